/* The transforms of omega-k along range and azimuth, with their memory, and the resampling of an image to other axes
   (wk_engine.h). Compiled once for each precision. */
#include <omp.h>
#include <string.h>

#include "backprojection/traces.h"
#include "common/fft.h"
#include "common/kaiser.h"
#include "wavenumber/wk_engine.h"
#include "wavenumber/polar_filter.h"

enum {
    STRIP = 2 * WK_ALIGNMENT / sizeof(complex_real), /* bins that go through the azimuth FFT together */
    STRIP_AHEAD = 16,
    TAPS_MOST = 16
};

static real *scratch_of(const struct wk *wk)
{
    return (real *)((char *)wk->scratch + (size_t)omp_get_thread_num() * wk->scratch_bytes);
}

/* A kernel's tap t for a cell that lies u beyond the last bin ahead of it. */
static double tap_value(const struct wk_kernel *kernel, int t, double u)
{
    const double distance = u - (1 - kernel->taps / 2 + t), turn = M_PI * distance;
    if (kernel->shape > 0)
        return kaiser_value(kernel->taps, kernel->shape, distance);
    return fabs(distance) > 1e-9 ? sin(turn) / turn : 1;
}

static void range_kernel_fill(struct wk *wk)
{
    struct wk_kernel *kernel = &wk->range_kernel;
    const size_t width = (size_t)wk_kernel_width(kernel->taps);
    real *values = kernel->values = store_take(&wk->store, width * (WK_INTERVALS + 2), sizeof(real), 1);
    for (int i = 0; values && i < WK_INTERVALS + 2; i++, values += width)
        for (int t = 0; t < kernel->taps; t++)
            values[2 * t] = values[2 * t + 1] = (real)tap_value(kernel, t, (double)i / WK_INTERVALS);
}

static void azimuth_kernel_fill(struct wk *wk)
{
    double nodes[WK_POWERS], powers[WK_POWERS][WK_POWERS];
    struct wk_kernel *kernel = &wk->azimuth_kernel;
    real *values = kernel->values = store_take(&wk->store, (size_t)(kernel->taps / 2) * WK_POWERS, sizeof(real), 1);
    fit_nodes_fill(WK_POWERS, nodes, powers);
    for (int t = 0; values && t < kernel->taps / 2; t++)
        for (int power = 0; power < WK_POWERS; power++) {
            double sum = 0;
            for (int n = 0; n < WK_POWERS; n++)
                sum += powers[power][n] * tap_value(kernel, t, 0.5 + 0.5 * nodes[n]);
            *values++ = (real)ldexp(sum, power); /* nodes are in [-1, 1], u - 1/2 is in half of it */
        }
}

/* 1 over the kernel's transform; constant outside of the samples. */
static double weight_at(const struct wk_kernel *kernel, double place, double most)
{
    return kernel->shape > 0 ? 1 / kaiser_transform(kernel->taps, kernel->shape, fmin(fabs(place), most)) : 1;
}

static void weights_fill(struct wk *wk)
{
    const int count = wk->samples + 2 * wk->weights_beside + 1;
    real *range = wk->range_weights = store_take(&wk->store, (size_t)count, sizeof(real), 1);
    real *azimuth = wk->azimuth_weights = store_take(&wk->store, (size_t)wk->pings, sizeof(real), 1);
    for (int i = 0; range && i < count; i++) {
        double place = (double)(i - wk->weights_beside - wk->centre) / wk->range_length;
        range[i] = (real)weight_at(&wk->range_kernel, place, 0.5 / wk->oversampling);
    }
    for (int n = 0; azimuth && n < wk->pings; n++) {
        const double place = (double)(n - wk->middle) / wk->azimuth_length;
        azimuth[n] = (real)((wk->angle != 0 ? weight_at(&wk->azimuth_kernel, place, 0.45) : 1)
                            * stretch_weight(&wk->stretch, wk->reversed ? wk->pings - 1 - n : n));
    }
}

/* The weight of a line of the spectrum: one, or a Hamming window over the beam: that of the echoes, or the
   transmitter's down to its half power. */
static double line_weight(const struct wk *wk, double kx)
{
    const struct acquisition *a = wk->problem.acquisition;
    const double kr = 4 * M_PI * wk->fc / wk->sound_speed;
    double half = a->tx_length > 0 ? wk->sound_speed / wk->fc / (2 * a->tx_length) : 1;
    if (a->echo_sine > 0 && isfinite(a->echo_sine))
        half = a->echo_sine;
    const double place = fmin(fabs(kx / kr - sin(wk->squint - wk->angle)) / half, 1);
    return wk->options.weighting ? 0.54 + 0.46 * cos(M_PI * place) : 1;
}

/* The azimuth sum over lines kx = kx_first + i kx_step onto columns x = x0 + j dx: one transform where 2 pi/(kx_step
   dx) is its length, or a convolution (chirp z),  2 i j = i^2 + j^2 - (j - i)^2. */
static void azimuth_fill(struct wk *wk, struct wk_patch *patch)
{
    const struct grid *g = &patch->own;
    const int length = patch->columns;
    complex_real *before = patch->before = store_take(&wk->store, (size_t)wk->lines, sizeof *before, 1);
    complex_real *after = patch->after = store_take(&wk->store, (size_t)g->x_count, sizeof *after, 1);
    complex_real *kernel = patch->kernel =
        patch->folds ? NULL : store_take(&wk->store, (size_t)length, sizeof *kernel, 1);
    patch->azimuth_inverse = fft_line(&wk->store, length, wk->scratch, wk->scratch, FFTW_BACKWARD);
    if (wk->store.failed)
        return;
    const double first = (wk->kx_first - patch->kx_carrier) / (2 * M_PI), step = wk->kx_step / (2 * M_PI);
    const double turn = patch->folds ? 1.0 / length : step * g->x_step, square = patch->folds ? 0 : 0.5 * turn;
    const double place = step * g->x_step, place_first = first * g->x_step;
    for (int i = 0; i < wk->lines; i++) {
        double weight = patch->resampled ? weight_at(&wk->range_kernel, place_first + i * place, 0.5) : 1;
        before[i] = rotor((first + i * step) * g->x_first + square * i * i)
                    * (real)(weight * line_weight(wk, wk->kx_first + i * wk->kx_step));
    }
    for (int j = 0; j < g->x_count; j++)
        after[j] = rotor(square * j * j + first * g->x_step * j) * (real)(patch->folds ? step : step / length);
    if (patch->folds)
        return;
    patch->azimuth_forward = fft_line(&wk->store, length, wk->scratch, wk->scratch, FFTW_FORWARD);
    if (wk->store.failed)
        return;
    for (int i = -(wk->lines - 1); i < g->x_count; i++)
        kernel[i < 0 ? i + length : i] = rotor(-square * i * i);
    FFTW(execute_dft)(patch->azimuth_forward, kernel, kernel);
}

/* Values from one column of a strip to the next: an odd number of the cache's lines, so that they do not lie on top of
   each other in it. */
static size_t column_stride(const struct wk *wk)
{
    const size_t line = WK_ALIGNMENT / sizeof(complex_real);
    return (((size_t)wk->azimuth_length + line - 1) / line | 1) * line;
}

/* A thread's memory, in turn: a record and its transform; a strip of the azimuth transform; a line with its rows. */
static size_t scratch_size(const struct wk *wk)
{
    size_t complex_count = (size_t)wk->samples + (size_t)wk->range_length, strip = STRIP * column_stride(wk);
    size_t line = (size_t)wk->band + 2 * WK_GUARD + wk->rows * WK_TILE, most = 0;
    for (int k = 0; k < wk->patch_count; k++) {
        size_t length = (size_t)wk->patches[k].length, columns = (size_t)wk->patches[k].columns;
        most = length > most ? length : most;
        complex_count = columns > complex_count ? columns : complex_count;
    }
    line += most + 4 * WK_ALIGNMENT / sizeof(complex_real);
    complex_count = strip > complex_count ? strip : complex_count;
    complex_count = line > complex_count ? line : complex_count;
    return (complex_count * sizeof(complex_real) / WK_ALIGNMENT + 2) * WK_ALIGNMENT;
}

static void plan_patch(struct wk *wk, struct wk_patch *patch)
{
    if (patch->resampled) {
        patch->wide = store_take(&wk->store, grid_pixels(&patch->own), sizeof(complex_real), 1);
        real *taper = patch->taper = store_take(&wk->store, (size_t)patch->length, sizeof(real), 1);
        for (int k = 0; taper && k < patch->length; k++) {
            double place = (double)(k < patch->length / 2 ? k : k - patch->length) / patch->length;
            taper[k] = (real)weight_at(&wk->range_kernel, place, 0.5 / WK_OVERSAMPLING);
        }
    }
    patch->focus_plan = fft_line(&wk->store, patch->length, wk->scratch, wk->scratch, FFTW_BACKWARD);
    azimuth_fill(wk, patch);
}

static void plan_all(struct wk *wk)
{
    wk->data = store_take(&wk->store, (size_t)wk->azimuth_length * (size_t)wk->row + WK_GUARD, sizeof(complex_real), 1);
    wk->focused = store_take(&wk->store, wk->rows * wk->line_stride, sizeof(complex_real), 1);
    wk->scratch = store_take(&wk->store, (size_t)wk->threads, wk->scratch_bytes, 1.0 / wk->threads);
    weights_fill(wk);
    range_kernel_fill(wk);
    if (wk->angle != 0)
        azimuth_kernel_fill(wk);
    if (!wk->scratch)
        return;
    wk->range_forward = fft_line(&wk->store, wk->range_length, wk->scratch, wk->scratch, FFTW_FORWARD);
    wk->azimuth_forward = fft_line(&wk->store, wk->azimuth_length, wk->scratch, wk->scratch, FFTW_FORWARD);
    for (int k = 0; k < wk->patch_count; k++)
        plan_patch(wk, &wk->patches[k]);
}

static enum status plan_compression(struct wk *wk)
{
    const struct acquisition *a = wk->problem.acquisition;
    const struct traces_form form = {.upsample = 1};
    struct traces_shape shape;
    enum status status = STATUS_OK;
    if (!a->compressed) {
        status = REAL_NAME(traces).plan(a, &form, wk->threads, &shape, &wk->traces);
        if (status == STATUS_OK) {
            store_keep(&wk->store, wk->traces, REAL_NAME(traces).destroy);
            wk->work.bytes += shape.bytes;
            wk->work.flops += shape.flops * wk->pings;
        }
    }
    if (status != STATUS_OK || !wk->method.filters || !(a->area.half_x > 0))
        return status;
    struct polar_shape filter;
    const struct polar_setting setting = {wk->options.subapertures, wk->options.curvature, wk->options.band};
    status = REAL_NAME(polar_filter_plan)(a, &setting, wk->threads, &filter, &wk->filter);
    if (status != STATUS_OK)
        return status;
    store_keep(&wk->store, wk->filter, REAL_NAME(polar_filter_destroy));
    wk->work.bytes += filter.bytes;
    wk->work.flops += filter.flops;
    wk->compressed = store_take(&wk->store, (size_t)wk->pings * (size_t)wk->samples, sizeof(complex_real), 1);
    return STATUS_OK;
}

static enum status plan(struct wk *wk)
{
    wk->scratch_bytes = scratch_size(wk);
    double wide = 0;
    for (int k = 0; k < wk->patch_count; k++)
        wide += wk->patches[k].resampled ? (double)grid_pixels(&wk->patches[k].own) : 0;
    double bytes = ((double)wk->azimuth_length * wk->row + (double)wk->rows * (double)wk->line_stride + wide)
                       * sizeof(complex_real)
                   + (double)wk->threads * (double)wk->scratch_bytes;
    enum status status = memory_check(bytes, wk->method.name);
    if (status == STATUS_OK)
        status = plan_compression(wk);
    if (status == STATUS_OK)
        plan_all(wk);
    wk->work.bytes += wk->store.bytes;
    if (status == STATUS_OK && wk->store.failed)
        status = status_set(STATUS_FAILED, "no memory for %s (%.0f MB)", wk->method.name, bytes / 1e6);
    return status;
}

/* Records through the matched filter and the polar-format filter. */
static void compress(const struct wk *wk, const void *samples)
{
    const size_t count = (size_t)wk->samples;
    const complex_real *from = samples;
    complex_real *to = wk->compressed;
#pragma omp parallel for schedule(static) num_threads(wk->threads)
    for (int n = 0; n < wk->pings; n++) {
        if (wk->traces)
            REAL_NAME(traces).fill(wk->traces, omp_get_thread_num(), from + count * (size_t)n, to + count * (size_t)n);
        else
            memcpy(to + count * (size_t)n, from + count * (size_t)n, count * sizeof *to);
    }
    REAL_NAME(polar_filter_apply)(wk->filter, to);
}

static void range(const struct wk *wk, const void *samples)
{
#pragma omp parallel for schedule(static) num_threads(wk->threads)
    for (int n = 0; n < wk->pings; n++) {
        const size_t record = 2 * (size_t)wk->samples * (size_t)(wk->reversed ? wk->pings - 1 - n : n);
        const real *from = (const real *)samples + record;
        real *scratch = scratch_of(wk);
        if (wk->traces && !wk->filter) {
            REAL_NAME(traces).fill(wk->traces, omp_get_thread_num(), from, (complex_real *)scratch + wk->range_length);
            from = scratch + 2 * (size_t)wk->range_length;
        }
        wk->record_loop(wk, n, from, scratch);
    }
}

/* Prefetch the strip STRIP_AHEAD rows ahead, with `left` rows to come: rows lie too far apart for the processor's own
   prefetch. */
static inline void strip_fetch(const complex_real *strip, size_t row, int left)
{
    const char *ahead = (const char *)(strip + STRIP_AHEAD * row);
    if (left <= STRIP_AHEAD)
        return;
    __builtin_prefetch(ahead);
    __builtin_prefetch(ahead + WK_ALIGNMENT);
}

/* Azimuth FFT over the pings, in rows 0 to pings - 1, and the zeros between and after them. Column by column: FFTW's
   estimate is several times slower for columns side by side. */
static void azimuth(const struct wk *wk)
{
    const int strips = wk->row / STRIP;
    const size_t row = (size_t)wk->row, length = (size_t)wk->azimuth_length, pings = (size_t)wk->pings;
    const size_t behind = wk->stuffed == 1 ? pings - (size_t)wk->middle : 0; /* the first of the zeros */
    const size_t zeros = wk->stuffed == 1 ? length - pings : length, column = column_stride(wk);
#pragma omp parallel for schedule(static) num_threads(wk->threads)
    for (int s = 0; s < strips; s++) {
        complex_real *columns = (complex_real *)scratch_of(wk), *data = (complex_real *)wk->data + (size_t)s * STRIP;
        for (size_t j = 0; j < STRIP; j++)
            memset(columns + j * column + behind, 0, zeros * sizeof *columns);
        for (int n = 0; n < wk->pings; n++) {
            long long at = (long long)(n - wk->middle) * wk->stuffed;
            complex_real *to = columns + (at < 0 ? (size_t)(at + wk->azimuth_length) : (size_t)at);
            strip_fetch(data + (size_t)n * row, row, wk->pings - n);
            for (size_t j = 0; j < STRIP; j++)
                memcpy(to + j * column, data + (size_t)n * row + j, sizeof *to);
        }
        for (size_t j = 0; j < STRIP; j++)
            FFTW(execute_dft)(wk->azimuth_forward, columns + j * column, columns + j * column);
        for (size_t p = 0; p < length; p++) {
            strip_fetch(data + p * row, row, wk->azimuth_length - (int)p);
            for (size_t j = 0; j < STRIP; j++)
                memcpy(data + p * row + j, columns + j * column + p, sizeof *columns);
        }
    }
}

static void inverse(const struct wk *wk, const struct wk_patch *patch, void *pixels)
{
    const size_t columns = (size_t)patch->own.x_count;
#pragma omp parallel for schedule(static) num_threads(wk->threads)
    for (int i = 0; i < patch->own.r_count; i++)
        wk->row_loop(wk, patch, i, scratch_of(wk), (complex_real *)pixels + columns * (size_t)i);
}

/* `taps` weights of a kernel at a fraction of a step. */
static inline void kernel_at(const struct wk_kernel *kernel, double fraction, real *weight)
{
    const int width = wk_kernel_width(kernel->taps), i = (int)(fraction * WK_INTERVALS);
    const real *low = (const real *)kernel->values + (size_t)i * (size_t)width, *high = low + width;
    const real u = (real)(fraction * WK_INTERVALS - i);
    for (int t = 0; t < kernel->taps; t++)
        weight[t] = low[2 * t] + u * (high[2 * t] - low[2 * t]);
}

/* A pixel of the image at (u, w) columns and rows of the finer grid. */
static inline void resample_pixel(const struct wk *wk, const struct wk_patch *patch, double u, double w, real out[2])
{
    const int taps = wk->taps, column = (int)floor(u), row = (int)floor(w);
    const size_t stride = 2 * (size_t)patch->own.x_count;
    const real *from = (const real *)patch->wide + (size_t)(row + 1 - taps / 2) * stride + 2 * (column + 1 - taps / 2);
    real across[TAPS_MOST], along[TAPS_MOST];
    kernel_at(&wk->range_kernel, u - column, along);
    kernel_at(&wk->range_kernel, w - row, across);
    out[0] = out[1] = 0;
    for (int i = 0; i < taps; i++, from += stride) {
        real re = 0, im = 0;
        for (int j = 0; j < taps; j++) {
            re += along[j] * from[2 * j];
            im += along[j] * from[2 * j + 1];
        }
        out[0] += across[i] * re;
        out[1] += across[i] * im;
    }
}

static void resample(const struct wk *wk, const struct wk_patch *patch, void *pixels)
{
    const struct grid *g = &patch->grid, *own = &patch->own;
    const double cosine = cos(wk->angle), sine = sin(wk->angle);
    const double ky = (double)patch->bin_carrier / (patch->length * own->r_step), kx = patch->kx_carrier / (2 * M_PI);
#pragma omp parallel for schedule(static) num_threads(wk->threads)
    for (int i = 0; i < g->r_count; i++) {
        real *out = (real *)pixels + 2 * (size_t)g->x_count * (size_t)i;
        for (int j = 0; j < g->x_count; j++, out += 2) {
            struct vector p = grid_point(g, i, j);
            double x = (p.x - wk->x_middle) * cosine - p.y * sine, r = (p.x - wk->x_middle) * sine + p.y * cosine;
            real value[2];
            resample_pixel(wk, patch, (x - own->x_first) / own->x_step, (r - own->r_first) / own->r_step, value);
            complex_real turned = rotor(kx * x + ky * r);
            real root = (real)sqrt(p.y), re = (real)creal(turned) * root, im = (real)cimag(turned) * root;
            out[0] = value[0] * re - value[1] * im;
            out[1] = value[0] * im + value[1] * re;
        }
    }
}

const struct wk_transform REAL_NAME(wk_transform) = {plan, compress, range, azimuth, inverse, resample};
