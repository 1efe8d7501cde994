/* Omega-k: one image row from its azimuth wavenumbers (inverse of wk.h). Compiled once for each precision and
   instruction set (BP_ISA names it). */
#include <string.h>

#include "common/real.h"
#include "wavenumber/wk_engine.h"

/* out = a b, written out: a complex product would check for NaN. */
static void multiply(const real *restrict a, const real *restrict b, int count, real *restrict out)
{
#pragma omp simd
    for (int k = 0; k < count; k++) {
        out[2 * k] = a[2 * k] * b[2 * k] - a[2 * k + 1] * b[2 * k + 1];
        out[2 * k + 1] = a[2 * k] * b[2 * k + 1] + a[2 * k + 1] * b[2 * k];
    }
}

static void multiply_add(const real *restrict a, const real *restrict b, int count, real *restrict out)
{
#pragma omp simd
    for (int k = 0; k < count; k++) {
        out[2 * k] += a[2 * k] * b[2 * k] - a[2 * k + 1] * b[2 * k + 1];
        out[2 * k + 1] += a[2 * k] * b[2 * k + 1] + a[2 * k + 1] * b[2 * k];
    }
}

/* out *= a, in place. */
static void multiply_by(real *restrict out, const real *restrict a, int count)
{
#pragma omp simd
    for (int k = 0; k < count; k++) {
        real re = out[2 * k], im = out[2 * k + 1];
        out[2 * k] = re * a[2 * k] - im * a[2 * k + 1];
        out[2 * k + 1] = re * a[2 * k + 1] + im * a[2 * k];
    }
}

/* The weight of ranges: sqrt(r), r the track's. A resampled patch gets it afterwards. */
static void scale(const struct wk_patch *patch, int i, real *restrict out)
{
    const double r = grid_point(&patch->grid, i, 0).y, step = grid_point(&patch->grid, i, 1).y - r;
    const int count = patch->own.x_count;
    if (patch->grid.angle_rad == 0) {
        const real root = (real)sqrt(r);
        for (int k = 0; k < 2 * count; k++)
            out[k] *= root;
        return;
    }
#pragma omp simd
    for (int j = 0; j < count; j++) {
        real root = (real)sqrt(r + j * step);
        out[2 * j] *= root;
        out[2 * j + 1] *= root;
    }
}

void REAL_ISA_NAME(wk_row)(const struct wk *wk, const struct wk_patch *patch, int i, void *memory, void *pixels)
{
    const size_t columns = (size_t)patch->columns;
    const real *from = (const real *)wk->focused + 2 * wk->line_stride * (patch->row + (size_t)i);
    const real *before = patch->before;
    real *wave = memory, *out = pixels;
    const size_t once = (size_t)wk->lines < columns ? (size_t)wk->lines : columns;
    multiply(from, before, (int)once, wave);
    memset(wave + 2 * once, 0, 2 * (columns - once) * sizeof *wave);
    for (size_t n = once, count; n < (size_t)wk->lines; n += count) { /* wavenumbers that fold */
        count = (size_t)wk->lines - n < columns ? (size_t)wk->lines - n : columns;
        multiply_add(from + 2 * n, before + 2 * n, (int)count, wave);
    }
    if (!patch->folds) {
        FFTW(execute_dft)(patch->azimuth_forward, (complex_real *)wave, (complex_real *)wave);
        multiply_by(wave, patch->kernel, patch->columns);
    }
    FFTW(execute_dft)(patch->azimuth_inverse, (complex_real *)wave, (complex_real *)wave);
    multiply(wave, patch->after, patch->own.x_count, out);
    if (!patch->resampled)
        scale(patch, i, out);
}
