/* What an echo file holds, in words, and a grid to begin with. */
#ifndef SASBENCH_COMMAND_INSPECT_H
#define SASBENCH_COMMAND_INSPECT_H

#include "scene/scene.h"

/* Print it, with warnings of what is probably wrong in it. Errors: as echo_file_read. */
enum status inspect_echoes(const char *path);

/* A grid that shows what was recorded: on a straight track from its first to its last ping and over the ranges of the
   records; else around the place that the records have in common. Steps of half the resolution, at most 1000 pixels an
   axis, about the middle. *cut: that bound shortened it. False where no grid suits the geometry. */
bool inspect_grid(const struct acquisition *acquisition, struct grid *grid, bool *cut);

#endif
