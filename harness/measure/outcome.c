/* One algorithm on one scene: the only place that fills the row of measurements.csv (outcome.h). */
#include "measure/outcome.h"

#include <math.h>
#include <omp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/pairs/pairs.h"
#include "echoes/echo_data.h"
#include "measure/darkness.h"
#include "imaging/imaging.h"
#include "measure/tiled.h"
#include "metrics/metrics.h"
#include "text/text_append.h"

enum { AXES = 2, DEFINITIONS = 3 };
static const char *const axis_names[AXES] = {[AXIS_AZIMUTH] = "azimuth", [AXIS_RANGE] = "range"};
static const char *const definition_names[DEFINITIONS] = {
    [DEFINITION_NULL] = "null", [DEFINITION_3DB] = "3db", [DEFINITION_PIXEL] = "pixel"};

/* The rows of one target, and its azimuth slice by the primary definition. Returns the number of rows. */
static int target_rows(const struct session *session, const struct image *image, int index,
                       const struct measurement *row, struct target_row *rows, struct slice_metrics *azimuth)
{
    const struct acquisition *a = &session->scene->acquisition;
    const struct target *target = &session->scene->targets[index];
    double complex here = metrics_value(image, a, target->x, target->r);
    double complex exact = metrics_value(&session->reference, a, target->x, target->r);
    double phase_error = here != 0 && exact != 0 ? carg(here * conj(exact)) : NAN; /* zero has no phase */
    int count = 0;
    for (int axis = 0; axis < AXES; axis++) {
        struct slice_metrics m = metrics_slice(image, a, target, (enum axis)axis);
        if (axis == AXIS_AZIMUTH)
            *azimuth = m;
        for (int d = 0; d < DEFINITIONS; d++)
            if (d != DEFINITION_PIXEL || axis == AXIS_AZIMUTH)
                rows[count++] = (struct target_row){
                    row->scene,       row->algorithm,      row->options, row->precision,     index,
                    axis_names[axis], definition_names[d], m.extent_m,   m.position_error_m, phase_error,
                    m.width_m,        m.pslr_db[d],        m.islr_db[d]};
    }
    return count;
}

/* Append a reason. */
static void __attribute__((format(printf, 3, 4))) reason_add(char *reason, size_t size, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    if (*reason)
        text_append(reason, size, "; ");
    const size_t used = strlen(reason);
    vsnprintf(reason + used, size - used, format, arguments);
    va_end(arguments);
}

/* An image in tiles has its errors already. */
static void errors_fill(const struct session *session, struct outcome *outcome)
{
    struct measurement *row = &outcome->row;
    if (session->memory > 0)
        return;
    const struct error_metrics error = metrics_error(&outcome->image, &session->reference);
    row->error = error.error;
    row->error_gain = error.error_gain;
    row->phase_rms_rad = error.phase_rms_rad;
    if (*session->no_reference)
        reason_add(outcome->reason, sizeof outcome->reason,
                   OUTCOME_WARNING "no errors, for there is no exact image: %s", session->no_reference);
    else if (*error.reason)
        reason_add(outcome->reason, sizeof outcome->reason, OUTCOME_WARNING "%s", error.reason);
    if (session->flown.patch_count > 0)
        row->error_flown = metrics_error(&outcome->image, &session->flown).error_gain;
}

/* Fill the row with the errors of the image and the medians over the targets, and the targets' rows. */
static enum status quality_fill(const struct session *session, struct outcome *outcome)
{
    struct measurement *row = &outcome->row;
    char *reason = outcome->reason;
    const size_t reason_size = sizeof outcome->reason;
    int points = session->scene->point_count, defined = 0, unmeasured = 0;
    double *values = calloc(3 * (size_t)points + 1, sizeof *values);
    outcome->targets = calloc((size_t)points * AXES * DEFINITIONS + 1, sizeof *outcome->targets);
    if (!outcome->targets || !values) {
        free(values);
        return status_set(STATUS_FAILED, "%s: no memory for %d targets", session->scene->name, points);
    }
    errors_fill(session, outcome);
    if (points == 0)
        reason_add(reason, reason_size, OUTCOME_NO_TARGETS);
    double *width = values, *pslr = values + points, *islr = values + 2 * points;
    for (int t = 0; t < points; t++) {
        struct slice_metrics azimuth;
        outcome->target_count +=
            target_rows(session, &outcome->image, t, row, outcome->targets + outcome->target_count, &azimuth);
        if (*azimuth.reason && unmeasured++ == 0)
            reason_add(reason, reason_size, OUTCOME_WARNING "target %d: %s", t + 1, azimuth.reason);
        if (isfinite(azimuth.pslr_db[DEFINITION_NULL])) {
            width[defined] = azimuth.width_m;
            pslr[defined] = azimuth.pslr_db[DEFINITION_NULL];
            islr[defined] = azimuth.islr_db[DEFINITION_NULL];
            defined++;
        }
    }
    if (unmeasured > 1)
        reason_add(reason, reason_size, OUTCOME_WARNING "%d more targets likewise", unmeasured - 1);
    row->width_m = median(width, defined);
    row->pslr_db = median(pslr, defined);
    row->islr_db = median(islr, defined);
    free(values);
    return STATUS_OK;
}

static void stages_format(const struct stages *stages, char *text, size_t size)
{
    *text = '\0';
    for (int k = 0; k < stages->count; k++)
        text_append(text, size, "%s%s=%.4g", k ? ";" : "", stages->stage[k].name, stages->stage[k].seconds);
}

static void sharpness_fill(struct outcome *outcome)
{
    const struct sharpness sharpness = metrics_sharpness(&outcome->image);
    outcome->row.entropy = sharpness.entropy;
    outcome->row.contrast = sharpness.contrast;
    outcome->row.peak_over_median = sharpness.peak_over_median;
}

static void work_fill(const struct session *session, const struct problem *problem, struct outcome *outcome)
{
    const struct work *work = &outcome->work;
    const struct scene *scene = session->scene;
    struct problem whole = scene_problem(scene, problem->precision);
    struct measurement *row = &outcome->row;
    row->flops = work->flops;
    row->flops_published = work->published[0].source ? work->published[0].flops : NAN;
    row->pairs = work->pairs;
    row->bytes = work->bytes;
    row->engine = work->engine;
    double left_out = 1 - problem_pixels(problem) / problem_pixels(&whole);
    if (left_out <= 0)
        sharpness_fill(outcome);
    else
        reason_add(outcome->skipped, sizeof outcome->skipped,
                   "%.3g %% of the pixels: only the patches around the targets are compared", 100 * left_out);
    if (*work->skipped)
        reason_add(outcome->skipped, sizeof outcome->skipped, "%s", work->skipped);
}

static void noise_tell(const struct timing *timing, char *text, size_t size)
{
    const double spread = timing_spread(timing), waited = timing->waited / omp_get_max_threads();
    char why[250] = "";
    if (spread > TIMING_NOISY)
        reason_add(why, sizeof why, "the middle half of %d runs spans %.0f %% of the median", timing->runs,
                   100 * spread);
    if (waited > TIMING_NOISY)
        reason_add(why, sizeof why, "other work had the processors for %.0f %% of the time", 100 * waited);
    if (fabs(timing->drift) > TIMING_NOISY)
        reason_add(why, sizeof why, "the scalar reference loop's time changed by %+.0f %% meanwhile",
                   100 * timing->drift);
    snprintf(text, size, "%s%s%s", *why ? OUTCOME_NOISE : "", *why ? ": " : "", why);
}

static void times_fill(const struct timing *timing, struct session *session, struct outcome *outcome)
{
    struct measurement *row = &outcome->row;
    outcome->work = timing->work;
    session->spent.planning += timing->plan_s;
    session->spent.imaging += timing->spent_s;
    row->plan_s = timing->plan_s;
    row->run_s = timing->run_s;
    row->run_min_s = timing->run_min_s;
    row->run_q1_s = timing->run_q1_s;
    row->run_q3_s = timing->run_q3_s;
    row->runs = timing->runs;
    row->control_s = timing->control_s;
    stages_format(&timing->stages, outcome->stages, sizeof outcome->stages);
    noise_tell(timing, outcome->noise, sizeof outcome->noise);
}

static enum status image_tiled(struct session *session, const struct spec *spec, struct outcome *outcome)
{
    struct tiled_image tiled;
    const enum status status = tiled_measure(spec, session->scene, session->memory, &tiled);
    if (status != STATUS_OK)
        return status;
    const struct probe_error *e = &tiled.error;
    outcome->image = tiled.image;
    outcome->row.error = e->error;
    outcome->row.error_gain = e->error_gain;
    times_fill(&tiled.timing, session, outcome);
    reason_add(outcome->reason, sizeof outcome->reason, "--tile %dx%d, %d in all", tiled.tiles.columns,
               tiled.tiles.rows, tiles_count(&tiled.tiles));
    if (isnan(e->error_gain))
        reason_add(outcome->reason, sizeof outcome->reason,
                   OUTCOME_WARNING "no relative error: the exact image is zero on %d pixels", e->pixels);
    else
        reason_add(outcome->reason, sizeof outcome->reason, "errors are of %d pixels, +gain from %.2g to %.2g at 95 %%",
                   e->pixels, e->low, e->high);
    return STATUS_OK;
}

static enum status image_time(struct session *session, const struct spec *spec, const struct problem *problem,
                              enum effort effort, struct timing_samples *samples, struct outcome *outcome)
{
    struct timing timing;
    const enum status status = timing_measure(spec, problem, &session->echoes[spec->precision], &session->control,
                                              effort, samples, &outcome->image, &timing);
    if (status == STATUS_OK)
        times_fill(&timing, session, outcome);
    return status;
}

static void outcome_fail(struct outcome *outcome, enum status status)
{
    outcome->row.status = status == STATUS_UNSUPPORTED ? "unsupported" : "failed";
    snprintf(outcome->reason, sizeof outcome->reason, "%s", status_message());
}

void outcome_warning(const struct condition *condition, char *text, size_t size)
{
    snprintf(text, size, OUTCOME_WARNING "condition %s: %s is %.3g, limit %g (cure: %s)", condition->name,
             condition->meaning, condition->value, condition->limit, condition->cure);
}

static void warnings_add(const struct condition *list, int count, struct outcome *outcome)
{
    char text[400];
    for (int k = 0; k < count; k++)
        if (list[k].severity == SEVERITY_WARN && !condition_holds(&list[k])) {
            outcome_warning(&list[k], text, sizeof text);
            reason_add(outcome->reason, sizeof outcome->reason, "%s", text);
        }
}

/* `error` compares with the best image by the stated track, which true motion may blur. */
static void flown_tell(struct outcome *outcome)
{
    if (isfinite(outcome->row.error_flown))
        reason_add(outcome->reason, sizeof outcome->reason,
                   OUTCOME_WARNING "against the exact image by the true track the error is %.2g after one gain",
                   outcome->row.error_flown);
}

/* Check the settings' promise against the measurement, with room for rounding. */
static void promise_hold(const struct spec *spec, struct outcome *outcome)
{
    const struct measurement *row = &outcome->row;
    const double promise = spec->algorithm->promise ? spec->algorithm->promise(spec->options) : NAN;
    struct condition broken = {"promise",       row->error,    promise,
                               false,           SEVERITY_WARN, "the measured error, more than the settings promise,",
                               "other settings"};
    if (row->error > promise + (spec->precision == PRECISION_FLOAT ? 1e-6 : 1e-12)) {
        condition_cure_add(&broken, "; after one gain it is %.3g", row->error_gain);
        warnings_add(&broken, 1, outcome);
    }
}

/* Warnings come behind the other reasons: a table finds them there. Without an exact image, this image's own
   darkness is measured. */
static void warnings_fill(const struct session *session, const struct spec *asked, const struct spec *spec,
                          const struct problem *problem, struct outcome *outcome)
{
    struct condition list[CONDITIONS_MAX];
    int count = algorithm_conditions(spec->algorithm, problem, spec->options, list, CONDITIONS_MAX);
    warnings_add(session->conditions, session->condition_count, outcome);
    flown_tell(outcome);
    if (*session->no_reference) {
        const struct darkness darkness = image_darkness(&session->echoes[spec->precision], &outcome->image);
        struct condition of_image[DARKNESS_CONDITIONS];
        darkness_conditions(&darkness, of_image);
        warnings_add(of_image, DARKNESS_CONDITIONS, outcome);
    }
    warnings_add(list, count, outcome);
    promise_hold(asked, outcome);
}

void outcome_round(struct session *session, const struct spec *spec, struct timing_samples *samples)
{
    struct timing timing;
    struct image image;
    if (session_resolve(session, spec, &spec) != STATUS_OK)
        return;
    const struct problem problem = session_problem(session->scene, spec->algorithm, spec->precision);
    if (timing_measure(spec, &problem, &session->echoes[spec->precision], &session->control, EFFORT_WHOLE, samples,
                       &image, &timing)
        != STATUS_OK)
        return;
    session->spent.planning += timing.plan_s;
    session->spent.imaging += timing.spent_s;
    image_free(&image);
}

/* The row of a choice names the chosen setting and the error behind the choice. */
static void choice_fill(const struct chosen *chosen, struct outcome *outcome)
{
    const struct candidate *c = &chosen->choice.list[0];
    char text[sizeof outcome->skipped];
    candidate_name(c, outcome->work.engine);
    snprintf(text, sizeof text, "%s", outcome->skipped);
    snprintf(outcome->skipped, sizeof outcome->skipped, "%d other settings: an error of %.2g %s%s%.180s",
             chosen->choice.count - 1, c->error, c->measured.pixels > 0 ? "was measured" : "is predicted",
             *text ? "; " : "", text);
}

static void outcome_begin(const struct session *session, const char *algorithm, const char *options,
                          enum precision precision, struct outcome *outcome)
{
    *outcome = (struct outcome){.row = measurement_empty(session->scene->name, algorithm, options, precision)};
    outcome->row.reason = outcome->reason;
    outcome->row.skipped = outcome->skipped;
    outcome->row.stages = outcome->stages;
}

enum status outcome_score(struct session *session, const char *name, struct image *image, double seconds,
                          struct outcome *outcome)
{
    outcome_begin(session, name, "", image->precision, outcome);
    outcome->image = *image;
    *image = (struct image){0};
    outcome->row.engine = "image";
    outcome->row.run_s = seconds;
    sharpness_fill(outcome);
    const enum status status = quality_fill(session, outcome);
    if (status != STATUS_OK) {
        outcome_free(outcome);
        return status;
    }
    if (!isnan(seconds))
        reason_add(outcome->reason, sizeof outcome->reason, OUTCOME_WARNING "the run time is stated, not measured");
    warnings_add(session->conditions, session->condition_count, outcome);
    flown_tell(outcome);
    return STATUS_OK;
}

void outcome_measure(struct session *session, const struct spec *asked, enum effort effort,
                     struct timing_samples *samples, struct outcome *outcome)
{
    const struct spec *spec = asked;
    outcome_begin(session, spec->algorithm->name, spec->text, spec->precision, outcome);
    enum status status =
        session->memory > 0 ? tiled_check("run", spec, session->scene) : session_resolve(session, spec, &spec);
    if (status != STATUS_OK) {
        outcome_fail(outcome, status);
        return;
    }
    struct problem problem = session_problem(session->scene, spec->algorithm, spec->precision);
    const struct echoes *echoes = &session->echoes[spec->precision];
    if (session->memory > 0)
        status = image_tiled(session, spec, outcome);
    else if (effort != EFFORT_NONE)
        status = image_time(session, spec, &problem, effort, samples, outcome);
    else
        status = imaging_form(spec, &problem, echoes, &outcome->image, &outcome->work);
    if (status == STATUS_OK) {
        work_fill(session, &problem, outcome);
        if (asked != spec)
            choice_fill(session_chosen(session, asked), outcome);
        status = quality_fill(session, outcome);
    }
    if (status == STATUS_OK) {
        warnings_fill(session, asked, spec, &problem, outcome);
        if (*outcome->noise)
            reason_add(outcome->reason, sizeof outcome->reason, "%s", outcome->noise);
    }
    if (status != STATUS_OK) {
        image_free(&outcome->image);
        outcome_fail(outcome, status);
    }
}

void outcome_free(struct outcome *outcome)
{
    image_free(&outcome->image);
    free(outcome->targets);
    *outcome = (struct outcome){0};
}
