/* Normal equations of least-squares taps: their matrix is symmetric, positive and constant along its diagonals. */
#ifndef SASBENCH_COMMON_CHOLESKY_H
#define SASBENCH_COMMON_CHOLESKY_H

/* Cholesky's factor L of R = L L^T with R_ij = row[|i - j|], positive: lower[i * size + j] for j <= i; the rest of
   lower[size * size] is not touched. size^3/6 multiplications. */
void cholesky_toeplitz(int size, const double *row, double *lower);

/* x with L L^T x = right, in its place: x[size]. */
void cholesky_solve(int size, const double *lower, double *x);

#endif
