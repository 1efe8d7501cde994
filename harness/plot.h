/* Pictures through gnuplot; the scripts and their one style file are in plots/. */
#ifndef SASBENCH_PLOT_H
#define SASBENCH_PLOT_H

#include "scene.h"

/* Image in decibels below its peak (0 to -60), all patches, into `path` (PNG). Large images are reduced by taking the
   largest magnitude of each block. Errors: STATUS_FAILED, when gnuplot is missing or fails, with what it printed. */
enum status plot_image(const char *path, const char *plots_directory, const struct image *image, const char *title);

/* Azimuth slices through point targets, one panel a target, one line an image (the papers' overlays). */
struct slice_line {
    const char *label;              /* SPEC */
    double *position_m, *power_db;  /* [count], owned by the caller */
    int count;
};
/* lines: [panel_count][line_count]. */
enum status plot_slices(const char *path, const char *plots_directory, const char *title, int panel_count,
                        const char *const *panel_titles, int line_count, const struct slice_line *lines);
/* The same for phase errors: position in cycles a metre, `power_db` holds radians. */
enum status plot_phase(const char *path, const char *plots_directory, const char *title, int panel_count,
                       const char *const *panel_titles, int line_count, const struct slice_line *lines);

#endif
