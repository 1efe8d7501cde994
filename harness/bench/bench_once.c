#include "bench/bench_once.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "echoes/echo_data.h"
#include "files/paths.h"
#include "measure/imaging.h"
#include "scene/simulate.h"

enum { RUNS_LEAST = 3, RUNS_MOST = 99 };
static const double single_s = 0.5, least_s = 0.25;

enum status bench_scene(const char *name, struct scene *scene, struct echoes *echoes)
{
    struct echoes recorded;
    enum status status = scene_load(name, SCENE_DIRECTORY, scene);
    if (status != STATUS_OK)
        return status;
    status = scene_simulate(scene, &recorded);
    if (status == STATUS_OK) {
        status = echoes_convert(&recorded, PRECISION_FLOAT, echoes);
        echoes_free(&recorded);
    }
    if (status != STATUS_OK)
        scene_free(scene);
    return status;
}

/* Runs in the order of their times. */
static void insert(struct bench_sample *runs, int *count, const struct stages *stages, double seconds)
{
    int k = (*count)++;
    for (; k > 0 && runs[k - 1].run_s > seconds; k--)
        runs[k] = runs[k - 1];
    runs[k].run_s = seconds;
    runs[k].stages = *stages;
}

static enum status repeat(struct imaging *imaging, const struct echoes *echoes, struct bench_sample *sample)
{
    static struct bench_sample runs[RUNS_MOST];
    int count = 0;
    double elapsed = 0;
    for (bool warm = false;; warm = true) {
        struct stages stages;
        stages_begin(&stages);
        const double begin = stages.mark;
        const enum status status = imaging_execute(imaging, echoes, &stages);
        const double seconds = seconds_now() - begin;
        if (status != STATUS_OK)
            return status;
        if (warm || seconds >= single_s) {
            insert(runs, &count, &stages, seconds);
            elapsed += seconds;
        }
        if (seconds >= single_s || count == RUNS_MOST || (count >= RUNS_LEAST && elapsed >= least_s))
            break;
    }
    sample->run_s = runs[count / 2].run_s;
    sample->stages = runs[count / 2].stages;
    sample->runs = count;
    return STATUS_OK;
}

enum status bench_once(const char *text, const struct problem *problem, const struct echoes *echoes, int threads,
                       struct image *image, struct work *work, struct bench_sample *sample)
{
    const int all = omp_get_max_threads();
    struct spec spec;
    struct imaging imaging;
    enum status status = spec_parse(text, &spec);
    if (status != STATUS_OK)
        return status;
    *sample = (struct bench_sample){0};
    omp_set_num_threads(threads);
    status = imaging_open(&spec, problem, &imaging);
    if (status == STATUS_OK) {
        sample->plan_s = imaging.plan_s;
        status = repeat(&imaging, echoes, sample);
        omp_set_num_threads(all);
        if (status == STATUS_OK && work) /* counting pairs takes as long as summing some of them */
            *work = imaging.algorithm->work(imaging.plan);
        if (status == STATUS_OK && image)
            status = imaging_finish(&imaging, echoes, image);
        imaging_close(&imaging);
    }
    omp_set_num_threads(all);
    spec_free(&spec);
    return status;
}

double bench_stage(const struct bench_sample *sample, const char *name)
{
    for (int k = 0; k < sample->stages.count; k++)
        if (strcmp(sample->stages.stage[k].name, name) == 0)
            return sample->stages.stage[k].seconds;
    return NAN;
}
