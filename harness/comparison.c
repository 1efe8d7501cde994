/* Scenes measured with algorithms (comparison.h). */
#include "comparison.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../algorithms/pairs.h"
#include "echo_data.h"
#include "metrics.h"
#include "pictures.h"
#include "simulate.h"
#include "table.h"
#include "task.h"
#include "timing.h"

enum { AXES = 2, DEFINITIONS = 3 };
static const char *const axis_names[AXES] = {[AXIS_AZIMUTH] = "azimuth", [AXIS_RANGE] = "range"};
static const char *const definition_names[DEFINITIONS] = {
    [DEFINITION_NULL] = "null", [DEFINITION_3DB] = "3db", [DEFINITION_PIXEL] = "pixel"};

/* One scene while its algorithms run. */
struct session {
    const struct scene *scene;
    const struct spec *specs;
    int spec_count;
    struct echoes echoes[2];            /* by enum precision */
    struct image reference;             /* double, on the reference patches */
    struct pictures pictures;           /* all zero when none are drawn */
    struct work *works;                 /* [spec_count] of the algorithms measured now; flops 0 otherwise */
};

/* Where images are compared: the scene's own patches, or the part of a whole swath around its targets. */
static struct problem compared_problem(const struct scene *scene, enum precision precision)
{
    if (scene->reference_count)
        return (struct problem){&scene->acquisition, scene->reference_count, scene->reference_patches, precision};
    return (struct problem){&scene->acquisition, scene->patch_count, scene->patches, precision};
}

/* What an algorithm images: exact ones are too slow for a whole swath and only image what is compared. */
static struct problem spec_problem(const struct scene *scene, const struct spec *spec)
{
    if (spec->algorithm->traits & TRAIT_EXACT)
        return compared_problem(scene, spec->precision);
    return (struct problem){&scene->acquisition, scene->patch_count, scene->patches, spec->precision};
}

static enum status image_once(const struct spec *spec, const struct problem *problem, const struct echoes *echoes,
                              struct image *image)
{
    void *plan;
    struct stages stages;
    enum status status = spec->algorithm->plan(problem, spec->options, &plan);
    if (status != STATUS_OK)
        return status;
    stages_begin(&stages);
    status = spec->algorithm->execute(plan, echoes, image, &stages);
    spec->algorithm->destroy(plan);
    return status;
}

static void session_close(struct session *session)
{
    pictures_free(&session->pictures);
    free(session->works);
    image_free(&session->reference);
    echoes_free(&session->echoes[PRECISION_FLOAT]);
    echoes_free(&session->echoes[PRECISION_DOUBLE]);
}

/* Echoes in both precisions and the exact image. On failure the session is closed. */
static enum status session_open(const struct comparison *comparison, const struct scene *scene, int spec_count,
                                const struct spec *specs, struct session *session)
{
    struct spec spec;
    struct problem problem = compared_problem(scene, PRECISION_DOUBLE);
    *session = (struct session){.scene = scene, .specs = specs, .spec_count = spec_count};
    enum status status = spec_parse("reference:precision=double", &spec);
    if (status != STATUS_OK)
        return status;
    session->works = calloc((size_t)spec_count, sizeof *session->works);
    if (!session->works)
        status = status_set(STATUS_FAILED, "%s: no memory for %d algorithms", scene->name, spec_count);
    if (status == STATUS_OK && comparison->details)
        status = pictures_begin(comparison->directory, scene, spec_count, &session->pictures);
    if (status == STATUS_OK)
        status = scene_simulate(scene, &session->echoes[PRECISION_DOUBLE]);
    if (status == STATUS_OK)
        status = echoes_convert(&session->echoes[PRECISION_DOUBLE], PRECISION_FLOAT, &session->echoes[PRECISION_FLOAT]);
    if (status == STATUS_OK)
        status = image_allocate(problem.patch_count, problem.patches, PRECISION_DOUBLE, &session->reference);
    if (status == STATUS_OK)
        status = image_once(&spec, &problem, &session->echoes[PRECISION_DOUBLE], &session->reference);
    spec_free(&spec);
    if (status != STATUS_OK)
        session_close(session);
    return status;
}

static void spec_label(const struct spec *spec, char *label, size_t size)
{
    snprintf(label, size, "%s%s%s%s", spec->algorithm->name, *spec->text ? ":" : "", spec->text,
             spec->precision == PRECISION_DOUBLE ? " double" : "");
}

static void draw(struct session *session, int index, const struct image *image)
{
    char label[320];
    if (!session->pictures.lines)
        return;
    spec_label(&session->specs[index], label, sizeof label);
    pictures_add(&session->pictures, index, label, image);
}

/* Rows of targets.csv for an image, and the medians of the primary measures into the measurement. `reason` receives why
   something is undefined. */
static enum status measure_targets(const struct comparison *comparison, const struct session *session, const struct image *image,
                                   struct measurement *row, char *reason, size_t reason_size)
{
    const struct scene *scene = session->scene;
    const struct acquisition *a = &scene->acquisition;
    int points = scene->point_count, count = 0, defined = 0;
    struct target_row *rows = calloc((size_t)points * AXES * DEFINITIONS + 1, sizeof *rows);
    double *values = calloc(3 * (size_t)points + 1, sizeof *values);
    if (!rows || !values) {
        free(rows);
        free(values);
        return status_set(STATUS_FAILED, "%s: no memory for %d targets", scene->name, points);
    }
    double *width = values, *pslr = values + points, *islr = values + 2 * points;
    for (int t = 0; t < points; t++) {
        const struct target *target = &scene->targets[t];
        double complex here = metrics_value(image, a, target->x, target->r);
        double complex exact = metrics_value(&session->reference, a, target->x, target->r);
        for (int axis = 0; axis < AXES; axis++) {
            struct slice_metrics m = metrics_slice(image, a, target, (enum axis)axis);
            if (axis == AXIS_AZIMUTH && *m.reason)
                snprintf(reason, reason_size, "target %d: %s", t + 1, m.reason);
            for (int d = 0; d < DEFINITIONS; d++)
                if (d != DEFINITION_PIXEL || axis == AXIS_AZIMUTH)
                    rows[count++] = (struct target_row){
                        row->scene, row->algorithm, row->options, row->precision, t, axis_names[axis],
                        definition_names[d], m.extent_m, m.position_error_m, carg(here * conj(exact)), m.width_m,
                        m.pslr_db[d], m.islr_db[d]};
            if (axis == AXIS_AZIMUTH && isfinite(m.pslr_db[DEFINITION_NULL])) {
                width[defined] = m.width_m;
                pslr[defined] = m.pslr_db[DEFINITION_NULL];
                islr[defined] = m.islr_db[DEFINITION_NULL];
                defined++;
            }
        }
    }
    row->width_m = median(width, defined);
    row->pslr_db = median(pslr, defined);
    row->islr_db = median(islr, defined);
    enum status status = record_targets(comparison->record, rows, count);
    free(rows);
    free(values);
    return status;
}

static void format_stages(const struct stages *stages, char *text, size_t size)
{
    size_t used = 0;
    *text = 0;
    for (int k = 0; k < stages->count && used < size; k++)
        used += (size_t)snprintf(text + used, size - used, "%s%s=%.4g", k ? ";" : "", stages->stage[k].name,
                                 stages->stage[k].seconds);
}

/* Measure one algorithm on one scene, record and draw it. Only a fault of the record itself is an error: what fails or
   is unsupported becomes a row. */
static enum status measure(struct comparison *comparison, struct session *session, int index)
{
    const struct spec *spec = &session->specs[index];
    const struct scene *scene = session->scene;
    struct problem problem = spec_problem(scene, spec), whole = {&scene->acquisition, scene->patch_count,
                                                                 scene->patches, spec->precision};
    struct timing timing = {0};
    struct image image = {0};
    char stages[512] = "", skipped[400] = "", reason[512] = "";
    struct measurement row = {
        .scene = scene->name, .algorithm = spec->algorithm->name, .options = spec->text,
        .precision = precision_name(spec->precision), .threads = comparison->threads, .engine = "", .status = "ok",
        .plan_s = NAN, .run_s = NAN, .run_min_s = NAN, .runs = -1, .control_s = NAN, .flops_published = NAN,
        .flops = NAN, .pairs = NAN, .bytes = NAN, .error = NAN, .error_gain = NAN, .phase_rms_rad = NAN,
        .width_m = NAN, .pslr_db = NAN, .islr_db = NAN, .stages = stages, .skipped = skipped, .reason = reason};
    enum status status = image_allocate(problem.patch_count, problem.patches, spec->precision, &image);
    if (status == STATUS_OK)
        status = timing_measure(spec->algorithm, &problem, spec->options, &session->echoes[spec->precision],
                                &session->echoes[PRECISION_FLOAT], &image, &timing);
    if (status == STATUS_OK) {
        struct error_metrics error = metrics_error(&image, &session->reference);
        row.error = error.error;
        row.error_gain = error.error_gain;
        row.phase_rms_rad = error.phase_rms_rad;
        row.plan_s = timing.plan_s;
        row.run_s = timing.run_s;
        row.run_min_s = timing.run_min_s;
        row.runs = timing.runs;
        row.control_s = timing.control_s;
        row.flops = timing.work.flops;
        row.flops_published = timing.work.published[0].source ? timing.work.published[0].flops : NAN;
        row.pairs = timing.work.pairs;
        row.bytes = timing.work.bytes;
        row.engine = timing.work.engine;
        session->works[index] = timing.work;
        format_stages(&timing.stages, stages, sizeof stages);
        double left_out = 1 - problem_pixels(&problem) / problem_pixels(&whole);
        if (left_out > 0)
            snprintf(skipped, sizeof skipped, "%.3g %% of the pixels: only the patches around the targets are compared",
                     100 * left_out);
        if (*timing.work.skipped)
            snprintf(skipped + strlen(skipped), sizeof skipped - strlen(skipped), "%s%s", *skipped ? "; " : "",
                     timing.work.skipped);
        if (!image_is_finite(&image))
            status = status_set(STATUS_FAILED, "the image holds values that are not finite");
    }
    if (status == STATUS_OK) {
        status = measure_targets(comparison, session, &image, &row, reason, sizeof reason);
        if (status == STATUS_OK)
            draw(session, index, &image);
    } else {
        row.status = status == STATUS_UNSUPPORTED ? "unsupported" : "failed";
        comparison->failed |= status != STATUS_UNSUPPORTED;
        snprintf(reason, sizeof reason, "%s", status_message());
        status = STATUS_OK;
    }
    image_free(&image);
    if (status == STATUS_OK)
        status = record_add(comparison->record, &row);
    if (status == STATUS_OK)
        table_row(stdout, &row);
    return status;
}

static void print_works(const struct session *session)
{
    char label[320];
    for (int k = 0; k < session->spec_count; k++)
        if (session->works[k].flops > 0) {
            spec_label(&session->specs[k], label, sizeof label);
            table_work(stdout, label, &session->works[k]);
        }
}

static void progress(const struct comparison *comparison, const char *scene, const char *what)
{
    if (isatty(STDERR_FILENO))
        fprintf(stderr, "\r\033[K[%d/%d] %s %s\r", comparison->done + 1, comparison->rows, scene, what);
}

static void progress_clear(void)
{
    if (isatty(STDERR_FILENO))
        fprintf(stderr, "\r\033[K");
}

const struct measurement *comparison_find(const struct comparison *comparison, const struct scene *scene,
                                          const struct spec *spec)
{
    return record_find(comparison->record, scene->name, spec->algorithm->name, spec->text,
                       precision_name(spec->precision));
}

/* A row that an earlier run finished is not timed again; its image is, for the overlaid slices. */
static enum status redraw(struct session *session, int index, const struct measurement *row)
{
    struct problem problem = spec_problem(session->scene, &session->specs[index]);
    struct image image = {0};
    if (strcmp(row->status, "ok") != 0)
        return STATUS_OK;
    enum status status = image_allocate(problem.patch_count, problem.patches, problem.precision, &image);
    if (status == STATUS_OK)
        status = image_once(&session->specs[index], &problem, &session->echoes[problem.precision], &image);
    if (status == STATUS_OK)
        draw(session, index, &image);
    image_free(&image);
    return status;
}

enum status comparison_scene(struct comparison *comparison, const struct scene *scene, int spec_count,
                             const struct spec *specs)
{
    struct session session;
    int missing = 0;
    enum status status = record_scene(comparison->record, scene->name, scene->hash);
    for (int k = 0; k < spec_count; k++)
        missing += !comparison_find(comparison, scene, &specs[k]);
    if (status == STATUS_OK && missing > 0) {
        progress(comparison, scene->name, "echoes and exact image");
        status = session_open(comparison, scene, spec_count, specs, &session);
    }
    if (status != STATUS_OK)
        return status;
    for (int k = 0; k < spec_count && status == STATUS_OK; k++, comparison->done++) {
        const struct measurement *row = comparison_find(comparison, scene, &specs[k]);
        progress(comparison, scene->name, specs[k].algorithm->name);
        if (!row)
            status = measure(comparison, &session, k);
        else if (missing > 0 && comparison->details)
            status = redraw(&session, k, row);
        progress_clear();
        if (row && status == STATUS_OK) {
            table_row(stdout, row);
            comparison->failed |= strcmp(row->status, "failed") == 0;
        }
        fflush(stdout);
    }
    if (missing > 0) {
        if (status == STATUS_OK && comparison->details) {
            pictures_slices(&session.pictures);
            print_works(&session);
        }
        session_close(&session);
    }
    return status;
}

enum status comparison_open(const char *directory, int rows, bool details, struct comparison *comparison)
{
    struct provenance provenance;
    *comparison = (struct comparison){
        .directory = directory, .threads = omp_get_max_threads(), .details = details, .rows = rows};
    provenance_fill(&provenance, comparison->threads);
    enum status status = record_open(directory, &provenance, &comparison->record);
    if (status == STATUS_OK)
        table_header(stdout);
    return status;
}

enum status comparison_close(struct comparison *comparison, enum status status)
{
    if (!comparison->record)
        return status;
    record_close(comparison->record);
    comparison->record = NULL;
    if (status == STATUS_OK && comparison->failed)
        status = status_set(STATUS_FAILED, "at least one algorithm failed; the table and %s/measurements.csv say why",
                            comparison->directory);
    return status;
}

void scenes_free(struct scene *scenes, int count)
{
    for (int k = 0; k < count; k++)
        scene_free(&scenes[k]);
    free(scenes);
}

enum status scenes_load(const char *command, int given_count, const char *const *given, struct scene **scenes,
                        int *count)
{
    char **names = NULL;
    int name_count = 0;
    enum status status = STATUS_OK;
    if (given_count == 0)
        status = scene_names(SCENE_DIRECTORY, &names, &name_count);
    const char *const *list = given_count ? given : (const char *const *)names;
    int total = given_count ? given_count : name_count;
    *count = 0;
    *scenes = calloc((size_t)total + 1, sizeof **scenes);
    if (status == STATUS_OK && !*scenes)
        status = status_set(STATUS_FAILED, "no memory for %d scenes", total);
    for (int k = 0; k < total && status == STATUS_OK; k++) {
        status = scene_load(list[k], SCENE_DIRECTORY, &(*scenes)[*count]);
        for (int before = 0; before < *count && status == STATUS_OK; before++)
            if (strcmp((*scenes)[before].name, (*scenes)[*count].name) == 0) {
                status = status_set(STATUS_INVALID, "%s: scene %s is given twice, must be named once",
                                    command, list[k]);
                scene_free(&(*scenes)[*count]);
            }
        if (status != STATUS_OK)
            break;
        if (given_count == 0 && (*scenes)[*count].full_size)
            scene_free(&(*scenes)[*count]);
        else
            ++*count;
    }
    scene_names_free(names, name_count);
    return status;
}
