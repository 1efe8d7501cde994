/* The command `filter`: the polar-format spatial filter, echoes to echoes, with a table of what it does to each target. */
#include <complex.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/traces.h"
#include "command/task.h"
#include "data/echo_data.h"
#include "scene/matfile.h"
#include "scene/simulate.h"
#include "wavenumber/filter.h"
#include "wavenumber/wk.h"

/* What filters the echoes of one acquisition: matched filter, then the target area. */
struct chain {
    const struct acquisition *acquisition;
    struct traces *traces;
    struct polar_filter *filter;
    struct polar_shape shape;
};

static void chain_close(struct chain *chain)
{
    traces_destroy_double(chain->traces);
    polar_filter_destroy_double(chain->filter);
}

static enum status chain_open(const struct acquisition *acquisition, const struct spec *spec, struct chain *chain)
{
    struct polar_setting setting = {4, false};
    struct traces_shape shape;
    if (spec) {
        const struct wk_options *options = spec->options;
        setting = (struct polar_setting){options->subapertures, options->curvature};
    }
    *chain = (struct chain){.acquisition = acquisition};
    enum status status =
        polar_filter_plan_double(acquisition, &setting, omp_get_max_threads(), &chain->shape, &chain->filter);
    if (status == STATUS_OK)
        status = traces_plan_double(acquisition, 1, 0, omp_get_max_threads(), &shape, &chain->traces);
    if (status != STATUS_OK)
        chain_close(chain);
    return status;
}

/* Records through the matched filter, in place. */
static void chain_compress(const struct chain *chain, double complex *records)
{
    if (chain->acquisition->compressed)
        return;
    const size_t samples = (size_t)chain->acquisition->samples;
#pragma omp parallel for schedule(static)
    for (int p = 0; p < chain->acquisition->pings; p++)
        traces_fill_double(chain->traces, omp_get_thread_num(), records + samples * (size_t)p,
                           records + samples * (size_t)p);
}

static double energy_db(const double complex *samples, const double complex *before, size_t count, double reference)
{
    double sum = 0;
    for (size_t n = 0; n < count; n++) {
        double complex value = samples[n] - (before ? before[n] : 0);
        sum += creal(value) * creal(value) + cimag(value) * cimag(value);
    }
    return reference > 0 ? 10 * log10(sum / reference) : sum;
}

/* Each point target by itself, for the filter is linear: the energy that it keeps, and of what is changed, over its own. */
static enum status table_print(const struct chain *chain, const struct scene *scene)
{
    const struct acquisition *a = chain->acquisition;
    const size_t count = (size_t)a->samples * (size_t)a->pings;
    double complex *before = malloc(count * sizeof *before);
    enum status status = before ? STATUS_OK : status_set(STATUS_FAILED, "no memory for the echoes of one target");
    printf("target,x_m,r_m,inside,kept_db,changed_db\n");
    for (int k = 0; k < scene->point_count && status == STATUS_OK; k++) {
        struct scene alone = *scene;
        struct echoes echoes;
        const struct target *target = alone.targets = &scene->targets[k];
        alone.target_count = alone.point_count = 1;
        alone.noise_std = 0;
        status = scene_simulate(&alone, &echoes);
        if (status != STATUS_OK)
            break;
        double complex *samples = (double complex *)echoes.samples;
        chain_compress(chain, samples);
        memcpy(before, samples, count * sizeof *before);
        polar_filter_apply_double(chain->filter, samples);
        double own = energy_db(before, NULL, count, 0);
        bool inside = fabs(target->x - a->area.x) < a->area.half_x && fabs(target->r - a->area.r) < a->area.half_r;
        if (own > 0)
            printf("%d,%.10g,%.10g,%d,%.2f,%.2f\n", k + 1, target->x, target->r, inside,
                   energy_db(samples, NULL, count, own), energy_db(samples, before, count, own));
        else /* no ping sees it */
            printf("%d,%.10g,%.10g,%d,,\n", k + 1, target->x, target->r, inside);
        echoes_free(&echoes);
    }
    free(before);
    return status;
}

static enum status check_usage(const struct task *task)
{
    if (!task->name_count == !task->echoes)
        return status_set(STATUS_INVALID, "filter: exactly one of SCENE and --echoes FILE.mat is needed");
    if (task->spec_count > 1 || (task->spec_count == 1 && strcmp(task->specs[0].algorithm->name, "wk_polar") != 0))
        return status_set(STATUS_INVALID,
                          "filter: %d --algorithm SPEC given, the last is %s; accepted: one of "
                          "wk_polar:subapertures=...,curvature=...",
                          task->spec_count, task->specs[task->spec_count - 1].algorithm->name);
    return output_check("filter", task->output);
}

/* The echoes as they will be written: compressed, without the pulse. */
static enum status filtered_write(const struct chain *chain, const struct echoes *echoes, const char *path,
                                  const char *description)
{
    struct acquisition plain = *chain->acquisition;
    struct echoes written = *echoes;
    double complex *samples = (double complex *)echoes->samples;
    chain_compress(chain, samples);
    polar_filter_apply_double(chain->filter, samples);
    plain.compressed = true;
    plain.pulse = NULL;
    plain.pulse_length = 0;
    written.acquisition = &plain;
    return echo_file_write(path, &written, description);
}

enum status command_filter(const struct task *task)
{
    struct scene scene = {0};
    struct acquisition recorded = {0};
    struct echoes echoes = {0};
    struct chain chain = {0};
    enum status status = check_usage(task);
    if (status == STATUS_OK)
        status = task->echoes ? echo_file_read(task->echoes, &recorded, &echoes)
                              : scene_load(task->names[0], SCENE_DIRECTORY, &scene);
    if (status == STATUS_OK)
        status =
            chain_open(task->echoes ? &recorded : &scene.acquisition, task->spec_count ? task->specs : NULL, &chain);
    if (status == STATUS_OK && !task->echoes)
        status = scene_simulate(&scene, &echoes);
    if (status == STATUS_OK) {
        status = filtered_write(&chain, &echoes, task->output, task->echoes ? "filtered" : scene.description);
        fprintf(stderr, "%d sub-apertures, upsampled %d times\n", chain.shape.subapertures, chain.shape.upsampling);
        if (status == STATUS_OK && !task->echoes)
            status = table_print(&chain, &scene);
        chain_close(&chain);
    }
    echoes_free(&echoes);
    acquisition_free(&recorded);
    scene_free(&scene);
    return status;
}
