/* The command `filter`: the polar-format spatial filter, echoes to echoes, with a table of its effect on each
   target. */
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "files/paths.h"
#include "command/task.h"
#include "echoes/echo_data.h"
#include "measure/filtering.h"
#include "echoes/matfile.h"
#include "scene/simulate.h"

static void row_print(const char *target, const char *place, const struct kept *kept)
{
    printf("%s,%s,", target, place);
    if (isnan(kept->kept_db)) /* no echoes: no ping sees it */
        printf(",\n");
    else
        printf("%.2f,%.2f\n", kept->kept_db, kept->changed_db);
}

/* Each point target by itself, and all echoes, which are the only row where they are recorded. */
static enum status table_print(const struct filtering *filtering, const struct scene *scene, const struct kept *all)
{
    enum status status = STATUS_OK;
    printf("target,x_m,r_m,inside,kept_db,changed_db\n");
    for (int k = 0; !scene->recorded && k < scene->point_count && status == STATUS_OK; k++) {
        const struct target *target = &scene->targets[k];
        char number[16], place[80];
        struct kept kept;
        status = filtering_target(filtering, scene, k, &kept);
        snprintf(number, sizeof number, "%d", k + 1);
        snprintf(place, sizeof place, "%.10g,%.10g,%d", target->x, target->r,
                 area_holds(&filtering->acquisition->area, target->x, target->r));
        if (status == STATUS_OK)
            row_print(number, place, &kept);
    }
    if (status == STATUS_OK)
        row_print("all", ",,", all);
    return status;
}

static enum status check_usage(const struct task *task)
{
    if (!task->name_count == !task->echoes)
        return status_set(STATUS_INVALID, "filter: exactly one of SCENE and --echoes FILE.mat is needed");
    if (task->spec_count > 1 || (task->spec_count == 1 && strcmp(task->specs[0].algorithm->name, "wk_polar") != 0))
        return status_set(STATUS_INVALID,
                          "filter: %d --algorithm SPEC given, the last is %s; accepted: one of "
                          "wk_polar:subapertures=...,curvature=...,band=...",
                          task->spec_count, task->specs[task->spec_count - 1].algorithm->name);
    return output_check("filter", task->output);
}

/* The echoes to write: compressed, so without the pulse, and without the area, which is applied already. */
static enum status filtered_write(const struct filtering *filtering, const struct echoes *from, const char *path,
                                  const struct echo_notes *notes, struct kept *all)
{
    struct acquisition plain = *filtering->acquisition;
    struct echoes echoes;
    enum status status = echoes_convert(from, PRECISION_DOUBLE, &echoes);
    if (status != STATUS_OK)
        return status;
    double complex *samples = (double complex *)echoes.samples;
    filtering_compress(filtering, samples);
    status = filtering_measure(filtering, samples, all);
    plain.compressed = true;
    plain.pulse = NULL;
    plain.pulse_length = 0;
    plain.area = (struct target_area){0};
    echoes.acquisition = &plain;
    if (status == STATUS_OK)
        status = echo_file_write(path, &echoes, notes);
    echoes_free(&echoes);
    return status;
}

static enum status source_filter(const struct task *task, const struct spec *spec, const struct scene *scene,
                                 const struct acquisition *acquisition, struct echoes *echoes)
{
    struct filtering filtering;
    struct kept all;
    struct echo_notes notes = scene_notes(scene), read = {.description = NULL};
    enum status status = filtering_open(acquisition, spec, &filtering);
    if (status != STATUS_OK)
        return status;
    status = task->echoes ? echo_notes_read(task->echoes, &read) : scene_echoes(scene, echoes);
    if (task->echoes) {
        notes = read;
        notes.description = "filtered";
    }
    if (status == STATUS_OK)
        status = filtered_write(&filtering, echoes, task->output, &notes, &all);
    echo_notes_free(&read);
    if (status == STATUS_OK) {
        printf("# %d sub-apertures, upsampled %d times\n", filtering.shape.subapertures, filtering.shape.upsampling);
        status = table_print(&filtering, scene, &all);
    }
    filtering_close(&filtering);
    return status;
}

enum status command_filter(const struct task *task)
{
    struct scene scene = {0};
    struct acquisition recorded = {0};
    struct echoes echoes = {0};
    struct spec usual = {0};
    enum status status = check_usage(task);
    if (status == STATUS_OK)
        status = spec_parse("wk_polar", &usual);
    if (status == STATUS_OK)
        status = task->echoes ? echo_file_read(task->echoes, &recorded, &echoes)
                              : scene_load(task->names[0], data_path(DATA_SCENES), &scene);
    if (status == STATUS_OK)
        status = source_filter(task, task->spec_count ? task->specs : &usual, &scene,
                               task->echoes ? &recorded : &scene.acquisition, &echoes);
    echoes_free(&echoes);
    acquisition_free(&recorded);
    scene_free(&scene);
    spec_free(&usual);
    return status;
}
