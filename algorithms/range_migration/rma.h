/* The engine that all range migrations share: multi-receiver echoes are converted into monostatic ones, then focused
   by one monostatic range migration (LBF21 section IV).

   A method is a formula phi(d, r, F, nu) for the phase of one pair's two-dimensional spectrum (spectrum.h). Each
   receiver's spectrum is multiplied by exp(-j (phi + r K)) at the centre r of a range block, with r K the exact
   phase of d = 0: what is left looks like the echo of a monostatic sonar and is focused exactly by

       image(x, r) = sum over nu and F of  Z(F, nu) exp(+j (r K(F, nu) + 2 pi nu x)) w(F, nu, r),
       w = exp(j pi/4) F/(1 - v^2/c^2) sqrt(c r/(2 kappa^3)) / (spacing P N_f),    kappa = c K/4 pi,

   in the same absolute scale and phase as back projection. As K is exact and linear in r, the azimuth correction
   (LBF21 Eq. (17)) has nothing left to do. The stages, timed one by one:

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

struct rma_options {
    int blocks;                             /* range blocks over all rows asked for; 0: by Eq. (13) and limit */
    double limit;                           /* rad: the phase error that Eq. (13) accepts */
    int spacing, blend, stolt, sum, phases; /* indices into the choices of RMA_PARAMS */
};

enum rma_spacing { RMA_UNIFORM, RMA_INVERSE };
enum rma_sum { RMA_SUM_BEFORE, RMA_SUM_AFTER };
enum rma_phases { RMA_RECURRENCE, RMA_LIBM };

extern const char *const rma_spacing_names[],
    *const rma_blend_names[], *const rma_stolt_names[], *const rma_sum_names[], *const rma_phases_names[];

/* The parameters that all methods have. */
#define RMA_PARAMS                                                                                                     \
    {PARAM(struct rma_options, blocks),                                                                                \
     .summary = "range blocks of the conversion; 0: as many as Eq. (13) requires",                                     \
     .initial = 0,                                                                                                     \
     .min = 0,                                                                                                         \
     .max = 4096,                                                                                                      \
     .sweep = "1 2 4 8 16 32"},                                                                                        \
        {PARAM(struct rma_options, limit),                                                                             \
         .summary = "largest phase error inside a block (rad) where blocks = 0",                                       \
         .initial = 0.78539816339744831,                                                                               \
         .min = 1e-3,                                                                                                  \
         .max = 100,                                                                                                   \
         .terse = true},                                                                                               \
        {PARAM_NAMED(struct rma_options, spacing, rma_spacing_names),                                                  \
         .summary = "blocks of equal width in r or in 1/r",                                                            \
         .initial = RMA_INVERSE,                                                                                       \
         .max = RMA_INVERSE,                                                                                           \
         .sweep = "uniform inverse",                                                                                   \
         .terse = true},                                                                                               \
        {PARAM_NAMED(struct rma_options, blend, rma_blend_names),                                                      \
         .summary = "blocks blend: each row is the cubic through the nearest four",                                    \
         .initial = 1,                                                                                                 \
         .max = 1,                                                                                                     \
         .sweep = "off on",                                                                                            \
         .terse = true},                                                                                               \
        {PARAM_NAMED(struct rma_options, stolt, rma_stolt_names),                                                      \
         .summary = "Kaiser taps of the Stolt interpolation, or a direct sum",                                         \
         .initial = 3,                                                                                                 \
         .max = 5,                                                                                                     \
         .sweep = "4 6 8 12 16",                                                                                       \
         .terse = true},                                                                                               \
        {PARAM_NAMED(struct rma_options, sum, rma_sum_names),                                                          \
         .summary = "receivers are summed before or after the range IFFT",                                             \
         .initial = RMA_SUM_BEFORE,                                                                                    \
         .max = RMA_SUM_AFTER,                                                                                         \
         .terse = true,                                                                                                \
         .hidden = true},                                                                                              \
    {                                                                                                                  \
        PARAM_NAMED(struct rma_options, phases, rma_phases_names),                                                     \
            .summary = "by recurrence over the receivers, or by libm for each cell", .initial = RMA_RECURRENCE,        \
            .max = RMA_LIBM, .terse = true, .hidden = true                                                             \
    }

struct rma_method {
    /* Options other than a struct rma_options: what they make of it and of the method. NULL: they are one. */
    void (*choose)(const void *options, struct rma_method *method, struct rma_options *shared);
    const char *name, *law; /* law: of the condition that bounds the error of `spectrum` (rma_conditions.h) */
    double error_limit;     /* of the predicted error of an image */
    spectrum_function *spectrum;
    int terms, taps; /* of delay compensation (delay_compensation.h); 0: conversion in blocks */
    /* The paper's FLOPs for M receivers (LBF21 Eqs. (20) to (22)): numbers[0] M + numbers[1] range transforms of
       1.5 N_a N_r log2 N_r, azimuth transforms alike, products of N_a N_r; interpolations of N_a N_r (2 taps - 1). */
    const char *source;
    double range[2], azimuth[2], products[2], interpolations;
};

/* How wide the engine focuses; what lies farther out does not exist, or is left out. */
struct rma_bounds {
    double sine;  /* of the widest angle off broadside that wavenumbers, beam and lowest frequency allow */
    double way;   /* m: the farthest that a ping is from a wanted column, along the track; INFINITY: no bound */
    double aside; /* m: greatest magnitude of an offset */
};

/* How far ahead or behind a target at range r the transmitter can be, m: by angle, or by the track's own extent and
   some Fresnel zones beyond it. */
double rma_reach(const struct acquisition *acquisition, const struct rma_bounds *bounds, double r);

/* How far the middle of a pair can be from a target at range r, m: what wavenumbers beyond hold is left out. */
double rma_focused(const struct acquisition *acquisition, const struct rma_bounds *bounds, double r);

/* What images by azimuth transforms keep to, range migration's and omega-k's: the conditions are to see to it. */
double rma_promise(const void *options);

/* The callbacks of struct algorithm, whose `method` is a struct rma_method, and whose options are a struct rma_options
   or what it chooses by (rma_method.c). */
int rma_method_conditions(const struct problem *problem, const void *method, const void *options,
                          struct condition *list, int room);
enum status rma_method_forecast(const struct problem *problem, const void *method, const void *options,
                                struct forecast *forecast);
enum status rma_method_cost(const struct problem *problem, const void *method, const void *options,
                            struct forecast *forecast);
enum status rma_method_plan(const struct problem *problem, const void *method, const void *options, void **plan);

/* The same of a method as the options make it; these are only used during the call. */
enum status rma_plan(const struct problem *problem, const struct rma_method *method, const struct rma_options *options,
                     void **plan);
enum status rma_execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages);
struct work rma_work(const void *plan);
void rma_destroy(void *plan);

#endif
