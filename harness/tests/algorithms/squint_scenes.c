#include "tests/algorithms/squint_scenes.h"

#include <fftw3.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contract/delay.h"
#include "scene/simulate.h"

const struct squint_sonar sonar_sq18 = {150e3, 25e3, 20e3, 0.2, -5.12, 1024, 988, 256, 0},
                          sonar_pf05 = {100e3, 12.5e3, 10e3, 0.16, -6.86, 640, 180, 344, 0};

static void scene_make(const struct squint_sonar *sonar, double squint, struct scene *scene)
{
    const double half_wave = 1500 / sonar->fc / (2 * sonar->length); /* the beam ends there: an angle, in radians */
    *scene = (struct scene){.pulse_kind = PULSE_FLAT,
                            .beam = {BEAM_RECT, TRUNCATION_TX, sin(half_wave) / (2 * half_wave), false}};
    struct acquisition *a = &scene->acquisition;
    *a = (struct acquisition){.sound_speed = 1500,
                              .fc = sonar->fc,
                              .fs = sonar->fs,
                              .bandwidth = sonar->bandwidth,
                              .samples = sonar->samples,
                              .receivers = 1,
                              .pings = sonar->pings,
                              .tx_length = sonar->length,
                              .rx_length = sonar->length,
                              .echo_squint = squint,
                              .aperture_limit = 1500 / sonar->fc / (4 * 0.04), /* sampled: no grating lobes */
                              .compressed = true};
    assert_int_equal(acquisition_allocate(a), STATUS_OK);
    for (int p = 0; p < a->pings; p++) {
        a->t0[p] = sonar->first_sample / a->fs;
        a->tx[p].x = a->rx[p].x = sonar->x_first + 0.04 * p;
        a->velocity[p].x = sonar->speed;
    }
    a->echo_sine = beam_sine(scene);
}

void scene_sq18(const struct squint_sonar *sonar, double squint, struct scene *scene)
{
    static const double places[][2] = {{0, 45}, {-3, 41}, {3, 41}, {-3, 49}, {3, 49}};
    scene_make(sonar, squint, scene);
    scene->target_count = scene->point_count = 5;
    scene->targets = calloc(5, sizeof *scene->targets);
    for (int k = 0; k < 5; k++)
        scene->targets[k] = (struct target){places[k][0] + places[k][1] * sin(squint), places[k][1] * cos(squint), 1};
    assert_int_equal(acquisition_check(&scene->acquisition, "sq18"), STATUS_OK);
}

void scene_pf05(struct scene *scene)
{
    static const double places[][2] = {{0, 30},   {-3, 24},   {2.5, 33}, {4.6, 37}, {-6.2, 30},
                                       {5.6, 23}, {-5.9, 37}, {6.4, 34}, {5.6, 39}};
    scene_make(&sonar_pf05, 0, scene);
    scene->acquisition.area = (struct target_area){0, 30, 5, 10};
    scene->target_count = scene->point_count = 9;
    scene->targets = calloc(9, sizeof *scene->targets);
    for (int k = 0; k < 9; k++)
        scene->targets[k] = (struct target){places[k][0], places[k][1], 1};
    assert_int_equal(acquisition_check(&scene->acquisition, "pf05"), STATUS_OK);
}

void squint_scene_free(struct scene *scene)
{
    free(scene->targets);
    acquisition_free(&scene->acquisition);
}

void patches_around(const struct scene *scene, double angle, double step, int half, struct grid *patches)
{
    for (int k = 0; k < scene->point_count; k++) {
        const struct target *t = &scene->targets[k];
        double x = t->x * cos(angle) - t->r * sin(angle), r = t->x * sin(angle) + t->r * cos(angle);
        patches[k] = (struct grid){x - half * step, step, 2 * half + 1, r - half * step, step, 2 * half + 1, angle};
    }
}

/* exp(j 2 pi cycles) */
static double complex turned(double cycles)
{
    return cexp(2 * M_PI * I * (cycles - floor(cycles)));
}

/* The last bin of a record in the band. */
static int last_bin(const struct acquisition *a)
{
    return (int)floor(a->bandwidth / 2 / a->fs * a->samples);
}

static bool edge_is_bin(const struct acquisition *a)
{
    return last_bin(a) * a->fs / a->samples == a->bandwidth / 2;
}

double spectrum_sum(const struct acquisition *a)
{
    return 2 * last_bin(a) + (edge_is_bin(a) ? 0 : 1);
}

double complex echo_spectrum(const struct scene *scene, const struct echoes *echoes, int ping, double f)
{
    const struct acquisition *a = &scene->acquisition;
    const double complex *record = (const double complex *)echoes->samples + (size_t)ping * (size_t)a->samples;
    double complex sum = 0;
    for (int n = 0; n < a->samples; n++)
        sum += record[n] * turned(-f * (a->t0[ping] + n / a->fs));
    return sum * spectrum_sum(a) / a->samples;
}

static double complex exact_pixel(const struct scene *scene, const double complex *spectra, double gate,
                                  struct vector p)
{
    const struct acquisition *a = &scene->acquisition;
    const int n = a->samples, half = last_bin(a);
    const bool edge = edge_is_bin(a);
    double complex sum = 0;
    for (int q = 0; q < a->pings; q++) {
        double u = p.x - a->tx[q].x;
        if (fabs(u / hypot(u, p.y) - sin(a->echo_squint)) > gate)
            continue;
        double tau = delay_exact(a->tx[q], a->rx[q], a->velocity[q], p, a->sound_speed), at = (tau - a->t0[q]) * a->fs;
        double complex step = turned(at / n), turn = turned(-half * at / n), value = 0;
        for (int b = -half; b <= half; b++, turn *= step)
            value += spectra[(size_t)q * (size_t)n + (size_t)((b + n) % n)] * turn * (edge && abs(b) == half ? 2 : 1);
        sum += turned(a->fc * tau) * value / n;
    }
    return sum;
}

void exact_image(const struct scene *scene, const struct echoes *echoes, double gate, struct image *image)
{
    const struct acquisition *a = &scene->acquisition;
    const int n = a->samples;
    double complex *spectra = fftw_malloc((size_t)n * (size_t)a->pings * sizeof *spectra);
    memcpy(spectra, echoes->samples, (size_t)n * (size_t)a->pings * sizeof *spectra);
    fftw_plan forward =
        fftw_plan_many_dft(1, &n, a->pings, spectra, NULL, 1, n, spectra, NULL, 1, n, FFTW_FORWARD, FFTW_ESTIMATE);
    fftw_execute(forward);
    fftw_destroy_plan(forward);
    for (int k = 0; k < image->patch_count; k++) {
        const struct grid *g = &image->patches[k];
#pragma omp parallel for schedule(dynamic)
        for (int i = 0; i < g->r_count; i++)
            for (int j = 0; j < g->x_count; j++)
                ((double complex *)image->pixels[k])[i * g->x_count + j] =
                    exact_pixel(scene, spectra, gate, grid_point(g, i, j));
    }
    fftw_free(spectra);
}

void make_imaged(const struct squint_sonar *sonar, double squint_rad, double angle_rad, struct imaged *out)
{
    scene_sq18(sonar, squint_rad, &out->scene);
    support_echoes(&out->scene, &out->echoes);
    patches_around(&out->scene, angle_rad, 0.04, 7, out->patches);
    out->problem = problem_make(&out->scene.acquisition, out->scene.point_count, out->patches, PRECISION_DOUBLE);
    assert_int_equal(image_allocate(out->scene.point_count, out->patches, PRECISION_DOUBLE, &out->exact), STATUS_OK);
    exact_image(&out->scene, &out->echoes, 0.01 / (4 * 0.04), &out->exact);
}

void free_imaged(struct imaged *imaged)
{
    image_free(&imaged->exact);
    echoes_free(&imaged->echoes);
    squint_scene_free(&imaged->scene);
}
