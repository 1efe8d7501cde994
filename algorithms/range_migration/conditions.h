/* What a scene must fulfil for range migration to image it rightly: each condition by name, with its value and its limit.
   Plans check them before any work; a row of a table is one condition. */
#ifndef SASBENCH_RANGE_MIGRATION_CONDITIONS_H
#define SASBENCH_RANGE_MIGRATION_CONDITIONS_H

#include <stdbool.h>

#include "range_migration/rma.h"

struct rma_condition {
    const char *name;
    double value, limit;
    bool at_least;              /* the value must lie above the limit, not below */
    const char *meaning, *cure; /* what the value is, and what would change it */
};

/* What the conditions look at: a uniform straight track along x, and the rows and columns wanted. */
struct rma_view {
    const struct problem *problem;
    const struct rma_method *method;
    struct spectrum_setting setting;
    double x_low, x_high, spacing; /* m: the track's ends; ping to ping, > 0 */
    bool converts;                 /* not a single receiver at the transmitter, which needs no formula */
    struct rma_bounds bounds;
    double beam_sine; /* of the echoes' beam at the transmitter; INFINITY: everything is seen */
};

struct rma_view rma_view_of(const struct problem *problem, const struct rma_method *method,
                            const struct straight_track *track);

double rma_sinc(double z); /* sin(pi z)/(pi z) */

/* The transmitter's places that echo a row at range r of a patch, from its columns: [*low, *high] m ahead of the pixel.
   False where there are none. */
bool rma_view_aperture(const struct rma_view *view, const struct grid *patch, double r, double *low, double *high);

/* Those up to RMA_CAUSES refuse by themselves, in this order. The last one is the predicted error; where that is too large,
   those before it are what may have caused it, and the first of them that fails is named. Where the predicted error
   is small they may fail. */
enum { RMA_CAUSES = 3, RMA_CONDITIONS = 7 };
typedef struct rma_condition rma_condition_function(const struct rma_view *view);
extern rma_condition_function *const rma_conditions[RMA_CONDITIONS];

bool rma_condition_holds(const struct rma_condition *condition);
/* STATUS_UNSUPPORTED with name, value, limit and cure of the condition that refuses; STATUS_FAILED without
   memory. */
enum status rma_conditions_check(const struct rma_view *view);

#endif
