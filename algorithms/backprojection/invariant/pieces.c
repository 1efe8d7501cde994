/* The greatest length of polynomials for the delays of an image row (invariant/pieces.h).

   The two-way path is L = D + c g, where D = sqrt(u^2 + r^2) is the way out and c g = (B b + sqrt(b^2 + (1 - B^2) r^2))
   /(1 - B^2), b = u + offset + B D, the way back (delay.h), B = v/c. Interpolation at the n Chebyshev points of [-h, h]
   errs by at most max|L^(n)|/n! h^n/2^(n-1). Bounds on the Taylor coefficients L^(n)/n!, in three steps:

     1. sqrt(1 + 2 s x + x^2) with |s| <= 1 is sqrt(1 - x e) sqrt(1 - x/e), |e| = 1. With 1 - sqrt(1 - x) = sum b_n
        x^n, all b_n > 0, its coefficients are at most 2 b_n + sum b_k b_(n-k) = 4 b_n from n = 2 on, since the square
        of sqrt(1 - x) has none there; that of n = 1 is s. So the D of a distance R errs from a line by coefficients
        below R^(1-n) p_n, p_1 = 1, p_n = 4 b_n.
     2. The way back is such a root of b, which in turn has coefficients below 1 + B p_1, B p_2 R^-1, ...: the
        root's series with them put in bounds the composition's (Faa di Bruno's formula has no negative terms).
     3. R^(1-n) at the least distance R bounds all others.

   The sum of both bounds, T_n, is computed as power series. Hence h^n = error 2^(n-1) R^(n-1)/T_n. */
#include "backprojection/invariant/pieces.h"

#include <math.h>

enum { N = PIECE_POWERS };

void piece_fit_make(struct piece_fit *fit)
{
    for (int j = 0; j < N; j++)
        fit->node[j] = -cos(M_PI * (2 * j + 1) / (2.0 * N));
    for (int j = 0; j < N; j++) { /* Lagrange's polynomial of node j, a factor at a time */
        double *c = fit->power[j];
        for (int k = 0; k < N; k++)
            c[k] = k == 0;
        for (int i = 0; i < N; i++) {
            const double scale = i == j ? 1 : 1 / (fit->node[j] - fit->node[i]);
            for (int k = N - 1; i != j && k >= 0; k--)
                c[k] = scale * ((k > 0 ? c[k - 1] : 0) - fit->node[i] * c[k]);
        }
    }
}

/* out = a b, powers up to N; out is neither of them. */
static void multiply(const double *a, const double *b, double *out)
{
    for (int n = 0; n <= N; n++) {
        out[n] = 0;
        for (int k = 0; k <= n; k++)
            out[n] += a[k] * b[n - k];
    }
}

double piece_reach(double mach, double error)
{
    const double e = (1 - mach) * (1 + mach), slower = sqrt(e);
    double p[N + 1] = {0, 1}, b = 0.5, back[N + 1] = {0}, inner[N + 1] = {0}, work[N + 1];
    for (int n = 2; n <= N; n++) {
        b *= (n - 1.5) / n;
        p[n] = 4 * b;
    }
    for (int n = 1; n <= N; n++) /* b of u, over the root's own distance, slower R */
        inner[n] = ((n == 1) + mach * p[n]) / slower;
    for (int n = N; n >= 1; n--) { /* Horner's rule for the series p of the series `inner` */
        back[0] += p[n];
        multiply(back, inner, work);
        for (int k = 0; k <= N; k++)
            back[k] = work[k];
    }
    const double bound = p[N] + (mach * mach * p[N] + slower * back[N]) / e;
    return pow(error * pow(2, N - 1) / bound, 1.0 / N);
}

double piece_half(double reach, double distance)
{
    return reach * pow(distance, (N - 1.0) / N);
}
