#include "tests/algorithms/predictions.h"

#include <math.h>
#include <stdio.h>

#include "metrics/metrics.h"
#include "tests/support.h"

struct forecast forecast_of(const char *text, const struct problem *problem)
{
    struct forecast forecast;
    struct spec spec;
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    assert_int_equal(algorithm_forecast(spec.algorithm, problem, spec.options, &forecast), STATUS_OK);
    spec_free(&spec);
    return forecast;
}

double predicted_over_measured(struct session *session, const char *text, double *error)
{
    struct image image;
    struct spec spec;
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    assert_int_equal(session_image(session, &spec, &image), STATUS_OK);
    const struct problem problem = session_problem(session->scene, spec.algorithm, PRECISION_FLOAT);
    const struct forecast forecast = forecast_of(text, &problem);
    const double predicted = forecast_error(&forecast);
    *error = metrics_error(&image, &session->reference).error_gain;
    print_message("%s, B/fs %.2f, %-30s predicted %.2e, measured %.2e, ratio %.2f\n", session->scene->name,
                  session->scene->acquisition.bandwidth / session->scene->acquisition.fs, text, predicted, *error,
                  predicted / *error);
    image_free(&image);
    spec_free(&spec);
    return predicted / *error;
}

void points_scene(int seed, int count, struct scene *scene)
{
    support_random_scene(seed, scene);
    const struct grid *g = &scene->patches[0];
    assert_true(scene->target_count >= count);
    for (int n = 0; n < count; n++)
        scene->targets[n] = (struct target){g->x_first + fmod(0.3 + 0.618 * n, 1) * (g->x_count - 1) * g->x_step,
                                            g->r_first + fmod(0.4 + 0.382 * n, 1) * (g->r_count - 1) * g->r_step, 1};
    scene->point_count = scene->target_count = count;
}
