/* Polynomials through values of smooth functions of one variable at Chebyshev's nodes. */
#ifndef SASBENCH_COMMON_FIT_H
#define SASBENCH_COMMON_FIT_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

enum { FIT_DEGREE = 5 };

/* Chebyshev's `count` nodes in [-1, 1], and the matrix from values at them to coefficients, lowest power first:
   c[power] = sum over n of powers[power][n] value[n]. */
void fit_nodes_fill(int count, double nodes[count], double powers[count][count]);

/* Nodes and powers of degree FIT_DEGREE. */
struct fit_nodes {
    double nodes[FIT_DEGREE + 1];
    double powers[FIT_DEGREE + 1][FIT_DEGREE + 1];
};

/* Bin j of a Stolt interpolation: the place in the spectrum (bins), the phase (cycles, whole turns included), the
   weight. */
struct fit_cell {
    double place, cycles, weight;
};
typedef struct fit_cell fit_function(const void *of, double j);

/* The three over a stretch of bins, in y = (j - middle)/half, lowest power first. */
struct fit {
    double middle, half;
    double place[FIT_DEGREE + 1], cycles[FIT_DEGREE + 1], weight[FIT_DEGREE + 1];
};

static inline __attribute__((always_inline)) double fit_value(const double *c, double y)
{
    return c[0] + y * (c[1] + y * (c[2] + y * (c[3] + y * (c[4] + y * c[5]))));
}

/* Fits `exact` over the bins `first` to `last`. False where the polynomials err by more than 1e-6 bins, 1e-7 cycles or
   1e-6 of the weight at the points checked: wide bands at grazing angles. */
static inline __attribute__((always_inline)) bool fit_make(const struct fit_nodes *n, fit_function *exact,
                                                           const void *of, double first, double last, struct fit *fit)
{
    static const double checks[] = {-1, -0.7, 0.3, 1};
    struct fit_cell at[FIT_DEGREE + 1];
    fit->middle = (first + last) / 2;
    fit->half = fmax((last - first) / 2, 1);
    for (int k = 0; k <= FIT_DEGREE; k++)
        at[k] = exact(of, fit->middle + fit->half * n->nodes[k]);
    for (int power = 0; power <= FIT_DEGREE; power++) {
        double place = 0, cycles = 0, weight = 0;
        for (int k = 0; k <= FIT_DEGREE; k++) {
            place += n->powers[power][k] * at[k].place;
            cycles += n->powers[power][k] * at[k].cycles;
            weight += n->powers[power][k] * at[k].weight;
        }
        fit->place[power] = place;
        fit->cycles[power] = cycles;
        fit->weight[power] = weight;
    }
    for (size_t k = 0; k < sizeof checks / sizeof *checks; k++) {
        const struct fit_cell cell = exact(of, fit->middle + fit->half * checks[k]);
        if (!(fabs(fit_value(fit->place, checks[k]) - cell.place) <= 1e-6
              && fabs(fit_value(fit->cycles, checks[k]) - cell.cycles) <= 1e-7
              && fabs(fit_value(fit->weight, checks[k]) - cell.weight) <= 1e-6 * cell.weight))
            return false;
    }
    return true;
}

/* `count` bins from j on, by a fit or (NULL) exactly; cycles are reduced to a fraction, an eighth added to them: the
   phase pi/4 of a focused cell. */
static inline __attribute__((always_inline)) void fit_cells(const struct fit *fit, fit_function *exact, const void *of,
                                                            double j, int count, double *restrict place,
                                                            double *restrict cycles, double *restrict weight)
{
    if (fit) {
        const double step = 1 / fit->half, from = (j - fit->middle) * step;
#pragma omp simd
        for (int i = 0; i < count; i++) {
            double y = from + i * step, f = fit_value(fit->cycles, y) + 0.125;
            place[i] = fit_value(fit->place, y);
            cycles[i] = f - floor(f + 0.5);
            weight[i] = fit_value(fit->weight, y);
        }
        return;
    }
#pragma omp simd
    for (int i = 0; i < count; i++) {
        const struct fit_cell cell = exact(of, j + i);
        double f = cell.cycles + 0.125;
        place[i] = cell.place;
        cycles[i] = f - floor(f + 0.5);
        weight[i] = cell.weight;
    }
}

#endif
