/* How dark an image is beside its echoes (darkness.h). */
#include "measure/darkness.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>

#include "backprojection/law_spectrum.h"
#include "backprojection/pairs/pairs.h"
#include "backprojection/traces.h"
#include "common/pulse_band.h"
#include "common/turns.h"
#include "contract/delay.h"
#include "echoes/echo_data.h"
#include "range_migration/rma_conditions.h"

static const double NOISE_MOST = 2;       /* 1: independent echoes, but for the scatter of few pixels */
static const double EDGES_MOST = 4.0 / 3; /* 1 + a sixth of the excess of side lobes alone, of a flat, narrow band */
static const double GHOSTS_MOST = 0.5;    /* beside a target ghosts cancel: a tenth is usual in wide images */
enum { VISITS = 1 << 18, RECORDS_LEAST = 256 };

/* The plastic number's first two powers below 1: points frac(n a), frac(n b) are spread evenly over a square, for
   any number of them, and over every band of its rows or columns. */
static const double SPREAD_R = 0.7548776662466927, SPREAD_X = 0.5698402909980532;

/* Sums of |s|^2, of the squares of differences between neighbours, and of the ghosts' |s|^2. */
struct energies {
    double met, steps, ghosts;
};

struct survey {
    const struct echoes *echoes;
    const struct image *image;
    struct traces *traces;
    double pixels;           /* of all patches */
    int records, pairs;      /* number of those read; of all */
    int visits;              /* pixels of a record */
    double sine;             /* |sin theta_t| up to which a ping sees a pixel */
    double sampled;          /* and up to which azimuth transforms image it */
    double complex *scratch; /* [threads][2][samples]: a record, and compressed */
};

/* The image's energy, in units of the samples in memory. */
static double image_energy(const struct image *image, int exponent)
{
    double sum = 0;
    for (int p = 0; p < image->patch_count; p++)
        for (int i = 0; i < image->patches[p].r_count; i++)
            for (int j = 0; j < image->patches[p].x_count; j++) {
                const double complex value = image_pixel(image, p, i, j);
                const double real = ldexp(creal(value), -exponent), imaginary = ldexp(cimag(value), -exponent);
                sum += real * real + imaginary * imaginary;
            }
    return sum;
}

/* A compressed record. */
static const double complex *record_read(const struct survey *survey, int pair)
{
    const struct echoes *echoes = survey->echoes;
    const size_t samples = (size_t)echoes->acquisition->samples, first = (size_t)pair * samples;
    const int thread = omp_get_thread_num();
    double complex *record = survey->scratch + 2 * samples * (size_t)thread;
    for (size_t n = 0; n < samples; n++)
        record[n] = echoes->precision == PRECISION_DOUBLE ? ((const double complex *)echoes->samples)[first + n]
                                                          : ((const float complex *)echoes->samples)[first + n];
    traces_double.fill(survey->traces, thread, record, record + samples);
    return record + samples;
}

/* Add one pair at one pixel, from the samples on either side of its delay. */
static void pair_add(const struct survey *survey, int pair, struct vector normal, struct vector pixel,
                     const double complex *record, struct energies *energies)
{
    const struct acquisition *a = survey->echoes->acquisition;
    const int ping = pair / a->receivers;
    const struct vector tx = a->tx[ping], way = {pixel.x - tx.x, pixel.y - tx.y, pixel.z - tx.z};
    const double along = way.x * normal.x + way.y * normal.y + way.z * normal.z;
    const double sine = fabs(along) / sqrt(way.x * way.x + way.y * way.y + way.z * way.z);
    const bool seen = sine <= survey->sine, ghost = !seen && sine > survey->sampled && sine <= a->aperture_limit;
    if (!seen && !ghost)
        return;
    const double delay = delay_exact(tx, a->rx[pair], a->velocity[ping], pixel, a->sound_speed);
    const double place = (delay - a->t0[ping]) * a->fs;
    if (!(place >= 0 && place <= a->samples - 1))
        return;
    const double complex here = record[(int)floor(place)], next = record[(int)ceil(place)];
    const double energy = (square(here) + square(next)) / 2;
    energies->met += seen ? energy : 0;
    energies->steps += seen ? square(next - here) : 0;
    energies->ghosts += ghost ? energy : 0;
}

static void energies_add(struct energies *to, const struct energies *from, double weight)
{
    to->met += weight * from->met;
    to->steps += weight * from->steps;
    to->ghosts += weight * from->ghosts;
}

/* One record's energies at a sample of all pixels. */
static struct energies record_energies(const struct survey *survey, int index)
{
    const struct acquisition *a = survey->echoes->acquisition;
    const int pair = (int)(((long long)index * 2 + 1) * survey->pairs / (2LL * survey->records));
    const struct vector normal = acquisition_normal(a, pair / a->receivers);
    const double complex *record = record_read(survey, pair);
    struct energies energies = {0};
    for (int p = 0; p < survey->image->patch_count; p++) {
        const struct grid *g = &survey->image->patches[p];
        const double pixels = (double)grid_pixels(g), share = survey->visits * pixels / survey->pixels;
        const bool all = survey->visits >= survey->pixels;
        const int count = all ? (int)pixels : (int)ceil(share);
        struct energies sum = {0};
        for (int n = 0; n < count; n++) {
            const double at = n + (double)count * index, r = at * SPREAD_R, x = at * SPREAD_X;
            const int i = all ? n / g->x_count : (int)((r - floor(r)) * g->r_count);
            const int j = all ? n % g->x_count : (int)((x - floor(x)) * g->x_count);
            pair_add(survey, pair, normal, grid_point(g, i, j), record, &sum);
        }
        energies_add(&energies, &sum, pixels / count);
    }
    return energies;
}

static struct energies echo_energies(struct survey *survey)
{
    struct energies *energies = malloc((size_t)survey->records * sizeof *energies), sum = {0};
    if (!energies)
        return (struct energies){NAN, NAN, NAN};
#pragma omp parallel for schedule(dynamic)
    for (int n = 0; n < survey->records; n++)
        energies[n] = record_energies(survey, n);
    for (int n = 0; n < survey->records; n++)
        energies_add(&sum, &energies[n], (double)survey->pairs / survey->records);
    free(energies);
    return sum;
}

/* The energy of a pulse's differences over its own; NAN without memory. */
static double pulse_steps(const struct problem *problem)
{
    struct law_spectrum spectrum;
    double steps = 0, all = 0;
    if (!law_spectrum(problem->acquisition, image_cells(problem), &spectrum))
        return NAN;
    for (int n = 0; n < spectrum.count; n++) {
        steps += spectrum.scattered[n] * 4 * pow(sin(M_PI * spectrum.nu[n]), 2);
        all += spectrum.scattered[n];
    }
    return steps / all;
}

/* Of a straight track; no transform images other tracks. */
static double sampled_sine(const struct acquisition *a)
{
    struct straight_track track;
    if (!acquisition_is_straight(a, &track))
        return INFINITY;
    const double sine = a->sound_speed * a->receivers / (4 * fabs(track.spacing) * a->fc);
    return fmin(sine / cos(a->echo_squint), rma_widest_sine(a));
}

struct darkness image_darkness(const struct echoes *echoes, const struct image *image)
{
    const struct acquisition *a = echoes->acquisition;
    const struct problem problem = problem_make(a, image->patch_count, image->patches, image->precision);
    const struct traces_form form = {.upsample = 1};
    const int threads = omp_get_max_threads();
    struct survey survey = {.echoes = echoes,
                            .image = image,
                            .pixels = problem_pixels(&problem),
                            .pairs = a->pings * a->receivers,
                            .sine = fmin(a->aperture_limit, condition_beam_sine(a)),
                            .sampled = sampled_sine(a)};
    struct traces_shape shape;
    survey.records = (int)fmin(survey.pairs, fmax(RECORDS_LEAST, VISITS / survey.pixels));
    survey.visits = (int)fmin(survey.pixels, VISITS / survey.records);
    survey.scratch = malloc(2 * (size_t)a->samples * (size_t)threads * sizeof *survey.scratch);
    const bool ready = survey.scratch && traces_double.plan(a, &form, threads, &shape, &survey.traces) == STATUS_OK;
    const struct energies sums = ready ? echo_energies(&survey) : (struct energies){NAN, NAN, NAN};
    const double met = sums.met, shown = image_energy(image, echoes->exponent);
    traces_double.destroy(survey.traces);
    free(survey.scratch);
    return (struct darkness){ldexp(sqrt(met / survey.pixels), echoes->exponent),
                             ldexp(sqrt(shown / survey.pixels), echoes->exponent), met == 0 ? 0 : met / shown,
                             met == 0 ? 1 : sums.steps / met / pulse_steps(&problem),
                             sums.ghosts == 0 ? 0 : sums.ghosts / shown};
}

void darkness_conditions(const struct darkness *darkness, struct condition list[DARKNESS_CONDITIONS])
{
    list[0] = (struct condition){"dark_image",
                                 darkness->ratio,
                                 NOISE_MOST,
                                 false,
                                 SEVERITY_WARN,
                                 "the energy of the pixels' echoes over that of the image",
                                 "a grid that covers the bright echoes"};
    list[1] = (struct condition){"side_lobes",
                                 darkness->edges,
                                 EDGES_MOST,
                                 false,
                                 SEVERITY_WARN,
                                 "the mean square frequency of the echoes that reach the pixels over the pulse's",
                                 "a grid that covers the bright echoes; these are their side lobes in range, at the "
                                 "ends of the band, where interpolators err most"};
    list[2] = (struct condition){
        "unseen_echoes",
        darkness->ghosts,
        GHOSTS_MOST,
        false,
        SEVERITY_WARN,
        "the energy at the pixels from pings outside whose beam and sampled wavenumbers they lie, over the image's",
        "an aperture_limit at the edge of the sampled wavenumbers; azimuth transforms show "
        "none of them"};
    condition_cure_add(
        &list[0],
        "; the image's rms is %.3g, that of its echoes %.3g: relative to the image, errors may be larger by this ratio",
        darkness->image, darkness->echoes);
}
