/* The metrics, and the empty row (measurement.h). */
#include "measure/measurement.h"

#include <math.h>
#include <stdbool.h>

#include "data/echo_data.h"

/* The braces are an initializer's. */
/* clang-format off */
#define METRIC(struct_name, name, unit, title, better, class, of_float, of_double, relative) \
    {#name, unit, title, better, class, {of_float, of_double}, relative, offsetof(struct struct_name, name)}
/* clang-format on */
#define M_METRIC(...) METRIC(measurement, __VA_ARGS__)
#define T_METRIC(...) METRIC(target_row, __VA_ARGS__)

/* Slacks of quality are about a hundred times what compilers and instruction sets make of the same source: rounding,
   1e-8 of an error (results/README.md). Work is exact. Two runs at different times can only tell a factor in time;
   `compare --ab` tells per cents. */
const struct metric metrics[] = {
    M_METRIC(run_s, "s", "Run time", BETTER_LOWER, CLASS_TIME, 0, 0, 1),
    M_METRIC(flops_published, "FLOP", "Operations by the paper's formula", BETTER_NONE, CLASS_WORK, 0, 0, 0),
    M_METRIC(flops, "FLOP", "Operations", BETTER_LOWER, CLASS_WORK, 0, 0, 0),
    M_METRIC(pairs, "pairs", "Pixel-pulse pairs", BETTER_NONE, CLASS_WORK, 0, 0, 0),
    M_METRIC(bytes, "B", "Memory of the plan", BETTER_LOWER, CLASS_WORK, 0, 0, 0),
    M_METRIC(error, "1", "Error", BETTER_LOWER, CLASS_QUALITY, 2e-6, 1e-9, 1e-3),
    M_METRIC(error_gain, "1", "Error after one gain", BETTER_LOWER, CLASS_QUALITY, 2e-6, 1e-9, 1e-3),
    M_METRIC(phase_rms_rad, "rad", "Phase error, rms", BETTER_LOWER, CLASS_QUALITY, 2e-6, 1e-9, 1e-3),
    M_METRIC(width_m, "m", "-3 dB width", BETTER_LOWER, CLASS_QUALITY, 0, 0, 1e-4),
    M_METRIC(pslr_db, "dB", "PSLR", BETTER_LOWER, CLASS_QUALITY, 2e-3, 2e-3, 0),
    M_METRIC(islr_db, "dB", "ISLR", BETTER_LOWER, CLASS_QUALITY, 2e-3, 2e-3, 0),
    M_METRIC(entropy, "1", "Entropy", BETTER_LOWER, CLASS_QUALITY, 0, 0, 1e-3),
    M_METRIC(contrast, "1", "Contrast", BETTER_HIGHER, CLASS_QUALITY, 0, 0, 1e-3),
    M_METRIC(peak_over_median, "1", "Peak over median", BETTER_HIGHER, CLASS_QUALITY, 0, 0, 1e-2),
    {.name = NULL},
};

const struct metric target_metrics[] = {
    T_METRIC(extent_m, "m", "Reach of the slice", BETTER_NONE, CLASS_QUALITY, 0, 0, 1e-6),
    T_METRIC(position_error_m, "m", "Position error", BETTER_SMALL, CLASS_QUALITY, 1e-6, 1e-6, 0),
    T_METRIC(phase_error_rad, "rad", "Phase error at the target", BETTER_SMALL, CLASS_QUALITY, 1e-5, 1e-7, 0),
    T_METRIC(width_m, "m", "-3 dB width", BETTER_LOWER, CLASS_QUALITY, 0, 0, 1e-4),
    T_METRIC(pslr_db, "dB", "PSLR", BETTER_LOWER, CLASS_QUALITY, 2e-3, 2e-3, 0),
    T_METRIC(islr_db, "dB", "ISLR", BETTER_LOWER, CLASS_QUALITY, 2e-3, 2e-3, 0),
    {.name = NULL},
};

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
                                .islr_db = NAN,
                                .run_q1_s = NAN,
                                .run_q3_s = NAN,
                                .entropy = NAN,
                                .contrast = NAN,
                                .peak_over_median = NAN};
}

void measurement_interval(const struct measurement *row, double *low, double *high)
{
    const bool known = isfinite(row->run_q1_s) && isfinite(row->run_q3_s);
    *low = known ? row->run_q1_s : row->run_s;
    *high = known ? row->run_q3_s : row->run_s;
}
