#include "common/cholesky.h"

#include <math.h>

void cholesky_toeplitz(int size, const double *row, double *lower)
{
    for (int i = 0; i < size; i++)
        for (int j = 0; j <= i; j++) {
            double left = row[i - j];
            for (int k = 0; k < j; k++)
                left -= lower[i * size + k] * lower[j * size + k];
            lower[i * size + j] = i == j ? sqrt(left) : left / lower[j * size + j];
        }
}

void cholesky_solve(int size, const double *lower, double *x)
{
    for (int i = 0; i < size; i++) {
        for (int k = 0; k < i; k++)
            x[i] -= lower[i * size + k] * x[k];
        x[i] /= lower[i * size + i];
    }
    for (int i = size - 1; i >= 0; i--) {
        for (int k = i + 1; k < size; k++)
            x[i] -= lower[k * size + i] * x[k];
        x[i] /= lower[i * size + i];
    }
}
