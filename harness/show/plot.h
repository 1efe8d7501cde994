/* Pictures through gnuplot; the scripts and their one style file are in plots/. */
#ifndef SASBENCH_SHOW_PLOT_H
#define SASBENCH_SHOW_PLOT_H

#include "scene/scene.h"

/* An image in decibels below its peak, all patches, into `path` (PNG or SVG), and its difference to another beside it.
   Large images are reduced by taking the largest magnitude of each block. Errors of all pictures: STATUS_FAILED, when
   gnuplot is missing, fails (with what it printed), leaves a picture without its end or does not end by itself; what
   stood at `path` is then left as it was. */
#define IMAGE_RANGE_DB 60
struct image_picture {
    const struct image *image;
    const struct image *reference; /* the exact image on the same patches; NULL: no difference is drawn */
    const char *title, *footer;    /* footer: where the image is from; may be NULL */
    double range_db;               /* shown below the peak; 0: IMAGE_RANGE_DB */
    const struct target *targets;  /* [target_count] that are named in it */
    int target_count;
    bool named; /* the path, by the user: a link there is followed */
};
enum status plot_image(const char *path, const char *plots_directory, const struct image_picture *picture);
/* The same, drawn later (plot_script.h): what is written until then fails here, the rest there. */
struct plot_queue;
enum status plot_image_later(struct plot_queue *queue, const char *path, const char *plots_directory,
                             const struct image_picture *picture);

/* Seconds that gnuplot may take for a picture. After one that took longer nothing is drawn. */
extern double plot_seconds_most;

/* Azimuth slices through point targets, one panel a target, one line an image (the papers' overlays). */
struct slice_line {
    const char *label;             /* SPEC */
    double *position_m, *power_db; /* [count], owned by the caller */
    int count;
    double *difference_db; /* [count] of the complex difference to the exact image over its peak; NULL: unknown */
    const char *algorithm; /* whose colour it has: a name, or a SPEC; NULL: the label is one */
    double printed;        /* of phase errors: the largest that the paper says; 0: it says none */
};
struct slices_picture {
    const char *title, *footer; /* footer: where they are from; may be NULL */
    int panel_count, line_count;
    const char *const *panel_titles; /* [panel_count] */
    const struct slice_line *lines;  /* [panel_count][line_count] */
};
enum status plot_slices(const char *path, const char *plots_directory, const struct slices_picture *picture);
enum status plot_slices_later(struct plot_queue *queue, const char *path, const char *plots_directory,
                              const struct slices_picture *picture);
/* The same for phase errors: position in cycles a metre, `power_db` holds radians. */
enum status plot_phase(const char *path, const char *plots_directory, const struct slices_picture *picture);

/* Of the rows in DIR/measurements.csv, as PNG and SVG: error against time, DIR/SCENE-error_time, of every scene, and
   all of them side by side, DIR/overview; or of the one `scene` of a sweep alone, with DIR/SCENE-upsampling where its
   settings change the upsampling rate. What has less than two points is not drawn; what cannot be drawn is reported
   and added to *undrawn. Errors: as results_read; STATUS_FAILED without memory. */
enum status plot_results(const char *directory, const char *scene, int *undrawn);

/* A script about one CSV file, into `path`, a PNG, and as SVG beside it; footer: where the file is from. */
enum status plot_csv(const char *path, const char *plots_directory, const char *script, const char *csv,
                     const char *footer);

/* What a picture of one setting is called: "bp_linear:beta=8 double". */
void picture_label(const char *algorithm, const char *options, const char *precision, char *label, size_t size);
/* A PNG picture's path becomes that of the SVG beside it. */
void plot_path_svg(char *path);
/* "DIR/bp22_table3-error_time.png" for bp22/table3 and error_time.png: signs that a shell would take become '_'. */
void picture_path(const char *directory, const char *scene, const char *rest, char *path, size_t size);

#endif
