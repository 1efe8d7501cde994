/* Direct sums in extended precision (exact_image.h). Cost: pixels x records x (samples for band-limited readings). */
#include "stability/exact_image.h"

#include <math.h>
#include <stdlib.h>

#include "stability/exact_geometry.h"

size_t exact_pixels(int patch_count, const struct grid *patches)
{
    size_t count = 0;
    for (int k = 0; k < patch_count; k++)
        count += grid_pixels(&patches[k]);
    return count;
}

/* Pixel number `index` of all patches. */
static struct exact_point pixel_number(const struct grid *patches, size_t index)
{
    const struct grid *patch = patches;
    for (size_t count; index >= (count = grid_pixels(patch)); patch++)
        index -= count;
    return exact_pixel_of(patch, (int)(index / (size_t)patch->x_count), (int)(index % (size_t)patch->x_count));
}

/* Add value times exp(+j 2 pi cycles). */
static void add_turned(struct exact_sum *sum, long double re, long double im, long double cycles)
{
    const long double angle = 2.0L * exact_pi * (cycles - floorl(cycles + 0.5L));
    const long double c = cosl(angle), s = sinl(angle);
    sum->re += re * c - im * s;
    sum->im += re * s + im * c;
}

/* --- Closed-form echoes ---------------------------------------------------------------------------------------- */

const char *exact_ideal_excludes(const struct scene *scene)
{
    if (scene->recorded)
        return "recorded echoes";
    if (scene->flown)
        return "motion unknown to the imager";
    if (scene->pulse_kind != PULSE_FLAT)
        return "raw echoes";
    if (scene->noise_std > 0)
        return "noise";
    return scene->beam.per_frequency ? "a beam that depends on the frequency" : NULL;
}

/* The spectrum has bins -h .. h of fs/N; bins at the band's edge weigh one half. */
long double exact_echo(const struct acquisition *a, long double t)
{
    const long double n = a->samples, half = (long double)a->bandwidth * n / a->fs / 2.0L;
    const long double h = floorl(half + 1e-6L), x = t * a->fs, turn = exact_pi * (x / n - floorl(x / n + 0.5L));
    const bool edge = fabsl(half - h) < 1e-6L && h > 0.0L;
    const long double bins = edge ? 2.0L * h : 2.0L * h + 1.0L, bottom = edge ? tanl(turn) : sinl(turn);
    return fabsl(turn) * bins < 1e-9L ? 1.0L : sinl(bins * turn) / (bins * bottom);
}

/* One target's echo in one record. */
struct echo {
    long double delay, re, im; /* amplitude; 0 beyond the beam or the record */
};

static void echoes_fill(const struct scene *scene, struct exact_pair pair, struct echo *echoes)
{
    const struct acquisition *a = &scene->acquisition;
    for (int k = 0; k < scene->target_count; k++) {
        const struct target *target = &scene->targets[k];
        const struct exact_point p = {target->x, target->r, 0.0L};
        const long double delay = exact_delay(&pair, p, a->sound_speed), after = delay - pair.t0;
        const bool received = after > 0.0L && after < a->samples / (long double)a->fs;
        const long double beam = received ? exact_beam(scene, &pair, p, delay) : 0.0L;
        echoes[k] = (struct echo){delay, creal(target->amplitude) * beam, cimag(target->amplitude) * beam};
    }
}

/* s: the rounding error that double may make in a delay and in the record's end: within it, either may be the later
   one. */
static long double rounding_of(const struct exact_pair *pair, long double delay)
{
    return 4.0L * 0x1p-53L * (fabsl(delay) + fabsl(pair->t0));
}

/* A pair whose delay is at the record's end: it may or may not be summed. */
struct bounds {
    bool inside, tied;
};

static struct bounds bounds_of(const struct acquisition *a, const struct exact_pair *pair, long double delay,
                               long double slack)
{
    const long double after = delay - pair->t0, left = (a->samples - 1) / (long double)a->fs - after;
    return (struct bounds){after >= 0.0L && left >= 0.0L,
                           after >= -slack && left >= -slack && (after <= slack || left <= slack)};
}

static bool inside_aperture(const struct acquisition *a, const struct exact_pair *pair, int ping, struct exact_point p)
{
    return !(a->aperture_limit < 1) || exact_sine(pair, p, acquisition_normal(a, ping)) <= a->aperture_limit;
}

/* Add a pair's echoes to a pixel. */
static void add_echoes(const struct scene *scene, const struct exact_pair *pair, const struct echo *echoes,
                       long double delay, struct exact_sum *sum)
{
    const struct acquisition *a = &scene->acquisition;
    const struct bounds bounds = bounds_of(a, pair, delay, rounding_of(pair, delay));
    struct exact_sum own = {0};
    for (int k = 0; k < scene->target_count && (bounds.inside || bounds.tied); k++) {
        const long double after = delay - echoes[k].delay, value = exact_echo(a, after);
        add_turned(&own, value * echoes[k].re, value * echoes[k].im, a->fc * after);
        own.size += fabsl(value) * hypotl(echoes[k].re, echoes[k].im);
    }
    if (bounds.tied)
        sum->ties += hypotl(own.re, own.im);
    if (bounds.inside) {
        sum->re += own.re;
        sum->im += own.im;
        sum->size += own.size;
        sum->pairs++;
    }
}

enum status exact_ideal(const struct scene *scene, struct exact_sum *sums)
{
    const struct acquisition *a = &scene->acquisition;
    const size_t pixels = exact_pixels(scene->patch_count, scene->patches);
    struct echo *echoes = calloc((size_t)scene->target_count + 1, sizeof *echoes);
    if (!echoes)
        return status_set(STATUS_FAILED, "no memory for %d exact echoes", scene->target_count);
    for (size_t i = 0; i < pixels; i++)
        sums[i] = (struct exact_sum){0};
    for (int ping = 0; ping < a->pings; ping++)
        for (int m = 0; m < a->receivers; m++) {
            const struct exact_pair pair = exact_pair_of(a, ping, m);
            bool received = false;
            echoes_fill(scene, pair, echoes);
            for (int k = 0; k < scene->target_count; k++)
                received = received || echoes[k].re != 0.0L || echoes[k].im != 0.0L;
            if (!received)
                continue;
#pragma omp parallel for schedule(dynamic, 4)
            for (size_t i = 0; i < pixels; i++) {
                const struct exact_point p = pixel_number(scene->patches, i);
                if (inside_aperture(a, &pair, ping, p))
                    add_echoes(scene, &pair, echoes, exact_delay(&pair, p, a->sound_speed), &sums[i]);
            }
        }
    free(echoes);
    return STATUS_OK;
}

/* --- A method's own reading of the samples ---------------------------------------------------------------------- */

/* Points and weights of a quadrature over [-1, 1]. */
struct gauss {
    int count;
    long double point[24], weight[24];
};

/* One record and the data for reading it. */
struct trace {
    const double complex *samples;
    int count;
    const long double *cosine, *sine; /* [count] of pi n/N */
    const struct exact_reading *reading;
    struct gauss gauss;                                  /* of polynomials */
    long double lower[EXACT_TAPS_MOST][EXACT_TAPS_MOST]; /* of fitted taps: Cholesky's factor of the normal equations */
    long double level; /* rms of the samples: a transform's rounding is relative to it */
};

struct value {
    long double re, im, size;
};

static void add_tap(const struct trace *trace, long double n, long double weight, struct value *value)
{
    if (!(n >= 0.0L && n < trace->count) || weight == 0.0L)
        return;
    const double complex s = trace->samples[(int)n];
    value->re += weight * creal(s);
    value->im += weight * cimag(s);
    value->size += fabsl(weight) * hypotl(creal(s), cimag(s));
}

/* The band-limited signal of period N through all samples: the sum of s[n] sin(pi x)/(N tan(pi x/N)), x = q - n, where
   both ends of the band share the bin at fs/2; /(N sin(pi x/N)) for an odd N. With q = i + f, sin(pi x) is (-1)^(i - n)
   sin(pi f). Sines of pi x/N by the addition theorem have 64 bits of the largest; the sample at q has its own. */
static struct value read_band(const struct trace *trace, long double q)
{
    const int count = trace->count;
    const long double i = floorl(q + 0.5L), f = q - i, n = count, turn = exact_pi * (q / n);
    const long double c = cosl(turn), s = sinl(turn), near = exact_pi * f / n, wave = sinl(exact_pi * f) / n;
    const bool odd = count % 2 != 0, first_negative = fmodl(i, 2.0L) != 0.0L;
    struct value value = {0};
    for (int k = 0; k < count; k++) {
        long double below = s * trace->cosine[k] - c * trace->sine[k];
        long double above = odd ? 1.0L : c * trace->cosine[k] + s * trace->sine[k];
        if (k == i) {
            below = sinl(near);
            above = odd ? 1.0L : cosl(near);
        }
        const bool negative = first_negative != (k % 2 != 0);
        const long double weight = k == i && f == 0.0L ? 1.0L : (negative ? -wave : wave) * above / below;
        value.re += weight * creal(trace->samples[k]);
        value.im += weight * cimag(trace->samples[k]);
    }
    value.size = hypotl(value.re, value.im) + trace->level;
    return value;
}

/* The Legendre polynomial P_n(z). */
static long double legendre(int n, long double z)
{
    long double before = 0.0L, now = 1.0L;
    for (int k = 0; k < n; k++) {
        const long double next = ((2 * k + 1) * z * now - k * before) / (k + 1);
        before = now;
        now = next;
    }
    return now;
}

/* Gauss's points in [-1, 1] and their weights, by Newton's method. For a polynomial of the degree times a signal of
   half a cycle, the quadrature's error is below 1e-17. */
static struct gauss gauss_make(int degree)
{
    struct gauss gauss = {.count = degree + 7};
    for (int k = 0; k < gauss.count; k++) {
        const int n = gauss.count;
        long double z = cosl(exact_pi * (k + 0.75L) / (n + 0.5L)), slope = 1.0L;
        for (int step = 0; step < 10; step++) {
            slope = n * (z * legendre(n, z) - legendre(n - 1, z)) / (z * z - 1.0L);
            z -= legendre(n, z) / slope;
        }
        gauss.point[k] = z;
        gauss.weight[k] = 2.0L / ((1.0L - z * z) * slope * slope);
    }
    return gauss;
}

/* The polynomial nearest to the signal s within half a sample of `place` is the sum over n <= degree of (2n+1)
   P_n(2u) times the integral of s(place + t) P_n(2t) over |t| <= 1/2; at u from there. No Bessel functions, no
   spectrum. */
static struct value read_polynomial(const struct trace *trace, long double place, long double u)
{
    const struct exact_reading *reading = trace->reading;
    struct value value = {0};
    for (int k = 0; k < trace->gauss.count; k++) {
        const long double z = trace->gauss.point[k];
        long double kernel = 0.0L;
        for (int n = 0; n <= reading->degree; n++)
            kernel += (2 * n + 1) * legendre(n, 2.0L * u) * legendre(n, z);
        kernel *= trace->gauss.weight[k] / 2.0L;
        const struct value s = read_band(trace, (place + z / 2.0L) / reading->upsample);
        value.re += kernel * s.re;
        value.im += kernel * s.im;
        value.size += fabsl(kernel) * s.size;
    }
    return value;
}

/* I0 by its power series, whose terms are all positive. */
static long double bessel_i0(long double x)
{
    long double sum = 1.0L, term = 1.0L;
    for (int k = 1; term > 1e-21L * sum; k++) {
        term *= x / 2.0L / k * (x / 2.0L / k);
        sum += term;
    }
    return sum;
}

static long double sinc(long double x)
{
    return x == 0.0L ? 1.0L : sinl(exact_pi * x) / (exact_pi * x);
}

static struct value read_sinc(const struct trace *trace, long double q)
{
    const int taps = trace->reading->taps;
    const long double beta = trace->reading->kaiser, whole = floorl(q), f = q - whole;
    struct value value = {0};
    for (int k = 1 - taps / 2; k <= taps / 2; k++) {
        const long double z = f - k, edge = 2.0L * z / taps, inside = 1.0L - edge * edge;
        const long double window =
            beta > 0.0L ? bessel_i0(beta * sqrtl(inside > 0.0L ? inside : 0.0L)) / bessel_i0(beta) : 1.0L;
        add_tap(trace, whole + k, sinc(z) * window, &value);
    }
    return value;
}

/* The normal equations of fitted taps, with 1e-12 on the diagonal. */
static void normal_factor(const struct exact_reading *reading, struct trace *trace)
{
    for (int i = 0; i < reading->taps; i++)
        for (int j = 0; j <= i; j++) {
            long double left = sinc((long double)reading->band * (i - j)) + (i == j ? 1e-12L : 0.0L);
            for (int k = 0; k < j; k++)
                left -= trace->lower[i][k] * trace->lower[j][k];
            trace->lower[i][j] = i == j ? sqrtl(left) : left / trace->lower[j][j];
        }
}

/* Solved again for each position. */
static struct value read_fitted(const struct trace *trace, long double fine)
{
    const struct exact_reading *reading = trace->reading;
    const int taps = reading->taps;
    const long double whole = floorl(fine), f = fine - whole;
    long double w[EXACT_TAPS_MOST];
    struct value value = {0};
    for (int i = 0; i < taps; i++) {
        w[i] = sinc((long double)reading->band * (f - (1 - taps / 2 + i)));
        for (int k = 0; k < i; k++)
            w[i] -= trace->lower[i][k] * w[k];
        w[i] /= trace->lower[i][i];
    }
    for (int i = taps - 1; i >= 0; i--) {
        for (int k = i + 1; k < taps; k++)
            w[i] -= trace->lower[k][i] * w[k];
        w[i] /= trace->lower[i][i];
    }
    for (int i = 0; i < taps; i++) {
        const long double at = whole + (1 - taps / 2 + i);
        if (reading->upsample == 1) {
            add_tap(trace, at, w[i], &value);
            continue;
        }
        const long double q = at / reading->upsample; /* the record's period contains all samples */
        const struct value s = read_band(trace, q - trace->count * floorl(q / trace->count));
        value.re += w[i] * s.re;
        value.im += w[i] * s.im;
        value.size += fabsl(w[i]) * s.size;
    }
    return value;
}

/* At a position in upsampled samples that is already rounded, if the method rounds. */
static struct value read_position(const struct trace *trace, long double position)
{
    struct value value = {0};
    switch (trace->reading->kind) {
    case READING_NEAREST:
        if (trace->reading->upsample > 1)
            return read_band(trace, position / trace->reading->upsample);
        add_tap(trace, position, 1.0L, &value);
        break;
    case READING_LINEAR: {
        const long double whole = floorl(position), f = position - whole;
        add_tap(trace, whole, 1.0L - f, &value);
        add_tap(trace, whole + 1.0L, f, &value);
        break;
    }
    case READING_SINC: return read_sinc(trace, position);
    case READING_FITTED: return read_fitted(trace, position * trace->reading->upsample);
    case READING_NONE: /* never asked for */
    case READING_BAND:
    case READING_POLYNOMIAL: return read_band(trace, position);
    }
    return value;
}

/* At `fine` in upsampled samples, rounded as the method rounds positions, to `whole` of `steps`. */
static struct value read_rounded(const struct trace *trace, long double fine, long double whole)
{
    if (trace->reading->kind == READING_POLYNOMIAL)
        return read_polynomial(trace, whole, fine - whole);
    return read_position(trace, whole / trace->reading->phases);
}

/* Add a pair: its value, and the value on the other side of a tie. */
static void add_pair(const struct trace *trace, const struct acquisition *a, const struct exact_pair *pair,
                     long double delay, struct exact_sum *sum)
{
    const struct exact_reading *reading = trace->reading;
    const long double slack = reading->slack_s + rounding_of(pair, delay), q = (delay - pair->t0) * a->fs;
    const struct bounds bounds = bounds_of(a, pair, delay, slack);
    struct value value;
    if (!bounds.inside && !bounds.tied)
        return;
    if (reading->phases > 0) {
        const long double steps = (long double)reading->upsample * reading->phases, fine = q * steps;
        const long double whole = floorl(fine + 0.5L), edge = 0.5L - fabsl(fine - whole);
        value = read_rounded(trace, fine, whole);
        if (edge <= slack * a->fs * steps + reading->slack_point * reading->phases) {
            const long double beside = fine > whole ? whole + 1.0L : whole - 1.0L;
            const struct value other = read_rounded(trace, fine, beside);
            sum->ties += hypotl(other.re - value.re, other.im - value.im);
        }
    } else {
        value = read_position(trace, q);
    }
    if (bounds.tied)
        sum->ties += hypotl(value.re, value.im);
    if (bounds.inside) {
        add_turned(sum, value.re, value.im, a->fc * delay);
        sum->size += value.size;
        sum->pairs++;
    }
}

/* False for an all-zero record: it adds nothing. */
static bool trace_open(const struct acquisition *a, const double complex *samples, struct trace *trace)
{
    long double sum = 0.0L;
    for (int n = 0; n < a->samples; n++)
        sum += (long double)creal(samples[n]) * creal(samples[n]) + (long double)cimag(samples[n]) * cimag(samples[n]);
    trace->samples = samples;
    trace->level = sqrtl(sum / a->samples);
    return sum > 0.0L;
}

enum status exact_method(const struct problem *problem, const double complex *samples,
                         const struct exact_reading *reading, struct exact_sum *sums)
{
    const struct acquisition *a = problem->acquisition;
    const size_t pixels = exact_pixels(problem->patch_count, problem->patches), n = (size_t)a->samples;
    long double *cosine = malloc(2 * n * sizeof *cosine);
    if (!cosine)
        return status_set(STATUS_FAILED, "no memory for %zu exact samples", n);
    for (size_t k = 0; k < n; k++) {
        cosine[k] = cosl(exact_pi * (long double)k / (long double)n);
        cosine[n + k] = sinl(exact_pi * (long double)k / (long double)n);
    }
    for (size_t i = 0; i < pixels; i++)
        sums[i] = (struct exact_sum){0};
    struct trace trace = {.count = a->samples, .cosine = cosine, .sine = cosine + n, .reading = reading};
    if (reading->kind == READING_POLYNOMIAL)
        trace.gauss = gauss_make(reading->degree);
    if (reading->kind == READING_FITTED)
        normal_factor(reading, &trace);
    for (int ping = 0; ping < a->pings; ping++)
        for (int m = 0; m < a->receivers; m++) {
            const struct exact_pair pair = exact_pair_of(a, ping, m);
            if (!trace_open(a, samples + ((size_t)ping * (size_t)a->receivers + (size_t)m) * n, &trace))
                continue;
#pragma omp parallel for schedule(dynamic, 4)
            for (size_t i = 0; i < pixels; i++) {
                const struct exact_point p = pixel_number(problem->patches, i);
                if (inside_aperture(a, &pair, ping, p))
                    add_pair(&trace, a, &pair, exact_delay(&pair, p, a->sound_speed), &sums[i]);
            }
        }
    free(cosine);
    return STATUS_OK;
}
