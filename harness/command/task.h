/* A command's arguments, and the commands themselves. */
#ifndef SASBENCH_COMMAND_TASK_H
#define SASBENCH_COMMAND_TASK_H

#include "files/paths.h"
#include "imaging/spec.h"
#include "scene/scene.h"

/* The command line after parsing; texts are borrowed from argv. Unused fields are NULL or 0. */
struct task {
    const char *const *names; /* [name_count] arguments without an option: scenes, an algorithm */
    int name_count;
    const char *output, *scene, *echoes, *grid, *at, *markdown, *json, *range, *precision, *error, *time, *memory,
        *nodes, *seed, *name, *seconds, *tile, *threads, *shard, *timeout;
    bool ab, quick, all, flops, verify, docs, site;
    int spec_count;
    struct spec *specs; /* [spec_count] of --algorithm */
};

/* Does a path (NULL: no) end in an extension, ".mat", in lower or upper case? */
bool has_extension(const char *path, const char *extension);
/* Check -o of a command that writes a MATLAB file, or a picture: its place exists, its extension fits. Errors:
   STATUS_INVALID. */
enum status output_check(const char *command, const char *output);
enum status picture_check(const char *command, const char *output);
bool output_is_picture(const char *output); /* by its extension; NULL is none */
/* --range: dB below the peak; NULL is the default. Errors: STATUS_INVALID. */
enum status range_parse(const char *command, const char *text, double *range_db);
/* --memory: "4G", "2GB", "512MiB" as bytes. Errors: STATUS_INVALID. */
enum status memory_parse(const char *command, const char *text, double *bytes);
/* The same for images in tiles, which need --echoes; 0 without --memory. Errors: STATUS_INVALID. */
enum status memory_of_tiles(const char *command, const struct task *task, double *bytes);
/* Draw an image, with the points of a scene (NULL: none) named in it; `named`: the user gave the path. Errors: as
   plot_image. */
enum status picture_draw(const char *path, bool named, const struct image *image, const char *title, double range_db,
                         const struct scene *scene);
/* Draw an image and its difference to another of the same grid; the user gave the path. Errors: as plot_image. */
enum status picture_differ(const char *path, const struct image *image, const struct image *reference,
                           const char *const names[2]);
struct image_origin;
/* " chose SETTING" of an image by `auto`, else empty. */
struct choice_text {
    char text[280];
} origin_choice(const struct image_origin *origin);
/* Print an image's origin beside its scene, algorithm and options. */
void origin_print(const struct image_origin *origin);
/* Print its extent and its peak. */
void image_describe(const struct image *image);

/* The scene of --echoes and --grid. Errors: as scene_from_echoes; *scene needs no scene_free then. */
enum status echoes_scene(const struct task *task, struct scene *scene);
/* Scenes by name; without names those of `usual` (NULL: all that are not full size), or that of --echoes. Freed with
   scenes_free even on failure. Errors: as scenes_load. */
enum status task_scenes(const char *command, const struct task *task, int usual_count, const char *const *usual,
                        struct scene **scenes, int *count);

/* Each returns STATUS_OK, or a status with a message for main to print. */
enum status command_list(const struct task *task);
enum status command_conformance(const struct task *task);
enum status command_info(const struct task *task);
enum status command_convert(const struct task *task);
enum status command_simulate(const struct task *task);
enum status command_image(const struct task *task);
/* Print those of conditions that warn and are not met. */
struct condition;
void warnings_print(const struct condition *list, int count);
/* `image --tile`, or --memory: form the tiles that its file lacks. */
bool image_is_tiled(const struct task *task);
enum status image_tiles(const struct task *task, const struct scene *scene, const struct image_origin *origin);
enum status command_filter(const struct task *task);
enum status command_merge(const struct task *task);
enum status command_score(const struct task *task);
enum status command_show(const struct task *task);
enum status command_run(const struct task *task);
enum status command_compare(const struct task *task);
enum status command_measure(const struct task *task);
enum status command_baseline(const struct task *task);
enum status command_reproduce(const struct task *task);
enum status command_sweep(const struct task *task);
enum status command_report(const struct task *task);
enum status command_phase(const struct task *task);
enum status command_check(const struct task *task);
enum status command_plan(const struct task *task);
enum status command_scenes(const struct task *task);
enum status command_bench(const struct task *task);
enum status command_stability(const struct task *task);

#endif
