/* One scene ready for imaging, and the quality of its images (session.h). */
#include "measure/session.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "data/echo_data.h"
#include "measure/metrics.h"
#include "scene/simulate.h"
#include "measure/timing.h"

enum { AXES = 2, DEFINITIONS = 3 };
static const char *const axis_names[AXES] = {[AXIS_AZIMUTH] = "azimuth", [AXIS_RANGE] = "range"};
static const char *const definition_names[DEFINITIONS] = {
    [DEFINITION_NULL] = "null", [DEFINITION_3DB] = "3db", [DEFINITION_PIXEL] = "pixel"};

/* Where images are compared: the scene's own patches, or the part of a whole swath around its targets. */
static struct problem compared_problem(const struct scene *scene, enum precision precision)
{
    if (scene->reference_count)
        return (struct problem){&scene->acquisition, scene->reference_count, scene->reference_patches, precision};
    return (struct problem){&scene->acquisition, scene->patch_count, scene->patches, precision};
}

struct problem session_problem(const struct scene *scene, const struct algorithm *algorithm, enum precision precision)
{
    if (algorithm->traits & TRAIT_EXACT)
        return compared_problem(scene, precision);
    return (struct problem){&scene->acquisition, scene->patch_count, scene->patches, precision};
}

enum status session_image(const struct session *session, const struct spec *spec, struct image *image,
                          struct work *work)
{
    void *plan;
    struct stages stages;
    struct problem problem = session_problem(session->scene, spec->algorithm, spec->precision);
    *image = (struct image){0};
    enum status status = spec->algorithm->plan(&problem, spec->options, &plan);
    if (status != STATUS_OK)
        return status;
    if (work)
        *work = spec->algorithm->work(plan);
    status = image_allocate(problem.patch_count, problem.patches, spec->precision, image);
    stages_begin(&stages);
    if (status == STATUS_OK)
        status = spec->algorithm->execute(plan, &session->echoes[spec->precision], image, &stages);
    if (status == STATUS_OK)
        status = image_scale(image, session->echoes[spec->precision].exponent);
    spec->algorithm->destroy(plan);
    if (status != STATUS_OK)
        image_free(image);
    return status;
}

/* What refuses the exact image may well allow others. */
static enum status form_reference(struct session *session)
{
    struct spec spec;
    enum status status = spec_parse("reference:precision=double", &spec);
    if (status != STATUS_OK)
        return status;
    status = session_image(session, &spec, &session->reference, NULL);
    if (status == STATUS_OK && !image_is_finite(&session->reference)) {
        image_free(&session->reference);
        status = status_set(STATUS_FAILED, "it holds values that are not finite");
    }
    if (status != STATUS_OK)
        snprintf(session->no_reference, sizeof session->no_reference, "%s", status_message());
    spec_free(&spec);
    return STATUS_OK;
}

enum status session_open(const struct scene *scene, struct session *session)
{
    *session = (struct session){.scene = scene};
    enum status status = scene_simulate(scene, &session->echoes[PRECISION_DOUBLE]);
    if (status == STATUS_OK)
        status = echoes_convert(&session->echoes[PRECISION_DOUBLE], PRECISION_FLOAT, &session->echoes[PRECISION_FLOAT]);
    if (status == STATUS_OK)
        status = form_reference(session);
    if (status != STATUS_OK)
        session_close(session);
    return status;
}

void session_close(struct session *session)
{
    image_free(&session->reference);
    echoes_free(&session->echoes[PRECISION_FLOAT]);
    echoes_free(&session->echoes[PRECISION_DOUBLE]);
}

struct measurement measurement_empty(const char *scene, const char *algorithm, const char *options,
                                     enum precision precision)
{
    return (struct measurement){.scene = scene,
                                .algorithm = algorithm,
                                .options = options,
                                .precision = precision_name(precision),
                                .threads = -1,
                                .engine = "",
                                .status = "ok",
                                .reason = "",
                                .skipped = "",
                                .plan_s = NAN,
                                .run_s = NAN,
                                .run_min_s = NAN,
                                .runs = -1,
                                .control_s = NAN,
                                .stages = "",
                                .flops_published = NAN,
                                .flops = NAN,
                                .pairs = NAN,
                                .bytes = NAN,
                                .error = NAN,
                                .error_gain = NAN,
                                .phase_rms_rad = NAN,
                                .width_m = NAN,
                                .pslr_db = NAN,
                                .islr_db = NAN};
}

/* The rows of one target, and its azimuth slice by the primary definition. Returns how many rows. */
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

/* One more reason, behind those that are there. */
static void __attribute__((format(printf, 3, 4))) reason_add(char *reason, size_t size, const char *format, ...)
{
    size_t used = strlen(reason);
    va_list arguments;
    va_start(arguments, format);
    if (used > 0 && used < size - 1)
        used += (size_t)snprintf(reason + used, size - used, "; ");
    if (used < size)
        vsnprintf(reason + used, size - used, format, arguments);
    va_end(arguments);
}

enum status session_quality(const struct session *session, const struct image *image, struct measurement *row,
                            char *reason, size_t reason_size, struct target_row **targets, int *count)
{
    int points = session->scene->point_count, defined = 0, unmeasured = 0;
    double *values = calloc(3 * (size_t)points + 1, sizeof *values);
    *targets = calloc((size_t)points * AXES * DEFINITIONS + 1, sizeof **targets);
    *count = 0;
    if (!*targets || !values) {
        free(values);
        free(*targets);
        *targets = NULL;
        return status_set(STATUS_FAILED, "%s: no memory for %d targets", session->scene->name, points);
    }
    struct error_metrics error = metrics_error(image, &session->reference);
    row->error = error.error;
    row->error_gain = error.error_gain;
    row->phase_rms_rad = error.phase_rms_rad;
    if (*session->no_reference)
        reason_add(reason, reason_size, "no errors, for there is no exact image: %s", session->no_reference);
    else if (*error.reason)
        reason_add(reason, reason_size, "%s", error.reason);
    if (points == 0)
        reason_add(reason, reason_size, "no point targets to measure lobes of");
    double *width = values, *pslr = values + points, *islr = values + 2 * points;
    for (int t = 0; t < points; t++) {
        struct slice_metrics azimuth;
        *count += target_rows(session, image, t, row, *targets + *count, &azimuth);
        if (*azimuth.reason && unmeasured++ == 0)
            reason_add(reason, reason_size, "target %d: %s", t + 1, azimuth.reason);
        if (isfinite(azimuth.pslr_db[DEFINITION_NULL])) {
            width[defined] = azimuth.width_m;
            pslr[defined] = azimuth.pslr_db[DEFINITION_NULL];
            islr[defined] = azimuth.islr_db[DEFINITION_NULL];
            defined++;
        }
    }
    if (unmeasured > 1)
        reason_add(reason, reason_size, "%d more targets likewise", unmeasured - 1);
    row->width_m = median(width, defined);
    row->pslr_db = median(pslr, defined);
    row->islr_db = median(islr, defined);
    free(values);
    return STATUS_OK;
}
