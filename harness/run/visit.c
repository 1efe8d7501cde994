/* One scene of a batch: echoes, measurements, pictures (visit.h). */
#include "run/visit.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "advise/plans.h"
#include "echoes/echo_data.h"
#include "measure/outcome.h"
#include "run/supervisor.h"
#include "show/table.h"

void visit_close(struct visit *visit)
{
    pictures_free(&visit->pictures);
    free(visit->samples);
    session_close(&visit->session);
}

/* Begin a task for the supervisor by this text; without a SPEC, the echoes and the exact image of a scene.
   supervisor_leave ends it. Returns how an earlier process crashed at it (it is not begun again), or NULL. */
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

enum status visit_open(struct batch *batch, const struct scene *scene, int spec_count, const struct spec *specs,
                       struct visit *visit)
{
    *visit = (struct visit){.specs = specs, .spec_count = spec_count};
    const char *crash = task_begin(scene, NULL);
    enum status status = STATUS_OK;
    if (crash)
        status = status_set(STATUS_FAILED, "making the echoes and the exact image %s", crash);
    else if (batch->memory > 0)
        session_open_tiled(scene, batch->memory, &visit->session);
    else
        status = session_open(scene, &visit->session);
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

struct measurement visit_failed_row(const struct batch *batch, const struct scene *scene, const struct spec *spec,
                                    const char *reason)
{
    struct measurement row = measurement_empty(scene->name, spec->algorithm->name, spec->text, spec->precision);
    row.threads = batch->threads;
    row.status = "failed";
    row.reason = reason;
    return row;
}

/* The row of a measurement that crashed an earlier process of this run. */
static enum status add_crashed(struct batch *batch, const struct scene *scene, const struct spec *spec, const char *how)
{
    struct measurement row = visit_failed_row(batch, scene, spec, how);
    enum status status = results_folder_add(batch->results, &row);
    batch->failed = true;
    if (status == STATUS_OK)
        table_row(stdout, &row);
    return status;
}

enum status visit_measure(struct batch *batch, struct visit *visit, int index)
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

void visit_turns(struct batch *batch, struct visit *visit, int first)
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
            batch_progress(batch, scene->name, spec->algorithm->name);
            outcome_round(&visit->session, spec, &visit->samples[k - first]);
            supervisor_leave();
        }
}

void visit_redraw(struct visit *visit, int index, const struct measurement *row)
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
        visit->pictures.queue.undrawn++;
    }
    image_free(&image);
}

bool visit_pictures_missing(const struct batch *batch, const struct scene *scene, int spec_count,
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
