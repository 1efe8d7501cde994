/* Choosing among candidates (planner.h). Back projections are forecast first: their forecasts are cheap. The work of
   range migration is counted, which is cheap as well; its error, and images of subapertures, are forecast only where
   they would be faster than the fastest that is within the budget. */
#include "planner/planner.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/factorised/factorised.h"
#include "backprojection/pairs/omission.h"
#include "backprojection/pairs/pairs.h"
#include "planner/candidates.h"
#include "planner/known.h"
#include "planner/process.h"
#include "planner/rates.h"

/* Forecasts are means over scenes: what is planned with lies above. */
static const double MARGIN = 1.12;
/* Of the budget, what interpolated delays may take: where that is more, they are made more exact, by a phase limit
   (rad) of this share of the budget. */
static const double DELAYS_MOST = 0.4, PHASE_SHARE = 0.8;
/* Of a candidate's time, what an aperture limit leaves at most, where it is looked at. */
static const double LIMIT_PAYS = 0.95;
/* Of the budget over the margin, what a setting takes that is called by its error: delays and rounding have the
   rest. */
static const double BUDGETED = 0.99;

/* What all candidates of a problem share. */
struct setting {
    const struct known *known;
    const struct problem *problem; /* as it is given: plans outlive what is known of it */
    const struct budget *budget;
    double pairs; /* of back projection */
    double reads; /* pairs that images of subapertures cannot do without */
};

void candidate_name(const struct candidate *candidate, char text[CANDIDATE_NAME])
{
    snprintf(text, CANDIDATE_NAME, "%s%s%s", candidate->algorithm->name, *candidate->settings ? ":" : "",
             candidate->settings);
}

/* Of back projection. */
static enum status pairs_of(const struct problem *problem, double *pairs)
{
    *pairs = pairs_count(problem);
    return *pairs >= 0 ? STATUS_OK : STATUS_FAILED;
}

/* What a law may say where an error is allowed, which is planned with above it. */
static double law_most(const struct setting *setting, double error)
{
    return error / (MARGIN * setting->known->coarse);
}

/* Over the budget, or not. */
static void judge(const struct setting *setting, struct candidate *candidate)
{
    candidate->error = MARGIN * forecast_error(&candidate->forecast);
    candidate->verdict = VERDICT_SLOWER;
    if (candidate->error <= setting->budget->error)
        return;
    candidate->verdict = VERDICT_ERROR;
    snprintf(candidate->reason, sizeof candidate->reason, "error %.2g is over the budget of %.2g, most of it %s",
             candidate->error, setting->budget->error, cause_names[forecast_cause(&candidate->forecast)]);
}

/* One that is refused says why, and that is no error. */
static enum status refused(struct candidate *candidate, enum status status)
{
    if (status != STATUS_UNSUPPORTED)
        return status;
    candidate->verdict = VERDICT_REFUSED;
    candidate->seconds = candidate->error = INFINITY;
    snprintf(candidate->reason, sizeof candidate->reason, "%s", status_message());
    return STATUS_OK;
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
        status = pairs_of(&problem, &candidate->pairs);
    }
    if (f->image_cost > 0)
        candidate->pairs = f->image_pairs;
    candidate->flops = candidate->pairs * f->pair_flops + f->image_flops + f->record_flops + f->kernel_flops;
    candidate->seconds = rates_sums(f, problem.precision, candidate->pairs);
    return status;
}

/* The forecast, with delays as exact as the budget needs them. */
static enum status forecast_make(const struct setting *setting, struct candidate *candidate)
{
    const struct algorithm *algorithm = candidate->algorithm;
    char limit[16];
    snprintf(limit, sizeof limit, "%.1e", PHASE_SHARE * setting->budget->error / setting->known->coarse);
    enum status status = known_forecast(setting->known, algorithm, candidate->options, &candidate->forecast);
    if (status == STATUS_OK && candidate->forecast.sums_pairs
        && MARGIN * candidate->forecast.error[CAUSE_DELAYS] > DELAYS_MOST * setting->budget->error
        && candidate_set(candidate, "phase_limit", limit))
        status = known_forecast(setting->known, algorithm, candidate->options, &candidate->forecast);
    return status;
}

static enum status candidate_forecast(const struct setting *setting, struct candidate *candidate)
{
    enum status status = forecast_make(setting, candidate);
    if (status == STATUS_OK) {
        judge(setting, candidate);
        status = sums_fill(setting, candidate);
    }
    return refused(candidate, status);
}

/* What a range migration takes, which its forecast does not say. */
static enum status migration_cost(const struct setting *setting, struct candidate *candidate)
{
    const struct problem *problem = setting->problem;
    enum status status = algorithm_cost(candidate->algorithm, problem, candidate->options, &candidate->forecast);
    if (status == STATUS_OK) {
        candidate->pairs = 0;
        candidate->flops = candidate->forecast.migration_flops;
        candidate->seconds = rates_migration(&candidate->forecast, problem->precision);
    }
    return refused(candidate, status);
}

static enum status migration_forecast(const struct setting *setting, struct candidate *candidate)
{
    struct forecast forecast;
    enum status status = known_forecast(setting->known, candidate->algorithm, candidate->options, &forecast);
    if (status == STATUS_OK) {
        memcpy(candidate->forecast.error, forecast.error, sizeof forecast.error);
        judge(setting, candidate);
    }
    return refused(candidate, status);
}

/* The time of the fastest candidate within the budget; INFINITY without one. */
static double fastest(const struct choice *choice)
{
    double least = INFINITY;
    for (int k = 0; k < choice->count; k++)
        if (choice->list[k].verdict == VERDICT_SLOWER && choice->list[k].error < INFINITY)
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
    return law_most(setting, sqrt(fmax(pow(setting->budget->error, 2) - pow(candidate->error, 2), 0)));
}

/* One candidate more: whichever is the fastest with as small an aperture as its error leaves room for. */
static enum status limit_try(const struct setting *setting, struct choice *choice)
{
    const struct problem *problem = setting->problem;
    const double most = share_kept(problem, sine_of(problem, law_most(setting, setting->budget->error)));
    const struct candidate *from = NULL;
    double least = LIMIT_PAYS * fastest(choice), sine = 1;
    for (int k = 0; k < choice->count; k++) {
        const struct candidate *c = &choice->list[k];
        if (c->verdict != VERDICT_SLOWER || !c->forecast.sums_pairs || !(most * c->seconds < least))
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
    return candidate_forecast(setting, limited);
}

/* ---- range migration, and images of subapertures ---- */

/* Whether another setting of the algorithm is over the budget by what all its settings have: its spectrum's error. */
static bool spectrum_fails(const struct setting *setting, const struct choice *choice,
                           const struct candidate *candidate)
{
    for (int k = 0; k < choice->count; k++) {
        const struct candidate *other = &choice->list[k];
        if (other->algorithm == candidate->algorithm
            && MARGIN * other->forecast.error[CAUSE_SPECTRUM] > setting->budget->error)
            return true;
    }
    return false;
}

/* Whether its forecast costs so much that it is only made where it may pay. */
static bool is_costly(const struct candidate *candidate)
{
    return candidate->budgeted || candidate->algorithm->cost;
}

/* Costly, neither refused nor forecast. */
static bool is_open(const struct candidate *candidate)
{
    return is_costly(candidate) && candidate->verdict == VERDICT_SLOWER && !(candidate->error < INFINITY);
}

/* The time of costly candidates: counted, or that of images of subapertures, which is a lower bound. */
static enum status costs_fill(const struct setting *setting, struct choice *choice)
{
    const struct forecast images = {.image_cost = setting->reads};
    enum status status = STATUS_OK;
    for (int k = 0; k < choice->count && status == STATUS_OK; k++) {
        struct candidate *c = &choice->list[k];
        if (!is_costly(c))
            continue;
        c->verdict = VERDICT_SLOWER;
        if (c->algorithm->cost)
            status = migration_cost(setting, c);
        else
            c->seconds = rates_sums(&images, setting->problem->precision, 0);
    }
    return status;
}

static enum status costly_forecast(const struct setting *setting, const struct choice *choice, struct candidate *c)
{
    if (c->algorithm->cost && spectrum_fails(setting, choice, c)) {
        c->verdict = VERDICT_ERROR;
        snprintf(c->reason, sizeof c->reason,
                 "over the budget of %.2g by the error of its spectrum, as with other settings",
                 setting->budget->error);
        return STATUS_OK;
    }
    if (c->algorithm->cost)
        return migration_forecast(setting, c);
    if (!*c->settings && !candidate_set_error(c, BUDGETED * law_most(setting, setting->budget->error))) {
        c->verdict = VERDICT_ERROR;
        snprintf(c->reason, sizeof c->reason, "does not take an error as small as the budget of %.2g",
                 setting->budget->error);
        return STATUS_OK;
    }
    return candidate_forecast(setting, c);
}

/* Of those that are faster than the fastest within the budget, from the fastest on: others need none, unless `every`
   one is asked for. */
static enum status costly_forecasts(const struct setting *setting, bool every, struct choice *choice)
{
    enum status status = STATUS_OK;
    while (status == STATUS_OK) {
        struct candidate *next = NULL;
        for (int k = 0; k < choice->count; k++)
            if (is_open(&choice->list[k]) && (!next || choice->list[k].seconds < next->seconds))
                next = &choice->list[k];
        if (!next || !(every || next->seconds < fastest(choice)))
            return STATUS_OK;
        status = costly_forecast(setting, choice, next);
    }
    return status;
}

static enum status forecast_all(const struct setting *setting, struct choice *choice)
{
    enum status status = STATUS_OK;
    int count = 0;
    bool tables = false; /* else all are of the general engine, said or not */
    for (int k = 0; k < choice->count && status == STATUS_OK; k++) {
        if (!tables && strstr(choice->list[k].settings, "engine=general"))
            continue;
        struct candidate *c = &choice->list[count++];
        *c = choice->list[k];
        c->sine = 1;
        c->verdict = VERDICT_REFUSED;     /* no verdict yet */
        c->error = c->seconds = INFINITY; /* numbers, for they are compared, which of a NAN would raise FE_INVALID */
        c->flops = c->pairs = c->bytes = NAN;
        if (!is_costly(c))
            status = candidate_forecast(setting, c);
        tables = tables || c->forecast.tables;
    }
    choice->count = count;
    status = status == STATUS_OK ? limit_try(setting, choice) : status;
    return status == STATUS_OK ? costs_fill(setting, choice) : status;
}

/* Tables take memory that the general engine does without: one candidate more, where one with tables is too large. */
static enum status general_try(const struct setting *setting, const struct candidate *from, struct choice *choice)
{
    if (!from->forecast.tables || choice->count == CANDIDATES_MAX)
        return STATUS_OK;
    struct candidate *general = &choice->list[choice->count];
    *general = *from;
    *general->reason = '\0';
    if (!candidate_set(general, "engine", "general"))
        return STATUS_OK;
    choice->count++;
    return candidate_forecast(setting, general);
}

/* Plan the fastest that is left; false without one. One that its plan refuses, or whose memory is too much, is out. */
static enum status plan_fastest(const struct setting *setting, struct choice *choice, bool *tried)
{
    struct candidate *best = NULL;
    for (int k = 0; k < choice->count; k++) {
        struct candidate *c = &choice->list[k];
        if (c->verdict == VERDICT_SLOWER && c->error < INFINITY && (!best || c->seconds < best->seconds))
            best = c;
    }
    *tried = best != NULL;
    if (!best)
        return STATUS_OK;
    enum status status = algorithm_plan(best->algorithm, setting->problem, best->options, &choice->plan);
    if (status != STATUS_OK)
        return refused(best, status);
    best->bytes = process_bytes(setting->problem, best->algorithm->work(choice->plan).bytes);
    if (best->bytes <= setting->budget->bytes) {
        best->verdict = VERDICT_CHOSEN;
        choice->found = true;
        return STATUS_OK;
    }
    best->algorithm->destroy(choice->plan);
    choice->plan = NULL;
    best->verdict = VERDICT_MEMORY;
    snprintf(best->reason, sizeof best->reason, "its process takes %.3g MB, more than %.3g MB", best->bytes / 1e6,
             setting->budget->bytes / 1e6);
    return general_try(setting, best, choice);
}

/* One after the other, from the fastest on, until one is found. Where one is out, others that seemed too slow may be
   the fastest. */
static enum status plan_first(const struct setting *setting, struct choice *choice)
{
    enum status status = STATUS_OK;
    for (bool tried = true; status == STATUS_OK && tried && !choice->found;) {
        status = costly_forecasts(setting, false, choice);
        if (status == STATUS_OK)
            status = plan_fastest(setting, choice, &tried);
    }
    return status == STATUS_OK && setting->budget->every ? costly_forecasts(setting, true, choice) : status;
}

static int compare(const void *a, const void *b)
{
    const struct candidate *one = a, *other = b;
    if (one->verdict != other->verdict)
        return one->verdict < other->verdict ? -1 : 1;
    return (one->seconds > other->seconds) - (one->seconds < other->seconds);
}

static void reasons_fill(struct choice *choice)
{
    for (int k = 1; k < choice->count; k++) {
        struct candidate *c = &choice->list[k];
        const double ratio = c->seconds / choice->list[0].seconds;
        if (c->verdict != VERDICT_SLOWER)
            continue;
        if (c->error < INFINITY)
            snprintf(c->reason, sizeof c->reason, "within the budget, %.2f times the chosen one's time", ratio);
        else if (c->budgeted)
            snprintf(c->reason, sizeof c->reason,
                     "%.2f times the chosen one's time or more: its images of subapertures alone take %.2g s", ratio,
                     c->seconds);
        else
            snprintf(c->reason, sizeof c->reason, "%.2f times the chosen one's time, whatever its error", ratio);
    }
}

enum status planner_choose(const struct problem *problem, const struct budget *budget, struct choice *choice)
{
    struct known known = {.coarse = 1};
    struct setting setting = {.known = &known, .problem = problem, .budget = budget};
    *choice = (struct choice){.least = INFINITY, .list = malloc(CANDIDATES_MAX * sizeof *choice->list)};
    if (!choice->list)
        return status_set(STATUS_FAILED, "no memory for the candidates of a plan");
    choice->count = candidates_fill(choice->list);
    enum status status = condition_targets_shown(problem);
    if (status == STATUS_OK) {
        known_find(problem, &known);
        status = pairs_of(problem, &setting.pairs);
    }
    setting.reads = factorised_least(problem, setting.pairs);
    if (status == STATUS_OK)
        status = forecast_all(&setting, choice);
    if (status == STATUS_OK)
        status = plan_first(&setting, choice);
    known_free(&known);
    if (status != STATUS_OK) {
        choice_free(choice);
        return status;
    }
    for (int k = 0; k < choice->count; k++)
        choice->least = fmin(choice->least, choice->list[k].error);
    qsort(choice->list, (size_t)choice->count, sizeof *choice->list, compare);
    if (choice->found)
        reasons_fill(choice);
    return STATUS_OK;
}

void choice_free(struct choice *choice)
{
    if (choice->plan)
        choice->list[0].algorithm->destroy(choice->plan);
    free(choice->list);
    *choice = (struct choice){.list = NULL};
}
