/* A kernel of many taps as Farrow branches: each tap's weight is a polynomial in u = fraction - 1/2, so that branch m
   is the record filtered by the coefficients of u^m, and a pair needs neither weights nor neighbours (farrow.h). */
#ifndef SASBENCH_BACKPROJECTION_KERNEL_H
#define SASBENCH_BACKPROJECTION_KERNEL_H

#include "backprojection/bp.h"

enum { KERNEL_BRANCHES_MOST = 20 };

/* Fill coefficients[KERNEL_BRANCHES_MOST][taps], lowest power first, by the Chebyshev series of each weight. Returns
   the least number of branches (>= 2) with all weights within `tolerance`; 0 if more than KERNEL_BRANCHES_MOST are
   needed, -1 without memory. */
int kernel_branches(const struct interpolator *interpolator, double tolerance, double *coefficients);

#endif
