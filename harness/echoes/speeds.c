#include "echoes/speeds.h"

#include <fftw3.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "common/fft_length.h"
#include "common/kaiser.h"
#include "echoes/echo_data.h"

/* Of the kernel; its grid's points for a sample; places of its table, between which it is linear: an error of 1e-6. */
enum { TAPS = 12, FINE = 2, PLACES = 1024 };
static const double SPEED_MOST = 1e9;

static bool are_equal(int pings, const double *speeds)
{
    for (int p = 1; p < pings; p++)
        if (speeds[p] != speeds[0])
            return false;
    return true;
}

enum status speeds_unite(const char *path, const double *speeds, struct acquisition *a)
{
    double stretch = 0;
    a->sound_speed = 0;
    for (int p = 0; p < a->pings; p++) {
        if (!(speeds[p] > 0 && speeds[p] <= SPEED_MOST))
            return status_set(STATUS_INVALID, "%s: sound_speed is %g m/s at ping %d; above 0, at most %g, is accepted",
                              path, speeds[p], p + 1, SPEED_MOST);
        a->sound_speed += speeds[p] / a->pings;
    }
    if (are_equal(a->pings, speeds)) {
        a->sound_speed = speeds[0];
        return STATUS_OK;
    }
    for (int p = 0; p < a->pings; p++)
        stretch = fmax(stretch, fabs(a->sound_speed / speeds[p] - 1));
    const double band = a->bandwidth * (1 + stretch) + 2 * a->fc * stretch;
    if (!(band <= a->fs))
        return status_set(STATUS_INVALID,
                          "%s: sound_speed is up to %.3g %% off its mean of %.6g m/s, which moves the echoes' band by "
                          "%.4g Hz; a band of %.6g Hz is needed, fs is %.6g Hz",
                          path, 100 * stretch, a->sound_speed, a->fc * stretch, band, a->fs);
    for (int p = 0; p < a->pings; p++) {
        const double faster = a->sound_speed / speeds[p];
        struct vector *v = &a->velocity[p];
        *v = (struct vector){faster * v->x, faster * v->y, faster * v->z};
    }
    a->bandwidth = band;
    a->compressed = true;
    a->pulse_length = 0;
    free(a->pulse);
    a->pulse = NULL;
    return STATUS_OK;
}

/* ---- The records ---- */

struct mover {
    const struct acquisition *a;
    int length, fine;       /* of a record with room behind it; of the kernel's grid */
    fftw_complex *filter;   /* [length]: compression, over what the kernel weighs */
    fftw_complex **buffers; /* [threads][length + fine] */
    fftw_plan forward, backward;
    double kernel[PLACES + 1][TAPS];
};

/* Cycles of a bin, from the middle of the spectrum. */
static int bin_of(int k, int length)
{
    return k < (length + 1) / 2 ? k : k - length;
}

static enum status mover_make(const struct acquisition *a, int pulse_length, const double complex *pulse,
                              struct mover *mover)
{
    const int threads = omp_get_max_threads();
    *mover = (struct mover){.a = a, .length = fft_length((long long)a->samples + pulse_length + TAPS)};
    const size_t length = (size_t)mover->length, fine = length * FINE;
    mover->fine = mover->length * FINE;
    mover->filter = fftw_alloc_complex(length);
    mover->buffers = calloc((size_t)threads, sizeof *mover->buffers);
    bool there = mover->filter && mover->buffers;
    for (int t = 0; t < threads && there; t++)
        there = (mover->buffers[t] = fftw_alloc_complex(length + fine)) != NULL;
    if (there) {
        fftw_complex *buffer = mover->buffers[0];
        mover->forward = fftw_plan_dft_1d(mover->length, buffer, buffer, FFTW_FORWARD, FFTW_ESTIMATE);
        mover->backward = fftw_plan_dft_1d(mover->fine, buffer + length, buffer + length, FFTW_BACKWARD, FFTW_ESTIMATE);
    }
    if (!mover->forward || !mover->backward)
        return status_set(STATUS_FAILED, "no memory to move the records to one sound speed");
    double energy = 0;
    memset(mover->filter, 0, length * sizeof *mover->filter);
    for (int k = 0; k < pulse_length; k++) {
        mover->filter[k] = pulse[k];
        energy += creal(pulse[k] * conj(pulse[k]));
    }
    fftw_execute_dft(mover->forward, mover->filter, mover->filter);
    const double shape = kaiser_shape(TAPS, FINE);
    for (int k = 0; k < mover->length; k++) {
        const double weight = kaiser_transform(TAPS, shape, (double)bin_of(k, mover->length) / mover->fine);
        mover->filter[k] = (pulse ? conj(mover->filter[k]) / energy : 1) / (weight * mover->length);
    }
    for (int i = 0; i <= PLACES; i++)
        for (int k = 0; k < TAPS; k++)
            mover->kernel[i][k] = kaiser_value(TAPS, shape, (double)i / PLACES + TAPS / 2 - 1 - k);
    return STATUS_OK;
}

static void mover_free(struct mover *mover)
{
    if (mover->forward)
        fftw_destroy_plan(mover->forward);
    if (mover->backward)
        fftw_destroy_plan(mover->backward);
    for (int t = 0; t < omp_get_max_threads() && mover->buffers; t++)
        fftw_free(mover->buffers[t]);
    free(mover->buffers);
    fftw_free(mover->filter);
}

/* The kernel's grid of a record, behind its spectrum. */
static fftw_complex *grid_make(const struct mover *mover, fftw_complex *record)
{
    fftw_complex *grid = record + mover->length;
    fftw_execute_dft(mover->forward, record, record);
    memset(grid, 0, (size_t)mover->fine * sizeof *grid);
    for (int k = 0; k < mover->length; k++) {
        const int bin = bin_of(k, mover->length);
        grid[bin < 0 ? bin + mover->fine : bin] = record[k] * mover->filter[k];
    }
    fftw_execute_dft(mover->backward, grid, grid);
    return grid;
}

/* The record at a place, in samples; beyond its ends nothing. */
static double complex value_at(const struct mover *mover, const fftw_complex *grid, double place)
{
    const double middle = FINE * place, whole = floor(middle), of = PLACES * (middle - whole);
    const int i = (int)of < PLACES ? (int)of : PLACES - 1;
    double complex sum = 0;
    if (!(place >= 0 && place <= mover->a->samples - 1))
        return 0;
    for (int k = 0; k < TAPS; k++) {
        const double weight = mover->kernel[i][k] + (of - i) * (mover->kernel[i + 1][k] - mover->kernel[i][k]);
        sum += weight * grid[((int)whole + 1 - TAPS / 2 + k + mover->fine) % mover->fine];
    }
    return sum;
}

static void record_move(const struct mover *mover, int ping, double stretch, fftw_complex *record,
                        enum precision precision, void *samples)
{
    const struct acquisition *a = mover->a;
    float complex *single = samples;
    double complex *both = samples;
    memset(record, 0, (size_t)mover->length * sizeof *record);
    for (int n = 0; n < a->samples; n++)
        record[n] = precision == PRECISION_FLOAT ? single[n] : both[n];
    const fftw_complex *grid = grid_make(mover, record);
    for (int n = 0; n < a->samples; n++) {
        const double since = n + a->t0[ping] * a->fs, turn = a->fc * stretch * since / a->fs;
        const double complex moved =
            value_at(mover, grid, n + stretch * since) * cexp(2 * M_PI * I * (turn - rint(turn)));
        if (precision == PRECISION_FLOAT)
            single[n] = (float complex)moved;
        else
            both[n] = moved;
    }
}

enum status speeds_move(const struct acquisition *a, const double *speeds, int pulse_length,
                        const double complex *pulse, const bool *read, enum precision precision, void *samples)
{
    struct mover mover;
    if (are_equal(a->pings, speeds))
        return STATUS_OK;
    const enum status status = mover_make(a, pulse ? pulse_length : 0, pulse, &mover);
    const long long records = status == STATUS_OK ? (long long)a->pings * a->receivers : 0;
    const size_t bytes = (size_t)a->samples * precision_size(precision);
#pragma omp parallel for schedule(dynamic)
    for (long long n = 0; n < records; n++) {
        const int ping = (int)(n / a->receivers);
        if (!read || read[ping])
            record_move(&mover, ping, a->sound_speed / speeds[ping] - 1, mover.buffers[omp_get_thread_num()], precision,
                        (char *)samples + (size_t)n * bytes);
    }
    mover_free(&mover);
    return status;
}
