/* Scenes measured with algorithms (batch.h). */
#include "run/batch.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>

#include "advise/check.h"
#include "echoes/echo_data.h"
#include "run/progress_line.h"
#include "run/supervisor.h"
#include "run/visit.h"
#include "show/table.h"

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
    table_scene_end(stdout);
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
        pixels += (double)scene->patches[k].r_count * scene->patches[k].x_count;
        imaged_m += scene->patches[k].r_count * scene->patches[k].r_step;
    }
    if (scene->patch_count == 1)
        snprintf(size, sizeof size, "%d x %d pixels", scene->patches[0].x_count, scene->patches[0].r_count);
    else
        snprintf(size, sizeof size, "%.0f pixels in %d patches", pixels, scene->patch_count);
    snprintf(what, sizeof what, "%s, %.2g %% of the ranges, %s echoes", size, 100 * fmin(imaged_m / recorded_m, 1),
             a->compressed ? "compressed" : "raw");
    table_scene(stdout, scene->name, what);
    check_warnings(stdout, scene, false);
}

static enum status part_measure(struct batch *batch, const struct scene *scene, int spec_count,
                                const struct spec *specs)
{
    struct visit visit;
    int missing = 0;
    enum status status = results_folder_scene(batch->results, scene->name, scene->hash);
    for (int k = 0; k < spec_count && status == STATUS_OK; k++)
        if (specs[k].algorithm->origin)
            status = results_folder_algorithm(batch->results, specs[k].algorithm->name, specs[k].algorithm->origin);
    for (int k = 0; k < spec_count; k++)
        missing += !batch_find(batch, scene, &specs[k]);
    const bool visited = missing > 0 || visit_pictures_missing(batch, scene, spec_count, specs);
    if (status == STATUS_OK)
        heading_print(scene);
    if (status == STATUS_OK && visited) {
        batch_progress(batch, scene->name, "echoes and exact image");
        if (visit_open(batch, scene, spec_count, specs, &visit) != STATUS_OK) {
            progress_line_clear();
            return fail_scene(batch, scene, spec_count, specs);
        }
    }
    if (status != STATUS_OK)
        return status;
    for (int k = 0; k < spec_count && status == STATUS_OK; k++, batch->done++) {
        const struct measurement *row = batch_find(batch, scene, &specs[k]);
        if (visited && visit.samples && k % TURNS == 0)
            visit_turns(batch, &visit, k);
        batch_progress(batch, scene->name, specs[k].algorithm->name);
        batch->measured += !row;
        if (!row)
            status = visit_measure(batch, &visit, k);
        else if (visited && batch->details)
            visit_redraw(&visit, k, row);
        progress_line_clear();
        if (row && status == STATUS_OK)
            table_row(stdout, row);
        fflush(stdout);
    }
    table_scene_end(stdout);
    if (visited) {
        const double begin = seconds_now();
        if (status == STATUS_OK && batch->details)
            pictures_draw(&visit.pictures);
        batch->drawn_s += seconds_now() - begin;
        batch->undrawn += visit.pictures.undrawn;
        session_spent(&visit.session, &batch->spent);
        visit_close(&visit);
    }
    if (status == STATUS_OK && batch->works)
        works_print(scene, spec_count, specs);
    return status;
}

enum status batch_cells(struct batch *batch, const struct scene *scene, int spec_count, const struct spec *specs)
{
    return batch->shard.count > 0 ? cells_add(&batch->cells, scene, spec_count, specs) : STATUS_OK;
}

enum status batch_deal(struct batch *batch)
{
    enum status status = cells_deal(&batch->cells, &batch->shard);
    if (batch->shard.count == 0 || status != STATUS_OK)
        return status;
    batch->details = batch->works = false;
    batch->rows = 0;
    for (int n = 0; n < batch->cells.count; n++)
        batch->rows += batch->cells.list[n].mine;
    return STATUS_OK;
}

bool batch_whole(const struct batch *batch)
{
    if (batch->shard.count > 0)
        printf("\nShard %d/%d: %d of %d cells are in %s. When all are done: ./sasbench merge FOLDER ... -o DIR\n",
               batch->shard.number, batch->shard.count, batch->rows, batch->cells.count, batch->directory);
    return batch->shard.count == 0;
}

enum status batch_scene(struct batch *batch, const struct scene *scene, int spec_count, const struct spec *specs)
{
    if (batch->shard.count == 0)
        return part_measure(batch, scene, spec_count, specs);
    struct spec *part = malloc((size_t)spec_count * sizeof *part + 1);
    int count = 0;
    if (!part)
        return status_set(STATUS_FAILED, "%s: no memory for %d algorithms", scene->name, spec_count);
    for (int k = 0; k < spec_count; k++) {
        const int n = cells_find(&batch->cells, scene->name, &specs[k]);
        if (n >= 0 && batch->cells.list[n].mine)
            part[count++] = specs[k];
    }
    const enum status status = count > 0 ? part_measure(batch, scene, count, part) : STATUS_OK;
    free(part);
    return status;
}

enum status batch_open(const char *directory, int rows, bool details, struct batch *batch)
{
    struct provenance provenance;
    *batch = (struct batch){.directory = directory,
                            .threads = omp_get_max_threads(),
                            .details = details,
                            .effort = EFFORT_WHOLE,
                            .rows = rows};
    provenance_fill(&provenance, batch->threads);
    provenance_line(batch->footer);
    batch->begin = seconds_now();
    enum status status = results_folder_open(directory, &provenance, &batch->results);
    if (status == STATUS_OK) {
        supervisor_keeps(directory);
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
    if (status == STATUS_OK && batch->failed)
        status = status_set(STATUS_FAILED,
                            "at least one algorithm failed; the table and %s/measurements.csv give the reason",
                            batch->directory);
    if (status == STATUS_OK && batch->undrawn > 0)
        status = status_set(STATUS_FAILED, "%d %s could not be drawn (see above); %s/measurements.csv is whole",
                            batch->undrawn, batch->undrawn == 1 ? "picture" : "pictures", batch->directory);
    return status;
}
