/* Weights of a truncated, optionally Kaiser-windowed sinc kernel (bp.h). */
#include <math.h>

#include "backprojection/bp.h"
#include "common/bessel.h"

void sinc_weights(int taps, double beta, double fraction, double *w)
{
    const double sine = sin(M_PI * fraction), whole = bessel_i0(beta);
    for (int k = 0; k < taps; k++) {
        int n = k + 1 - taps / 2;
        double z = fraction - n, edge = 1 - 4 * z * z / ((double)taps * taps);
        /* sin(pi (fraction - n)) = (-1)^n sin(pi fraction): exact zeros at whole samples, no large arguments */
        double value = fabs(z) < 1e-9 ? 1 : (n % 2 ? -sine : sine) / (M_PI * z);
        w[k] = value * bessel_i0(beta * sqrt(edge > 0 ? edge : 0)) / whole;
    }
}
