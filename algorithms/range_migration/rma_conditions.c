/* The conditions of range migration (rma_conditions.h). Limits are measured, over several hundred scenes whose images
   were compared with exact ones (docs/range_migration.md). */
#include "range_migration/rma_conditions.h"

#include <math.h>
#include <string.h>

#include "range_migration/delay_compensation.h"

static const double SLOWEST = 0.1; /* 1 - |v|/c that spectra need */
static const double ERROR_LIMIT = 0.1, PROMISE = 0.12;
static const double LAW_LIMIT = 0.1;                       /* rad: the image's error is about that of its phases */
static const double TERMS_LIMIT = 0.05, TAPS_LIMIT = 0.05; /* relative L2: half the limit of the predicted error */
static const double WIDEST_SINE = 0.95; /* of the aperture where neither sampling nor element length bounds it */
static const double ECHO_ZONES = 4;     /* Fresnel zones beyond the echoes' own sine, over which their spectrum fades */
static const double FRESNEL_ZONES = 6;  /* of azimuth_guard */

struct rma_method rma_choose(const struct rma_method *method, const struct rma_options *options)
{
    static const int tap_counts[] = {8, 12, 16, 24};
    struct rma_method chosen = *method;
    if (chosen.spectrum == spectrum_lbf_corrected && options->variant == RMA_PRINTED)
        chosen.spectrum = spectrum_lbf_printed;
    chosen.terms = options->terms;
    chosen.taps = options->terms > 0 ? tap_counts[options->taps] : 0;
    return chosen;
}

double rma_promise(const void *options)
{
    (void)options;
    return PROMISE;
}

/* Offset of the receiver that is n/2 of the way from the least to the greatest. */
static double offset_at(const struct rma_view *view, int n)
{
    return condition_offset(view->problem->acquisition, n);
}

double rma_widest_sine(const struct acquisition *a)
{
    double lowest = fmax(a->fc - a->bandwidth / 2, 1e-9 * a->fc);
    if (!(a->tx_length > 0))
        return WIDEST_SINE;
    return fmin(WIDEST_SINE, fmax(a->sound_speed / lowest / a->tx_length, a->echo_tapers ? 0 : a->echo_sine));
}

static struct rma_bounds bounds_of(const struct rma_view *view)
{
    struct rma_bounds bounds = {0};
    const struct acquisition *a = view->problem->acquisition;
    /* A band that reaches 0 Hz has a condition of its own, which refuses it. */
    double lowest = fmax(a->fc - a->bandwidth / 2, 1e-9 * a->fc), nearest = INFINITY, farthest = 0;
    bounds.aside = fmax(fabs(offset_at(view, 0)), fabs(offset_at(view, 2)));
    /* nu of the full rate, as an angle at the lowest frequency of the pulse. */
    bounds.sine = a->sound_speed * a->receivers / view->spacing / 4 / lowest;
    bounds.sine = fmin(bounds.sine, rma_widest_sine(a));
    for (int k = 0; k < view->problem->patch_count; k++) {
        const struct grid *g = &view->problem->patches[k];
        double last = g->x_first + (g->x_count - 1) * g->x_step;
        bounds.way = fmax(bounds.way, fmax(last - view->x_low, view->x_high - g->x_first));
        nearest = fmin(nearest, g->r_first);
        farthest = fmax(farthest, g->r_first + (g->r_count - 1) * g->r_step);
    }
    if (view->method->terms > 0 && a->echo_sine > 0 && a->echo_tapers) /* a sharp edge fades too slowly */
        bounds.sine = fmin(bounds.sine, a->echo_sine + ECHO_ZONES * sqrt(a->sound_speed / lowest / (2 * nearest)));
    /* A record that contains the echoes of the widest angle needs no other bound. */
    double tangent = bounds.sine / sqrt(1 - bounds.sine * bounds.sine);
    if (2 * farthest * (hypot(1, tangent) - 1) / a->sound_speed * a->fs <= a->samples)
        bounds.way = INFINITY;
    return bounds;
}

struct rma_view rma_view_of(const struct problem *problem, const struct rma_method *method,
                            const struct straight_track *track)
{
    const struct acquisition *a = problem->acquisition;
    double end = track->x_first + (a->pings - 1) * track->spacing;
    struct rma_view view = {
        .problem = problem,
        .method = method,
        .spacing = fabs(track->spacing),
        .setting = {a->sound_speed, track->speed, a->fc, a->rx[a->receivers / 2].x - a->tx[0].x},
        .converts = a->receivers > 1 || fabs(a->rx[0].x - a->tx[0].x) > a->sound_speed / a->fc / 1000,
        .x_low = fmin(track->x_first, end),
        .x_high = fmax(track->x_first, end),
        .beam_sine = condition_beam_sine(a),
    };
    view.bounds = bounds_of(&view);
    return view;
}

double azimuth_guard(const struct acquisition *acquisition, double r)
{
    const double wavelength = acquisition->sound_speed / (acquisition->fc - acquisition->bandwidth / 2);
    return FRESNEL_ZONES * sqrt(wavelength * r / 2);
}

double rma_reach(const struct acquisition *acquisition, const struct rma_bounds *bounds, double r)
{
    double track = bounds->way + azimuth_guard(acquisition, r);
    return fmin(r * bounds->sine / sqrt(1 - bounds->sine * bounds->sine), track);
}

double rma_focused(const struct acquisition *acquisition, const struct rma_bounds *bounds, double r)
{
    return rma_reach(acquisition, bounds, r) + bounds->aside / 2;
}

/* The transmitter's places that echo a row at range r of a patch, from its columns: [*low, *high] m ahead of the pixel.
   False where there are none. */
static bool rma_view_aperture(const struct rma_view *view, const struct grid *patch, double r, double *low,
                              double *high)
{
    double sine = view->beam_sine, reach = sine < 1 ? r * sine / sqrt((1 - sine) * (1 + sine)) : INFINITY;
    double last = patch->x_first + (patch->x_count - 1) * patch->x_step;
    *low = fmax(view->x_low - last, -reach);
    *high = fmin(view->x_high - patch->x_first, reach);
    return *low <= *high;
}

/* Worst over the first and the last row of each patch, as far as they are seen. */
typedef double row_function(const struct rma_view *view, double r, double low, double high);

static double worst_row(const struct rma_view *view, row_function *function)
{
    double worst = 0, low, high;
    for (int k = 0; k < view->problem->patch_count; k++) {
        const struct grid *patch = &view->problem->patches[k];
        for (int end = 0; end < 2; end++) {
            double r = patch->r_first + end * (patch->r_count - 1) * patch->r_step;
            double value = rma_view_aperture(view, patch, r, &low, &high) ? function(view, r, low, high) : 0;
            worst = condition_worse(worst, value);
        }
    }
    return worst;
}

static double stationary_at(const struct rma_view *view, double r, double low, double high)
{
    const struct acquisition *a = view->problem->acquisition;
    double wavelength = a->sound_speed / (a->fc - a->bandwidth / 2), u = fmax(fabs(low), fabs(high));
    return wavelength / (32 * M_PI * r) * hypot(1, u / r);
}

static struct condition stationary(const struct rma_view *view)
{
    return condition_most(SEVERITY_REFUSE, "stationary", worst_row(view, stationary_at), 0.01,
                          "the first term that stationary phase drops, lambda/(32 pi r cos theta)",
                          "rows farther away, or a higher frequency");
}

static double amplitude_at(const struct rma_view *view, double r, double low, double high)
{
    (void)low;
    (void)high;
    double d = fmax(fabs(offset_at(view, 0)), fabs(offset_at(view, 2))) / (2 * r);
    return pow(1 + d * d, 0.75) - 1;
}

static struct condition spa_amplitude(const struct rma_view *view)
{
    return condition_most(SEVERITY_REFUSE, "spa_amplitude", worst_row(view, amplitude_at), 0.05,
                          "the amplitude error of a monostatic weight, (1 + (d/2r)^2)^.75 - 1",
                          "rows farther away, or receivers nearer to the transmitter");
}

/* Root mean square phase error of the method's formula over the beam, the band and the array. */
static double formula_at(const struct rma_view *view, double r, double low, double high)
{
    enum { PLACES = 16, FREQUENCIES = 3, RECEIVERS = 3 };
    const struct acquisition *a = view->problem->acquisition;
    double sum = 0, weights = 0;
    for (int m = 0; m < RECEIVERS; m++)
        for (int k = 0; k < PLACES; k++)
            for (int n = 0; n < FREQUENCIES; n++) {
                double d = offset_at(view, m), u = low + (k + 0.5) / PLACES * (high - low);
                double frequency = a->fc + (n - 1) * a->bandwidth / 2;
                double nu = -frequency * spectrum_slope(&view->setting, d, r, u);
                double exact = -2 * M_PI * (frequency * spectrum_delay(&view->setting, d, r, u) + nu * u);
                double error = view->method->spectrum(&view->setting, d, r, frequency, nu) - exact;
                double sine = u / hypot(u, r) * frequency / a->sound_speed;
                double weight = a->echo_tapers
                                    ? pow(condition_sinc(a->tx_length * sine) * condition_sinc(a->rx_length * sine), 2)
                                    : 1;
                sum += weight * error * error;
                weights += weight;
            }
    return sqrt(sum / weights);
}

static struct condition formula(const struct rma_view *view)
{
    bool exact = view->method->spectrum == spectrum_exact || !view->converts;
    double off = exact ? 0 : worst_row(view, formula_at);
    return condition_most(SEVERITY_WARN, view->method->law,
                          isnan(off) ? INFINITY : off, /* the formula ends inside the beam */
                          LAW_LIMIT, "the formula's phase error over the beam (rad, rms)",
                          "rma_numeric, which has no such error; rows farther away or nearer, a narrower beam or a "
                          "lower speed");
}

struct condition rma_predicted_error(const struct rma_view *view)
{
    double error = prediction_error(view);
    struct condition condition =
        condition_most(error <= view->method->error_limit ? SEVERITY_WARN : SEVERITY_REFUSE, "predicted_error", error,
                       ERROR_LIMIT, "the error predicted for azimuth slices through point targets (relative L2)",
                       "more pings in the beam, columns within the track, pings closer together, or rows "
                       "farther away");
    condition_beam_named(view->problem->acquisition, &condition);
    return condition;
}

bool azimuth_requirements(const struct problem *problem, struct condition *list, int *count,
                          struct straight_track *track)
{
    const struct acquisition *a = problem->acquisition;
    const struct condition *first = list + *count;
    double nearest = INFINITY;
    for (int k = 0; k < problem->patch_count; k++)
        for (int corner = 0; corner < 4; corner++) {
            const struct grid *g = &problem->patches[k];
            nearest = fmin(nearest, grid_point(g, corner / 2 * (g->r_count - 1), corner % 2 * (g->x_count - 1)).y);
        }
    list[(*count)++] = condition_least(SEVERITY_REFUSE, "above_dc", a->fc - a->bandwidth / 2, 0,
                                       "the lowest frequency fc - B/2 (Hz)", "a higher carrier or a narrower band");
    list[(*count)++] =
        condition_most(SEVERITY_REFUSE, "uniform_track", acquisition_unevenness(a, track) * a->fc / a->sound_speed,
                       ACQUISITION_UNEVEN_MOST,
                       "how far pings, receivers and starts of record lie off a uniform straight track along x "
                       "(wavelengths)",
                       "back projection, or motion compensation by the filter 'monostatic |' ahead of it");
    list[(*count)++] = condition_least(SEVERITY_REFUSE, "pings", a->pings, 1,
                                       "the number of pings (one has no azimuth spectrum)", "back projection");
    /* A limit at the edge of the echoes' own beam leaves out only pairs without an echo of the pixel. */
    double whole = fmin(1, a->echo_sine > 0 ? a->echo_sine : 1);
    list[(*count)++] = condition_least(SEVERITY_REFUSE, "whole_aperture", a->aperture_limit, nextafter(whole, 0),
                                       "the scene's aperture_limit (a sine; an azimuth transform cannot choose "
                                       "pings pixel by pixel)",
                                       "back projection, or a limit beyond the echoes' beam");
    list[(*count)++] = condition_least(SEVERITY_REFUSE, "in_front", nearest, 0, "the range r of the nearest pixel (m)",
                                       "pixels at r > 0");
    for (; first < list + *count; first++)
        if (!condition_holds(first))
            return false;
    return true;
}

/* Further conditions of delay compensation (delay_compensation.h). */
static int delay_conditions(const struct rma_view *view, struct condition *list, int count)
{
    const double error = view->converts ? delay_taps_error(view->problem->acquisition, 1, view->method->taps, 0.5) : 0;
    list[count++] = condition_most(SEVERITY_REFUSE, "delay_terms", delay_terms_left(view, view->method->terms),
                                   TERMS_LIMIT, "the phase error that the terms over the receivers leave (relative L2)",
                                   "more terms, rows farther away, a shorter array or a narrower beam");
    list[count++] = condition_most(SEVERITY_REFUSE, "delay_taps", error, TAPS_LIMIT,
                                   "the error of a delay by half a sample (relative L2 of the pulse)",
                                   "more taps, or a higher sampling rate");
    return count;
}

/* The predicted error, and its possible cause. */
static int prediction_conditions(const struct rma_view *view, const struct straight_track *track, struct condition *all,
                                 int count)
{
    struct condition causes[] = {condition_doppler(view->problem, track->spacing), formula(view)};
    struct condition error = rma_predicted_error(view);
    if (view->problem->acquisition->receivers > 1)
        all[count++] = condition_ghost(view->problem->acquisition, track->spacing);
    all[count++] = spa_amplitude(view);
    bool named = !condition_holds(&all[count - 1]);
    for (size_t k = 0; k < sizeof causes / sizeof *causes; k++) {
        causes[k].severity = error.severity;
        named = named || !condition_holds(&causes[k]);
        all[count++] = causes[k];
    }
    if (error.severity == SEVERITY_WARN || !named || isnan(error.value))
        all[count++] = error;
    return count;
}

/* Limits of range migration: no wavenumbers about another centre than 0, and no axes other than the track's. */
static bool along_track(const struct problem *problem, struct condition *all, int *count)
{
    const double squint = fabs(problem->acquisition->echo_squint) * 180 / M_PI;
    double turned = 0;
    for (int k = 0; k < problem->patch_count; k++)
        turned = fmax(turned, fabs(problem->patches[k].angle_rad) * 180 / M_PI);
    if (squint > 0)
        all[(*count)++] = condition_most(SEVERITY_REFUSE, "squint", squint, 0, "the beam's squint (degrees)",
                                         "wk_classic, wk_squint");
    if (turned > 0)
        all[(*count)++] = condition_most(SEVERITY_REFUSE, "axes", turned, 0, "the angle of the image's axes (degrees)",
                                         "axes along the track");
    return squint == 0 && turned == 0;
}

/* Conditions without a prediction. False where one of them is not met. */
static bool requirements(const struct problem *problem, struct condition all[CONDITIONS_MAX], int *count,
                         struct straight_track *track)
{
    *count = conditions_general(problem, all, CONDITIONS_MAX);
    all[0].limit = SLOWEST;
    return along_track(problem, all, count) && azimuth_requirements(problem, all, count, track)
           && condition_holds(&all[0]);
}

enum status rma_requirements_check(const struct problem *problem, const char *method)
{
    struct straight_track track;
    struct condition all[CONDITIONS_MAX];
    int count;
    requirements(problem, all, &count, &track);
    return conditions_check(method, all, count);
}

int rma_conditions(const struct problem *problem, const void *given, const void *options, struct condition *list,
                   int room)
{
    const struct rma_method method = rma_choose(given, options);
    struct straight_track track;
    struct condition all[CONDITIONS_MAX];
    int count;
    if (requirements(problem, all, &count, &track)) {
        struct rma_view view = rma_view_of(problem, &method, &track);
        all[count++] = stationary(&view);
        if (condition_holds(&all[count - 1]))
            count = prediction_conditions(&view, &track, all, count);
        if (method.terms > 0)
            count = delay_conditions(&view, all, count);
        if (conditions_accept(all, count))
            all[count++] = ghosts_condition(problem, &track);
    }
    for (int k = 0; k < count && k < room; k++)
        list[k] = all[k];
    return count < room ? count : room;
}

enum status rma_conditions_check(const char *method, const struct condition *list, int count)
{
    static const char *const computed[] = {"predicted_error", "delay_terms", "delay_taps"};
    for (int k = 0; k < 3 * count; k++)
        if (strcmp(list[k / 3].name, computed[k % 3]) == 0 && isnan(list[k / 3].value))
            return status_set(STATUS_FAILED, "%s: no memory to predict the image's error", method);
    return conditions_check(method, list, count);
}
