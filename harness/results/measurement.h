/* Rows of measurements.csv and targets.csv, and the metrics among their columns. */
#ifndef SASBENCH_RESULTS_MEASUREMENT_H
#define SASBENCH_RESULTS_MEASUREMENT_H

#include <stdbool.h>
#include <stddef.h>

#include "contract/algorithm.h"

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
    const char *host;                           /* that measured it */
    double load;                                /* ready processes there, the system's mean over the last minute */
    double error_flown; /* as error_gain, against the exact image by the true track; NAN where it is the stated one */
};

/* One row of targets.csv. */
struct target_row {
    const char *scene, *algorithm, *options, *precision;
    int target; /* index from 0 */
    const char *axis, *definition;
    double extent_m, position_error_m, phase_error_rad, width_m, pslr_db, islr_db;
};

/* The one table of metrics. It defines header, writer and reader of the CSV, the empty row, what the regression gate
   compares, what a claim may name, and what terminal and report show. The latter two add values from several columns
   (speed-up, rate). */
struct column {
    const char *name; /* NULL ends the table */
    enum { COLUMN_TEXT, COLUMN_INTEGER, COLUMN_REAL } type;
    size_t offset; /* of the field in struct measurement or target_row */
    /* Of a metric, a real number that is compared: */
    const char *unit;                                                       /* NULL: no metric */
    enum { BETTER_NONE, BETTER_LOWER, BETTER_HIGHER, BETTER_SMALL } better; /* small: a smaller magnitude */
    enum metric_class { CLASS_QUALITY, CLASS_WORK, CLASS_TIME } class;
    double absolute_slack[2]; /* by enum precision; a change within either slack does not count */
    double relative_slack;
    /* Of a metric in tables: */
    struct {
        const char *title, *unit; /* title NULL: not shown */
        double scale;             /* factor to that unit */
        const char *format;       /* NULL: three digits */
        const char *brief;        /* its title on the terminal; NULL: only the report shows it */
        bool wide;                /* on a wide terminal only */
        enum { SHOWN_OF_ALL, SHOWN_OF_TARGETS, SHOWN_WITHOUT_TARGETS } of; /* the last two share one place */
    } shown;
};
extern const struct column measurement_columns[], target_columns[];

/* The first metric from a column on; NULL without one. */
const struct column *metric_first(const struct column *columns);
/* Is it shown for scenes with point targets, or for those without? */
bool column_is_shown(const struct column *column, bool targets);
/* Set the field of a row to the value that is written as an empty one. */
void column_clear(const struct column *column, void *row);

/* A row before anything is measured: numbers undefined, status ok. Texts are borrowed. */
struct measurement measurement_empty(const char *scene, const char *algorithm, const char *options,
                                     enum precision precision);

/* Is this row cheaper than the cheapest so far, `best`, which may be NULL? It needs an error up to error_most and a
   lower cost (the double at the offset `cost`; the faster of equal ones). Rows with stated, unmeasured times do not
   count. A sweep's tables and a report's summary use it. */
bool measurement_is_cheaper(const struct measurement *row, const struct measurement *best, size_t cost,
                            double error_most);

/* s of one of its stages; NAN without that stage. */
double measurement_stage(const struct measurement *row, const char *stage);

/* s: the quartiles of the runs; without quartiles both are the median. */
void measurement_interval(const struct measurement *row, double *low, double *high);

#endif
