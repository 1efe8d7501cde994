/* The engine that all back projections share:

       image(x, r) = sum over pings and receivers of  s_pm(tau) exp(+j 2 pi fc tau),   tau = delay_exact(...)

   (BP22 Eqs. (5), (9) with the absolute phase; ZP15 Eqs. (6), (7)), for any track in space. A pair counts while tau
   lies inside the record and |sin theta_t| inside the aperture limit. The methods differ only in how they read s_pm
   between its samples: a struct interpolator. */
#ifndef SASBENCH_BACKPROJECTION_BP_H
#define SASBENCH_BACKPROJECTION_BP_H

#include "backprojection/fitted.h"
#include "contract/algorithm.h"

/* The value at sample coordinate q = (tau - t0) fs upsample is  sum over k < taps of
   w[k] s[floor(q) + first + k],  w = weights(fraction of q). Taps beyond the record's ends read zero (with upsample >
   1: the band-limited signal's own continuation). */
struct interpolator {
    int upsample;     /* records are upsampled by zero padding (exactly) by this factor first; >= 1 */
    int steps;        /* > 0: q is rounded to the nearest multiple of 1/steps first, at most 4096; 0: not rounded */
    int taps, first;  /* taps >= 1; first <= 0 */
    bool preemphasis; /* the spectrum is first divided by sinc^2(f/fs), the loss of linear interpolation; not with a
                         degree */
    int degree;       /* > 0: in place of taps, the record's Farrow branches up to this power (farrow.h) are read at
                        floor(q + 1/2); taps and steps are not used */
    /* Fill w[taps] for a fraction in [0, 1). Called while planning only; NULL when taps == 1 (the weight is 1). */
    void (*weights)(const struct interpolator *interpolator, double fraction, double *w);
    union {
        double beta;          /* of a Kaiser window */
        struct fitted fitted; /* taps by least squares */
    } kernel;                 /* input of `weights` */
    bool in_papers;           /* BP22 Eq. (11) and LBF21 Eq. (23) count its FLOPs: struct work has published numbers */
};

/* Settings of every back projection: the first member of a method's options struct. */
struct bp_options {
    int engine;         /* enum bp_engine_choice */
    int exact;          /* 1: the general engine evaluates every delay; 0: it interpolates them */
    double phase_limit; /* rad: largest phase error of a pair by interpolated delays */
    double aperture;    /* > 0: only pairs with |sin theta_t| <= this are summed, beside the acquisition's own limit */
};
enum bp_engine_choice { BP_ENGINE_AUTO, BP_ENGINE_GENERAL, BP_ENGINE_INVARIANT };
extern const char *const bp_engine_names[], *const bp_exact_names[];
#define BP_PARAMS                                                                                                      \
    {PARAM_NAMED(struct bp_options, engine, bp_engine_names),                                                          \
     .summary = "general: any track; invariant: tables, uniform straight tracks on the pixel raster",                  \
     .initial = BP_ENGINE_AUTO, .max = BP_ENGINE_INVARIANT, .terse = true},                                            \
        {PARAM_NAMED(struct bp_options, exact, bp_exact_names), .summary = "every delay is evaluated: the plain path", \
         .max = 1, .terse = true, .hidden = true},                                                                     \
        {PARAM(struct bp_options, phase_limit),                                                                        \
         .summary = "largest phase error (rad) of a pair from the general engine's interpolated delays",               \
         .initial = 1e-4,                                                                                              \
         .min = 1e-8,                                                                                                  \
         .max = 0.1,                                                                                                   \
         .terse = true,                                                                                                \
         .hidden = true},                                                                                              \
    {                                                                                                                  \
        PARAM(struct bp_options, aperture), .summary = "only pairs with |sin theta_t| up to this are summed; 1: all",  \
                                            .initial = 1, .min = 1e-6, .max = 1, .terse = true                         \
    }

/* `method` of struct algorithm; options begin with a struct bp_options. */
struct bp_method {
    /* Errors: STATUS_UNSUPPORTED with the reason, STATUS_FAILED. */
    enum status (*make)(const struct problem *problem, const void *options, struct interpolator *interpolator);
    const struct bp_options *fixed; /* in place of options; NULL: the method has options */
};

/* The callbacks of struct algorithm, whose `method` is a struct bp_method. */
#define BP_CALLBACKS                                                                                                   \
    .conditions = bp_method_conditions, .cost = bp_method_cost, .errors = bp_method_errors, .plan = bp_method_plan,    \
    .execute = bp_execute, .reads = bp_reads, .work = bp_work, .destroy = bp_destroy
enum status bp_method_plan(const struct problem *problem, const void *method, const void *options, void **plan);
enum status bp_method_cost(const struct problem *problem, const void *method, const void *options,
                           struct forecast *forecast);
enum status bp_method_errors(const struct problem *problem, const void *method, const void *options,
                             struct forecast *forecast);
/* conditions_sampled and `invariance`, which refuses with engine=invariant. */
int bp_method_conditions(const struct problem *problem, const void *method, const void *options, struct condition *list,
                         int room);

/* The same for an interpolator. Interpolator and options are used during the call only. Errors: STATUS_UNSUPPORTED,
   with the reason, when the engine asked for cannot image the problem. */
enum status bp_plan(const struct problem *problem, const struct interpolator *interpolator,
                    const struct bp_options *options, void **plan);
enum status bp_execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages);
void bp_reads(const void *plan, bool *read);
struct work bp_work(const void *plan);
void bp_destroy(void *plan);
/* The forecast of an interpolator: its error law, and delays and rounding of the engine that bp_plan would choose.
   Errors: as bp_plan for the engine asked for, and for the conditions; STATUS_FAILED without memory. */
enum status bp_forecast(const struct problem *problem, const struct interpolator *interpolator,
                        const struct bp_options *options, struct forecast *forecast);

/* sinc(z) w(z) with w a Kaiser window of parameter beta over |z| <= taps/2 (beta = 0: no window):
   I0(beta sqrt(1 - (2z/taps)^2))/I0(beta), at the distances of `taps` taps -taps/2+1 .. taps/2 from floor(q). */
void sinc_weights(int taps, double beta, double fraction, double *w);

#endif
