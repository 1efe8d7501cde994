/* The shift between two images (metrics.h). */
#include <complex.h>
#include <math.h>

#include <fftw3.h>

#include "echoes/echo_data.h"
#include "metrics/metrics.h"

struct plane {
    int rows, columns; /* padded, so that the correlation does not wrap */
    fftw_complex *values;
};

/* The spectrum of a patch, padded with zeros. */
static void spectrum_make(const struct image *image, struct plane *plane)
{
    const struct grid *grid = &image->patches[0];
    fftw_plan plan =
        fftw_plan_dft_2d(plane->rows, plane->columns, plane->values, plane->values, FFTW_FORWARD, FFTW_ESTIMATE);
    for (int i = 0; i < plane->rows; i++)
        for (int j = 0; j < plane->columns; j++)
            plane->values[(size_t)i * (size_t)plane->columns + (size_t)j] =
                i < grid->r_count && j < grid->x_count ? image_pixel(image, 0, i, j) : 0;
    fftw_execute(plan);
    fftw_destroy_plan(plan);
}

static double power(const struct plane *plane, int row, int column)
{
    const int i = (row + plane->rows) % plane->rows, j = (column + plane->columns) % plane->columns;
    const double magnitude = cabs(plane->values[(size_t)i * (size_t)plane->columns + (size_t)j]);
    return magnitude * magnitude;
}

/* The peak of a parabola through three samples, the middle one the largest. */
static double peak_offset(double before, double at, double after)
{
    const double curve = before - 2 * at + after;
    return curve < 0 ? (before - after) / (2 * curve) : 0;
}

static struct shift peak_find(const struct plane *plane, const struct grid *grid)
{
    int row = 0, column = 0;
    for (int i = 1 - grid->r_count; i < grid->r_count; i++)
        for (int j = 1 - grid->x_count; j < grid->x_count; j++)
            if (power(plane, i, j) > power(plane, row, column)) {
                row = i;
                column = j;
            }
    const double at = power(plane, row, column);
    if (!(at > 0 && at < INFINITY))
        return (struct shift){NAN, NAN};
    return (struct shift){
        grid->x_step * (column + peak_offset(power(plane, row, column - 1), at, power(plane, row, column + 1))),
        grid->r_step * (row + peak_offset(power(plane, row - 1, column), at, power(plane, row + 1, column)))};
}

struct shift metrics_shift(const struct image *image, const struct image *reference)
{
    const struct grid *grid = &reference->patches[0];
    struct shift shift = {NAN, NAN};
    struct plane plane[2];
    for (int k = 0; k < 2; k++) {
        plane[k].rows = 2 * grid->r_count;
        plane[k].columns = 2 * grid->x_count;
        plane[k].values = fftw_alloc_complex((size_t)plane[k].rows * (size_t)plane[k].columns);
    }
    if (plane[0].values && plane[1].values) {
        const size_t count = (size_t)plane[0].rows * (size_t)plane[0].columns;
        spectrum_make(image, &plane[0]);
        spectrum_make(reference, &plane[1]);
        for (size_t n = 0; n < count; n++)
            plane[0].values[n] *= conj(plane[1].values[n]);
        fftw_plan plan = fftw_plan_dft_2d(plane[0].rows, plane[0].columns, plane[0].values, plane[0].values,
                                          FFTW_BACKWARD, FFTW_ESTIMATE);
        fftw_execute(plan);
        fftw_destroy_plan(plan);
        shift = peak_find(&plane[0], grid);
    }
    for (int k = 0; k < 2; k++)
        fftw_free(plane[k].values);
    return shift;
}
