/* The papers' tables and claims beside our own numbers: what has to be measured, where the values are found again,
   and what becomes of them. Measuring fills a results folder; all that is said of the papers is then worked out from
   that folder alone, so that no number comes from anywhere else. */
#ifndef SASBENCH_PAPERS_REPRODUCE_H
#define SASBENCH_PAPERS_REPRODUCE_H

#include "measure/results.h"
#include "scene/scene.h"

/* Engines and settings that stand for the papers' methods. */
#define NEAREST "bp_nearest"
#define LINEAR_1 "bp_linear:beta=1"
#define LINEAR_2 "bp_linear:beta=2"
#define LINEAR_8 "bp_linear:beta=8"
#define SINC_8 "bp_sinc:taps=8"
#define ZEROPAD_8 "bp_zeropad:factor=8"
#define ZEROPAD_16 "bp_zeropad:factor=16"
#define ZEROPAD_32 "bp_zeropad:factor=32"
#define LBF_BLOCK "rma_lbf:blocks=1,spacing=uniform"        /* Table II: the target at the edge of its one block */
#define LBF_8 "rma_lbf:blocks=8"
#define LBF_16 "rma_lbf:blocks=16"
#define PCA_1 "rma_pca:blocks=1"
#define PCA_16 "rma_pca:blocks=16"
#define WU_16 "rma_wu:blocks=16"

/* Plain engines, which are what the papers compare: every delay evaluated; every cell's phase by libm and each
   receiver summed by itself. */
#define PLAIN_BP "engine=general,exact=true"
#define PLAIN_RMA "spacing=uniform,blend=off,sum=after,phases=libm"

/* Definitions of a time. */
#define PLAIN_TIMES "plain engines, extrapolated"
#define PLAIN_SINC "plain engines, extrapolated, BP by sinc"
#define FAST_TIMES "fast engines"
#define FAST_SINC "fast engines, BP by sinc"
#define FAST_LIMITED "fast engines, aperture limited"

/* A folder's measurements. What is asked of it and not there is NAN, and `missing` then says why. */
struct measured {
    struct results measurements, targets;   /* as record.h reads them; all zero when there is no file */
    struct csv phase[2];                    /* of enum phase_setup, as the command `phase` writes them */
    struct csv published;                   /* results/published.csv */
    char missing[400];                      /* the first value that was not there since it was last cleared */
};
enum phase_setup { PHASE_SHORT, PHASE_LONG };
/* The columns of published.csv. */
enum published_column {
    PUBLISHED_TABLE, PUBLISHED_TARGET, PUBLISHED_METHOD, PUBLISHED_QUANTITY, PUBLISHED_UNIT, PUBLISHED_PAPER,
    PUBLISHED_SOURCE, PUBLISHED_NOTE
};

/* Files that are not there yet are no error. Errors: those of results_read and csv_read; free in any case. */
enum status measured_read(const char *directory, struct measured *measured);
void measured_free(struct measured *measured);

/* A field of the measurement of `spec` (SPEC text) on `scene`: MEASURED(measured, scene, spec, error). */
#define MEASURED(measured, scene, spec, field) \
    measured_value(measured, scene, spec, offsetof(struct measurement, field), #field)
double measured_value(struct measured *measured, const char *scene, const char *spec, size_t offset,
                      const char *name);

/* Seconds of one stage of it ("compress"). */
double measured_stage(struct measured *measured, const char *scene, const char *spec, const char *stage);

/* A field of its azimuth slice through a target (from 0):
   MEASURED_TARGET(measured, scene, spec, 0, "pixel", islr_db). */
#define MEASURED_TARGET(measured, scene, spec, target, definition, field) \
    measured_target(measured, scene, spec, target, definition, offsetof(struct target_row, field), #field)
double measured_target(struct measured *measured, const char *scene, const char *spec, int target,
                       const char *definition, size_t offset, const char *name);

/* The largest magnitude (rad) of a formula's phase error over a set-up's first or last receiver, ranges from
   `least_m` to `most_m`, the three range frequencies, and |f| up to `share` of the Doppler band (0: its centre). */
struct phase_part {
    enum phase_setup setup;
    bool last_receiver;
    const char *formula;                    /* lbf_fc, lbf_F, lbf7_fc, pca */
    double least_m, most_m, share;
};
double measured_phase(struct measured *measured, const struct phase_part *part);

/* What a paper prints: the cell of published.csv; NAN with `missing` set when there is none. */
double published_value(struct measured *measured, const char *table, const char *target, const char *method,
                       const char *quantity);

/* ---- tables ---- */

/* One of the papers' tables or figures, or the claims; `id` is its name on the command line. */
struct table {
    const char *id, *title;
    const char *assumption;                 /* what had to be assumed */
    const char *base;                       /* the method that times are divided by; NULL: no times */
};
extern const struct table tables[];         /* id NULL ends */

/* One measurement that a table rests on. */
struct need {
    const char *scene, *spec;
};
/* Add the needs of the table `id` to needs [count of room], each once; returns how many there are then. The claims
   need all. What finds no room is left out. */
int table_needs(const char *id, struct need *needs, int count, int room);

/* Seconds of a method of a table of times by one of its definitions ("fast engines"), scaled to the full size where
   only a part of it was timed. */
double table_seconds(struct measured *measured, const char *id, const char *method, const char *definition);

/* The smallest upsampling rate that satisfies BP22 Eq. (20) for bin and resolution (m) at wavelength lambda (m). */
int upsampling_rate(double bin_m, double resolution_m, double wavelength_m);

/* One line of reproduced.csv. Texts are borrowed. */
struct reproduced {
    const char *table, *target, *method, *quantity, *definition, *unit;
    double paper, ours;                     /* NAN: not printed, not measured */
    const char *assumption, *note;          /* of the table; of the printed number */
    char missing[400];                      /* why `ours` is not there */
};
/* All lines, malloc'ed, [*count], for the caller to free. Errors: STATUS_FAILED without memory. */
enum status tables_evaluate(struct measured *measured, struct reproduced **lines, int *count);

#endif
