#include "echoes/noise.h"

#include <fftw3.h>
#include <math.h>
#include <stdlib.h>

#include "common/pulse_band.h"
#include "echoes/echo_data.h"

enum { RECORDS_MOST = 64, PINGS_MOST = 16 };
static const double BINS_LEAST = 4;  /* beyond the band, to either side */
static const double TAPER = 3.0 / 8; /* of white noise's energy, what a raised cosine leaves */
static const double TAPERED = 2;     /* bins that it smears the band's edge over */
/* This many times a pulse's energy beyond its band is no noise: tapers and cut records change it. */
static const double FLANKS = 2;

/* The mean energy of a unit echo over some of the pings: those that do not see the target have none. */
static double seen_of(const struct acquisition *a, const struct target *target)
{
    enum { PINGS = 64 };
    const int step = (a->pings + PINGS - 1) / PINGS;
    double sum = 0;
    int count = 0;
    for (int p = step / 2; p < a->pings; p += step, count++) {
        const double r = hypot(target->r - a->tx[p].y, a->tx[p].z), u = a->tx[p].x - target->x;
        const double d = a->rx[(size_t)p * (size_t)a->receivers].x - a->tx[p].x;
        sum += pow(condition_pair_amplitude(a, r, u, d), 2);
    }
    return sum / count;
}

double noise_of_targets(const struct acquisition *a, int target_count, const struct target *targets, double noise_std)
{
    double most = noise_std, echoes = 0, pulse = a->compressed ? 1 : 0;
    if (!(noise_std > 0))
        return 0;
    for (int k = 0; k < target_count; k++)
        most = fmax(most, cabs(targets[k].amplitude)); /* squares of the ratios fit */
    for (int k = 0; k < target_count; k++)
        echoes += pow(cabs(targets[k].amplitude) / most, 2) * seen_of(a, &targets[k]);
    for (int k = 0; k < a->pulse_length; k++)
        pulse += creal(a->pulse[k] * conj(a->pulse[k]));
    const double noise = a->samples * pow(noise_std / most, 2) / pulse;
    return noise / (noise + echoes * a->fs / a->bandwidth);
}

/* What the pulse predicts of a record's echoes at its frequencies. */
struct expected {
    int first;     /* bins [first, samples - first] lie beyond the band */
    double beyond; /* of their energy, the share that lies there */
    double kept;   /* of white noise beside them, what compression keeps */
};

/* Of compressed echoes: nothing beyond the band, and all is kept. first = 0: there is nothing to measure, where the
   band leaves too few bins, a record is shorter than the pulse, or the pulse has as much energy beyond its band as in
   it. */
static enum status expected_make(const struct acquisition *a, struct expected *expected)
{
    const double first = ceil(a->bandwidth / a->fs / 2 * a->samples) + TAPERED;
    double sum = 0, squares = 0, beyond = 0;
    *expected = (struct expected){.kept = 1};
    if (!(a->samples / 2.0 - first >= BINS_LEAST) || a->pulse_length > a->samples)
        return STATUS_OK;
    expected->first = (int)first;
    if (a->compressed)
        return STATUS_OK;
    double *energy = pulse_energy(a, a->samples); /* the squares of the pulse's own */
    if (!energy)
        return STATUS_FAILED;
    for (int k = 0; k < a->samples; k++) {
        sum += sqrt(energy[k]);
        squares += energy[k];
        beyond += k >= expected->first && k <= a->samples - expected->first ? sqrt(energy[k]) : 0;
    }
    free(energy);
    expected->beyond = FLANKS * beyond / sum;
    expected->kept = sum * sum / (a->samples * squares);
    if (!(expected->beyond < 1 - 2 * first / a->samples))
        expected->first = 0;
    return STATUS_OK;
}

/* Energies of some records: in all, and beyond the band after a taper. */
struct energies {
    double all, beyond;
};

static void record_add(const double complex *values, double most, int samples, int first, fftw_plan plan,
                       fftw_complex *record, struct energies *sum)
{
    for (int i = 0; i < samples; i++) {
        const double complex value = values[i] / most;
        sum->all += creal(value * conj(value)) * samples;
        record[i] = value * (0.5 - 0.5 * cos(2 * M_PI * (i + 0.5) / samples));
    }
    fftw_execute(plan);
    for (int k = first; k <= samples - first; k++)
        sum->beyond += creal(record[k] * conj(record[k])) / TAPER;
}

/* The share of noise in the compressed echoes, from energies that are sums of echoes and noise. */
static double share_of(const struct energies *sum, const struct expected *expected, int samples)
{
    const double bins = samples - 2 * expected->first + 1;
    const double noise = (sum->beyond - expected->beyond * sum->all) * samples / (bins - expected->beyond * samples);
    const double of_noise = fmin(fmax(noise / sum->all, 0), 1);
    return expected->kept * of_noise / (expected->kept * of_noise + 1 - of_noise);
}

/* Of a row of `count`: every step-th is measured, from step/2 on. */
static int step_for(int count, int most)
{
    return (count + most - 1) / most;
}

/* Few pings, of several receivers each: pings are read whole. */
static void steps_of(const struct acquisition *a, int *ping, int *receiver)
{
    const int few = (RECORDS_MOST + a->receivers - 1) / a->receivers;
    *ping = step_for(a->pings, few > PINGS_MOST ? few : PINGS_MOST);
    *receiver = step_for(a->receivers, step_for(RECORDS_MOST, step_for(a->pings, *ping)));
}

void noise_pings(const struct acquisition *a, bool *read)
{
    int ping, receiver;
    steps_of(a, &ping, &receiver);
    for (int p = ping / 2; p < a->pings; p += ping)
        read[p] = true;
}

/* The records that are measured, as they lie in `values`; returns their number. */
static int records_of(const struct acquisition *a, const double complex *values, const double complex **records)
{
    int ping, receiver, count = 0;
    steps_of(a, &ping, &receiver);
    for (int p = ping / 2; p < a->pings; p += ping)
        for (int m = receiver / 2; m < a->receivers; m += receiver)
            records[count++] = values + ((size_t)p * (size_t)a->receivers + (size_t)m) * (size_t)a->samples;
    return count;
}

enum status noise_measure(const struct echoes *echoes, double *share)
{
    const struct acquisition *a = echoes->acquisition;
    const size_t samples = (size_t)a->samples;
    const double complex *records[2 * RECORDS_MOST];
    const int count = records_of(a, echoes->samples, records);
    struct expected expected;
    struct energies sum = {0, 0};
    double most = 0;
    *share = 0;
    enum status status = expected_make(a, &expected);
    if (status != STATUS_OK || expected.first == 0)
        return status;
    fftw_complex *record = fftw_malloc(samples * sizeof *record);
    fftw_plan plan = record ? fftw_plan_dft_1d(a->samples, record, record, FFTW_FORWARD, FFTW_ESTIMATE) : NULL;
    for (int n = 0; n < count; n++)
        most = fmax(most, largest_part(records[n], PRECISION_DOUBLE, samples));
    for (int n = 0; n < count && plan && most > 0; n++)
        record_add(records[n], most, a->samples, expected.first, plan, record, &sum);
    if (plan)
        fftw_destroy_plan(plan);
    else
        status = status_set(STATUS_FAILED, "no memory to measure the echoes' noise");
    fftw_free(record);
    if (sum.all > 0)
        *share = share_of(&sum, &expected, a->samples);
    return status;
}
