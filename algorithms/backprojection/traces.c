/* Range compression and exact upsampling of single records (traces.h). Cost: an FFT of L, and one for each phase (of
   the first two branches each): as many operations as one of L upsample, less those on zeros, and all in the nearest
   cache. */
#include "backprojection/traces.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/farrow.h"
#include "backprojection/planes.h"
#include "common/bessel.h"
#include "common/fft.h"
#include "common/fft_length.h"
#include "common/pulse_band.h"

/* What a row is made of. */
struct stretch {
    int from, read; /* of the record (struct traces_shape) */
    int length;     /* of the transform; 0: too long */
    int fade;       /* of the samples read, at either end */
};

/* A Kaiser window down to 1e-15: its parameter, and its length times where its spectrum ends, in cycles. */
static const double FADE_SHAPE = 32.1, FADE_EDGE = 10.3;

struct traces {
    struct traces_shape shape;
    int samples, fade;           /* of a record; those of what is read, at either end, that fade */
    real *fading;                /* [fade] */
    bool transforms;             /* false: compressed already, and read as it is */
    FFTW(plan) forward, inverse; /* of L = shape.period, into another array: in place takes 1.2 times as long */
    complex_real *filter;        /* [L] conj(P)/(L sum|p|^2); 1/L if compressed; over sinc^2 where it is emphasised */
    complex_real *factors;       /* [branches][upsample][L/2 + 1] of frequencies 0 to fs/2, where upsample > 1 */
    /* [branches][L] where branches > 1 and upsample = 1: real gains, of odd branches times the imaginary unit. Neither
       factors nor gains: of one plane, all are 1. */
    real *gains;
    const struct planes *planes;
    struct farrow_taps *taps; /* of branches from 2 on, where there are some */
    /* Of each thread: [2 + upsample][shape.pitch], input of the transform, a spectrum, a branch; and where branches > 1
       [2][wide], the first two with neighbours, in order. */
    complex_real *scratch;
    size_t wide, each; /* complex values: of a branch with neighbours; of a thread, whole cache lines */
    struct store store;
};

/* Branches that are transformed; they make the others (farrow.h). */
static int transformed(int branches)
{
    return branches < 2 ? branches : 2;
}

/* False without memory. */
static bool filter_fill(const struct acquisition *acquisition, int length, complex_real *filter)
{
    double complex *made = acquisition->compressed ? NULL : pulse_filter(acquisition, length);
    for (int k = 0; k < length; k++)
        filter[k] = made ? (complex_real)made[k] : (real)1 / (real)length;
    fftw_free(made);
    return made || acquisition->compressed;
}

/* Linear interpolation between samples multiplies by sinc^2(nu) at nu cycles a sample. */
static void emphasise(int length, complex_real *filter)
{
    for (int k = 1; k < length; k++) {
        const double x = M_PI * (2 * k > length ? k - length : k) / length, sinc = sin(x) / x;
        filter[k] /= (real)(sinc * sinc);
    }
}

/* Branch m at phase j of K is the signal of the spectrum times H_m(nu) exp(j 2 pi nu j/K), of which the factors of -nu
   are the conjugates of those of nu. H_m is real for even m, imaginary for odd ones. */
static void factors_fill(const struct traces *traces)
{
    const int length = traces->shape.period, upsample = traces->shape.upsample, degree = traces->shape.branches - 1;
    const size_t half = (size_t)length / 2 + 1;
    double gains[FARROW_MOST + 1] = {1};
    for (size_t k = 0; k < half; k++) {
        if (degree > 0)
            farrow_gains(degree, (double)k / length / upsample, gains);
        for (int m = 0; m < transformed(degree + 1); m++) {
            if (traces->gains) {
                real *of = traces->gains + (size_t)m * (size_t)length;
                if (k > 0)
                    of[(size_t)length - k] = (real)(m % 2 ? -gains[m] : gains[m]);
                /* the bin at fs/2: half of it at either end of the band */
                of[k] = m % 2 && 2 * k == (size_t)length ? 0 : (real)gains[m];
            }
            for (int j = 0; traces->factors && j < upsample; j++) {
                const double turn = 2 * M_PI * (double)k * j / ((double)length * upsample);
                const double complex factor = gains[m] * (cos(turn) + I * sin(turn)) * (m % 2 ? I : 1);
                traces->factors[((size_t)m * (size_t)upsample + (size_t)j) * half + k] = (complex_real)factor;
            }
        }
    }
}

/* Complex values rounded up to whole cache lines. */
static size_t whole_lines(int count)
{
    const size_t line = 64 / sizeof(complex_real);
    return ((size_t)count + line - 1) / line * line;
}

static int reach_of(int degree, int upsample)
{
    return farrow_reach(degree, upsample, REAL_DOUBLE ? PRECISION_DOUBLE : PRECISION_FLOAT);
}

/* Values of a branch that are made by convolution: by sixteens, the last of them in the guard. */
static int convolved(const struct traces_shape *shape)
{
    const int count = shape->length - 2 * shape->guard;
    return shape->guard < 15 ? count : (count + 15) / 16 * 16;
}

/* False without memory. */
static bool fading_fill(struct traces *traces)
{
    const int count = traces->fade;
    double sum = 0, all = 0;
    traces->fading = store_room(&traces->store, (size_t)count, sizeof *traces->fading, 1);
    for (int pass = 0; traces->fading && pass < 2; pass++, all = sum, sum = 0)
        for (int k = 0; k <= count; k++) {
            const double place = 2.0 * k / count - 1;
            sum += bessel_i0(FADE_SHAPE * sqrt(1 - place * place));
            if (pass > 0 && k < count)
                traces->fading[k] = (real)(sum / all);
        }
    return traces->fading;
}

/* Filter, factors, scratch and FFTW's plans, and their counts in the shape. */
static enum status transforms_plan(struct traces *traces, const struct acquisition *acquisition, bool preemphasis,
                                   int threads)
{
    struct traces_shape *shape = &traces->shape;
    const int length = shape->period, planes = transformed(shape->branches) * shape->upsample;
    const size_t pitch = whole_lines(length);
    const size_t factors = shape->upsample > 1 ? (size_t)planes * ((size_t)length / 2 + 1) : 0;
    const size_t gains = shape->upsample == 1 && planes > 1 ? (size_t)planes * (size_t)length : 0;
    shape->pitch = pitch;
    if (shape->branches > 1) {
        const int reach = reach_of(shape->branches - 1, shape->upsample);
        traces->wide = whole_lines(convolved(shape) + 2 * reach);
        traces->taps = store_room(&traces->store, 1, sizeof *traces->taps, 1);
        if (traces->taps)
            farrow_taps_make(shape->branches - 1, shape->upsample, fmin(1, acquisition->bandwidth / acquisition->fs),
                             reach, traces->taps);
    }
    traces->each = (2 + (size_t)shape->upsample) * pitch + 2 * traces->wide;
    /* Scratch, filter, factors, the pulse's spectrum, and an upper limit for FFTW's plans. */
    enum status status =
        memory_check(((threads + 1.0) * (double)traces->each + length + (double)factors) * sizeof(complex_real)
                         + (double)gains * sizeof(real) + (double)length * sizeof(double complex),
                     "range compression");
    if (status != STATUS_OK)
        return status;
    struct store *store = &traces->store;
    complex_real *a = traces->scratch = store_room(store, (size_t)threads * traces->each, sizeof *a, 1.0 / threads);
    traces->filter = store_room(store, (size_t)length, sizeof *traces->filter, 1);
    traces->factors = factors > 0 ? store_room(store, factors, sizeof *traces->factors, 1) : NULL;
    traces->gains = gains > 0 ? store_room(store, gains, sizeof *traces->gains, 1) : NULL;
    if (!store->failed && filter_fill(acquisition, length, traces->filter)) {
        if (preemphasis)
            emphasise(length, traces->filter);
        if (planes > 1)
            factors_fill(traces);
        traces->forward = fft_line(store, length, a, a + pitch, FFTW_FORWARD);
        traces->inverse = fft_line(store, length, a, a + pitch, FFTW_BACKWARD);
    }
    const bool faded = traces->fade == 0 || fading_fill(traces);
    if (!faded || !traces->forward || !traces->inverse)
        return status_set(STATUS_FAILED, "no memory for range compression (%.0f MB)",
                          threads * (double)traces->each * sizeof(complex_real) / 1e6);
    shape->bytes += store->bytes;
    return STATUS_OK;
}

static bool transforms(const struct acquisition *acquisition, const struct traces_form *form)
{
    return !acquisition->compressed || form->upsample > 1 || form->degree > 0 || form->preemphasis;
}

/* Does a row depend on part of the record only? */
static bool cuts(const struct acquisition *acquisition, const struct traces_form *form)
{
    const bool compresses = !acquisition->compressed && form->upsample == 1 && form->degree == 0 && !form->preemphasis;
    return form->count > 0 && (compresses || !transforms(acquisition, form));
}

/* Whole records, or the part that alone a row depends on. */
static struct stretch stretch_plain(const struct acquisition *acquisition, const struct traces_form *form)
{
    const int pulse = acquisition->compressed ? 1 : acquisition->pulse_length;
    const bool cut = cuts(acquisition, form);
    const int from = cut ? form->first : 0, n = cut ? form->count : acquisition->samples;
    return (struct stretch){.from = from,
                            .read = (int)fmin(acquisition->samples - from, n + pulse - 1.0),
                            .length = acquisition->compressed ? n : fft_length_quick((long long)n + pulse - 1)};
}

/* Of a row with a band. */
static struct stretch stretch_of(const struct acquisition *acquisition, const struct traces_form *form)
{
    const struct stretch plain = stretch_plain(acquisition, form);
    const int beside = form->degree > 0 ? reach_of(form->degree, form->upsample) : form->guard;
    const double fade = ceil(2 * FADE_EDGE / fmax(1 - form->band, 1e-9)), around = fade + beside / form->upsample + 1;
    const bool between = form->upsample > 1 || form->degree > 0;
    if (!(form->count > 0 && form->band > 0 && between && acquisition->compressed) || form->preemphasis
        || !(form->count + 2 * around < acquisition->samples))
        return plain;
    const int from = form->first - (int)around, read = form->count + 2 * (int)around, length = fft_length_quick(read);
    return length < acquisition->samples ? (struct stretch){from, read, length, (int)fade} : plain;
}

static int period_of(const struct acquisition *acquisition, const struct traces_form *form)
{
    return stretch_of(acquisition, form).length;
}

static double flops_of(const struct acquisition *acquisition, const struct traces_form *form, double *sums)
{
    const struct stretch stretch = stretch_of(acquisition, form);
    const double length = stretch.length, planes = transformed(form->degree + 1) * form->upsample;
    const int samples = form->count > 0 ? form->count : acquisition->samples;
    *sums = 0;
    if (!transforms(acquisition, form))
        return 0;
    if (form->degree > 0) {
        const double taps = 2 * (2 * reach_of(form->degree, form->upsample) + 1);
        *sums = 4 * taps * (form->degree - 1) * ((samples - 1.0) * form->upsample + 1);
    }
    const double product = planes > 1 ? form->upsample > 1 ? 6 : 2 : 0;
    return 4.0 * stretch.fade + (planes + 1) * fft_flops(length) + 6 * length + product * planes * length;
}

static void destroy(void *made)
{
    struct traces *traces = made;
    if (traces)
        store_release(&traces->store);
    free(traces);
}

static enum status plan(const struct acquisition *acquisition, const struct traces_form *form, int threads,
                        struct traces_shape *shape, struct traces **out)
{
    *out = NULL;
    const int n = form->count > 0 ? form->count : acquisition->samples;
    const int upsample = form->upsample, branches = form->degree + 1;
    const struct stretch stretch = stretch_of(acquisition, form);
    const int length = stretch.length;
    long long fine = (long long)length * upsample, row = (long long)(n - 1) * upsample + 1 + 2LL * form->guard;
    if (length == 0 || fine * branches > INT_MAX / 4 || row * branches > INT_MAX / 4)
        return status_set(STATUS_UNSUPPORTED,
                          "records of %d samples upsampled by %d are too long to transform "
                          "(at most %d values)",
                          acquisition->samples, upsample, INT_MAX / 4 / branches);
    struct traces *traces = calloc(1, sizeof *traces);
    if (!traces)
        return status_set(STATUS_FAILED, "no memory for range compression");
    traces->fade = stretch.fade;
    traces->samples = acquisition->samples;
    traces->shape = (struct traces_shape){.first = form->count > 0 ? form->first : 0,
                                          .samples = n,
                                          .from = stretch.from,
                                          .read = stretch.read,
                                          .upsample = upsample,
                                          .guard = form->guard,
                                          .branches = branches,
                                          .length = (int)row,
                                          .period = length,
                                          .bytes = sizeof *traces - sizeof traces->store};
    double sums;
    traces->shape.flops = flops_of(acquisition, form, &sums);
    traces->shape.flops += sums;
    traces->planes = planes_choose(REAL_DOUBLE ? PRECISION_DOUBLE : PRECISION_FLOAT);
    traces->transforms = transforms(acquisition, form);
    enum status status =
        traces->transforms ? transforms_plan(traces, acquisition, form->preemphasis, threads) : STATUS_OK;
    if (status != STATUS_OK) {
        destroy(traces);
        return status;
    }
    *shape = traces->shape;
    *out = traces;
    return STATUS_OK;
}

/* The first of a thread's arrays. */
static complex_real *scratch_of(const struct traces *traces, int thread)
{
    return traces->scratch + (size_t)thread * traces->each;
}

static void spectrum_fill(const struct traces *traces, int thread, const void *record, void *spectrum)
{
    const struct traces_shape *shape = &traces->shape;
    const size_t length = (size_t)shape->period, count = (size_t)shape->read;
    const int begin = shape->from < 0 ? shape->from + traces->samples : shape->from, left = traces->samples - begin;
    const size_t n = (size_t)(shape->read < left ? shape->read : left);
    complex_real *padded = scratch_of(traces, thread);
    memcpy(padded, (const complex_real *)record + begin, n * sizeof *padded);
    memcpy(padded + n, record, (count - n) * sizeof *padded);
    memset(padded + count, 0, (length - count) * sizeof *padded);
    for (int k = 0; k < traces->fade; k++) {
        padded[k] *= traces->fading[k];
        padded[shape->read - 1 - k] *= traces->fading[k];
    }
    FFTW(execute_dft)(traces->forward, padded, spectrum);
    traces->planes->filter(spectrum, traces->filter, length);
}

static void plane_fill(const struct traces *traces, int thread, void *spectrum, int plane, void *values)
{
    const size_t length = (size_t)traces->shape.period;
    complex_real *turned = scratch_of(traces, thread);
    if (traces->factors)
        traces->planes->turn(spectrum, traces->factors + (size_t)plane * (length / 2 + 1), length, turned);
    else if (traces->gains)
        traces->planes->weigh(spectrum, traces->gains + (size_t)plane * length, plane % 2, length, turned);
    else
        turned = spectrum;
    FFTW(execute_dft)(traces->inverse, turned, values);
}

/* `count` fine values in order from one period of each of their planes, [upsample][pitch]; the first of them lies
   `before` fine values before the row's first sample. */
static void fine_fill(const struct traces_shape *shape, const complex_real *values, size_t before, size_t count,
                      complex_real *fine)
{
    const size_t upsample = (size_t)shape->upsample, period = (size_t)shape->period;
    const size_t samples = (before + upsample - 1) / upsample, begin = (size_t)(shape->first - shape->from);
    size_t sample = (begin + period - samples % period) % period, phase = samples * upsample - before;
    for (size_t i = 0; i < count && upsample == 1; sample = 0) {
        const size_t some = period - sample < count - i ? period - sample : count - i;
        memcpy(fine + i, values + sample, some * sizeof *fine);
        i += some;
    }
    for (size_t i = 0; i < count && upsample > 1; phase = 0) {
        const size_t end = upsample - phase < count - i ? upsample : phase + count - i;
        for (; phase < end; phase++)
            fine[i++] = values[phase * shape->pitch + sample];
        sample = sample + 1 < period ? sample + 1 : 0;
    }
}

/* A row of one branch. */
static void row_fill(const struct traces_shape *shape, const complex_real *values, complex_real *row)
{
    const size_t guard = (size_t)shape->guard, length = (size_t)shape->length;
    if (shape->upsample > 1) {
        fine_fill(shape, values, guard, length, row);
        return;
    }
    memset(row, 0, guard * sizeof *row);
    fine_fill(shape, values, 0, length - 2 * guard, row + guard);
    memset(row + length - guard, 0, guard * sizeof *row);
}

/* All branches from the first two and their neighbours, [2][wide]. */
static void branches_fill(const struct traces *traces, const complex_real *first, complex_real *row)
{
    const struct farrow_taps *taps = traces->taps;
    const size_t guard = (size_t)traces->shape.guard, length = (size_t)traces->shape.length;
    const size_t count = length - 2 * guard, some = (size_t)convolved(&traces->shape), reach = (size_t)taps->reach;
    for (int m = 0; m < traces->shape.branches; m++, row += length) {
        const complex_real *own = first + (size_t)(m % 2) * traces->wide;
        const complex_real *other = first + (size_t)(1 - m % 2) * traces->wide;
        memset(row, 0, guard * sizeof *row);
        if (m < 2)
            memcpy(row + guard, own + reach, count * sizeof *row);
        else {
            traces->planes->convolve(own, taps->own[m], 2 * taps->reach + 1, some, false, row + guard);
            traces->planes->convolve(other, taps->other[m], 2 * taps->reach + 1, some, true, row + guard);
        }
        memset(row + length - guard, 0, guard * sizeof *row);
    }
}

static void fill(const struct traces *traces, int thread, const void *record, void *row)
{
    const struct traces_shape *shape = &traces->shape;
    if (!traces->transforms) {
        row_fill(shape, (const complex_real *)record + shape->from, row);
        return;
    }
    complex_real *spectrum = scratch_of(traces, thread) + shape->pitch, *values = spectrum + shape->pitch;
    complex_real *first = values + (size_t)shape->upsample * shape->pitch;
    spectrum_fill(traces, thread, record, spectrum);
    for (int branch = 0; branch < transformed(shape->branches); branch++) {
        for (int phase = 0; phase < shape->upsample; phase++)
            plane_fill(traces, thread, spectrum, branch * shape->upsample + phase,
                       values + (size_t)phase * shape->pitch);
        if (shape->branches == 1)
            row_fill(shape, values, row);
        else
            fine_fill(shape, values, (size_t)traces->taps->reach, (size_t)(convolved(shape) + 2 * traces->taps->reach),
                      first + (size_t)branch * traces->wide);
    }
    if (shape->branches > 1)
        branches_fill(traces, first, row);
}

const struct traces_build REAL_NAME(traces) = {period_of, flops_of, plan, fill, spectrum_fill, plane_fill, destroy};
