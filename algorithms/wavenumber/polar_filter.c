/* The polar-format filter (polar_filter.h). Compiled once for each precision. */
#include "wavenumber/polar_filter.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "contract/delay.h"
#include "common/fft.h"
#include "common/fft_length.h"
#include "common/phasor.h"

enum {
    ALIGNMENT = 64,
    STRIP = 128 / sizeof(complex_real), /* samples that go through an azimuth FFT together: two lines of the cache */
    UPSAMPLING_MOST = 64
};

/* One sub-aperture, in rows of the upsampled field. */
struct aperture {
    int begin, end, length;      /* length: of its padded transform */
    double x, sine, rho;         /* m: its middle; of the area's centre seen from there */
    FFTW(plan) forward, inverse; /* wide band: of chirp transforms, `chirp` long */
    int chirp, lines;            /* lines: wavenumbers, a period of them at any frequency */
};

struct polar_filter {
    const struct acquisition *acquisition;
    struct polar_shape shape;
    bool curvature, is_wide;
    double spacing, kc, slope;  /* m, signed; 2 pi fc/c; of the beam's axis */
    int pings, samples, length; /* length: of the range transform */
    int up, rows;               /* rows of the field: up x pings */
    double *delay;              /* [rows] s: delay of the area's centre */
    struct aperture *apertures;
    complex_real *field;   /* [rows][length] */
    complex_real *wide;    /* wide band: [wavenumbers of a sub-aperture][length] */
    complex_real *scratch; /* [threads][scratch_length] */
    size_t scratch_length;
    FFTW(plan) range_forward, range_inverse, track_forward, track_inverse;
    struct store store;
};

/* Wavenumbers of `rows`, padded to twice as many at the carrier: a period at the lowest frequency. */
static int wide_lines(const struct acquisition *a, int rows)
{
    return 2 * (int)ceil(rows / (1 - a->fs / (2 * a->fc)));
}

static int chirp_length(int rows, int lines)
{
    return fft_length_fast(rows + lines);
}

static void plan_apertures(struct polar_filter *f)
{
    const struct acquisition *a = f->acquisition;
    const int count = f->shape.subapertures;
    for (int s = 0; s < count; s++) {
        struct aperture *p = &f->apertures[s];
        const int first = polar_filter_begin(a, count, s), end = polar_filter_begin(a, count, s + 1);
        p->begin = first * f->up;
        p->end = end * f->up;
        p->x = a->tx[0].x + (first + end - 1) / 2.0 * f->spacing;
        p->sine = polar_filter_sine(a, p->x);
        p->rho = hypot(a->area.x - p->x, a->area.r);
        p->length = 2 * (p->end - p->begin);
        double all = (double)p->length * f->length;
        if (f->is_wide) {
            p->lines = wide_lines(f->acquisition, p->end - p->begin);
            p->chirp = chirp_length(p->end - p->begin, p->lines);
            p->forward = fft_line(&f->store, p->chirp, f->scratch, f->scratch, FFTW_FORWARD);
            p->inverse = fft_line(&f->store, p->chirp, f->scratch, f->scratch, FFTW_BACKWARD);
            f->shape.flops += f->length * 2 * (3 * fft_flops(p->chirp) + 18.0 * p->chirp)
                              + (2.0 * p->lines + p->length) * fft_flops(f->length) + all * 2;
            continue;
        }
        p->forward = fft_strip(&f->store, p->length, STRIP, f->scratch, f->scratch, FFTW_FORWARD);
        p->inverse = fft_strip(&f->store, p->length, STRIP, f->scratch, f->scratch, FFTW_BACKWARD);
        f->shape.flops += f->length * 2 * fft_flops(p->length) + all * 2;
    }
}

static bool plan_memory(struct polar_filter *f, int threads)
{
    const struct acquisition *a = f->acquisition;
    const size_t strip = STRIP * 3 * (size_t)f->rows; /* a padded sub-aperture; both track transforms */
    const int rows = f->up * ((f->pings + f->shape.subapertures - 1) / f->shape.subapertures);
    const int lines = wide_lines(f->acquisition, rows);
    const size_t chirps = f->is_wide ? 2 * ((size_t)chirp_length(rows, lines) + ALIGNMENT) : 0;
    f->scratch_length = (strip > (size_t)f->length ? strip : (size_t)f->length) + ALIGNMENT;
    f->scratch_length = f->scratch_length > chirps ? f->scratch_length : chirps;
    f->scratch_length = f->scratch_length / ALIGNMENT * ALIGNMENT;
    f->apertures = store_take(&f->store, (size_t)f->shape.subapertures, sizeof *f->apertures, 1);
    f->delay = store_take(&f->store, (size_t)f->rows, sizeof *f->delay, 1);
    f->field = store_take(&f->store, (size_t)f->rows * (size_t)f->length, sizeof *f->field, 1);
    if (f->is_wide)
        f->wide = store_take(&f->store, (size_t)lines * (size_t)f->length, sizeof *f->wide, 1);
    f->scratch = store_take(&f->store, (size_t)threads, f->scratch_length * sizeof *f->scratch, 1.0 / threads);
    if (f->store.failed)
        return false;
    const struct vector centre = {a->area.x, a->area.r, 0};
    for (int i = 0; i < f->rows; i++) {
        struct vector tx = {a->tx[0].x + i * f->spacing / f->up, 0, 0};
        f->delay[i] = delay_exact(tx, tx, a->velocity[0], centre, a->sound_speed);
    }
    f->range_forward = fft_line(&f->store, f->length, f->scratch, f->scratch, FFTW_FORWARD);
    f->range_inverse = fft_line(&f->store, f->length, f->scratch, f->scratch, FFTW_BACKWARD);
    if (f->up > 1) {
        f->track_forward = fft_strip(&f->store, f->pings, STRIP, f->scratch, f->scratch, FFTW_FORWARD);
        f->track_inverse = fft_strip(&f->store, f->rows, STRIP, f->scratch, f->scratch, FFTW_BACKWARD);
    }
    return !f->store.failed;
}

enum status REAL_NAME(polar_filter_plan)(const struct acquisition *a, const struct polar_setting *setting, int threads,
                                         struct polar_shape *shape, struct polar_filter **out)
{
    struct straight_track track;
    *out = NULL;
    enum status status = polar_filter_check(a, "polar-format filter");
    if (status != STATUS_OK)
        return status;
    acquisition_is_straight(a, &track);
    struct polar_filter *f = calloc(1, sizeof *f);
    if (!f)
        return status_set(STATUS_FAILED, "no memory for the polar-format filter");
    *f = (struct polar_filter){.acquisition = a,
                               .curvature = setting->curvature,
                               .is_wide = setting->wide,
                               .spacing = track.spacing,
                               .kc = 2 * M_PI * a->fc / a->sound_speed,
                               .slope = sin(a->echo_squint),
                               .pings = a->pings,
                               .samples = a->samples,
                               .length = fft_length_fast(a->samples),
                               .shape = {setting->subapertures, 1, 0, sizeof *f - sizeof f->store}};
    const int most = polar_filter_most(a);
    double up = 0;
    f->shape.subapertures = polar_filter_subapertures(a, setting->subapertures);
    if (f->shape.subapertures > most)
        status = status_set(STATUS_UNSUPPORTED,
                            "polar-format filter: condition subapertures: %d sub-apertures of %d pings; at most %d",
                            f->shape.subapertures, a->pings, most);
    if (status == STATUS_OK && setting->wide && !(a->fs < a->fc))
        status = status_set(STATUS_UNSUPPORTED,
                            "polar-format filter: condition band: the sampling rate over the carrier is %.3g; below 1 "
                            "is needed (cure: band=narrow)",
                            a->fs / a->fc);
    if (status == STATUS_OK && !((up = polar_filter_upsampling(a, f->shape.subapertures)) <= UPSAMPLING_MOST))
        status = status_set(STATUS_UNSUPPORTED,
                            "polar-format filter: condition upsampling: %d sub-apertures need %g times upsampling; at "
                            "most %d (cure: more "
                            "sub-apertures)",
                            f->shape.subapertures, up, UPSAMPLING_MOST);
    f->up = f->shape.upsampling = (int)up;
    f->rows = f->up * f->pings;
    if (status == STATUS_OK)
        status = memory_check((double)f->rows * f->length * sizeof(complex_real), "the polar-format filter");
    if (status == STATUS_OK && plan_memory(f, threads))
        plan_apertures(f);
    if (f->store.failed)
        status = status_set(STATUS_FAILED, "no memory for the polar-format filter");
    if (status != STATUS_OK) {
        REAL_NAME(polar_filter_destroy)(f);
        return status;
    }
    double rows = f->rows, pings = f->pings, length = f->length;
    f->shape.flops += 2 * (rows + pings) * fft_flops(length) + (rows + pings) * length * (setting->curvature ? 14 : 8);
    if (f->up > 1)
        f->shape.flops += length * (fft_flops(pings) + fft_flops(rows));
    f->shape.bytes += f->store.bytes;
    *shape = f->shape;
    *out = f;
    return STATUS_OK;
}

void REAL_NAME(polar_filter_destroy)(void *filter)
{
    struct polar_filter *f = filter;
    if (f)
        store_release(&f->store);
    free(f);
}

static complex_real *scratch_of(const struct polar_filter *f)
{
    return f->scratch + (size_t)omp_get_thread_num() * f->scratch_length;
}

/* Remove the centre's delay at a row (sign 1: sample 0 is then at that delay) or restore it (-1): bins in the
   transform's order, whose samples begin at t0, times exp(sign j 2 pi (fc delay + f (delay - t0))) and `scale`. */
static void shift(const struct polar_filter *f, real *bins, int row, double sign, real scale)
{
    const struct acquisition *a = f->acquisition;
    const int length = f->length;
    const double carrier = sign * a->fc * f->delay[row], step = sign * (f->delay[row] - a->t0[0]) * a->fs / length;
#pragma omp simd
    for (int k = 0; k < length; k++) {
        double cycles = carrier + (2 * k < length ? k : k - length) * step;
        real c, s, re = bins[2 * k] * scale, im = bins[2 * k + 1] * scale;
        phasor((real)(cycles - floor(cycles + 0.5)), &c, &s);
        bins[2 * k] = re * c - im * s;
        bins[2 * k + 1] = re * s + im * c;
    }
}

/* Range from the sub-aperture's middle at sample k without the centre's delay; samples wrap around. */
static inline double range_at(const struct polar_filter *f, const struct aperture *p, int k)
{
    const struct acquisition *a = f->acquisition;
    int n = 2 * k < f->length ? k : k - f->length;
    return p->rho + a->sound_speed / 2 * n / a->fs;
}

/* The wavefronts' curvature of one row: exp(sign j k_c u^2 (1/R - 1/rho)). */
static void curve(const struct polar_filter *f, const struct aperture *p, int row, double sign, real *samples)
{
    const double u = f->acquisition->tx[0].x + row * f->spacing / f->up - p->x,
                 scale = sign * f->kc * u * u / (2 * M_PI);
    for (int k = 0; k < f->length; k++) {
        double r = range_at(f, p, k), cycles = r > 0 ? scale * (1 / r - 1 / p->rho) : 0;
        real c, s, re = samples[2 * k], im = samples[2 * k + 1];
        phasor((real)(cycles - floor(cycles + 0.5)), &c, &s);
        samples[2 * k] = re * c - im * s;
        samples[2 * k + 1] = re * s + im * c;
    }
}

/* Records to spectra, pings 0 to P - 1 in the first rows of the field. */
static void spectra(const struct polar_filter *f, const complex_real *records)
{
#pragma omp parallel for schedule(static)
    for (int n = 0; n < f->pings; n++) {
        complex_real *wave = scratch_of(f), *row = f->field + (size_t)n * (size_t)f->length;
        memcpy(wave, records + (size_t)n * (size_t)f->samples, (size_t)f->samples * sizeof *wave);
        memset(wave + f->samples, 0, (size_t)(f->length - f->samples) * sizeof *wave);
        FFTW(execute_dft)(f->range_forward, wave, wave);
        memcpy(row, wave, (size_t)f->length * sizeof *wave);
    }
}

/* Along the track, band-limited, about the wavenumber of the beam's axis. */
static void upsample(const struct polar_filter *f)
{
    const struct acquisition *a = f->acquisition;
    const int strips = (f->length + STRIP - 1) / STRIP, pings = f->pings, rows = f->rows;
#pragma omp parallel for schedule(static)
    for (int s = 0; s < strips; s++) {
        const int first = s * STRIP, width = f->length - first < STRIP ? f->length - first : STRIP;
        complex_real *fine = scratch_of(f), *coarse = fine + (size_t)STRIP * (size_t)rows;
        complex_real *field = f->field + first;
        for (int n = 0; n < pings; n++)
            memcpy(coarse + (size_t)n * STRIP, field + (size_t)n * (size_t)f->length, (size_t)width * sizeof *coarse);
        FFTW(execute_dft)(f->track_forward, coarse, coarse);
        memset(fine, 0, (size_t)rows * STRIP * sizeof *fine);
        for (int k = 0; k < width; k++) {
            int bin = 2 * (first + k) < f->length ? first + k : first + k - f->length;
            double axis = 2 * f->slope * (a->fc + bin * a->fs / f->length) / a->sound_speed * f->spacing * pings;
            for (long long q = (long long)floor(axis + 0.5) - pings / 2, end = q + pings; q < end; q++) {
                size_t from = (size_t)((q % pings + pings) % pings), to = (size_t)((q % rows + rows) % rows);
                fine[to * STRIP + (size_t)k] = coarse[from * STRIP + (size_t)k] / (real)pings;
            }
        }
        FFTW(execute_dft)(f->track_inverse, fine, fine);
        for (int i = 0; i < rows; i++)
            memcpy(field + (size_t)i * (size_t)f->length, fine + (size_t)i * STRIP, (size_t)width * sizeof *fine);
    }
}

/* The sine of psi at wavenumber q, which is ambiguous by whole periods: the one about the beam's axis. */
static double sine_at(const struct polar_filter *f, const struct aperture *p, int q)
{
    const double period = 2 * M_PI * f->up / fabs(f->spacing) / (2 * f->kc);
    const double sine = (f->spacing < 0 ? -q : q) * period / p->length + p->sine - f->slope;
    return sine + f->slope - period * floor(sine / period + 0.5);
}

/* The mask (PF05 Eq. (16)): `count` samples at wavenumber q, from sample `first` on. */
static void mask_line(const struct polar_filter *f, const struct aperture *p, int q, int first, int count,
                      complex_real *line)
{
    const struct target_area *area = &f->acquisition->area;
    const double sine = sine_at(f, p, q), cosine = sqrt(fmax(1 - sine * sine, 0));
    for (int k = 0; k < count; k++) {
        const double r = range_at(f, p, first + k);
        if (!(fabs(sine) < 1 && r > 0 && fabs(r * cosine - area->r) < area->half_r
              && fabs(p->x + r * sine - area->x) < area->half_x))
            line[k] = 0;
    }
}

/* A strip of samples of one sub-aperture's polar-format image, in place. */
static void mask_strip(const struct polar_filter *f, const struct aperture *p, int first, int width)
{
    const size_t length = (size_t)f->length, count = (size_t)(p->end - p->begin);
    complex_real *wave = scratch_of(f), *field = f->field + (size_t)p->begin * length + (size_t)first;
    for (size_t i = 0; i < count; i++)
        memcpy(wave + i * STRIP, field + i * length, (size_t)width * sizeof *wave);
    memset(wave + count * STRIP, 0, ((size_t)p->length - count) * STRIP * sizeof *wave);
    FFTW(execute_dft)(p->forward, wave, wave);
    for (int q = 0; q < p->length; q++)
        mask_line(f, p, q, first, width, wave + (size_t)q * STRIP);
    FFTW(execute_dft)(p->inverse, wave, wave);
    for (size_t i = 0; i < count; i++)
        memcpy(field + i * length, wave + i * STRIP, (size_t)width * sizeof *wave);
}

/* ---- the wide band ---- */

static void turn(complex_real *value, double cycles)
{
    real c, s;
    phasor((real)(cycles - floor(cycles + 0.5)), &c, &s);
    *value *= c + s * (complex_real)I;
}

/* Wavenumbers from `first` on, `ratio` times those of the carrier, of the rows about the sub-aperture's middle:
   exponents  first (i - middle) + a (i - middle),  where a i = (a^2 + i^2 - (a - i)^2)/2 makes it a convolution. Onto
   the wavenumbers (sign -1), or back (1). Values in `wave`, which has room for two lines. */
static void chirp(const struct aperture *p, int first, double ratio, int sign, complex_real *wave)
{
    const int rows = p->end - p->begin, from = sign < 0 ? rows : p->lines, onto = sign < 0 ? p->lines : rows;
    const double scale = sign * ratio / p->length, middle = (rows - 1) / 2.0;
    complex_real *kernel = wave + (p->chirp + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    memset(wave + from, 0, (size_t)(p->chirp - from) * sizeof *wave);
    memset(kernel, 0, (size_t)p->chirp * sizeof *kernel);
    for (int n = 1 - from; n < onto; n++) {
        complex_real *value = &kernel[n < 0 ? n + p->chirp : n];
        *value = (real)1 / (real)p->chirp;
        turn(value, -scale * 0.5 * n * (double)n);
    }
    for (int side = 0; side < 2; side++) { /* ahead of the convolution, and behind it */
        const bool along_rows = (side == 0) == (sign < 0);
        for (int n = 0; n < (along_rows ? rows : p->lines); n++)
            turn(&wave[n], scale * (0.5 * n * (double)n + (along_rows ? first * (n - middle) : -middle * n)));
        if (side == 1)
            return;
        FFTW(execute_dft)(p->forward, wave, wave);
        FFTW(execute_dft)(p->forward, kernel, kernel);
        for (int n = 0; n < p->chirp; n++)
            wave[n] *= kernel[n];
        FFTW(execute_dft)(p->inverse, wave, wave);
    }
}

/* A column of one frequency, between the field and the wide image. */
static void chirp_column(const struct polar_filter *f, const struct aperture *p, int first, int k, int sign)
{
    const struct acquisition *a = f->acquisition;
    const size_t length = (size_t)f->length, rows = (size_t)(p->end - p->begin), lines = (size_t)p->lines;
    const double ratio = 1 + (2 * k < f->length ? k : k - f->length) * a->fs / f->length / a->fc;
    const real scale = sign < 0 ? 1 : (real)ratio / ((real)f->length * (real)f->length);
    complex_real *wave = scratch_of(f), *field = f->field + (size_t)p->begin * length + (size_t)k;
    complex_real *wide = f->wide + k, *from = sign < 0 ? field : wide, *onto = sign < 0 ? wide : field;
    for (size_t n = 0; n < (sign < 0 ? rows : lines); n++)
        wave[n] = from[n * length];
    chirp(p, first, ratio, sign, wave);
    for (size_t n = 0; n < (sign < 0 ? lines : rows); n++) {
        const double period = ratio * fabs((double)n - p->lines / 2); /* of wavenumbers, of which one counts */
        onto[n * length] = sign > 0 || 2 * period < p->length ? wave[n] * scale : 0;
    }
}

static void rows_transform(const struct polar_filter *f, const struct aperture *p, FFTW(plan) plan)
{
#pragma omp parallel for schedule(static)
    for (int i = p->begin; i < p->end; i++) {
        complex_real *wave = scratch_of(f), *row = f->field + (size_t)i * (size_t)f->length;
        memcpy(wave, row, (size_t)f->length * sizeof *wave);
        FFTW(execute_dft)(plan, wave, wave);
        memcpy(row, wave, (size_t)f->length * sizeof *wave);
    }
}

/* The mask on an image whose wavenumbers grow with the frequency, so that a target has one place at all of them. */
static void mask_wide(const struct polar_filter *f, const struct aperture *p)
{
    const double step = 2 * M_PI * f->up / f->spacing / (2 * f->kc) / p->length;
    const int first = (int)floor((f->slope - p->sine) / step + 0.5) - p->lines / 2;
    rows_transform(f, p, f->range_forward);
#pragma omp parallel for schedule(static)
    for (int k = 0; k < f->length; k++)
        chirp_column(f, p, first, k, -1);
#pragma omp parallel for schedule(static)
    for (int n = 0; n < p->lines; n++) {
        complex_real *wave = scratch_of(f), *line = f->wide + (size_t)n * (size_t)f->length;
        memcpy(wave, line, (size_t)f->length * sizeof *wave);
        FFTW(execute_dft)(f->range_inverse, wave, wave);
        mask_line(f, p, first + n, 0, f->length, wave);
        FFTW(execute_dft)(f->range_forward, wave, wave);
        memcpy(line, wave, (size_t)f->length * sizeof *wave);
    }
#pragma omp parallel for schedule(static)
    for (int k = 0; k < f->length; k++)
        chirp_column(f, p, first, k, 1);
    rows_transform(f, p, f->range_inverse);
}

static void mask(const struct polar_filter *f, const struct aperture *p)
{
    const int strips = (f->length + STRIP - 1) / STRIP;
#pragma omp parallel for schedule(static)
    for (int i = p->begin; i < p->end; i++) {
        complex_real *wave = scratch_of(f), *row = f->field + (size_t)i * (size_t)f->length;
        memcpy(wave, row, (size_t)f->length * sizeof *wave);
        shift(f, (real *)wave, i, 1, (real)1 / (real)f->length);
        FFTW(execute_dft)(f->range_inverse, wave, wave);
        if (f->curvature)
            curve(f, p, i, 1, (real *)wave);
        memcpy(row, wave, (size_t)f->length * sizeof *wave);
    }
    if (f->is_wide) {
        mask_wide(f, p);
        return;
    }
#pragma omp parallel for schedule(static)
    for (int s = 0; s < strips; s++)
        mask_strip(f, p, s * STRIP, f->length - s * STRIP < STRIP ? f->length - s * STRIP : STRIP);
}

/* A row of the field back to a record; rows between the pings are not needed. */
static void restore(const struct polar_filter *f, const struct aperture *p, complex_real *records)
{
#pragma omp parallel for schedule(static)
    for (int n = p->begin / f->up; n < p->end / f->up; n++) {
        const int row = n * f->up;
        complex_real *wave = scratch_of(f);
        memcpy(wave, f->field + (size_t)row * (size_t)f->length, (size_t)f->length * sizeof *wave);
        if (f->curvature)
            curve(f, p, row, -1, (real *)wave);
        FFTW(execute_dft)(f->range_forward, wave, wave);
        shift(f, (real *)wave, row, -1, (real)1 / ((real)f->length * (real)p->length));
        FFTW(execute_dft)(f->range_inverse, wave, wave);
        memcpy(records + (size_t)n * (size_t)f->samples, wave, (size_t)f->samples * sizeof *wave);
    }
}

void REAL_NAME(polar_filter_apply)(const struct polar_filter *f, complex_real *records)
{
    spectra(f, records);
    if (f->up > 1)
        upsample(f);
    for (int s = 0; s < f->shape.subapertures; s++) {
        mask(f, &f->apertures[s]);
        restore(f, &f->apertures[s], records);
    }
}
