/* PF05's pictures of echoes: as recorded, range compressed, and filtered by four sub-apertures (Figs 5A to 5C). */
#ifndef SASBENCH_PAPERS_ECHO_FIGURES_H
#define SASBENCH_PAPERS_ECHO_FIGURES_H

#include "contract/status.h"

#define ECHO_FIGURES "pf05_f5_echoes"

/* Draw them into the folder: figure-ID-recorded.png, -compressed.png, -filtered.png. Those that are there already stay.
   What gnuplot cannot draw is reported on standard error and counted in *undrawn. Errors: those of the scene, its
   echoes and the filter. */
enum status echo_figures_draw(const char *directory, int *undrawn);

#endif
