/* The part of a problem for a window: its records, and memory that it needs a part of (bp_engine.h). */
#include <math.h>
#include <stdlib.h>

#include "backprojection/bp_engine.h"
#include "backprojection/pairs/pairs.h"

void *bp_part_allocate(struct bp *bp, size_t bytes, size_t runs, size_t run)
{
    static const double PAGE = 4096; /* of memory: a run begins anywhere in one */
    const bool whole = !bp->problem.window;
    bp->engines.bytes += whole ? (double)bytes : fmin((double)bytes, (double)runs * ((double)run + PAGE));
    return store_keep(&bp->engines, memory_sparse(bytes, whole), memory_sparse_free);
}

struct problem bp_wanted(const struct bp *bp, struct grid *part)
{
    struct problem wanted = bp->problem;
    if (wanted.window) {
        *part = grid_part(wanted.patches, wanted.window);
        wanted.patches = part;
        wanted.window = NULL;
    }
    return wanted;
}

int bp_pings_wanted(const struct bp *bp)
{
    struct grid part;
    const struct problem wanted = bp_wanted(bp, &part);
    bool *met = malloc((size_t)wanted.acquisition->pings * sizeof *met);
    const int count = met ? pings_met(&wanted, met) : wanted.acquisition->pings;
    free(met);
    return count;
}

/* Pings that may be summed together are read together. */
enum status bp_met_narrow(struct bp *bp)
{
    struct grid part;
    const struct problem wanted = bp_wanted(bp, &part);
    const int pings = wanted.acquisition->pings, joined = bp_pings_joined(wanted.acquisition);
    if (!bp->met)
        bp->met = store_keep(&bp->tables, malloc((size_t)pings * sizeof *bp->met), free);
    bool *met = malloc((size_t)pings * sizeof *met);
    if (bp->met && met) {
        pings_met(&wanted, met);
        for (int p = 0; p < pings; p++) {
            const int first = p - p % joined;
            bp->met[p] = false;
            for (int k = first; k < first + joined && k < pings; k++)
                bp->met[p] |= met[k];
        }
    }
    free(met);
    return bp->met && met ? STATUS_OK : status_set(STATUS_FAILED, "no memory for %d pings", pings);
}

enum status bp_met_find(struct bp *bp)
{
    const int pings = bp->problem.acquisition->pings;
    bool *met = malloc((size_t)pings * sizeof *met);
    if (!met)
        return status_set(STATUS_FAILED, "no memory for %d pings", pings);
    if (pings_met(&bp->problem, met) < pings) {
        bp->met = store_keep(&bp->tables, met, free);
        bp->tables.bytes += (double)pings * sizeof *met;
    } else {
        free(met);
    }
    return STATUS_OK;
}

int bp_met_count(const struct bp *bp)
{
    int count = 0;
    for (int p = 0; p < bp->problem.acquisition->pings; p++)
        count += bp_met(bp, p);
    return count;
}

void bp_reads(const void *plan, bool *read)
{
    const struct bp *bp = plan;
    for (int p = 0; p < bp->problem.acquisition->pings; p++)
        read[p] = bp_met(bp, p);
}
