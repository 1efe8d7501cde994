/* Samples and images in memory: allocation, conversion, release. */
#ifndef SASBENCH_ECHOES_ECHO_DATA_H
#define SASBENCH_ECHOES_ECHO_DATA_H

#include "contract/algorithm.h"

/* Bytes of one complex number. */
size_t precision_size(enum precision precision);
const char *precision_name(enum precision precision); /* "float", "double" */

/* Samples of all records together; the acquisition was checked to fit into memory. */
size_t acquisition_samples(const struct acquisition *acquisition);
size_t samples_bytes(const struct acquisition *acquisition, enum precision precision);

/* a * b * c * d bytes, or 0 if that overflows size_t. */
size_t size_product(size_t a, size_t b, size_t c, size_t d);

/* Allocate samples for an acquisition, of any values, owned by the caller (free(): the samples pointer is malloc'ed and
   64-byte aligned). Errors: STATUS_FAILED without memory. */
enum status echoes_allocate(const struct acquisition *acquisition, enum precision precision, struct echoes *echoes);
/* A copy in the other precision, same ownership. If the largest sample lies near the ends of the precision's range,
   where sums overflow and small parts are lost, samples are divided by a power of two, exactly: to->exponent. */
enum status echoes_convert(const struct echoes *from, enum precision precision, struct echoes *to);
/* That power of two, 0 for none. */
int echoes_exponent(const struct echoes *echoes, enum precision precision);
void echoes_free(struct echoes *echoes);
/* Multiply by -1, exactly: samples that the caller owns; an image. */
void echoes_negate(struct echoes *echoes);
void image_negate(struct image *image);

/* Allocate a zeroed image over `patches` (kept by pointer, not copied). Errors: STATUS_FAILED without memory. */
enum status image_allocate(int patch_count, const struct grid *patches, enum precision precision, struct image *image);
/* Multiply an image by 2^exponent, exactly: the exponent of the echoes that it was made of. Unless the exponent is 0
   the image is double afterwards, for float may not hold it. Errors: STATUS_FAILED without memory. */
enum status image_scale(struct image *image, int exponent);
void image_free(struct image *image);

/* The largest magnitude of a real or imaginary part of complex numbers; infinite or NaN where one is. */
double largest_part(const void *numbers, enum precision precision, size_t count);

/* False if any pixel is infinite or not a number: such a result must not be shown. */
bool image_is_finite(const struct image *image);

/* Pixel (i, j) of a patch as double, whatever the precision. */
double complex image_pixel(const struct image *image, int patch, int i, int j);

#endif
