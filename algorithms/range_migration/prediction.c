/* Prediction of an image's error (rma_conditions.h).

   Back projection multiplies the echo of receiver m, u metres ahead of the pixel, by exp(j 2 pi F tau_m(u)). Range
   migration replaces this factor (rma.h) by

       h_m(u) = integral over |nu| <= M/(2 spacing) of  w(F, nu) exp(-j (phi_m(F, nu) + 2 pi nu u)),

   whose relative error e_m(u) = h_m(u) exp(-j 2 pi F tau_m(u)) - 1 contains all errors in azimuth: wavenumbers that the
   receivers do not sample, the ripple where they end, the terms neglected by stationary phase, the amplitude of a
   monostatic sonar, the formula's own phase. An FFT over nu gives e_m for all u at once. The slice through a target is

       sum over pings and receivers of  a sinc(B dtau) exp(j 2 pi fc dtau),

   dtau the difference of the delays of pixel and target and a the beam's amplitude; its error is the same sum with e_m.
   Energies are summed over the slices of some targets, and errors over some frequencies. A small number of pings and
   receivers represents all. */
#include "range_migration/rma_conditions.h"

#include <complex.h>
#include <fftw3.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/fft_length.h"
#include "common/turns.h"

enum {
    TARGETS = 3,      /* on a row */
    COLUMNS = 17,     /* of a slice: evenly over the patch, and as many near the target */
    PINGS = 512,      /* that are summed, at most: with a wide beam, fewer than see a target alias */
    RECEIVERS = 12,   /* that are summed, at most */
    TABLES = 5,       /* receivers whose errors are tabulated: each represents those nearest to it */
    FREQUENCIES = 3,  /* of the band: Gauss and Legendre's */
    FINER = 3,        /* places of a table for each independent one */
    ROWS = 8,         /* of a patch, at most */
    LONGEST = 1 << 14 /* wavenumbers; places that need more are left out */
};
static const double abscissas[FREQUENCIES] = {-0.7745966692414834, 0, 0.7745966692414834};
static const double weights[FREQUENCIES] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
static const double FRESNEL_ZONES = 6; /* beside the places asked for, over which the kernel tapers */
static const double SPARE = 1.1;       /* of the tables' period, so that fading ends do not overlap */
static const double NEAR = 4;          /* resolutions: columns near a target */
static const double DEEP = 0.05;       /* of their range: deeper patches use both their first and last row */
static const double APART = 1.4;       /* ratio of two rows' ranges, beyond which one between them is used, too */

/* Errors e of the kernel at one row, at places `step` apart. */
struct kernel {
    const struct rma_view *view;
    double r;              /* m */
    double axis, centroid; /* m: place from which the row lies on the beam's axis; fc times the delay's slope there */
    double reach, margin;  /* m: the places asked for, on either side of the axis; beside them it tapers */
    int count;             /* wavenumbers: k nu_step off the centroid, k = -count/2 ... count/2 */
    double nu_step;        /* cycles/m */
    int length;            /* of a table: places from axis - length/2 step on */
    double step;           /* m */
    double offset[TABLES]; /* m: of the receivers */
    double complex *error; /* [TABLES][FREQUENCIES][length]: the axis first, then places ahead, then those behind */
    fftw_plan transform;
};

static double offset_of(const struct rma_view *view, int receiver)
{
    return view->problem->acquisition->rx[receiver].x - view->problem->acquisition->tx[0].x;
}

/* The k-th of `count` receivers that represent all. */
static int receiver_of(const struct rma_view *view, int k, int count)
{
    return count > 1 ? (int)((long long)k * (view->problem->acquisition->receivers - 1) / (count - 1)) : 0;
}

/* Kept share of the kernel with its stationary point u ahead of the pixel. */
static double taper(const struct kernel *kernel, double u)
{
    double beyond = (fabs(u - kernel->axis) - kernel->reach) / kernel->margin;
    return beyond <= 0.5 ? 1 : beyond < 1 ? 0.5 - 0.5 * cos(2 * M_PI * beyond) : 0;
}

/* Does the method focus echoes seen from a place? */
static bool is_focused(const struct kernel *kernel, double place)
{
    const struct rma_view *view = kernel->view;
    const double squint = view->problem->acquisition->echo_squint, r = kernel->r;
    if (squint == 0)
        return fabs(place) <= rma_focused(view->problem->acquisition, &view->bounds, r);
    return fabs(place * cos(squint) + r * sin(squint)) <= view->bounds.sine * hypot(place, r);
}

/* h of a receiver at offset d and one frequency, without the centroid's own turns. */
static void kernel_transform(const struct kernel *kernel, double d, double frequency, double complex *wave)
{
    const struct rma_view *view = kernel->view;
    const struct spectrum_setting *setting = &view->setting;
    const double c = setting->sound_speed, r = kernel->r, beta = setting->speed / c;
    const double f = frequency / ((1 - beta) * (1 + beta)), centroid = -kernel->centroid * frequency / setting->fc;
    memset(wave, 0, (size_t)kernel->length * sizeof *wave);
    for (int k = -kernel->count / 2; k <= kernel->count / 2; k++) {
        double nu = centroid + k * kernel->nu_step, monostatic = spectrum_monostatic(setting, frequency, nu);
        if (isnan(monostatic))
            continue; /* evanescent */
        double kappa = c * monostatic / (4 * M_PI), place = -r * (c * nu / 2 + f * beta) / kappa;
        if (!is_focused(kernel, place))
            continue;
        double phase = view->converts ? view->method->spectrum(setting, d, r, frequency, nu) : -r * monostatic;
        double weight = f * sqrt(c * r / (2 * kappa * kappa * kappa)) * kernel->nu_step * taper(kernel, place - d / 2);
        if (weight > 0 && !isnan(phase))
            wave[k < 0 ? kernel->length + k : k] = (2 * abs(k) == kernel->count ? 0.5 : 1) * weight
                                                   * turns(0.125 - phase / (2 * M_PI) - nu * kernel->axis);
    }
    fftw_execute_dft(kernel->transform, wave, wave);
}

static double complex *table_at(const struct kernel *kernel, int table, int n)
{
    return kernel->error + (size_t)(table * FREQUENCIES + n) * (size_t)kernel->length;
}

/* e of a table at all frequencies: the two beside the carrier turn by equal amounts more and less. */
static void table_fill(const struct kernel *kernel, int table)
{
    const struct acquisition *a = kernel->view->problem->acquisition;
    const double d = kernel->offset[table], beside = abscissas[FREQUENCIES - 1] * a->bandwidth / 2;
    double complex *low = table_at(kernel, table, 0), *middle = table_at(kernel, table, 1);
    double complex *high = table_at(kernel, table, 2);
    for (int n = 0; n < FREQUENCIES; n++)
        kernel_transform(kernel, d, a->fc + abscissas[n] * a->bandwidth / 2, table_at(kernel, table, n));
    for (int i = 0; i < kernel->length; i++) {
        const double place = (i < kernel->length - kernel->length / 2 ? i : i - kernel->length) * kernel->step;
        const double delay = spectrum_delay(&kernel->view->setting, d, kernel->r, kernel->axis + place);
        const double late = delay - kernel->centroid / a->fc * place;
        const double complex turn = turns(-a->fc * late), more = turns(-beside * late);
        low[i] = low[i] * (turn * conj(more)) - 1;
        middle[i] = middle[i] * turn - 1;
        high[i] = high[i] * (turn * more) - 1;
    }
}

static bool table_repeats(const struct kernel *kernel, int table)
{
    return table > 0 && kernel->offset[table] == kernel->offset[table - 1];
}

/* Tables of all offsets; one that repeats is copied. */
static void tables_fill(const struct kernel *kernel)
{
#pragma omp parallel for schedule(dynamic)
    for (int t = 0; t < TABLES; t++)
        if (!table_repeats(kernel, t))
            table_fill(kernel, t);
    const size_t size = (size_t)kernel->length * FREQUENCIES;
    for (int t = 0; t < TABLES; t++)
        if (table_repeats(kernel, t))
            memcpy(table_at(kernel, t, 0), table_at(kernel, t - 1, 0), size * sizeof *kernel->error);
}

static void kernel_free(struct kernel *kernel)
{
    if (kernel->transform)
        fftw_destroy_plan(kernel->transform);
    fftw_free(kernel->error);
}

/* Azimuth wavenumbers, cycles/m, within which places up to `far` on either side of the axis lie. */
static double band_of(const struct kernel *kernel, double far)
{
    const struct acquisition *a = kernel->view->problem->acquisition;
    const double highest = a->fc + a->bandwidth / 2, beta = fabs(kernel->view->setting.speed) / a->sound_speed;
    if (kernel->axis == 0) /* bounded, whatever the offset */
        return 4 * highest / a->sound_speed / (1 - beta) * fmin(1, far / hypot(far, kernel->r) + 2 * beta);
    double half = 0, slope = spectrum_slope(&kernel->view->setting, 0, kernel->r, kernel->axis);
    for (int side = -1; side <= 1; side += 2)
        half =
            fmax(half, fabs(spectrum_slope(&kernel->view->setting, 0, kernel->r, kernel->axis + side * far) - slope));
    return 2 * highest * half;
}

/* At range r, for places up to `reach` on either side of the axis. False without memory; freed with kernel_free in any
   case. */
static bool kernel_make(const struct rma_view *view, double r, double reach, struct kernel *kernel)
{
    const struct acquisition *a = view->problem->acquisition;
    const double c = a->sound_speed, lowest = a->fc - a->bandwidth / 2, cosine = cos(a->echo_squint);
    const double margin = FRESNEL_ZONES * sqrt(c / lowest * r / cosine / 2) / cosine;
    double far =
        reach + margin + view->bounds.aside; /* the angle to there, and the speed's part, bound the wavenumbers */
    *kernel = (struct kernel){.view = view, .r = r, .reach = reach, .margin = margin};
    if (a->echo_squint != 0) {
        kernel->axis = -r * tan(a->echo_squint);
        kernel->centroid = a->fc * spectrum_slope(&view->setting, 0, r, kernel->axis);
    }
    double band = fmin(a->receivers / view->spacing, band_of(kernel, far));
    int count = (int)fmin(ceil(band * 2 * SPARE * far), LONGEST);
    kernel->count = count + count % 2;
    kernel->length = fft_length_fast(FINER * ((long long)kernel->count + 2));
    kernel->nu_step = fmax(band / kernel->count, 0);
    kernel->step = 1 / (kernel->nu_step * kernel->length);
    kernel->error = fftw_malloc(TABLES * FREQUENCIES * (size_t)kernel->length * sizeof *kernel->error);
    if (!kernel->error)
        return false;
    kernel->transform = fftw_plan_dft_1d(kernel->length, kernel->error, kernel->error, FFTW_FORWARD, FFTW_ESTIMATE);
    if (!kernel->transform)
        return false;
    for (int t = 0; t < TABLES; t++)
        kernel->offset[t] = offset_of(view, receiver_of(view, t, TABLES));
    tables_fill(kernel);
    return true;
}

/* e at the first frequency, those of the others a table's length behind each other; NULL where the tables do not
   reach. */
static const double complex *kernel_error(const struct kernel *kernel, double d, double u)
{
    int table = 0;
    for (int t = 1; t < TABLES; t++)
        table = fabs(kernel->offset[t] - d) < fabs(kernel->offset[table] - d) ? t : table;
    const double place = floor((u - kernel->axis) / kernel->step + 0.5), behind = kernel->length / 2;
    if (!(place >= -behind && place < kernel->length - behind))
        return NULL;
    return table_at(kernel, table, 0) + (size_t)(place < 0 ? place + kernel->length : place);
}

/* Energies of an image and of its error. */
struct energies {
    double image, error;
};

/* A target, and pings that represent those that see it. */
struct sight {
    double x;                /* m */
    int first, count, every; /* pings */
};

static void pixel_add(const struct kernel *kernel, const struct sight *target, double x, double weight,
                      struct energies *energies)
{
    const struct rma_view *view = kernel->view;
    const struct acquisition *a = view->problem->acquisition;
    const int receivers = a->receivers < RECEIVERS ? a->receivers : RECEIVERS;
    double complex image = 0, errors[FREQUENCIES] = {0};
    for (int p = target->first; p < target->first + target->count; p += target->every) {
        double u = a->tx[p].x - target->x, at = a->tx[p].x - x, seen = condition_amplitude(a, kernel->r, u);
        /* Range migration also images pairs that back projection leaves out: there its whole kernel is error. */
        bool summed = !(fabs(at * cos(a->echo_squint) + kernel->r * sin(a->echo_squint))
                        > a->aperture_limit * hypot(at, kernel->r));
        for (int k = 0; k < receivers && seen != 0; k++) {
            double d = offset_of(view, receiver_of(view, k, receivers));
            const double complex *error = kernel_error(kernel, d, at);
            if (!error)
                continue;
            double late =
                spectrum_delay(&view->setting, d, kernel->r, at) - spectrum_delay(&view->setting, d, kernel->r, u);
            double cycles = a->fc * late;
            double complex pair = seen * condition_sinc(a->bandwidth * late) * turns(cycles);
            image += summed ? pair : 0;
            for (int n = 0; n < FREQUENCIES; n++)
                errors[n] += pair * (error[(size_t)n * (size_t)kernel->length] + (summed ? 0 : 1));
        }
    }
    energies->image += weight * creal(image * conj(image));
    for (int n = 0; n < FREQUENCIES; n++)
        energies->error += weight * weights[n] * creal(errors[n] * conj(errors[n]));
}

/* The slice through a target at column x of a row. */
static void slice_add(const struct kernel *kernel, const struct grid *row, double x, struct energies *energies)
{
    const struct rma_view *view = kernel->view;
    const struct acquisition *a = view->problem->acquisition;
    const double width = (row->x_count - 1) * row->x_step, wavelength = a->sound_speed / a->fc;
    struct sight target = {x, 0, 0, 1};
    for (int p = a->pings - 1; p >= 0; p--)
        if (condition_amplitude(a, kernel->r, a->tx[p].x - x) != 0) {
            target.count = target.count > 0 ? target.count + target.first - p : 1;
            target.first = p;
        }
    if (target.count == 0)
        return;
    target.every = (target.count + PINGS - 1) / PINGS;
    if (!(width > 0)) {
        pixel_add(kernel, &target, x, 1, energies);
        return;
    }
    double resolution = fmax(wavelength / (4 * fmin(condition_seen_sine(view->problem->acquisition), 1)),
                             wavelength * kernel->r / 2 / (view->x_high - view->x_low + view->spacing));
    double near = fmin(NEAR * resolution, width), near_step = 2 * near / (COLUMNS - 1), step = width / (COLUMNS - 1);
    for (int k = 0; k < COLUMNS; k++) {
        double beside = (k - COLUMNS / 2) * near_step, column = row->x_first + k * step;
        if (x + beside >= row->x_first - row->x_step / 2 && x + beside <= row->x_first + width + row->x_step / 2)
            pixel_add(kernel, &target, x + beside, near_step, energies);
        if (fabs(column - x) > near + near_step / 2)
            pixel_add(kernel, &target, column, step, energies);
    }
}

/* Row i of a patch, along the track in any case: the columns of a turned row lie as close as their places along it. */
static struct grid row_of(const struct grid *patch, double i)
{
    const double cosine = cos(patch->angle_rad), half = (patch->x_count - 1) / 2.0;
    const struct vector middle = grid_point(patch, i, half);
    return (struct grid){.x_first = middle.x - half * patch->x_step * cosine,
                         .x_step = patch->x_step * cosine,
                         .x_count = patch->x_count,
                         .r_first = middle.y,
                         .r_count = 1};
}

/* The greatest distance off the axis from which pings see a row: by the beam, or by the places of pings and columns. */
static double row_reach(const struct rma_view *view, const struct grid *row)
{
    const double r = row->r_first, width = (row->x_count - 1) * row->x_step,
                 squint = view->problem->acquisition->echo_squint;
    const double sine = condition_seen_sine(view->problem->acquisition), axis = -r * tan(squint);
    double reach = fmax(row->x_first + width - view->x_low + axis, view->x_high - row->x_first - axis);
    const double edge = fabs(squint) + asin(fmin(sine, 1));
    return edge < M_PI / 2 ? fmin(reach, width + r * (tan(edge) - tan(fabs(squint)))) : reach;
}

/* Error over image, negative where no ping sees anything, NAN without memory. */
static double row_error(const struct rma_view *view, const struct grid *row)
{
    const double width = (row->x_count - 1) * row->x_step;
    struct kernel kernel;
    struct energies energies = {0, 0};
    bool made = kernel_make(view, row->r_first, fmax(row_reach(view, row), 0), &kernel);
    for (int t = 0; t < (width > 0 ? TARGETS : 1) && made; t++)
        slice_add(&kernel, row, row->x_first + t * width / (TARGETS - 1), &energies);
    kernel_free(&kernel);
    return !made ? NAN : energies.image > 0 ? sqrt(energies.error / energies.image) : -1;
}

double prediction_error(const struct rma_view *view)
{
    const struct acquisition *a = view->problem->acquisition;
    double worst = -1;
    if (!(a->fc > a->bandwidth / 2))
        return INFINITY;
    for (int k = 0; k < view->problem->patch_count; k++) {
        const struct grid *patch = &view->problem->patches[k];
        const double last = patch->r_count - 1;
        const double near = row_of(patch, 0).r_first, far = row_of(patch, last).r_first;
        const int gaps = far - near > DEEP * near ? (int)fmin(1 + log(far / near) / log(APART), ROWS - 1) : 0;
        for (int n = 0; n <= gaps; n++) {
            double r = gaps > 0 ? near * pow(far / near, (double)n / gaps) : (near + far) / 2;
            struct grid row = row_of(patch, far > near ? (r - near) / (far - near) * last : 0);
            double error = row_error(view, &row);
            worst = condition_worse(worst, error);
        }
    }
    return worst < 0 ? INFINITY : worst;
}
