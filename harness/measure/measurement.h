/* What is measured: rows of numbers, and the metrics among them. */
#ifndef SASBENCH_MEASURE_MEASUREMENT_H
#define SASBENCH_MEASURE_MEASUREMENT_H

#include <stddef.h>

#include "algorithm.h"

/* One row of measurements.csv. Texts are borrowed for the call; NAN and negative counts become empty fields. */
struct measurement {
    const char *scene, *algorithm, *options, *precision;
    int threads;
    const char *engine, *status, *reason, *skipped; /* status: ok, unsupported, failed */
    double plan_s, run_s, run_min_s;
    int runs;
    double control_s;
    const char *stages; /* "compress=0.1;focus=0.9" */
    double flops_published, flops, pairs, bytes;
    double error, error_gain, phase_rms_rad;
    double width_m, pslr_db, islr_db;           /* null definition, azimuth, medians over the targets */
    double run_q1_s, run_q3_s;                  /* quartiles of the runs; NAN for less than 4 */
    double entropy, contrast, peak_over_median; /* metrics_sharpness; NAN where only a part was imaged */
};

/* One row of targets.csv. */
struct target_row {
    const char *scene, *algorithm, *options, *precision;
    int target; /* index from 0 */
    const char *axis, *definition;
    double extent_m, position_error_m, phase_error_rad, width_m, pslr_db, islr_db;
};

/* The one metric table: CSV header, terminal table, plot labels and the regression gate come from it. */
struct metric {
    const char *name, *unit, *title;
    enum { BETTER_NONE, BETTER_LOWER, BETTER_HIGHER, BETTER_SMALL } better; /* small: of magnitude */
    enum metric_class { CLASS_QUALITY, CLASS_WORK, CLASS_TIME } class;
    double absolute_slack[2]; /* by enum precision; a change within either slack is none */
    double relative_slack;
    size_t offset; /* of the double in struct measurement or target_row */
};
extern const struct metric metrics[];        /* of struct measurement; name NULL ends the table */
extern const struct metric target_metrics[]; /* of struct target_row */

/* A row before anything is measured: numbers undefined, status ok. Texts are borrowed. */
struct measurement measurement_empty(const char *scene, const char *algorithm, const char *options,
                                     enum precision precision);

/* s: the quartiles of the runs, or both the median where there are none. */
void measurement_interval(const struct measurement *row, double *low, double *high);

#endif
