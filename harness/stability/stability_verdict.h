/* The verdict on one SPEC in one trial: digits lost against the method's own sum, error against the right image, spread
   over rounding modes, and other faults.

   Digits lost D = log10(difference/conditioning). Both are relative L2 norms over one target's patch, the worst patch
   counts. The difference is that from the same method in extended precision. The conditioning is the possible rounding
   error of careful code:

       sum |w s| (eps64 kappa_phase + eps64 kappa_place + declared + eps_T (1 + sqrt(pairs))) + ties

   kappa_phase = 2 pi (fc + fs/2) tau_max, kappa_place = 2 pi fc 2 |x|_max/c for coordinates far from the origin;
   declared is the engine's deliberate change (method.h); eps64 = 2^-53, eps_T = 2^-24 in float. Careful code has D
   below 1, a fault far more. */
#ifndef SASBENCH_STABILITY_STABILITY_VERDICT_H
#define SASBENCH_STABILITY_STABILITY_VERDICT_H

#include "stability/trial.h"

#define DIGITS_MOST 2.0

enum verdict_kind { VERDICT_WORKS, VERDICT_DEGRADES, CANDIDATE_REFUSED, VERDICT_FAILS };

struct stability_verdict {
    enum verdict_kind kind;
    char why[80];      /* the condition that refuses, or the fault; else empty */
    char message[400]; /* in full */
    char engine[96];
    double error;      /* relative L2 against the right image, worst patch and mode; NAN: no image, or a zero one */
    double error_most; /* the method's promise */
    double difference, conditioning, digits; /* NAN without a sum to compare with */
    double spread;                           /* largest difference between two modes' images, relative L2 */
    bool same_bits, finite;
    int exceptions; /* raised in any mode */
};

struct stability_verdict trial_verdict(const struct trial *trial, int spec);
/* The verdict on a scene that cannot be read, from its message. */
struct stability_verdict refusal_verdict(const char *message);

/* "works", "degrades", "refused: lbf_law", "fails: digits". */
void verdict_text(const struct stability_verdict *verdict, char *text, size_t size);

#endif
