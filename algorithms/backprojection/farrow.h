/* Farrow branches: a band-limited record between its samples as a polynomial in the distance from the nearest one. With
   u in [-1/2, 1/2] samples and nu in cycles a sample,

       exp(j 2 pi nu u) = sum over n of (2n+1) j^n j_n(pi nu) P_n(2u)

   (spherical Bessel functions, Legendre polynomials; Abramowitz and Stegun Eq. 10.1.47). Cut after n = degree, it is
   the polynomial of least squared error over u at every frequency. Sorted by powers of u, branch m is the record
   filtered by H_m(nu), and the value at sample i and u is the sum over m of branch_m[i] u^m (Farrow's structure,
   ISCAS 1988). */
#ifndef SASBENCH_BACKPROJECTION_FARROW_H
#define SASBENCH_BACKPROJECTION_FARROW_H

enum { FARROW_LEAST = 2, FARROW_MOST = 9 }; /* degrees */

/* gains[degree + 1]: H_m = gains[m] for an even m, j gains[m] for an odd one; gains[m] is even or odd in nu as m is.
   |nu| <= 1/2. */
void farrow_gains(int degree, double nu, double *gains);

/* The a-priori error: rms over u of what the cut leaves out, over a flat band |nu| <= band/2, relative to the signal:
   sqrt(mean of the sum over n > degree of (2n+1) j_n(pi nu)^2). 0 < band <= 1. */
double farrow_error(int degree, double band);

/* The least degree whose a-priori error is at most `error`; FARROW_MOST if none is. */
int farrow_degree(double error, double band);

#endif
