/* Memory of samples and images, in either precision. */
#include "echoes/echo_data.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"

enum { LINE = 64 /* bytes of the cache's */, FEW = 1 << 16 /* numbers, that one thread handles */ };

static const struct {
    const char *name;
    size_t size;
} precisions[] = {
    [PRECISION_FLOAT] = {"float", sizeof(float complex)},
    [PRECISION_DOUBLE] = {"double", sizeof(double complex)},
};

size_t precision_size(enum precision precision)
{
    return precisions[precision].size;
}

const char *precision_name(enum precision precision)
{
    return precisions[precision].name;
}

size_t acquisition_samples(const struct acquisition *acquisition)
{
    return (size_t)acquisition->pings * (size_t)acquisition->receivers * (size_t)acquisition->samples;
}

size_t samples_bytes(const struct acquisition *acquisition, enum precision precision)
{
    return acquisition_samples(acquisition) * precision_size(precision);
}

size_t size_product(size_t a, size_t b, size_t c, size_t d)
{
    size_t product;
    if (__builtin_mul_overflow(a, b, &product) || __builtin_mul_overflow(product, c, &product)
        || __builtin_mul_overflow(product, d, &product)) {
        return 0;
    }
    return product;
}

/* NULL for a size of 0, one that overflowed. */
static void *allocate(size_t size)
{
    return size > 0 && size <= PTRDIFF_MAX - LINE ? memory_columns(LINE, size) : NULL;
}

static double complex number_at(const void *numbers, enum precision precision, size_t index)
{
    return precision == PRECISION_FLOAT ? ((const float complex *)numbers)[index]
                                        : ((const double complex *)numbers)[index];
}

/* Times 2^exponent. */
static void numbers_copy(const void *from, enum precision from_precision, int exponent, void *to,
                         enum precision precision, size_t count)
{
#pragma omp parallel for if (count > FEW)
    for (size_t i = 0; i < count; i++) {
        double complex z = number_at(from, from_precision, i);
        if (exponent != 0)
            z = __builtin_complex(ldexp(creal(z), exponent), ldexp(cimag(z), exponent));
        if (precision == PRECISION_FLOAT)
            ((float complex *)to)[i] = __builtin_complex((float)creal(z), (float)cimag(z));
        else
            ((double complex *)to)[i] = z;
    }
}

/* Bits of the magnitude of a part: they are ordered as the magnitudes are, and above all finite ones for others. */
static uint64_t magnitude_bits(const void *parts, enum precision precision, size_t i)
{
    uint32_t single;
    uint64_t both;
    if (precision == PRECISION_DOUBLE) {
        memcpy(&both, (const char *)parts + i * sizeof both, sizeof both);
        return both & INT64_MAX;
    }
    memcpy(&single, (const char *)parts + i * sizeof single, sizeof single);
    return single & INT32_MAX;
}

double largest_part(const void *numbers, enum precision precision, size_t count)
{
    uint64_t most = 0;
    float single;
    double both;
#pragma omp parallel for reduction(max : most) if (count > FEW)
    for (size_t i = 0; i < 2 * count; i++)
        most = magnitude_bits(numbers, precision, i) > most ? magnitude_bits(numbers, precision, i) : most;
    memcpy(&both, &most, sizeof both);
    memcpy(&single, &(uint32_t){(uint32_t)most}, sizeof single);
    return precision == PRECISION_DOUBLE ? both : single;
}

enum status echoes_allocate(const struct acquisition *acquisition, enum precision precision, struct echoes *echoes)
{
    size_t size = size_product((size_t)acquisition->pings, (size_t)acquisition->receivers, (size_t)acquisition->samples,
                               precision_size(precision));
    *echoes = (struct echoes){0};
    enum status room = memory_check((double)size, "echoes");
    if (room != STATUS_OK) {
        return room;
    }
    *echoes = (struct echoes){acquisition, precision, allocate(size), 0};
    if (!echoes->samples) {
        return status_set(STATUS_FAILED, "out of memory for %d samples x %d receivers x %d pings", acquisition->samples,
                          acquisition->receivers, acquisition->pings);
    }
    return STATUS_OK;
}

/* It brings the largest part below 1, unless that lies well within the range of `precision`: room for the sums of 2^60
   samples, and for parts 2^60 times smaller. */
int echoes_exponent(const struct echoes *echoes, enum precision precision)
{
    const double reach = precision == PRECISION_FLOAT ? 0x1p40 : 0x1p400;
    int exponent = 0;
    if (echoes->precision == PRECISION_FLOAT)
        return 0;
    const double largest = largest_part(echoes->samples, echoes->precision, acquisition_samples(echoes->acquisition));
    if (largest > 0 && largest < INFINITY && !(largest >= 1 / reach && largest <= reach))
        frexp(largest, &exponent);
    return exponent;
}

enum status echoes_convert(const struct echoes *from, enum precision precision, struct echoes *to)
{
    enum status status = echoes_allocate(from->acquisition, precision, to);
    if (status == STATUS_OK) {
        const int exponent = echoes_exponent(from, precision);
        numbers_copy(from->samples, from->precision, -exponent, (void *)to->samples, precision,
                     acquisition_samples(from->acquisition));
        to->exponent = from->exponent + exponent;
    }
    return status;
}

void echoes_free(struct echoes *echoes)
{
    free((void *)echoes->samples);
    *echoes = (struct echoes){0};
}

static void negate(void *numbers, size_t count, enum precision precision)
{
    float complex *single = numbers;
    double complex *both = numbers;
    for (size_t n = 0; n < count; n++)
        if (precision == PRECISION_FLOAT)
            single[n] = -single[n];
        else
            both[n] = -both[n];
}

void echoes_negate(struct echoes *echoes)
{
    negate((void *)echoes->samples, acquisition_samples(echoes->acquisition), echoes->precision);
}

void image_negate(struct image *image)
{
    for (int k = 0; k < image->patch_count; k++)
        negate(image->pixels[k], grid_pixels(&image->patches[k]), image->precision);
}

enum status image_allocate(int patch_count, const struct grid *patches, enum precision precision, struct image *image)
{
    double bytes = 0;
    for (int i = 0; i < patch_count; i++) {
        bytes += (double)grid_pixels(&patches[i]) * (double)precision_size(precision);
    }
    *image = (struct image){0};
    enum status room = memory_check(bytes, "the image");
    if (room != STATUS_OK) {
        return room;
    }
    *image = (struct image){patch_count, patches, precision, calloc((size_t)patch_count, sizeof *image->pixels)};
    for (int i = 0; image->pixels && i < patch_count; i++) {
        const size_t size =
            size_product((size_t)patches[i].r_count, (size_t)patches[i].x_count, 1, precision_size(precision));
        image->pixels[i] = allocate(size);
        if (!image->pixels[i]) {
            enum status status = status_set(STATUS_FAILED, "out of memory for an image of %d x %d pixels",
                                            patches[i].r_count, patches[i].x_count);
            image_free(image);
            return status;
        }
        memory_clear(image->pixels[i], size);
    }
    return image->pixels ? STATUS_OK : status_set(STATUS_FAILED, "out of memory for %d image patches", patch_count);
}

enum status image_scale(struct image *image, int exponent)
{
    struct image scaled;
    if (exponent == 0)
        return STATUS_OK;
    enum status status = image_allocate(image->patch_count, image->patches, PRECISION_DOUBLE, &scaled);
    if (status != STATUS_OK)
        return status;
    for (int i = 0; i < image->patch_count; i++) {
        numbers_copy(image->pixels[i], image->precision, exponent, scaled.pixels[i], PRECISION_DOUBLE,
                     grid_pixels(&image->patches[i]));
    }
    image_free(image);
    *image = scaled;
    return STATUS_OK;
}

void image_free(struct image *image)
{
    for (int i = 0; image->pixels && i < image->patch_count; i++) {
        free(image->pixels[i]);
    }
    free(image->pixels);
    *image = (struct image){0};
}

double complex image_pixel(const struct image *image, int patch, int i, int j)
{
    size_t index = (size_t)i * (size_t)image->patches[patch].x_count + (size_t)j;
    return number_at(image->pixels[patch], image->precision, index);
}

bool image_is_finite(const struct image *image)
{
    bool finite = true;
    for (int k = 0; k < image->patch_count; k++)
        finite = finite && isfinite(largest_part(image->pixels[k], image->precision, grid_pixels(&image->patches[k])));
    return finite;
}
