#include "common/fit.h"

void fit_nodes_fill(int count, double nodes[count], double powers[count][count])
{
    for (int n = 0; n < count; n++)
        nodes[n] = cos(M_PI * (2 * n + 1) / (2 * count));
    /* Lagrange's polynomials, multiplied out factor by factor: powers[.][n] of node n. */
    for (int n = 0; n < count; n++) {
        double scale = 1;
        int degree = 0;
        for (int power = 0; power < count; power++)
            powers[power][n] = power == 0;
        for (int k = 0; k < count; k++) {
            if (k == n)
                continue;
            scale *= nodes[n] - nodes[k];
            degree++;
            for (int power = degree; power >= 0; power--)
                powers[power][n] = (power > 0 ? powers[power - 1][n] : 0) - nodes[k] * powers[power][n];
        }
        for (int power = 0; power < count; power++)
            powers[power][n] /= scale;
    }
}
