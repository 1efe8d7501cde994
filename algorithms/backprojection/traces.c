/* Range compression and exact upsampling of single records (traces.h). Cost: an FFT of L and one of L upsample. */
#include "backprojection/traces.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/fft_length.h"
#include "common/memory.h"
#include "common/real.h"

struct traces {
    struct traces_shape shape;
    int transform;               /* L: period of the transformed signal, >= samples + pulse - 1 */
    bool transforms;             /* false: compressed already and not upsampled */
    FFTW(plan) forward, inverse; /* of L, and of L upsample */
    complex_real *filter;        /* [L] conj(P)/(L sum|p|^2); 1/L if compressed */
    complex_real *scratch;       /* [threads][L + L upsample] */
    size_t scratch_length;       /* L + L upsample */
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

enum status REAL_NAME(traces_plan)(const struct acquisition *acquisition, int upsample, int guard, int threads,
                                   struct traces_shape *shape, struct traces **out)
{
    *out = NULL;
    int n = acquisition->samples;
    int length = acquisition->compressed ? n : fft_length((long long)n + acquisition->pulse_length - 1);
    long long fine = (long long)length * upsample, row = (long long)(n - 1) * upsample + 1 + 2LL * guard;
    if (length == 0 || fine > INT_MAX / 4 || row > INT_MAX / 4)
        return status_set(STATUS_UNSUPPORTED,
                          "records of %d samples upsampled by %d are too long to transform "
                          "(at most %d values)",
                          n, upsample, INT_MAX / 4);
    struct traces *traces = calloc(1, sizeof *traces);
    if (!traces)
        return status_set(STATUS_FAILED, "no memory for range compression");
    traces->shape = (struct traces_shape){
        .samples = n, .upsample = upsample, .guard = guard, .length = (int)row, .bytes = sizeof *traces};
    traces->transform = length;
    traces->transforms = !acquisition->compressed || upsample > 1;
    if (traces->transforms) {
        traces->scratch_length = (size_t)(length + fine);
        /* Scratch, filter, the pulse's spectrum, and as much as FFTW's plans may hold. */
        enum status status =
            memory_check(((threads + 1.0) * (double)traces->scratch_length + length) * sizeof(complex_real)
                             + (double)length * sizeof(double complex),
                         "range compression");
        if (status != STATUS_OK) {
            free(traces);
            return status;
        }
        traces->scratch = FFTW(malloc)((size_t)threads * traces->scratch_length * sizeof *traces->scratch);
        traces->filter = FFTW(malloc)((size_t)length * sizeof *traces->filter);
        double complex *work = fftw_malloc((size_t)length * sizeof *work);
        if (traces->scratch && traces->filter && work) {
            if (acquisition->compressed)
                for (int k = 0; k < length; k++)
                    traces->filter[k] = (real)1 / (real)length;
            else
                filter_fill(acquisition, length, work, traces->filter);
            /* ESTIMATE: the same algorithm, hence the same bits, at every planning; measuring costs more than a scene's
               compression. */
            complex_real *a = traces->scratch, *b = upsample > 1 ? a + length : a;
            traces->forward = FFTW(plan_dft_1d)(length, a, a, FFTW_FORWARD, FFTW_ESTIMATE | FFTW_UNALIGNED);
            traces->inverse = FFTW(plan_dft_1d)((int)fine, b, b, FFTW_BACKWARD, FFTW_ESTIMATE | FFTW_UNALIGNED);
        }
        fftw_free(work);
        if (!traces->forward || !traces->inverse) {
            double bytes = (double)threads * (double)traces->scratch_length * sizeof(complex_real);
            REAL_NAME(traces_destroy)(traces);
            return status_set(STATUS_FAILED, "no memory for range compression (%.0f MB)", bytes / 1e6);
        }
        traces->shape.flops = fft_flops(length) + fft_flops((double)fine) + 6.0 * length;
        traces->shape.bytes += (double)(traces->scratch_length + (size_t)length) * sizeof(complex_real);
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

void REAL_NAME(traces_fill)(const struct traces *traces, int thread, const complex_real *record, complex_real *row)
{
    const struct traces_shape *shape = &traces->shape;
    size_t n = (size_t)shape->samples, guard = (size_t)shape->guard, length = (size_t)traces->transform;
    const complex_real *source = record;
    size_t fine = length * (size_t)shape->upsample;
    if (traces->transforms) {
        complex_real *a = traces->scratch + (size_t)thread * traces->scratch_length;
        complex_real *b = shape->upsample > 1 ? a + length : a;
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
        if (shape->upsample > 1)
            spectrum_pad(a, (int)length, b, fine);
        FFTW(execute_dft)(traces->inverse, b, b);
        source = b;
    }
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

void REAL_NAME(traces_destroy)(struct traces *traces)
{
    if (!traces)
        return;
    if (traces->forward)
        FFTW(destroy_plan)(traces->forward);
    if (traces->inverse)
        FFTW(destroy_plan)(traces->inverse);
    FFTW(free)(traces->filter);
    FFTW(free)(traces->scratch);
    free(traces);
}
