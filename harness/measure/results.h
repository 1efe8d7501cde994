/* Results on disk: measurements.csv and targets.csv, written row by row, and found again after a cut. */
#ifndef SASBENCH_MEASURE_RESULTS_H
#define SASBENCH_MEASURE_RESULTS_H

#include <stdbool.h>
#include <stdint.h>

#include "algorithm.h"
#include "data/csv.h"

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
    double width_m, pslr_db, islr_db; /* null definition, azimuth, medians over the targets */
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

/* What makes rows comparable: written as `# key: value` lines ahead of the rows. */
struct provenance {
    char machine[128], isa[16], compiler[160], flags[256], libraries[160], commit[80], program[32], date[32];
    int threads;
};
void provenance_fill(struct provenance *provenance, int threads);

/* Scene content that rows were measured on. */
struct scene_hash {
    char *scene;
    uint64_t hash;
};

/* A finished file, measurements.csv, targets.csv or a baseline, in memory; freed with results_free, which accepts a zeroed
   struct. Texts of the rows belong to the csv. */
struct results {
    struct csv csv;
    bool targets;                     /* which of the two it is */
    struct measurement *measurements; /* [csv.row_count], or NULL */
    struct target_row *target_rows;   /* [csv.row_count], or NULL */
};
/* Errors: STATUS_INVALID naming file, line, column and value: not a file of ours or of another version, other columns, a
   number that is none or not finite, a status that is none. */
enum status results_read(const char *path, struct results *results);
void results_free(struct results *results);
/* A whole measurements file without provenance, the same on every machine. `note` is one line that says what it is and
   how it is made. Errors: STATUS_INVALID when it cannot be written; an older file is then left as it is. */
enum status measurements_write(const char *path, const char *note, const struct scene_hash *scenes, int scene_count,
                               const struct measurement *rows, int row_count);

struct record;
/* Make the folder and take it (folder.h) until record_close; open its two files. Rows left by an earlier run are kept when
   machine, instruction set, libraries, commit, program and threads are the same; otherwise the files are begun anew, and
   the old ones, where they have rows, are kept beside them as measurements.N.csv and targets.N.csv, which is told on
   standard error. A last line that was cut short is dropped. Errors: STATUS_INVALID for a place that cannot be written, a
   folder that another program works in, or a CSV that is not ours (naming file and line). */
enum status record_open(const char *directory, const struct provenance *provenance, struct record **record);
/* Declare a scene before its rows. Rows kept from other content (hash) of the same name are dropped, and the old files
   kept and told of as above. */
enum status record_scene(struct record *record, const char *scene, uint64_t hash);
/* The finished row of an earlier run, or NULL; belongs to the record, valid until record_close. One that failed is not
   finished: it gives way to the row that is added in its place. */
const struct measurement *record_find(const struct record *record, const char *scene, const char *algorithm,
                                      const char *options, const char *precision);
/* Append and flush. The rows of a measurement's targets are added before the measurement itself: when that is there,
   all of it is. Target rows without their measurement are dropped by the next run. Errors: STATUS_FAILED. */
enum status record_targets(struct record *record, const struct target_row *rows, int count);
enum status record_add(struct record *record, const struct measurement *row);
void record_close(struct record *record);

#endif
