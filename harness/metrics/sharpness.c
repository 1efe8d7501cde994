/* An image's peak, and how sharp it is, whatever it shows (metrics.h). */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "echoes/echo_data.h"
#include "metrics/metrics.h"

enum { BUCKETS = 1 << 16 };

/* Applied to each pixel's magnitude over the peak's. */
typedef void (*pixel_function)(void *sums, double ratio);

/* Without hypot, which takes longer than all else here, where squares fit. */
static double magnitude_of(const struct image *image, int p, int i, int j)
{
    const double complex value = image_pixel(image, p, i, j);
    return image->precision == PRECISION_FLOAT ? sqrt(creal(value) * creal(value) + cimag(value) * cimag(value))
                                               : cabs(value);
}

static void pixels_visit(const struct image *image, double peak, pixel_function function, void *sums)
{
    for (int p = 0; p < image->patch_count; p++)
        for (int i = 0; i < image->patches[p].r_count; i++)
            for (int j = 0; j < image->patches[p].x_count; j++)
                function(sums, magnitude_of(image, p, i, j) / peak);
}

/* The brightest pixel that is finite; false where others are not. */
static bool peak_find(const struct image *image, struct sharpness *sharpness)
{
    bool all_finite = true;
    for (int p = 0; p < image->patch_count; p++)
        for (int i = 0; i < image->patches[p].r_count; i++)
            for (int j = 0; j < image->patches[p].x_count; j++) {
                const double magnitude = magnitude_of(image, p, i, j);
                all_finite = all_finite && isfinite(magnitude);
                if (magnitude > sharpness->peak && isfinite(magnitude)) {
                    const struct vector place = grid_point(&image->patches[p], i, j);
                    sharpness->peak = magnitude;
                    sharpness->x = place.x;
                    sharpness->r = place.y;
                }
            }
    return all_finite;
}

/* The median by the bits of floats: floats >= 0 sort as their bits do. First the upper half, then the lower one. */
struct histogram {
    uint32_t upper; /* of the bits; BUCKETS: not yet found */
    uint64_t counts[BUCKETS];
};

static void histogram_visit(void *sums, double ratio)
{
    struct histogram *histogram = sums;
    const float value = (float)ratio;
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    if (histogram->upper == BUCKETS)
        histogram->counts[bits >> 16]++;
    else if (bits >> 16 == histogram->upper)
        histogram->counts[bits & (BUCKETS - 1)]++;
}

struct moments {
    double count, power, power_squared, power_log; /* of the powers I, sums of I, I^2, I ln I */
    struct histogram *histogram;
};

static void moments_visit(void *sums, double ratio)
{
    struct moments *moments = sums;
    const double power = ratio * ratio;
    moments->count++;
    moments->power += power;
    moments->power_squared += power * power;
    moments->power_log += power > 0 ? power * log(power) : 0;
    histogram_visit(moments->histogram, ratio);
}

/* The bucket of the value of this rank; the rank becomes that within the bucket. */
static uint32_t bucket_find(const struct histogram *histogram, uint64_t *rank)
{
    uint32_t bucket = 0;
    for (; bucket < BUCKETS - 1 && *rank >= histogram->counts[bucket]; bucket++)
        *rank -= histogram->counts[bucket];
    return bucket;
}

struct sharpness metrics_sharpness(const struct image *image)
{
    static struct histogram histogram;
    struct sharpness sharpness = {.entropy = NAN, .contrast = NAN, .peak_over_median = NAN};
    struct moments sums = {.histogram = &histogram};
    float median;
    if (!peak_find(image, &sharpness) || !(sharpness.peak > 0))
        return sharpness;
    memset(&histogram, 0, sizeof histogram);
    histogram.upper = BUCKETS;
    pixels_visit(image, sharpness.peak, moments_visit, &sums);
    const double mean = sums.power / sums.count;
    uint64_t rank = (uint64_t)(sums.count / 2);
    const uint32_t upper = bucket_find(&histogram, &rank);
    memset(histogram.counts, 0, sizeof histogram.counts);
    histogram.upper = upper;
    pixels_visit(image, sharpness.peak, histogram_visit, &histogram);
    const uint32_t bits = upper << 16 | bucket_find(&histogram, &rank);
    memcpy(&median, &bits, sizeof median);
    sharpness.entropy = log(sums.power) - sums.power_log / sums.power;
    sharpness.contrast = sqrt(fmax(0, sums.power_squared / sums.count - mean * mean)) / mean;
    sharpness.peak_over_median = median > 0 ? 1 / median : NAN;
    return sharpness;
}
