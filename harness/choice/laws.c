/* Candidates before any image (laws.h). */
#include "choice/laws.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "backprojection/factorised/factorised.h"
#include "backprojection/pairs/omission.h"
#include "backprojection/pairs/pairs.h"
#include "choice/candidates.h"
#include "choice/rates.h"

/* Of the budget, the share of interpolated delays. If theirs is more, they are made more exact, by a phase limit (rad)
   of this share of the budget. */
static const double DELAYS_MOST = 0.4, PHASE_SHARE = 0.8;
/* An aperture limit is examined if it leaves at most this share of a candidate's time. */
static const double LIMIT_PAYS = 0.95;
/* Of the budget, the share of a setting with a parameter `error`; delays and rounding have the rest. */
static const double BUDGETED = 0.9;
/* Of the budget, the error by law that the stand-in for the exact image may have. */
static const double EXACT = 0.1;
/* s: the time to count images of subapertures, and all range migrations; a filter, and each recorded value that it
   reads. A candidate is counted where the fastest takes longer. */
static const double COUNT_IMAGES = 0.05, COUNT_MIGRATIONS = 0.005, COUNT_FILTER = 0.1, COUNT_VALUE = 1.2e-7;

enum status laws_refused(struct candidate *candidate, enum status status)
{
    if (status != STATUS_UNSUPPORTED)
        return status;
    candidate->verdict = CANDIDATE_REFUSED;
    candidate->seconds = candidate->error = INFINITY;
    snprintf(candidate->reason, sizeof candidate->reason, "%s", status_message());
    return STATUS_OK;
}

void laws_compare(const struct setting *setting, struct candidate *candidate)
{
    candidate->error = forecast_error(&candidate->forecast) * (candidate->forecast.sums_pairs ? setting->ratio : 1);
    candidate->verdict = CANDIDATE_SLOWER;
    *candidate->reason = '\0';
    if (candidate->error <= setting->budget->error)
        return;
    candidate->verdict = CANDIDATE_ERROR;
    snprintf(candidate->reason, sizeof candidate->reason, "error %.2g is over the budget of %.2g, most of it %s",
             candidate->error, setting->budget->error, cause_names[forecast_cause(&candidate->forecast)]);
}

static enum status sums_fill(const struct setting *setting, struct candidate *candidate)
{
    enum status status = STATUS_OK;
    const struct forecast *f = &candidate->forecast;
    struct problem problem = *setting->problem;
    struct acquisition limited = *problem.acquisition;
    candidate->pairs = setting->pairs;
    if (candidate->sine < 1) {
        limited.aperture_limit = candidate->sine;
        problem.acquisition = &limited;
        candidate->pairs = pairs_estimate(&problem);
        status = candidate->pairs >= 0 ? STATUS_OK : STATUS_FAILED;
    }
    if (f->image_cost > 0)
        candidate->pairs = f->image_pairs;
    candidate->flops = candidate->pairs * f->pair_flops + f->image_flops + f->record_flops + f->kernel_flops;
    candidate->seconds = rates_run(rates_sums(rates_get(), f, problem.precision, candidate->pairs));
    return status;
}

/* Its work, a back projection's with delays as exact as the budget needs them, and the part of its error that follows
   from its settings alone; the rest is unknown. */
static enum status candidate_count(const struct setting *setting, struct candidate *candidate)
{
    const struct algorithm *algorithm = candidate->algorithm;
    const struct problem *problem = setting->problem;
    struct forecast *f = &candidate->forecast;
    char limit[16];
    snprintf(limit, sizeof limit, "%.1e", PHASE_SHARE * setting->budget->error);
    enum status status = algorithm_cost(algorithm, problem, candidate->options, f);
    if (status == STATUS_OK && f->sums_pairs && f->error[CAUSE_DELAYS] > DELAYS_MOST * setting->budget->error
        && candidate_set(candidate, "phase_limit", limit))
        status = algorithm_cost(algorithm, problem, candidate->options, f);
    if (status == STATUS_OK) {
        laws_compare(setting, candidate);
        if (algorithm->errors && (f->sums_pairs || candidate->verdict == CANDIDATE_SLOWER)) {
            candidate->verdict = CANDIDATE_SLOWER;
            candidate->error = INFINITY;
        }
        if (f->sums_pairs) {
            status = sums_fill(setting, candidate);
        } else {
            candidate->pairs = 0;
            candidate->flops = f->migration_flops;
            candidate->seconds = rates_run(rates_migration(rates_get(), f, problem->precision));
        }
    }
    return laws_refused(candidate, status);
}

bool laws_sums(const struct candidate *candidate)
{
    return candidate->algorithm->traits & TRAIT_APERTURE_LIMIT && !candidate->budgeted;
}

bool laws_counted(const struct candidate *candidate)
{
    return candidate->verdict != CANDIDATE_SLOWER || !isnan(candidate->flops);
}

struct candidate *laws_next(struct choice *choice)
{
    struct candidate *best = NULL, *more = NULL;
    for (int k = 0; k < choice->count; k++) {
        struct candidate *c = &choice->list[k];
        const bool waits = k > 0 && c[-1].family == c->family && c[-1].verdict == CANDIDATE_SLOWER;
        if (c->verdict != CANDIDATE_SLOWER || waits)
            continue;
        if (!laws_counted(c) && (!more || c->count_s < more->count_s))
            more = c;
        if (laws_counted(c) && (!best || c->seconds < best->seconds))
            best = c;
    }
    const bool pays = more && best && best->seconds > fmax(more->count_s, more->seconds)
                      && (best->forecast.sums_pairs || !more->budgeted);
    return best && !pays ? best : more;
}

/* ---- an aperture limit ---- */

/* Of the pings of an image's middle, the share that a sine limit keeps. */
static double share_kept(const struct problem *problem, double sine)
{
    const struct acquisition *a = problem->acquisition;
    const struct grid *g = &problem->patches[problem->patch_count / 2];
    const struct vector pixel = grid_point(g, (g->r_count - 1) / 2.0, (g->x_count - 1) / 2.0);
    double all = 0, kept = 0;
    for (int p = 0; p < a->pings; p++) {
        const double x = a->tx[p].x - pixel.x, at = fabs(x) / hypot(x, hypot(a->tx[p].y - pixel.y, a->tx[p].z));
        all += at <= a->aperture_limit;
        kept += at <= fmin(sine, a->aperture_limit);
    }
    return all > 0 ? kept / all : 1;
}

/* The least sine that an error leaves room for, rounded up to three digits. */
static double sine_of(const struct problem *problem, double error)
{
    const double sine = aperture_least(problem, error);
    const double unit = sine < 1 ? pow(10, floor(log10(sine)) - 2) : 1;
    return fmin(ceil(sine / unit) * unit, 1);
}

/* What is left of the budget beside a candidate's own error. */
static double error_left(const struct setting *setting, const struct candidate *candidate)
{
    return sqrt(fmax(pow(setting->budget->error, 2) - pow(candidate->error, 2), 0));
}

enum status laws_limit(const struct setting *setting, struct choice *choice, const struct candidate *fastest)
{
    const struct problem *problem = setting->problem;
    const double most = share_kept(problem, sine_of(problem, setting->budget->error));
    struct candidate *from = NULL;
    double least = LIMIT_PAYS * fastest->seconds, sine = 1;
    for (int k = 0; k < choice->count; k++) {
        struct candidate *c = &choice->list[k];
        if (c->verdict != CANDIDATE_SLOWER || !laws_sums(c) || !(most < LIMIT_PAYS))
            continue;
        const enum status status = laws_complete(setting, c);
        if (status != STATUS_OK)
            return status;
        const double own = c->verdict == CANDIDATE_SLOWER ? sine_of(problem, error_left(setting, c)) : 1;
        const double seconds = own < 1 ? c->seconds * share_kept(problem, own) : INFINITY;
        if (seconds < least) {
            least = seconds;
            from = c;
            sine = own;
        }
    }
    if (!from || choice->count == CANDIDATES_MAX)
        return STATUS_OK;
    struct candidate *limited = &choice->list[choice->count];
    char text[16];
    *limited = *from;
    limited->sine = sine;
    snprintf(text, sizeof text, "%.3g", sine);
    if (!candidate_set(limited, "aperture", text))
        return STATUS_OK;
    choice->count++;
    return candidate_count(setting, limited);
}

/* ---- one after the other ---- */

bool laws_open(const struct candidate *candidate)
{
    return candidate->verdict == CANDIDATE_SLOWER && !(candidate->error < INFINITY);
}

/* Set the parameter `error` of a candidate that has it. */
static bool budgeted_set(const struct setting *setting, struct candidate *c)
{
    if (*c->settings || candidate_set_error(c, BUDGETED * setting->budget->error / fmax(setting->ratio, 1)))
        return true;
    c->verdict = CANDIDATE_ERROR;
    snprintf(c->reason, sizeof c->reason, "accepts no error as small as the budget of %.2g", setting->budget->error);
    return false;
}

enum status laws_count(const struct setting *setting, struct candidate *c)
{
    return !c->budgeted || budgeted_set(setting, c) ? candidate_count(setting, c) : STATUS_OK;
}

enum status laws_complete(const struct setting *setting, struct candidate *c)
{
    enum status status = laws_counted(c) ? STATUS_OK : laws_count(setting, c);
    if (status != STATUS_OK || !laws_open(c))
        return status;
    status = algorithm_errors(c->algorithm, setting->problem, c->options, &c->forecast);
    if (status == STATUS_OK)
        laws_compare(setting, c);
    return laws_refused(c, status);
}

static double count_time(const struct setting *setting, const struct candidate *c)
{
    const struct acquisition *a = setting->problem->acquisition;
    if (c->algorithm->traits & TRAIT_FILTERED)
        return COUNT_FILTER + COUNT_VALUE * a->pings * a->receivers * a->samples;
    return c->budgeted ? COUNT_IMAGES : laws_sums(c) ? 0 : COUNT_MIGRATIONS;
}

enum status laws_fill(struct setting *setting, struct choice *choice)
{
    const int all = candidates_fill(setting->problem->acquisition, choice->list);
    struct candidate *first = &choice->list[0];
    enum status status = STATUS_OK;
    setting->ratio = 1;
    setting->pairs = pairs_estimate(setting->problem);
    if (!(setting->pairs >= 0))
        return STATUS_FAILED;
    for (int k = 0; k < all && status == STATUS_OK; k++) {
        struct candidate *c = &choice->list[choice->count];
        *c = choice->list[k];
        if (setting->budget->windows && !(c->algorithm->traits & TRAIT_WINDOW))
            continue;
        /* Without tables all are of the general engine, whatever the setting. */
        if (k > 0 && !first->forecast.tables && strstr(c->settings, "engine=general"))
            continue;
        c->sine = 1;
        c->verdict = CANDIDATE_SLOWER;
        c->error = INFINITY;
        c->seconds = 0;
        c->count_s = count_time(setting, c);
        c->flops = c->pairs = c->bytes = NAN;
        if (k == 0)
            status = laws_count(setting, c);
        if (c->budgeted) { /* a lower bound: every back projection reads as much */
            const struct forecast images = {.image_cost = factorised_least(setting->problem, setting->pairs),
                                            .record_flops = first->forecast.record_flops,
                                            .slowness = first->forecast.slowness,
                                            .record_values = first->forecast.record_values};
            c->seconds = rates_run(rates_sums(rates_get(), &images, setting->problem->precision, 0));
        }
        choice->count++;
    }
    return status;
}

enum status laws_without_tables(const struct setting *setting, const struct candidate *from, struct choice *choice)
{
    if (!from->forecast.tables || choice->count == CANDIDATES_MAX)
        return STATUS_OK;
    struct candidate *general = &choice->list[choice->count];
    *general = *from;
    general->measured = (struct probe_error){.pixels = 0};
    if (!candidate_set(general, "engine", "general"))
        return STATUS_OK;
    choice->count++;
    return candidate_count(setting, general);
}

/* In the general engine, by every delay: few pixels pay neither for tables nor for what stands for delays. */
enum status laws_exact(const struct setting *setting, bool dark, struct spec *spec, double *error)
{
    const double most = EXACT * setting->budget->error, asked = 0.9 * most, least = 1e-8;
    char text[64];
    struct forecast forecast;
    snprintf(text, sizeof text, "bp_farrow:exact=true,error=%.3e", asked);
    *error = 0;
    if (!dark && asked >= least) {
        const enum status status = spec_parse(text, spec);
        if (status != STATUS_OK)
            return status;
        spec->precision = setting->problem->precision;
        if (algorithm_forecast(spec->algorithm, setting->problem, spec->options, &forecast) == STATUS_OK
            && forecast_error(&forecast) <= most) {
            *error = forecast_error(&forecast);
            return STATUS_OK;
        }
        spec_free(spec);
    }
    return spec_parse("reference:precision=double", spec);
}
