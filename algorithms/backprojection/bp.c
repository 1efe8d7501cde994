/* Back projection (bp.h): weights, the choice of an engine, and the count of the work. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "backprojection/bp_engine.h"
#include "backprojection/budget.h"
#include "backprojection/kernel.h"
#include "backprojection/law.h"
#include "backprojection/pairs/omission.h"
#include "backprojection/pairs/pairs.h"
#include "common/fft_length.h"
#include "common/pulse_band.h"
#include "contract/forecast_time.h"

/* The kernel's branches, if there are at most KERNEL_BRANCHES_MOST; false without memory. */
static bool kernel_make(struct bp *bp, const struct interpolator *in, double phase_limit)
{
    const size_t count = KERNEL_BRANCHES_MOST * (size_t)in->taps;
    bp->kernel = (struct bp_kernel){.taps = in->taps, .first = in->first};
    bp->kernel.coefficients = store_room(&bp->tables, count, sizeof *bp->kernel.coefficients, 1);
    if (!bp->kernel.coefficients)
        return false;
    bp->kernel.branches =
        kernel_branches(in, budget_kernel(phase_limit, bp->problem.precision), bp->kernel.coefficients);
    return bp->kernel.branches >= 0;
}

/* The way of reading, without the weights. */
static struct bp_table table_of(const struct interpolator *in)
{
    if (in->degree > 0)
        return (struct bp_table){.reading = BP_BRANCHES,
                                 .upsample = in->upsample,
                                 .steps = 1,
                                 .taps = in->degree + 1,
                                 .guard = BP_BRANCHES_GUARD,
                                 .branches = in->degree + 1,
                                 .shift = 0.5};
    return (struct bp_table){.reading = in->taps == 1   ? BP_NEAREST
                                        : in->steps > 0 ? BP_STEPS
                                                        : BP_CUBICS,
                             .upsample = in->upsample,
                             .steps = in->steps,
                             .taps = in->taps,
                             .first = in->first,
                             .guard = in->taps,
                             .branches = 1,
                             .preemphasis = in->preemphasis};
}

/* Tabulate the interpolator's weights in the plan's precision. */
static enum status tabulate(struct bp *bp, const struct interpolator *in, double phase_limit)
{
    bp->table = table_of(in);
    if (in->taps == 1)
        return STATUS_OK; /* BP_NEAREST, BP_BRANCHES */
    bool line = in->taps == 2 && in->steps > 0;
    size_t rows = in->steps > 0 ? (size_t)in->steps : 4 * (size_t)BP_INTERVALS, taps = (size_t)in->taps;
    double *w = malloc(rows * taps * sizeof *w), *at = malloc(4 * taps * sizeof *at);
    bp->weights = store_room(&bp->tables, rows * taps, real_size(bp->problem.precision), 1);
    if (w && at && bp->weights) {
        if (in->steps > 0)
            for (int p = 0; p < in->steps; p++) {
                double fraction = (double)p / in->steps, *at_p = w + (size_t)p * taps;
                in->weights(in, fraction, at_p);
                line = line && fabs(at_p[0] - (1 - fraction)) <= 1e-15 && fabs(at_p[1] - fraction) <= 1e-15;
            }
        for (int k = 0; in->steps == 0 && k < BP_INTERVALS; k++) {
            /* The cubic through the four Chebyshev points of the interval, from Newton's divided differences. */
            double u[4], *c = w + (size_t)k * 4 * taps;
            for (int n = 0; n < 4; n++) {
                u[n] = 0.5 - 0.5 * cos(M_PI * (2 * n + 1) / 8);
                in->weights(in, (k + u[n]) / BP_INTERVALS, at + (size_t)n * taps);
            }
            for (size_t t = 0; t < taps; t++) {
                double d[4] = {at[t], at[taps + t], at[2 * taps + t], at[3 * taps + t]};
                for (int level = 1; level < 4; level++)
                    for (int n = 3; n >= level; n--)
                        d[n] = (d[n] - d[n - 1]) / (u[n] - u[n - level]);
                c[3 * taps + t] = d[3];
                c[2 * taps + t] = d[2] - d[3] * (u[0] + u[1] + u[2]);
                c[taps + t] = d[1] - d[2] * (u[0] + u[1]) + d[3] * (u[0] * u[1] + u[0] * u[2] + u[1] * u[2]);
                c[t] = d[0] - d[1] * u[0] + d[2] * u[0] * u[1] - d[3] * u[0] * u[1] * u[2];
            }
        }
        for (size_t i = 0; i < rows * taps; i++)
            if (bp->problem.precision == PRECISION_DOUBLE)
                ((double *)bp->weights)[i] = w[i];
            else
                ((float *)bp->weights)[i] = (float)w[i];
    }
    bool complete = w && at && bp->weights && (in->steps > 0 || kernel_make(bp, in, phase_limit));
    free(w);
    free(at);
    bp->table.weights = bp->weights;
    if (line)
        bp->table.reading = BP_LINE;
    return complete ? STATUS_OK : status_set(STATUS_FAILED, "no memory for interpolation weights");
}

/* The counted and the published work, without the pairs. BP22 Eq. (11) has N_a records, N_r samples and N_a N_r pixels,
   every pixel summed over every record; here the actual pixels are counted. LBF21 Eq. (23) lacks the sum over records
   and contradicts it. Its interpolation factor, and BP22's points beta between two samples, follow from the method's
   interpolator. The inverse FFT of zero padding is as long as the padded record. */
static void count_work(struct bp *bp, const struct interpolator *in)
{
    const struct acquisition *a = bp->problem.acquisition;
    struct work *work = &bp->work;
    const double na = (double)a->pings * a->receivers, nr = a->samples, pixels = problem_pixels(&bp->problem);
    double all = na * pixels, transforms = na * (fft_flops(nr) + fft_flops(in->upsample * nr) + 6 * nr);
    work->flops = (double)bp_met_count(bp) * a->receivers * bp->shape.flops;
    if (in->in_papers) {
        const bool kernel = in->steps == 0; /* each value is summed over one */
        const double beta = kernel ? 0 : in->steps - 1, points = kernel ? in->taps : in->steps;
        const double factor = in->upsample > 1 ? in->upsample : points;
        work->published[0].source = kernel ? "BP22 Eq. (11) + sinc load" : "BP22 Eq. (11)";
        work->published[0].flops = transforms + 6 * all + 6 * beta * na * (nr - 1);
        if (kernel)
            work->published[0].flops += 2 * (2.0 * in->taps - 1) * all;
        work->published[1].source = "LBF21 Eq. (23)";
        work->published[1].flops = 1.5 * na * nr * log2(nr) + na * nr + 1.5 * na * factor * nr * log2(factor * nr);
    }
    snprintf(work->engine, sizeof work->engine, "%s%s", bp->engine->name,
             bp->engine == &bp_general && !(bp->medium.phase_limit > 0) ? " exact" : "");
}

const char *const bp_engine_names[] = {"auto", "general", "invariant", NULL};
const char *const bp_exact_names[] = {"false", "true", NULL};

int bp_method_conditions(const struct problem *problem, const void *method, const void *options, struct condition *list,
                         int room)
{
    (void)method;
    const struct bp_options *given = options;
    int count = conditions_sampled(problem, list, room);
    if (count < room)
        list[count++] =
            invariant_condition(problem, given->engine == BP_ENGINE_INVARIANT ? SEVERITY_REFUSE : SEVERITY_INFORM);
    return count;
}

static enum status forecast_work(const struct bp *bp, const struct interpolator *in, const struct bp_options *options,
                                 struct forecast *forecast);

static enum status choose_engine(struct bp *bp, const struct interpolator *in, const struct bp_options *options)
{
    const bool invariant = options->engine == BP_ENGINE_INVARIANT;
    enum status status = options->engine == BP_ENGINE_GENERAL ? STATUS_OK : bp_invariant.applicable(bp);
    bp->engine = invariant ? &bp_invariant : &bp_general;
    if (invariant && status != STATUS_OK)
        return status_set(STATUS_UNSUPPORTED, "engine=invariant: %s", status_message());
    if (options->engine == BP_ENGINE_AUTO && !options->exact && status == STATUS_OK) {
        struct forecast forecast;
        status = forecast_work(bp, in, options, &forecast);
        if (status != STATUS_OK)
            return status;
        bp->engine = forecast.tables ? &bp_invariant : &bp_general;
    }
    /* The approximation also moves a sample coordinate by at most a quarter of the finest step. */
    double finest = bp->medium.fs * bp->table.upsample * (bp->table.steps > 0 ? bp->table.steps : 1);
    if (!options->exact)
        bp->medium.phase_limit = budget_limit(options->phase_limit, bp->medium.fc, finest);
    return STATUS_OK;
}

/* The engine's plan; the general engine's where tables would be too large and engine is auto. */
static enum status engine_plan(struct bp *bp, const struct bp_options *options)
{
    enum status status = bp->engine->plan(bp);
    if (status == STATUS_UNSUPPORTED && bp->engine == &bp_invariant && options->engine == BP_ENGINE_AUTO) {
        store_release(&bp->engines);
        bp->engine = &bp_general;
        status = bp->engine->plan(bp);
    }
    return status;
}

/* Limit the problem's aperture to that of the settings, where it is smaller. */
static void aperture_take(struct bp *bp, const struct bp_options *options)
{
    if (!(options->aperture > 0 && options->aperture < fmin(1, bp->problem.acquisition->aperture_limit)))
        return;
    bp->limited = *bp->problem.acquisition;
    bp->limited.aperture_limit = options->aperture;
    bp->problem.acquisition = &bp->limited;
}

enum status bp_plan(const struct problem *problem, const struct interpolator *interpolator,
                    const struct bp_options *options, void **plan)
{
    const struct acquisition *a = problem->acquisition;
    *plan = NULL;
    if (interpolator->steps > BP_STEPS_MOST)
        return status_set(STATUS_UNSUPPORTED, "positions are rounded to %d steps between samples, must be at most %d",
                          interpolator->steps, BP_STEPS_MOST);
    struct bp *bp = calloc(1, sizeof *bp);
    if (!bp)
        return status_set(STATUS_FAILED, "no memory for the plan");
    bp->problem = *problem;
    bp->medium = (struct bp_medium){a->sound_speed, a->fc, a->fs, 0, a->samples - 1, 0};
    bp->work.bytes = BP_BYTES(*bp);
    aperture_take(bp, options);
    enum status status = problem_turn_back(&bp->problem, &bp->turned, &bp->work.bytes);
    if (status == STATUS_OK)
        status = bp_met_find(bp);
    if (status == STATUS_OK)
        status = tabulate(bp, interpolator, options->phase_limit);
    if (status == STATUS_OK)
        status = choose_engine(bp, interpolator, options);
    if (status == STATUS_OK)
        status = engine_plan(bp, options);
    if (status == STATUS_OK && bp->problem.window)
        status = bp_met_narrow(bp);
    if (status != STATUS_OK) {
        bp_destroy(bp);
        return status;
    }
    bp->work.bytes += bp->tables.bytes + bp->engines.bytes;
    count_work(bp, interpolator);
    *plan = bp;
    return STATUS_OK;
}

enum status bp_execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    struct bp *bp = plan;
    bp->engine->execute(bp, echoes, image, stages);
    return STATUS_OK;
}

/* Counting pairs takes longer than planning, so it waits for a request. */
struct work bp_work(const void *plan)
{
    const struct bp *bp = plan;
    const struct acquisition *a = bp->problem.acquisition;
    struct work work = bp->work;
    struct grid part;
    const struct problem wanted = bp_wanted(bp, &part);
    double all = (double)a->pings * a->receivers * problem_pixels(&wanted);
    work.pairs = pairs_count(&wanted);
    work.flops += work.pairs * (4.0 * (bp->table.taps == 1 ? 0 : bp->table.taps - (bp->table.branches > 1)) + 8);
    int length = 0;
    if (work.pairs < all)
        length = snprintf(work.skipped, sizeof work.skipped, "%.3g %% of the pairs: outside the record%s",
                          100 * (1 - work.pairs / all), a->aperture_limit < 1 ? " or the aperture limit" : "");
    if (bp->met)
        length += snprintf(work.skipped + length, sizeof work.skipped - (size_t)length,
                           "%s%d of %d pings, which no pixel meets", length > 0 ? "; " : "",
                           a->pings - bp_met_count(bp), a->pings);
    bp_records_skipped(bp, work.skipped + length, sizeof work.skipped - (size_t)length, length > 0 ? "; " : "");
    return work;
}

/* Rounding, relative L2: of sums in the invariant engine, and with the phase factors of the general one (budget.h). */
static const double ROUNDING[][2] = {{3e-7, 1e-13}, {2.5e-6, 1e-9}};
/* Root mean square error by interpolated delays over the phase limit, which is reached at a block's corners only. */
static const double DELAYS_SHARE = 0.3;

/* Values that a pair reads in the general engine: a kernel with branches is read by these. */
static enum status forecast_reading(const struct bp *bp, const struct interpolator *in, struct forecast *forecast)
{
    struct bp kernel = {.problem = bp->problem};
    kernel.problem.precision = PRECISION_FLOAT; /* so that both precisions have the same forecast */
    const bool line = in->taps == 2 && (in->steps > 0 || bp->engine == &bp_invariant);
    forecast->kind = in->degree > 0 ? READ_BRANCHES : line ? READ_LINE : in->taps > 1 ? READ_TAPS : READ_NEAREST;
    forecast->values = in->degree > 0 ? in->degree + 1 : in->taps;
    if (bp->engine == &bp_invariant || in->degree > 0 || in->taps == 1 || in->steps > 0)
        return STATUS_OK;
    const bool made = kernel_make(&kernel, in, bp->medium.phase_limit);
    if (made && kernel.kernel.branches > 0 && bp->medium.phase_limit > 0) {
        forecast->kind = READ_BRANCHES;
        forecast->values = kernel.kernel.branches;
    }
    store_release(&kernel.tables);
    return made ? STATUS_OK : status_set(STATUS_FAILED, "no memory for interpolation weights");
}

/* What engines share, without a plan. The caller frees `tables` and `turned` of *bp. */
static enum status forecast_begin(const struct problem *problem, const struct bp_options *options, struct bp *bp)
{
    const struct acquisition *a = problem->acquisition;
    *bp = (struct bp){.problem = *problem, .medium = {a->sound_speed, a->fc, a->fs, 0, a->samples - 1, 0}};
    aperture_take(bp, options);
    const enum status status = problem_turn_back(&bp->problem, &bp->turned, NULL);
    return status == STATUS_OK ? bp_met_find(bp) : status;
}

/* The work besides pairs. */
static void forecast_records(struct bp *bp, const struct interpolator *in, struct forecast *forecast)
{
    const struct acquisition *a = bp->problem.acquisition;
    const struct traces_form form = bp_records_form(bp, bp_samples_read(bp));
    const double records = (double)bp_met_count(bp) * a->receivers, fine = (form.count - 1.0) * in->upsample + 1;
    const int taps = forecast->kind == READ_BRANCHES && in->degree == 0 ? in->taps : 0; /* of a kernel's branches */
    bp->engine->units(bp, forecast);
    forecast->pair_flops =
        4.0 * (in->taps == 1 && in->degree == 0 ? 0 : forecast->values - (forecast->kind == READ_BRANCHES)) + 8;
    double sums = 0;
    forecast->record_flops = records * traces_float.flops(a, &form, &sums); /* the same in both precisions */
    forecast->slowness = fft_slowness(traces_float.period(a, &form));
    forecast->kernel_flops = records * (4.0 * forecast->values * taps * fine + sums);
    forecast->record_values = records * fine * (forecast->kind == READ_BRANCHES ? forecast->values : 1);
}

/* NAN without memory. */
static double error_between_samples(const struct problem *problem, const struct interpolator *in)
{
    struct law_spectrum spectrum;
    return law_spectrum(problem->acquisition, image_cells(problem), &spectrum) ? interpolation_error(in, &spectrum)
                                                                               : NAN;
}

/* The forecast of what is begun, by the engine of the options, which is not auto. */
static enum status forecast_engine(const struct bp *begun, const struct interpolator *in,
                                   const struct bp_options *options, struct forecast *forecast)
{
    struct bp bp = {.problem = begun->problem, .medium = begun->medium, .table = table_of(in), .met = begun->met};
    *forecast = (struct forecast){.sums_pairs = true};
    enum status status = choose_engine(&bp, in, options);
    if (status == STATUS_OK)
        status = forecast_reading(&bp, in, forecast);
    if (status == STATUS_OK) {
        const bool general = bp.engine == &bp_general;
        forecast->tables = !general;
        forecast->finer = in->upsample;
        forecast->error[CAUSE_DELAYS] = general ? DELAYS_SHARE * bp.medium.phase_limit : 1e-7;
        forecast->error[CAUSE_FLOAT] = ROUNDING[general][bp.problem.precision];
        if (forecast->kind == READ_BRANCHES && in->degree == 0)
            bp.kernel.branches = forecast->values;
        forecast_records(&bp, in, forecast);
    }
    store_release(&bp.tables);
    return status;
}

/* The forecast without conditions and the error law. engine=auto takes the invariant engine, whose delays are more
   exact, unless the general one gains a tenth of the time or more: by the built-in rates, so that a setting makes the
   same image on every machine. */
static enum status forecast_work(const struct bp *bp, const struct interpolator *in, const struct bp_options *options,
                                 struct forecast *forecast)
{
    if (options->engine != BP_ENGINE_AUTO)
        return forecast_engine(bp, in, options, forecast);
    struct forecast invariant;
    struct bp_options fixed = *options;
    fixed.engine = BP_ENGINE_GENERAL;
    enum status status = forecast_engine(bp, in, &fixed, forecast);
    if (status != STATUS_OK || options->exact)
        return status;
    fixed.engine = BP_ENGINE_INVARIANT;
    status = forecast_engine(bp, in, &fixed, &invariant);
    if (status != STATUS_OK)
        return status == STATUS_UNSUPPORTED ? STATUS_OK : status;
    const enum precision precision = bp->problem.precision;
    if (rates_sums(&rates_built_in, &invariant, precision, forecast->pairs)
        <= 1.1 * rates_sums(&rates_built_in, forecast, precision, forecast->pairs))
        *forecast = invariant;
    return STATUS_OK;
}

static enum status forecast_cost(const struct problem *problem, const struct interpolator *in,
                                 const struct bp_options *options, struct forecast *forecast)
{
    struct condition list[CONDITIONS_MAX];
    struct bp bp;
    enum status status =
        conditions_check("back projection", list, bp_method_conditions(problem, NULL, options, list, CONDITIONS_MAX));
    if (status != STATUS_OK)
        return status;
    status = forecast_begin(problem, options, &bp);
    if (status == STATUS_OK)
        status = forecast_work(&bp, in, options, forecast);
    if (status == STATUS_OK && bp.limited.aperture_limit > 0)
        forecast->error[CAUSE_APERTURE] = aperture_planned(problem, options->aperture);
    store_release(&bp.tables);
    turned_free(&bp.turned);
    return status;
}

static enum status forecast_errors(const struct problem *problem, const struct interpolator *in,
                                   struct forecast *forecast)
{
    const double law = error_between_samples(problem, in);
    const double ends = in->upsample == 1 && in->degree == 0 && in->taps > 1 ? law_ends(problem, in->taps) : 0;
    forecast->error[CAUSE_INTERPOLATION] = hypot(law, ends);
    return isnan(law) ? status_set(STATUS_FAILED, "no memory for an error law") : STATUS_OK;
}

enum status bp_forecast(const struct problem *problem, const struct interpolator *in, const struct bp_options *options,
                        struct forecast *forecast)
{
    const enum status status = forecast_cost(problem, in, options, forecast);
    return status == STATUS_OK ? forecast_errors(problem, in, forecast) : status;
}

enum status bp_method_plan(const struct problem *problem, const void *given, const void *options, void **plan)
{
    const struct bp_method *method = given;
    struct interpolator interpolator;
    *plan = NULL;
    const enum status status = method->make(problem, options, &interpolator);
    return status == STATUS_OK ? bp_plan(problem, &interpolator, method->fixed ? method->fixed : options, plan)
                               : status;
}

enum status bp_method_cost(const struct problem *problem, const void *given, const void *options,
                           struct forecast *forecast)
{
    const struct bp_method *method = given;
    struct interpolator interpolator;
    const enum status status = method->make(problem, options, &interpolator);
    return status == STATUS_OK ? forecast_cost(problem, &interpolator, options, forecast) : status;
}

enum status bp_method_errors(const struct problem *problem, const void *given, const void *options,
                             struct forecast *forecast)
{
    const struct bp_method *method = given;
    struct interpolator interpolator;
    const enum status status = method->make(problem, options, &interpolator);
    return status == STATUS_OK ? forecast_errors(problem, &interpolator, forecast) : status;
}

void bp_destroy(void *plan)
{
    struct bp *bp = plan;
    if (!bp)
        return;
    store_release(&bp->engines);
    store_release(&bp->tables);
    turned_free(&bp->turned);
    free(bp);
}
