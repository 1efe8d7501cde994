/* Images between their pixels (interpolation.h). */
#include "metrics/interpolation.h"

#include <float.h>
#include <math.h>

#include "common/bessel.h"
#include "echoes/echo_data.h"
#include "metrics/metrics.h"

#define KAISER_BETA 10.0 /* stop band of 100 dB */

void taps_fill(double fraction, double taps[2 * TAPS_HALF])
{
    for (int k = 0; k < 2 * TAPS_HALF; k++) {
        double distance = k - TAPS_HALF + 1 - fraction, z = distance / TAPS_HALF;
        double sinc = distance == 0 ? 1 : sin(M_PI * distance) / (M_PI * distance);
        taps[k] = sinc * bessel_i0(KAISER_BETA * sqrt(1 - z * z)) / bessel_i0(KAISER_BETA);
        if (fraction == 0)
            taps[k] = distance == 0;
    }
}

double raster_tolerance(double largest_m, double step)
{
    return fmin(0.25, RASTER_TOLERANCE + 2 * DBL_EPSILON * fabs(largest_m) / step);
}

/* The place of `value` on an axis in units of samples; whole where it lies on the raster. */
static double raster_place(double value, double first, double step)
{
    double coordinate = (value - first) / step, whole = round(coordinate);
    double tolerance = raster_tolerance(fmax(fabs(value), fabs(first)), step);
    return fabs(coordinate - whole) <= tolerance ? whole : coordinate;
}

struct place place_find(const struct image *image, double x, double r)
{
    struct place best = {.patch = -1};
    for (int k = 0; k < image->patch_count; k++) {
        const struct grid *grid = &image->patches[k];
        const struct vector at = grid_coordinates(grid, x, r);
        double column = raster_place(at.x, grid->x_first, grid->x_step);
        double row = raster_place(at.y, grid->r_first, grid->r_step);
        double margin_x = grid->x_step * fmin(column, grid->x_count - 1 - column);
        double margin_r = grid->r_step * fmin(row, grid->r_count - 1 - row);
        double margin = fmin(margin_x, margin_r);
        if (margin >= 0 && (best.patch < 0 || margin > best.margin_m))
            best = (struct place){k, grid, column, row, margin};
    }
    return best;
}

void columns_interpolate(const struct image *image, const struct acquisition *acquisition, const struct place *place,
                         int first, int count, double complex *samples)
{
    double base = floor(place->row), taps[2 * TAPS_HALF];
    double complex weights[2 * TAPS_HALF];
    const int top = (int)base - TAPS_HALF + 1;
    taps_fill(place->row - base, taps);
    for (int k = 0; k < 2 * TAPS_HALF; k++) {
        double cycles = 2 * acquisition->fc * (top + k - place->row) * place->grid->r_step / acquisition->sound_speed;
        weights[k] = taps[k] * cexp(-2 * M_PI * I * cycles);
    }
    for (int j = 0; j < count; j++) {
        samples[j] = 0;
        for (int k = 0; k < 2 * TAPS_HALF; k++)
            if (top + k >= 0 && top + k < place->grid->r_count && taps[k] != 0)
                samples[j] += weights[k] * image_pixel(image, place->patch, top + k, first + j);
    }
}

void rows_interpolate(const struct image *image, const struct acquisition *acquisition, const struct place *place,
                      double complex *samples)
{
    const struct grid *grid = place->grid;
    double base = floor(place->column), taps[2 * TAPS_HALF];
    const int left = (int)base - TAPS_HALF + 1;
    taps_fill(place->column - base, taps);
    for (int i = 0; i < grid->r_count; i++) {
        double complex sum = 0;
        for (int k = 0; k < 2 * TAPS_HALF; k++)
            if (left + k >= 0 && left + k < grid->x_count && taps[k] != 0)
                sum += taps[k] * image_pixel(image, place->patch, i, left + k);
        double cycles = 2 * acquisition->fc * (i - place->row) * grid->r_step / acquisition->sound_speed;
        samples[i] = cexp(-2 * M_PI * I * cycles) * sum;
    }
}

double complex metrics_value(const struct image *image, const struct acquisition *acquisition, double x, double r)
{
    struct place place = place_find(image, x, r);
    if (place.patch < 0)
        return NAN;
    double base = floor(place.column), taps[2 * TAPS_HALF];
    double complex columns[2 * TAPS_HALF], sum = 0;
    const int left = (int)base - TAPS_HALF + 1, first = left < 0 ? 0 : left;
    const int end = left + 2 * TAPS_HALF < place.grid->x_count ? left + 2 * TAPS_HALF : place.grid->x_count;
    taps_fill(place.column - base, taps);
    columns_interpolate(image, acquisition, &place, first, end - first, columns);
    for (int j = first; j < end; j++)
        if (taps[j - left] != 0)
            sum += taps[j - left] * columns[j - first];
    return sum;
}
