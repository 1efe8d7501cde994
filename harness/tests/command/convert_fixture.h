/* What the tests of `convert` share: images against sums of the layouts' own numbers, refusals, HDF5. */
#ifndef SASBENCH_TEST_CONVERT_FIXTURE_H
#define SASBENCH_TEST_CONVERT_FIXTURE_H

#include <complex.h>
#include <stdint.h>

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
/* Write a data set, its groups with it, in HDF5's order. Numbers are those of HDF5: hid_t, hsize_t. */
void set_write(int64_t file, const char *name, int64_t type, int rank, const unsigned long long *dims,
               const void *values);

#endif
