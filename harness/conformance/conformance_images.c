/* The image of every scene, its work, and what was predicted of it (conformance.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "conformance/conformance.h"
#include "echoes/echo_data.h"
#include "imaging/imaging.h"
#include "metrics/metrics.h"
#include "scene/simulate.h"

#define GAIN_MOST      0.02 /* of ordinary scenes; nearest neighbour's is half of it */
#define FORECAST_SLACK 5e-3 /* beside twice the forecast, a mean over scenes: of scenes as small as these */

/* Work that a plan may claim. */
static void check_work(const struct conformance *c, const char *place, const struct problem *problem, const void *plan)
{
    const struct work work = c->algorithm->work(plan);
    const struct work_bounds bounds = work_bounds(c->algorithm, c->specs[problem->precision].options, problem, &work);
    if (isnan(work.flops) && isnan(work.pairs)) { /* said once */
        if (place == settings->name && problem->precision == PRECISION_DOUBLE)
            fprintf(c->stream, "  not checked: the counts of work, which an external program leaves empty\n");
        return;
    }
    promise(c, place, work.pairs == 0 || work.pairs == bounds.pairs,
            "work.pairs is %.9g, must be 0 or the number of pairs that count, %.9g", work.pairs, bounds.pairs);
    promise(c, place, work.flops >= bounds.flops_least && work.flops <= bounds.flops_most,
            "work.flops is %.3g, must be from %.3g to %.3g", work.flops, bounds.flops_least, bounds.flops_most);
    promise(c, place, *work.engine, "work.engine is \"%s\", must name the way that was chosen", work.engine);
}

/* What was said of the problem ahead of the plan. */
static void check_predictions(const struct conformance *c, const struct setting *setting, const struct problem *problem,
                              const struct error_metrics *error)
{
    struct condition list[CONDITIONS_MAX];
    struct forecast forecast;
    const void *options = c->specs[problem->precision].options;
    const int count = algorithm_conditions(c->algorithm, problem, options, list, CONDITIONS_MAX);
    const bool accepted = conditions_check("the image", list, count) == STATUS_OK;
    promise(c, setting->name, accepted, "its conditions accept what its plan accepts%s%s", accepted ? "" : ": ",
            accepted ? "" : status_message());
    if (!c->algorithm->cost || algorithm_forecast(c->algorithm, problem, options, &forecast) != STATUS_OK
        || !isfinite(forecast_error(&forecast)))
        return;
    promise_most(c, setting->name, "the error after one gain", error->error_gain,
                 2 * forecast_error(&forecast) + FORECAST_SLACK);
}

/* Near the exact image, float near double. */
static void check_errors(const struct conformance *c, const struct setting *setting, const struct problem *problem,
                         const struct image *exact, const struct image images[2])
{
    const struct image *image = &images[PRECISION_DOUBLE];
    if (setting->empty) {
        promise_most(c, setting->name, "the norm of the image of zeros",
                     condition_worse(image_difference(&images[0], exact), image_difference(image, exact)), 0);
        return;
    }
    const struct error_metrics error = metrics_error(image, exact);
    promise_most(c, setting->name, "the error against reference", error.error,
                 c->algorithm->traits & TRAIT_EXACT ? 1e-8 : setting->bound);
    if (setting == c->usual || setting == settings)
        promise_most(c, setting->name, "the gain's distance from 1", cabs(error.gain - 1), GAIN_MOST);
    promise_most(c, setting->name, "the difference of float from double", image_difference(&images[0], image), 2e-6);
    check_predictions(c, setting, problem, &error);
}

void check_images(const struct conformance *c, const struct setting *setting)
{
    struct scene scene;
    struct grid grids[2];
    struct echoes echoes;
    struct image exact, images[2], again;
    struct spec reference;
    conformance_echoes(c, setting, &scene, grids, &echoes);
    const struct problem problem = scene_problem(&scene, PRECISION_DOUBLE);
    conformance_need(c, spec_parse("reference:precision=double", &reference));
    conformance_need(c, imaging_form(&reference, &problem, &echoes, &exact, NULL));
    for (int precision = 1; precision >= 0; precision--) {
        struct problem own = problem;
        void *plan;
        own.precision = (enum precision)precision;
        if (!conformance_form(c, setting, problem, own.precision, 2, &echoes, &images[precision])) {
            promise(c, setting->name, precision == PRECISION_DOUBLE, "refused in %s: %s", precision_name(own.precision),
                    status_message());
            return;
        }
        promise(c, setting->name,
                conformance_form(c, setting, problem, own.precision, 1, &echoes, &again)
                    && same_bits(&again, &images[precision]),
                "the same bits on 1 thread as on 2, in %s", precision_name(own.precision));
        if (conformance_plan(c, setting, &own, &plan)) {
            check_work(c, setting->name, &own, plan);
            c->algorithm->destroy(plan);
        }
    }
    c->tally->accepted++;
    check_errors(c, setting, &problem, &exact, images);
}

/* ---- one scene against another ---- */

/* Image(2j a - 0.5 b) = 2j Image(a) - 0.5 Image(b). */
void check_linearity(const struct conformance *c, const struct setting *setting)
{
    struct scene scene;
    struct grid grids[2];
    struct echoes echoes[3];
    struct image image[3];
    conformance_need(c, make_scene(setting, &scene, grids));
    double complex *s[3];
    for (int k = 0; k < 3; k++) {
        scene.targets[0] = (struct target){0.1 * k - 0.08, 29.9 + 0.07 * k, 1};
        conformance_need(c, scene_simulate(&scene, &echoes[k]));
        s[k] = (double complex *)echoes[k].samples;
    }
    const struct acquisition *a = &scene.acquisition;
    const size_t count = (size_t)a->samples * (size_t)a->receivers * (size_t)a->pings;
    for (size_t n = 0; n < count; n++)
        s[2][n] = 2 * I * s[0][n] - 0.5 * s[1][n];
    const struct problem problem = scene_problem(&scene, PRECISION_DOUBLE);
    for (int k = 0; k < 3; k++)
        if (!conformance_form(c, setting, problem, PRECISION_DOUBLE, 2, &echoes[k], &image[k])) {
            promise(c, setting->name, false, "refuses an ordinary scene, \"%s\"", status_message());
            return;
        }
    double worst = 0, peak = 0;
    for (int n = 0; n < grids->r_count * grids->x_count; n++) {
        double complex value[3];
        for (int k = 0; k < 3; k++)
            value[k] = image_pixel(&image[k], 0, n / grids->x_count, n % grids->x_count);
        worst = condition_worse(worst, cabs(2 * I * value[0] - 0.5 * value[1] - value[2]));
        peak = condition_worse(peak, cabs(value[2]));
    }
    promise_most(c, "sum of two echoes", "the difference from the sum of two images over the peak", worst / peak,
                 1e-12);
}

/* Echoes two pings later show the same image two ping spacings further on. */
void check_translation(const struct conformance *c, const struct setting *setting)
{
    enum { SHIFT = 2 };
    struct scene scene;
    struct grid grids[2];
    struct echoes echoes;
    struct image image, after;
    conformance_echoes(c, setting, &scene, grids, &echoes);
    const struct acquisition *a = &scene.acquisition;
    const size_t ping = (size_t)a->samples * (size_t)a->receivers;
    double complex *s = (double complex *)echoes.samples;
    memset(s + (size_t)(a->pings - SHIFT) * ping, 0, SHIFT * ping * sizeof *s);
    struct problem problem = scene_problem(&scene, PRECISION_DOUBLE);
    if (!conformance_form(c, setting, problem, PRECISION_DOUBLE, 2, &echoes, &image))
        return;
    memmove(s + SHIFT * ping, s, (size_t)(a->pings - SHIFT) * ping * sizeof *s);
    memset(s, 0, SHIFT * ping * sizeof *s);
    struct grid moved = grids[0];
    moved.x_first += SHIFT * (a->tx[1].x - a->tx[0].x);
    problem.patches = &moved;
    if (conformance_form(c, setting, problem, PRECISION_DOUBLE, 2, &echoes, &after))
        promise_most(c, "echoes two pings later", "the difference of the shifted image",
                     image_difference(&after, &image), 1e-9);
}
