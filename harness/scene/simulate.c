/* Echo simulation with exact delays (simulate.h). Each pair is made by one thread from its own random stream. */
#include "scene/simulate.h"

#include <fftw3.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "contract/delay.h"
#include "common/fft_length.h"
#include "common/memory.h"
#include "common/progress.h"
#include "echoes/echo_data.h"
#include "scene/random.h"

enum { BINS = 32 };

int pulse_length_lfm(double duration, double fs)
{
    double length = floor(duration * fs * (1 + 1e-12));
    return length < 1 ? 1 : length < 1e9 ? (int)length : 1000000000;
}

static double complex chirp(double bandwidth, double duration, double t)
{
    double u = t - duration / 2, cycles = bandwidth / (2 * duration) * u * u;
    return cexp(I * (2 * M_PI * (cycles - floor(cycles))));
}

void pulse_lfm(double bandwidth, double duration, double fs, int length, double complex *pulse)
{
    for (int k = 0; k < length; k++)
        pulse[k] = chirp(bandwidth, duration, k / fs);
}

/* Shared by all pairs: the spectrum to delay, on `length` bins, and the place of the record in its period. */
struct replica {
    int length, lead;         /* lead: samples before the record, so that echoes that begin before t0 are complete */
    double *frequency;        /* [length] Hz, -fs/2 < f <= fs/2 */
    double complex *spectrum; /* [length] scaled for an unnormalised inverse FFT */
    double scale;             /* of amplitudes and noise, a power of two */
    bool nyquist;             /* the last positive bin is fs/2, which stands for both ends of the band */
    fftw_plan inverse;
};

static void replica_free(struct replica *replica)
{
    if (replica->inverse)
        fftw_destroy_plan(replica->inverse);
    free(replica->frequency);
    fftw_free(replica->spectrum);
    *replica = (struct replica){0};
}

/* Bins of the transforms of a record and its lead. */
static int transform_length(const struct scene *scene)
{
    const struct acquisition *a = &scene->acquisition;
    return scene->pulse_kind == PULSE_FLAT ? a->samples : fft_length(a->samples + 2LL * a->pulse_length);
}

/* The echoes of `pings`, the replica, a transform for each thread, and as much again for FFTW's plans. */
static enum status check_memory(const struct scene *scene, int pings)
{
    const struct acquisition *a = &scene->acquisition;
    double samples = (double)pings * a->receivers * a->samples, transforms = omp_get_max_threads() + 3.0;
    char what[400];
    snprintf(what, sizeof what, "the echoes of %.300s, %d samples x %d receivers x %d pings", scene->name, a->samples,
             a->receivers, pings);
    return memory_check((samples + transforms * transform_length(scene)) * sizeof(double complex), what);
}

static enum status replica_make(const struct scene *scene, struct replica *replica)
{
    const struct acquisition *a = &scene->acquisition;
    bool flat = scene->pulse_kind == PULSE_FLAT;
    int pulse = a->pulse_length, length = transform_length(scene);
    *replica = (struct replica){.length = length, .lead = flat ? 0 : pulse, .nyquist = length % 2 == 0};
    replica->frequency = malloc((size_t)length * sizeof *replica->frequency);
    replica->spectrum = fftw_malloc((size_t)length * sizeof *replica->spectrum);
    if (!length || !replica->frequency || !replica->spectrum) {
        replica_free(replica);
        return status_set(STATUS_FAILED, "no memory to simulate records of %d samples", a->samples);
    }
    replica->inverse =
        fftw_plan_dft_1d(length, replica->spectrum, replica->spectrum, FFTW_BACKWARD, FFTW_ESTIMATE | FFTW_UNALIGNED);
    double sum = 0, bin = a->fs / length, half = a->bandwidth / 2;
    for (int k = 0; k < length; k++) {
        double f = replica->frequency[k] = (2 * k > length ? k - length : k) * bin, beyond = fabs(f) - half;
        double weight = fabs(beyond) < 1e-6 * bin ? 0.5 : beyond < 0;
        if (replica->nyquist && 2 * k == length)
            weight *= 2; /* both ends of the band meet here: B = fs keeps the half of each */
        sum += weight;
        replica->spectrum[k] = weight;
    }
    if (flat) {
        for (int k = 0; k < length; k++)
            replica->spectrum[k] /= sum;
        return STATUS_OK;
    }
    memset(replica->spectrum, 0, (size_t)length * sizeof *replica->spectrum);
    memcpy(replica->spectrum, a->pulse, (size_t)pulse * sizeof *a->pulse);
    fftw_plan forward = fftw_plan_dft_1d(length, replica->spectrum, replica->spectrum, FFTW_FORWARD, FFTW_ESTIMATE);
    fftw_execute(forward);
    fftw_destroy_plan(forward);
    for (int k = 0; k < length; k++)
        replica->spectrum[k] /= length;
    return STATUS_OK;
}

/* Written out: the language's complex product checks for NaN, which costs several times the product. */
static double complex product(double complex a, double complex b)
{
    return __builtin_complex(creal(a) * creal(b) - cimag(a) * cimag(b), creal(a) * cimag(b) + cimag(a) * creal(b));
}

static double complex turn(double cycles)
{
    double angle = 2 * M_PI * (cycles - floor(cycles + 0.5));
    return __builtin_complex(cos(angle), sin(angle)); /* CMPLX, which clang 14 lacks */
}

static const double carrier = 0; /* Hz from itself */

/* A point as a record has it. */
struct echo {
    struct beam_angles angles;
    double delay;          /* s, from the record's first sample */
    double complex factor; /* of the carrier */
};

/* False where no part of the echo lies in the record. */
static bool echo_make(const struct acquisition *a, size_t record, const struct target *target, struct echo *echo)
{
    const int ping = (int)(record / (size_t)a->receivers), receiver = (int)(record % (size_t)a->receivers);
    const struct vector p = {target->x, target->r, 0};
    const double tau = delay_exact(a->tx[ping], a->rx[record], a->velocity[ping], p, a->sound_speed);
    echo->delay = tau - a->t0[ping];
    if (!(echo->delay > -a->pulse_length / a->fs && echo->delay < a->samples / a->fs))
        return false;
    echo->angles = beam_angles(a, ping, receiver, p, tau);
    echo->factor = turn(-a->fc * tau);
    return true;
}

/* Bins from `first` on, whose phases follow from each other without a turn of their own: to the last of the positive
   frequencies, or of all. */
static int bins_from(int first, int length)
{
    const int positive = length / 2 + 1, end = first < positive ? positive : length;
    return end - first < BINS ? end - first : BINS;
}

/* Add an echo of this amplitude to the spectrum: replica times exp(-j 2 pi f shift) with the amplitude of each bin. The
   adjoint leaves the spectrum, and returns its product with the conjugate of a unit echo's. */
static double complex pass_delayed(const struct scene *scene, const struct replica *replica, const struct echo *echo,
                                   bool adjoint, double complex amplitude, double complex *spectrum)
{
    const struct acquisition *a = &scene->acquisition;
    const int length = replica->length;
    const double bin = a->fs / length, shift = echo->delay + replica->lead / a->fs;
    const bool varies = scene->beam.per_frequency;
    double complex steps[BINS] = {1, turn(-bin * shift)}, sum = 0;
    double weight[BINS];
    beam_weights(scene, &echo->angles, &carrier, 1, weight);
    if (weight[0] == 0 && !varies)
        return 0;
    for (int k = 1; k < BINS; k++)
        weight[k] = weight[0];
    for (int k = 2; k < BINS; k++)
        steps[k] = product(steps[k / 2], steps[k - k / 2]);
    for (int first = 0, count; first < length; first += count) {
        const double *f = replica->frequency + first;
        const double complex start = turn(-f[0] * shift);
        double complex value[BINS], *part = spectrum + first;
        count = bins_from(first, length);
        if (varies)
            beam_weights(scene, &echo->angles, f, count, weight);
        for (int k = 0; k < count; k++)
            value[k] = product(start, steps[k]);
        if (replica->nyquist && 2 * (first + count - 1) == length)
            value[count - 1] = cos(2 * M_PI * f[count - 1] * shift);
        for (int k = 0; k < count; k++)
            value[k] = weight[k] * product(replica->spectrum[first + k], value[k]);
        for (int k = 0; k < count && adjoint; k++)
            sum += product(conj(value[k]), part[k]);
        for (int k = 0; k < count && !adjoint; k++)
            part[k] += product(amplitude, value[k]);
    }
    return sum;
}

/* The same of the chirp sampled at n/fs - tau: not band limited, as a naive simulation makes it. */
static double complex pass_sampled(const struct scene *scene, const struct echo *echo, bool adjoint,
                                   double complex amplitude, double complex *record)
{
    const struct acquisition *a = &scene->acquisition;
    const double delay = echo->delay;
    const int first = (int)fmax(0, ceil(delay * a->fs)),
              end = (int)fmin(a->samples, ceil((delay + scene->pulse_duration) * a->fs));
    double complex sum = 0;
    double weight;
    beam_weights(scene, &echo->angles, &carrier, 1, &weight);
    for (int n = first; n < end; n++) {
        const double complex value = chirp(a->bandwidth, scene->pulse_duration, n / a->fs - delay);
        if (adjoint)
            sum += product(weight * conj(value), record[n]);
        else
            record[n] += product(weight * amplitude, value);
    }
    return sum;
}

static void simulate_pair(const struct scene *scene, const struct replica *replica, size_t index, double complex *work,
                          double complex *record)
{
    const struct acquisition *a = &scene->acquisition;
    size_t samples = (size_t)a->samples;
    bool sampled = scene->pulse_kind == PULSE_LFM_TIME, any = false;
    if (sampled)
        memset(record, 0, samples * sizeof *record);
    else
        memset(work, 0, (size_t)replica->length * sizeof *work);
    for (int k = 0; k < scene->target_count; k++) {
        struct echo echo;
        if (!echo_make(a, index, &scene->targets[k], &echo))
            continue;
        double complex amplitude = replica->scale * scene->targets[k].amplitude * echo.factor;
        any = true;
        if (sampled)
            pass_sampled(scene, &echo, false, amplitude, record);
        else
            pass_delayed(scene, replica, &echo, false, amplitude, work);
    }
    if (!sampled) {
        if (any)
            fftw_execute_dft(replica->inverse, work, work);
        memcpy(record, work + replica->lead, samples * sizeof *record);
    }
    if (scene->noise_std > 0) {
        const double std = replica->scale * scene->noise_std;
        struct random random = random_seed(scene->noise_seed, index);
        for (size_t n = 0; n < samples; n++)
            record[n] += std * random_normal(&random);
    }
}

static bool is_finite(const double complex *numbers, int count)
{
    return isfinite(largest_part(numbers, PRECISION_DOUBLE, (size_t)count));
}

/* The power of two by which the echoes are divided: 0 unless the largest amplitude is so extreme that sums of
   echoes, or squares of the image, could leave double. */
static int amplitude_exponent(const struct scene *scene)
{
    double largest = scene->noise_std;
    int exponent = 0;
    for (int k = 0; k < scene->target_count; k++) {
        double complex amplitude = scene->targets[k].amplitude;
        largest = fmax(largest, fmax(fabs(creal(amplitude)), fabs(cimag(amplitude))));
    }
    if (largest > 0 && !(largest >= 0x1p-400 && largest <= 0x1p400))
        frexp(largest, &exponent);
    return exponent;
}

struct simulation {
    struct scene scene; /* borrowed; as it was flown */
    struct replica replica;
    int exponent;
    double complex *work; /* [threads][replica.length] */
};

void simulation_close(struct simulation *simulation)
{
    if (simulation) {
        fftw_free(simulation->work);
        replica_free(&simulation->replica);
    }
    free(simulation);
}

enum status simulation_open(const struct scene *scene, int pings, struct simulation **out)
{
    struct simulation *simulation = calloc(1, sizeof *simulation);
    *out = NULL;
    if (!simulation)
        return status_set(STATUS_FAILED, "no memory to simulate %s", scene->name);
    struct scene *own = &simulation->scene;
    *own = *scene;
    if (scene->flown)
        own->acquisition = *scene->flown;
    enum status status = check_memory(own, pings);
    if (status == STATUS_OK)
        status = replica_make(own, &simulation->replica);
    if (status == STATUS_OK) {
        const size_t bins = (size_t)omp_get_max_threads() * (size_t)simulation->replica.length;
        simulation->exponent = amplitude_exponent(own);
        simulation->replica.scale = ldexp(1, -simulation->exponent);
        simulation->work = fftw_malloc(bins * sizeof *simulation->work);
        if (!simulation->work)
            status = status_set(STATUS_FAILED, "no memory to simulate records of %d samples", own->acquisition.samples);
    }
    if (status == STATUS_OK)
        *out = simulation;
    else
        simulation_close(simulation);
    return status;
}

int simulation_exponent(const struct simulation *simulation)
{
    return simulation->exponent;
}

enum status simulation_pings(struct simulation *simulation, int first, int count, double complex *samples)
{
    const struct scene *scene = &simulation->scene;
    const struct acquisition *a = &scene->acquisition;
    const struct replica *replica = &simulation->replica;
    const size_t each = (size_t)a->samples;
    const long long begin = (long long)first * a->receivers, end = begin + (long long)count * a->receivers;
    long long unfit = end;
    progress_part((double)first / a->pings, ((double)first + count) / a->pings, (int)(end - begin));
#pragma omp parallel for schedule(dynamic, 8) reduction(min : unfit)
    for (long long k = begin; k < end; k++) {
        double complex *record = samples + (size_t)(k - begin) * each;
        if (!progress_step())
            continue;
        simulate_pair(scene, replica, (size_t)k,
                      simulation->work + (size_t)omp_get_thread_num() * (size_t)replica->length, record);
        if (k < unfit && !is_finite(record, a->samples))
            unfit = k;
    }
    return unfit == end ? STATUS_OK
                        : status_set(STATUS_INVALID,
                                     "%s: the echo of receiver %lld in ping %lld is not finite, its numbers must "
                                     "be less extreme",
                                     scene->name, unfit % a->receivers + 1, unfit / a->receivers + 1);
}

enum status simulation_adjoint(struct simulation *simulation, const double complex *samples, double complex *amplitudes)
{
    const struct scene *scene = &simulation->scene;
    const struct acquisition *a = &scene->acquisition;
    const struct replica *replica = &simulation->replica;
    const bool sampled = scene->pulse_kind == PULSE_LFM_TIME;
    const long long records = (long long)a->pings * a->receivers;
    const size_t length = (size_t)replica->length, each = (size_t)a->samples, size = length * sizeof *samples;
    enum status status = memory_check((double)records * (double)size, "the spectra of the echoes");
    double complex *spectra = status == STATUS_OK ? fftw_malloc((size_t)records * size) : NULL;
    if (!spectra)
        return status == STATUS_OK ? status_set(STATUS_FAILED, "no memory for the spectra of the echoes") : status;
    fftw_plan forward =
        fftw_plan_dft_1d(replica->length, spectra, spectra, FFTW_FORWARD, FFTW_ESTIMATE | FFTW_UNALIGNED);
    progress_part(0, 1, scene->target_count);
#pragma omp parallel for
    for (long long n = 0; n < records; n++) { /* the adjoint of cutting a record out of an inverse transform */
        double complex *spectrum = spectra + (size_t)n * length;
        memset(spectrum, 0, size);
        memcpy(spectrum + replica->lead, samples + (size_t)n * each, each * sizeof *samples);
        if (!sampled)
            fftw_execute_dft(forward, spectrum, spectrum);
    }
#pragma omp parallel for schedule(dynamic, 8)
    for (int k = 0; k < scene->target_count; k++) {
        double complex sum = 0;
        struct echo echo;
        const bool wanted = progress_step();
        for (long long n = 0; n < records && wanted; n++)
            if (echo_make(a, (size_t)n, &scene->targets[k], &echo)) {
                double complex *spectrum = spectra + (size_t)n * length;
                sum +=
                    product(conj(echo.factor), sampled ? pass_sampled(scene, &echo, true, 0, spectrum + replica->lead)
                                                       : pass_delayed(scene, replica, &echo, true, 0, spectrum));
            }
        amplitudes[k] = sum;
    }
    fftw_destroy_plan(forward);
    fftw_free(spectra);
    return is_finite(amplitudes, scene->target_count)
               ? STATUS_OK
               : status_set(STATUS_INVALID, "%s: the echoes are too extreme for sums of them", scene->name);
}

enum status scene_simulate(const struct scene *scene, struct echoes *echoes)
{
    const struct acquisition *a = &scene->acquisition;
    struct simulation *simulation;
    enum status status = simulation_open(scene, a->pings, &simulation);
    if (status != STATUS_OK)
        return status;
    status = echoes_allocate(a, PRECISION_DOUBLE, echoes);
    if (status == STATUS_OK) {
        echoes->exponent = simulation->exponent;
        status = simulation_pings(simulation, 0, a->pings, (double complex *)echoes->samples);
        if (status != STATUS_OK)
            echoes_free(echoes);
    }
    simulation_close(simulation);
    return status;
}
