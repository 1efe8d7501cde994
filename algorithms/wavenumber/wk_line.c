/* Omega-k at one azimuth wavenumber: the cells of its line, read or interpolated along azimuth, then along range onto
   Ky, then focused onto the rows (rotate, stolt and focus of wk.h). Compiled once for each precision and instruction
   set (BP_ISA names it). */
#include <stdint.h>
#include <string.h>

#include "common/clock.h"
#include "common/lanes.h"
#include "common/phasor.h"
#include "wavenumber/wk_engine.h"

/* Complex numbers in the vectors of lanes.h, real and imaginary parts in turn. */
#define COMPLEX_LANES (VECTOR_BYTES / (REAL_DOUBLE ? 16 : 8))

/* Of two vectors: their even and their odd complex numbers. Of one vector of reals: its first and its second half, each
   number twice. */
#if COMPLEX_LANES == 8
#define COMPLEX_EVEN(a, b) __builtin_shufflevector(a, b, 0, 1, 4, 5, 8, 9, 12, 13, 16, 17, 20, 21, 24, 25, 28, 29)
#define COMPLEX_ODD(a, b)  __builtin_shufflevector(a, b, 2, 3, 6, 7, 10, 11, 14, 15, 18, 19, 22, 23, 26, 27, 30, 31)
#define TWICE_FIRST(a)     __builtin_shufflevector(a, a, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7)
#define TWICE_SECOND(a)    __builtin_shufflevector(a, a, 8, 8, 9, 9, 10, 10, 11, 11, 12, 12, 13, 13, 14, 14, 15, 15)
#elif COMPLEX_LANES == 4
#define COMPLEX_EVEN(a, b) __builtin_shufflevector(a, b, 0, 1, 4, 5, 8, 9, 12, 13)
#define COMPLEX_ODD(a, b)  __builtin_shufflevector(a, b, 2, 3, 6, 7, 10, 11, 14, 15)
#define TWICE_FIRST(a)     __builtin_shufflevector(a, a, 0, 0, 1, 1, 2, 2, 3, 3)
#define TWICE_SECOND(a)    __builtin_shufflevector(a, a, 4, 4, 5, 5, 6, 6, 7, 7)
#elif COMPLEX_LANES == 2
#define COMPLEX_EVEN(a, b) __builtin_shufflevector(a, b, 0, 1, 4, 5)
#define COMPLEX_ODD(a, b)  __builtin_shufflevector(a, b, 2, 3, 6, 7)
#define TWICE_FIRST(a)     __builtin_shufflevector(a, a, 0, 0, 1, 1)
#define TWICE_SECOND(a)    __builtin_shufflevector(a, a, 2, 2, 3, 3)
#else /* one: there is nothing to part */
#define COMPLEX_EVEN(a, b) (a)
#define COMPLEX_ODD(a, b)  (b)
#define TWICE_FIRST(a)     __builtin_shufflevector(a, a, 0, 0)
#define TWICE_SECOND(a)    __builtin_shufflevector(a, a, 1, 1)
#endif

static inline vector_real lanes_load(const real *from)
{
    return *(const vector_real *)from;
}

static inline void lanes_store(real *to, vector_real value)
{
    *(vector_real *)to = value;
}

enum {
    SPAN = WK_SPAN,
    PIECE = 4 * SPAN,  /* Ky bins that share a fit */
    FITTED_LEAST = 16, /* fewer are as fast without one */
    ROWS_AHEAD = 16,   /* prefetched: they lie too far apart for the processor to do so */
    TAPS_MOST = 16
};

/* One thread at one line. */
struct line {
    const struct wk *wk;
    double kx;           /* rad/m, in the own axes */
    double low, high;    /* Hz: F of the cells that are worked on */
    real *cells;         /* [guard + band + guard] complex: zeros beside the band */
    real *wave, *stored; /* [longest transform] complex; [rows][WK_TILE] complex */
    double *seconds, mark;
};

static void stage_end(struct line *l, enum wk_stage stage)
{
    double now = clock_monotonic();
    l->seconds[stage] += now - l->mark;
    l->mark = now;
}

static double bin_frequency(const struct wk *wk, double bin)
{
    return wk->fc + (wk->band_first + bin) * wk->fs / wk->range_length;
}

/* Unfolded: the line's cells where the wavenumber lies within pi/spacing of the centroid K_R slope; others are zero. */
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
    const size_t begin = (size_t)fmin(fmax(ceil((low - first) * per_hz - 1e-6), 0), wk->band);
    const size_t end = (size_t)fmin(fmax(floor((high - first) * per_hz + 1e-6) + 1, (double)begin), wk->band);
    const real *row = (const real *)wk->data + 2 * (size_t)wk->row * (size_t)bin;
    real *cells = l->cells + 2 * WK_GUARD;
    memset(cells, 0, 2 * begin * sizeof *cells);
    memcpy(cells + 2 * begin, row + 2 * begin, 2 * (end - begin) * sizeof *cells);
    memset(cells + 2 * end, 0, 2 * ((size_t)wk->band - end) * sizeof *cells);
    if (wk->skips) {
        l->low = low;
        l->high = high;
    }
}

/* Cells k0 to k0 + n - 1 from azimuth bins `first` on, u being how far beyond bin first: weights by their polynomials
   in u - 1/2, which the mirrored tap shares but for the sign of its odd powers. Whole vectors: up to LANES - 1 cells
   more are written. */
static inline __attribute__((always_inline)) void rotate_run(const struct wk *wk, int taps, long long first, int k0,
                                                             int n, const real *u, real *out)
{
    const int length = wk->azimuth_length;
    const real *rows[TAPS_MOST];
    int bin = (int)(((first + 1 - taps / 2) % length + length) % length);
    for (int t = 0; t < taps; t++) {
        rows[t] = (const real *)wk->data + 2 * ((size_t)wk->row * (size_t)bin + (size_t)k0);
        bin = bin + 1 < length ? bin + 1 : 0;
    }
    for (int i = 0; i < n; i += LANES) {
        const vector_real v = lanes_load(u + i) - (real)0.5, y = v * v;
        vector_real low = {0}, high = {0};
        for (int t = 0; t < taps / 2; t++) {
            const real *c = (const real *)wk->azimuth_kernel.values + WK_POWERS * t;
            const real *a = rows[t] + 2 * i, *b = rows[taps - 1 - t] + 2 * i;
            vector_real even = c[0] + y * (c[2] + y * (c[4] + y * (c[6] + y * c[8])));
            vector_real odd = v * (c[1] + y * (c[3] + y * (c[5] + y * (c[7] + y * c[9]))));
            vector_real wa = even + odd, wb = even - odd;
            low += TWICE_FIRST(wa) * lanes_load(a) + TWICE_FIRST(wb) * lanes_load(b);
            high += TWICE_SECOND(wa) * lanes_load(a + LANES) + TWICE_SECOND(wb) * lanes_load(b + LANES);
        }
        lanes_store(out + 2 * i, low);
        lanes_store(out + 2 * i + LANES, high);
    }
}

/* Where cell k of a line reads: bins of the azimuth transform; beyond all of them where evanescent. */
struct rotation {
    double f_first, f_step;                    /* rad/m: K_R of the band */
    double square, cross, kx2, tilt;           /* of the root: f^2 square - f cross - kx2; f tilt is subtracted from
                                                  it */
    double per_b1, sine, slope, along, per_kx; /* along: of Kx cos */
    double nowhere;
};

static inline __attribute__((always_inline)) struct fit_cell rotation_exact(const void *of, double k)
{
    const struct rotation *r = of;
    double f = r->f_first + k * r->f_step, root = f * (f * r->square - r->cross) - r->kx2;
    double ky = (sqrt(root > 0 ? root : 0) - f * r->tilt) * r->per_b1;
    double at = (r->along + ky * r->sine - f * r->slope) * r->per_kx;
    return (struct fit_cell){root > 0 ? at : r->nowhere, 0, 0};
}

static struct rotation rotation_of(const struct line *l)
{
    const struct wk *wk = l->wk;
    const double sine = sin(wk->angle), cosine = cos(wk->angle), to_kr = 4 * M_PI / wk->sound_speed;
    const double beta = wk->speed / wk->sound_speed, b1 = (1 - beta) * (1 + beta);
    return (struct rotation){.f_first = bin_frequency(wk, 0) * to_kr,
                             .f_step = wk->fs / wk->range_length * to_kr,
                             .square = beta * beta * sine * sine + b1,
                             .cross = 2 * b1 * l->kx * beta * cosine,
                             .kx2 = b1 * b1 * l->kx * l->kx,
                             .tilt = beta * sine,
                             .per_b1 = 1 / b1,
                             .sine = sine,
                             .slope = wk->slope,
                             .along = l->kx * cosine,
                             .per_kx = wk->azimuth_length * wk->spacing / (2 * M_PI),
                             .nowhere = -2.0 * wk->azimuth_length};
}

/* Azimuth bins of `count` cells from k on and how far beyond them, by a fit or (NULL) exactly. Half a transform off the
   centroid there is no signal: `nowhere`. */
static void rotation_places(const struct rotation *r, const struct fit *fit, int k, int count, double half,
                            double *restrict place, real *restrict u)
{
    const double step = fit ? 1 / fit->half : 0, from = fit ? (k - fit->middle) * step : 0;
    double at[SPAN];
    if (fit) {
#pragma omp simd
        for (int i = 0; i < count; i++)
            at[i] = fit_value(fit->place, from + i * step);
    } else {
        for (int i = 0; i < count; i++)
            at[i] = rotation_exact(r, k + i).place;
    }
#pragma omp simd
    for (int i = 0; i < count; i++) {
        double bin = floor(at[i]);
        place[i] = fabs(at[i]) <= half ? bin : r->nowhere;
        u[i] = (real)(at[i] - bin);
    }
}

/* Rotated: the line's cells from Kx - K_R slope, between the bins of the azimuth transform (SQ18 Eq. (12)). */
static void cells_rotate(struct line *l)
{
    const struct wk *wk = l->wk;
    const struct rotation rotation = rotation_of(l);
    struct fit made, *fit = NULL;
    for (int k0 = 0; k0 < wk->band; k0 += SPAN) {
        const int n = wk->band - k0 < SPAN ? wk->band - k0 : SPAN;
        if (k0 % PIECE == 0) {
            int last = wk->band - 1 - k0 < PIECE ? wk->band - 1 : k0 + PIECE - 1;
            fit = fit_make(&wk->fit, rotation_exact, &rotation, k0, last, &made) ? &made : NULL;
        }
        double place[SPAN];
        real u[SPAN + LANES] = {0};
        rotation_places(&rotation, fit, k0, n, wk->azimuth_length / 2.0, place, u);
        for (int i = 0, end; i < n; i = end) {
            for (end = i + 1; end < n && place[end] == place[i]; end++)
                ;
            real *out = l->cells + 2 * (WK_GUARD + k0 + i);
            if (place[i] <= rotation.nowhere)
                memset(out, 0, 2 * (size_t)(end - i) * sizeof *out);
            else if (wk->taps == 8)
                rotate_run(wk, 8, (long long)place[i], k0 + i, end - i, u + i, out);
            else
                rotate_run(wk, wk->taps, (long long)place[i], k0 + i, end - i, u + i, out);
        }
    }
    memset(l->cells + 2 * (WK_GUARD + wk->band), 0, 2 * WK_GUARD * sizeof *l->cells);
}

/* Values of the cells between their bins, complex: the weights at u beyond row `interval` of the kernel's table, times
   the cells from `first` on. Whole vectors. `width` is a constant where this is inlined. */
static inline __attribute__((always_inline)) void interpolate(const struct line *l, int width, int n, const int *first,
                                                              const int *interval, const real *u, real *out)
{
    const real *kernel = l->wk->range_kernel.values, *cells = l->cells;
    for (int j = 0; j < n; j += COMPLEX_LANES) {
        vector_real sum[COMPLEX_LANES];
        for (int k = 0; k < COMPLEX_LANES; k++) {
            const real *a = kernel + (size_t)interval[j + k] * (size_t)width, *b = a + width;
            const real *x = cells + 2 * (size_t)first[j + k];
            sum[k] = (vector_real){0};
            for (int t = 0; t < width; t += LANES) {
                const vector_real low = lanes_load(a + t), weight = low + u[j + k] * (lanes_load(b + t) - low);
                sum[k] += weight * lanes_load(x + t);
            }
        }
        /* Each vector has parts of one cell's sum: pairs are added into one, until one vector has all cells. */
        for (int left = COMPLEX_LANES / 2; left > 0; left /= 2)
            for (int k = 0; k < left; k++)
                sum[k] = COMPLEX_EVEN(sum[2 * k], sum[2 * k + 1]) + COMPLEX_ODD(sum[2 * k], sum[2 * k + 1]);
        lanes_store(out + 2 * j, sum[0]);
    }
}

/* A patch's bins of Ky at one line: Ky0 = j step. */
struct bins {
    double fc, beta, b1;
    double h, h_step, kappa, kappa_step; /* Hz: c/4pi times Kx and Ky in the track's axes, at j = 0 and for each j */
    double to_place, place;              /* of the frequency above fc: bins of the cells */
    double to_row, row, to_centre;       /* cycles of j at the first row, less the carrier's; s, the samples' origin */
    double weight;                       /* of the cell: all factors constant along Ky */
};

static inline __attribute__((always_inline)) struct fit_cell bin_exact(const void *of, double j)
{
    const struct bins *b = of;
    double h = b->h + b->h_step * j, kappa = b->kappa + b->kappa_step * j, root = sqrt(h * h + b->b1 * kappa * kappa);
    double frequency = b->beta * h + root, offset = frequency - b->fc;
    return (struct fit_cell){offset * b->to_place + b->place, j * b->to_row - b->row - offset * b->to_centre,
                             b->weight * frequency / (root * sqrt(kappa))}; /* F/(kappa^1.5) dF/dKy */
}

/* The bins of [low, high] Hz: from `first` to `last`. */
static struct bins bins_of(const struct line *l, const struct wk_patch *patch, long long *first, long long *last)
{
    const struct wk *wk = l->wk;
    const double c = wk->sound_speed, beta = wk->speed / c, scale = c / (4 * M_PI);
    const double sine = sin(wk->angle), cosine = cos(wk->angle);
    const double step = 2 * M_PI / (patch->length * patch->own.r_step), to_row = step * patch->own.r_first / (2 * M_PI);
    const struct bins bins = {.fc = wk->fc,
                              .beta = beta,
                              .b1 = (1 - beta) * (1 + beta),
                              .h = scale * l->kx * cosine,
                              .h_step = scale * sine * step,
                              .kappa = -scale * l->kx * sine,
                              .kappa_step = scale * cosine * step,
                              .to_place = wk->range_length / wk->fs,
                              .place = WK_GUARD - wk->band_first,
                              .to_row = to_row,
                              .row = (double)patch->bin_carrier * to_row,
                              .to_centre = wk->t0 + wk->centre / wk->fs,
                              .weight = sqrt(c / 2) * scale * step / wk->fs};
    double low = wk_ky(wk, l->low, l->kx), high = wk_ky(wk, l->high, l->kx);
    *first = isfinite(low) ? (long long)ceil(low / step) : 1;
    *last = isfinite(high) && l->high > l->low ? (long long)floor(high / step) : *first - 1;
    *first = (long long)fmax((double)*first, floor(-bins.kappa / bins.kappa_step) + 1); /* ahead of the track */
    return bins;
}

/* n Ky bins from j on, interpolated, turned and weighted, added to `wave`; `taper`: weights of a patch to resample, or
   NULL. */
static void cells_add(const struct line *l, const struct bins *bins, const struct fit *fit, long long j, int n,
                      const real *taper, real *restrict wave)
{
    const struct wk *wk = l->wk;
    const double least = WK_GUARD, most = WK_GUARD + wk->band - 1;
    const int before = wk->taps / 2 - 1, whole = (n + COMPLEX_LANES - 1) / COMPLEX_LANES * COMPLEX_LANES;
    double place[SPAN], cycles[SPAN], weight[SPAN];
    real u[SPAN], wr[SPAN], wi[SPAN], value[2 * SPAN];
    int first[SPAN], interval[SPAN];
    fit_cells(fit, bin_exact, bins, (double)j, whole, place, cycles, weight);
#pragma omp simd
    for (int i = 0; i < whole; i++) {
        bool exists = place[i] >= least - 0.5 && place[i] <= most + 0.5;
        double at = exists ? place[i] : least;
        int bin = (int)at;
        real fine = (real)((at - bin) * WK_INTERVALS), w = exists ? (real)weight[i] : 0, c, s;
        phasor((real)cycles[i], &c, &s);
        first[i] = bin - before;
        interval[i] = (int)fine;
        u[i] = fine - (real)interval[i];
        wr[i] = w * c;
        wi[i] = w * s;
    }
    switch (wk_kernel_width(wk->taps)) {
    case 16: interpolate(l, 16, whole, first, interval, u, value); break;
    default: interpolate(l, 32, whole, first, interval, u, value); break;
    }
    for (int i = 0; taper && i < n; i++) {
        wr[i] *= taper[i];
        wi[i] *= taper[i];
    }
#pragma omp simd
    for (int i = 0; i < n; i++) {
        wave[2 * i] += value[2 * i] * wr[i] - value[2 * i + 1] * wi[i];
        wave[2 * i + 1] += value[2 * i] * wi[i] + value[2 * i + 1] * wr[i];
    }
}

static void focus(struct line *l, const struct wk_patch *patch, complex_real *stored)
{
    const struct wk *wk = l->wk;
    real *wave = l->wave;
    long long first, last, fitted = 0;
    const struct bins bins = bins_of(l, patch, &first, &last);
    struct fit made, *fit = NULL;
    memset(wave, 0, 2 * (size_t)patch->length * sizeof *wave);
    long long at = (first - patch->bin_carrier) % patch->length;
    at += at < 0 ? patch->length : 0;
    for (long long j = first, n; j <= last; j += n) {
        if (j == first || j >= fitted) {
            fitted = last + 1 - j < PIECE ? last + 1 : j + PIECE;
            fit = fitted - j >= FITTED_LEAST
                          && fit_make(&wk->fit, bin_exact, &bins, (double)j, (double)(fitted - 1), &made)
                      ? &made
                      : NULL;
        }
        n = fitted - j < SPAN ? fitted - j : SPAN;
        n = patch->length - at < n ? patch->length - at : n;
        cells_add(l, &bins, fit, j, (int)n, patch->resampled ? (const real *)patch->taper + at : NULL, wave + 2 * at);
        at = at + n < patch->length ? at + n : 0;
    }
    stage_end(l, WK_STOLT);
    FFTW(execute_dft)(patch->focus_plan, (complex_real *)wave, (complex_real *)wave);
    for (int i = 0; i < patch->own.r_count; i++)
        stored[WK_TILE * i] = ((const complex_real *)wave)[i];
    stage_end(l, WK_FOCUS);
}

/* Every buffer begins at a line of the cache. */
static real *aligned(real *memory)
{
    return (real *)(((uintptr_t)memory + WK_ALIGNMENT - 1) / WK_ALIGNMENT * WK_ALIGNMENT);
}

void REAL_ISA_NAME(wk_line)(const struct wk *wk, int thread, int first, double seconds[WK_STAGES])
{
    struct line l = {.wk = wk, .seconds = seconds, .mark = clock_monotonic()};
    const size_t cells = (size_t)wk->band + 2 * WK_GUARD;
    l.wave = (real *)((char *)wk->scratch + (size_t)thread * wk->scratch_bytes); /* aligned as for FFTW's plan */
    size_t longest = 0;
    for (int k = 0; k < wk->patch_count; k++)
        longest = (size_t)wk->patches[k].length > longest ? (size_t)wk->patches[k].length : longest;
    l.cells = aligned(l.wave + 2 * longest);
    l.stored = aligned(l.cells + 2 * cells);
    memset(l.cells, 0, 2 * cells * sizeof *l.cells);
    if (wk->lines - first < WK_TILE)
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
            focus(&l, &wk->patches[k], (complex_real *)l.stored + WK_TILE * wk->patches[k].row + n);
    }
    real *out = (real *)wk->focused + 2 * (size_t)first;
    for (size_t i = 0; i < wk->rows; i++) {
        if (i + ROWS_AHEAD < wk->rows)
            __builtin_prefetch(out + 2 * wk->line_stride * (i + ROWS_AHEAD), 1);
        memcpy(out + 2 * wk->line_stride * i, l.stored + 2 * WK_TILE * i, 2 * WK_TILE * sizeof *out);
    }
    stage_end(&l, WK_FOCUS);
}
