/* A description of an echo file, and a grid to begin with. */
#ifndef SASBENCH_COMMAND_INSPECT_H
#define SASBENCH_COMMAND_INSPECT_H

#include "scene/scene.h"

/* Print it, with warnings of probable faults. Errors: as echo_file_read. */
enum status inspect_echoes(const char *path);

#endif
