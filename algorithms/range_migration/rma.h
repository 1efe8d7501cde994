/* The engine that all range migrations share: multi-receiver echoes are converted into monostatic ones, then focused
   by one monostatic range migration (LBF21 section IV).

   A method is a formula phi(d, r, F, nu) for the phase of one pair's two-dimensional spectrum (spectrum.h). Each
   receiver's spectrum is multiplied by exp(-j (phi + r K)) at the centre r of a range block, with r K the exact phase
   of d = 0. The product is like the echo of a monostatic sonar, and is focused exactly by

       image(x, r) = sum over nu and F of  Z(F, nu) exp(+j (r K(F, nu) + 2 pi nu x)) w(F, nu, r),
       w = exp(j pi/4) F/(1 - v^2/c^2) sqrt(c r/(2 kappa^3)) / (spacing P N_f),    kappa = c K/4 pi,

   in the same absolute scale and phase as back projection. As K is exact and linear in r, the azimuth correction
   (LBF21 Eq. (17)) has nothing left to do. rma_lbf:variant=printed takes LBF21's chain instead: conversion by psi_i/2
   alone, K of Eqs. (15) and (16), which leaves the speed out, and rows turned by Eq. (17). The range that Eq. (15)
   refers to cancels between (15) and (16); only the taps of the interpolation see it. The stages, timed one by one:

       compress       range FFT and the replica's conjugate
       spread         azimuth FFT of each receiver; X[q mod P] serves all M P frequencies (LBF21 Eq. (10))
       bulk           the correction at the reference range (LBF21 Eq. (11)), for each receiver
       differential   the rest of it for each range block (Eq. (12)), and the sum over the receivers (Eq. (14))
       reconstruct    range IFFT of the sum, one for each block; each row, along r/cos theta, is its block's, or
                      blends the nearest four: the conversion is smooth in range, so that Lagrange's cubic through
                      the blocks' centres leaves a tenth or less of the error of fading linearly from one to the next
       stolt          spectrum from F to K (Eq. (16)), for each patch
       focus          bulk focusing at the patch (Eq. (15)), weight, range IFFT
       inverse        azimuth IFFT, onto the patch's own columns */
#ifndef SASBENCH_RANGE_MIGRATION_RMA_H
#define SASBENCH_RANGE_MIGRATION_RMA_H

#include "contract/algorithm.h"
#include "range_migration/spectrum.h"

/* Settings of all methods; 0 where a method does not have one. */
struct rma_options {
    int blocks;                             /* range blocks over all wanted rows; 0: by Eq. (13) and limit */
    double limit;                           /* rad: the phase error that Eq. (13) accepts; that of rma_chirp's terms */
    int spacing, blend, stolt, sum, phases; /* indices into the choices of rma_params */
    int variant;                            /* enum rma_variant: of rma_lbf */
    int terms, taps;                        /* of rma_delay; taps: index into rma_delay_taps_names */
};

enum rma_spacing { RMA_UNIFORM, RMA_INVERSE };
enum rma_sum { RMA_SUM_BEFORE, RMA_SUM_AFTER };
enum rma_phases { RMA_RECURRENCE, RMA_LIBM };
enum rma_variant { RMA_PRINTED, RMA_CORRECTED };

extern const char *const rma_stolt_names[], *const rma_delay_taps_names[];
/* The parameters of methods that convert in blocks; from rma_params + 1 on without the variant. */
extern const struct param rma_params[];

/* The parameters of methods that compensate delays. */
#define RMA_DELAY_PARAMS                                                                                               \
    {PARAM_NAMED(struct rma_options, taps, rma_delay_taps_names), .summary = "taps of the receivers' delays",          \
     .initial = 2, .max = 3, .sweep = "8 12 16 24"},                                                                   \
    {                                                                                                                  \
        PARAM(struct rma_options, terms), .summary = "terms over the receivers for what the delays leave",             \
                                          .initial = 2, .min = 1, .max = 3, .sweep = "1 2 3"                           \
    }

struct rma_method {
    const char *name, *law; /* law: of the condition that bounds the error of `spectrum` (rma_conditions.h) */
    double error_limit;     /* of the predicted error of an image */
    spectrum_function *spectrum;
    bool chirps;     /* focuses by chirp transforms in place of Stolt's interpolation */
    int terms, taps; /* of delay compensation (delay_compensation.h), by the options; 0: conversion in blocks */
    /* The paper's FLOPs for M receivers (LBF21 Eqs. (20) to (22)): numbers[0] M + numbers[1] range transforms of
       1.5 N_a N_r log2 N_r, azimuth transforms alike, products of N_a N_r; interpolations of N_a N_r (2 taps - 1). */
    const char *source;
    double range[2], azimuth[2], products[2], interpolations;
};

/* The widths that the engine focuses; echoes from farther out do not exist, or are left out. */
struct rma_bounds {
    double sine;  /* of the widest angle off broadside that wavenumbers, beam and lowest frequency allow */
    double way;   /* m: the farthest that a ping is from a wanted column, along the track; INFINITY: no bound */
    double aside; /* m: greatest magnitude of an offset */
};

/* The greatest distance along the track between a target at range r and the transmitter, m: by angle, or by the track's
   own extent and some Fresnel zones beyond it. */
double rma_reach(const struct acquisition *acquisition, const struct rma_bounds *bounds, double r);

/* m: the Fresnel zones over which an azimuth transform's filter ends beyond its widest angle. A cut of the track
   farther out makes no ripple. */
double azimuth_guard(const struct acquisition *acquisition, double r);

/* The greatest distance between a target at range r and the middle of a pair, m: wavenumbers beyond are left out. */
double rma_focused(const struct acquisition *acquisition, const struct rma_bounds *bounds, double r);

/* Limits of images by azimuth transforms (range migration, omega-k), for the conditions to check. */
double rma_promise(const void *options);

/* The callbacks of struct algorithm, whose `method` is a struct rma_method, and whose options are a struct rma_options.
   Conditions, cost and errors: rma_conditions.h. */
#define RMA_CALLBACKS                                                                                                  \
    .traits = TRAIT_WINDOW, .conditions = rma_conditions, .promise = rma_promise, .cost = rma_cost,                    \
    .errors = rma_errors, .plan = rma_plan, .execute = rma_execute, .reads = rma_reads, .work = rma_work,              \
    .destroy = rma_destroy
int rma_conditions(const struct problem *problem, const void *method, const void *options, struct condition *list,
                   int room);
enum status rma_cost(const struct problem *problem, const void *method, const void *options, struct forecast *forecast);
enum status rma_errors(const struct problem *problem, const void *method, const void *options,
                       struct forecast *forecast);
enum status rma_plan(const struct problem *problem, const void *method, const void *options, void **plan);
enum status rma_execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages);
void rma_reads(const void *plan, bool *read);
struct work rma_work(const void *plan);
void rma_destroy(void *plan);

#endif
