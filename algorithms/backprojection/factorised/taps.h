/* Fitted taps (backprojection/fitted.h) for one axis of a polar grid, as polynomials in the fraction. */
#ifndef SASBENCH_BACKPROJECTION_FACTORISED_TAPS_H
#define SASBENCH_BACKPROJECTION_FACTORISED_TAPS_H

#include "backprojection/fitted.h"
#include "backprojection/kernel.h"

struct polar_taps {
    int taps, branches;  /* taps even; weight t is the sum over m of coefficients[m][t] u^m, u = fraction - 1/2 */
    double oversampling; /* samples over those of the band */
    double error;        /* relative L2, of a flat spectrum */
    double coefficients[KERNEL_BRANCHES_MOST * FITTED_TAPS_MOST]; /* [branches][taps] */
};

/* The taps with an error of at most `error` (> 0) and the least work for samples and taps together; the axis is
   oversampled by `least` (>= 1) at least. Errors: STATUS_FAILED without memory, STATUS_UNSUPPORTED where no taps are
   that accurate. */
enum status polar_taps_choose(double error, double least, struct polar_taps *chosen);

#endif
