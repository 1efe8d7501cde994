/* An image's error, measured on some of its pixels. The exact image is formed of segments of rows: a quarter of them
   the brightest of a pilot image, the others drawn from the rest in order of brightness. The error is relative to the
   image, whatever the scene, and needs neither targets nor the whole exact image. */
#ifndef SASBENCH_IMAGING_PROBE_H
#define SASBENCH_IMAGING_PROBE_H

#include "imaging/spec.h"

/* The most pixels that are compared; an image of up to twice as many is taken whole. */
#define PROBE_PIXELS 1024

/* The place of a segment: columns from `column` on of one row of a patch. */
struct probe_place {
    int patch, row, column;
    double stands_for; /* segments of the image, 1 or more */
};

/* Made by probe_make, released by probe_free, which accepts a zeroed struct. */
struct probe {
    bool whole; /* an image of few pixels is taken whole: its patches are the grids */
    int count;  /* segments */
    /* [count]: the brightest, which stand for themselves, then others in order of brightness; NULL: the whole image */
    struct probe_place *places;
    struct grid *grids; /* [count], one row each but for the whole image */
    struct image exact; /* of `grids` */
};

/* Where errors count. */
struct region {
    int count; /* 0: everywhere */
    const struct grid *grids;
};

/* Choose segments by the magnitudes of a pilot, any image of the problem's patches, and form the exact image of them
   by a SPEC, to which `echoes` belong. Segments that do not meet the region are left out, unless none does. The choice
   is the same for the same pilot. Errors: as imaging_form; *probe then needs no free. */
enum status probe_make(const struct spec *exact, const struct problem *problem, const struct echoes *echoes,
                       const struct image *pilot, const struct region *region, struct probe *probe);
/* Form the exact image of the same segments again, by another SPEC. Errors: as imaging_form; *probe stays as it was. */
enum status probe_exact(const struct spec *exact, const struct problem *problem, const struct echoes *echoes,
                        struct probe *probe);
/* Add the probe of a window's image, of no whole one, to one of the whole image, zeroed at first; `part` is empty then.
   Errors: STATUS_FAILED without memory; both are still to be freed. */
enum status probe_join(struct probe *all, struct probe *part, const struct pixel_window *window);
void probe_free(struct probe *probe);
/* The problem of the segments alone, which points into the probe. */
struct problem probe_problem(const struct probe *probe, const struct problem *problem);

/* Relative L2 of the complex image, as metrics_error computes it of all pixels. */
struct probe_error {
    double error, error_gain; /* plain, and after one best complex gain; NAN where the exact segments are all zero */
    double low, high; /* of error_gain, at 95 % confidence; both error_gain where the probe is the whole image */
    int pixels;       /* that were compared */
};
struct probe_error probe_measure(const struct probe *probe, const struct image *image);
/* Of an image of probe_problem. */
struct probe_error probe_measure_pixels(const struct probe *probe, const struct image *pixels);

#endif
