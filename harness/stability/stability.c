/* The run over extreme scenes (stability.h). */
#include "stability/stability.h"

#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "files/folder.h"
#include "files/paths.h"
#include "ranks/cells.h"
#include "run/progress_line.h"
#include "text/shown_text.h"
#include "results/provenance.h"
#include "show/plot.h"
#include "stability/stability_table.h"

/* In addition to every default algorithm: the plain paths, the engine that is not chosen for small images, and motion
   compensation. */
static const char *const settings[] = {"bp_nearest:exact=true", "bp_nearest:engine=invariant",
                                       "bp_sinc:window=kaiser,exact=true", "monostatic | rma_delay"};
enum { SETTINGS = sizeof settings / sizeof *settings };

/* One of each family: geometry, coordinates, speed, phase, band, sampling, ties, ends, amplitude, cancellation,
 * refusals. */
static const char *const quick_scenes[] = {"base",         "near_r_lt_array", "r_zero",         "utm",
                                           "v_c_1-1e-6",   "v_zero",          "v_gt_c",         "phase_1e9",
                                           "phase_1e14",   "band_edge_dc",    "fs_eq_B",        "tie_exact",
                                           "amp_denormal", "near_equal",      "outside_record", "all_zero"};
enum { QUICK_SCENES = sizeof quick_scenes / sizeof *quick_scenes, QUICK_MODES = 2 };

/* The scenes and specs of a run, and the place of its rows. */
struct run {
    int scene_count, spec_count, mode_count;
    char **scenes; /* [scene_count] */
    struct spec *specs;
    struct stability_row *rows; /* [scene_count][spec_count] */
};

static void run_free(struct run *run)
{
    for (int k = 0; k < run->scene_count; k++)
        free(run->scenes[k]);
    for (int k = 0; k < run->spec_count; k++)
        spec_free(&run->specs[k]);
    free(run->scenes);
    free(run->specs);
    free(run->rows);
}

/* A scene may be refused, which becomes a row; a missing file is a mistake. */
static enum status scene_find(const char *name)
{
    char path[4096];
    const char *end = strrchr(name, '.');
    if (end && strcmp(end, ".cfg") == 0)
        snprintf(path, sizeof path, "%s", name);
    else
        snprintf(path, sizeof path, "%s/%s.cfg", data_path(DATA_SCENES), name);
    return access(path, R_OK) == 0 ? STATUS_OK
                                   : status_set(STATUS_INVALID,
                                                "%s: no scene can be read there, must be a path to a "
                                                ".cfg file or a name below %s",
                                                path, data_path(DATA_SCENES));
}

static enum status scenes_choose(const struct stability_request *request, struct run *run)
{
    char **names = NULL;
    int count = request->scene_count ? request->scene_count : QUICK_SCENES;
    enum status status = STATUS_OK;
    const char *const *list = request->scene_count ? request->scenes : quick_scenes;
    const char *before = request->scene_count ? "" : SCENES_EXTREME "/";
    if (!request->scene_count && !request->quick) {
        status = scene_names(data_path(DATA_EXTREME), &names, &count);
        list = (const char *const *)names;
    }
    run->scenes = status == STATUS_OK ? calloc((size_t)count + 1, sizeof *run->scenes) : NULL;
    for (int k = 0; k < count && run->scenes; k++) {
        size_t size = strlen(before) + strlen(list[k]) + 1;
        run->scenes[k] = malloc(size);
        if (!run->scenes[k])
            break;
        snprintf(run->scenes[k], size, "%s%s", before, list[k]);
        run->scene_count++;
        if (request->scene_count && status == STATUS_OK)
            status = scene_find(list[k]);
    }
    if (names)
        scene_names_free(names, count);
    if (status == STATUS_OK && run->scene_count < count)
        status = status_set(STATUS_FAILED, "stability: no memory for %d scenes", count);
    return status;
}

/* Drop the scenes of other shards, by the work of their exact images; those that are refused, which take no time, are
   the first shard's. With one thread: processes that are forked later could not use the others. */
static enum status scenes_share(struct run *run, const struct shard *shard)
{
    const int threads = omp_get_max_threads();
    struct cells cells = {.list = NULL};
    struct spec exact;
    int count = 0, *of = calloc((size_t)run->scene_count + 1, sizeof *of); /* the cells' scene; -1: refused */
    enum status status = of ? spec_parse("reference:precision=double", &exact)
                            : status_set(STATUS_FAILED, "stability: no memory for %d scenes", run->scene_count);
    if (status != STATUS_OK) {
        free(of);
        return status;
    }
    omp_set_num_threads(1);
    for (int k = 0; k < run->scene_count && status == STATUS_OK; k++) {
        struct scene scene;
        status = scene_load(run->scenes[k], data_path(DATA_SCENES), &scene);
        of[k] = -1;
        if (status == STATUS_OK) {
            status = cells_add(&cells, &scene, 1, &exact);
            of[k] = status == STATUS_OK ? cells.list[cells.count - 1].scene : -1;
            scene_free(&scene);
        } else if (status == STATUS_INVALID) {
            status = STATUS_OK;
        }
    }
    if (status == STATUS_OK)
        status = cells_deal(&cells, shard);
    for (int k = 0; k < run->scene_count && status == STATUS_OK; k++) {
        int n = 0;
        while (n < cells.count && cells.list[n].scene != of[k])
            n++;
        if (n < cells.count ? cells.list[n].mine : shard->number == 1)
            run->scenes[count++] = run->scenes[k];
        else
            free(run->scenes[k]);
    }
    if (status == STATUS_OK)
        run->scene_count = count;
    omp_set_num_threads(threads);
    cells_free(&cells);
    spec_free(&exact);
    free(of);
    return status;
}

/* A SPEC in the precision that it names, or in both. */
static enum status spec_add(struct run *run, const struct spec *spec)
{
    enum status status = STATUS_OK;
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        struct spec *added = &run->specs[run->spec_count];
        if (spec_given(spec, "precision") && spec->precision != (enum precision)k)
            continue;
        status = spec_copy(spec, added);
        added->precision = (enum precision)k;
        run->spec_count += status == STATUS_OK;
    }
    return status;
}

/* `auto` is a choice among the others, not a method of its own. */
static enum status spec_take(struct run *run, const struct spec *spec, bool asked)
{
    if (spec->algorithm->plan)
        return spec_add(run, spec);
    return asked ? status_set(STATUS_INVALID, "stability: %s chooses among the other algorithms; try one of these",
                              spec->algorithm->name)
                 : STATUS_OK;
}

static enum status specs_choose(const struct stability_request *request, struct run *run)
{
    int all = 0;
    while (algorithms[all])
        all++;
    int count = request->spec_count ? request->spec_count : all + SETTINGS;
    enum status status = STATUS_OK;
    run->specs = calloc(2 * (size_t)count, sizeof *run->specs);
    if (!run->specs)
        return status_set(STATUS_FAILED, "stability: no memory for %d algorithms", count);
    for (int k = 0; k < count && status == STATUS_OK; k++) {
        if (request->spec_count) {
            status = spec_take(run, &request->specs[k], true);
            continue;
        }
        struct spec spec;
        status = spec_own(k < all ? algorithms[k]->name : settings[k - all], &spec);
        if (status == STATUS_OK)
            status = spec_take(run, &spec, false);
        spec_free(&spec);
    }
    return status;
}

/* A refused scene is refused for every SPEC. */
static enum status scene_check(struct run *run, int index)
{
    struct stability_row *rows = run->rows + index * run->spec_count;
    struct scene scene;
    struct trial trial;
    for (int k = 0; k < run->spec_count; k++)
        rows[k] = (struct stability_row){run->scenes[index], &run->specs[k], {0}};
    enum status status = scene_load(run->scenes[index], data_path(DATA_SCENES), &scene);
    if (status == STATUS_INVALID) {
        for (int k = 0; k < run->spec_count; k++)
            rows[k].verdict = refusal_verdict(status_message());
        return STATUS_OK;
    }
    if (status == STATUS_OK) {
        status = trial_run(&scene, run->specs, run->spec_count, run->mode_count, &trial);
        for (int k = 0; k < run->spec_count && status == STATUS_OK; k++)
            rows[k].verdict = trial_verdict(&trial, k);
        if (status == STATUS_OK)
            trial_close(&trial);
        scene_free(&scene);
    }
    return status;
}

static enum status run_open(const struct stability_request *request, struct run *run)
{
    struct shard shard;
    *run = (struct run){.mode_count = request->quick ? QUICK_MODES : TRIAL_MODES};
    enum status status = shard_parse("stability", request->shard, &shard);
    if (status == STATUS_OK)
        status = scenes_choose(request, run);
    if (status == STATUS_OK && shard.count > 0)
        status = scenes_share(run, &shard);
    if (status == STATUS_OK)
        status = specs_choose(request, run);
    if (status == STATUS_OK) {
        run->rows = calloc((size_t)run->scene_count * (size_t)run->spec_count + 1, sizeof *run->rows);
        if (!run->rows)
            status = status_set(STATUS_FAILED, "stability: no memory for %d scenes", run->scene_count);
    }
    return status;
}

/* The files of the folder. A picture that cannot be drawn is no failure. */
static enum status run_write(const struct run *run, const char *directory)
{
    char measured[4096], expected[4096], picture[4096], footer[PROVENANCE_LINE];
    int count = run->scene_count * run->spec_count;
    snprintf(measured, sizeof measured, "%s/stability.csv", directory);
    snprintf(expected, sizeof expected, "%s/expected.csv", directory);
    snprintf(picture, sizeof picture, "%s/stability.png", directory);
    enum status status = stability_write(measured, run->mode_count, count, run->rows);
    if (status == STATUS_OK)
        status = stability_expected_write(expected, count, run->rows);
    provenance_line(footer);
    if (status == STATUS_OK && plot_csv(picture, data_path(DATA_PLOTS), "stability.gp", measured, footer) != STATUS_OK)
        shown_note(status_message());
    return status;
}

/* Compare rows with the expected ones, in words. */
static enum status run_compare(const struct run *run, const char *expected, const char *directory)
{
    int differ, unknown, count = run->scene_count * run->spec_count;
    printf("\n");
    enum status status = stability_compare(expected, count, run->rows, &differ, &unknown);
    if (status != STATUS_OK)
        return status;
    printf("%d rows in %d rounding modes, with one and two threads: %d as expected, %d not, %d without "
           "an expectation.\nResults: %s/stability.csv, stability.png\n",
           count, run->mode_count, count - differ - unknown, differ, unknown, directory);
    return differ == 0
               ? STATUS_OK
               : status_set(STATUS_FAILED, "stability: %d of %d rows are not as %s expects", differ, count, expected);
}

enum status stability_run(const struct stability_request *request, const char *expected)
{
    struct run run;
    int lock = -1;
    enum status status = run_open(request, &run);
    if (status == STATUS_OK)
        status = directory_make(request->directory);
    if (status == STATUS_OK)
        status = folder_take(request->directory, &lock);
    if (status == STATUS_OK)
        stability_table_head();
    for (int k = 0; k < run.scene_count && status == STATUS_OK; k++) {
        progress_line(false, "[%d/%d] %s", k + 1, run.scene_count, run.scenes[k]);
        status = scene_check(&run, k);
        progress_line_clear();
        if (status == STATUS_OK)
            stability_table_line(run.spec_count, run.rows + k * run.spec_count);
    }
    if (status == STATUS_OK)
        status = run_write(&run, request->directory);
    if (status == STATUS_OK)
        status = run_compare(&run, expected, request->directory);
    folder_leave(lock);
    run_free(&run);
    return status;
}
