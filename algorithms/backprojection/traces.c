/* Range compression and exact upsampling of single records (traces.h). Cost: an FFT of L and one of L upsample for each
   branch. */
#include "backprojection/traces.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/farrow.h"
#include "common/fft_length.h"
#include "common/memory.h"
#include "common/real.h"

struct traces {
    struct traces_shape shape;
    int transform;                 /* L: period of the transformed signal, >= samples + pulse - 1 */
    bool transforms;               /* false: compressed already and not upsampled */
    FFTW(plan) forward, inverse;   /* of L, and of L upsample */
    complex_real *filter;          /* [L] conj(P)/(L sum|p|^2); 1/L if compressed */
    real *gains;                   /* [branches][L/2 + 1] of frequencies 0 to fs/2 (farrow.h); NULL without branches */
    complex_real *scratch;         /* [threads][scratch_length], of L and of L upsample values */
    size_t scratch_length, second; /* where the latter begin: both at cache lines, as FFTW's plans expect */
};

static void filter_fill(const struct acquisition *acquisition, int length, double complex *work, complex_real *filter)
{
    double energy = 0;
    memset(work, 0, (size_t)length * sizeof *work);
    for (int k = 0; k < acquisition->pulse_length; k++) {
        work[k] = acquisition->pulse[k];
        energy += creal(work[k]) * creal(work[k]) + cimag(work[k]) * cimag(work[k]);
    }
    fftw_plan plan = fftw_plan_dft_1d(length, work, work, FFTW_FORWARD, FFTW_ESTIMATE);
    fftw_execute(plan);
    fftw_destroy_plan(plan);
    for (int k = 0; k < length; k++)
        filter[k] = (complex_real)(conj(work[k]) / (energy * length));
}

static void gains_fill(const struct traces *traces)
{
    const int length = traces->transform, branches = traces->shape.branches;
    double gains[FARROW_MOST + 1];
    for (int k = 0; k <= length / 2; k++) {
        farrow_gains(branches - 1, (double)k / length / traces->shape.upsample, gains);
        for (int m = 0; m < branches; m++)
            traces->gains[m * (length / 2 + 1) + k] = (real)gains[m];
    }
}

/* Complex values rounded up to whole cache lines. */
static size_t whole_lines(int count)
{
    const size_t line = 64 / sizeof(complex_real);
    return ((size_t)count + line - 1) / line * line;
}

/* Filter, gains, scratch and FFTW's plans, and what they count in the shape. */
static enum status transforms_plan(struct traces *traces, const struct acquisition *acquisition, int threads)
{
    struct traces_shape *shape = &traces->shape;
    const int length = traces->transform, branches = shape->branches, fine = length * shape->upsample;
    const size_t gains = branches > 1 ? (size_t)branches * ((size_t)length / 2 + 1) : 0;
    traces->second = whole_lines(length);
    traces->scratch_length = traces->second + whole_lines(fine);
    /* Scratch, filter, the pulse's spectrum, and as much as FFTW's plans may hold. */
    enum status status = memory_check(((threads + 1.0) * (double)traces->scratch_length + length) * sizeof(complex_real)
                                          + (double)length * sizeof(double complex) + (double)gains * sizeof(real),
                                      "range compression");
    if (status != STATUS_OK)
        return status;
    traces->scratch = FFTW(malloc)((size_t)threads * traces->scratch_length * sizeof *traces->scratch);
    traces->filter = FFTW(malloc)((size_t)length * sizeof *traces->filter);
    traces->gains = gains > 0 ? FFTW(malloc)(gains * sizeof *traces->gains) : NULL;
    double complex *work = fftw_malloc((size_t)length * sizeof *work);
    if (traces->scratch && traces->filter && work && (traces->gains || gains == 0)) {
        if (acquisition->compressed)
            for (int k = 0; k < length; k++)
                traces->filter[k] = (real)1 / (real)length;
        else
            filter_fill(acquisition, length, work, traces->filter);
        if (gains > 0)
            gains_fill(traces);
        /* ESTIMATE: the same algorithm, hence the same bits, at every planning; measuring costs more than a scene's
           compression. */
        complex_real *a = traces->scratch, *b = a + traces->second;
        traces->forward = FFTW(plan_dft_1d)(length, a, a, FFTW_FORWARD, FFTW_ESTIMATE);
        traces->inverse = FFTW(plan_dft_1d)(fine, b, b, FFTW_BACKWARD, FFTW_ESTIMATE);
    }
    fftw_free(work);
    if (!traces->forward || !traces->inverse)
        return status_set(STATUS_FAILED, "no memory for range compression (%.0f MB)",
                          (double)threads * (double)traces->scratch_length * sizeof(complex_real) / 1e6);
    shape->flops = fft_flops(length) + branches * fft_flops(fine) + 6.0 * length;
    shape->flops += gains > 0 ? 2.0 * branches * length : 0;
    shape->bytes += (double)(traces->scratch_length + (size_t)length) * sizeof(complex_real);
    shape->bytes += (double)gains * sizeof(real);
    return STATUS_OK;
}

enum status REAL_NAME(traces_plan)(const struct acquisition *acquisition, int upsample, int degree, int guard,
                                   int threads, struct traces_shape *shape, struct traces **out)
{
    *out = NULL;
    int n = acquisition->samples;
    int length = acquisition->compressed ? n : fft_length_fast((long long)n + acquisition->pulse_length - 1);
    long long fine = (long long)length * upsample, row = (long long)(n - 1) * upsample + 1 + 2LL * guard;
    if (length == 0 || fine * (degree + 1) > INT_MAX / 4 || row * (degree + 1) > INT_MAX / 4)
        return status_set(STATUS_UNSUPPORTED,
                          "records of %d samples upsampled by %d are too long to transform "
                          "(at most %d values)",
                          n, upsample, INT_MAX / 4 / (degree + 1));
    struct traces *traces = calloc(1, sizeof *traces);
    if (!traces)
        return status_set(STATUS_FAILED, "no memory for range compression");
    traces->shape = (struct traces_shape){.samples = n,
                                          .upsample = upsample,
                                          .guard = guard,
                                          .branches = degree + 1,
                                          .length = (int)row,
                                          .bytes = sizeof *traces};
    traces->transform = length;
    traces->transforms = !acquisition->compressed || upsample > 1 || degree > 0;
    enum status status = traces->transforms ? transforms_plan(traces, acquisition, threads) : STATUS_OK;
    if (status != STATUS_OK) {
        REAL_NAME(traces_destroy)(traces);
        return status;
    }
    *shape = traces->shape;
    *out = traces;
    return STATUS_OK;
}

/* Place the L bins of `from` into the L upsample bins of `to`. */
static void spectrum_pad(const complex_real *from, int length, complex_real *to, size_t fine)
{
    int positive = (length + 1) / 2; /* bins 0 .. positive - 1; a bin at fs/2 stands apart */
    int negative = length / 2 - (length % 2 == 0);
    memcpy(to, from, (size_t)positive * sizeof *to);
    memset(to + positive, 0, (fine - (size_t)positive) * sizeof *to);
    memcpy(to + fine - negative, from + length - negative, (size_t)negative * sizeof *to);
    if (length % 2 == 0) {
        to[length / 2] = from[length / 2] / 2;
        to[fine - (size_t)length / 2] += from[length / 2] / 2;
    }
}

/* The spectrum of one branch, of L upsample bins: the L bins of `from` times gains, and times j where `odd`. */
static void spectrum_branch(const complex_real *from, int length, const real *gains, bool odd, complex_real *to,
                            size_t fine)
{
    const real *x = (const real *)from;
    real *y = (real *)to;
    const int re = odd, im = !odd; /* j (a + j b) = -b + j a */
    const real sign = odd ? -1 : 1;
    memset(to, 0, fine * sizeof *to);
    for (int k = 0; 2 * k < length; k++) {
        y[2 * k + re] = gains[k] * x[2 * k];
        y[2 * k + im] = sign * gains[k] * x[2 * k + 1];
    }
    real *end = y + 2 * fine;
    for (int k = 1; 2 * k < length; k++) { /* gains of odd branches are odd */
        end[-2 * k + re] = sign * gains[k] * x[2 * (length - k)];
        end[-2 * k + im] = gains[k] * x[2 * (length - k) + 1];
    }
    if (length % 2 == 0) { /* the bin at fs/2: half at either end of the band, which is one bin without upsampling */
        const real a = gains[length / 2] * x[length] / 2, b = sign * gains[length / 2] * x[length + 1] / 2;
        real *positive = y + length, *negative = end - length;
        positive[re] += a;
        positive[im] += b;
        negative[re] += sign * a;
        negative[im] += sign * b;
    }
}

/* One period of a signal into a row's branch. */
static void row_fill(const struct traces_shape *shape, const complex_real *source, size_t fine, complex_real *row)
{
    const size_t n = (size_t)shape->samples, guard = (size_t)shape->guard;
    if (shape->upsample == 1) {
        memset(row, 0, guard * sizeof *row);
        memcpy(row + guard, source, n * sizeof *row);
        memset(row + guard + n, 0, guard * sizeof *row);
        return;
    }
    size_t start = (fine - guard % fine) % fine;
    for (size_t i = 0; i < (size_t)shape->length; i++) {
        row[i] = source[start];
        if (++start == fine)
            start = 0;
    }
}

void REAL_NAME(traces_fill)(const struct traces *traces, int thread, const complex_real *record, complex_real *row)
{
    const struct traces_shape *shape = &traces->shape;
    size_t n = (size_t)shape->samples, length = (size_t)traces->transform;
    const complex_real *source = record;
    size_t fine = length * (size_t)shape->upsample;
    if (traces->transforms) {
        complex_real *a = traces->scratch + (size_t)thread * traces->scratch_length, *b = a + traces->second;
        memcpy(a, record, n * sizeof *a);
        memset(a + n, 0, (length - n) * sizeof *a);
        FFTW(execute_dft)(traces->forward, a, a);
        real *x = (real *)a;
        const real *h = (const real *)traces->filter;
        for (size_t k = 0; k < 2 * length; k += 2) { /* written out: a complex product would check for NaN */
            real re = x[k] * h[k] - x[k + 1] * h[k + 1];
            x[k + 1] = x[k] * h[k + 1] + x[k + 1] * h[k];
            x[k] = re;
        }
        for (int m = 0; traces->gains && m < shape->branches; m++, row += shape->length) {
            const real *gains = traces->gains + (size_t)m * (length / 2 + 1);
            spectrum_branch(a, (int)length, gains, m % 2 != 0, b, fine);
            FFTW(execute_dft)(traces->inverse, b, b);
            row_fill(shape, b, fine, row);
        }
        if (traces->gains)
            return;
        if (shape->upsample > 1)
            spectrum_pad(a, (int)length, b, fine);
        else
            b = a;
        FFTW(execute_dft)(traces->inverse, b, b);
        source = b;
    }
    row_fill(shape, source, fine, row);
}

void REAL_NAME(traces_destroy)(struct traces *traces)
{
    if (!traces)
        return;
    if (traces->forward)
        FFTW(destroy_plan)(traces->forward);
    if (traces->inverse)
        FFTW(destroy_plan)(traces->inverse);
    FFTW(free)(traces->filter);
    FFTW(free)(traces->gains);
    FFTW(free)(traces->scratch);
    free(traces);
}
