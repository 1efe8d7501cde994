/* Farrow branches: a band-limited record between its samples as a polynomial in the distance from the nearest one. With
   u in [-1/2, 1/2] samples and nu in cycles a sample,

       exp(j 2 pi nu u) = sum over n of (2n+1) j^n j_n(pi nu) P_n(2u)

   (spherical Bessel functions, Legendre polynomials; Abramowitz and Stegun Eq. 10.1.47). Cut after n = degree, it is
   the polynomial of least squared error over u at every frequency. Sorted by powers of u, branch m is the record
   filtered by H_m(nu), and the value at sample i and u is the sum over m of branch_m[i] u^m (Farrow's structure,
   ISCAS 1988). */
#ifndef SASBENCH_BACKPROJECTION_FARROW_H
#define SASBENCH_BACKPROJECTION_FARROW_H

#include "backprojection/law_spectrum.h"

enum { FARROW_LEAST = 2, FARROW_MOST = 9 }; /* degrees */

/* gains[degree + 1]: H_m = gains[m] for an even m, j gains[m] for an odd one; gains[m] is even or odd in nu as m is.
   |nu| <= 1/2. */
void farrow_gains(int degree, double nu, double *gains);

/* The a-priori error: rms over u of the terms cut off, over a flat band |nu| <= band/2, relative to the signal:
   sqrt(mean of the sum over n > degree of (2n+1) j_n(pi nu)^2). 0 < band <= 1. */
double farrow_error(int degree, double band);

/* The least degree with an a-priori error of at most `error`, on records of `upsample` times the sampling rate and of
   that spectrum; FARROW_MOST if none has. */
int farrow_degree(double error, const struct law_spectrum *spectrum, int upsample);
/* The least degree for images of a problem with at most `error`. 0 without memory, with a message. */
int farrow_degree_choose(double error, const struct problem *problem, int upsample);

/* Branches 0 and 1 make all others, with neighbours at most `reach` values away:

       branch_m[i] = sum over k of own[m][reach + k] branch_(m%2)[i + k] + other[m][reach + k] branch_(1 - m%2)[i + k]

   (own is even, other odd in k). It is generalised sampling (Papoulis, IEEE Trans. Circuits Syst. 24(11), 1977: a
   signal and its derivative), which has no edge at fs/2. So a small number of neighbours is enough, and two inverse
   transforms for any degree. Taps are least squares, weighted with the error of the cut. Their own error at any
   frequency below fs/2 is at most FARROW_SHARE of the rms error there and in the band together; in double, where they
   reach farther, 2e-10 of the signal as well. */
enum { FARROW_REACH_MOST = FARROW_MOST };
#define FARROW_SHARE 0.01
struct farrow_taps {
    int reach;
    double own[FARROW_MOST + 1][2 * FARROW_REACH_MOST + 1]; /* m from 2 on */
    double other[FARROW_MOST + 1][2 * FARROW_REACH_MOST + 1];
};

/* FARROW_LEAST <= degree <= FARROW_MOST; `upsample` 1 or 2: factor of the records' zero padding; 0 < band <= 1: before
   padding; `reach`: farrow_reach(). */
int farrow_reach(int degree, int upsample, enum precision precision);
void farrow_taps_make(int degree, int upsample, double band, int reach, struct farrow_taps *taps);

#endif
