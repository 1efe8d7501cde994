/* Which measurement corresponds to a printed number: the papers' methods, ways to measure them, and targets. */
#ifndef SASBENCH_PAPERS_SOURCES_H
#define SASBENCH_PAPERS_SOURCES_H

#include "papers/measured.h"

/* LBF21's method in two schemes, each with its own verdict: as the paper prints it (theta at the carrier, Eqs. (11)
   to (17), sub-blocks of equal width with hard edges: section IV-C), and corrected (theta at F, blocks evenly spaced in
   1/r that blend). The paper's other methods have no sub-blocks and are the same in both. */
enum scheme { SCHEME_PRINTED, SCHEME_CORRECTED, SCHEMES };
/* "as printed", "corrected". */
extern const char *const scheme_names[SCHEMES];
/* The SPEC of `text`: "LBF:OPTIONS" is rma_lbf with the scheme's options and these; any other text is itself.
   Returns whether the text depends on the scheme. */
bool scheme_spec(enum scheme scheme, const char *text, char *spec, size_t size);
/* The formula of the phase study for `name`: LBF is Eq. (5), LBF7 is Eq. (7). Both have theta at the carrier as
   printed; corrected, both are Eq. (5) with theta at F. Returns whether the name depends on the scheme. */
bool scheme_formula(enum scheme scheme, const char *name, const char **formula);

/* Engines and settings that correspond to the papers' methods; LBF by the evaluated scheme. PCA's and Wu's
   correction follows range by interpolation (LBF21 V-A); blending blocks take its place. */
#define NEAREST   "bp_nearest"
#define LINEAR_2  "bp_linear:beta=2"
#define LINEAR_8  "bp_linear:beta=8"
#define SINC_8    "bp_sinc:taps=8"
#define ZEROPAD_8 "bp_zeropad:factor=8"
#define LBF_BLOCK "LBF:blocks=1,spacing=uniform" /* Table II: the target at the edge of its one block */
#define LBF_8     "LBF:blocks=8"
#define LBF_16    "LBF:blocks=16"
#define PCA_1     "rma_pca:blocks=1"
#define PCA_16    "rma_pca:blocks=16"
#define WU_16     "rma_wu:blocks=16"
#define TURNED    "wk_squint"
#define IDEAL     "wk_classic" /* for echoes from inside the target area alone */
#define POLAR_4   "wk_polar:subapertures=4"
#define POLAR_2   "wk_polar:subapertures=2"

/* Plain engines, as the papers compare them: every delay evaluated, every cell's phase by libm, each receiver summed
   by itself. */
#define PLAIN_BP  "engine=general,exact=true"
#define PLAIN_RMA "sum=after,phases=libm"

/* Definitions of a time. */
#define PLAIN_TIMES  "plain engines, extrapolated"
#define PLAIN_SINC   "plain engines, extrapolated, BP by sinc"
#define FAST_TIMES   "fast engines"
#define FAST_SINC    "fast engines, BP by sinc"
#define FAST_LIMITED "fast engines, aperture limited"

/* One measurement that a table needs. `spec` may name LBF. */
struct need {
    const char *scene, *spec;
};
/* Add one to needs [count of room] unless it is there; returns their new number. Without room, it is left out. */
int need_add(struct need *needs, int count, int room, struct need need);
/* Add the needs of the table `id`. */
int table_needs(const char *id, struct need *needs, int count, int room);

/* Scales each stage of a part to the whole. */
struct scaling {
    double factor; /* of the stages in `stages` (separated by blanks) */
    const char *stages;
    double rest; /* of the others */
};

/* A way in which a method is measured for a table. */
struct source {
    const char *table, *method;
    const char *definition;        /* of a time or a formula; NULL: by the definitions of the quantity */
    const char *scene;             /* NULL: the target's, by source_place */
    char spec[200];                /* a SPEC: LBF is replaced by the scheme's */
    const struct scaling *scaling; /* of a time; NULL: the whole was timed */
    enum scheme scheme;
    bool by_scheme; /* depends on the scheme; else it is the same for both */
    bool planned;   /* the number comes from the plan, without a measurement */
};
/* The source k, which lasts; NULL behind the last. */
const struct source *source_at(int k);
/* The scene whose target, *index from 0, corresponds to a printed one; NULL if there is none. */
const char *source_place(const char *table, const char *target, int *index);

/* Seconds of a method of a table of times by one of its definitions ("fast engines"), scaled to the full size where
   only a part was timed. Back projection by sinc is a definition of its own, equal to the others for all other
   methods. */
double table_seconds(struct measured *measured, enum scheme scheme, const char *id, const char *method,
                     const char *definition);
/* How far apart two times of a table may lie by chance, relative: the largest of a tenth, the scatter of one
   method's runs, and that of the scalar reference loop beside the methods of one scene. */
double table_noise(const struct measured *measured, const char *id, const char *definition);

/* Is there such a time? -1, or which of the three texts (from 0) does not exist; `accepted` then lists those that
   do. */
int table_seconds_check(const char *id, const char *method, const char *definition, char *accepted, size_t size);
/* The measurement behind such a time; NULL if there is none. */
const struct source *table_time_source(enum scheme scheme, const char *id, const char *method, const char *definition);

#endif
