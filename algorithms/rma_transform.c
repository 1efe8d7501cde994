/* The transforms of range migration along range and azimuth, with their memory (rma_engine.h). Compiled once for each
   precision. */
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "fft_length.h"
#include "real.h"
#include "rma_engine.h"

enum {
    LANES = RMA_ALIGNMENT / sizeof(real),
    BLOCKS = 4                      /* vectors of bins that go through the azimuth FFT together */
};
static const double pi = 3.14159265358979323846;

/* Zeroed memory on the plan's account; failure shows as NULL. */
static void *take(struct rma *rma, size_t count, size_t size, double share)
{
    size_t bytes = (count * size + RMA_ALIGNMENT - 1) / RMA_ALIGNMENT * RMA_ALIGNMENT;
    void *memory = aligned_alloc(RMA_ALIGNMENT, bytes ? bytes : RMA_ALIGNMENT);
    if (memory)
        memset(memory, 0, bytes);
    rma->work.bytes += share * (double)bytes;
    return memory;
}

static real *scratch_of(const struct rma *rma, enum rma_buffer buffer)
{
    char *scratch = (char *)rma->scratch + (size_t)omp_get_thread_num() * rma->scratch_bytes;
    return (real *)(scratch + rma->scratch_at[buffer]);
}

static complex_real rotor(double cycles)
{
    double angle = 2 * pi * (cycles - floor(cycles + 0.5));
    return (real)cos(angle) + (real)sin(angle) * (complex_real)I;
}

/* ESTIMATE: the same algorithm, hence the same bits, at every planning. */
static void *plan_line(int length, complex_real *memory, int sign)
{
    return FFTW(plan_dft_1d)(length, memory, memory, sign, FFTW_ESTIMATE);
}

/* conj(P)/sum|p|^2 on the band; 1 for compressed echoes. */
static void filter_fill(const struct rma *rma, double complex *work)
{
    const struct acquisition *a = rma->problem.acquisition;
    complex_real *filter = rma->filter;
    double energy = 0;
    for (int k = 0; k < a->pulse_length; k++) {
        work[k] = a->pulse[k];
        energy += creal(work[k]) * creal(work[k]) + cimag(work[k]) * cimag(work[k]);
    }
    fftw_plan forward = fftw_plan_dft_1d(rma->length, work, work, FFTW_FORWARD, FFTW_ESTIMATE);
    fftw_execute(forward);
    fftw_destroy_plan(forward);
    for (int k = 0; k < rma->band; k++)
        filter[k] = a->compressed ? 1
                    : (complex_real)(conj(work[(rma->band_first + k + rma->length) % rma->length]) / energy);
}

/* I0(x)/exp(x) by its power series: all terms are positive. */
static double bessel_i0(double x)
{
    double term = exp(-x), sum = term, y = x * x / 4;
    for (int k = 1; term > 1e-17 * sum; k++) {
        term *= y / ((double)k * k);
        sum += term;
    }
    return sum;
}

/* The Kaiser kernel of the Stolt interpolation, and what the samples are multiplied by beforehand so that it neither
   weights nor blurs them: 1 over its transform. */
static void kernel_fill(const struct rma *rma)
{
    real *kernel = rma->kernel, *apodization = rma->apodization;
    int taps = rma->taps, length = rma->length;
    double shape = rma->shape;
    for (int i = 0; taps && i < RMA_INTERVALS + 2; i++)
        for (int k = 0; k < taps; k++) {
            double z = 2 * ((double)i / RMA_INTERVALS - (1 - taps / 2 + k)) / taps, inside = sqrt(fmax(1 - z * z, 0));
            kernel[i * taps + k] = (real)(fabs(z) <= 1 ? bessel_i0(shape * inside) * exp(shape * (inside - 1)) : 0);
        }
    for (int j = 0; j < length; j++) {
        double place = fmin(fabs((double)(j < length - length / 2 ? j : j - length) / length), rma->widest);
        double x = sqrt(fmax(shape * shape - pi * pi * taps * taps * place * place, 1e-12));
        double transform = taps ? taps * exp(-shape) * sinh(x) / x : 1;
        apodization[j] = (real)(1 / (transform * length));
    }
}

/* The azimuth sum onto a grid's columns as a convolution (chirp z): for wavenumbers nu = (q - Q/2) dnu and columns
   x = x0 + j dx,  2 q j = q^2 + j^2 - (j - q)^2. */
static bool chirp_fill(struct rma *rma, struct rma_patch *patch)
{
    int q_count = rma->wavenumbers, x_count = patch->grid.x_count, length = patch->chirp;
    complex_real *before = take(rma, (size_t)q_count, sizeof *before, 1);
    complex_real *after = take(rma, (size_t)x_count, sizeof *after, 1);
    complex_real *kernel = take(rma, (size_t)length, sizeof *kernel, 1);
    patch->before = before;
    patch->after = after;
    patch->kernel = kernel;
    if (!before || !after || !kernel)
        return false;
    double period = rma->period * fabs(rma->spacing), turn = patch->grid.x_step / period;
    double from = (patch->grid.x_first - rma->x_first) / period;
    patch->chirp_forward = plan_line(length, kernel, FFTW_FORWARD);
    patch->chirp_inverse = plan_line(length, kernel, FFTW_BACKWARD);
    if (!patch->chirp_forward || !patch->chirp_inverse)
        return false;
    for (int q = 0; q < q_count; q++)
        before[q] = rotor((q - q_count / 2) * from + 0.5 * turn * q * q);
    for (int j = 0; j < x_count; j++)
        after[j] = rotor(0.5 * turn * j * j - turn * (q_count / 2) * j) / (real)(period * length);
    for (int i = -(q_count - 1); i < x_count; i++)
        kernel[i < 0 ? i + length : i] = rotor(-0.5 * turn * i * i);
    FFTW(execute_dft)(patch->chirp_forward, kernel, kernel);
    return true;
}

static enum status plan(struct rma *rma)
{
    size_t threads = (size_t)rma->threads, row = 2 * (size_t)rma->row, length = (size_t)rma->length;
    size_t strip = BLOCKS * LANES * (size_t)rma->period * sizeof(complex_real);
    for (int k = 0; k < rma->patch_count; k++)      /* scratch also serves the transforms of this file */
        strip = strip > (size_t)rma->patches[k].chirp * sizeof(complex_real) ? strip
                : (size_t)rma->patches[k].chirp * sizeof(complex_real);
    if (rma->scratch_bytes < strip)
        rma->scratch_bytes = (strip / RMA_ALIGNMENT + 1) * RMA_ALIGNMENT;
    rma->scratch = take(rma, threads, rma->scratch_bytes, 1.0 / rma->threads);
    rma->data = take(rma, (size_t)rma->period * (size_t)rma->receivers * row, sizeof(real), 1);
    rma->focused = take(rma, rma->rows * rma->columns, sizeof(complex_real), 1);
    rma->filter = take(rma, (size_t)rma->band, sizeof(complex_real), 1);
    rma->apodization = take(rma, length, sizeof(real), 1);
    rma->kernel = take(rma, (RMA_INTERVALS + 2) * (size_t)rma->taps, sizeof(real), 1);
    double complex *work = take(rma, length, sizeof *work, 0);
    bool complete = rma->scratch && rma->data && rma->focused && rma->filter && rma->apodization && rma->kernel
                    && work;
    if (complete) {
        complex_real *wave = (complex_real *)scratch_of(rma, RMA_WAVE), *lines = rma->scratch;
        filter_fill(rma, work);
        kernel_fill(rma);
        rma->range_forward = plan_line(rma->length, wave, FFTW_FORWARD);
        rma->range_inverse = plan_line(rma->length, wave, FFTW_BACKWARD);
        rma->azimuth_forward = FFTW(plan_many_dft)(1, &rma->period, BLOCKS * LANES, lines, NULL, BLOCKS * LANES, 1,
                                                   lines, NULL, BLOCKS * LANES, 1, FFTW_FORWARD, FFTW_ESTIMATE);
        complete = rma->range_forward && rma->range_inverse && rma->azimuth_forward;
        for (int k = 0; complete && k < rma->patch_count; k++) {
            struct rma_patch *patch = &rma->patches[k];
            patch->focus_plan = plan_line(patch->length, wave, FFTW_BACKWARD);
            complete = patch->focus_plan && chirp_fill(rma, patch);
        }
    }
    free(work);
    return complete ? STATUS_OK : status_set(STATUS_FAILED, "no memory for range migration (%.0f MB for a thread)",
                                             rma->work.bytes / 1e6);
}

static void plan_destroy(void *made)
{
    if (made)
        FFTW(destroy_plan)(made);
}

static void destroy(struct rma *rma)
{
    plan_destroy(rma->range_forward);
    plan_destroy(rma->range_inverse);
    plan_destroy(rma->azimuth_forward);
    for (int k = 0; k < rma->patch_count; k++) {
        struct rma_patch *patch = &rma->patches[k];
        plan_destroy(patch->focus_plan);
        plan_destroy(patch->chirp_forward);
        plan_destroy(patch->chirp_inverse);
        free(patch->before);
        free(patch->kernel);
        free(patch->after);
    }
    free(rma->scratch);
    free(rma->data);
    free(rma->focused);
    free(rma->filter);
    free(rma->apodization);
    free(rma->kernel);
}

/* Records [pings][receivers][samples] into the spectra of their band, times the filter: rows [pings][receivers],
   complex. */
static void compress(const struct rma *rma, const void *samples)
{
    const int records = rma->pings * rma->receivers, length = rma->length;
    const size_t n = (size_t)rma->samples;
    const real *filter = rma->filter;
#pragma omp parallel for schedule(static) num_threads(rma->threads)
    for (int k = 0; k < records; k++) {
        real *wave = scratch_of(rma, RMA_WAVE), *row = (real *)rma->data + (size_t)k * 2 * (size_t)rma->row;
        memcpy(wave, (const real *)samples + 2 * n * (size_t)k, 2 * n * sizeof *wave);
        memset(wave + 2 * n, 0, 2 * ((size_t)length - n) * sizeof *wave);
        FFTW(execute_dft)(rma->range_forward, (complex_real *)wave, (complex_real *)wave);
        int bin = rma->band_first < 0 ? rma->band_first + length : rma->band_first;
        for (int i = 0; i < rma->band; i++) {
            real re = wave[2 * bin], im = wave[2 * bin + 1];
            row[2 * i] = re * filter[2 * i] - im * filter[2 * i + 1];
            row[2 * i + 1] = re * filter[2 * i + 1] + im * filter[2 * i];
            if (++bin == length)
                bin = 0;
        }
        memset(row + 2 * rma->band, 0, 2 * (size_t)(rma->row - rma->band) * sizeof *row);
    }
}

/* Azimuth FFT over the pings and the zeros after them, in place; the complex numbers of a vector become its real
   parts and then its imaginary parts. */
static void spread(const struct rma *rma)
{
    const int vectors = rma->row / LANES, strips = (vectors + BLOCKS - 1) / BLOCKS;
    const size_t row = 2 * (size_t)rma->row;
#pragma omp parallel for schedule(static) collapse(2) num_threads(rma->threads)
    for (int m = 0; m < rma->receivers; m++)
        for (int s = 0; s < strips; s++) {
            const size_t width = 2 * LANES * (size_t)(vectors - s * BLOCKS < BLOCKS ? vectors - s * BLOCKS : BLOCKS);
            real *lines = scratch_of(rma, 0);
            real *data = (real *)rma->data + (size_t)m * row + (size_t)s * BLOCKS * 2 * LANES;
            const size_t ping = (size_t)rma->receivers * row, line = 2 * BLOCKS * LANES, pings = (size_t)rma->pings;
            for (size_t p = 0; p < pings; p++)
                memcpy(lines + p * line, data + p * ping, width * sizeof *lines);
            memset(lines + pings * line, 0, ((size_t)rma->period - pings) * line * sizeof *lines);
            FFTW(execute_dft)(rma->azimuth_forward, (complex_real *)lines, (complex_real *)lines);
            for (size_t p = 0; p < (size_t)rma->period; p++)
                for (size_t b = 0; b < width; b += 2 * LANES)
                    for (size_t l = 0; l < LANES; l++) {
                        data[p * ping + b + l] = lines[p * line + b + 2 * l];
                        data[p * ping + b + LANES + l] = lines[p * line + b + 2 * l + 1];
                    }
        }
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

static void inverse(const struct rma *rma, int index, void *pixels)
{
    const struct rma_patch *patch = &rma->patches[index];
    const size_t q = (size_t)rma->wavenumbers, columns = (size_t)patch->grid.x_count;
#pragma omp parallel for schedule(static) num_threads(rma->threads)
    for (int i = 0; i < patch->grid.r_count; i++) {
        real *wave = scratch_of(rma, 0);
        real *out = (real *)pixels + 2 * columns * (size_t)i;
        real root = (real)sqrt(patch->grid.r_first + i * patch->grid.r_step);
        memcpy(wave, (const real *)rma->focused + 2 * rma->columns * (patch->row + (size_t)i), 2 * q * sizeof *wave);
        multiply(wave, patch->before, rma->wavenumbers);
        memset(wave + 2 * q, 0, 2 * ((size_t)patch->chirp - q) * sizeof *wave);
        FFTW(execute_dft)(patch->chirp_forward, (complex_real *)wave, (complex_real *)wave);
        multiply(wave, patch->kernel, patch->chirp);
        FFTW(execute_dft)(patch->chirp_inverse, (complex_real *)wave, (complex_real *)wave);
        multiply(wave, patch->after, patch->grid.x_count);
        for (size_t k = 0; k < 2 * columns; k++)
            out[k] = wave[k] * root;
    }
}

const struct rma_transform REAL_NAME(rma_transform) = {plan, destroy, compress, spread, inverse};
