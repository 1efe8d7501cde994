/* The commands `simulate` and `image`. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#include "files/paths.h"
#include "choice/choice.h"
#include "echoes/echo_data.h"
#include "run/progress_line.h"
#include "text/shown_text.h"
#include "measure/darkness.h"
#include "imaging/imaging.h"
#include "imaging/probe.h"
#include "measure/outcome.h"
#include "results/provenance.h"
#include "echoes/matfile.h"
#include "scene/simulate.h"
#include "show/plot.h"
#include "show/table.h"
#include "advise/machine_rates.h"
#include "command/task.h"

static enum status pings_simulate(void *simulation, int first, int count, double complex *samples)
{
    return simulation_pings(simulation, first, count, samples);
}

enum status command_simulate(const struct task *task)
{
    struct scene scene;
    struct simulation *simulation = NULL;
    enum status status = output_check("simulate", task->output);
    if (status == STATUS_OK)
        status = scene_load(task->names[0], data_path(DATA_SCENES), &scene);
    if (status != STATUS_OK)
        return status;
    if (scene.recorded)
        status = status_set(STATUS_INVALID, "simulate: the echoes of %s are recorded, there is nothing to simulate",
                            scene.name);
    if (status == STATUS_OK)
        status = simulation_open(&scene, 1, &simulation);
    if (status == STATUS_OK) {
        const struct echo_notes notes = scene_notes(&scene);
        const struct sample_source source = {simulation_exponent(simulation), pings_simulate, simulation};
        status = echo_file_stream(task->output, &scene.acquisition, &source, &notes);
    }
    if (status == STATUS_OK)
        printf("%s: echoes of %s, %d samples x %d receivers x %d pings\n", task->output, scene.name,
               scene.acquisition.samples, scene.acquisition.receivers, scene.acquisition.pings);
    simulation_close(simulation);
    scene_free(&scene);
    return status;
}

void warnings_print(const struct condition *list, int count)
{
    char text[400];
    for (int k = 0; k < count; k++)
        if (list[k].severity == SEVERITY_WARN && !condition_holds(&list[k])) {
            outcome_warning(&list[k], text, sizeof text);
            shown_note(text);
        }
}

/* Warn of errors that the image shows. */
static void warn_of_image(const struct echoes *echoes, const struct image *image)
{
    const struct darkness darkness = image_darkness(echoes, image);
    struct condition list[DARKNESS_CONDITIONS];
    darkness_conditions(&darkness, list);
    progress_line_clear();
    warnings_print(list, DARKNESS_CONDITIONS);
}

/* By a plan that is made. */
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

/* Replace `auto` by its choice, from the echoes; its image is often formed already. */
static enum status choose(const struct spec *asked, const struct budget *budget, const struct scene *scene,
                          const struct echoes *from, struct image *image, struct image_origin *origin)
{
    const struct problem problem = scene_problem(scene, asked->precision);
    struct echoes echoes[2] = {[PRECISION_DOUBLE] = *from};
    struct choice choice = {.list = NULL};
    struct spec spec = {.algorithm = NULL};
    enum status status = echoes_convert(from, PRECISION_FLOAT, &echoes[PRECISION_FLOAT]);
    if (status != STATUS_OK)
        return status;
    status = choice_make(&problem, echoes, budget, &choice);
    if (status == STATUS_OK)
        status = choice_spec(&choice, budget, asked->precision, &spec);
    if (status == STATUS_OK) {
        char name[CANDIDATE_NAME];
        candidate_name(&choice.list[0], name);
        snprintf(origin->engine, sizeof origin->engine, "%s", name);
        *image = choice.image;
        choice.image = (struct image){0};
        if (image->patch_count == 0)
            status = imaging_form(&spec, &problem, &echoes[asked->precision], image, NULL);
    }
    spec_free(&spec);
    choice_free(&choice);
    echoes_free(&echoes[PRECISION_FLOAT]);
    return status;
}

/* The error of the finished image, against the exact image of some of its pixels. */
static enum status verify(const struct problem *problem, const struct echoes *from, const struct image *image)
{
    const struct region everywhere = {0, NULL};
    struct spec exact;
    struct probe probe;
    enum status status = spec_parse("reference:precision=double", &exact);
    if (status != STATUS_OK)
        return status;
    status = probe_make(&exact, problem, from, image, &everywhere, &probe);
    spec_free(&exact);
    if (status != STATUS_OK)
        return status;
    const struct probe_error e = probe_measure(&probe, image);
    progress_line_clear();
    if (isnan(e.error_gain))
        printf("No relative error: the exact image is zero on %d pixels.\n", e.pixels);
    else if (probe.whole)
        printf("Relative error %.2e after one gain, %.2e without, of all %d pixels.\n", e.error_gain, e.error,
               e.pixels);
    else
        printf("Relative error %.2e after one gain (95 %%: %.2e to %.2e), %.2e without, measured on %d pixels.\n",
               e.error_gain, e.low, e.high, e.error, e.pixels);
    probe_free(&probe);
    return STATUS_OK;
}

/* A plan comes before the echoes: what cannot be imaged need not be simulated. A choice comes after them. Extreme
   echoes are worked on divided by their power of two, which the finished image is multiplied by. */
static enum status form_image(const struct spec *spec, const struct scene *scene, bool verified, struct image *image,
                              struct image_origin *origin, double *seconds)
{
    const struct problem problem = scene_problem(scene, spec->precision);
    struct imaging imaging = {.algorithm = NULL};
    struct budget budget;
    const struct echoes recorded = {&scene->acquisition, PRECISION_DOUBLE, scene->recorded, 0};
    struct echoes made = {0};
    const bool choice = choice_asked(spec, &budget);
    enum status status = STATUS_OK;
    if (!choice) {
        progress_line(false, "%s: plan of %s", scene->name, spec->algorithm->name);
        status = imaging_open(spec, &problem, &imaging);
        if (status != STATUS_OK)
            return status;
        const struct work work = imaging.algorithm->work(imaging.plan);
        snprintf(origin->engine, sizeof origin->engine, "%s", work.engine);
    }
    progress_line(false, "%s: echoes", scene->name);
    const bool as_recorded = scene->recorded && echoes_exponent(&recorded, PRECISION_DOUBLE) == 0;
    if (!as_recorded)
        status = scene_echoes(scene, &made);
    struct echoes echoes = as_recorded ? recorded : made;
    echoes.exponent = 0;
    progress_line(false, "%s: image by %s", scene->name, spec->algorithm->name);
    const double begin = seconds_now();
    if (status == STATUS_OK)
        status =
            choice ? choose(spec, &budget, scene, &echoes, image, origin) : execute(spec, &imaging, &echoes, image);
    *seconds = seconds_now() - begin;
    if (status == STATUS_OK) {
        warn_of_image(&echoes, image);
        status = verified ? verify(&problem, &echoes, image) : STATUS_OK;
        if (status != STATUS_OK)
            image_free(image);
    }
    if (status == STATUS_OK)
        status = imaging_scale(spec->algorithm->name, made.exponent, image);
    echoes_free(&made);
    imaging_close(&imaging);
    return status;
}

static enum status check_usage(const struct task *task)
{
    if (!task->scene == !task->echoes)
        return status_set(STATUS_INVALID, "image: exactly one of --scene SCENE and --echoes FILE.mat is needed");
    if (task->spec_count != 1)
        return status_set(STATUS_INVALID, task->spec_count
                                              ? "image: --algorithm is given twice; one image has one SPEC"
                                              : "image: --algorithm SPEC is missing; `-a auto` chooses one");
    if (task->range && !output_is_picture(task->output))
        return status_set(STATUS_INVALID, "image: --range %s applies to pictures; -o FILE.png or FILE.svg is needed",
                          task->range);
    if (task->tile && task->memory)
        return status_set(STATUS_INVALID, "image: one of --tile %s and --memory %s is needed, not both", task->tile,
                          task->memory);
    if (image_is_tiled(task) && (output_is_picture(task->output) || task->verify))
        return status_set(STATUS_INVALID, "image: --%s %s fills a file of numbers: -o FILE.mat, without --verify",
                          task->tile ? "tile" : "memory", task->tile ? task->tile : task->memory);
    if (task->shard && !image_is_tiled(task))
        return status_set(STATUS_INVALID, "image: --shard %s shares tiles; --tile NxM or --memory BYTES is needed",
                          task->shard);
    double bytes;
    const enum status status = memory_of_tiles("image", task, &bytes);
    if (status != STATUS_OK)
        return status;
    return output_is_picture(task->output) ? picture_check("image", task->output) : output_check("image", task->output);
}

/* With --grid, the image of a scene has that grid. */
static enum status scene_open(const struct task *task, struct scene *scene)
{
    struct grid grid;
    if (task->echoes)
        return echoes_scene(task, scene);
    enum status status = task->grid ? grid_parse(task->grid, &grid) : STATUS_OK;
    if (status == STATUS_OK)
        status = scene_load(task->scene, data_path(DATA_SCENES), scene);
    if (status != STATUS_OK || !task->grid)
        return status;
    scene->patches[0] = grid;
    scene->patch_count = 1;
    status = grid_meets_records(&scene->acquisition, 1, scene->patches, task->grid);
    if (status != STATUS_OK)
        scene_free(scene);
    return status;
}

/* The image's origin but for its engine. */
static void origin_fill(const struct task *task, const struct scene *scene, struct image_origin *origin)
{
    const struct spec *spec = &task->specs[0];
    struct provenance provenance;
    provenance_fill(&provenance, 1);
    *origin = (struct image_origin){.fc = scene->acquisition.fc, .sound_speed = scene->acquisition.sound_speed};
    snprintf(origin->algorithm, sizeof origin->algorithm, "%s", spec->algorithm->name);
    snprintf(origin->options, sizeof origin->options, "%s", spec->text);
    snprintf(origin->scene, sizeof origin->scene, "%s", task->scene ? scene->name : task->echoes);
    snprintf(origin->scene_hash, sizeof origin->scene_hash, "%016" PRIx64, scene->hash);
    snprintf(origin->commit, sizeof origin->commit, "%s", provenance.commit);
    snprintf(origin->date, sizeof origin->date, "%s", provenance.date);
}

static enum status image_put(const struct task *task, const struct scene *scene, const struct image *image,
                             const struct image_origin *origin, double range_db)
{
    const struct spec *spec = &task->specs[0];
    if (!output_is_picture(task->output))
        return image_file_write(task->output, image, origin);
    char label[320], title[1000];
    picture_label(spec->algorithm->name, spec->text, precision_name(spec->precision), label, sizeof label);
    snprintf(title, sizeof title, "%.300s: %s%s", scene->name, label, origin_choice(origin).text);
    return picture_draw(task->output, true, image, title, range_db, scene);
}

/* Warn of faults of the scene before the work begins. */
static void warn(const struct spec *spec, const struct scene *scene)
{
    const struct problem problem = scene_problem(scene, spec->precision);
    struct condition list[SCENE_CONDITIONS + CONDITIONS_MAX];
    int count = scene_conditions(scene, list);
    count += algorithm_conditions(spec->algorithm, &problem, spec->options, list + count, CONDITIONS_MAX);
    warnings_print(list, count);
}

enum status command_image(const struct task *task)
{
    struct scene scene;
    struct image image;
    struct image_origin origin;
    double range_db, seconds = 0;
    machine_rates_use(NULL);
    enum status status = check_usage(task);
    if (status == STATUS_OK)
        status = range_parse("image", task->range, &range_db);
    if (status == STATUS_OK)
        status = scene_open(task, &scene);
    if (status != STATUS_OK)
        return status;
    warn(&task->specs[0], &scene);
    origin_fill(task, &scene, &origin);
    if (image_is_tiled(task)) {
        status = image_tiles(task, &scene, &origin);
        scene_free(&scene);
        return status;
    }
    status = form_image(&task->specs[0], &scene, task->verify, &image, &origin, &seconds);
    progress_line_clear();
    if (status == STATUS_OK) {
        status = image_put(task, &scene, &image, &origin, range_db);
        if (status == STATUS_OK) {
            printf("%s: %s of %s%s, %s\n", task->output, origin.algorithm, scene.name, origin_choice(&origin).text,
                   cell_time(seconds).text);
            image_describe(&image);
        }
        image_free(&image);
    }
    scene_free(&scene);
    return status;
}
