/* Image quality: main-lobe measures of point targets on finely interpolated slices, and errors against the reference
   image.

   Interpolation is separable, with a Kaiser-windowed sinc of 2 TAPS_HALF taps, whose error is below -80 dB for images
   that fill up to 85 % of the sampled band. In range the carrier exp(+j 4 pi fc r/c) has a period of millimetres, far
   below the range step, and is taken off first. */
#include "measure/metrics.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "data/echo_data.h"

#define TAPS_HALF        24   /* samples to either side */
#define KAISER_BETA      10.0 /* stop band of 100 dB */
#define FINE             12   /* fine samples an image step; doubled until ... */
#define WIDTH_SAMPLES    20   /* ... the -3 dB width has as many as this */
#define EXTENT_MAX_M     3.0
#define RASTER_TOLERANCE 1e-6 /* of a step: nearer counts as on the raster */
#define PIXEL_LOBE       2    /* pixels to either side of the peak (DEFINITION_PIXEL) */

/* --- Interpolation ------------------------------------------------------------------------------------------- */

/* Modified Bessel function of order 0 by its power series; the arguments are small. */
static double bessel_i0(double x)
{
    double sum = 1, term = 1;
    for (int k = 1; term > 1e-17 * sum; k++) {
        term *= (x / (2 * k)) * (x / (2 * k));
        sum += term;
    }
    return sum;
}

/* Weights of the samples base - TAPS_HALF + 1 .. base + TAPS_HALF for a place `fraction` of a step, in [0, 1), past
   sample `base`. On the raster that is the sample itself. */
static void taps_fill(double fraction, double taps[2 * TAPS_HALF])
{
    for (int k = 0; k < 2 * TAPS_HALF; k++) {
        double distance = k - TAPS_HALF + 1 - fraction, z = distance / TAPS_HALF;
        double sinc = distance == 0 ? 1 : sin(M_PI * distance) / (M_PI * distance);
        taps[k] = sinc * bessel_i0(KAISER_BETA * sqrt(1 - z * z)) / bessel_i0(KAISER_BETA);
        if (fraction == 0)
            taps[k] = distance == 0;
    }
}

/* How far from the raster, in steps, still counts as on it: coordinates far from 0 are rounded, which may be much of a fine
   step. A quarter of a step is never on the raster. */
static double raster_tolerance(double largest_m, double step)
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

/* The place of a target in the patch that serves it best. */
struct place {
    int patch;
    const struct grid *grid;
    double column, row; /* sample coordinates along x and r */
    double margin_m;    /* to the nearest edge of the patch */
};

static struct place place_find(const struct image *image, double x, double r)
{
    struct place best = {.patch = -1};
    for (int k = 0; k < image->patch_count; k++) {
        const struct grid *grid = &image->patches[k];
        double column = raster_place(x, grid->x_first, grid->x_step);
        double row = raster_place(r, grid->r_first, grid->r_step);
        double margin_x = grid->x_step * fmin(column, grid->x_count - 1 - column);
        double margin_r = grid->r_step * fmin(row, grid->r_count - 1 - row);
        double margin = fmin(margin_x, margin_r);
        if (margin >= 0 && (best.patch < 0 || margin > best.margin_m))
            best = (struct place){k, grid, column, row, margin};
    }
    return best;
}

/* Image column j at the fractional row of `place`, without the carrier's turn between the rows. */
static double complex column_interpolate(const struct image *image, const struct acquisition *acquisition,
                                         const struct place *place, int j)
{
    double base = floor(place->row), taps[2 * TAPS_HALF];
    double complex sum = 0;
    taps_fill(place->row - base, taps);
    for (int k = 0; k < 2 * TAPS_HALF; k++) {
        int i = (int)base - TAPS_HALF + 1 + k;
        if (i < 0 || i >= place->grid->r_count || taps[k] == 0)
            continue;
        double cycles = 2 * acquisition->fc * (i - place->row) * place->grid->r_step / acquisition->sound_speed;
        sum += taps[k] * cexp(-2 * M_PI * I * cycles) * image_pixel(image, place->patch, i, j);
    }
    return sum;
}

/* Image row i at the fractional column of `place`. */
static double complex row_interpolate(const struct image *image, const struct place *place, int i)
{
    double base = floor(place->column), taps[2 * TAPS_HALF];
    double complex sum = 0;
    taps_fill(place->column - base, taps);
    for (int k = 0; k < 2 * TAPS_HALF; k++) {
        int j = (int)base - TAPS_HALF + 1 + k;
        if (j >= 0 && j < place->grid->x_count && taps[k] != 0)
            sum += taps[k] * image_pixel(image, place->patch, i, j);
    }
    return sum;
}

double complex metrics_value(const struct image *image, const struct acquisition *acquisition, double x, double r)
{
    struct place place = place_find(image, x, r);
    if (place.patch < 0)
        return NAN;
    double base = floor(place.column), taps[2 * TAPS_HALF];
    double complex sum = 0;
    taps_fill(place.column - base, taps);
    for (int k = 0; k < 2 * TAPS_HALF; k++) {
        int j = (int)base - TAPS_HALF + 1 + k;
        if (j >= 0 && j < place.grid->x_count && taps[k] != 0)
            sum += taps[k] * column_interpolate(image, acquisition, &place, j);
    }
    return sum;
}

/* --- Measures of a slice ------------------------------------------------------------------------------------ */

static struct slice_metrics slice_undefined(void)
{
    return (struct slice_metrics){NAN, NAN, NAN, {NAN, NAN, NAN}, {NAN, NAN, NAN}, ""};
}

/* Piecewise linear between the samples. */
static double power_at(const double *power, int count, double index)
{
    int k = (int)fmin(floor(index), count - 2);
    return power[k] + (index - k) * (power[k + 1] - power[k]);
}

/* Trapezoid rule over [from, to]: of an interval that an edge cuts, the share that lies inside is counted. */
static double power_integral(const double *power, double from, double to)
{
    double sum = 0;
    for (int k = (int)floor(from); k < to; k++)
        sum += 0.5 * (power[k] + power[k + 1]) * (fmin(to, k + 1) - fmax(from, k));
    return sum;
}

/* Extremum of the parabola through samples k-1, k, k+1, of which k is the highest or the lowest. */
static double parabola_extremum(const double *power, int k, double *value)
{
    double slope = 0.5 * (power[k + 1] - power[k - 1]);
    double curvature = power[k + 1] - 2 * power[k] + power[k - 1];
    double shift = curvature == 0 ? 0 : fmax(-0.5, fmin(0.5, -slope / curvature));
    *value = power[k] + shift * (slope + 0.5 * shift * curvature);
    return k + shift;
}

/* First minimum on the way from sample `peak` in direction `way` (+-1), as a fractional index; NAN if the slice ends
   before the power rises again. */
static double minimum_find(const double *power, int count, int peak, int way)
{
    int k = peak + way;
    while (k > 0 && k < count - 1 && power[k + way] < power[k])
        k += way;
    double value;
    return k > 0 && k < count - 1 ? parabola_extremum(power, k, &value) : NAN;
}

/* Where the power first falls to `level` on the way from sample `peak`; NAN if it does not. */
static double crossing_find(const double *power, int count, int peak, int way, double level)
{
    int k = peak;
    while (k >= 0 && k < count && power[k] > level)
        k += way;
    if (k < 0 || k >= count || k == peak)
        return NAN;
    return k - way * (level - power[k]) / (power[k - way] - power[k]);
}

static int maximum_find(const double *power, int first, int last)
{
    int best = first;
    for (int k = first + 1; k <= last; k++)
        if (power[k] > power[best])
            best = k;
    return best;
}

/* Main lobe between two fractional indices: power outside over power inside. */
static double islr_of_lobe(const double *power, int count, double left, double right)
{
    double outside = power_integral(power, 0, left) + power_integral(power, right, count - 1);
    return 10 * log10(outside / power_integral(power, left, right));
}

/* The slice at the image's own pixels, target on a pixel: main lobe = the highest of them +-2, plain sums. */
static void pixel_measure(const double *power, int count, double target, double stride, double left, double right,
                          struct slice_metrics *metrics)
{
    int first = -(int)floor(target / stride + RASTER_TOLERANCE);
    int last = (int)floor((count - 1 - target) / stride + RASTER_TOLERANCE);
    double highest = 0, sidelobe = 0, inside = 0, outside = 0;
    int peak = first - 1;
    for (int k = first; k <= last; k++) {
        double index = fmax(0, fmin(count - 1, target + k * stride)), value = power_at(power, count, index);
        if (index > left && index < right && value > highest) {
            highest = value;
            peak = k;
        }
    }
    if (peak - PIXEL_LOBE <= first || peak + PIXEL_LOBE >= last) {
        snprintf(metrics->reason, sizeof metrics->reason, "no main lobe of %d pixels inside the slice",
                 2 * PIXEL_LOBE + 1);
        return;
    }
    for (int k = first; k <= last; k++) {
        double value = power_at(power, count, fmax(0, fmin(count - 1, target + k * stride)));
        if (abs(k - peak) <= PIXEL_LOBE) {
            inside += value;
        } else {
            outside += value;
            sidelobe = fmax(sidelobe, value);
        }
    }
    metrics->pslr_db[DEFINITION_PIXEL] = 10 * log10(sidelobe / highest);
    metrics->islr_db[DEFINITION_PIXEL] = 10 * log10(outside / inside);
}

/* The sample of the target's peak: the highest within two widths of the target, unless the slice has a stronger one
   elsewhere. The width is that of the slice's strongest lobe. -1 with a reason if there is none. */
static int peak_find(const double *power, int count, double first, double step, struct slice_metrics *metrics)
{
    int strongest = maximum_find(power, 0, count - 1), left = strongest, right = strongest;
    while (left > 0 && power[left - 1] > 0.5 * power[strongest])
        left--;
    while (right < count - 1 && power[right + 1] > 0.5 * power[strongest])
        right++;
    double reach = 2 * (right - left + 1), target = -first / step;
    int from = (int)fmax(0, ceil(target - reach)), to = (int)fmin(count - 1, floor(target + reach));
    int peak = from <= to ? maximum_find(power, from, to) : -1;
    /* Equal targets must not turn on rounding. */
    if (peak < 0 || power[strongest] > power[peak] * (1 + 1e-6)) {
        snprintf(metrics->reason, sizeof metrics->reason, "the strongest peak lies %+.4g m from the target",
                 first + strongest * step);
        return -1;
    }
    if (peak == 0 || peak == count - 1) {
        snprintf(metrics->reason, sizeof metrics->reason,
                 "the slice is strongest at its end, %+.4g m from the "
                 "target",
                 first + peak * step);
        return -1;
    }
    return peak;
}

struct slice_metrics metrics_of_power(const double *power, int count, double first, double step, double pixel_step)
{
    struct slice_metrics metrics = slice_undefined();
    double sum = 0;
    for (int k = 0; k < count; k++)
        sum += power[k];
    metrics.extent_m = fmax(0, fmin(-first, first + (count - 1) * step));
    if (count < 3 || !(sum > 0 && sum < INFINITY)) {
        snprintf(metrics.reason, sizeof metrics.reason, "%s",
                 count < 3  ? "the slice is shorter than 3 samples"
                 : sum == 0 ? "the slice is zero"
                            : "the slice is not finite");
        return metrics;
    }
    int peak = peak_find(power, count, first, step, &metrics);
    if (peak < 0)
        return metrics;
    double peak_power, peak_index = parabola_extremum(power, peak, &peak_power);
    double null_left = minimum_find(power, count, peak, -1), null_right = minimum_find(power, count, peak, +1);
    double half_left = crossing_find(power, count, peak, -1, 0.5 * peak_power);
    double half_right = crossing_find(power, count, peak, +1, 0.5 * peak_power);
    if (!(half_right - half_left > 0) || half_left < null_left || half_right > null_right) {
        snprintf(metrics.reason, sizeof metrics.reason, "the main lobe does not fall to half its peak");
        return metrics;
    }
    metrics.position_error_m = first + peak_index * step;
    metrics.width_m = (half_right - half_left) * step;
    if (!(null_right > null_left)) {
        snprintf(metrics.reason, sizeof metrics.reason,
                 "the main lobe has no first minimum on both sides within "
                 "%.4g m of the target",
                 metrics.extent_m);
        return metrics;
    }
    int left = maximum_find(power, 0, (int)floor(null_left));
    int right = maximum_find(power, (int)ceil(null_right), count - 1);
    int sidelobe = power[left] > power[right] ? left : right;
    if (sidelobe > 0 && sidelobe < count - 1) {
        double sidelobe_power;
        parabola_extremum(power, sidelobe, &sidelobe_power);
        metrics.pslr_db[DEFINITION_NULL] = 10 * log10(sidelobe_power / peak_power);
    } else {
        snprintf(metrics.reason, sizeof metrics.reason, "the largest sidelobe is cut by the slice's end at %+.4g m",
                 first + sidelobe * step);
    }
    metrics.islr_db[DEFINITION_NULL] = islr_of_lobe(power, count, null_left, null_right);
    metrics.islr_db[DEFINITION_3DB] = islr_of_lobe(power, count, half_left, half_right);
    if (!isfinite(metrics.islr_db[DEFINITION_NULL]) || isinf(metrics.pslr_db[DEFINITION_NULL])) {
        metrics.pslr_db[DEFINITION_NULL] = metrics.islr_db[DEFINITION_NULL] = metrics.islr_db[DEFINITION_3DB] = NAN;
        snprintf(metrics.reason, sizeof metrics.reason, "no power outside the main lobe");
        return metrics;
    }
    if (pixel_step > 0)
        pixel_measure(power, count, -first / step, pixel_step / step, null_left, null_right, &metrics);
    return metrics;
}

/* --- Slices of images ---------------------------------------------------------------------------------------- */

/* A line of image samples through a target, along one axis. */
struct line {
    double complex *samples; /* [count], malloc'ed; NULL without memory */
    int count;
    double step_m, target; /* the target as a sample coordinate */
};

static struct line line_extract(const struct image *image, const struct acquisition *acquisition,
                                const struct place *place, enum axis axis)
{
    const struct grid *grid = place->grid;
    struct line line = axis == AXIS_AZIMUTH ? (struct line){NULL, grid->x_count, grid->x_step, place->column}
                                            : (struct line){NULL, grid->r_count, grid->r_step, place->row};
    line.samples = malloc((size_t)line.count * sizeof *line.samples);
    if (!line.samples)
        return line;
    for (int k = 0; k < line.count; k++) {
        if (axis == AXIS_AZIMUTH) {
            line.samples[k] = column_interpolate(image, acquisition, place, k);
        } else {
            double cycles = 2 * acquisition->fc * (k - place->row) * grid->r_step / acquisition->sound_speed;
            line.samples[k] = cexp(-2 * M_PI * I * cycles) * row_interpolate(image, place, k);
        }
    }
    return line;
}

/* Share of the line's energy in the outer 5 % of its band, where a well sampled image has none. */
static double edge_energy(const struct line *line)
{
    int n = line->count;
    double total = 0, edge = 0;
    for (int k = 0; k < n; k++)
        total +=
            n * (creal(line->samples[k]) * creal(line->samples[k]) + cimag(line->samples[k]) * cimag(line->samples[k]));
    for (int bin = (int)ceil(0.475 * n); bin <= (int)floor(0.525 * n); bin++) {
        double complex sum = 0;
        for (int k = 0; k < n; k++)
            sum += line->samples[k] * cexp(-2 * M_PI * I * (double)((long long)bin * k % n) / n);
        edge += creal(sum) * creal(sum) + cimag(sum) * cimag(sum);
    }
    return total > 0 ? edge / total : 0;
}

/* Power at the places target + k step/fine, |k| <= half_count: there are `fine` different sets of taps. */
static double *line_refine(const struct line *line, int fine, int half_count)
{
    double *power = malloc((2 * (size_t)half_count + 1) * sizeof *power);
    for (int phase = 0; power && phase < fine; phase++) {
        double fraction = line->target - floor(line->target) + (double)phase / fine, taps[2 * TAPS_HALF];
        int base = (int)floor(line->target) + (fraction >= 1);
        taps_fill(fraction - (fraction >= 1), taps);
        int first = -((half_count + phase) / fine); /* smallest with first fine + phase >= -half_count */
        for (int whole = first; whole * fine + phase <= half_count; whole++) {
            double complex sum = 0;
            for (int k = 0; k < 2 * TAPS_HALF; k++) {
                int sample = base + whole - TAPS_HALF + 1 + k;
                if (sample >= 0 && sample < line->count)
                    sum += taps[k] * line->samples[sample];
            }
            power[half_count + whole * fine + phase] = creal(sum) * creal(sum) + cimag(sum) * cimag(sum);
        }
    }
    return power;
}

/* The fine slice as malloc'ed power samples at k times the fine step, |k| <= half_count; NULL with a reason. */
struct slice {
    double *power;
    int half_count;
    double image_step_m, step_m;
};

static struct slice slice_refine(const struct image *image, const struct acquisition *acquisition,
                                 const struct target *target, enum axis axis, int fine, struct slice_metrics *metrics)
{
    const char *axis_name = axis == AXIS_AZIMUTH ? "azimuth" : "range";
    struct slice slice = {0};
    struct place place = place_find(image, target->x, target->r);
    if (place.patch < 0) {
        snprintf(metrics->reason, sizeof metrics->reason, "no patch holds the target (%.6g, %.6g) m", target->x,
                 target->r);
        return slice;
    }
    /* Azimuth slices on a range row need nothing from the other rows. */
    double range_limit = acquisition->sound_speed / (2 * acquisition->bandwidth);
    if ((axis == AXIS_RANGE || place.row != floor(place.row)) && place.grid->r_step > range_limit * (1 + 1e-9)) {
        snprintf(metrics->reason, sizeof metrics->reason, "range step %.4g m too coarse, c/(2B) = %.4g m at most",
                 place.grid->r_step, range_limit);
        return slice;
    }
    struct line line = line_extract(image, acquisition, &place, axis);
    double reach = fmin(EXTENT_MAX_M / line.step_m, fmin(line.target, line.count - 1 - line.target));
    slice.half_count = (int)floor(reach * fine + RASTER_TOLERANCE);
    slice.image_step_m = line.step_m;
    slice.step_m = line.step_m / fine;
    if (!line.samples)
        snprintf(metrics->reason, sizeof metrics->reason, "no memory for the slice");
    else if (slice.half_count < fine)
        snprintf(metrics->reason, sizeof metrics->reason, "the %s slice is shorter than 3 samples", axis_name);
    else if (axis == AXIS_AZIMUTH && edge_energy(&line) > 1e-3)
        snprintf(metrics->reason, sizeof metrics->reason, "azimuth step %.4g m too coarse for the image's spectrum",
                 line.step_m);
    else if (!(slice.power = line_refine(&line, fine, slice.half_count)))
        snprintf(metrics->reason, sizeof metrics->reason, "no memory for the slice");
    free(line.samples);
    return slice;
}

struct slice_metrics metrics_slice(const struct image *image, const struct acquisition *acquisition,
                                   const struct target *target, enum axis axis)
{
    struct slice_metrics metrics = slice_undefined();
    bool too_coarse = true;
    for (int fine = FINE; too_coarse && fine <= 4 * FINE; fine *= 2) {
        struct slice slice = slice_refine(image, acquisition, target, axis, fine, &metrics);
        if (slice.power)
            metrics = metrics_of_power(slice.power, 2 * slice.half_count + 1, -slice.half_count * slice.step_m,
                                       slice.step_m, axis == AXIS_AZIMUTH ? slice.image_step_m : 0);
        too_coarse = metrics.width_m < WIDTH_SAMPLES * slice.step_m;
        free(slice.power);
    }
    return metrics;
}

void metrics_slice_samples(const struct image *image, const struct acquisition *acquisition,
                           const struct target *target, enum axis axis, double **position_m, double **power_db,
                           int *count)
{
    struct slice_metrics metrics = slice_undefined();
    struct slice slice = slice_refine(image, acquisition, target, axis, FINE, &metrics);
    double *power = slice.power;
    int samples = 2 * slice.half_count + 1;
    double peak = power ? power[maximum_find(power, 0, samples - 1)] : 0;
    double *position = peak > 0 && peak < INFINITY ? malloc((size_t)samples * sizeof *position) : NULL;
    *position_m = position;
    *power_db = position ? power : NULL;
    *count = position ? samples : 0;
    if (!position)
        free(power);
    for (int k = 0; k < *count; k++) {
        position[k] = (k - slice.half_count) * slice.step_m;
        power[k] = 10 * log10(fmax(power[k] / peak, 1e-20)); /* no -inf in a plot */
    }
}

/* --- Errors against the reference ---------------------------------------------------------------------------- */

/* Where a reference patch lies within the image. */
struct offset {
    int patch, row, column; /* patch -1: nowhere */
};

/* Offset of a run of `count` samples within one of `whole_count`, both uniform; -1 unless all of them coincide. */
static int raster_offset(double first, double step, int count, double whole_first, double whole_step, int whole_count)
{
    double begin = (first - whole_first) / whole_step, offset = round(begin);
    double stretch = (count - 1) * (step / whole_step - 1); /* by which the last sample is off, beside the first */
    double tolerance = raster_tolerance(fmax(fabs(first), fabs(whole_first)), whole_step);
    bool matches = fabs(begin - offset) <= tolerance && fabs(begin + stretch - offset) <= tolerance;
    return matches && offset >= 0 && offset + count <= whole_count ? (int)offset : -1;
}

static struct offset offset_find(const struct image *image, const struct grid *part)
{
    for (int k = 0; k < image->patch_count; k++) {
        const struct grid *whole = &image->patches[k];
        int column =
            raster_offset(part->x_first, part->x_step, part->x_count, whole->x_first, whole->x_step, whole->x_count);
        int row =
            raster_offset(part->r_first, part->r_step, part->r_count, whole->r_first, whole->r_step, whole->r_count);
        if (column >= 0 && row >= 0)
            return (struct offset){k, row, column};
    }
    return (struct offset){-1, 0, 0};
}

static double squared(double complex z)
{
    return creal(z) * creal(z) + cimag(z) * cimag(z);
}

/* The sums over all pixels that the errors are made of. The gain and the peak come from a first pass, so that small
   errors are summed directly and not as differences of large sums. */
struct error_sums {
    double image, reference, reference_peak; /* energies, and the largest |reference|^2 */
    double complex cross;                    /* sum of reference conj(image) */
    double error, error_gain, error_peak;    /* energies of the differences, and the largest of one */
    double phase, phase_weight;              /* squared phase errors, weighted, and the weights */
};

static void pair_add_first(struct error_sums *sums, double complex value, double complex wanted)
{
    sums->image += squared(value);
    sums->reference += squared(wanted);
    sums->reference_peak = fmax(sums->reference_peak, squared(wanted));
    sums->cross += wanted * conj(value);
}

static void pair_add_second(struct error_sums *sums, double complex value, double complex wanted)
{
    double complex gain = sums->image > 0 ? sums->cross / sums->image : 0;
    sums->error += squared(value - wanted);
    sums->error_gain += squared(gain * value - wanted);
    sums->error_peak = fmax(sums->error_peak, squared(value - wanted));
    if (squared(wanted) >= 0.01 * sums->reference_peak) {
        double phase = value == 0 ? NAN : carg(value * conj(wanted));
        sums->phase += squared(wanted) * phase * phase;
        sums->phase_weight += squared(wanted);
    }
}

struct error_metrics metrics_error(const struct image *image, const struct image *reference)
{
    struct error_metrics undefined = {NAN, NAN, NAN, NAN, "no errors: the exact image is zero"};
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
        .reason = isnan(sums.phase) ? "no phase error: strong pixels are zero" : "",
    };
}
