/* The layout of an omega-k image for a scene (wk_engine.h): the track, the conditions, the axes and the lengths of all
   transforms. All in double and independent of the echoes. */
#include <limits.h>

#include "common/fft_length.h"
#include "common/kaiser.h"
#include "common/pulse_band.h"
#include "wavenumber/wk_engine.h"

static const double PULSE_PERIODS = 8; /* of 1/B, beside the rows, so that no pulse wraps around */
static const double EVEN = 1e-12;      /* relative: columns that divide the period but for rounding */
static const double SAME_ANGLE = 1e-9; /* rad */
static const int tap_counts[] = {4, 6, 8, 12, 16};

/* Whole numbers of bins and cells: a value that is whole up to rounding, in any mode, counts as whole. */
static double whole_below(double x)
{
    return floor(x + 1e-9);
}

static double whole_above(double x)
{
    return ceil(x - 1e-9);
}

static double wavelength_longest(const struct wk *wk)
{
    const struct acquisition *a = wk->problem.acquisition;
    return a->sound_speed / (a->fc - a->bandwidth / 2);
}

/* Sines of the angles off broadside between which a beam of `half` (sine, about its axis) sees, and pings sample. */
static void angles_limit(const struct wk *wk, double half, double sine[2])
{
    double b = half < 1 ? asin(half) : M_PI, sampled = wavelength_longest(wk) / (4 * wk->spacing);
    double low = wk->squint - b > -M_PI / 2 ? sin(wk->squint - b) : -1;
    double high = wk->squint + b < M_PI / 2 ? sin(wk->squint + b) : 1;
    sine[0] = fmax(fmax(low, wk->slope - sampled), -WK_WIDEST_SINE);
    sine[1] = fmin(fmin(high, wk->slope + sampled), WK_WIDEST_SINE);
}

static enum status lay_track(struct wk *wk)
{
    const struct acquisition *a = wk->problem.acquisition;
    const struct straight_track *track = &wk->stretch.track; /* as wk_conditions requires */
    wk->sound_speed = a->sound_speed;
    wk->speed = track->speed;
    wk->fc = a->fc;
    wk->fs = a->fs;
    wk->t0 = a->t0[0];
    wk->samples = a->samples;
    wk->centre = a->samples / 2;
    wk->spacing = fabs(track->spacing);
    wk->reversed = track->spacing < 0;
    wk->squint = a->echo_squint;
    wk->slope = wk_centroid_slope(a, track);
    wk->angle = wk->method.rotates ? wk->squint : 0;
    /* Echoes reach out to the element's first null. */
    angles_limit(wk, a->tx_length > 0 ? wavelength_longest(wk) / a->tx_length : INFINITY, wk->sine);
    if (wk->stretch.cut) {
        stretch_cut(&wk->stretch, (const double[2]){tan(asin(wk->sine[0])), tan(asin(wk->sine[1]))}, 0);
        wk->problem = wk->stretch.problem;
    }
    wk->pings = wk->problem.acquisition->pings;
    wk->middle = wk->pings / 2;
    double first = track->x_first + (wk->reversed ? (wk->pings - 1) * track->spacing : 0);
    wk->x_middle = first + wk->middle * wk->spacing;
    wk->x_end[0] = first - wk->x_middle;
    wk->x_end[1] = first + (wk->pings - 1) * wk->spacing - wk->x_middle;
    return STATUS_OK;
}

/* ---- view ---- */

struct place {
    double x, r; /* m, in the track's axes, from x_middle */
};

/* Corner k of a grid, 0 to 3. */
static struct place grid_place(const struct wk *wk, const struct grid *g, int k)
{
    struct vector p = grid_point(g, k / 2 * (g->r_count - 1), k % 2 * (g->x_count - 1));
    return (struct place){p.x - wk->x_middle, p.y};
}

static struct place place_turned(struct place p, double angle)
{
    return (struct place){p.x * cos(angle) - p.r * sin(angle), p.x * sin(angle) + p.r * cos(angle)};
}

/* ---- range ---- */

static enum status lay_range(struct wk *wk)
{
    const struct acquisition *a = wk->problem.acquisition;
    struct pulse_band band;
    int pulse = a->compressed ? 0 : fft_length_fast((long long)a->samples + a->pulse_length - 1);
    enum status status = pulse_band_find(a, pulse, &band);
    if (status != STATUS_OK)
        return status;
    const double reach =
        fmax(-wk->x_end[0], wk->x_end[1]) * 2 * wk->fs / wk->sound_speed; /* samples, along the track */
    /* The echo of a point on the beam's axis at r' arrives after 2 (r' - X sin) (1 + beta sin)/(c (1 - beta^2)). */
    const double sine = sin(wk->angle), beta = wk->speed / wk->sound_speed;
    wk->drift = sine * (1 + beta * sine) / ((1 - beta) * (1 + beta));
    wk->record_pad = reach * fabs(wk->drift);
    double length = wk->samples + 2 * wk->record_pad;
    length = fmax(wk->oversampling * length, length + 4 * WK_GUARD); /* short records: a band of several kernels */
    wk->range_length = length < INT_MAX / 64 ? fft_length_fast((long long)whole_above(length)) : 0;
    if (wk->range_length == 0)
        return status_set(STATUS_UNSUPPORTED,
                          "%s: condition transform_length: the samples of a record with what the turned axes add are "
                          "%.3g; at most %d is needed (cure: shorter records or tracks, or back projection)",
                          wk->method.name, length, INT_MAX / 64);
    wk->weights_beside = (int)ceil(wk->record_pad) + 1;
    double half = fmin(whole_above(band.half_hz / wk->fs * wk->range_length), (wk->range_length - 1) / 2);
    double lowest = (wk->fc - wk->fs / 2 > 0 ? wk->fs / 2 : wk->fc * (1 - 1e-6)) / wk->fs * wk->range_length;
    wk->band_first = -(int)fmin(half, floor(lowest)); /* F > 0 */
    wk->band = (int)half - wk->band_first + 1;
    /* An odd number of pairs of the cache's lines, so that rows do not lie on top of each other in it. */
    int pair = 2 * WK_ALIGNMENT / (wk->problem.precision == PRECISION_DOUBLE ? 16 : 8);
    wk->row = ((wk->band + pair - 1) / pair | 1) * pair;
    return STATUS_OK;
}

static double band_edge(const struct wk *wk, int end)
{
    return wk->fc + (wk->band_first + end * (wk->band - 1)) * wk->fs / wk->range_length;
}

/* ---- azimuth ---- */

/* The edge of the pulse's band: lines beyond it, of flanks at the beam's own edge, are not laid out. */
static double pulse_edge(const struct wk *wk, int end)
{
    double half = wk->problem.acquisition->bandwidth / 2, edge = wk->fc + (end ? half : -half);
    return end ? fmin(edge, band_edge(wk, 1)) : fmax(edge, band_edge(wk, 0));
}

/* Tangents, in the own axes, of the angles with echoes. */
static void own_tangents(const struct wk *wk, double tangent[2])
{
    for (int k = 0; k < 2; k++)
        tangent[k] = tan(fmin(fmax(asin(wk->sine[k]) - wk->angle, -1.5), 1.5));
}

/* The extent of echoes along the own azimuth, at the own range r. */
static void own_extent(const struct wk *wk, double r, double extent[2])
{
    double tangent[2], cosine = cos(wk->angle), sine = sin(wk->angle);
    own_tangents(wk, tangent);
    extent[0] = INFINITY;
    extent[1] = -INFINITY;
    for (int k = 0; k < 2; k++)
        for (int end = 0; end < 2; end++) {
            double x = wk->x_end[end], at = x * cosine + (r - x * sine) * tangent[k];
            extent[0] = fmin(extent[0], at);
            extent[1] = fmax(extent[1], at);
        }
}

/* The shortest period of the own azimuth without echoes that wrap around onto a pixel. */
static double own_period(const struct wk *wk)
{
    double period = 0;
    for (int n = 0; n < wk->patch_count; n++) {
        const struct grid *g = &wk->patches[n].own;
        double first = g->x_first, last = first + (g->x_count - 1) * g->x_step;
        for (int k = 0; k < 2; k++) {
            double extent[2];
            own_extent(wk, g->r_first + k * (g->r_count - 1) * g->r_step, extent);
            /* A stretch ends so far from its window's columns that only these may not be wrapped onto. */
            period = fmax(period, wk->stretch.cut ? fmax(extent[1] - first, last - extent[0])
                                                  : fmax(extent[1], last) - fmin(extent[0], first));
        }
    }
    return period;
}

static enum status too_long(const struct wk *wk, double period)
{
    return status_set(STATUS_UNSUPPORTED,
                      "%s: condition transform_length: the pings %g m apart over %g m are too many to transform (cure: "
                      "a narrower beam, rows nearer to the track, or back projection)",
                      wk->method.name, wk->spacing, period);
}

/* Lines over all Kx of the pings: the centroid +- pi/spacing at each frequency. */
static enum status lay_unfolded(struct wk *wk)
{
    double half = M_PI / wk->spacing, low = INFINITY, high = -INFINITY, period = own_period(wk) / wk->spacing + 1;
    int length = period < 1e8 ? fft_length((long long)whole_above(fmax(period, wk->options.pad * wk->pings))) : 0;
    if (length == 0)
        return too_long(wk, period * wk->spacing);
    for (int end = 0; end < 2; end++) {
        double centroid = wk->slope * 4 * M_PI * pulse_edge(wk, end) / wk->sound_speed;
        low = fmin(low, centroid - half);
        high = fmax(high, centroid + half);
    }
    wk->kx_step = 2 * M_PI / (length * wk->spacing);
    wk->stuffed = 1;
    if (wk->options.unfold == WK_SUPPORT) {
        wk->line_first = (int)whole_below(low / wk->kx_step);
        wk->lines = (int)whole_below(high / wk->kx_step) - wk->line_first;
        wk->skips = true;
    } else {
        double reach = fmax(high, -low), slack = 1e-9 * half;
        if (wk->options.unfold == WK_BASEBAND) {
            reach = (high - low) / 2;
            wk->kx_base = (low + high) / 2;
        }
        wk->stuffed = (int)ceil((reach - slack) / half);
        if ((double)length * wk->stuffed > INT_MAX / 8)
            return too_long(wk, period * wk->spacing * wk->stuffed);
        wk->lines = length * wk->stuffed;
        wk->line_first = -(wk->lines / 2);
    }
    wk->azimuth_length = length * wk->stuffed;
    wk->kx_first = wk->kx_base + wk->line_first * wk->kx_step;
    return STATUS_OK;
}

/* Lines over Kx0 as far as |Kx - K_R slope| <= pi/spacing reaches, at the edges of the band; their spacing follows from
   the image's own period alone; the azimuth transform is padded for the interpolation. */
static enum status lay_rotated(struct wk *wk)
{
    double half = M_PI / wk->spacing, low = INFINITY, high = -INFINITY, period = own_period(wk);
    double padded = whole_above(wk->options.pad * wk->pings);
    int length = period / wk->spacing < 1e8 ? fft_length((long long)whole_above(period / wk->spacing) + 1) : 0;
    wk->azimuth_length = padded < INT_MAX / 8 ? fft_length_fast((long long)padded) : 0;
    if (length == 0 || wk->azimuth_length == 0)
        return too_long(wk, fmax(period, padded * wk->spacing));
    for (int k = 0; k < 4; k++) {
        double kr = 4 * M_PI * pulse_edge(wk, k % 2) / wk->sound_speed, kx = kr * wk->slope + (k / 2 ? half : -half);
        double ky = sqrt(fmax(kr * kr - kx * kx, 0)), kx0 = kx * cos(wk->angle) - ky * sin(wk->angle);
        low = fmin(low, kx0);
        high = fmax(high, kx0);
    }
    wk->stuffed = 1;
    wk->kx_step = 2 * M_PI / (length * wk->spacing);
    wk->line_first = (int)whole_below(low / wk->kx_step);
    wk->lines = (int)whole_above(high / wk->kx_step) - wk->line_first + 1;
    wk->kx_first = wk->line_first * wk->kx_step;
    wk->skips = true;
    return STATUS_OK;
}

/* ---- patches ---- */

/* The grid focused for a patch: the same pixels where its axes are the plan's; else a grid around it that samples the
   spectrum WK_OVERSAMPLING times. Steps of the latter need the lines: see lay_steps. */
static enum status lay_patches(struct wk *wk)
{
    wk->patch_count = wk->problem.patch_count;
    wk->patches = store_take(&wk->store, (size_t)wk->patch_count, sizeof *wk->patches, 0);
    if (!wk->patches)
        return status_set(STATUS_FAILED, "no memory for %d patches", wk->patch_count);
    for (int n = 0; n < wk->patch_count; n++) {
        struct wk_patch *patch = &wk->patches[n];
        const struct grid *g = &wk->problem.patches[n];
        patch->grid = patch->own = *g;
        patch->resampled = fabs(g->angle_rad - wk->angle) > SAME_ANGLE;
        patch->own.angle_rad = wk->angle;
        if (!patch->resampled) {
            patch->own.x_first -= wk->x_middle * cos(wk->angle);
            patch->own.r_first -= wk->x_middle * sin(wk->angle);
            continue;
        }
        struct place low = {INFINITY, INFINITY}, high = {-INFINITY, -INFINITY};
        for (int k = 0; k < 4; k++) {
            struct place p = place_turned(grid_place(wk, g, k), wk->angle);
            low = (struct place){fmin(low.x, p.x), fmin(low.r, p.r)};
            high = (struct place){fmax(high.x, p.x), fmax(high.r, p.r)};
        }
        patch->own.x_first = low.x;
        patch->own.r_first = low.r;
        patch->own.x_count = patch->own.r_count = 2;
        patch->own.x_step = high.x - low.x;
        patch->own.r_step = high.r - low.r;
    }
    return STATUS_OK;
}

/* One axis of a resampled patch: from `first` over `extent`, `span` rad/m of wavenumbers, and the kernel's reach. */
static enum status resampled_axis(const struct wk *wk, double span, double *first, double *step, int *count)
{
    double extent = *step;
    *step = 2 * M_PI / (WK_OVERSAMPLING * span);
    double beside = wk->taps / 2 + 1, points = whole_above(extent / *step) + 2 * beside + 1;
    if (!(points < 1e8))
        return status_set(
            STATUS_UNSUPPORTED,
            "%s: condition transform_length: the places %g m apart over %g m to resample from are %.3g; at "
            "most 1e8 is needed (cure: a smaller patch, or back projection)",
            wk->method.name, *step, extent, points);
    *first -= beside * *step;
    *count = (int)points;
    return STATUS_OK;
}

static enum status lay_steps(struct wk *wk)
{
    /* Ky at the ends of the band, over all lines. */
    double low = INFINITY, high = -INFINITY, kx_last = wk->kx_first + (wk->lines - 1) * wk->kx_step;
    for (int k = 0; k < 6; k++) {
        double kx = k / 2 == 0 ? wk->kx_first : k / 2 == 1 ? kx_last : fmin(fmax(0, wk->kx_first), kx_last);
        double ky = wk_ky(wk, band_edge(wk, k % 2), kx);
        low = fmin(low, isfinite(ky) ? ky : 0);
        high = fmax(high, isfinite(ky) ? ky : 0);
    }
    double c = wk->sound_speed, bin = c / (2 * wk->fs), tangent[2], aside = wk->record_pad * bin;
    own_tangents(wk, tangent);
    double steepest = fmax(fabs(tangent[0]), fabs(tangent[1])), moving = 1 + 2 * fabs(wk->speed) / c;
    double nearest = tangent[0] * tangent[1] < 0 ? 1 : hypot(1, fmin(fabs(tangent[0]), fabs(tangent[1])));
    double record[2] = {fmax(wk->t0, 0) * c / 2 / moving, (wk->t0 + (wk->samples - 1) / wk->fs) * c / 2 * moving};
    double from = record[0] / hypot(1, steepest) - aside, to = record[1] / nearest + aside;
    double pulse = fmin(PULSE_PERIODS / wk->problem.acquisition->bandwidth, wk->samples / wk->fs) * c / 2;
    for (int n = 0; n < wk->patch_count; n++) {
        struct wk_patch *patch = &wk->patches[n];
        struct grid *g = &patch->own;
        if (patch->resampled) {
            enum status status = resampled_axis(wk, kx_last - wk->kx_first, &g->x_first, &g->x_step, &g->x_count);
            if (status == STATUS_OK)
                status = resampled_axis(wk, high - low, &g->r_first, &g->r_step, &g->r_count);
            if (status != STATUS_OK)
                return status;
            patch->kx_carrier = (wk->kx_first + kx_last) / 2;
        } else if (g->r_count == 1) {
            g->r_step = bin;
        }
        double first = g->r_first, last = first + (g->r_count - 1) * g->r_step;
        double extent = fmax(last - from, to - first) + 2 * pulse,
               rows = fmax(whole_above(extent / g->r_step), g->r_count);
        double window = (wk->range_length - wk->samples / 2.0 - wk->record_pad) / wk->fs * c / 2;
        double centre = (wk->t0 + wk->centre / wk->fs) * c / 2;
        if (!(first > centre - window && last * hypot(1, steepest) < centre + window))
            return status_set(STATUS_UNSUPPORTED,
                              "%s: condition in_record: rows from %g to %g m lie too far outside the record's %g to %g "
                              "m (cure: rows within it)",
                              wk->method.name, patch->grid.r_first,
                              patch->grid.r_first + (patch->grid.r_count - 1) * patch->grid.r_step, record[0],
                              record[1]);
        patch->length = rows < 1e8 ? fft_length_fast((long long)rows) : 0;
        double period = 2 * M_PI / wk->kx_step / g->x_step, whole = floor(period + 0.5);
        patch->folds = fabs(period - whole) <= EVEN * whole && whole >= g->x_count && whole <= INT_MAX
                       && fft_length((long long)whole) == whole;
        patch->columns = patch->folds ? (int)whole : fft_length_fast((long long)wk->lines + g->x_count - 1);
        if (patch->length == 0 || patch->columns == 0)
            return status_set(STATUS_UNSUPPORTED,
                              "%s: condition transform_length: the rows %g m apart over %g m are %.3g; at most 1e8 is "
                              "needed (cure: rows farther apart, or back projection)",
                              wk->method.name, g->r_step, extent, rows);
        if (patch->resampled)
            patch->bin_carrier = (long long)whole_below((low + high) / 2 / (2 * M_PI / (patch->length * g->r_step)));
        patch->row = wk->rows;
        wk->rows += (size_t)g->r_count;
    }
    return STATUS_OK;
}

enum status wk_period(const struct wk *wk, double *period)
{
    struct wk along = *wk; /* as if it did not turn */
    along.method.rotates = false;
    along.store = (struct store){0};
    lay_track(&along);
    const enum status status = lay_patches(&along);
    if (status == STATUS_OK)
        *period = fmax(whole_above(own_period(&along) / along.spacing + 1), along.pings);
    store_release(&along.store);
    return status;
}

enum status wk_layout(struct wk *wk)
{
    static enum status (*const steps[])(struct wk *) = {lay_track, lay_range, lay_patches};
    enum status status = STATUS_OK;
    wk->taps = tap_counts[wk->options.taps];
    wk->oversampling = wk->taps == 8 ? WK_OVERSAMPLING_LEAST : WK_OVERSAMPLING;
    for (size_t k = 0; status == STATUS_OK && k < sizeof steps / sizeof *steps; k++)
        status = steps[k](wk);
    if (status == STATUS_OK)
        status = wk->angle != 0 ? lay_rotated(wk) : lay_unfolded(wk);
    if (status == STATUS_OK)
        status = lay_steps(wk);
    wk->line_stride = ((size_t)(wk->lines + WK_TILE - 1) / WK_TILE | 1) * WK_TILE;
    const double padded = wk->pings > 0 ? (double)wk->azimuth_length / wk->pings : 1, windowed = !wk->options.window;
    wk->range_kernel = (struct wk_kernel){wk->taps, windowed * kaiser_shape(wk->taps, wk->oversampling), NULL};
    wk->azimuth_kernel = (struct wk_kernel){wk->taps, windowed * kaiser_shape(wk->taps, fmax(padded, 1.0)), NULL};
    return status;
}
