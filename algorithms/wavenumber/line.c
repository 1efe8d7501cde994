/* Omega-k at one azimuth wavenumber: the cells of its line, read or interpolated along azimuth, then along range onto
   Ky, then focused onto the rows (rotate, stolt and focus of wk.h). Compiled once for each precision and instruction
   set (BP_ISA names it). */
#include <stdint.h>
#include <string.h>

#include "common/phasor.h"
#include "wavenumber/engine.h"

enum { SPAN = WK_SPAN };

/* One thread at one line. */
struct line {
    const struct wk *wk;
    double kx;              /* rad/m, in the own axes */
    double low, high;       /* Hz: F of the cells that are worked on */
    real *values, *re, *im; /* [row] complex; [band + 2 guard] each: the cells, zeros beside them */
    real *wave, *stored;    /* [longest transform] complex; [rows][WK_TILE] complex */
    double *seconds, mark;
};

static void stage_end(struct line *l, enum wk_stage stage)
{
    double now = seconds_now();
    l->seconds[stage] += now - l->mark;
    l->mark = now;
}

static double bin_frequency(const struct wk *wk, double bin)
{
    return wk->fc + (wk->band_first + bin) * wk->fs / wk->range_length;
}

/* Cells of the band as real and imaginary parts; those outside [begin, end) read zero. */
static void cells_split(const struct line *l, const real *restrict row, int begin, int end)
{
    real *restrict re = l->re + WK_GUARD, *restrict im = l->im + WK_GUARD;
    memset(re, 0, (size_t)begin * sizeof *re);
    memset(im, 0, (size_t)begin * sizeof *im);
    for (int k = begin; k < end; k++) {
        re[k] = row[2 * k];
        im[k] = row[2 * k + 1];
    }
    memset(re + end, 0, (size_t)(l->wk->band - end) * sizeof *re);
    memset(im + end, 0, (size_t)(l->wk->band - end) * sizeof *im);
}

/* Unfolded: the line's cells where the wavenumber lies within pi/spacing of the centroid K_R slope. */
static void cells_read(struct line *l, int index)
{
    const struct wk *wk = l->wk;
    const int length = wk->azimuth_length, bin = ((wk->line_first + index) % length + length) % length;
    const double step = 4 * M_PI / wk->sound_speed * wk->slope, half = M_PI / wk->spacing * (1 + 1e-12);
    double low = l->low, high = l->high;
    if (fabs(step) * wk->fc > 1e-9 * half) {
        double a = (l->kx - half) / step, b = (l->kx + half) / step;
        low = fmax(low, fmin(a, b));
        high = fmin(high, fmax(a, b));
    }
    const double per_hz = wk->range_length / wk->fs, first = bin_frequency(wk, 0);
    double begin = fmin(fmax(ceil((low - first) * per_hz - 1e-6), 0), wk->band);
    double end = fmin(fmax(floor((high - first) * per_hz + 1e-6) + 1, begin), wk->band);
    cells_split(l, (const real *)wk->data + 2 * (size_t)wk->row * (size_t)bin, (int)begin, (int)end);
    if (wk->skips) {
        l->low = low;
        l->high = high;
    }
}

/* Cells k0 to k0 + n - 1 from azimuth bins `first` on, whose weights come from the kernel's table. */
static inline __attribute__((always_inline)) void rotate_run(const struct wk *wk, int taps, long long first, int k0,
                                                             int n, const int *restrict interval,
                                                             const real *restrict u, real *restrict out)
{
    const int length = wk->azimuth_length;
    const real *kernel = wk->azimuth_kernel.values;
    real re[SPAN], im[SPAN];
    for (int i = 0; i < n; i++)
        re[i] = im[i] = 0;
    int bin = (int)(((first + 1 - taps / 2) % length + length) % length);
    for (int t = 0; t < taps; t++, kernel += WK_INTERVALS + 2) {
        const real *row = (const real *)wk->data + 2 * ((size_t)wk->row * (size_t)bin + (size_t)k0);
#pragma omp simd
        for (int i = 0; i < n; i++) {
            real a = kernel[interval[i]], weight = a + u[i] * (kernel[interval[i] + 1] - a);
            re[i] += weight * row[2 * i];
            im[i] += weight * row[2 * i + 1];
        }
        bin = bin + 1 < length ? bin + 1 : 0;
    }
    for (int i = 0; i < n; i++) {
        out[2 * i] = re[i];
        out[2 * i + 1] = im[i];
    }
}

/* Rotated: the line's cells from Kx - K_R slope, between the bins of the azimuth transform (SQ18 Eq. (12)). */
static void cells_rotate(struct line *l)
{
    const struct wk *wk = l->wk;
    const double sine = sin(wk->angle), cosine = cos(wk->angle), to_kr = 4 * M_PI / wk->sound_speed;
    const double per_kx = wk->azimuth_length * wk->spacing / (2 * M_PI), half = wk->azimuth_length / 2.0;
    const double c = wk->sound_speed, beta = wk->speed / c, b1 = (1 - beta) * (1 + beta);
    for (int k0 = 0; k0 < wk->band; k0 += SPAN) {
        const int n = wk->band - k0 < SPAN ? wk->band - k0 : SPAN;
        double place[SPAN];
        real u[SPAN];
        int interval[SPAN];
#pragma omp simd
        for (int i = 0; i < n; i++) {
            double f = (wk->fc + (wk->band_first + k0 + i) * wk->fs / wk->range_length) * to_kr;
            double root = f * f * (beta * beta * sine * sine + b1) - b1 * l->kx * (2 * f * beta * cosine + b1 * l->kx);
            double ky = (sqrt(root > 0 ? root : 0) - f * beta * sine) / b1;
            double at = (l->kx * cosine + ky * sine - f * wk->slope) * per_kx, bin = floor(at);
            bool exists = root > 0 && fabs(at) <= half;
            place[i] = exists ? bin : -2 * half;
            double fine = exists ? (at - bin) * WK_INTERVALS : 0;
            interval[i] = (int)fine;
            u[i] = (real)(fine - interval[i]);
        }
        for (int i = 0, end; i < n; i = end) {
            for (end = i + 1; end < n && place[end] == place[i]; end++)
                ;
            real *out = l->values + 2 * (k0 + i);
            if (place[i] < -half - 1)
                memset(out, 0, 2 * (size_t)(end - i) * sizeof *out);
            else if (wk->taps == 8)
                rotate_run(wk, 8, (long long)place[i], k0 + i, end - i, interval + i, u + i, out);
            else
                rotate_run(wk, wk->taps, (long long)place[i], k0 + i, end - i, interval + i, u + i, out);
        }
    }
    cells_split(l, l->values, 0, wk->band);
}

/* Values of the cells between their bins; a position counts from the first guard. `taps` is a constant where this is
   inlined. */
static inline __attribute__((always_inline)) void interpolate(const struct line *l, int taps, int n,
                                                              const double *restrict position, real *restrict vr,
                                                              real *restrict vi)
{
    const real *kernel = l->wk->range_kernel.values, *re = l->re, *im = l->im;
    enum { ROW = WK_INTERVALS + 2 };
#pragma omp simd
    for (int j = 0; j < n; j++) {
        int bin = (int)position[j], first = bin + 1 - taps / 2;
        real fine = (real)((position[j] - bin) * WK_INTERVALS), sum_r = 0, sum_i = 0;
        int interval = (int)fine;
        real u = fine - (real)interval;
        for (int t = 0; t < taps; t++) {
            real a = kernel[t * ROW + interval], weight = a + u * (kernel[t * ROW + interval + 1] - a);
            sum_r += weight * re[first + t];
            sum_i += weight * im[first + t];
        }
        vr[j] = sum_r;
        vi[j] = sum_i;
    }
}

/* Where the cells end: Ky of [low, high] Hz as bins of the patch's transform. */
static void ky_bins(const struct line *l, double step, long long *first, long long *last)
{
    double low = wk_ky(l->wk, l->low, l->kx), high = wk_ky(l->wk, l->high, l->kx);
    *first = isfinite(low) ? (long long)ceil(low / step) : 1;
    *last = isfinite(high) && l->high > l->low ? (long long)floor(high / step) : *first - 1;
}

/* Positions, phases and weights of Ky bins j0 to j0 + n - 1. */
static void ky_places(const struct line *l, const struct wk_patch *patch, long long j0, int n,
                      double *restrict position, double *restrict cycles, real *restrict weight)
{
    const struct wk *wk = l->wk;
    const double c = wk->sound_speed, beta = wk->speed / c, b1 = (1 - beta) * (1 + beta), scale = c / (4 * M_PI);
    const double sine = sin(wk->angle), cosine = cos(wk->angle), bin = wk->fs / wk->range_length, fc = wk->fc;
    const double step = 2 * M_PI / (patch->length * patch->own.r_step), r = patch->own.r_first / (2 * M_PI);
    const double t_centre = wk->t0 + wk->centre / wk->fs, carrier = (double)patch->bin_carrier * step;
    const double to_first = WK_GUARD - wk->band_first, least = WK_GUARD, most = WK_GUARD + wk->band - 1,
                 from = (double)j0;
#pragma omp simd
    for (int i = 0; i < n; i++) {
        double ky0 = (from + i) * step, h = scale * (l->kx * cosine + ky0 * sine);
        double kappa = scale * (ky0 * cosine - l->kx * sine);
        double root = sqrt(h * h + b1 * kappa * kappa), frequency = beta * h + root, offset = frequency - fc;
        double at = offset / bin + to_first;
        bool exists = kappa > 0 && at >= least - 0.5 && at <= most + 0.5;
        position[i] = exists ? at : least;
        double k = exists ? kappa : 1;
        double value = frequency * sqrt(c / (2 * k)) * scale / root * step / wk->fs;
        weight[i] = exists ? (real)value : 0;
        double f = (ky0 - carrier) * r - offset * t_centre + 0.125;
        cycles[i] = f - floor(f + 0.5);
    }
}

/* A resampled patch's weights along Ky. */
static void taper(const struct wk *wk, const struct wk_patch *patch, long long j0, int n, real *weight)
{
    const real *weights = wk->range_weights;
    for (int i = 0; i < n; i++) {
        double at = fmin(fabs((double)(j0 + i - patch->bin_carrier)) * 2 / patch->length, 1) * WK_WEIGHTS;
        weight[i] *= weights[(int)at];
    }
}

static void focus(struct line *l, const struct wk_patch *patch, real *stored)
{
    const struct wk *wk = l->wk;
    const double step = 2 * M_PI / (patch->length * patch->own.r_step);
    real *wave = l->wave;
    long long first, last;
    ky_bins(l, step, &first, &last);
    memset(wave, 0, 2 * (size_t)patch->length * sizeof *wave);
    double position[SPAN], cycles[SPAN];
    real weight[SPAN], re[SPAN], im[SPAN], wr[SPAN], wi[SPAN];
    for (long long j0 = first; j0 <= last; j0 += SPAN) {
        const int n = last - j0 + 1 < SPAN ? (int)(last - j0 + 1) : SPAN;
        ky_places(l, patch, j0, n, position, cycles, weight);
        if (patch->resampled)
            taper(wk, patch, j0, n, weight);
        switch (wk->taps) {
        case 4: interpolate(l, 4, n, position, re, im); break;
        case 8: interpolate(l, 8, n, position, re, im); break;
        default: interpolate(l, wk->taps, n, position, re, im); break;
        }
        stage_end(l, WK_STOLT);
#pragma omp simd
        for (int i = 0; i < n; i++) {
            phasor((real)cycles[i], &wr[i], &wi[i]);
            wr[i] *= weight[i];
            wi[i] *= weight[i];
        }
        long long from = (j0 - patch->bin_carrier) % patch->length;
        int at = (int)(from < 0 ? from + patch->length : from);
        for (int i = 0; i < n; i++) {
            wave[2 * at] += re[i] * wr[i] - im[i] * wi[i];
            wave[2 * at + 1] += re[i] * wi[i] + im[i] * wr[i];
            if (++at == patch->length)
                at = 0;
        }
        stage_end(l, WK_FOCUS);
    }
    FFTW(execute_dft)(patch->focus_plan, (complex_real *)wave, (complex_real *)wave);
    for (int i = 0; i < patch->own.r_count; i++) {
        stored[2 * WK_TILE * i] = wave[2 * i];
        stored[2 * WK_TILE * i + 1] = wave[2 * i + 1];
    }
    stage_end(l, WK_FOCUS);
}

/* Every buffer begins on a line of the cache. */
static real *aligned(real *memory)
{
    return (real *)(((uintptr_t)memory + WK_ALIGNMENT - 1) / WK_ALIGNMENT * WK_ALIGNMENT);
}

void REAL_ISA_NAME(wk_line)(const struct wk *wk, int thread, int first, double seconds[WK_STAGES])
{
    struct line l = {.wk = wk, .seconds = seconds, .mark = seconds_now()};
    const size_t cells = (size_t)wk->band + 2 * WK_GUARD;
    l.wave = (real *)((char *)wk->scratch + (size_t)thread * wk->scratch_bytes); /* as FFTW was told: aligned */
    size_t longest = 0;
    for (int k = 0; k < wk->patch_count; k++)
        longest = (size_t)wk->patches[k].length > longest ? (size_t)wk->patches[k].length : longest;
    l.values = aligned(l.wave + 2 * longest);
    l.re = aligned(l.values + 2 * (size_t)wk->row);
    l.im = l.re + cells;
    l.stored = aligned(l.im + cells);
    memset(l.re, 0, 2 * cells * sizeof *l.re);
    memset(l.stored, 0, 2 * WK_TILE * wk->rows * sizeof *l.stored);
    for (int n = 0; n < WK_TILE && first + n < wk->lines; n++) {
        l.kx = wk->kx_first + (first + n) * wk->kx_step;
        l.low = bin_frequency(wk, 0);
        l.high = bin_frequency(wk, wk->band - 1);
        if (wk->angle != 0)
            cells_rotate(&l);
        else
            cells_read(&l, first + n);
        stage_end(&l, WK_ROTATE);
        for (int k = 0; k < wk->patch_count; k++)
            focus(&l, &wk->patches[k], l.stored + 2 * (WK_TILE * wk->patches[k].row + (size_t)n));
    }
    real *out = (real *)wk->focused + 2 * (size_t)first;
    for (size_t i = 0; i < wk->rows; i++)
        memcpy(out + 2 * wk->line_stride * i, l.stored + 2 * WK_TILE * i, 2 * WK_TILE * sizeof *out);
    stage_end(&l, WK_FOCUS);
}
