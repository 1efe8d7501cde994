/* The transforms of range migration along range and azimuth, with their memory (rma_engine.h). Compiled once for each
   precision. */
#include <omp.h>
#include <string.h>

#include "common/clock.h"
#include "common/fft.h"
#include "common/kaiser.h"
#include "common/pulse_band.h"
#include "common/stream.h"
#include "range_migration/rma_engine.h"

enum {
    LANES = RMA_ALIGNMENT / sizeof(real),
    BLOCKS = 4, /* vectors of bins that are copied together for the azimuth FFT */
    AHEAD = 256 /* wavenumbers of a row that are prefetched */
};

static real *scratch_of(const struct rma *rma, enum rma_buffer buffer)
{
    char *scratch = (char *)rma->scratch + (size_t)omp_get_thread_num() * rma->scratch_bytes;
    return (real *)(scratch + rma->scratch_at[buffer]);
}

/* Transforms of this file work on the scratch's begin: from there, to as far behind it as `count` values need. */
static complex_real *behind(complex_real *memory, size_t count)
{
    return memory + (count + LANES - 1) / LANES * LANES;
}

static void *plan_line(struct rma *rma, int length, int sign)
{
    return fft_line(&rma->store, length, (complex_real *)scratch_of(rma, RMA_WAVE),
                    (complex_real *)scratch_of(rma, RMA_TRANSFORMED), sign);
}

/* The matched filter. */
static void filter_fill(struct rma *rma)
{
    complex_real *filter = rma->filter;
    double complex *made = pulse_filter(rma->problem.acquisition, rma->record_length);
    const int length = rma->inverse_length, below = length / 2, beyond = rma->record_length - length;
    for (int k = 0; made && k < length; k++) {
        const int shift = (int)((long long)k * rma->ahead % length);
        filter[k] = (complex_real)(made[k < length - below ? k : k + beyond] * cexp(-2 * M_PI * I * shift / length));
    }
    rma->store.failed = rma->store.failed || !made;
    fftw_free(made);
}

/* The Kaiser kernel of the Stolt interpolation. */
static void kernel_fill(const struct rma *rma)
{
    real *kernel = rma->kernel;
    int taps = rma->taps;
    for (int i = 0; i < RMA_INTERVALS + 2; i++)
        for (int k = 0; k < taps; k++)
            kernel[i * taps + k] = (real)kaiser_value(taps, rma->shape, (double)i / RMA_INTERVALS - (1 - taps / 2 + k));
}

/* The samples' factor that undoes the kernel's weight: 1 over its transform; constant where no row lies. */
static void apodization_fill(const struct rma *rma, const struct rma_swath *swath)
{
    real *apodization = swath->apodization;
    int taps = rma->taps, length = swath->stolt_length;
    for (int j = 0; j < length; j++) {
        double place = fmin(fabs((double)(j < length - length / 2 ? j : j - length) / length), 0.5 / RMA_OVERSAMPLING);
        double transform = rma->method.chirps ? 1 : kaiser_transform(taps, rma->shape, place);
        apodization[j] = (real)(1 / (transform * (rma->delay ? 1 : swath->length)));
    }
}

/* The azimuth sum onto a grid's columns, wavenumbers nu = (q - Q/2) dnu and columns x = x0 + j dx: one transform where
   1/(dnu dx) is its length, or a convolution (chirp z),  2 q j = q^2 + j^2 - (j - q)^2. */
static void azimuth_fill(struct rma *rma, const struct rma_swath *swath, struct rma_patch *patch)
{
    const int q_count = swath->wavenumbers, x_count = patch->grid.x_count, length = patch->columns;
    int *bins = store_take(&rma->store, swath->columns, sizeof *bins, 1);
    complex_real *after = store_take(&rma->store, (size_t)x_count, sizeof *after, 1);
    complex_real *kernel = patch->folds ? NULL : store_take(&rma->store, (size_t)length, sizeof *kernel, 1);
    complex_real *wave = rma->scratch, *turned = behind(wave, (size_t)length + 1);
    patch->bins = bins;
    patch->after = after;
    patch->kernel = kernel;
    patch->azimuth_inverse = fft_line(&rma->store, length, wave, turned, FFTW_BACKWARD);
    if (rma->store.failed)
        return;
    const double period = swath->period * fabs(rma->spacing),
                 turn = patch->folds ? 1.0 / length : patch->grid.x_step / period;
    const double square = patch->folds ? 0 : 0.5 * turn;
    patch->shift = (patch->grid.x_first - rma->x_first) / period;
    patch->square = square;
    for (int k = 0; k < (int)swath->columns; k++)
        bins[k] = k < q_count ? rma_wavenumber(rma, swath, k) % length : length;
    for (int j = 0; j < x_count; j++)
        after[j] = rotor(square * j * j - turn * (q_count / 2) * j) / (real)(patch->folds ? period : period * length);
    if (patch->folds)
        return;
    patch->azimuth_forward = fft_line(&rma->store, length, turned, wave, FFTW_FORWARD);
    if (rma->store.failed)
        return;
    memset(turned, 0, (size_t)length * sizeof *turned);
    for (int i = -(q_count - 1); i < x_count; i++)
        turned[i < 0 ? i + length : i] = rotor(-square * i * i);
    FFTW(execute_dft)(patch->azimuth_forward, turned, wave);
    memcpy(kernel, wave, (size_t)length * sizeof *wave);
}

static void plan_swath(struct rma *rma, struct rma_swath *swath)
{
    complex_real *lines = rma->scratch, *turned = behind(lines, BLOCKS * LANES * (size_t)swath->period);
    swath->data = store_take(&rma->store, (size_t)rma->receivers * swath->apart, sizeof(real), 1);
    swath->apodization = store_take(&rma->store, (size_t)swath->stolt_length, sizeof(real), 1);
    if (rma->delay)
        REAL_NAME(rma_map_plan)(rma, swath);
    if (rma->store.failed)
        return;
    apodization_fill(rma, swath);
    swath->range_forward = plan_line(rma, swath->length, FFTW_FORWARD);
    swath->range_inverse = plan_line(rma, swath->length, FFTW_BACKWARD);
    swath->stolt_forward = plan_line(rma, swath->stolt_length, FFTW_FORWARD);
    swath->azimuth_forward = fft_strip(&rma->store, swath->period, LANES, lines, turned, FFTW_FORWARD);
    for (int k = 0; k < swath->patch_count; k++) {
        swath->patches[k].focus_plan = plan_line(rma, swath->patches[k].length, FFTW_BACKWARD);
        if (rma->method.chirps)
            swath->patches[k].chirp_plan = plan_line(rma, swath->patches[k].length, FFTW_FORWARD);
        azimuth_fill(rma, swath, &swath->patches[k]);
    }
}

/* The parts shared by all swaths. */
static void tables_fill(struct rma *rma)
{
    real *tapers = rma->tapers, *basis = rma->delay ? rma->delay->basis : NULL;
    for (int k = 0; k < rma->taper; k++)
        tapers[k] = (real)pow(sin(M_PI / 2 * (k + 0.5) / rma->taper), 2);
    kernel_fill(rma);
    for (int k = 0; basis && k < rma->delay->terms.terms * rma->receivers; k++)
        basis[k] = (real)rma->delay->terms.basis[k];
    if (rma->record_length == 0)
        return;
    complex_real *record = (complex_real *)scratch_of(rma, RMA_RECORD),
                 *turned = (complex_real *)scratch_of(rma, RMA_TRANSFORMED);
    rma->record_forward = fft_line(&rma->store, rma->record_length, record, turned, FFTW_FORWARD);
    rma->record_inverse = fft_line(&rma->store, rma->inverse_length, turned, record, FFTW_BACKWARD);
    filter_fill(rma);
}

static enum status plan(struct rma *rma)
{
    size_t strip = 0, focused = 0, at_once = BLOCKS * LANES; /* scratch also serves the transforms of this file */
    for (const struct rma_swath *s = rma->swaths; s < rma->swaths + rma->swath_count; s++) {
        strip = strip > at_once * (size_t)s->period ? strip : at_once * (size_t)s->period;
        focused = focused > s->rows * s->columns ? focused : s->rows * s->columns;
        for (int k = 0; k < s->patch_count; k++)
            strip = strip > (size_t)s->patches[k].columns ? strip : (size_t)s->patches[k].columns;
    }
    strip = 2 * (strip + LANES) * sizeof(complex_real);
    if (rma->scratch_bytes < strip)
        rma->scratch_bytes = (strip / RMA_ALIGNMENT + 1) * RMA_ALIGNMENT;
    rma->scratch = store_take(&rma->store, (size_t)rma->threads, rma->scratch_bytes, 1.0 / rma->threads);
    rma->focused = store_take(&rma->store, focused, sizeof(complex_real), 1);
    rma->tapers = store_take(&rma->store, (size_t)rma->taper, sizeof(real), 1);
    rma->kernel = store_take(&rma->store, (RMA_INTERVALS + 2) * (size_t)rma->taps, sizeof(real), 1);
    rma->filter = store_take(&rma->store, (size_t)rma->inverse_length, sizeof(complex_real), 1);
    if (rma->delay)
        rma->delay->basis =
            store_take(&rma->store, (size_t)rma->delay->terms.terms * (size_t)rma->receivers, sizeof(real), 1);
    if (!rma->store.failed)
        tables_fill(rma);
    for (int n = 0; !rma->store.failed && n < rma->swath_count; n++)
        plan_swath(rma, &rma->swaths[n]);
    return !rma->store.failed ? STATUS_OK
                              : status_set(STATUS_FAILED, "no memory for range migration (%.0f MB for a thread)",
                                           rma->store.bytes / 1e6);
}

/* a[k] *= b[k], written out: a complex product would check for NaN. */
static inline void multiply(real *restrict a, const real *restrict b, int count)
{
    for (int k = 0; k < 2 * count; k += 2) {
        real re = a[k] * b[k] - a[k + 1] * b[k + 1];
        a[k + 1] = a[k] * b[k + 1] + a[k + 1] * b[k];
        a[k] = re;
    }
}

/* A swath's part of a compressed record, of which sample `from` is the first, as the spectrum's bins of the band. */
static void cut(const struct rma *rma, const struct rma_swath *swath, const real *record, real *row)
{
    const real *tapers = rma->tapers;
    const int length = swath->length, count = swath->end - swath->begin, lead = swath->begin - swath->first;
    real *wave = scratch_of(rma, RMA_WAVE), *taken = wave + 2 * lead, *bins = scratch_of(rma, RMA_TRANSFORMED);
    memset(wave, 0, 2 * (size_t)lead * sizeof *wave);
    if (count > 0)
        memcpy(taken, record + 2 * (swath->begin - rma->from), 2 * (size_t)count * sizeof *wave);
    memset(taken + 2 * count, 0, 2 * (size_t)(length - lead - count) * sizeof *wave);
    for (int k = 0; k < rma->taper && k < count; k++)
        for (int part = 0; part < 2; part++) {
            taken[2 * k + part] *= swath->begin > 0 || rma->early > 0 ? tapers[k] : 1;
            taken[2 * (count - 1 - k) + part] *= swath->end < rma->samples ? tapers[k] : 1;
        }
    FFTW(execute_dft)(swath->range_forward, (complex_real *)wave, (complex_real *)bins);
    const int below = -swath->band_first;
    memcpy(row, bins + 2 * (length - below), 2 * (size_t)below * sizeof *row);
    memcpy(row + 2 * below, bins, 2 * (size_t)(swath->band - below) * sizeof *row);
    memset(row + 2 * swath->band, 0, 2 * (size_t)(swath->row - swath->band) * sizeof *row);
}

/* Ping k of a receiver: pulse compression by a linear correlation, then each swath's cut. */
static void compress(const struct rma *rma, rma_map_function *map, const void *samples, int receiver, int k,
                     double seconds[RMA_SPREADS])
{
    const size_t all = 2 * (size_t)rma->problem.acquisition->samples, n = 2 * (size_t)rma->read,
                 length = 2 * (size_t)rma->record_length;
    const real *record = (const real *)samples + all * ((size_t)k * (size_t)rma->receivers + (size_t)receiver);
    const double begun = clock_monotonic();
    const size_t guard = rma->delay ? 2 * (size_t)rma->delay->guard : 0, held = 2 * (size_t)rma->held;
    real *padded = rma->delay ? scratch_of(rma, RMA_PADDED) : NULL;
    record += 2 * (size_t)rma->read_from;
    if (length > 0) {
        real *wave = scratch_of(rma, RMA_RECORD), *bins = scratch_of(rma, RMA_TRANSFORMED);
        memcpy(wave, record, n * sizeof *wave);
        memset(wave + n, 0, (length - n) * sizeof *wave);
        FFTW(execute_dft)(rma->record_forward, (complex_real *)wave, (complex_real *)bins);
        const size_t below = 2 * (size_t)(rma->inverse_length / 2), kept = 2 * (size_t)rma->inverse_length;
        if (kept < length)
            memmove(bins + kept - below, bins + length - below, below * sizeof *bins);
        multiply(bins, rma->filter, rma->inverse_length);
        wave = rma->delay ? padded + guard : wave;
        FFTW(execute_dft)(rma->record_inverse, (complex_real *)bins, (complex_real *)wave);
        record = wave;
    } else if (rma->delay)
        memcpy(padded + guard, record, held * sizeof *padded);
    for (int end = 0; rma->delay && end < 2; end++)
        memset(padded + (size_t)end * (guard + held), 0, guard * sizeof *padded);
    const real weight = (real)stretch_weight(&rma->stretch, k);
    const double compressed = clock_monotonic();
    for (const struct rma_swath *s = rma->swaths; s < rma->swaths + rma->swath_count; s++) {
        real *row = (real *)s->data + rma_row(s, receiver, k);
        if (rma->delay)
            map(rma, s, receiver, padded, row);
        else
            cut(rma, s, record, row);
        for (size_t i = 0; weight < 1 && i < 2 * (size_t)s->row; i++)
            row[i] *= weight;
    }
    seconds[RMA_COMPRESS] += compressed - begun;
    seconds[rma->delay ? RMA_MAP : RMA_COMPRESS] += clock_monotonic() - compressed;
}

/* A receiver's azimuth FFT over the pings and the zeros after them, in place, of some vectors of samples or bins: the
   complex numbers of a vector become its real parts and then its imaginary parts. */
static void spread(const struct rma *rma, const struct rma_swath *swath, int receiver, int strip,
                   double seconds[RMA_SPREADS])
{
    const double begun = clock_monotonic();
    const size_t row = 2 * (size_t)swath->row, pings = (size_t)rma->pings, period = (size_t)swath->period;
    const size_t first = (size_t)strip * BLOCKS, left = row / (2 * LANES) - first,
                 count = left < BLOCKS ? left : BLOCKS;
    complex_real *lines = (complex_real *)scratch_of(rma, 0), *turned = behind(lines, BLOCKS * LANES * period);
    real *data = (real *)swath->data + rma_row(swath, receiver, 0) + first * 2 * LANES;
    for (size_t p = 0; p < pings; p++)
        for (size_t v = 0; v < count; v++)
            memcpy(lines + (v * period + p) * LANES, data + p * row + v * 2 * LANES, LANES * sizeof *lines);
    for (size_t v = 0; v < count; v++) {
        memset(lines + (v * period + pings) * LANES, 0, (period - pings) * LANES * sizeof *lines);
        FFTW(execute_dft)(swath->azimuth_forward, lines + v * period * LANES, turned + v * period * LANES);
    }
    for (size_t p = 0; p < period; p++)
        for (size_t v = 0; v < count; v++) {
            const real *from = (const real *)(turned + (v * period + p) * LANES);
            real *to = data + p * row + v * 2 * LANES;
            for (size_t l = 0; l < LANES; l++) {
                to[l] = from[2 * l];
                to[LANES + l] = from[2 * l + 1];
            }
        }
    seconds[RMA_SPREAD] += clock_monotonic() - begun;
}

/* A receiver for each thread at a time, so that its records are still in the cache when they are transformed over the
   pings, and the tables of its map for all of them. */
static void receive(const struct rma *rma, rma_map_function *map, const void *samples, double seconds[RMA_SPREADS])
{
    memset(seconds, 0, RMA_SPREADS * sizeof *seconds);
#pragma omp parallel num_threads(rma->threads) reduction(+ : seconds[:RMA_SPREADS])
    for (int first = 0, end; first < rma->receivers; first = end) {
        end = rma->receivers - first < rma->threads ? rma->receivers : first + rma->threads;
#pragma omp for schedule(static) collapse(2)
        for (int m = first; m < end; m++)
            for (int k = 0; k < rma->pings; k++)
                compress(rma, map, samples, m, k, seconds);
        for (const struct rma_swath *s = rma->swaths; s < rma->swaths + rma->swath_count; s++) {
            const int strips = (s->row / LANES + BLOCKS - 1) / BLOCKS;
#pragma omp for schedule(static) collapse(2)
            for (int m = first; m < end; m++)
                for (int strip = 0; strip < strips; strip++)
                    spread(rma, s, m, strip, seconds);
        }
    }
}

static void inverse(const struct rma *rma, const struct rma_swath *swath, const struct rma_patch *patch, void *pixels)
{
    const size_t x_count = (size_t)patch->grid.x_count;
    const int length = patch->columns, *bins = patch->bins;
    const size_t columns = swath->columns;
    const bool streams = stream_pays((double)x_count * patch->grid.r_count * 2 * sizeof(real));
    typedef real one __attribute__((vector_size(2 * sizeof(real)), aligned(sizeof(real)), may_alias));
#pragma omp parallel for schedule(static) num_threads(rma->threads)
    for (int i = 0; i < patch->grid.r_count; i++) {
        real *wave = scratch_of(rma, 0), *turned = (real *)behind((complex_real *)wave, (size_t)length + 1);
        real *out = (real *)pixels + 2 * x_count * (size_t)i;
        real root = (real)sqrt(patch->grid.r_first + i * patch->grid.r_step);
        const real *from = (const real *)rma->focused + 2 * swath->columns * (patch->row + (size_t)i);
        memset(wave, 0, 2 * (size_t)length * sizeof *wave);
        for (size_t k = 0; k < columns; k += RMA_TILE) {
            __builtin_prefetch(from + 2 * (k + AHEAD));
            for (size_t n = k; n < k + RMA_TILE; n++)
                *(one *)(wave + 2 * bins[n]) += root * *(const one *)(from + 2 * n);
        }
        if (!patch->folds) {
            memcpy(turned, wave, 2 * (size_t)length * sizeof *wave);
            FFTW(execute_dft)(patch->azimuth_forward, (complex_real *)turned, (complex_real *)wave);
            multiply(wave, patch->kernel, length);
        }
        FFTW(execute_dft)(patch->azimuth_inverse, (complex_real *)wave, (complex_real *)turned);
        multiply(turned, patch->after, patch->grid.x_count);
        if (streams)
            stream_copy(out, turned, 2 * x_count * sizeof *out);
        else
            memcpy(out, turned, 2 * x_count * sizeof *out);
    }
}

const struct rma_transform REAL_NAME(rma_transform) = {plan, receive, inverse};
