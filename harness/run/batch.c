/* Scenes measured with algorithms (batch.h). */
#include "run/batch.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "echoes/echo_data.h"
#include "run/progress_line.h"
#include "show/pictures.h"
#include "measure/outcome.h"
#include "show/table.h"
#include "run/supervisor.h"
#include "advise/check.h"
#include "advise/plans.h"

/* One scene while its algorithms run. */
struct visit {
    struct session session;
    const struct spec *specs;
    int spec_count;
    struct pictures pictures;       /* all zero when none are drawn */
    struct timing_samples *samples; /* [TURNS] of the settings from turns_first on; NULL: each is timed at once */
    int turns_first;
};
enum { TURNS = 24 }; /* settings that are timed in turn */

static void visit_close(struct visit *visit)
{
    pictures_free(&visit->pictures);
    free(visit->samples);
    session_close(&visit->session);
}

/* Begin what the supervisor knows by these words, without a SPEC the echoes and the exact image of a scene;
   supervisor_leave ends it. How an earlier process crashed at it, which is not begun again; NULL: it did not. */
static const char *task_begin(const struct scene *scene, const struct spec *spec)
{
    char task[700];
    if (spec)
        snprintf(task, sizeof task, "%s, %s:%s%sprecision=%s", scene->name, spec->algorithm->name, spec->text,
                 *spec->text ? "," : "", precision_name(spec->precision));
    else
        snprintf(task, sizeof task, "%s, echoes and exact image", scene->name);
    const char *crash = supervisor_crash(task);
    if (!crash)
        supervisor_enter(task);
    return crash;
}

/* On failure the visit is closed. */
static enum status visit_open(struct batch *batch, const struct scene *scene, int spec_count, const struct spec *specs,
                              struct visit *visit)
{
    *visit = (struct visit){.specs = specs, .spec_count = spec_count};
    const char *crash = task_begin(scene, NULL);
    enum status status = crash ? status_set(STATUS_FAILED, "making the echoes and the exact image %s", crash)
                               : session_open(scene, &visit->session);
    supervisor_leave();
    if (status != STATUS_OK)
        return status;
    visit->samples = batch->in_turn ? calloc(TURNS, sizeof *visit->samples) : NULL;
    if (batch->in_turn && !visit->samples)
        status = status_set(STATUS_FAILED, "%s: no memory for %d algorithms", scene->name, spec_count);
    if (status == STATUS_OK && batch->details)
        status = pictures_begin(batch->directory, batch->footer, scene, &visit->session.reference, spec_count,
                                &visit->pictures);
    if (status != STATUS_OK)
        visit_close(visit);
    return status;
}

static void spec_label(const struct spec *spec, char *label, size_t size)
{
    picture_label(spec->algorithm->name, spec->text, precision_name(spec->precision), label, size);
}

static void draw(struct visit *visit, int index, const struct image *image)
{
    char label[320];
    if (!visit->pictures.lines)
        return;
    spec_label(&visit->specs[index], label, sizeof label);
    pictures_add(&visit->pictures, index, label, image);
}

/* A row of what was not measured. */
static struct measurement failed_row(const struct batch *batch, const struct scene *scene, const struct spec *spec,
                                     const char *reason)
{
    struct measurement row = measurement_empty(scene->name, spec->algorithm->name, spec->text, spec->precision);
    row.threads = batch->threads;
    row.status = "failed";
    row.reason = reason;
    return row;
}

/* A scene whose echoes cannot be made has a failed row for every algorithm that is missing, and the next one goes
   on. */
static enum status fail_scene(struct batch *batch, const struct scene *scene, int spec_count, const struct spec *specs)
{
    char reason[512];
    enum status status = STATUS_OK;
    snprintf(reason, sizeof reason, "%s", status_message());
    batch->failed = true;
    for (int k = 0; k < spec_count && status == STATUS_OK; k++, batch->done++) {
        struct measurement row = failed_row(batch, scene, &specs[k], reason);
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

/* A measurement that crashed an earlier process of this run. */
static enum status add_crashed(struct batch *batch, const struct scene *scene, const struct spec *spec, const char *how)
{
    struct measurement row = failed_row(batch, scene, spec, how);
    enum status status = results_folder_add(batch->results, &row);
    batch->failed = true;
    if (status == STATUS_OK)
        table_row(stdout, &row);
    return status;
}

/* Measure one algorithm on one scene, record and draw it. Only a fault of the record itself is an error: what fails or
   is unsupported becomes a row. */
static enum status measure(struct batch *batch, struct visit *visit, int index)
{
    struct outcome outcome;
    enum status status = STATUS_OK;
    const char *crash = task_begin(visit->session.scene, &visit->specs[index]);
    if (crash)
        return add_crashed(batch, visit->session.scene, &visit->specs[index], crash);
    outcome_measure(&visit->session, &visit->specs[index], batch->effort,
                    visit->samples ? &visit->samples[index - visit->turns_first] : NULL, &outcome);
    supervisor_leave();
    const struct chosen *chosen = session_chosen(&visit->session, &visit->specs[index]);
    if (chosen && chosen->choice.count > 0)
        status =
            plans_keep(batch->directory, &(struct plans){visit->session.scene, &visit->specs[index], &chosen->choice});
    outcome.row.threads = batch->threads;
    if (status == STATUS_OK && strcmp(outcome.row.status, "ok") == 0) {
        status = results_folder_targets(batch->results, outcome.targets, outcome.target_count);
        const double begin = seconds_now();
        if (status == STATUS_OK)
            draw(visit, index, &outcome.image);
        batch->drawn_s += seconds_now() - begin;
    }
    batch->failed |= strcmp(outcome.row.status, "failed") == 0;
    if (status == STATUS_OK)
        status = results_folder_add(batch->results, &outcome.row);
    if (status == STATUS_OK)
        table_row(stdout, &outcome.row);
    outcome_free(&outcome);
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

static void progress(const struct batch *batch, const char *scene, const char *what)
{
    char left[60];
    to_go_format(batch, left, sizeof left);
    progress_line(true, "[%d/%d%s] %s %s", batch->done + 1, batch->rows, left, scene, what);
}

/* All rounds but the last, which measure() adds, of the settings from `first` on that are to be measured. */
static void turns_take(struct batch *batch, struct visit *visit, int first)
{
    const struct scene *scene = visit->session.scene;
    const int end = first + TURNS < visit->spec_count ? first + TURNS : visit->spec_count;
    visit->turns_first = first;
    memset(visit->samples, 0, TURNS * sizeof *visit->samples);
    for (int round = 1; round < TIMING_ROUNDS; round++)
        for (int k = first; k < end; k++) {
            const struct spec *spec = &visit->specs[k];
            if (batch_find(batch, scene, spec) || task_begin(scene, spec))
                continue;
            progress(batch, scene->name, spec->algorithm->name);
            outcome_round(&visit->session, spec, &visit->samples[k - first]);
            supervisor_leave();
        }
}

const struct measurement *batch_find(const struct batch *batch, const struct scene *scene, const struct spec *spec)
{
    return results_folder_find(batch->results, scene->name, spec->algorithm->name, spec->text,
                               precision_name(spec->precision));
}

/* A row that an earlier run finished is not timed again; its image is, for the overlaid slices. What cannot be drawn
   now is reported and stops nothing. */
static void redraw(struct visit *visit, int index, const struct measurement *row)
{
    struct image image = {0};
    if (strcmp(row->status, "ok") != 0)
        return;
    const char *crash = task_begin(visit->session.scene, &visit->specs[index]);
    enum status status =
        crash ? status_set(STATUS_FAILED, "%s", crash) : session_image(&visit->session, &visit->specs[index], &image);
    supervisor_leave();
    if (status == STATUS_OK) {
        draw(visit, index, &image);
    } else {
        fprintf(stderr, "sasbench: %s with %s is not drawn: %s\n", row->scene, row->algorithm, status_message());
        visit->pictures.undrawn++;
    }
    image_free(&image);
}

/* Whether an image or the slices of finished rows are still to be drawn. */
static bool pictures_missing(const struct batch *batch, const struct scene *scene, int spec_count,
                             const struct spec *specs)
{
    int images = 0, missing = 0;
    char label[320];
    for (int k = 0; k < spec_count && batch->details; k++) {
        const struct measurement *row = batch_find(batch, scene, &specs[k]);
        if (!row || strcmp(row->status, "ok") != 0)
            continue;
        spec_label(&specs[k], label, sizeof label);
        missing += !picture_exists(batch->directory, scene->name, label);
        images++;
    }
    return missing > 0
           || (images > 0 && scene->point_count > 0 && !picture_exists(batch->directory, scene->name, NULL));
}

/* A patch costs back projection little and range migration as much as the whole swath: the heading says which it is. */
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

enum status batch_scene(struct batch *batch, const struct scene *scene, int spec_count, const struct spec *specs)
{
    struct visit visit;
    int missing = 0;
    enum status status = results_folder_scene(batch->results, scene->name, scene->hash);
    for (int k = 0; k < spec_count; k++)
        missing += !batch_find(batch, scene, &specs[k]);
    const bool visited = missing > 0 || pictures_missing(batch, scene, spec_count, specs);
    if (status == STATUS_OK)
        heading_print(scene);
    if (status == STATUS_OK && visited) {
        progress(batch, scene->name, "echoes and exact image");
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
            turns_take(batch, &visit, k);
        progress(batch, scene->name, specs[k].algorithm->name);
        batch->measured += !row;
        if (!row)
            status = measure(batch, &visit, k);
        else if (visited && batch->details)
            redraw(&visit, k, row);
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
