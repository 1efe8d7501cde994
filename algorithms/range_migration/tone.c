/* A target at one frequency (tone.h). */
#include "range_migration/tone.h"

#include <stdlib.h>
#include <string.h>

#include "common/fft_length.h"
#include "range_migration/rma_engine.h"

enum { MOST = 1000000 }; /* receivers times wavenumbers */
static const double GRAZING = 1.005, WIDEST = 1.5;

double azimuth_offset(const struct azimuth *azimuth, int m)
{
    return azimuth->view->problem->acquisition->rx[m].x - azimuth->view->problem->acquisition->tx[0].x;
}

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
static void phasors_fill(const struct azimuth *azimuth, const struct tone *target)
{
    const struct rma_view *view = azimuth->view;
    const int receivers = view->problem->acquisition->receivers;
    for (int k = 0; k < AZIMUTH_ANGLES; k++) {
        const double nu = wavenumber(view, target->frequency, sin((k - AZIMUTH_ANGLES / 2) * azimuth->angle_step));
        const double monostatic = target->r * spectrum_monostatic(&view->setting, target->frequency, nu);
        for (int m = 0; m < receivers; m++) {
            const double d = azimuth_offset(azimuth, m);
            const double phase = view->converts
                                     ? view->method->spectrum(&view->setting, d, target->r, target->frequency, nu)
                                     : -monostatic;
            const double beyond = phase + monostatic - M_PI * nu * d;
            azimuth->phasors[k * receivers + m] = isnan(beyond) ? NAN : turns(-beyond / (2 * M_PI));
        }
    }
}

/* The echoes, and their transform over the pings. */
static void echoes_fill(const struct azimuth *azimuth, const struct tone *target)
{
    const struct rma_view *view = azimuth->view;
    const struct acquisition *a = view->problem->acquisition;
    memset(azimuth->echoes, 0, (size_t)azimuth->wavenumbers * sizeof *azimuth->echoes);
    for (int p = 0; p < a->pings; p++) {
        const double u = view->x_low + p * view->spacing - target->x;
        for (int m = 0; m < a->receivers && condition_amplitude(a, target->r, u) != 0; m++) {
            const double d = azimuth_offset(azimuth, m);
            azimuth->echoes[p * a->receivers + m] =
                condition_pair_amplitude(a, target->r, u, d)
                * turns(-target->frequency * spectrum_delay(&view->setting, d, target->r, u));
        }
    }
    fftw_execute_dft(azimuth->over_pings, azimuth->echoes, azimuth->spectra);
}

/* Does range migration keep the wavenumber? (rma_line) Omega-k keeps all. */
static bool is_kept(const struct azimuth *azimuth, double frequency, double nu)
{
    const struct rma_view *view = azimuth->view;
    if (view->period > 0)
        return true;
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
        const double d = azimuth_offset(azimuth, m);
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
static double complex line_sum(const struct azimuth *azimuth, const struct tone *target, double nu,
                               const double complex *spectra)
{
    const struct rma_view *view = azimuth->view;
    const int receivers = view->problem->acquisition->receivers;
    const double place =
        asin(fmin(fmax(sine_of(view, target->frequency, nu), -1), 1)) / azimuth->angle_step + AZIMUTH_ANGLES / 2;
    const int first = (int)fmin(fmax(floor(place) - 1, 0), AZIMUTH_ANGLES - 4);
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

void azimuth_form(const struct azimuth *azimuth, const struct tone *target)
{
    const struct rma_view *view = azimuth->view;
    const struct spectrum_setting *setting = &view->setting;
    const double c = setting->sound_speed, beta = setting->speed / c, frequency = target->frequency;
    const double f = frequency / ((1 - beta) * (1 + beta)), nu_step = 1 / (azimuth->period * view->spacing);
    const int receivers = view->problem->acquisition->receivers;
    const int first = (int)floor(view->slope * 2 * frequency / c / nu_step + 0.5) - azimuth->wavenumbers / 2;
    echoes_fill(azimuth, target);
    phasors_fill(azimuth, target);
    bool begun = false; /* those that are kept lie next to each other */
    memset(azimuth->wave, 0, (size_t)azimuth->wavenumbers * sizeof *azimuth->wave);
    for (int q = first; q < first + azimuth->wavenumbers; q++) {
        const double nu = q * nu_step, monostatic = spectrum_monostatic(setting, frequency, nu);
        if (isnan(monostatic) || !is_kept(azimuth, frequency, nu))
            continue;
        if (begun)
            turns_next(azimuth);
        else
            turns_begin(azimuth, nu, nu_step);
        begun = true;
        const int place = (q % azimuth->wavenumbers + azimuth->wavenumbers) % azimuth->wavenumbers;
        const int entry = place % azimuth->period;
        const double kappa = c * monostatic / (4 * M_PI);
        const double weight = f * sqrt(c * target->r / (2 * kappa * kappa * kappa)) * nu_step;
        azimuth->wave[place] = weight * turns(0.125 + target->r * monostatic / (2 * M_PI))
                               * line_sum(azimuth, target, nu, azimuth->spectra + (size_t)entry * (size_t)receivers);
    }
    fftw_execute_dft(azimuth->to_columns, azimuth->wave, azimuth->wave);
}

bool azimuth_make(const struct rma_view *view, const struct grid *patch, struct azimuth *azimuth)
{
    const struct acquisition *a = view->problem->acquisition;
    const double last = patch->x_first + (patch->x_count - 1) * patch->x_step;
    const double overhang = fmax(fmax(view->x_low - patch->x_first, last - view->x_high), 0);
    const double farthest = patch->r_first + (patch->r_count - 1) * patch->r_step;
    const double pings =
        view->period > 0 ? view->period : rma_period(a, &view->bounds, view->spacing, farthest, overhang);
    const double widest = atan(rma_focused(a, &view->bounds, patch->r_first) / patch->r_first);
    *azimuth = (struct azimuth){
        .view = view, .nearest = patch->r_first, .angle_step = 2 * fmin(1.05 * widest, WIDEST) / (AZIMUTH_ANGLES - 1)};
    if (!(pings * a->receivers * a->receivers <= MOST))
        return true;
    azimuth->period = fft_length((long long)pings);
    azimuth->wavenumbers = azimuth->period * a->receivers;
    azimuth->echoes = fftw_malloc((size_t)azimuth->wavenumbers * sizeof *azimuth->echoes);
    azimuth->wave = fftw_malloc((size_t)azimuth->wavenumbers * sizeof *azimuth->wave);
    azimuth->spectra = fftw_malloc((size_t)azimuth->wavenumbers * sizeof *azimuth->spectra);
    azimuth->phasors = malloc((size_t)(AZIMUTH_ANGLES * a->receivers) * sizeof *azimuth->phasors);
    azimuth->turns = malloc(2 * (size_t)a->receivers * sizeof *azimuth->turns);
    if (!azimuth->echoes || !azimuth->spectra || !azimuth->wave || !azimuth->phasors || !azimuth->turns)
        return false;
    azimuth->over_pings = fftw_plan_many_dft(1, &azimuth->period, a->receivers, azimuth->echoes, NULL, a->receivers, 1,
                                             azimuth->spectra, NULL, a->receivers, 1, FFTW_FORWARD, FFTW_ESTIMATE);
    azimuth->to_columns =
        fftw_plan_dft_1d(azimuth->wavenumbers, azimuth->wave, azimuth->wave, FFTW_BACKWARD, FFTW_ESTIMATE);
    return azimuth->over_pings && azimuth->to_columns;
}

void azimuth_free(struct azimuth *azimuth)
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
