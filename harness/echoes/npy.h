/* Images in the format of NumPy, .npy. */
#ifndef SASBENCH_ECHOES_NPY_H
#define SASBENCH_ECHOES_NPY_H

#include <stdio.h>

#include "echoes/matfile.h"

/* Read an array [r_count][x_count], or its rows one after the other, of complex or real numbers, float or double, as
   the image of a grid: one patch, in double, of unknown origin. Closed with image_file_close. Errors: STATUS_INVALID,
   naming file, value and what is accepted; STATUS_FAILED for memory; nothing to close then. */
enum status npy_image_read(const char *path, const struct grid *grid, struct image_file *file);
/* Read it into an image that has its memory; of several patches, the pixels of one after the other. `path` is for
   messages. Errors: STATUS_INVALID. */
enum status npy_pixels_read(FILE *stream, const char *path, const struct image *image);

#endif
