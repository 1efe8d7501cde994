/* Shared by bp.c and its two engines. */
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
    int branches, taps, first; /* branches 0: none */
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
    struct turned_problem turned; /* target of `problem` where grids are turned */
    struct acquisition limited;   /* target of its acquisition where the settings limit the aperture */
    bool *met;                    /* [pings] pings_met: records of others are not read; NULL: all are met */
    struct store tables, engines; /* the weights and `met`; the traces and the engine's own */
};

/* Bytes of a plan's struct, without its bookkeeping. */
#define BP_BYTES(plan) ((double)(sizeof(plan) - 2 * sizeof(struct store)))

/* One way of doing the sums. */
struct bp_engine {
    const char *name;
    /* Can it image bp->problem? If not, the status message is the reason (STATUS_UNSUPPORTED). */
    enum status (*applicable)(const struct bp *bp);
    /* Counts of a plan, all records together, from bp->problem, medium and table, before any plan; the problem is
       applicable. `units`: entries of tables, or blocks of pixels. `residues`: with tables, columns from ping to ping
       whose neighbours share loads, the fewest of all patches; 1 where the nearest fine step is read. `apart`: without
       tables, the share of pairs that share no loads. */
    void (*units)(const struct bp *bp, struct forecast *forecast);
    /* m along the track: delays are evaluated so far beyond the pairs' places; NULL: 0. */
    double (*beside)(const struct bp *bp);
    /* Make bp->state and bp->traces; bp->engines owns them. */
    enum status (*plan)(struct bp *bp);
    void (*execute)(struct bp *bp, const struct echoes *echoes, struct image *image, struct stages *stages);
};

extern const struct bp_engine bp_general;   /* any track: delays of runs of range rows */
extern const struct bp_engine bp_invariant; /* uniform straight track on the pixel raster: tables of delays */

/* Requirements of the invariant engine. */
struct condition invariant_condition(const struct problem *problem, enum severity severity);

static inline bool bp_met(const struct bp *bp, int ping)
{
    return !bp->met || bp->met[ping];
}
/* Find bp->met. First the pings in pairs of the whole image, which decide the records' form. Then, with a window, the
   pings in pairs of its pixels: only their records are read. Errors: STATUS_FAILED without memory. */
enum status bp_met_find(struct bp *bp);
enum status bp_met_narrow(struct bp *bp);
/* The wanted part of the image as a problem of its own; *part is its grid where there is a window. */
struct problem bp_wanted(const struct bp *bp, struct grid *part);
int bp_pings_wanted(const struct bp *bp); /* by its pairs */
/* Pings whose records are read. */
int bp_met_count(const struct bp *bp);

/* The most neighbouring pings that are summed together; the first ping is a multiple of this number. */
int bp_pings_joined(const struct acquisition *acquisition);

/* Zeroed memory of bp->engines. With a window, unused parts take no room: it uses so many runs of so many bytes. */
void *bp_part_allocate(struct bp *bp, size_t bytes, size_t runs, size_t run);

static inline size_t real_size(enum precision precision)
{
    return precision == PRECISION_DOUBLE ? sizeof(double) : sizeof(float);
}

/* The samples that the engine's pairs read. */
struct sample_span bp_samples_read(const struct bp *bp);
/* The form of rows that hold this part of the records, which bp->medium is limited to. */
struct traces_form bp_records_form(struct bp *bp, struct sample_span read);
/* Rows of that form for up to omp_get_max_threads() threads. Fills bp->traces, which bp->engines owns, bp->shape, and
   from these `origin` of the table. */
enum status bp_plan_traces(struct bp *bp, struct sample_span read);
/* Append to `text` of `room` characters `join` and the samples that no row needs; nothing if all are needed. */
void bp_records_skipped(const struct bp *bp, char *text, size_t room, const char *join);
/* Record `index` of the echoes, complex [samples]. */
static inline const void *bp_record(const struct bp *bp, const struct echoes *echoes, size_t index)
{
    const size_t samples = (size_t)bp->problem.acquisition->samples;
    return (const char *)echoes->samples + index * samples * 2 * real_size(bp->problem.precision);
}

#endif
