/* The columns, and the empty row (measurement.h). */
#include "results/measurement.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "echoes/echo_data.h"

/* The braces are an initializer's. */
/* clang-format off */
#define COLUMN(kind, row, name) {#name, COLUMN_##kind, offsetof(struct row, name), .unit = NULL}
#define METRIC(row, name, unit, better, class, of_float, of_double, relative, ...) \
    {#name, COLUMN_REAL, offsetof(struct row, name), unit, better, class, {of_float, of_double}, relative, __VA_ARGS__}
#define M_COLUMN(kind, name)                COLUMN(kind, measurement, name)
#define M_METRIC(name, unit, better, ...)   METRIC(measurement, name, unit, better, __VA_ARGS__)
#define T_COLUMN(kind, name)                COLUMN(kind, target_row, name)
#define T_METRIC(name, unit, better, ...)   METRIC(target_row, name, unit, better, CLASS_QUALITY, __VA_ARGS__, {NULL})
/* clang-format on */

/* Slacks of quality are about a hundred times the differences between compilers and instruction sets for the same
   source: rounding, 1e-8 of an error (results/README.md). Work is exact. Two runs at different times resolve only a
   factor in time; `compare --ab` resolves per cents. */
const struct column measurement_columns[] = {
    M_COLUMN(TEXT, scene),
    M_COLUMN(TEXT, algorithm),
    M_COLUMN(TEXT, options),
    M_COLUMN(TEXT, precision),
    M_COLUMN(INTEGER, threads),
    M_COLUMN(TEXT, engine),
    M_COLUMN(TEXT, status),
    M_COLUMN(TEXT, reason),
    M_COLUMN(TEXT, skipped),
    M_COLUMN(REAL, plan_s),
    M_METRIC(run_s, "s", BETTER_LOWER, CLASS_TIME, 0, 0, 1, {NULL}),
    M_COLUMN(REAL, run_min_s),
    M_COLUMN(INTEGER, runs),
    M_COLUMN(REAL, control_s),
    M_COLUMN(TEXT, stages),
    M_METRIC(flops_published, "FLOP", BETTER_NONE, CLASS_WORK, 0, 0, 0, {NULL}),
    M_METRIC(flops, "FLOP", BETTER_LOWER, CLASS_WORK, 0, 0, 0, {"work", "GFLOP", 1e-9, "%.3g"}),
    M_METRIC(pairs, "pairs", BETTER_NONE, CLASS_WORK, 0, 0, 0, {NULL}),
    M_METRIC(bytes, "B", BETTER_LOWER, CLASS_WORK, 0, 0, 0, {"memory", "MB", 1e-6, "%.3g"}),
    M_METRIC(error, "1", BETTER_LOWER, CLASS_QUALITY, 2e-6, 1e-9, 1e-3, {"error", "", 1, "%.1e", .brief = "error"}),
    M_METRIC(error_gain, "1", BETTER_LOWER, CLASS_QUALITY, 2e-6, 1e-9, 1e-3,
             {"error, best gain", "", 1, "%.1e", .brief = "+gain", .wide = true}),
    M_METRIC(phase_rms_rad, "rad", BETTER_LOWER, CLASS_QUALITY, 2e-6, 1e-9, 1e-3,
             {"phase rms", "rad", 1, "%.1e", .brief = "phase"}),
    M_METRIC(width_m, "m", BETTER_LOWER, CLASS_QUALITY, 0, 0, 1e-4,
             {"width", "mm", 1e3, "%.2f", .brief = "width", .of = SHOWN_OF_TARGETS}),
    M_METRIC(pslr_db, "dB", BETTER_LOWER, CLASS_QUALITY, 2e-3, 2e-3, 0,
             {"PSLR", "dB", 1, "%.2f", .brief = "PSLR", .of = SHOWN_OF_TARGETS}),
    M_METRIC(islr_db, "dB", BETTER_LOWER, CLASS_QUALITY, 2e-3, 2e-3, 0,
             {"ISLR", "dB", 1, "%.2f", .brief = "ISLR", .of = SHOWN_OF_TARGETS}),
    M_COLUMN(REAL, run_q1_s),
    M_COLUMN(REAL, run_q3_s),
    M_METRIC(entropy, "1", BETTER_LOWER, CLASS_QUALITY, 0, 0, 1e-3,
             {"entropy", "", 1, "%.2f", .brief = "entro.", .of = SHOWN_WITHOUT_TARGETS}),
    M_METRIC(contrast, "1", BETTER_HIGHER, CLASS_QUALITY, 0, 0, 1e-3,
             {"contrast", "", 1, NULL, .brief = "contr.", .of = SHOWN_WITHOUT_TARGETS}),
    M_METRIC(peak_over_median, "1", BETTER_HIGHER, CLASS_QUALITY, 0, 0, 1e-2,
             {"peak/median", "", 1, NULL, .brief = "peak", .of = SHOWN_WITHOUT_TARGETS}),
    M_COLUMN(TEXT, host),
    M_COLUMN(REAL, load),
    M_METRIC(error_flown, "1", BETTER_LOWER, CLASS_QUALITY, 2e-6, 1e-9, 1e-3, {NULL}),
    {.name = NULL},
};

const struct column target_columns[] = {
    T_COLUMN(TEXT, scene),
    T_COLUMN(TEXT, algorithm),
    T_COLUMN(TEXT, options),
    T_COLUMN(TEXT, precision),
    T_COLUMN(INTEGER, target),
    T_COLUMN(TEXT, axis),
    T_COLUMN(TEXT, definition),
    T_METRIC(extent_m, "m", BETTER_NONE, 0, 0, 1e-6),
    T_METRIC(position_error_m, "m", BETTER_SMALL, 1e-6, 1e-6, 0),
    T_METRIC(phase_error_rad, "rad", BETTER_SMALL, 1e-5, 1e-7, 0),
    T_METRIC(width_m, "m", BETTER_LOWER, 0, 0, 1e-4),
    T_METRIC(pslr_db, "dB", BETTER_LOWER, 2e-3, 2e-3, 0),
    T_METRIC(islr_db, "dB", BETTER_LOWER, 2e-3, 2e-3, 0),
    {.name = NULL},
};

const struct column *metric_first(const struct column *columns)
{
    while (columns->name && !columns->unit)
        columns++;
    return columns->name ? columns : NULL;
}

bool column_is_shown(const struct column *column, bool targets)
{
    return column->shown.title && column->shown.of != (targets ? SHOWN_WITHOUT_TARGETS : SHOWN_OF_TARGETS);
}

void column_clear(const struct column *column, void *row)
{
    void *field = (char *)row + column->offset;
    if (column->type == COLUMN_TEXT)
        *(const char **)field = "";
    else if (column->type == COLUMN_INTEGER)
        *(int *)field = -1;
    else
        *(double *)field = NAN;
}

struct measurement measurement_empty(const char *scene, const char *algorithm, const char *options,
                                     enum precision precision)
{
    struct measurement row = {0};
    for (const struct column *column = measurement_columns; column->name; column++)
        column_clear(column, &row);
    row.scene = scene;
    row.algorithm = algorithm;
    row.options = options;
    row.precision = precision_name(precision);
    row.status = "ok";
    return row;
}

bool measurement_is_cheaper(const struct measurement *row, const struct measurement *best, size_t cost,
                            double error_most)
{
    const double mine = *(const double *)((const char *)row + cost);
    const double other = best ? *(const double *)((const char *)best + cost) : INFINITY;
    return row->error <= error_most && mine > 0 && row->runs > 0
           && (mine < other || (best && mine == other && row->run_s < best->run_s));
}

double measurement_stage(const struct measurement *row, const char *stage)
{
    const size_t length = strlen(stage);
    for (const char *at = row->stages; *at; at += strcspn(at, ";"), at += *at == ';')
        if (strncmp(at, stage, length) == 0 && at[length] == '=')
            return strtod(at + length + 1, NULL);
    return NAN;
}

void measurement_interval(const struct measurement *row, double *low, double *high)
{
    const bool known = isfinite(row->run_q1_s) && isfinite(row->run_q3_s);
    *low = known ? row->run_q1_s : row->run_s;
    *high = known ? row->run_q3_s : row->run_s;
}
