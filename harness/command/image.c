/* The commands `simulate` and `image`. */
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "data/echo_data.h"
#include "measure/imaging.h"
#include "scene/matfile.h"
#include "scene/simulate.h"
#include "command/task.h"

enum status output_check(const char *command, const char *output)
{
    const char *extension = output ? strrchr(output, '.') : NULL;
    if (!output)
        return status_set(STATUS_INVALID, "%s: -o FILE.mat is missing", command);
    enum status status = matfile_place(output);
    if (status == STATUS_OK && (!extension || strcasecmp(extension, ".mat") != 0))
        status = status_set(STATUS_INVALID, "%s: -o %s is of no known kind; accepted: FILE.mat", command, output);
    return status;
}

enum status command_simulate(const struct task *task)
{
    struct scene scene;
    struct echoes echoes;
    enum status status = output_check("simulate", task->output);
    if (status == STATUS_OK)
        status = scene_load(task->names[0], SCENE_DIRECTORY, &scene);
    if (status != STATUS_OK)
        return status;
    status = scene_simulate(&scene, &echoes);
    if (status == STATUS_OK) {
        status = echo_file_write(task->output, &echoes, scene.description);
        echoes_free(&echoes);
    }
    scene_free(&scene);
    return status;
}

/* A scene, or the echoes of a file. */
struct source {
    struct scene scene;          /* zeroed with --echoes */
    struct acquisition recorded; /* zeroed with --scene */
    struct echoes echoes;        /* double; with --scene they are made when a plan is there */
};

static void source_free(struct source *source)
{
    echoes_free(&source->echoes);
    acquisition_free(&source->recorded);
    scene_free(&source->scene);
}

static enum status source_open(const struct task *task, struct source *source)
{
    *source = (struct source){0};
    if (task->echoes)
        return echo_file_read(task->echoes, &source->recorded, &source->echoes);
    return scene_load(task->scene, SCENE_DIRECTORY, &source->scene);
}

static enum status execute(const struct spec *spec, struct imaging *imaging, const struct echoes *from,
                           struct image *image)
{
    struct echoes echoes;
    struct stages stages;
    enum status status = echoes_convert(from, spec->precision, &echoes);
    if (status != STATUS_OK)
        return status;
    stages_begin(&stages);
    status = imaging_execute(imaging, &echoes, &stages);
    if (status == STATUS_OK)
        status = imaging_finish(imaging, &echoes, image);
    echoes_free(&echoes);
    return status;
}

/* The plan comes first: what cannot be imaged need not be simulated. */
static enum status form_image(const struct spec *spec, const struct problem *problem, struct source *source,
                              struct image *image)
{
    struct imaging imaging;
    enum status status = imaging_open(spec, problem, &imaging);
    if (status != STATUS_OK)
        return status;
    if (!source->echoes.samples)
        status = scene_simulate(&source->scene, &source->echoes);
    if (status == STATUS_OK)
        status = execute(spec, &imaging, &source->echoes, image);
    imaging_close(&imaging);
    return status;
}

static enum status check_usage(const struct task *task)
{
    if (!task->scene == !task->echoes)
        return status_set(STATUS_INVALID, "image: exactly one of --scene SCENE and --echoes FILE.mat is needed");
    if (task->echoes && !task->grid)
        return status_set(STATUS_INVALID, "image: --echoes %s needs --grid xmin:xstep:xcount,rmin:rstep:rcount",
                          task->echoes);
    if (task->spec_count != 1)
        return status_set(STATUS_INVALID, "image: %d --algorithm SPEC given, exactly one is needed", task->spec_count);
    return output_check("image", task->output);
}

enum status command_image(const struct task *task)
{
    struct grid grid;
    struct source source;
    struct image image;
    enum status status = check_usage(task);
    if (status == STATUS_OK && task->grid)
        status = grid_parse(task->grid, &grid);
    if (status != STATUS_OK)
        return status;
    status = source_open(task, &source);
    if (status == STATUS_OK) {
        const struct spec *spec = &task->specs[0];
        const struct acquisition *acquisition = task->echoes ? &source.recorded : &source.scene.acquisition;
        struct problem problem = {acquisition, source.scene.patch_count, source.scene.patches, spec->precision};
        if (task->grid) {
            problem.patch_count = 1;
            problem.patches = &grid;
            status = grid_meets_records(problem.acquisition, 1, &grid, task->grid);
        }
        if (status == STATUS_OK)
            status = form_image(spec, &problem, &source, &image);
        if (status == STATUS_OK) {
            status = image_file_write(task->output, &image, spec->algorithm->name, spec->text,
                                      task->scene ? source.scene.name : task->echoes);
            image_free(&image);
        }
    }
    source_free(&source);
    return status;
}
