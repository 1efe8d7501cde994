/* A results folder as input of the papers' tables and claims (measured.h). */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "echoes/echo_data.h"
#include "files/paths.h"
#include "imaging/spec.h"
#include "papers/measured.h"
#include "papers/assumptions.h"
#include "papers/phase.h"

static enum status results_read_if(const char *directory, const char *name, struct results *results)
{
    char path[4200];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    return access(path, F_OK) == 0 ? results_read(path, results) : STATUS_OK;
}

enum status measured_read(const char *directory, struct measured *measured)
{
    char path[4200];
    *measured = (struct measured){0};
    enum status status = published_read(&measured->published);
    if (status == STATUS_OK)
        status = results_read_if(directory, "measurements.csv", &measured->measurements);
    if (status == STATUS_OK)
        status = results_read_if(directory, "targets.csv", &measured->targets);
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        phase_path(directory, assumed_scene_name(phase_setups[k]), ".csv", path, sizeof path);
        if (access(path, F_OK) == 0)
            status = csv_read(path, CSV_TAIL_KEEP, &measured->phase[k]);
    }
    snprintf(path, sizeof path, "%s/%s", directory, RULES_FILE);
    if (status == STATUS_OK && access(path, F_OK) == 0)
        status = csv_read(path, CSV_TAIL_KEEP, &measured->rules);
    return status;
}

void measured_free(struct measured *measured)
{
    results_free(&measured->measurements);
    results_free(&measured->targets);
    csv_free(&measured->phase[PHASE_SHORT]);
    csv_free(&measured->phase[PHASE_LONG]);
    csv_free(&measured->rules);
    csv_free(&measured->published);
}

/* Only the first reason is kept: it explains the others. */
double measured_missing(struct measured *measured, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    if (!*measured->missing)
        vsnprintf(measured->missing, sizeof measured->missing, format, arguments);
    va_end(arguments);
    return NAN;
}

/* The row of a SPEC on a scene, of any status; NULL if there is none or the SPEC is invalid (*valid: false). */
static const struct measurement *row_find(const struct measured *measured, const char *scene, const char *spec_text,
                                          bool *valid)
{
    struct spec spec;
    const struct measurement *row = NULL;
    const char *assumed = assumed_scene_name(scene);
    *valid = spec_own(spec_text, &spec) == STATUS_OK;
    for (int k = 0; *valid && k < measured->measurements.csv.row_count && !row; k++) {
        const struct measurement *m = &measured->measurements.measurements[k];
        if (strcmp(m->scene, assumed) == 0 && strcmp(m->algorithm, spec.algorithm->name) == 0
            && strcmp(m->options, spec.text) == 0 && strcmp(m->precision, precision_name(spec.precision)) == 0)
            row = m;
    }
    if (*valid)
        spec_free(&spec);
    return row;
}

const struct measurement *measured_row(const struct measured *measured, const char *scene, const char *spec)
{
    bool valid;
    const struct measurement *row = row_find(measured, scene, spec, &valid);
    return row && strcmp(row->status, "ok") == 0 ? row : NULL;
}

/* The measurement, if it exists and is ok. */
static const struct measurement *measurement_find(struct measured *measured, const char *scene, const char *spec_text)
{
    bool valid;
    const struct measurement *row = row_find(measured, scene, spec_text, &valid);
    if (row && strcmp(row->status, "ok") == 0)
        return row;
    if (!valid)
        measured_missing(measured, "%s", status_message());
    else if (row)
        measured_missing(measured, "%s with %s: %s, %s", scene, spec_text, row->status, row->reason);
    else
        measured_missing(measured, "%s with %s was not measured", scene, spec_text);
    return NULL;
}

double measured_value(struct measured *measured, const char *scene, const char *spec, size_t offset, const char *name)
{
    const struct measurement *row = measurement_find(measured, scene, spec);
    double value = row ? *(const double *)((const char *)row + offset) : NAN;
    if (row && !isfinite(value))
        measured_missing(measured, "%s with %s: %s is undefined%s%s", scene, spec, name, *row->reason ? ", " : "",
                         row->reason);
    return value;
}

double measured_stage(struct measured *measured, const char *scene, const char *spec, const char *stage)
{
    const struct measurement *row = measurement_find(measured, scene, spec);
    const double seconds = row ? measurement_stage(row, stage) : NAN;
    if (!isnan(seconds))
        return seconds;
    return measured_missing(measured, "%s with %s: there is no stage %s", scene, spec, stage);
}

double measured_target(struct measured *measured, const char *scene, const char *spec, int target,
                       const char *definition, size_t offset, const char *name)
{
    const struct measurement *row = measurement_find(measured, scene, spec);
    const bool along_range = strcmp(definition, "range") == 0;
    const char *axis = along_range ? "range" : "azimuth", *by = along_range ? "null" : definition;
    double value = NAN;
    for (int k = 0; row && k < measured->targets.csv.row_count; k++) {
        const struct target_row *t = &measured->targets.target_rows[k];
        if (t->target == target && strcmp(t->scene, row->scene) == 0 && strcmp(t->algorithm, row->algorithm) == 0
            && strcmp(t->options, row->options) == 0 && strcmp(t->precision, row->precision) == 0
            && strcmp(t->axis, axis) == 0 && strcmp(t->definition, by) == 0)
            value = *(const double *)((const char *)t + offset);
    }
    if (!isfinite(value))
        measured_missing(measured, "%s with %s: %s of target %d is undefined (%s)", scene, spec, name, target + 1,
                         definition);
    return value;
}

double measured_phase(struct measured *measured, const struct phase_part *part)
{
    const struct csv *csv = &measured->phase[part->setup];
    char name[40];
    snprintf(name, sizeof name, "%s_error_rad", part->formula);
    int error = csv_column(csv, name), range = csv_column(csv, "r_m"), nu = csv_column(csv, "nu_per_m");
    int receiver = csv_column(csv, "receiver");
    if (error < 0 || range < 0 || nu < 0 || receiver < 0)
        return measured_missing(measured, "the phase study of %s was not made", phase_setups[part->setup]);
    double nu_most = 0, largest = NAN, number, r, error_rad;
    for (int row = 0; row < csv->row_count; row++)
        if (csv_number(csv_cell(csv, row, nu), &number))
            nu_most = fmax(nu_most, fabs(number));
    for (int row = 0; row < csv->row_count; row++) {
        bool last = strcmp(csv_cell(csv, row, receiver), "1") != 0;
        if (last == part->last_receiver && csv_number(csv_cell(csv, row, range), &r) && r >= part->least_m
            && r <= part->most_m && csv_number(csv_cell(csv, row, nu), &number)
            && fabs(number) <= (part->share + 1e-6) * nu_most && csv_number(csv_cell(csv, row, error), &error_rad))
            largest = fmax(largest, fabs(error_rad));
    }
    return isfinite(largest) ? largest
                             : measured_missing(measured, "%s: %s is undefined", phase_setups[part->setup], name);
}

double published_value(struct measured *measured, const char *table, const char *target, const char *method,
                       const char *quantity)
{
    double value;
    if (published_values(&measured->published, table, target, method, quantity, &value, 1) == 1)
        return value;
    return measured_missing(measured, "published.csv has no %s of %s %s in %s", quantity, method, target, table);
}
