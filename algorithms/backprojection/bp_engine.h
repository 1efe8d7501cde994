/* What bp.c and its two engines share. */
#ifndef SASBENCH_BACKPROJECTION_BP_ENGINE_H
#define SASBENCH_BACKPROJECTION_BP_ENGINE_H

#include "backprojection/bp.h"
#include "backprojection/planes.h"
#include "backprojection/reading.h"
#include "common/isa.h"
#include "common/memory.h"
#include "backprojection/traces.h"
#include "backprojection/pairs/turned.h"

/* The weights of a kernel of many taps as polynomials (kernel.h), for the general engine's interpolated delays. */
struct bp_kernel {
    int branches, taps, first; /* no branches: it has none */
    double *coefficients;      /* [branches][taps] */
};

struct bp {
    struct problem problem;
    struct bp_medium medium;
    struct bp_table table;
    void *weights; /* of table */
    struct bp_kernel kernel;
    struct traces *traces;
    struct traces_shape shape;
    const struct planes *planes; /* of the plan's precision */
    const struct bp_engine *engine;
    void *state; /* the engine's own */
    struct work work;
    struct turned_problem turned; /* what `problem` points to where grids are turned */
    struct acquisition limited;   /* and where the settings limit the aperture */
    bool *met;                    /* [pings] pings_met: records of others are not read; NULL: all are met */
    struct store tables, engines; /* the weights and `met`; the traces and the engine's own */
};

/* Bytes of a plan's struct, but for what keeps account. */
#define BP_BYTES(plan) ((double)(sizeof(plan) - 2 * sizeof(struct store)))

/* One way of doing the sums. */
struct bp_engine {
    const char *name;
    /* Can it do the problem of bp->problem? When not, the reason is the status message (STATUS_UNSUPPORTED). */
    enum status (*applicable)(const struct bp *bp);
    /* What a plan would make for the pairs to read by, all records together: `units`, entries of tables or blocks of
       pixels. Known from bp->problem, medium and table, before any plan; of a problem that is applicable. `residues`:
       of tables, columns from ping to ping whose neighbours share loads, the fewest of all patches: 1 where the nearest
       fine step is read, which none share. `apart`: without tables, the share of pairs that share no loads. */
    void (*units)(const struct bp *bp, struct forecast *forecast);
    /* m: how far along the track beyond the pairs' places delays are evaluated; NULL: nowhere. */
    double (*beside)(const struct bp *bp);
    /* Make bp->state and bp->traces, of what bp->engines owns. */
    enum status (*plan)(struct bp *bp);
    void (*execute)(struct bp *bp, const struct echoes *echoes, struct image *image, struct stages *stages);
};

extern const struct bp_engine bp_general;   /* any track: delays of runs of range rows */
extern const struct bp_engine bp_invariant; /* uniform straight track on the pixel raster: tables of delays */

/* What the second one needs of a problem. */
struct condition invariant_condition(const struct problem *problem, enum severity severity);

static inline bool bp_met(const struct bp *bp, int ping)
{
    return !bp->met || bp->met[ping];
}
/* Find bp->met: the pings that any pixel of the whole image meets, by which the records' form is planned; then, of a
   window, those that its own pixels meet, whose records are read. Errors: STATUS_FAILED without memory. */
enum status bp_met_find(struct bp *bp);
enum status bp_met_narrow(struct bp *bp);
/* What of the image is wanted, as a problem of its own; *part is its grid where there is a window. */
struct problem bp_wanted(const struct bp *bp, struct grid *part);
/* Pings whose records are read. */
int bp_met_count(const struct bp *bp);

/* How many neighbouring pings are summed together at the most, the first a multiple of so many. */
int bp_pings_joined(const struct acquisition *acquisition);

/* Memory of bp->engines of which a window needs a part: all is there, what is not used takes no room and is 0. */
void *bp_part_allocate(struct bp *bp, size_t bytes);

static inline size_t real_size(enum precision precision)
{
    return precision == PRECISION_DOUBLE ? sizeof(double) : sizeof(float);
}

/* What of the records pairs read, into bp->medium, and the form of their rows; all where there is no engine. */
struct traces_form bp_records_form(struct bp *bp);
/* Records for up to omp_get_max_threads() threads; fills bp->traces, which bp->engines owns, and bp->shape; `origin` of
   the table follows from them. */
enum status bp_plan_traces(struct bp *bp);
/* Name into `text` of `room` characters, behind `join`, the samples that no row needs; nothing where there are none. */
void bp_records_skipped(const struct bp *bp, char *text, size_t room, const char *join);
/* Record `index` of the echoes, complex [samples]. */
static inline const void *bp_record(const struct bp *bp, const struct echoes *echoes, size_t index)
{
    const size_t samples = (size_t)bp->problem.acquisition->samples;
    return (const char *)echoes->samples + index * samples * 2 * real_size(bp->problem.precision);
}

#endif
