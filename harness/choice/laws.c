/* Candidates before any image (laws.h). Forecasts of back projections are cheap and made of all. The work of range
   migration is counted, which is cheap as well; the error of its spectrum costs as much as a plan. */
#include "choice/laws.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "backprojection/factorised/factorised.h"
#include "backprojection/pairs/omission.h"
#include "backprojection/pairs/pairs.h"
#include "choice/candidates.h"
#include "choice/rates.h"

/* Of the budget, what interpolated delays may take: where that is more, they are made more exact, by a phase limit
   (rad) of this share of the budget. */
static const double DELAYS_MOST = 0.4, PHASE_SHARE = 0.8;
/* Of a candidate's time, what an aperture limit leaves at most, where it is looked at. */
static const double LIMIT_PAYS = 0.95;
/* Of the budget, what a setting takes that is called by its error: delays and rounding have the rest. */
static const double BUDGETED = 0.9;

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
        candidate->pairs = pairs_count(&problem);
        status = candidate->pairs >= 0 ? STATUS_OK : STATUS_FAILED;
    }
    if (f->image_cost > 0)
        candidate->pairs = f->image_pairs;
    candidate->flops = candidate->pairs * f->pair_flops + f->image_flops + f->record_flops + f->kernel_flops;
    candidate->seconds = rates_sums(f, problem.precision, candidate->pairs);
    return status;
}

/* Of a back projection, with delays as exact as the budget needs them. */
static enum status sums_forecast(const struct setting *setting, struct candidate *candidate)
{
    const struct algorithm *algorithm = candidate->algorithm;
    const struct problem *problem = setting->problem;
    char limit[16];
    snprintf(limit, sizeof limit, "%.1e", PHASE_SHARE * setting->budget->error);
    enum status status = algorithm_forecast(algorithm, problem, candidate->options, &candidate->forecast);
    if (status == STATUS_OK && candidate->forecast.sums_pairs
        && candidate->forecast.error[CAUSE_DELAYS] > DELAYS_MOST * setting->budget->error
        && candidate_set(candidate, "phase_limit", limit))
        status = algorithm_forecast(algorithm, problem, candidate->options, &candidate->forecast);
    if (status == STATUS_OK) {
        laws_compare(setting, candidate);
        status = sums_fill(setting, candidate);
    }
    return laws_refused(candidate, status);
}

/* Its work, and the errors of its settings; what its spectrum makes of the image is not known. */
static enum status migration_count(const struct setting *setting, struct candidate *candidate)
{
    const struct problem *problem = setting->problem;
    enum status status = algorithm_cost(candidate->algorithm, problem, candidate->options, &candidate->forecast);
    if (status == STATUS_OK) {
        laws_compare(setting, candidate);
        if (candidate->verdict == CANDIDATE_SLOWER)
            candidate->error = INFINITY;
        candidate->pairs = 0;
        candidate->flops = candidate->forecast.migration_flops;
        candidate->seconds = rates_migration(&candidate->forecast, problem->precision);
    }
    return laws_refused(candidate, status);
}

struct candidate *laws_fastest(struct choice *choice, bool costly)
{
    struct candidate *best = NULL;
    for (int k = 0; k < choice->count; k++) {
        struct candidate *c = &choice->list[k];
        if (c->looked_at && c->verdict == CANDIDATE_SLOWER && (costly || !(c->budgeted && laws_open(c)))
            && (!best || c->seconds < best->seconds))
            best = c;
    }
    return best;
}

/* The time of the fastest whose error is known to be within the budget; INFINITY without one. */
static double fastest_known(const struct choice *choice)
{
    double least = INFINITY;
    for (int k = 0; k < choice->count; k++)
        if (choice->list[k].looked_at && choice->list[k].verdict == CANDIDATE_SLOWER
            && choice->list[k].error < INFINITY)
            least = fmin(least, choice->list[k].seconds);
    return least;
}

/* ---- an aperture limit ---- */

/* The share of the pings that a sine keeps, of those that an image's middle has. */
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

/* The least sine that an error leaves room for; a little more, so that its three digits say it. */
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

/* One candidate more: whichever is the fastest with as small an aperture as its error leaves room for. */
static enum status limit_try(const struct setting *setting, struct choice *choice)
{
    const struct problem *problem = setting->problem;
    const double most = share_kept(problem, sine_of(problem, setting->budget->error));
    const struct candidate *from = NULL;
    double least = LIMIT_PAYS * fastest_known(choice), sine = 1;
    for (int k = 0; k < choice->count; k++) {
        const struct candidate *c = &choice->list[k];
        if (!c->looked_at || c->verdict != CANDIDATE_SLOWER || !c->forecast.sums_pairs || !(most * c->seconds < least))
            continue;
        const double own = sine_of(problem, error_left(setting, c));
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
    return sums_forecast(setting, limited);
}

/* ---- range migration, and images of subapertures ---- */

bool laws_open(const struct candidate *candidate)
{
    return (candidate->budgeted || candidate->algorithm->cost) && candidate->verdict == CANDIDATE_SLOWER
           && !(candidate->error < INFINITY);
}

static enum status factorised_complete(const struct setting *setting, struct candidate *c)
{
    if (*c->settings || candidate_set_error(c, BUDGETED * setting->budget->error / fmax(setting->ratio, 1)))
        return sums_forecast(setting, c);
    c->verdict = CANDIDATE_ERROR;
    snprintf(c->reason, sizeof c->reason, "accepts no error as small as the budget of %.2g", setting->budget->error);
    return STATUS_OK;
}

enum status laws_complete(const struct setting *setting, struct candidate *c)
{
    if (c->budgeted)
        return factorised_complete(setting, c);
    enum status status = algorithm_forecast(c->algorithm, setting->problem, c->options, &c->forecast);
    if (status == STATUS_OK)
        laws_compare(setting, c);
    return laws_refused(c, status);
}

static enum status candidate_begin(const struct setting *setting, struct candidate *c)
{
    struct forecast images = {.image_cost = setting->reads};
    c->looked_at = true;
    c->sine = 1;
    c->verdict = CANDIDATE_SLOWER;
    c->error = c->seconds = INFINITY; /* numbers, for they are compared, which of a NAN would raise FE_INVALID */
    c->flops = c->pairs = c->bytes = NAN;
    if (c->algorithm->cost)
        return migration_count(setting, c);
    if (!c->budgeted)
        return sums_forecast(setting, c);
    images.record_flops = setting->records.record_flops;
    images.slowness = setting->records.slowness;
    images.record_values = setting->records.record_values;
    c->seconds = rates_sums(&images, setting->problem->precision, 0); /* a lower bound */
    return STATUS_OK;
}

/* No others of its family are worth a look: they are slower, and this one is exact enough. */
static bool family_done(const struct setting *setting, const struct candidate *last)
{
    return last->forecast.sums_pairs && last->error <= LAWS_EXACT * setting->budget->error;
}

enum status laws_extend(struct setting *setting, struct choice *choice)
{
    const struct candidate *last = NULL; /* that was looked at */
    enum status status = STATUS_OK;
    bool tables = false; /* else all are of the general engine, whether a setting says so or not */
    for (int k = 0; k < choice->count && status == STATUS_OK; k++) {
        struct candidate *c = &choice->list[k];
        if (k == 1)
            setting->records = choice->list[0].forecast; /* every back projection reads as much */
        const bool done = last && last->family == c->family && family_done(setting, last);
        if (!c->looked_at && !done && (tables || !strstr(c->settings, "engine=general")))
            status = candidate_begin(setting, c);
        if (c->looked_at)
            last = c;
        tables = tables || c->forecast.tables;
    }
    return status;
}

enum status laws_fill(struct setting *setting, struct choice *choice)
{
    setting->ratio = 1;
    setting->pairs = pairs_count(setting->problem);
    if (!(setting->pairs >= 0))
        return STATUS_FAILED;
    setting->reads = factorised_least(setting->problem, setting->pairs);
    choice->count = candidates_fill(choice->list);
    const enum status status = laws_extend(setting, choice);
    return status == STATUS_OK ? limit_try(setting, choice) : status;
}

bool laws_without_tables(const struct setting *setting, const struct candidate *from, struct choice *choice,
                         enum status *status)
{
    if (!from->forecast.tables || choice->count == CANDIDATES_MAX)
        return false;
    struct candidate *general = &choice->list[choice->count];
    *general = *from;
    general->measured = (struct probe_error){.pixels = 0};
    if (!candidate_set(general, "engine", "general"))
        return false;
    choice->count++;
    *status = sums_forecast(setting, general);
    return true;
}
