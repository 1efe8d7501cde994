/* What the tests of `convert` share: images against sums of the layouts' own numbers, refusals, HDF5. */
#ifndef SASBENCH_TEST_CONVERT_FIXTURE_H
#define SASBENCH_TEST_CONVERT_FIXTURE_H

#include <complex.h>

#include "tests/command/program.h"

enum { GRID = 9 }; /* pixels along each axis */

/* Where they begin, and their step, m. */
struct raster {
    double x, r, step;
};

double pixel_x(const struct raster *raster, int pixel);
double pixel_r(const struct raster *raster, int pixel);
/* The image of an echo file is, to 1e-3, that of [GRID * GRID] pixels, row by row. */
void assert_image(const char *echoes, const struct raster *raster, const double complex *wanted);
/* A file, behind a good one (NULL: alone), is refused for a field, in this process: its status has the message. */
void assert_field_refused(const char *good, const char *bad, const char *field, const char *reason);
/* The same of a file alone, of a table of data sets. */
#define ASSERT_SETS_REFUSED(sets, left_out, field, reason)                                                             \
    do {                                                                                                               \
        sets_write("bad.h5", sets, COUNT_OF(sets), left_out);                                                          \
        assert_field_refused(NULL, "bad.h5", field, reason);                                                           \
    } while (0)
/* `convert` makes of a file, saying `told`, echoes of that image. */
void assert_converted(const char *file, const char *told, const struct raster *raster, const double complex *wanted);
/* Add a record of `count` samples to the image, at each pixel's delay in samples from the first one. Between samples it
   is the sum of its frequencies, of real samples twice those above 0. It turns by `turns` cycles a sample. */
void record_add(const double complex *record, int count, bool is_real, const double *delays, double turns,
                double complex *image);

/* A data set of an HDF5 file, dimensions in its order. */
struct set {
    const char *name;
    const void *values; /* NULL: it is left out */
    bool is_single;     /* float, else double */
    int rank;
    unsigned long long dims[5];
};
/* Write a file of them, their groups with them, but one; NULL: all. */
void sets_write(const char *file, const struct set *sets, size_t count, const char *left_out);

#endif
