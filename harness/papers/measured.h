/* A results folder as input of the papers' tables and claims. They use that folder and published.csv alone. */
#ifndef SASBENCH_PAPERS_MEASURED_H
#define SASBENCH_PAPERS_MEASURED_H

#include "report/published.h"
#include "results/results.h"
#include "papers/phase.h"

#define RULES_FILE "rules_random.csv" /* of a folder (rules.h) */

/* A computed number that needs no image (unimaged.h). */
enum scene_quantity {
    QUANTITY_SIZE_FACTOR,
    QUANTITY_UPSAMPLING,
    QUANTITY_KEPT_DB,
    QUANTITY_CHANGED_DB,
    QUANTITY_FLOPS,
    QUANTITY_FLOPS_PUBLISHED
};
struct scene_number {
    char scene[80], spec[160];
    int target; /* from 0; -1: of the scene */
    enum scene_quantity quantity;
    double value;
};

/* A folder's measurements. A value that is not there is NAN, and `missing` then has the reason. */
struct measured {
    struct results measurements, targets; /* as results.h reads them; all zero without a file */
    struct csv phase[PHASE_SETUPS];       /* as phase_study writes them */
    struct csv rules;                     /* as rules_study writes them */
    struct csv published;                 /* results/published.csv */
    struct scene_number numbers[192];     /* requested so far */
    int number_count;
    char missing[400]; /* the first missing value since this was last cleared */
};

/* Missing files are no error. Errors: those of results_read and csv_read; free in any case. */
enum status measured_read(const char *directory, struct measured *measured);
void measured_free(struct measured *measured);

/* The requested value is not there: keep the reason unless there is one already. Returns NAN. */
double measured_missing(struct measured *measured, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The successful measurement of `spec` (SPEC text) on `scene`, else NULL; `missing` stays unchanged. */
const struct measurement *measured_row(const struct measured *measured, const char *scene, const char *spec);

/* A field of the measurement of `spec` (SPEC text) on `scene`: MEASURED(measured, scene, spec, error). */
#define MEASURED(measured, scene, spec, field)                                                                         \
    measured_value(measured, scene, spec, offsetof(struct measurement, field), #field)
double measured_value(struct measured *measured, const char *scene, const char *spec, size_t offset, const char *name);

/* Seconds of one stage of the measurement ("compress"). */
double measured_stage(struct measured *measured, const char *scene, const char *spec, const char *stage);

/* A field of the azimuth slice through a target (from 0) by a definition ("pixel"), or of the "range" slice; `name` is
   for messages. */
double measured_target(struct measured *measured, const char *scene, const char *spec, int target,
                       const char *definition, size_t offset, const char *name);

/* The largest magnitude (rad) of a formula's phase error over a set-up's first or last receiver, ranges from
   `least_m` to `most_m`, the three range frequencies, and |f| up to `share` of the Doppler band (0: its centre). */
struct phase_part {
    enum phase_setup setup;
    bool last_receiver;
    const char *formula; /* a name of phase.h's formulas: lbf_fc, pca */
    double least_m, most_m, share;
};
double measured_phase(struct measured *measured, const struct phase_part *part);

/* What a paper prints: the cell of published.csv; NAN with `missing` set when there is none. */
double published_value(struct measured *measured, const char *table, const char *target, const char *method,
                       const char *quantity);

#endif
