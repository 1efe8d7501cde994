/* Azimuth and range slices through point targets, interpolated finely (metrics.h). */
#include <complex.h> /* before fftw3.h, which then uses C's complex numbers */
#include <fftw3.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "metrics/interpolation.h"
#include "metrics/lobes.h"

#define FINE          12 /* fine samples an image step; doubled until ... */
#define WIDTH_SAMPLES 20 /* ... the -3 dB width has as many as this */
#define EXTENT_MAX_M  3.0

/* A line of image samples through a target, along one axis. */
struct line {
    double complex *samples; /* [count], malloc'ed; NULL when there is no slice */
    int count;
    double step_m, target; /* the target as a sample coordinate */
};

/* Share of the line's energy in the outer 5 % of its band, where a well sampled image has none. Negative without
   memory. */
static double edge_energy(const struct line *line)
{
    const int n = line->count;
    double total = 0, edge = 0;
    double complex *spectrum = fftw_malloc((size_t)n * sizeof *spectrum);
    if (!spectrum)
        return -1;
    fftw_plan plan = fftw_plan_dft_1d(n, spectrum, spectrum, FFTW_FORWARD, FFTW_ESTIMATE);
    if (!plan) {
        fftw_free(spectrum);
        return -1;
    }
    memcpy(spectrum, line->samples, (size_t)n * sizeof *spectrum);
    fftw_execute(plan);
    fftw_destroy_plan(plan);
    for (int k = 0; k < n; k++)
        total +=
            n * (creal(line->samples[k]) * creal(line->samples[k]) + cimag(line->samples[k]) * cimag(line->samples[k]));
    for (int bin = (int)ceil(0.475 * n); bin <= (int)floor(0.525 * n); bin++)
        edge += creal(spectrum[bin]) * creal(spectrum[bin]) + cimag(spectrum[bin]) * cimag(spectrum[bin]);
    fftw_free(spectrum);
    return total > 0 ? edge / total : 0;
}

/* Fine samples to either side of the target: 3 m, or to the nearer end of the line. */
static int slice_reach(const struct line *line, int fine)
{
    double reach = fmin(EXTENT_MAX_M / line->step_m, fmin(line->target, line->count - 1 - line->target));
    return (int)fmin(floor(reach * fine + RASTER_TOLERANCE), INT_MAX / 4);
}

/* Power at the places target + k step/fine, |k| <= half_count, from `fine` sets of taps. */
static double *line_refine(const struct line *line, int fine, int half_count)
{
    size_t bytes = (2 * (size_t)half_count + 1) * sizeof(double);
    double *power = memory_check((double)bytes, "the slice") == STATUS_OK ? malloc(bytes) : NULL;
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

/* The line through a target for its slice; without a line no samples, but the reason. */
static struct line line_extract(const struct image *image, const struct acquisition *acquisition,
                                const struct target *target, enum axis axis, char *reason, size_t size)
{
    struct place place = place_find(image, target->x, target->r);
    if (place.patch < 0) {
        snprintf(reason, size, "no patch holds the target (%.6g, %.6g) m", target->x, target->r);
        return (struct line){0};
    }
    const struct grid *grid = place.grid;
    struct line line = axis == AXIS_AZIMUTH ? (struct line){NULL, grid->x_count, grid->x_step, place.column}
                                            : (struct line){NULL, grid->r_count, grid->r_step, place.row};
    /* Azimuth slices on a range row do not use the other rows. */
    double range_limit = acquisition->sound_speed / (2 * acquisition->bandwidth);
    if ((axis == AXIS_RANGE || place.row != floor(place.row)) && grid->r_step > range_limit * (1 + 1e-9)) {
        snprintf(reason, size, "range step %.4g m too coarse, c/(2B) = %.4g m at most", grid->r_step, range_limit);
        return line;
    }
    if (slice_reach(&line, FINE) < FINE) {
        snprintf(reason, size, "the %s slice is shorter than 3 samples", axis == AXIS_AZIMUTH ? "azimuth" : "range");
        return line;
    }
    const double bytes = (double)line.count * sizeof *line.samples; /* with its transform, three times as much */
    if (memory_check(3 * bytes, "the slice") == STATUS_OK)
        line.samples = malloc((size_t)line.count * sizeof *line.samples);
    if (!line.samples) {
        snprintf(reason, size, "no memory for a slice of %d samples, %.3g MB", line.count, bytes / 1e6);
        return line;
    }
    if (axis == AXIS_RANGE) {
        rows_interpolate(image, acquisition, &place, line.samples);
        return line;
    }
    columns_interpolate(image, acquisition, &place, 0, line.count, line.samples);
    double edge = edge_energy(&line);
    if (edge > 1e-3)
        snprintf(reason, size, "azimuth step %.4g m too coarse for the image's spectrum", line.step_m);
    else if (edge < 0)
        snprintf(reason, size, "no memory for the spectrum of %d samples, %.3g MB", line.count, bytes / 1e6);
    if (*reason) {
        free(line.samples);
        line.samples = NULL;
    }
    return line;
}

struct slice_metrics metrics_slice(const struct image *image, const struct acquisition *acquisition,
                                   const struct target *target, enum axis axis)
{
    struct slice_metrics metrics = slice_undefined();
    struct line line = line_extract(image, acquisition, target, axis, metrics.reason, sizeof metrics.reason);
    bool too_coarse = line.samples != NULL;
    for (int fine = FINE; too_coarse && fine <= 4 * FINE; fine *= 2) {
        int half_count = slice_reach(&line, fine);
        double *power = line_refine(&line, fine, half_count), step_m = line.step_m / fine;
        if (power)
            metrics = metrics_of_power(power, 2 * half_count + 1, -half_count * step_m, step_m,
                                       axis == AXIS_AZIMUTH ? line.step_m : 0);
        else
            snprintf(metrics.reason, sizeof metrics.reason, "no memory for a slice of %d fine samples, %.3g MB",
                     2 * half_count + 1, (2e-6 * half_count + 1e-6) * sizeof *power);
        too_coarse = power && metrics.width_m < WIDTH_SAMPLES * step_m;
        free(power);
    }
    free(line.samples);
    return metrics;
}

void metrics_slice_samples(const struct image *image, const struct acquisition *acquisition,
                           const struct target *target, enum axis axis, double **position_m, double **power_db,
                           int *count)
{
    char reason[160] = "";
    struct line line = line_extract(image, acquisition, target, axis, reason, sizeof reason);
    int half_count = line.samples ? slice_reach(&line, FINE) : 0, samples = 2 * half_count + 1;
    double *power = line.samples ? line_refine(&line, FINE, half_count) : NULL;
    double peak = power ? power[maximum_find(power, 0, samples - 1)] : 0;
    double *position = peak > 0 && peak < INFINITY ? malloc((size_t)samples * sizeof *position) : NULL;
    free(line.samples);
    *position_m = position;
    *power_db = position ? power : NULL;
    *count = position ? samples : 0;
    if (!position)
        free(power);
    for (int k = 0; k < *count; k++) {
        position[k] = (k - half_count) * (line.step_m / FINE);
        power[k] = 10 * log10(fmax(power[k] / peak, 1e-20)); /* no -inf in a plot */
    }
}

double *metrics_slice_difference(const struct image *image, const struct image *reference,
                                 const struct acquisition *acquisition, const struct target *target, enum axis axis,
                                 int count)
{
    char reason[160] = "";
    struct line line = line_extract(image, acquisition, target, axis, reason, sizeof reason);
    struct line exact = line_extract(reference, acquisition, target, axis, reason, sizeof reason);
    const bool fit = line.samples && exact.samples && line.count == exact.count && line.target == exact.target;
    const int half_count = fit ? slice_reach(&line, FINE) : 0;
    double *power = NULL, *wanted = NULL;
    if (fit && count == 2 * half_count + 1) {
        wanted = line_refine(&exact, FINE, half_count);
        for (int k = 0; k < line.count; k++)
            line.samples[k] -= exact.samples[k];
        power = line_refine(&line, FINE, half_count);
    }
    const double peak = wanted ? wanted[maximum_find(wanted, 0, count - 1)] : 0;
    for (int k = 0; power && k < count; k++)
        power[k] = peak > 0 ? 10 * log10(fmax(power[k] / peak, 1e-20)) : NAN;
    free(line.samples);
    free(exact.samples);
    free(wanted);
    return power;
}
