/* Choosing among candidates (choice.h). The fastest that is within the budget by law is formed, and its error measured
   on a probe (imaging/probe.h). If it fails, its error over its law is how much brighter the echoes are than the image,
   which no law includes, and corrects the laws for the next. Back projection after the first is formed on the probe's
   pixels alone; range migration, whose images have no pixels of their own, whole. */
#include "choice/choice.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "methods/automatic.h"
#include "choice/candidates.h"
#include "choice/laws.h"
#include "choice/process.h"
#include "echoes/echo_data.h"
#include "imaging/imaging.h"

/* From this ratio of measured errors to their laws on, `reference` forms the exact image. */
static const double DARK = 3;
/* A setting of less than this share of the chosen one's time is measured, too. */
static const double PAYS = 0.8;
enum { LOOKS = 2 };

struct trial {
    struct setting setting;
    const struct echoes *echoes; /* [2]; NULL: laws alone */
    struct choice *choice;
    struct probe probe; /* made of the first image */
    bool probed, dark, limited;
    double exact; /* the error by law of the stand-in for the exact image; 0 of `reference` */
};

void candidate_name(const struct candidate *candidate, char text[CANDIDATE_NAME])
{
    snprintf(text, CANDIDATE_NAME, "%s%s%s", candidate->algorithm->name, *candidate->settings ? ":" : "",
             candidate->settings);
}

static enum status candidate_spec(const struct candidate *c, enum precision precision, struct spec *spec)
{
    char name[CANDIDATE_NAME], text[CANDIDATE_NAME + 24];
    candidate_name(c, name);
    snprintf(text, sizeof text, "%s%cprecision=%s", name, *c->settings ? ',' : ':',
             precision == PRECISION_FLOAT ? "float" : "double");
    return spec_parse(text, spec);
}

/* ---- the exact image on the probe ---- */

static enum status probe_again(struct trial *t, const struct image *pilot)
{
    struct spec spec;
    enum status status = laws_exact(&t->setting, t->dark, &spec, &t->exact);
    if (status != STATUS_OK)
        return status;
    status = t->probed ? probe_exact(&spec, t->setting.problem, &t->echoes[spec.precision], &t->probe)
                       : probe_make(&spec, t->setting.problem, &t->echoes[spec.precision], pilot,
                                    &t->setting.budget->region, &t->probe);
    t->probed = t->probed || status == STATUS_OK;
    spec_free(&spec);
    return status;
}

/* ---- one candidate ---- */

/* Its plan's work; out by memory where the process would take too much. */
static void work_take(struct trial *t, struct candidate *c, const struct problem *problem, const struct work *work)
{
    const double bytes = process_bytes(t->setting.problem, work->bytes);
    if (problem == t->setting.problem)
        c->bytes = bytes;
    if (bytes <= t->setting.budget->bytes)
        return;
    c->verdict = CANDIDATE_MEMORY;
    snprintf(c->reason, sizeof c->reason, "its process takes %.3g MB, more than %.3g MB", bytes / 1e6,
             t->setting.budget->bytes / 1e6);
}

/* *work of its plan, and its verdict by memory. */
static enum status candidate_plan(struct trial *t, struct candidate *c, struct work *work)
{
    const struct problem *problem = t->setting.problem;
    struct problem counted = *problem;
    struct spec spec;
    void *plan;
    enum status status = candidate_spec(c, problem->precision, &spec);
    if (status != STATUS_OK)
        return status;
    counted.estimate = true;
    status = algorithm_plan(spec.algorithm, &counted, spec.options, &plan);
    if (status == STATUS_OK) {
        *work = spec.algorithm->work(plan);
        spec.algorithm->destroy(plan);
        work_take(t, c, problem, work);
    }
    spec_free(&spec);
    return status;
}

/* Form its image of the problem, and *work of its plan; the image is empty where it is out by memory or refused. */
static enum status candidate_form(struct trial *t, struct candidate *c, const struct problem *problem,
                                  struct image *image, struct work *work)
{
    const enum precision precision = problem->precision;
    struct candidate formed = *c;
    struct spec spec;
    struct imaging imaging;
    struct stages stages;
    if (problem != t->setting.problem) /* few pixels pay neither for tables nor for what stands for taps or delays */
        candidate_set(&formed, "exact", "true");
    enum status status = candidate_spec(&formed, precision, &spec);
    if (status != STATUS_OK)
        return status;
    struct problem counted = *problem;
    counted.estimate = true;
    status = imaging_open(&spec, &counted, &imaging);
    if (status == STATUS_OK) {
        *work = spec.algorithm->work(imaging.plan);
        work_take(t, c, problem, work);
        if (c->verdict != CANDIDATE_MEMORY) {
            stages_begin(&stages);
            status = imaging_execute(&imaging, &t->echoes[precision], &stages);
            if (status == STATUS_OK)
                status = imaging_finish(&imaging, &t->echoes[precision], image);
        }
        imaging_close(&imaging);
    }
    spec_free(&spec);
    return status;
}

static void back_projections_compare(struct trial *t)
{
    for (int k = 0; k < t->choice->count; k++) {
        struct candidate *c = &t->choice->list[k];
        if (c->measured.pixels == 0 && c->forecast.sums_pairs && !laws_open(c)
            && (c->verdict == CANDIDATE_SLOWER || c->verdict == CANDIDATE_ERROR))
            laws_compare(&t->setting, c);
    }
}

/* All range migrations of one spectrum are over the budget if one exceeds it by more than its settings' error. */
static void migrations_compare(struct trial *t, const struct candidate *failed)
{
    const double error = t->setting.budget->error, own = forecast_error(&failed->forecast);
    char name[CANDIDATE_NAME];
    if (pow(failed->error, 2) - own * own <= error * error)
        return;
    candidate_name(failed, name);
    for (int k = 0; k < t->choice->count; k++) {
        struct candidate *c = &t->choice->list[k];
        if (c->verdict == CANDIDATE_SLOWER && !laws_sums(c) && !c->budgeted) {
            c->verdict = CANDIDATE_ERROR;
            snprintf(c->reason, sizeof c->reason, "over the budget of %.2g by its spectrum, as %s is", error, name);
        }
    }
}

/* Use the measured error, with `beside` for what the measurement leaves out. NAN, of an image of zeros, leaves the
   law's. */
static void measured_take(struct trial *t, struct candidate *c, const struct probe_error *measured, double beside)
{
    const double budget = t->setting.budget->error, law = forecast_error(&c->forecast);
    c->measured = *measured;
    if (isnan(measured->error_gain)) {
        c->error = law;
        return;
    }
    c->error = hypot(measured->error_gain, hypot(t->exact, beside));
    if (c->forecast.sums_pairs && !c->budgeted)
        t->setting.ratio = c->error / law;
    /* Half of the interval is kept clear, since a true error may lie above its estimate. */
    if (hypot(sqrt(measured->error_gain * measured->high), beside) <= budget)
        return;
    c->verdict = CANDIDATE_ERROR;
    snprintf(c->reason, sizeof c->reason,
             "error %.2g (%.2g to %.2g), measured on %d pixels, is over the budget of %.2g", c->error, measured->low,
             measured->high, measured->pixels, budget);
}

/* Update the others after one that failed. */
static enum status failure_learn(struct trial *t, struct candidate *c)
{
    if (!c->forecast.sums_pairs) {
        migrations_compare(t, c);
        return STATUS_OK;
    }
    back_projections_compare(t);
    if (t->dark || !(t->setting.ratio > DARK))
        return STATUS_OK;
    t->dark = true;
    return probe_again(t, NULL);
}

/* Do the probe's pixels, back projected, represent the whole image? */
static bool by_pixels(const struct trial *t, const struct candidate *c)
{
    return t->probed && !t->probe.whole && c->forecast.sums_pairs && !(c->forecast.image_cost > 0);
}

/* Measure it: on the probe's pixels, or on the whole image, which goes to *image. */
static enum status candidate_measure(struct trial *t, struct candidate *c, struct image *image, struct work *work)
{
    const struct problem *problem = t->setting.problem;
    struct probe_error measured;
    *image = (struct image){0};
    enum status status;
    if (by_pixels(t, c)) {
        struct image part;
        const struct problem pixels = probe_problem(&t->probe, problem);
        status = candidate_form(t, c, &pixels, &part, work);
        if (status == STATUS_OK && c->verdict == CANDIDATE_SLOWER) {
            measured = probe_measure_pixels(&t->probe, &part);
            measured_take(t, c, &measured, c->forecast.error[CAUSE_DELAYS]);
            image_free(&part);
        }
        return status;
    }
    status = candidate_form(t, c, problem, image, work);
    if (status != STATUS_OK || c->verdict != CANDIDATE_SLOWER)
        return status;
    if (!t->probed)
        status = probe_again(t, image);
    if (status == STATUS_OK) {
        measured = probe_measure(&t->probe, image);
        measured_take(t, c, &measured, 0);
    }
    if (status != STATUS_OK || c->verdict != CANDIDATE_SLOWER)
        image_free(image);
    return status;
}

/* The fastest so far: chosen, or out with its reason. */
static enum status candidate_try(struct trial *t, struct candidate *c)
{
    struct choice *choice = t->choice;
    const bool form = t->echoes && c->seconds <= t->setting.budget->seconds;
    struct image image = {0};
    struct work work;
    enum status status = STATUS_OK;
    if (!laws_counted(c))
        return laws_count(&t->setting, c);
    if (laws_open(c) && (!form || laws_sums(c)))
        return laws_complete(&t->setting, c);
    if (!t->limited && c->forecast.sums_pairs) {
        t->limited = true;
        return laws_limit(&t->setting, choice, c);
    }
    if (form)
        status = candidate_measure(t, c, &image, &work);
    const bool whole = image.patch_count > 0;
    if (status == STATUS_OK && c->verdict == CANDIDATE_SLOWER && !whole)
        status = candidate_plan(t, c, &work);
    if (status == STATUS_UNSUPPORTED)
        return laws_refused(c, status);
    if (status == STATUS_OK && c->verdict == CANDIDATE_MEMORY)
        status = laws_without_tables(&t->setting, c, choice);
    else if (status == STATUS_OK && c->verdict == CANDIDATE_ERROR)
        status = failure_learn(t, c);
    if (status != STATUS_OK || c->verdict != CANDIDATE_SLOWER) {
        image_free(&image);
        return status;
    }
    image_free(&choice->image);
    choice->image = image;
    choice->work = work;
    choice->found = true;
    return STATUS_OK;
}

/* ---- all of them ---- */

/* If the law, an upper bound, leaves none: the back projection of least error. */
static struct candidate *least_by_law(struct choice *choice)
{
    struct candidate *best = NULL;
    for (int k = 0; k < choice->count; k++) {
        struct candidate *c = &choice->list[k];
        if (c->verdict == CANDIDATE_ERROR && c->forecast.sums_pairs && c->measured.pixels == 0
            && (!best || c->error < best->error))
            best = c;
    }
    if (best)
        best->verdict = CANDIDATE_SLOWER;
    return best;
}

/* A faster one than the choice, now that laws are known to exceed what is measured. */
static enum status faster_look(struct trial *t, struct candidate **chosen)
{
    enum status status = STATUS_OK;
    if (!(*chosen)->forecast.sums_pairs || (*chosen)->measured.pixels == 0 || !(t->setting.ratio < 1))
        return STATUS_OK;
    back_projections_compare(t);
    for (int k = 0; k < LOOKS && status == STATUS_OK; k++) {
        struct candidate *c = laws_next(t->choice);
        if (c == *chosen || !c->forecast.sums_pairs || c->forecast.image_cost > 0
            || !(c->seconds < PAYS * (*chosen)->seconds))
            return STATUS_OK;
        status = candidate_try(t, c);
        if (status == STATUS_OK && c->verdict == CANDIDATE_SLOWER)
            *chosen = c;
    }
    return status;
}

static enum status trial_run(struct trial *t, struct candidate **chosen)
{
    struct choice *choice = t->choice;
    bool least = false;
    enum status status = STATUS_OK;
    while (status == STATUS_OK && !choice->found) {
        *chosen = laws_next(choice);
        if (!*chosen && t->echoes && !least) {
            least = true;
            *chosen = least_by_law(choice);
        }
        if (!*chosen)
            return STATUS_OK;
        status = candidate_try(t, *chosen);
    }
    return status == STATUS_OK && t->echoes ? faster_look(t, chosen) : status;
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
        if (c->verdict != CANDIDATE_SLOWER)
            continue;
        if (laws_open(c) && ratio < 1)
            snprintf(c->reason, sizeof c->reason,
                     "may take %.2f times the chosen one's time, or more; to find out takes longer", ratio);
        else if (laws_open(c))
            snprintf(c->reason, sizeof c->reason, "%.2f times the chosen one's time%s, whatever its error", ratio,
                     c->budgeted ? " or more" : "");
        else
            snprintf(c->reason, sizeof c->reason, "within the budget, %.2f times the chosen one's time", ratio);
    }
}

static void choice_finish(struct choice *choice, struct candidate *chosen)
{
    int kept = 0;
    if (choice->found)
        chosen->verdict = CANDIDATE_CHOSEN;
    for (int k = 0; k < choice->count; k++)
        if (laws_counted(&choice->list[k]) || choice->list[k].budgeted)
            choice->list[kept++] = choice->list[k];
    choice->count = kept;
    for (int k = 0; k < choice->count; k++)
        choice->least = fmin(choice->least, choice->list[k].error);
    qsort(choice->list, (size_t)choice->count, sizeof *choice->list, compare);
    if (choice->found)
        reasons_fill(choice);
}

enum status choice_make(const struct problem *problem, const struct echoes *echoes, const struct budget *budget,
                        struct choice *choice)
{
    struct trial t = {.setting = {.problem = problem, .budget = budget}, .echoes = echoes, .choice = choice};
    struct candidate *chosen = NULL;
    *choice = (struct choice){.least = INFINITY, .list = malloc(CANDIDATES_MAX * sizeof *choice->list)};
    enum status status = choice->list ? STATUS_OK : status_set(STATUS_FAILED, "no memory for the candidates of a plan");
    if (status == STATUS_OK)
        status = laws_fill(&t.setting, choice);
    if (status == STATUS_OK)
        status = trial_run(&t, &chosen);
    for (int k = 0; k < choice->count && budget->all && status == STATUS_OK; k++)
        if (!choice->list[k].budgeted && choice->list[k].verdict == CANDIDATE_SLOWER && &choice->list[k] != chosen)
            status = (laws_sums(&choice->list[k]) ? laws_complete : laws_count)(&t.setting, &choice->list[k]);
    probe_free(&t.probe);
    if (status == STATUS_OK)
        choice_finish(choice, chosen);
    else
        choice_free(choice);
    return status;
}

void choice_free(struct choice *choice)
{
    image_free(&choice->image);
    free(choice->list);
    *choice = (struct choice){.list = NULL};
}

bool choice_asked(const struct spec *spec, struct budget *budget)
{
    if (spec->algorithm != &automatic)
        return false;
    const struct automatic_options *options = spec->options;
    *budget = (struct budget){.error = options->error, .bytes = 1e9 * options->memory, .seconds = INFINITY};
    return true;
}

enum status choice_spec(const struct choice *choice, const struct budget *budget, enum precision precision,
                        struct spec *chosen)
{
    const struct candidate *best = NULL;
    char name[CANDIDATE_NAME];
    if (choice->found)
        return candidate_spec(&choice->list[0], precision, chosen);
    for (int k = 0; k < choice->count; k++)
        if (choice->list[k].error < INFINITY && choice->list[k].error == choice->least)
            best = &choice->list[k];
    if (!best)
        return status_set(STATUS_UNSUPPORTED, "auto: every candidate is refused; the first: %s",
                          choice->list[0].reason);
    candidate_name(best, name);
    return status_set(STATUS_UNSUPPORTED,
                      "auto: condition budget: no candidate has an error of at most %.3g in %.3g GB; the least is "
                      "%.3g, of %s (cure: a larger error, or more memory)",
                      budget->error, 1e-9 * budget->bytes, best->error, name);
}

enum status choice_resolve(const struct spec *spec, const struct problem *problem, const struct echoes *echoes,
                           struct spec *resolved)
{
    struct budget budget;
    struct choice choice;
    if (!choice_asked(spec, &budget))
        return spec_copy(spec, resolved);
    enum status status = choice_make(problem, echoes, &budget, &choice);
    if (status == STATUS_OK) {
        status = choice_spec(&choice, &budget, spec->precision, resolved);
        choice_free(&choice);
    }
    return status;
}
