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
    if (scene.recorded)
        status = status_set(STATUS_INVALID, "simulate: the echoes of %s are recorded, there is nothing to simulate",
                            scene.name);
    if (status == STATUS_OK)
        status = scene_simulate(&scene, &echoes);
    if (status == STATUS_OK) {
        status = echo_file_write(task->output, &echoes, scene.description);
        echoes_free(&echoes);
    }
    scene_free(&scene);
    return status;
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
static enum status form_image(const struct spec *spec, const struct scene *scene, struct image *image)
{
    const struct problem problem = {&scene->acquisition, scene->patch_count, scene->patches, spec->precision};
    struct imaging imaging;
    struct echoes simulated = {0}, recorded = {&scene->acquisition, PRECISION_DOUBLE, scene->recorded, 0};
    enum status status = imaging_open(spec, &problem, &imaging);
    if (status != STATUS_OK)
        return status;
    if (!scene->recorded)
        status = scene_simulate(scene, &simulated);
    if (status == STATUS_OK)
        status = execute(spec, &imaging, scene->recorded ? &recorded : &simulated, image);
    echoes_free(&simulated);
    imaging_close(&imaging);
    return status;
}

static enum status check_usage(const struct task *task)
{
    if (!task->scene == !task->echoes)
        return status_set(STATUS_INVALID, "image: exactly one of --scene SCENE and --echoes FILE.mat is needed");
    if (task->spec_count != 1)
        return status_set(STATUS_INVALID, "image: %d --algorithm SPEC given, exactly one is needed", task->spec_count);
    return output_check("image", task->output);
}

/* With --grid the image of a scene is that one. */
static enum status scene_open(const struct task *task, struct scene *scene)
{
    struct grid grid;
    if (task->echoes)
        return echoes_scene("image", task, scene);
    enum status status = task->grid ? grid_parse(task->grid, &grid) : STATUS_OK;
    if (status == STATUS_OK)
        status = scene_load(task->scene, SCENE_DIRECTORY, scene);
    if (status != STATUS_OK || !task->grid)
        return status;
    scene->patches[0] = grid;
    scene->patch_count = 1;
    status = grid_meets_records(&scene->acquisition, 1, scene->patches, task->grid);
    if (status != STATUS_OK)
        scene_free(scene);
    return status;
}

enum status command_image(const struct task *task)
{
    struct scene scene;
    struct image image;
    enum status status = check_usage(task);
    if (status == STATUS_OK)
        status = scene_open(task, &scene);
    if (status != STATUS_OK)
        return status;
    const struct spec *spec = &task->specs[0];
    status = form_image(spec, &scene, &image);
    if (status == STATUS_OK) {
        status = image_file_write(task->output, &image, spec->algorithm->name, spec->text,
                                  task->scene ? scene.name : task->echoes);
        image_free(&image);
    }
    scene_free(&scene);
    return status;
}
