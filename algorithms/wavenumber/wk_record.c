/* Omega-k: one record to its spectrum (range of wk.h). Compiled once for each precision and instruction set (BP_ISA
   names it). */
#include <string.h>

#include "common/phasor.h"
#include "wavenumber/wk_engine.h"

/* Samples times their weights, from weights[i] on and `u` of the way to the next: these change so slowly that a
   shift by part of a sample is linear. */
static void weighted(const real *restrict record, const real *restrict weights, real u, real factor, int count,
                     real *restrict out)
{
#pragma omp simd
    for (int i = 0; i < count; i++) {
        real weight = factor * (weights[i] + u * (weights[i + 1] - weights[i]));
        out[2 * i] = record[2 * i] * weight;
        out[2 * i + 1] = record[2 * i + 1] * weight;
    }
}

/* Bins times exp(j 2 pi (first + k step)). */
static void turned(const real *restrict bins, double first, double step, int count, real *restrict out)
{
#pragma omp simd
    for (int k = 0; k < count; k++) {
        double cycles = first + k * step;
        real c, s, re = bins[2 * k], im = bins[2 * k + 1];
        phasor((real)(cycles - floor(cycles + 0.5)), &c, &s);
        out[2 * k] = re * c - im * s;
        out[2 * k + 1] = re * s + im * c;
    }
}

void REAL_ISA_NAME(wk_record)(const struct wk *wk, int n, const void *record, void *memory)
{
    const int length = wk->range_length, samples = wk->samples, centre = wk->centre, below = -wk->band_first;
    const double x = (n - wk->middle) * wk->spacing, way = wk->angle != 0 ? 2 * wk->slope * x / wk->sound_speed : 0;
    const double shift = 2 * wk->drift * x / wk->sound_speed * wk->fs + wk->weights_beside, whole = floor(shift);
    const real *weights = (const real *)wk->range_weights + (int)whole, *from = record;
    const real u = (real)(shift - whole), factor = ((const real *)wk->azimuth_weights)[n];
    real *wave = memory, *row = (real *)wk->data + 2 * (size_t)wk->row * (size_t)n;
    weighted(from + 2 * centre, weights + centre, u, factor, samples - centre, wave);
    memset(wave + 2 * (samples - centre), 0, 2 * (size_t)(length - samples) * sizeof *wave);
    weighted(from, weights, u, factor, centre, wave + 2 * (length - centre));
    FFTW(execute_dft)(wk->range_forward, (complex_real *)wave, (complex_real *)wave);
    const double base = wk->kx_base * x / (2 * M_PI), step = -wk->fs / length * way, first = -wk->fc * way - base;
    if (way == 0 && base == 0) {
        memcpy(row, wave + 2 * (length - below), 2 * (size_t)below * sizeof *row);
        memcpy(row + 2 * below, wave, 2 * (size_t)(wk->band - below) * sizeof *row);
    } else {
        turned(wave + 2 * (length - below), first - below * step, step, below, row);
        turned(wave, first, step, wk->band - below, row + 2 * below);
    }
    memset(row + 2 * wk->band, 0, 2 * (size_t)(wk->row - wk->band) * sizeof *row);
}
