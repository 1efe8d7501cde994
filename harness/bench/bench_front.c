/* What accuracy costs (bench_front.h). */
#include "bench/bench_front.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <string.h>

#include "echoes/echo_data.h"
#include "files/paths.h"
#include "files/text_file.h"
#include "measure/imaging.h"
#include "metrics/metrics.h"
#include "measure/timing.h"
#include "scene/simulate.h"
#include "bench/bench_once.h"

enum { ROUNDS = 5 };

/* An error, and the run over nearest's that it may take. */
static const struct setting {
    const char *spec;
    double error, ratio;
} settings[] = {
    {"bp_nearest:engine=general", 1, 1},
    {"bp_farrow:degree=3,engine=general", 1e-3, 1.5},
    {"bp_farrow:degree=4,engine=general", 1e-4, 1.7},
    {"bp_farrow:degree=5,engine=general", 1e-5, 2.2},
};
enum { SETTINGS = sizeof settings / sizeof *settings };

static const char *const scenes[] = {"sweep/point", "sweep/speckle"};

struct measured {
    double run_s[ROUNDS], ratio[ROUNDS], error;
};

static enum status settings_measure(const struct problem *problem, const struct echoes *echoes,
                                    const struct image *reference, struct measured measured[SETTINGS])
{
    enum status status = STATUS_OK;
    for (int round = 0; round < ROUNDS; round++)
        for (int k = 0; k < SETTINGS && status == STATUS_OK; k++) {
            struct bench_sample sample;
            struct image image;
            status = bench_once(settings[k].spec, problem, echoes, 1, &image, NULL, &sample);
            if (status != STATUS_OK)
                return status;
            measured[k].run_s[round] = sample.run_s;
            measured[k].ratio[round] = sample.run_s / measured[0].run_s[round];
            measured[k].error = metrics_error(&image, reference).error;
            image_free(&image);
        }
    return status;
}

static enum status scene_front(const char *name, FILE *file, struct bench_goals *goals)
{
    struct scene scene;
    struct echoes recorded = {0}, echoes = {0};
    struct image reference = {0};
    struct spec spec = {0};
    struct measured measured[SETTINGS];
    enum status status = scene_load(name, SCENE_DIRECTORY, &scene);
    if (status != STATUS_OK)
        return status;
    const struct problem exact = scene_problem(&scene, PRECISION_DOUBLE);
    const struct problem problem = scene_problem(&scene, PRECISION_FLOAT);
    status = scene_simulate(&scene, &recorded);
    if (status == STATUS_OK)
        status = echoes_convert(&recorded, PRECISION_FLOAT, &echoes);
    if (status == STATUS_OK)
        status = spec_parse("reference", &spec);
    if (status == STATUS_OK)
        status = imaging_form(&spec, &exact, &recorded, &reference, NULL);
    if (status == STATUS_OK)
        status = settings_measure(&problem, &echoes, &reference, measured);
    for (int k = 0; k < SETTINGS && status == STATUS_OK; k++) {
        const double run_s = median(measured[k].run_s, ROUNDS), ratio = median(measured[k].ratio, ROUNDS);
        fprintf(file, "%s,\"%s\",%d,%d,%.4g,%.4g,%.4g\n", name, settings[k].spec, scene.patches[0].x_count,
                scene.patches[0].r_count, run_s, ratio, measured[k].error);
        printf("%-18s %-36s %8.4f s %6.2f x nearest, error %.2g\n", name, settings[k].spec, run_s, ratio,
               measured[k].error);
        if (k == 0)
            continue;
        bench_goal(goals, GOAL_AT_MOST, settings[k].ratio, ratio, "general engine, run over nearest's, %s: %s", name,
                   settings[k].spec);
        bench_goal(goals, GOAL_AT_MOST, settings[k].error, measured[k].error, "its error");
    }
    fflush(stdout);
    spec_free(&spec);
    image_free(&reference);
    echoes_free(&echoes);
    echoes_free(&recorded);
    scene_free(&scene);
    return status;
}

/* The first receivers alone of every ping; to be freed, both. */
static enum status few_receivers(const struct acquisition *a, const struct echoes *echoes, int receivers,
                                 struct acquisition *few, struct echoes *taken)
{
    *few = *a;
    few->receivers = receivers;
    enum status status = acquisition_allocate(few);
    if (status != STATUS_OK)
        return status;
    memcpy(few->t0, a->t0, (size_t)a->pings * sizeof *a->t0);
    memcpy(few->tx, a->tx, (size_t)a->pings * sizeof *a->tx);
    memcpy(few->velocity, a->velocity, (size_t)a->pings * sizeof *a->velocity);
    if (a->pulse_length > 0)
        memcpy(few->pulse, a->pulse, (size_t)a->pulse_length * sizeof *a->pulse);
    status = echoes_allocate(few, PRECISION_FLOAT, taken);
    if (status != STATUS_OK) {
        acquisition_free(few);
        return status;
    }
    const size_t record = (size_t)a->samples * sizeof(float complex);
    for (size_t p = 0; p < (size_t)a->pings; p++) {
        const size_t from = p * (size_t)a->receivers, to = p * (size_t)receivers;
        memcpy(few->rx + to, a->rx + from, (size_t)receivers * sizeof *a->rx);
        memcpy((char *)taken->samples + to * record, (const char *)echoes->samples + from * record,
               (size_t)receivers * record);
    }
    return STATUS_OK;
}

/* The sums' rate with one and two receivers a ping over that with all. */
static enum status receivers_measure(FILE *file, struct bench_goals *goals)
{
    static const char *const scene_name = "bp22/full_limited", *const text = "bp_nearest:engine=general";
    enum { ROWS = 64, COUNTS = 3 };
    struct scene scene;
    struct echoes echoes;
    enum status status = bench_scene(scene_name, &scene, &echoes);
    if (status != STATUS_OK)
        return status;
    struct grid grid = scene.patches[0];
    grid.r_step *= (double)grid.r_count / ROWS;
    grid.r_count = ROWS;
    const int counts[COUNTS] = {scene.acquisition.receivers, 1, 2};
    double rate[COUNTS][ROUNDS], ratio[COUNTS][ROUNDS];
    for (int round = 0; round < ROUNDS; round++)
        for (int k = 0; k < COUNTS && status == STATUS_OK; k++) {
            struct acquisition few;
            struct echoes taken;
            struct bench_sample sample;
            struct work work;
            status = few_receivers(&scene.acquisition, &echoes, counts[k], &few, &taken);
            if (status != STATUS_OK)
                break;
            const struct problem problem = problem_make(&few, 1, &grid, PRECISION_FLOAT);
            status = bench_once(text, &problem, &taken, 1, NULL, &work, &sample);
            rate[k][round] = work.pairs / bench_stage(&sample, "focus");
            ratio[k][round] = rate[k][round] / rate[0][round];
            echoes_free(&taken);
            acquisition_free(&few);
        }
    for (int k = 0; k < COUNTS && status == STATUS_OK; k++) {
        const double pairs_per_s = median(rate[k], ROUNDS), over = median(ratio[k], ROUNDS);
        fprintf(file, "%s,\"%s, %d receivers\",%d,%d,%.4g,%.4g,\n", scene_name, text, counts[k], grid.x_count, ROWS,
                pairs_per_s, over);
        printf("%-18s %-26s %2d receivers: %.3f Gpair/s, %.2f of all\n", scene_name, text, counts[k],
               1e-9 * pairs_per_s, over);
        if (k > 0)
            bench_goal(goals, GOAL_AT_LEAST, 0.9, over, "general engine, nearest's rate with %d of %d receivers a ping",
                       counts[k], counts[0]);
    }
    fflush(stdout);
    echoes_free(&echoes);
    scene_free(&scene);
    return status;
}

/* Factorised back projection of a long aperture on a track that sways, over direct back projection. */
static enum status aperture_measure(FILE *file, struct bench_goals *goals)
{
    static const char *const scene_name = "study/rail_sway";
    static const char *const specs[] = {"bp_nearest", "bp_factorised:error=0.01"};
    struct scene scene;
    struct echoes echoes;
    struct bench_sample sample[2];
    enum status status = bench_scene(scene_name, &scene, &echoes);
    if (status != STATUS_OK)
        return status;
    const struct problem problem = scene_problem(&scene, PRECISION_FLOAT);
    for (int k = 0; k < 2 && status == STATUS_OK; k++)
        status = bench_once(specs[k], &problem, &echoes, omp_get_max_threads(), NULL, NULL, &sample[k]);
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        const double ratio = sample[k].run_s / sample[0].run_s;
        fprintf(file, "%s,\"%s\",%d,%d,%.4g,%.4g,\n", scene_name, specs[k], scene.patches[0].x_count,
                scene.patches[0].r_count, sample[k].run_s, ratio);
        printf("%-18s %-36s %8.4f s %6.2f x nearest, all threads\n", scene_name, specs[k], sample[k].run_s, ratio);
        if (k > 0)
            bench_goal(goals, GOAL_AT_MOST, 1, ratio, "%s, run over nearest's: %s", specs[k], scene_name);
    }
    fflush(stdout);
    echoes_free(&echoes);
    scene_free(&scene);
    return status;
}

enum status bench_front(const char *directory, struct bench_goals *goals)
{
    char path[4096];
    struct text_file file;
    snprintf(path, sizeof path, "%s/bench_front.csv", directory);
    enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    fprintf(file.stream, "# sasbench bench_front 1\nscene,algorithm,columns,rows,run_s_or_pairs_per_s,ratio,error\n");
    printf("\nGeneral engine, float, one thread\n");
    for (size_t k = 0; k < sizeof scenes / sizeof *scenes && status == STATUS_OK; k++)
        status = scene_front(scenes[k], file.stream, goals);
    if (status == STATUS_OK)
        status = receivers_measure(file.stream, goals);
    if (status == STATUS_OK)
        status = aperture_measure(file.stream, goals);
    status = text_file_close(&file, status);
    if (status == STATUS_OK)
        printf("Results: %s\n", path);
    return status;
}
