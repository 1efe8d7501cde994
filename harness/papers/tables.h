/* The papers' tables and figures beside our own numbers: what has to be measured for them, and what becomes of it. */
#ifndef SASBENCH_PAPERS_TABLES_H
#define SASBENCH_PAPERS_TABLES_H

#include "papers/measured.h"

/* Engines and settings that stand for the papers' methods. */
#define NEAREST   "bp_nearest"
#define LINEAR_2  "bp_linear:beta=2"
#define LINEAR_8  "bp_linear:beta=8"
#define SINC_8    "bp_sinc:taps=8"
#define ZEROPAD_8 "bp_zeropad:factor=8"
#define LBF_BLOCK "rma_lbf:blocks=1,spacing=uniform" /* Table II: the target at the edge of its one block */
#define LBF_8     "rma_lbf:blocks=8"
#define LBF_16    "rma_lbf:blocks=16"
#define PCA_1     "rma_pca:blocks=1"
#define PCA_16    "rma_pca:blocks=16"
#define WU_16     "rma_wu:blocks=16"

/* Plain engines, which are what the papers compare: every delay evaluated; every cell's phase by libm and each
   receiver summed by itself. */
#define PLAIN_BP  "engine=general,exact=true"
#define PLAIN_RMA "spacing=uniform,blend=off,sum=after,phases=libm"

/* Definitions of a time. */
#define PLAIN_TIMES  "plain engines, extrapolated"
#define PLAIN_SINC   "plain engines, extrapolated, BP by sinc"
#define FAST_TIMES   "fast engines"
#define FAST_SINC    "fast engines, BP by sinc"
#define FAST_LIMITED "fast engines, aperture limited"

/* One measurement that a table rests on. */
struct need {
    const char *scene, *spec;
};
/* Add one to needs [count of room] unless it is there; returns how many there are then. What finds no room is left
   out. */
int need_add(struct need *needs, int count, int room, struct need need);
/* Add the needs of the table `id`. The claims need those of all tables; their own come from claims_needs. */
int table_needs(const char *id, struct need *needs, int count, int room);

/* Seconds of a method of a table of times by one of its definitions ("fast engines"), scaled to the full size where
   only a part of it was timed. */
double table_seconds(struct measured *measured, const char *id, const char *method, const char *definition);

/* Is there such a time? -1, or which of the three texts (from 0) is unknown; `accepted` then lists those that are. */
int table_seconds_check(const char *id, const char *method, const char *definition, char *accepted, size_t size);

/* The smallest upsampling rate that satisfies BP22 Eq. (20) for bin and resolution (m) at wavelength lambda (m). */
int upsampling_rate(double bin_m, double resolution_m, double wavelength_m);

/* One line of reproduced.csv. Texts are borrowed. */
struct reproduced {
    const char *table, *target, *method, *quantity, *definition, *unit;
    double paper, ours;            /* NAN: not printed, not measured */
    const char *assumption, *note; /* of the table; of the printed number */
    char missing[400];             /* why `ours` is not there */
};
/* All lines, malloc'ed, [*count], for the caller to free. Errors: STATUS_FAILED without memory. */
enum status tables_evaluate(struct measured *measured, struct reproduced **lines, int *count);

#endif
