/* Pictures through gnuplot; the scripts and their one style file are in plots/. */
#ifndef SASBENCH_SHOW_PLOT_H
#define SASBENCH_SHOW_PLOT_H

#include "scene/scene.h"

/* An image in decibels below its peak, all patches, into `path` (PNG or SVG), beside it its difference from another.
   Large images are reduced by taking the largest magnitude of each block. Errors of all pictures: STATUS_FAILED,
   when gnuplot is missing, fails (with what it printed), writes an incomplete picture or does not end by itself; an
   older file at `path` then stays. */
#define IMAGE_RANGE_DB 60
struct image_picture {
    const struct image *image;
    const struct image *reference; /* the exact image on the same patches; NULL: no difference is drawn */
    const char *title, *footer;    /* footer: where the image is from; may be NULL */
    double range_db;               /* dynamic range below the peak; 0: IMAGE_RANGE_DB */
    const struct target *targets;  /* [target_count] that are labelled */
    int target_count;
    bool named; /* the user gave the path: follow a link there */
};
/* With a queue (plot_script.h) the picture is drawn later; NULL: now. */
struct plot_queue;
enum status plot_image(struct plot_queue *queue, const char *path, const char *plots_directory,
                       const struct image_picture *picture);
/* Note on standard error a picture that was not drawn, by the status of its making, and count it. */
void undrawn_note(enum status status, int *undrawn);

/* Seconds that gnuplot may take for a picture. After a longer one nothing more is drawn. */
extern double plot_seconds_most;

/* Azimuth slices through point targets, one panel a target, one line an image (the papers' overlays). */
struct slice_line {
    const char *label;             /* SPEC */
    double *position_m, *power_db; /* [count], owned by the caller */
    int count;
    double *difference_db; /* [count] of the complex difference from the exact image over its peak; NULL: none */
    const char *algorithm; /* whose colour it has: a name, or a SPEC; NULL: that of the label */
    double printed;        /* of phase errors: the largest that the paper prints; 0: none */
};
struct slices_picture {
    const char *title, *footer; /* footer: where they are from; may be NULL */
    int panel_count, line_count;
    const char *const *panel_titles; /* [panel_count] */
    const struct slice_line *lines;  /* [panel_count][line_count] */
    bool phase;                      /* phase errors: position in cycles a metre, `power_db` in radians */
};
enum status plot_slices(struct plot_queue *queue, const char *path, const char *plots_directory,
                        const struct slices_picture *picture);

/* Of the rows in DIR/measurements.csv, as PNG and SVG: error against time, DIR/SCENE-error_time, of every scene, and
   all of them side by side, DIR/overview; or of the one `scene` of a sweep alone, with DIR/SCENE-upsampling where
   its settings change the upsampling rate. Less than two points are not drawn; failed pictures are reported and
   added to *undrawn. Errors: as results_read; STATUS_FAILED without memory. */
enum status plot_results(const char *directory, const char *scene, int *undrawn);

/* Draw one CSV file by a script into `path`, a PNG, and as SVG beside it; footer: where the file is from. */
enum status plot_csv(const char *path, const char *plots_directory, const char *script, const char *csv,
                     const char *footer);

/* The name of a setting's picture: "bp_linear:beta=8 double". */
void picture_label(const char *algorithm, const char *options, const char *precision, char *label, size_t size);
/* Change a PNG picture's path to that of the SVG beside it. */
void plot_path_svg(char *path);
/* "DIR/bp22_table3-error_time.png" for bp22/table3 and error_time.png: characters special to a shell become '_'. */
void picture_path(const char *directory, const char *scene, const char *rest, char *path, size_t size);

#endif
