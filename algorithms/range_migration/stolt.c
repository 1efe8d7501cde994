/* Range migration at one azimuth wavenumber: the Stolt interpolation and the focusing of a patch's rows (stolt and
   focus of rma.h). Compiled once for each precision and instruction set (BP_ISA names it). */
#include <string.h>

#include "range_migration/column.h"

enum { SPAN = RMA_SPAN, PIECE = 4 * SPAN /* bins of a polynomial */, EIGHT = 8 };
typedef real vec8 __attribute__((vector_size(EIGHT * sizeof(real)), aligned(sizeof(real)), may_alias));

/* Bins of K at one wavenumber and patch: K = j step. */
struct bins {
    double fc, half, beta, b1; /* Hz; half: c nu/2 */
    double to_kappa;           /* of j: c step/4 pi */
    double to_position, to_fc; /* of the frequency above fc: bins of the spectrum */
    double to_row, to_centre;  /* cycles of j at the first row; s, the samples' origin */
    double shift;              /* cycles: to the patch's columns */
    double weight;             /* of the cell: all factors constant along K */
};

static inline __attribute__((always_inline)) struct fit_cell bin_exact(const void *of, double j)
{
    const struct bins *b = of;
    double kappa = b->to_kappa * j, root = sqrt(b->half * b->half + b->b1 * kappa * kappa);
    double frequency = b->beta * b->half + root, offset = frequency - b->fc;
    return (struct fit_cell){offset * b->to_position + b->to_fc, j * b->to_row - offset * b->to_centre + b->shift,
                             b->weight * frequency / (root * sqrt(kappa))}; /* F/(kappa^1.5) dF/dK */
}

/* Places between a spectrum's bins, with the weights there. */
struct places {
    int first[SPAN], weights[SPAN]; /* the first tap's bin; the first weight in the kernel's table */
    real between[SPAN];             /* of these weights and the next ones */
};

/* Position counts from the first guard bin. The last place is repeated up to a multiple of four. */
static inline __attribute__((always_inline)) void places_fill(const double *restrict position, int n, int taps,
                                                              struct places *restrict places)
{
#pragma omp simd
    for (int j = 0; j < n; j++) {
        const int bin = (int)position[j];
        const double interval = (position[j] - bin) * RMA_INTERVALS;
        const int whole = (int)interval;
        places->first[j] = bin + 1 - taps / 2;
        places->weights[j] = whole * taps;
        places->between[j] = (real)(interval - whole);
    }
    for (int j = n; j % 4 != 0; j++) {
        places->first[j] = places->first[n - 1];
        places->weights[j] = places->weights[n - 1];
        places->between[j] = places->between[n - 1];
    }
}

/* Sums of eight lanes, each in four lanes: of the real parts, then of the imaginary ones. `taps`, a multiple of eight,
   is a constant where this is inlined. */
static inline __attribute__((always_inline)) void eights(const real *kernel, const real *restrict spectrum, int length,
                                                         int taps, const struct places *places, int j, vec8 *sums)
{
    const real *a = kernel + places->weights[j], *b = a + taps, u = places->between[j];
    const real *re = spectrum + places->first[j], *im = re + length + 2 * RMA_GUARD;
    vec8 vr = {0}, vi = {0};
    for (int k = 0; k < taps; k += EIGHT) {
        const vec8 low = *(const vec8 *)(a + k), weight = low + u * (*(const vec8 *)(b + k) - low);
        vr += weight * *(const vec8 *)(re + k);
        vi += weight * *(const vec8 *)(im + k);
    }
    *sums = __builtin_shufflevector(vr, vi, 0, 1, 2, 3, 8, 9, 10, 11)
            + __builtin_shufflevector(vr, vi, 4, 5, 6, 7, 12, 13, 14, 15);
}

/* As `interpolate`, four bins at a time: they share the sum over a vector's lanes. */
static inline __attribute__((always_inline)) void interpolate_fours(const real *kernel, const real *restrict spectrum,
                                                                    int length, int taps, int n,
                                                                    const struct places *places, real *restrict re,
                                                                    real *restrict im)
{
    for (int j = 0; j < n; j += 4) {
        vec8 half[4], quarter[2];
        for (int k = 0; k < 4; k++)
            eights(kernel, spectrum, length, taps, places, j + k, &half[k]);
        for (int k = 0; k < 2; k++)
            quarter[k] = __builtin_shufflevector(half[2 * k], half[2 * k + 1], 0, 1, 8, 9, 4, 5, 12, 13)
                         + __builtin_shufflevector(half[2 * k], half[2 * k + 1], 2, 3, 10, 11, 6, 7, 14, 15);
        const vec8 sums = __builtin_shufflevector(quarter[0], quarter[1], 0, 2, 8, 10, 4, 6, 12, 14)
                          + __builtin_shufflevector(quarter[0], quarter[1], 1, 3, 9, 11, 5, 7, 13, 15);
        memcpy(re + j, &sums, 4 * sizeof *re);
        memcpy(im + j, (const real *)&sums + 4, 4 * sizeof *im);
    }
}

/* Values of the spectrum at some places. `taps` is a constant where this is inlined. */
static inline __attribute__((always_inline)) void interpolate(const real *kernel, const real *restrict spectrum,
                                                              int length, int taps, int n, const struct places *places,
                                                              real *restrict re, real *restrict im)
{
    const real *imaginary = spectrum + length + 2 * RMA_GUARD;
    for (int j = 0; j < n; j++) {
        const real *a = kernel + places->weights[j], *b = a + taps, u = places->between[j];
        const int first = places->first[j];
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

/* Bins of K that the band reaches, and some beside it for the spread by interpolation and blocks' edges. */
static struct bins bins_of(const struct workspace *w, const struct rma_patch *patch, long long *first, long long *last)
{
    const struct rma *rma = w->rma;
    const struct rma_swath *swath = w->swath;
    const struct spectrum_setting *monostatic = &rma->monostatic;
    const double c = monostatic->sound_speed, beta = monostatic->speed / c, fc = monostatic->fc;
    const double bin = rma->fs / swath->length, step = 2 * M_PI / (patch->length * patch->step);
    const double lowest = fmax(swath->band_first - RMA_GUARD, -(swath->length / 2)) * bin;
    const double highest = fmin(swath->band_first + swath->band - 1 + RMA_GUARD, (swath->length - 1) / 2) * bin;
    *first = (long long)ceil(spectrum_monostatic(monostatic, fmax(fc + lowest, w->line.lowest), w->line.nu) / step);
    *last = (long long)floor(spectrum_monostatic(monostatic, fc + highest, w->line.nu) / step);
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
                         .shift = rma_shift(swath, patch, w->q),
                         .weight = sqrt(c / 2) * to_kappa / rma->fs};
}

/* wave += the values times their phasors. */
static void add_turned(int n, const real *restrict re, const real *restrict im, const real *restrict wr,
                       const real *restrict wi, real *restrict wave)
{
    for (int i = 0; i < n; i++) {
        wave[2 * i] += re[i] * wr[i] - im[i] * wi[i];
        wave[2 * i + 1] += re[i] * wi[i] + im[i] * wr[i];
    }
}

/* LBF21 Eq. (17). */
static void turn_rows(const struct grid *grid, double offset, real *rows)
{
    for (int i = 0; i < grid->r_count; i++) {
        const double cycles = offset * (grid->r_first + i * grid->r_step);
        real c, s, re = rows[2 * i], im = rows[2 * i + 1];
        phasor((real)(cycles - floor(cycles + 0.5)), &c, &s);
        rows[2 * i] = re * c - im * s;
        rows[2 * i + 1] = re * s + im * c;
    }
}

void REAL_ISA_NAME(rma_stolt)(struct workspace *w, const struct rma_patch *patch, const real *z, real *stored)
{
    const struct rma *rma = w->rma;
    const int length = w->swath->stolt_length;
    long long first, last;
    const struct bins bins = bins_of(w, patch, &first, &last);
    struct fit made, *fit = NULL;
    real *wave = buffer(w, RMA_WAVE), *rows = buffer(w, RMA_TRANSFORMED);
    memset(wave, 0, 2 * (size_t)patch->length * sizeof *wave);
    double position[SPAN], cycles[SPAN], weight[SPAN];
    struct places places;
    real re[SPAN], im[SPAN], wr[SPAN], wi[SPAN];
    for (long long j0 = first; j0 <= last; j0 += SPAN) {
        const int n = last - j0 + 1 < SPAN ? (int)(last - j0 + 1) : SPAN;
        if ((j0 - first) % PIECE == 0) {
            const long long end = last - j0 < PIECE ? last : j0 + PIECE - 1;
            const bool fits = end > j0 && fit_make(&rma->fit, bin_exact, &bins, (double)j0, (double)end, &made);
            fit = fits ? &made : NULL;
        }
        fit_cells(fit, bin_exact, &bins, (double)j0, n, position, cycles, weight);
        places_fill(position, n, rma->taps, &places);
        switch (rma->taps) {
        case 4: interpolate(rma->kernel, z, length, 4, n, &places, re, im); break;
        case 8: interpolate_fours(rma->kernel, z, length, 8, n, &places, re, im); break;
        case 16: interpolate_fours(rma->kernel, z, length, 16, n, &places, re, im); break;
        default: interpolate(rma->kernel, z, length, rma->taps, n, &places, re, im); break;
        }
        stage_end(w, RMA_STOLT);
#pragma omp simd
        for (int i = 0; i < n; i++) {
            phasor((real)cycles[i], &wr[i], &wi[i]);
            wr[i] *= (real)weight[i];
            wi[i] *= (real)weight[i];
        }
        for (int i = 0, left; i < n; i += left) { /* bins beyond the transform fold onto it */
            const int at = (int)((j0 + i) % patch->length);
            left = patch->length - at < n - i ? patch->length - at : n - i;
            add_turned(left, re + i, im + i, wr + i, wi + i, wave + 2 * (size_t)at);
        }
        stage_end(w, RMA_FOCUS);
    }
    FFTW(execute_dft)(patch->focus_plan, (complex_real *)wave, (complex_real *)rows);
    if (rma->turns_rows)
        turn_rows(&patch->grid, rma_offset(rma, w->line.nu), rows);
    memcpy(stored, rows, 2 * (size_t)patch->grid.r_count * sizeof *stored);
    stage_end(w, RMA_FOCUS);
}
