/* Main lobe, sidelobes and widths of a finished slice: PSLR, ISLR (metrics.h). */
#include "metrics/lobes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "metrics/interpolation.h"

#define RISE       1e-3 /* of the power at a minimum */
#define PIXEL_LOBE 2    /* pixels to either side of the peak (DEFINITION_PIXEL) */

struct slice_metrics slice_undefined(void)
{
    return (struct slice_metrics){NAN, NAN, NAN, {NAN, NAN, NAN}, {NAN, NAN, NAN}, ""};
}

/* Piecewise linear between the samples. */
static double power_at(const double *power, int count, double index)
{
    int k = (int)fmin(floor(index), count - 2);
    return power[k] + (index - k) * (power[k + 1] - power[k]);
}

/* Trapezoid rule over [from, to]; an interval cut by an edge counts by its share inside. */
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
   before the power rises again. Densely sampled power goes up and down by the interpolation's error: a rise below
   RISE does not count. */
static double minimum_find(const double *power, int count, int peak, int way)
{
    int lowest = peak, k = peak + way;
    for (; k >= 0 && k < count && power[lowest] > 0 && power[k] <= (1 + RISE) * power[lowest]; k += way)
        if (power[k] < power[lowest])
            lowest = k;
    double value;
    return k >= 0 && k < count ? parabola_extremum(power, lowest, &value) : NAN;
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

int maximum_find(const double *power, int first, int last)
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

/* The slice at the pixels' spacing, with a sample on the target: main lobe = the highest pixel +-2, plain sums. */
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
    /* Rounding must not decide between equal targets. */
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
