/* The papers' pictures from our own images, drawn as in the papers: one picture a method or one panel a target. */
#ifndef SASBENCH_PAPERS_FIGURES_H
#define SASBENCH_PAPERS_FIGURES_H

#include <stdbool.h>

#include "contract/status.h"

/* Draw the figures that `asked` accepts into the folder, figure-ID.png, or figure-ID-SCENE-METHOD.png for images.
   Existing pictures stay. Pictures that gnuplot cannot draw are reported on standard error and counted in *undrawn.
   Errors: those of scenes, echoes and images. */
enum status figures_draw(const char *directory, bool (*asked)(const void *of, const char *id), const void *of,
                         int *undrawn);

#endif
