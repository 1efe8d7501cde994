/* Range migration at one azimuth wavenumber: the Stolt interpolation and the focusing of a patch's rows (stolt and
   focus of rma.h). Compiled once for each precision and instruction set (BP_ISA names it). */
#include <string.h>

#include "range_migration/column.h"

enum { SPAN = RMA_SPAN, EIGHT = 8 };
typedef real vec8 __attribute__((vector_size(EIGHT * sizeof(real)), aligned(sizeof(real)), may_alias));

/* Where the fits are held against the closed forms, and how far they may be off: bins, cycles, relative. */
static const double checks[] = {-1, -0.7, 0.3, 1};
static const double close_to[3] = {1e-6, 1e-7, 1e-6};

/* Bins of K at one wavenumber and patch: K = j step. */
struct bins {
    double fc, half, beta, b1; /* Hz; half: c nu/2 */
    double to_kappa;           /* of j: c step/4 pi */
    double to_position, to_fc; /* of the frequency above fc: bins of the spectrum */
    double to_row, to_centre;  /* cycles of j at the first row; s, the samples' origin */
    double weight;             /* of the cell: everything that does not change along K */
};

/* What stands at bin j: the place in the spectrum, the phase in cycles (whole turns included), the weight. */
static inline __attribute__((always_inline)) void bin_exact(const struct bins *b, double j, double *position,
                                                            double *cycles, double *weight)
{
    double kappa = b->to_kappa * j, root = sqrt(b->half * b->half + b->b1 * kappa * kappa);
    double frequency = b->beta * b->half + root, offset = frequency - b->fc;
    *position = offset * b->to_position + b->to_fc;
    *cycles = j * b->to_row - offset * b->to_centre;
    *weight = b->weight * frequency / (root * sqrt(kappa)); /* F/(kappa^1.5) dF/dK */
}

/* Polynomials of these three over the bins, in y = (j - middle)/half. */
struct fit {
    double middle, half, values[3][RMA_DEGREE + 1];
};

static inline __attribute__((always_inline)) double polynomial(const double *c, double y)
{
    return c[0] + y * (c[1] + y * (c[2] + y * (c[3] + y * (c[4] + y * c[5]))));
}

/* False where they are not close enough: wide bands at grazing angles. */
static bool fit_make(const struct rma *rma, const struct bins *b, long long first, long long last, struct fit *fit)
{
    double at[3][RMA_DEGREE + 1];
    fit->middle = (double)(first + last) / 2;
    fit->half = fmax((double)(last - first) / 2, 1);
    for (int n = 0; n <= RMA_DEGREE; n++)
        bin_exact(b, fit->middle + fit->half * rma->nodes[n], &at[0][n], &at[1][n], &at[2][n]);
    for (int k = 0; k < 3; k++)
        for (int power = 0; power <= RMA_DEGREE; power++) {
            fit->values[k][power] = 0;
            for (int n = 0; n <= RMA_DEGREE; n++)
                fit->values[k][power] += rma->powers[power][n] * at[k][n];
        }
    for (size_t n = 0; n < sizeof checks / sizeof *checks; n++) {
        double exact[3];
        bin_exact(b, fit->middle + fit->half * checks[n], &exact[0], &exact[1], &exact[2]);
        for (int k = 0; k < 3; k++)
            if (!(fabs(polynomial(fit->values[k], checks[n]) - exact[k]) <= close_to[k] * (k < 2 ? 1 : exact[k])))
                return false;
    }
    return true;
}

/* `count` bins from j on; cycles are reduced. Without a fit by the closed forms. */
static void places(const struct bins *b, const struct fit *fit, double j, int count, double *restrict position,
                   double *restrict cycles, real *restrict weight)
{
    if (fit) {
        const double step = 1 / fit->half, from = (j - fit->middle) * step;
#pragma omp simd
        for (int i = 0; i < count; i++) {
            double y = from + i * step, f = polynomial(fit->values[1], y) + 0.125;
            position[i] = polynomial(fit->values[0], y);
            cycles[i] = f - floor(f + 0.5);
            weight[i] = (real)polynomial(fit->values[2], y);
        }
        return;
    }
#pragma omp simd
    for (int i = 0; i < count; i++) {
        double f, value;
        bin_exact(b, j + i, &position[i], &f, &value);
        f += 0.125;
        cycles[i] = f - floor(f + 0.5);
        weight[i] = (real)value;
    }
}

/* Values of the spectrum between its bins; position counts from the first guard bin. `taps` is a constant where
   this is inlined. */
static inline __attribute__((always_inline)) void interpolate(const struct rma *rma, const real *restrict spectrum,
                                                              int length, int taps, int n,
                                                              const double *restrict position, real *restrict re,
                                                              real *restrict im)
{
    const real *kernel = rma->kernel, *imaginary = spectrum + length + 2 * RMA_GUARD;
    for (int j = 0; j < n; j++) {
        int bin = (int)position[j], first = bin + 1 - taps / 2;
        double interval = (position[j] - bin) * RMA_INTERVALS;
        const real *a = kernel + (size_t)(int)interval * (size_t)taps, *b = a + taps;
        real u = (real)(interval - (int)interval);
        if (taps % EIGHT == 0) {
            vec8 vr = {0}, vi = {0};
            for (int k = 0; k < taps; k += EIGHT) {
                const vec8 low = *(const vec8 *)(a + k), weight = low + u * (*(const vec8 *)(b + k) - low);
                vr += weight * *(const vec8 *)(spectrum + first + k);
                vi += weight * *(const vec8 *)(imaginary + first + k);
            }
            vec8 sum = __builtin_shufflevector(vr, vi, 0, 1, 2, 3, 8, 9, 10, 11)
                       + __builtin_shufflevector(vr, vi, 4, 5, 6, 7, 12, 13, 14, 15);
            sum += __builtin_shufflevector(sum, sum, 2, 3, 0, 1, 6, 7, 4, 5);
            sum += __builtin_shufflevector(sum, sum, 1, 0, 3, 2, 5, 4, 7, 6);
            re[j] = sum[0];
            im[j] = sum[4];
            continue;
        }
        real vr = 0, vi = 0;
        for (int k = 0; k < taps; k++) {
            real weight = a[k] + u * (b[k] - a[k]);
            vr += weight * spectrum[first + k];
            vi += weight * imaginary[first + k];
        }
        re[j] = vr;
        im[j] = vi;
    }
}

/* Bins of K that the band reaches, and some beside it for what the interpolation and the blocks' edges spread. */
static struct bins bins_of(const struct workspace *w, const struct rma_patch *patch, long long *first, long long *last)
{
    const struct rma *rma = w->rma;
    const struct rma_swath *swath = w->swath;
    const double c = rma->setting.sound_speed, beta = rma->setting.speed / c, fc = rma->setting.fc;
    const double bin = rma->fs / swath->length, step = 2 * M_PI / (patch->length * patch->step);
    const double lowest = fmax(swath->band_first - RMA_GUARD, -(swath->length / 2)) * bin;
    const double highest = fmin(swath->band_first + swath->band - 1 + RMA_GUARD, (swath->length - 1) / 2) * bin;
    *first = (long long)ceil(spectrum_monostatic(&rma->setting, fmax(fc + lowest, w->line.lowest), w->line.nu) / step);
    *last = (long long)floor(spectrum_monostatic(&rma->setting, fc + highest, w->line.nu) / step);
    const double to_kappa = c / (4 * M_PI) * step;
    return (struct bins){.fc = fc,
                         .half = c * w->line.nu / 2,
                         .beta = beta,
                         .b1 = (1 - beta) * (1 + beta),
                         .to_kappa = to_kappa,
                         .to_position = swath->stolt_length / rma->fs,
                         .to_fc = swath->stolt_length / 2 + RMA_GUARD,
                         .to_row = step * patch->grid.r_first / (2 * M_PI),
                         .to_centre = swath->t_first + swath->centre / rma->fs,
                         .weight = sqrt(c / 2) * to_kappa / rma->fs};
}

void REAL_ISA_NAME(rma_stolt)(struct workspace *w, const struct rma_patch *patch, const real *z, real *stored)
{
    const struct rma *rma = w->rma;
    const int length = w->swath->stolt_length;
    long long first, last;
    const struct bins bins = bins_of(w, patch, &first, &last);
    struct fit made, *fit = last > first && fit_make(rma, &bins, first, last, &made) ? &made : NULL;
    real *wave = buffer(w, RMA_WAVE);
    memset(wave, 0, 2 * (size_t)patch->length * sizeof *wave);
    double position[SPAN], cycles[SPAN];
    real weight[SPAN], re[SPAN], im[SPAN], wr[SPAN], wi[SPAN];
    for (long long j0 = first; j0 <= last; j0 += SPAN) {
        const int n = last - j0 + 1 < SPAN ? (int)(last - j0 + 1) : SPAN;
        places(&bins, fit, (double)j0, n, position, cycles, weight);
        switch (rma->taps) {
        case 4: interpolate(rma, z, length, 4, n, position, re, im); break;
        case 8: interpolate(rma, z, length, 8, n, position, re, im); break;
        default: interpolate(rma, z, length, rma->taps, n, position, re, im); break;
        }
        stage_end(w, RMA_STOLT);
#pragma omp simd
        for (int i = 0; i < n; i++) {
            phasor((real)cycles[i], &wr[i], &wi[i]);
            wr[i] *= weight[i];
            wi[i] *= weight[i];
        }
        int at = (int)(j0 % patch->length);
        for (int i = 0; i < n; i++) {
            wave[2 * at] += re[i] * wr[i] - im[i] * wi[i];
            wave[2 * at + 1] += re[i] * wi[i] + im[i] * wr[i];
            if (++at == patch->length)
                at = 0;
        }
        stage_end(w, RMA_FOCUS);
    }
    FFTW(execute_dft)(patch->focus_plan, (complex_real *)wave, (complex_real *)wave);
    memcpy(stored, wave, 2 * (size_t)patch->grid.r_count * sizeof *stored);
    stage_end(w, RMA_FOCUS);
}
