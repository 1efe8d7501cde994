/* Errors of an image against the exact one (metrics.h). */
#include <math.h>
#include <stdio.h>

#include "common/turns.h"
#include "echoes/echo_data.h"
#include "metrics/interpolation.h"
#include "metrics/metrics.h"

#define ANGLE_TOLERANCE 1e-9 /* rad; other programs compute the axes of files */

/* Where a reference patch lies within the image. */
struct offset {
    int patch, row, column; /* patch -1: nowhere */
};

/* Offset of a run of `count` samples within one of `whole_count`, both uniform; -1 unless all of them coincide. */
static int raster_offset(double first, double step, int count, double whole_first, double whole_step, int whole_count)
{
    double begin = (first - whole_first) / whole_step, offset = round(begin);
    double stretch = (count - 1) * (step / whole_step - 1); /* offset of the last sample, besides that of the first */
    double tolerance = raster_tolerance(fmax(fabs(first), fabs(whole_first)), whole_step);
    bool matches = fabs(begin - offset) <= tolerance && fabs(begin + stretch - offset) <= tolerance;
    return matches && offset >= 0 && offset + count <= whole_count ? (int)offset : -1;
}

static struct offset offset_find(const struct image *image, const struct grid *part)
{
    for (int k = 0; k < image->patch_count; k++) {
        const struct grid *whole = &image->patches[k];
        if (!(fabs(whole->angle_rad - part->angle_rad) <= ANGLE_TOLERANCE))
            continue;
        int column =
            raster_offset(part->x_first, part->x_step, part->x_count, whole->x_first, whole->x_step, whole->x_count);
        int row =
            raster_offset(part->r_first, part->r_step, part->r_count, whole->r_first, whole->r_step, whole->r_count);
        if (column >= 0 && row >= 0)
            return (struct offset){k, row, column};
    }
    return (struct offset){-1, 0, 0};
}

enum { GRID_TEXT = 160 };

/* As --grid takes it. */
static void grid_format(const struct grid *grid, char text[GRID_TEXT])
{
    snprintf(text, GRID_TEXT, "%.9g:%.9g:%d,%.9g:%.9g:%d,%.6g", grid->x_first, grid->x_step, grid->x_count,
             grid->r_first, grid->r_step, grid->r_count, grid->angle_rad * 180 / M_PI);
}

enum status metrics_cover(const struct image *image, int count, const struct grid *patches)
{
    for (int k = 0; k < count; k++)
        if (offset_find(image, &patches[k]).patch < 0) {
            char has[GRID_TEXT], needed[GRID_TEXT];
            grid_format(&image->patches[k < image->patch_count ? k : 0], has);
            grid_format(&patches[k], needed);
            return status_set(STATUS_INVALID,
                              "its grid is %s (xmin:xstep:xcount,rmin:rstep:rcount,angle in degrees), needed is %s",
                              has, needed);
        }
    return STATUS_OK;
}

/* Sums over all pixels for the errors. The gain and the peak come from a first pass, so that small errors are summed
   directly and not as differences of large sums. */
struct error_sums {
    double image, reference, reference_peak; /* energies, and the largest |reference|^2 */
    double complex cross;                    /* sum of reference conj(image) */
    double error, error_gain, error_peak;    /* energies of the differences, and the largest of one */
    double phase, phase_weight;              /* squared phase errors, weighted, and the weights */
};

static void pair_add_first(struct error_sums *sums, double complex value, double complex wanted)
{
    sums->image += square(value);
    sums->reference += square(wanted);
    sums->reference_peak = fmax(sums->reference_peak, square(wanted));
    sums->cross += wanted * conj(value);
}

static void pair_add_second(struct error_sums *sums, double complex value, double complex wanted)
{
    double complex gain = sums->image > 0 ? sums->cross / sums->image : 0;
    sums->error += square(value - wanted);
    sums->error_gain += square(gain * value - wanted);
    sums->error_peak = fmax(sums->error_peak, square(value - wanted));
    if (square(wanted) >= 0.01 * sums->reference_peak) {
        double phase = value == 0 ? NAN : carg(value * conj(wanted));
        sums->phase += square(wanted) * phase * phase;
        sums->phase_weight += square(wanted);
    }
}

struct error_metrics metrics_error(const struct image *image, const struct image *reference)
{
    struct error_metrics undefined = {NAN, NAN, NAN, NAN, NAN, "no errors: the exact image is zero"};
    void (*const passes[])(struct error_sums *, double complex, double complex) = {pair_add_first, pair_add_second};
    struct error_sums sums = {0};
    for (int pass = 0; pass < 2; pass++) {
        for (int k = 0; k < reference->patch_count; k++) {
            const struct grid *grid = &reference->patches[k];
            struct offset offset = offset_find(image, grid);
            if (offset.patch < 0) {
                undefined.reason = "no errors: no patch of the image has the exact image's pixels";
                return undefined;
            }
            for (int i = 0; i < grid->r_count; i++)
                for (int j = 0; j < grid->x_count; j++)
                    passes[pass](&sums, image_pixel(image, offset.patch, offset.row + i, offset.column + j),
                                 image_pixel(reference, k, i, j));
        }
        if (!(sums.reference < INFINITY && sums.image < INFINITY))
            undefined.reason = "no errors: pixels that are not finite, or too large to square";
        if (!(sums.reference > 0 && sums.reference < INFINITY && sums.image < INFINITY))
            return undefined;
    }
    return (struct error_metrics){
        .error = sqrt(sums.error / sums.reference),
        .error_gain = sqrt(sums.error_gain / sums.reference),
        .phase_rms_rad = sqrt(sums.phase / sums.phase_weight),
        .peak_ratio = sqrt(sums.error_peak / sums.reference_peak),
        .gain = sums.image > 0 ? sums.cross / sums.image : 0,
        .reason = isnan(sums.phase) ? "no phase error: strong pixels are zero" : "",
    };
}
