/* A description of an echo file, and a grid to begin with. */
#ifndef SASBENCH_COMMAND_INSPECT_H
#define SASBENCH_COMMAND_INSPECT_H

#include "scene/scene.h"

/* Print it, with warnings of probable faults. Errors: as echo_file_read. */
enum status inspect_echoes(const char *path);

/* Propose a grid that shows the recording: on a straight track from its first to its last ping and over the ranges of
   the records; else around the place that the records have in common. Steps of half the resolution, at most 1000 pixels
   an axis, about the middle. *cut: that bound shortened it. False where no grid suits the geometry. */
bool inspect_grid(const struct acquisition *acquisition, struct grid *grid, bool *cut);

#endif
