/* Azimuth of range migration at single frequencies (azimuth.h).

   The echo of a target at (x', r) at the frequency F is  s_pm = a exp(-j 2 pi F tau_m(x_p - x')),  a the beam's
   amplitude. Range migration transforms it over the pings, adds the receivers up and transforms back (rma.h):

       image(x) = sum over nu of  w(F, nu) exp(+j 2 pi nu x) sum over m of  exp(-j phi_m(F, nu)) X_m(nu),

   X_m(nu) periodic in nu as the pings sample it. This is done as it stands, for it costs little at one frequency, and
   compared with back projection,  sum over p and m of  s_pm exp(+j 2 pi F tau_m(x_p - x)).  What goes wrong in
   azimuth is all in it: wavenumbers that the receivers do not sample, what is seen and not focused, the ripple where
   the track ends, what stationary phase drops, the formula's own phase.

   Rows need not be looked at: to a column, a row is a delay, and by Parseval's theorem the energies of all rows are
   those of all frequencies. Targets, rows and frequencies are taken in turn; their energies are summed as those of
   the image. */
#include "range_migration/azimuth.h"

#include <complex.h>
#include <fftw3.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/fft_length.h"
#include "range_migration/engine.h"

enum {
    TARGETS = 4,   /* of an image, on several rows of several patches where it has them */
    COLUMNS = 13,  /* evenly over the patch, and as many near the target */
    ANGLES = 33,   /* at which the formula's phase is computed, cubics between */
    MOST = 1000000 /* receivers times wavenumbers */
};
static const double FREQUENCY = 0.57735; /* of half the band, to either side: Gauss and Legendre's two */
static const double NEAR = 4, DEEP = 0.05, APART = 1.4, GRAZING = 1.005, WIDEST = 1.5;

/* What a patch's targets share. */
struct azimuth {
    const struct rma_view *view;
    double nearest;                   /* m: of the rows */
    int period;                       /* pings and zeros after them; 0: too many */
    int wavenumbers;                  /* period x receivers */
    double complex *echoes, *spectra; /* [period][receivers] of one target, and their transform over the pings */
    double complex *wave;             /* [wavenumbers], then columns spacing/receivers apart from the first ping on */
    double angle_step;                /* rad: of ANGLES about broadside, as far as the transforms follow */
    double complex *phasors;          /* [ANGLES][receivers] */
    double complex *turns; /* [2][receivers]: exp(-j pi nu d) of one wavenumber, and of the step to the next */
    fftw_plan over_pings, to_columns;
};

/* A target, and its share of the image. */
struct target {
    const struct grid *patch;
    double r, x, frequency, weight;
};

struct energies {
    double image, formed; /* of the exact image, and of range migration's */
    double complex product;
};

static double complex turns(double cycles)
{
    const double angle = 2 * M_PI * (cycles - floor(cycles));
    return cos(angle) + I * sin(angle);
}

/* Without C's own care for infinities. */
static inline double complex product(double complex a, double complex b)
{
    return creal(a) * creal(b) - cimag(a) * cimag(b) + I * (creal(a) * cimag(b) + cimag(a) * creal(b));
}

static double offset_of(const struct azimuth *azimuth, int m)
{
    return azimuth->view->problem->acquisition->rx[m].x - azimuth->view->problem->acquisition->tx[0].x;
}

/* ---- the targets ---- */

static int rows_of(const struct grid *patch)
{
    const double near = patch->r_first, far = near + (patch->r_count - 1) * patch->r_step;
    return far - near > DEEP * near ? (int)fmin(2 + log(far / near) / log(APART), TARGETS) : 1;
}

/* Those of the k-th of `patches`, evenly over its columns, on rows that each stand for a part of its depth; as many at
   one frequency as at the other. */
static int patch_targets(const struct rma_view *view, const struct grid *patch, int k, int patches,
                         struct target list[TARGETS])
{
    const struct acquisition *a = view->problem->acquisition;
    const double near = patch->r_first - patch->r_step / 2, far = near + patch->r_count * patch->r_step;
    const double from = fmax(near, 0.5 * patch->r_first), width = patch->x_count * patch->x_step;
    const int rows = (int)fmin(rows_of(patch), TARGETS / patches), count = TARGETS / patches / rows * rows;
    for (int n = 0; n < count; n++) {
        const int row = n % rows, turn = patches > 1 ? k : n;
        const double low = from * pow(far / from, (double)row / rows);
        const double high = from * pow(far / from, (row + 1.0) / rows);
        const double place = fmod(0.125 + turn * 0.618, 1); /* of the width: as even as any number of them may be */
        list[n] = (struct target){.patch = patch,
                                  .r = (low + high) / 2,
                                  .x = patch->x_first - patch->x_step / 2 + place * width,
                                  .frequency = a->fc + (turn / 2 + turn) % 2 * FREQUENCY * a->bandwidth
                                               - FREQUENCY * a->bandwidth / 2,
                                  .weight = (high - low) * width};
    }
    return count;
}

/* ---- one target ---- */

/* nu (cycles/m) at the sine of the angle off broadside of the monostatic spectrum, and back. */
static double wavenumber(const struct rma_view *view, double frequency, double sine)
{
    const double c = view->setting.sound_speed, beta = view->setting.speed / c;
    return (sine - beta) * frequency / ((1 - beta) * (1 + beta)) * 2 / c;
}

static double sine_of(const struct rma_view *view, double frequency, double nu)
{
    const double c = view->setting.sound_speed, beta = view->setting.speed / c;
    return c * nu / 2 / (frequency / ((1 - beta) * (1 + beta))) + beta;
}

/* exp(-j (phi + r K - pi nu d)): what a formula has beyond the phase centres varies slowly. NAN where it ends. */
static void phasors_fill(const struct azimuth *azimuth, const struct target *target)
{
    const struct rma_view *view = azimuth->view;
    const int receivers = view->problem->acquisition->receivers;
    for (int k = 0; k < ANGLES; k++) {
        const double nu = wavenumber(view, target->frequency, sin((k - ANGLES / 2) * azimuth->angle_step));
        const double monostatic = target->r * spectrum_monostatic(&view->setting, target->frequency, nu);
        for (int m = 0; m < receivers; m++) {
            const double d = offset_of(azimuth, m);
            const double phase = view->converts
                                     ? view->method->spectrum(&view->setting, d, target->r, target->frequency, nu)
                                     : -monostatic;
            const double beyond = phase + monostatic - M_PI * nu * d;
            azimuth->phasors[k * receivers + m] = isnan(beyond) ? NAN : turns(-beyond / (2 * M_PI));
        }
    }
}

/* The echoes, and their transform over the pings. */
static void echoes_fill(const struct azimuth *azimuth, const struct target *target)
{
    const struct rma_view *view = azimuth->view;
    const struct acquisition *a = view->problem->acquisition;
    memset(azimuth->echoes, 0, (size_t)azimuth->wavenumbers * sizeof *azimuth->echoes);
    for (int p = 0; p < a->pings; p++) {
        const double u = view->x_low + p * view->spacing - target->x;
        for (int m = 0; m < a->receivers && condition_amplitude(a, target->r, u) != 0; m++) {
            const double d = offset_of(azimuth, m);
            azimuth->echoes[p * a->receivers + m] =
                condition_pair_amplitude(a, target->r, u, d)
                * turns(-target->frequency * spectrum_delay(&view->setting, d, target->r, u));
        }
    }
    fftw_execute_dft(azimuth->over_pings, azimuth->echoes, azimuth->spectra);
}

/* Does range migration keep the wavenumber? (rma_line) */
static bool is_kept(const struct azimuth *azimuth, double frequency, double nu)
{
    const struct rma_view *view = azimuth->view;
    const struct acquisition *a = view->problem->acquisition;
    const double c = view->setting.sound_speed, beta = view->setting.speed / c;
    const double sine = sine_of(view, a->fc, nu), edge = fmax(nu > 0 ? 1 + beta : 1 - beta, 1);
    if (!(frequency > GRAZING * edge * c * fabs(nu) / 2) || !(fabs(sine) < 1))
        return false;
    return azimuth->nearest * fabs(sine) / sqrt((1 - sine) * (1 + sine))
           <= rma_focused(a, &view->bounds, azimuth->nearest);
}

/* The receivers' phase centres at the first wavenumber that is kept, and at the next one. */
static void turns_begin(const struct azimuth *azimuth, double nu, double nu_step)
{
    const int receivers = azimuth->view->problem->acquisition->receivers;
    for (int m = 0; m < receivers; m++) {
        const double d = offset_of(azimuth, m);
        azimuth->turns[m] = turns(-nu * d / 2);
        azimuth->turns[receivers + m] = turns(-nu_step * d / 2);
    }
}

static void turns_next(const struct azimuth *azimuth)
{
    const int receivers = azimuth->view->problem->acquisition->receivers;
    for (int m = 0; m < receivers; m++)
        azimuth->turns[m] = product(azimuth->turns[m], azimuth->turns[receivers + m]);
}

/* One wavenumber: the receivers' sum. */
static double complex line_sum(const struct azimuth *azimuth, const struct target *target, double nu,
                               const double complex *spectra)
{
    const struct rma_view *view = azimuth->view;
    const int receivers = view->problem->acquisition->receivers;
    const double place =
        asin(fmin(fmax(sine_of(view, target->frequency, nu), -1), 1)) / azimuth->angle_step + ANGLES / 2;
    const int first = (int)fmin(fmax(floor(place) - 1, 0), ANGLES - 4);
    const double u = place - first - 1;
    const double w0 = -u * (u - 1) * (u - 2) / 6, w1 = (u + 1) * (u - 1) * (u - 2) / 2;
    const double w2 = -(u + 1) * u * (u - 2) / 2, w3 = (u + 1) * u * (u - 1) / 6;
    const double complex *a = azimuth->phasors + (size_t)first * (size_t)receivers, *b = a + receivers,
                         *c = b + receivers;
    const double complex *d = c + receivers;
    double complex sum = 0;
    for (int m = 0; m < receivers; m++) {
        const double pr = w0 * creal(a[m]) + w1 * creal(b[m]) + w2 * creal(c[m]) + w3 * creal(d[m]);
        const double pi = w0 * cimag(a[m]) + w1 * cimag(b[m]) + w2 * cimag(c[m]) + w3 * cimag(d[m]);
        if (!isnan(pr))
            sum += product(product(pr + I * pi, azimuth->turns[m]), spectra[m]);
    }
    return sum;
}

/* Range migration's image, columns spacing/receivers apart from the first ping on. */
static void image_form(const struct azimuth *azimuth, const struct target *target)
{
    const struct rma_view *view = azimuth->view;
    const struct spectrum_setting *setting = &view->setting;
    const double c = setting->sound_speed, beta = setting->speed / c, frequency = target->frequency;
    const double f = frequency / ((1 - beta) * (1 + beta)), nu_step = 1 / (azimuth->period * view->spacing);
    const int half = azimuth->wavenumbers / 2, receivers = view->problem->acquisition->receivers;
    echoes_fill(azimuth, target);
    phasors_fill(azimuth, target);
    bool begun = false; /* those that are kept lie next to each other */
    memset(azimuth->wave, 0, (size_t)azimuth->wavenumbers * sizeof *azimuth->wave);
    for (int q = -half; q < azimuth->wavenumbers - half; q++) {
        const double nu = q * nu_step, monostatic = spectrum_monostatic(setting, frequency, nu);
        if (isnan(monostatic) || !is_kept(azimuth, frequency, nu))
            continue;
        if (begun)
            turns_next(azimuth);
        else
            turns_begin(azimuth, nu, nu_step);
        begun = true;
        const int entry = (q % azimuth->period + azimuth->period) % azimuth->period;
        const double kappa = c * monostatic / (4 * M_PI);
        const double weight = f * sqrt(c * target->r / (2 * kappa * kappa * kappa)) * nu_step;
        azimuth->wave[q < 0 ? q + azimuth->wavenumbers : q] =
            weight * turns(0.125 + target->r * monostatic / (2 * M_PI))
            * line_sum(azimuth, target, nu, azimuth->spectra + (size_t)entry * (size_t)receivers);
    }
    fftw_execute_dft(azimuth->to_columns, azimuth->wave, azimuth->wave);
}

/* Back projection at column x, and the share of its energy that lies on the patch's rows for targets on any of them: an
   echo that is late there belongs to another row. */
static double complex back_projection(const struct azimuth *azimuth, const struct target *target, double x,
                                      double *share)
{
    const struct rma_view *view = azimuth->view;
    const struct acquisition *a = view->problem->acquisition;
    const double deep = 2 / a->sound_speed * target->patch->r_count * target->patch->r_step + 1 / a->bandwidth; /* s */
    double complex sum = 0;
    double all = 0, inside = 0;
    for (int p = 0; p < a->pings; p++) {
        const double at = view->x_low + p * view->spacing - x, u = at + x - target->x;
        const double seen = condition_amplitude(a, target->r, u);
        if (seen == 0)
            continue;
        const double beside =
            spectrum_delay(&view->setting, 0, target->r, at) - spectrum_delay(&view->setting, 0, target->r, u);
        all += seen * seen;
        inside += seen * seen * fmax(1 - fabs(beside) / deep, 0);
        if (fabs(at) > a->aperture_limit * hypot(at, target->r))
            continue;
        for (int m = 0; m < a->receivers; m++) {
            const double d = offset_of(azimuth, m);
            sum += product(azimuth->echoes[p * a->receivers + m],
                           turns(target->frequency * spectrum_delay(&view->setting, d, target->r, at)));
        }
    }
    *share = all > 0 ? inside / all : 0;
    return sum;
}

static void column_add(const struct azimuth *azimuth, const struct target *target, double x, double weight,
                       struct energies *energies)
{
    const struct rma_view *view = azimuth->view;
    const double step = view->spacing / view->problem->acquisition->receivers;
    const double n = floor((x - view->x_low) / step + 0.5), wraps = floor(n / azimuth->wavenumbers);
    double share;
    const double complex exact = back_projection(azimuth, target, view->x_low + n * step, &share);
    weight *= share;
    const double complex formed = azimuth->wave[(int)(n - wraps * azimuth->wavenumbers)];
    energies->image += weight * creal(exact * conj(exact));
    energies->formed += weight * creal(formed * conj(formed));
    energies->product += weight * formed * conj(exact);
}

/* Evenly over the patch's columns, and more of them about the target. */
static void target_add(const struct azimuth *azimuth, const struct target *target, struct energies *energies)
{
    const struct rma_view *view = azimuth->view;
    const struct acquisition *a = view->problem->acquisition;
    const struct grid *patch = target->patch;
    const double width = patch->x_count * patch->x_step, first = patch->x_first - patch->x_step / 2;
    const double wavelength = a->sound_speed / a->fc;
    const double resolution = fmax(wavelength / (4 * fmin(condition_seen_sine(a), 1)),
                                   wavelength * target->r / 2 / (view->x_high - view->x_low + view->spacing));
    const double near = fmin(NEAR * resolution, width), step = 2 * near / COLUMNS, beside = width / COLUMNS;
    image_form(azimuth, target);
    for (int k = 0; k < COLUMNS; k++) {
        const double close = target->x + (k - COLUMNS / 2) * step, column = first + (k + 0.5) * beside;
        if (close >= first && close <= first + width)
            column_add(azimuth, target, close, target->weight * step, energies);
        if (fabs(column - target->x) > near)
            column_add(azimuth, target, column, target->weight * beside, energies);
    }
}

/* ---- all of them ---- */

/* False without memory; azimuth_free in any case. */
static bool azimuth_make(const struct rma_view *view, const struct grid *patch, struct azimuth *azimuth)
{
    const struct acquisition *a = view->problem->acquisition;
    const double last = patch->x_first + (patch->x_count - 1) * patch->x_step;
    const double overhang = fmax(fmax(view->x_low - patch->x_first, last - view->x_high), 0);
    const double farthest = patch->r_first + (patch->r_count - 1) * patch->r_step;
    const double pings = rma_period(a, &view->bounds, view->spacing, farthest, overhang);
    const double widest = atan(rma_focused(a, &view->bounds, patch->r_first) / patch->r_first);
    *azimuth = (struct azimuth){
        .view = view, .nearest = patch->r_first, .angle_step = 2 * fmin(1.05 * widest, WIDEST) / (ANGLES - 1)};
    if (!(pings * a->receivers * a->receivers <= MOST))
        return true;
    azimuth->period = fft_length((long long)pings);
    azimuth->wavenumbers = azimuth->period * a->receivers;
    azimuth->echoes = fftw_malloc((size_t)azimuth->wavenumbers * sizeof *azimuth->echoes);
    azimuth->wave = fftw_malloc((size_t)azimuth->wavenumbers * sizeof *azimuth->wave);
    azimuth->spectra = fftw_malloc((size_t)azimuth->wavenumbers * sizeof *azimuth->spectra);
    azimuth->phasors = malloc((size_t)(ANGLES * a->receivers) * sizeof *azimuth->phasors);
    azimuth->turns = malloc(2 * (size_t)a->receivers * sizeof *azimuth->turns);
    if (!azimuth->echoes || !azimuth->spectra || !azimuth->wave || !azimuth->phasors || !azimuth->turns)
        return false;
    azimuth->over_pings = fftw_plan_many_dft(1, &azimuth->period, a->receivers, azimuth->echoes, NULL, a->receivers, 1,
                                             azimuth->spectra, NULL, a->receivers, 1, FFTW_FORWARD, FFTW_ESTIMATE);
    azimuth->to_columns =
        fftw_plan_dft_1d(azimuth->wavenumbers, azimuth->wave, azimuth->wave, FFTW_BACKWARD, FFTW_ESTIMATE);
    return azimuth->over_pings && azimuth->to_columns;
}

static void azimuth_free(struct azimuth *azimuth)
{
    if (azimuth->over_pings)
        fftw_destroy_plan(azimuth->over_pings);
    if (azimuth->to_columns)
        fftw_destroy_plan(azimuth->to_columns);
    fftw_free(azimuth->echoes);
    fftw_free(azimuth->wave);
    fftw_free(azimuth->spectra);
    free(azimuth->phasors);
    free(azimuth->turns);
}

/* Of the k-th of `patches` that stand for all; false without memory. */
static bool patch_add(const struct rma_view *view, int k, int patches, struct energies *energies)
{
    const struct grid *patch = &view->problem->patches[(long long)k * view->problem->patch_count / patches];
    struct target list[TARGETS];
    struct azimuth azimuth;
    const int count = patch_targets(view, patch, k, patches, list);
    const bool made = azimuth_make(view, patch, &azimuth);
    for (int n = 0; n < count && made && azimuth.period > 0; n++)
        target_add(&azimuth, &list[n], energies);
    azimuth_free(&azimuth);
    return made;
}

double azimuth_error(const struct rma_view *view)
{
    const int patches = view->problem->patch_count < TARGETS ? view->problem->patch_count : TARGETS;
    struct energies sum = {0, 0, 0};
    for (int k = 0; k < patches; k++)
        if (!patch_add(view, k, patches, &sum))
            return NAN;
    if (!(sum.image > 0 && sum.formed > 0))
        return INFINITY;
    return sqrt(fmax(1 - creal(sum.product * conj(sum.product)) / sum.image / sum.formed, 0));
}
