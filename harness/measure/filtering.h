/* The polar-format filter (wavenumber/polar_filter.h) on recorded echoes, and how much of each target it keeps. */
#ifndef SASBENCH_MEASURE_FILTERING_H
#define SASBENCH_MEASURE_FILTERING_H

#include "imaging/spec.h"
#include "scene/scene.h"
#include "wavenumber/polar_filter.h"

struct traces;

/* Matched filter, then the target area, for the echoes of one acquisition. Made by filtering_open, released by
   filtering_close. */
struct filtering {
    const struct acquisition *acquisition; /* borrowed, outlives it */
    struct traces *traces;
    struct polar_filter *filter;
    struct polar_shape shape;
};

/* `spec` is one of wk_polar. Errors: STATUS_UNSUPPORTED as polar_filter_check, STATUS_FAILED without memory; there is
   nothing to close then. */
enum status filtering_open(const struct acquisition *acquisition, const struct spec *spec, struct filtering *filtering);
void filtering_close(struct filtering *filtering);

/* Both in place, on records [pings][samples]: filtering_compress takes recorded ones, filtering_apply compressed
   ones. */
void filtering_compress(const struct filtering *filtering, double complex *records);
void filtering_apply(const struct filtering *filtering, double complex *records);

/* The filter's effect on echoes: the energy that it keeps and the energy of what it changes, both over the energy of
   its input; NAN without echoes. */
struct kept {
    double kept_db, changed_db;
};

/* Filters compressed echoes in place. Errors: STATUS_FAILED without memory. */
enum status filtering_measure(const struct filtering *filtering, double complex *records, struct kept *kept);
/* The same for point target `index` of the scene by itself: the filter is linear. Errors: as filtering_measure and
   scene_simulate. */
enum status filtering_target(const struct filtering *filtering, const struct scene *scene, int index,
                             struct kept *kept);

/* Does a place lie in the target area? */
bool area_holds(const struct target_area *area, double x_m, double r_m);

#endif
