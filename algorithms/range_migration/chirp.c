/* Range migration at one azimuth wavenumber: the focusing of a patch's rows by chirp transforms (rma_engine.h).
   Compiled once for each precision and instruction set (BP_ISA names it). */
#include <string.h>

#include "range_migration/column.h"

/* Bins of F at one wavenumber, and the rows of one piece. */
struct bins {
    const struct chirp *chirp;
    double fc;                     /* Hz */
    double half, beta, to_f, to_k; /* K = to_k sqrt(...), as spectrum_monostatic */
    double to_row;                 /* cycles of K (rad/m) at the row that the phases count from */
    double to_centre, to_first;    /* s: the samples' origin; cycles of a bin from that row to the first one */
    double shift;                  /* cycles: to the patch's columns, and an eighth */
    double weight;                 /* of the cell, but for F/K^1.5 */
};

/* exp(j 2 pi f) for any f. */
static inline __attribute__((always_inline)) void turn(double f, real *c, real *s)
{
    phasor((real)(f - floor(f + 0.5)), c, s);
}

/* a *= b, complex. */
static inline void multiply(const real *restrict b, int count, real *restrict a)
{
    for (int k = 0; k < 2 * count; k += 2) {
        const real re = a[k] * b[k] - a[k + 1] * b[k + 1];
        a[k + 1] = a[k] * b[k + 1] + a[k + 1] * b[k];
        a[k] = re;
    }
}

/* exp(+j pi alpha n^2), alpha in cycles, and the transform of its conjugate over all n from a bin to a row. */
static void kernel_fill(const struct rma_patch *patch, const struct chirp *chirp, real *restrict wave,
                        real *restrict chirps, real *restrict kernel)
{
    const int length = patch->length, rows = patch->piece, count = chirp->count;
    const double square = chirp->slope * patch->step / (4 * M_PI);
    const real scale = 1 / (real)length;
#pragma omp simd
    for (int n = 0; n < (rows > count ? rows : count); n++)
        turn(square * n * n, &chirps[2 * n], &chirps[2 * n + 1]);
    memset(wave, 0, 2 * (size_t)length * sizeof *wave);
    for (int n = 0; n < rows; n++) {
        wave[2 * n] = scale * chirps[2 * n];
        wave[2 * n + 1] = -scale * chirps[2 * n + 1];
    }
    for (int n = 1; n < count; n++) {
        wave[2 * (length - n)] = scale * chirps[2 * n];
        wave[2 * (length - n) + 1] = -scale * chirps[2 * n + 1];
    }
    FFTW(execute_dft)(patch->chirp_plan, (complex_real *)wave, (complex_real *)kernel);
}

/* The bins of a piece, times their phases and weights, and the shares of the bend. */
static void line_fill(const struct bins *b, const real *restrict re, const real *restrict im, real *restrict line,
                      real *restrict shares)
{
    const struct chirp *chirp = b->chirp;
    const double to_share = chirp->extreme > 0 ? 1 / chirp->extreme : 0;
#pragma omp simd
    for (int n = 0; n < chirp->count; n++) {
        const double offset = (chirp->first + n) * chirp->bin, f = (b->fc + offset) * b->to_f;
        const double along = b->half + f * b->beta, k = b->to_k * sqrt((f - along) * (f + along));
        const real weight = (real)(b->weight * (b->fc + offset) / (k * sqrt(k)));
        real c, s;
        turn(k * b->to_row - offset * b->to_centre - n * b->to_first + b->shift, &c, &s);
        line[2 * n] = weight * (re[n] * c - im[n] * s);
        line[2 * n + 1] = weight * (re[n] * s + im[n] * c);
        shares[n] = (real)((k - chirp->start - n * chirp->slope) * to_share);
    }
}

/* sums += factor powers values; the powers of y, from -1 to 1, go on to the next. */
static void add_term(const real *restrict values, int rows, double middle, double complex factor, real *restrict powers,
                     real *restrict sums)
{
    const real re = (real)creal(factor), im = (real)cimag(factor), to_y = middle > 0 ? (real)(1 / middle) : 0;
    for (int i = 0; i < rows; i++) {
        sums[2 * i] += powers[i] * (re * values[2 * i] - im * values[2 * i + 1]);
        sums[2 * i + 1] += powers[i] * (re * values[2 * i + 1] + im * values[2 * i]);
        powers[i] *= ((real)i - (real)middle) * to_y;
    }
}

/* Rows one by one: each turns the bins by a step. */
static void rows_add(const struct chirp *chirp, int rows, double step, const real *restrict shares, real *restrict line,
                     real *restrict steps, real *restrict sums)
{
    const double cycles = step / (2 * M_PI);
#pragma omp simd
    for (int n = 0; n < chirp->count; n++)
        turn((chirp->start + n * chirp->slope + chirp->extreme * shares[n]) * cycles, &steps[2 * n], &steps[2 * n + 1]);
    for (int i = 0; i < rows; i++) {
        real sum_re = 0, sum_im = 0;
#pragma omp simd reduction(+ : sum_re, sum_im)
        for (int n = 0; n < chirp->count; n++) {
            const real re = line[2 * n], im = line[2 * n + 1];
            sum_re += re;
            sum_im += im;
            line[2 * n] = re * steps[2 * n] - im * steps[2 * n + 1];
            line[2 * n + 1] = re * steps[2 * n + 1] + im * steps[2 * n];
        }
        sums[2 * i] = sum_re;
        sums[2 * i + 1] = sum_im;
    }
}

/* `rows` rows of a piece. */
static void piece_fill(struct workspace *w, const struct rma_patch *patch, const struct chirp *chirp, int rows,
                       real *restrict sums)
{
    const int count = chirp->count, length = patch->length;
    const double middle = (patch->piece - 1) / 2.0, cycles = chirp->start * patch->step / (2 * M_PI);
    const real *chirps = buffer(w, RMA_CHIRP), *kernel = buffer(w, RMA_KERNEL), *shares = buffer(w, RMA_SHARES);
    real *powers = (real *)buffer(w, RMA_SHARES) + w->swath->stolt_length;
    real *line = buffer(w, RMA_LINE), *wave = buffer(w, RMA_WAVE), *turned = buffer(w, RMA_TRANSFORMED);
    memset(sums, 0, 2 * (size_t)rows * sizeof *sums);
    multiply(chirps, count, line);
    for (int i = 0; i < rows; i++)
        powers[i] = 1;
    for (int t = 0; t < chirp->terms; t++) {
        for (int n = 0; t > 0 && n < count; n++) {
            line[2 * n] *= shares[n];
            line[2 * n + 1] *= shares[n];
        }
        memcpy(wave, line, 2 * (size_t)count * sizeof *wave);
        memset(wave + 2 * count, 0, 2 * (size_t)(length - count) * sizeof *wave);
        FFTW(execute_dft)(patch->chirp_plan, (complex_real *)wave, (complex_real *)turned);
        multiply(kernel, length, turned);
        FFTW(execute_dft)(patch->focus_plan, (complex_real *)turned, (complex_real *)wave);
        add_term(wave, rows, middle, chirp->factors[t], powers, sums);
    }
    multiply(chirps, rows, sums);
#pragma omp simd
    for (int i = 0; i < rows; i++) {
        real c, s, re = sums[2 * i], im = sums[2 * i + 1];
        turn((i - middle) * cycles, &c, &s);
        sums[2 * i] = re * c - im * s;
        sums[2 * i + 1] = re * s + im * c;
    }
}

void REAL_ISA_NAME(rma_chirp_rows)(struct workspace *w, const struct rma_patch *patch, const real *z, real *stored)
{
    const struct rma *rma = w->rma;
    const struct rma_swath *swath = w->swath;
    const double c = rma->monostatic.sound_speed, beta = rma->monostatic.speed / c, b1 = (1 - beta) * (1 + beta),
                 to_k = 4 * M_PI / c;
    const int length = swath->stolt_length, all = patch->grid.r_count;
    struct chirp chirp;
    if (!chirp_find(rma, swath, patch, &w->line, &chirp)) {
        memset(stored, 0, 2 * (size_t)all * sizeof *stored);
        return;
    }
    if (!patch->sums)
        kernel_fill(patch, &chirp, buffer(w, RMA_WAVE), buffer(w, RMA_CHIRP), buffer(w, RMA_KERNEL));
    const real *re = z + RMA_GUARD + length / 2 + chirp.first, *im = re + length + 2 * RMA_GUARD;
    for (int row = 0; row < all; row += patch->piece) {
        const struct bins bins = {
            .chirp = &chirp,
            .fc = rma->setting.fc,
            .half = c * w->line.nu / 2,
            .beta = beta,
            .to_f = 1 / b1,
            .to_k = to_k,
            .weight = sqrt(c / 2) * to_k * sqrt(to_k) / (b1 * length),
            .to_row = (patch->grid.r_first + row * patch->step + chirp.reach) / (2 * M_PI),
            .to_centre = swath->t_first + swath->centre / rma->fs,
            .to_first = chirp.slope * chirp.reach / (2 * M_PI),
            .shift = rma_shift(swath, patch, w->q) + 0.125,
        };
        const int rows = all - row < patch->piece ? all - row : patch->piece;
        line_fill(&bins, re, im, buffer(w, RMA_LINE), buffer(w, RMA_SHARES));
        if (patch->sums)
            rows_add(&chirp, rows, patch->step, buffer(w, RMA_SHARES), buffer(w, RMA_LINE), buffer(w, RMA_CHIRP),
                     stored + 2 * (size_t)row);
        else
            piece_fill(w, patch, &chirp, rows, stored + 2 * (size_t)row);
    }
    stage_end(w, RMA_FOCUS);
}
