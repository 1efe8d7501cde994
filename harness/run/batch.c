/* Scenes measured with algorithms (batch.h). */
#include "run/batch.h"
#include "files/paths.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "advise/check.h"
#include "echoes/echo_data.h"
#include "guests/external.h"
#include "ranks/rank_folders.h"
#include "ranks/ranks.h"
#include "run/progress_line.h"
#include "run/supervisor.h"
#include "run/visit.h"
#include "show/table.h"
#include "text/shown_text.h"

/* A scene whose echoes cannot be made gets a failed row for every missing algorithm, and the next scene follows. */
static enum status fail_scene(struct batch *batch, const struct scene *scene, int spec_count, const struct spec *specs)
{
    char reason[512];
    enum status status = STATUS_OK;
    snprintf(reason, sizeof reason, "%s", status_message());
    batch->failed = true;
    for (int k = 0; k < spec_count && status == STATUS_OK; k++, batch->done++) {
        struct measurement row = visit_failed_row(batch, scene, &specs[k], reason);
        const struct measurement *earlier = batch_find(batch, scene, &specs[k]);
        if (!earlier)
            status = results_folder_add(batch->results, &row);
        if (status == STATUS_OK)
            table_row(stdout, earlier ? earlier : &row);
    }
    fflush(stdout);
    return status;
}

static void works_print(const struct scene *scene, int spec_count, const struct spec *specs)
{
    char text[512];
    table_works_header(stdout);
    for (int k = 0; k < spec_count; k++) {
        const struct algorithm *algorithm = specs[k].algorithm;
        const struct problem problem = session_problem(scene, algorithm, specs[k].precision);
        const struct measurement row = measurement_empty("", algorithm->name, specs[k].text, specs[k].precision);
        void *plan = NULL;
        measurement_spec(&row, text, sizeof text);
        if (algorithm_plan(algorithm, &problem, specs[k].options, &plan) == STATUS_OK) {
            const struct work work = algorithm->work(plan);
            table_work(stdout, text, &work);
        }
        algorithm->destroy(plan);
    }
}

/* ", about 4 min to go", from the rows measured so far. */
static void to_go_format(const struct batch *batch, char *text, size_t size)
{
    const double left = (seconds_now() - batch->begin) / batch->measured * (batch->rows - batch->done);
    *text = '\0';
    if (batch->measured >= 5)
        snprintf(text, size, left < 90 ? ", about %.0f s to go" : ", about %.0f min to go",
                 left < 90 ? left : left / 60);
}

void batch_progress(const struct batch *batch, const char *scene, const char *what)
{
    char left[60];
    to_go_format(batch, left, sizeof left);
    progress_line(true, "[%d/%d%s] %s %s", batch->done + 1, batch->rows, left, scene, what);
}

const struct measurement *batch_find(const struct batch *batch, const struct scene *scene, const struct spec *spec)
{
    return results_folder_find(batch->results, scene->name, spec->algorithm->name, spec->text,
                               precision_name(spec->precision));
}

/* A patch costs back projection little and range migration as much as the whole swath: the heading shows the share
   of the ranges. */
static void heading_print(const struct scene *scene)
{
    const struct acquisition *a = &scene->acquisition;
    double pixels = 0, imaged_m = 0, recorded_m = a->samples * a->sound_speed / (2 * a->fs);
    char what[160], size[60];
    for (int k = 0; k < scene->patch_count; k++) {
        pixels += (double)grid_pixels(&scene->patches[k]);
        imaged_m += scene->patches[k].r_count * scene->patches[k].r_step;
    }
    if (scene->patch_count == 1)
        snprintf(size, sizeof size, "%d x %d pixels", scene->patches[0].x_count, scene->patches[0].r_count);
    else
        snprintf(size, sizeof size, "%.0f pixels in %d patches", pixels, scene->patch_count);
    snprintf(what, sizeof what, "%s, %.3g %% of the ranges, %s echoes", size, 100 * fmin(imaged_m / recorded_m, 1),
             a->compressed ? "compressed" : "raw");
    table_scene(stdout, scene->name, what);
    check_warnings(stdout, scene, false);
}

/* A scene while its parts are measured. */
struct stay {
    struct visit visit;
    bool begun, visited, refused; /* `refused`: its echoes cannot be made */
};

/* Is there anything to do but print? */
static bool part_is_left(const struct batch *batch, const struct scene *scene, int spec_count, const struct spec *specs)
{
    for (int k = 0; k < spec_count; k++)
        if (!batch_find(batch, scene, &specs[k]))
            return true;
    return visit_pictures_missing(batch, scene, spec_count, specs);
}

/* Declare scene and algorithms, and open the visit where it is needed. */
static enum status part_begin(struct batch *batch, struct stay *stay, const struct scene *scene, int spec_count,
                              const struct spec *specs)
{
    enum status status = stay->begun ? STATUS_OK : results_folder_scene(batch->results, scene->name, scene->hash);
    for (int k = 0; k < spec_count && status == STATUS_OK; k++)
        if (specs[k].algorithm->origin)
            status = results_folder_algorithm(batch->results, specs[k].algorithm->name, specs[k].algorithm->origin);
    if (status != STATUS_OK)
        return status;
    if (!stay->begun)
        heading_print(scene);
    stay->begun = true;
    if (!stay->visited && !stay->refused && part_is_left(batch, scene, spec_count, specs)) {
        batch_progress(batch, scene->name, "echoes and exact image");
        stay->visited = visit_open(batch, scene, spec_count, specs, &stay->visit) == STATUS_OK;
        stay->refused = !stay->visited;
        progress_line_clear();
    }
    stay->visit.specs = specs;
    stay->visit.spec_count = spec_count;
    return STATUS_OK;
}

static enum status part_measure(struct batch *batch, struct stay *stay, const struct scene *scene, int spec_count,
                                const struct spec *specs)
{
    struct visit *visit = &stay->visit;
    enum status status = part_begin(batch, stay, scene, spec_count, specs);
    if (status == STATUS_OK && stay->refused)
        return fail_scene(batch, scene, spec_count, specs);
    for (int k = 0; k < spec_count && status == STATUS_OK; k++, batch->done++) {
        const struct measurement *row = batch_find(batch, scene, &specs[k]);
        if (stay->visited && visit->samples && k % TURNS == 0)
            visit_turns(batch, visit, k);
        batch_progress(batch, scene->name, specs[k].algorithm->name);
        batch->measured += !row;
        if (!row)
            status = visit_measure(batch, visit, k);
        else if (stay->visited && batch->details)
            visit_redraw(visit, k, row);
        progress_line_clear();
        if (row && status == STATUS_OK)
            table_row(stdout, row);
        fflush(stdout);
    }
    return status;
}

static void stay_end(struct batch *batch, struct stay *stay, bool drawn)
{
    const double begin = seconds_now();
    table_scene_end(stdout);
    if (!stay->visited)
        return;
    if (drawn && batch->details)
        pictures_draw(&stay->visit.pictures);
    batch->drawn_s += seconds_now() - begin;
    batch->undrawn += stay->visit.pictures.queue.undrawn;
    batch->spent.planning += stay->visit.session.spent.planning;
    batch->spent.imaging += stay->visit.session.spent.imaging;
    visit_close(&stay->visit);
}

/* ---- parts of a run ---- */

static bool is_shared(const struct batch *batch)
{
    return batch->shard.count > 0 || ranks_count() > 1;
}

enum status batch_cells(struct batch *batch, const struct scene *scene, int spec_count, const struct spec *specs)
{
    const int first = batch->cells.count;
    enum status status = is_shared(batch) ? cells_add(&batch->cells, scene, spec_count, specs) : STATUS_OK;
    if (status == STATUS_OK && ranks_count() > 1 && ranks_number() == 0) {
        status = results_folder_scene(batch->results, scene->name, scene->hash);
        for (int k = 0; k < spec_count; k++)
            batch->cells.list[first + k].mine = !batch_find(batch, scene, &specs[k]);
    }
    return status;
}

/* Rank 0: what is to be done. */
static enum status cells_offer(const struct cells *cells)
{
    int count = 0, *tasks = calloc((size_t)cells->count + 1, sizeof *tasks);
    if (!tasks)
        return status_set(STATUS_FAILED, "no memory for %d cells", cells->count);
    for (int n = 0; n < cells->count; n++)
        if (cells->list[n].mine)
            tasks[count++] = n;
    ranks_offer(count, tasks, false);
    free(tasks);
    return STATUS_OK;
}

enum status batch_deal(struct batch *batch)
{
    enum status status = cells_deal(&batch->cells, &batch->shard);
    if (!is_shared(batch) || status != STATUS_OK)
        return status;
    batch->details = batch->works = false;
    if (ranks_count() > 1)
        return ranks_number() == 0 ? cells_offer(&batch->cells) : STATUS_OK;
    batch->rows = 0;
    for (int n = 0; n < batch->cells.count; n++)
        batch->rows += batch->cells.list[n].mine;
    return STATUS_OK;
}

const struct scene *batch_nth(const struct batch *batch, const struct scene *scenes, int k)
{
    return ranks_count() > 1 ? &scenes[cells_scene(&batch->cells, k)] : &scenes[k];
}

/* The next cells of a scene that rank 0 hands to this rank; several where settings are timed in turn, fewer towards
   the end. */
static int part_next(struct batch *batch, const struct scene *scene, int spec_count, const struct spec *specs,
                     struct spec *part)
{
    struct cells *cells = &batch->cells;
    int count = 0, most = 1;
    while (count < most) {
        if (cells->next < 0)
            cells->next = ranks_next();
        if (cells->next < 0)
            cells->next = cells->count;
        int k = 0;
        while (k < spec_count && !cells_is(cells, cells->next, scene->name, &specs[k]))
            k++;
        if (k == spec_count)
            break;
        if (count == 0) {
            const int fair = (cells->count - cells->next) / (2 * ranks_count());
            most = !batch->in_turn || fair < 1 ? 1 : fair < TURNS ? fair : TURNS;
            batch->measured += cells->next - batch->done;
            batch->done = cells->next;
        }
        part[count++] = specs[k];
        cells->next = -1;
    }
    return count;
}

static int part_of_shard(const struct batch *batch, const struct scene *scene, int spec_count, const struct spec *specs,
                         struct spec *part)
{
    int count = 0;
    for (int k = 0; k < spec_count; k++) {
        const int n = cells_find(&batch->cells, scene->name, &specs[k]);
        if (n >= 0 && batch->cells.list[n].mine)
            part[count++] = specs[k];
    }
    return count;
}

/* By one part of the scene's SPECs after the other. */
static enum status scene_parts(struct batch *batch, struct stay *stay, const struct scene *scene, int spec_count,
                               const struct spec *specs)
{
    struct spec *part = malloc((size_t)spec_count * sizeof *part + 1);
    enum status status = STATUS_OK;
    int count = 1;
    if (!part)
        return status_set(STATUS_FAILED, "%s: no memory for %d algorithms", scene->name, spec_count);
    if (batch->shard.count > 0) {
        count = part_of_shard(batch, scene, spec_count, specs, part);
        status = count > 0 ? part_measure(batch, stay, scene, count, part) : STATUS_OK;
        count = 0;
    }
    while (count > 0 && status == STATUS_OK) {
        count = part_next(batch, scene, spec_count, specs, part);
        if (count > 0)
            status = part_measure(batch, stay, scene, count, part);
    }
    free(part);
    return status;
}

enum status batch_scene(struct batch *batch, const struct scene *scene, int spec_count, const struct spec *specs)
{
    struct stay stay = {.begun = false};
    enum status status = is_shared(batch) ? scene_parts(batch, &stay, scene, spec_count, specs)
                                          : part_measure(batch, &stay, scene, spec_count, specs);
    if (stay.begun)
        stay_end(batch, &stay, status == STATUS_OK);
    if (status == STATUS_OK && batch->works)
        works_print(scene, spec_count, specs);
    return status;
}

/* Rows of other ranks may have failed. */
static enum status failed_find(struct batch *batch)
{
    char path[4400];
    struct results results;
    snprintf(path, sizeof path, "%s/measurements.csv", batch->directory);
    const enum status status = results_read(path, &results);
    for (int k = 0; k < results.csv.row_count; k++)
        batch->failed |= strcmp(results.measurements[k].status, "failed") == 0;
    results_free(&results);
    return status;
}

enum status batch_join(struct batch *batch, bool *whole)
{
    *whole = !is_shared(batch);
    if (batch->shard.count > 0)
        printf("\nShard %d/%d: %d of %d cells are in %s. When all are done: %s merge FOLDER ... -o DIR\n",
               batch->shard.number, batch->shard.count, batch->rows, batch->cells.count, batch->directory,
               program_called());
    if (ranks_count() == 1 || ranks_number() > 0)
        return STATUS_OK;
    ranks_join();
    *whole = true;
    enum status status = results_folder_close(batch->results);
    batch->results = NULL;
    if (status == STATUS_OK)
        status = rank_folders_join(batch->directory);
    if (status == STATUS_OK)
        status = results_folder_open(batch->directory, &batch->provenance, &batch->results);
    return status == STATUS_OK ? failed_find(batch) : status;
}

/* Rank 0, or the only process, takes up what ranks that were ended have left. */
static enum status folder_open(const char *directory, struct batch *batch)
{
    if (ranks_number() == 0 && !ranks_again() && rank_folders_join(directory) != STATUS_OK)
        shown_note(status_message());
    if (ranks_number() > 0) {
        ranks_meet();
        rank_folder(directory, ranks_number(), batch->own, sizeof batch->own);
        batch->directory = batch->own;
        if (!freopen("/dev/null", "w", stdout)) /* rank 0 prints */
            return status_set(STATUS_FAILED, "rank %d: /dev/null cannot be opened", ranks_number());
    }
    return results_folder_open(batch->directory, &batch->provenance, &batch->results);
}

enum status batch_open(const char *directory, int rows, bool details, struct batch *batch)
{
    *batch = (struct batch){.directory = directory,
                            .threads = omp_get_max_threads(),
                            .details = details,
                            .effort = EFFORT_WHOLE,
                            .rows = rows};
    provenance_fill(&batch->provenance, batch->threads);
    provenance_line(batch->footer);
    batch->begin = seconds_now();
    enum status status = folder_open(directory, batch);
    if (status == STATUS_OK) {
        supervisor_keeps(directory);
        external_logs(directory);
        table_begin(stdout, rows > ROWS_MANY);
    }
    if (status == STATUS_OK && batch->threads > omp_get_num_procs())
        fprintf(stderr, "sasbench: warning: %d threads share %d processor%s: times are not those of %d threads\n",
                batch->threads, omp_get_num_procs(), omp_get_num_procs() > 1 ? "s" : "", batch->threads);
    return status;
}

enum status batch_close(struct batch *batch, enum status status)
{
    cells_free(&batch->cells);
    if (!batch->results)
        return status;
    enum status closed = results_folder_close(batch->results);
    status = status == STATUS_OK ? closed : status;
    batch->results = NULL;
    if (status == STATUS_OK && batch->failed && ranks_number() == 0)
        status = status_set(STATUS_FAILED,
                            "at least one algorithm failed; the table and %s/measurements.csv give the reason",
                            batch->directory);
    if (status == STATUS_OK && batch->undrawn > 0)
        status = status_set(STATUS_FAILED, "%d %s could not be drawn (see above); %s/measurements.csv is whole",
                            batch->undrawn, batch->undrawn == 1 ? "picture" : "pictures", batch->directory);
    return status;
}
