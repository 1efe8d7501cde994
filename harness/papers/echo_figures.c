/* PF05's pictures of echoes (echo_figures.h). */
#include "papers/echo_figures.h"

#include <stdio.h>

#include "echoes/echo_data.h"
#include "files/folder.h"
#include "files/paths.h"
#include "text/shown_text.h"
#include "measure/filtering.h"
#include "results/provenance.h"
#include "papers/sources.h"
#include "scene/simulate.h"
#include "show/plot.h"

enum step { RECORDED, COMPRESSED, FILTERED, STEPS };
static const struct {
    const char *name, *title;
} steps[STEPS] = {
    [RECORDED] = {"recorded", "PF05 Fig. 5A: echoes as recorded"},
    [COMPRESSED] = {"compressed", "PF05 Fig. 5B: range compressed"},
    [FILTERED] = {"filtered", "PF05 Fig. 5C: filtered by 4 sub-apertures"},
};

static bool is_drawn(const char *directory, enum step step, char path[4200])
{
    snprintf(path, 4200, "%s/figure-" ECHO_FIGURES "-%s.png", directory, steps[step].name);
    return place_is_file(path);
}

/* Records side by side, as an image over the transmitter's place and half the way of the sound. */
static enum status records_draw(const struct acquisition *a, const double complex *records, const char *path,
                                const char *title, int *undrawn)
{
    const struct grid grid = {.x_first = a->tx[0].x,
                              .x_step = a->tx[1].x - a->tx[0].x,
                              .x_count = a->pings,
                              .r_first = a->t0[0] * a->sound_speed / 2,
                              .r_step = a->sound_speed / (2 * a->fs),
                              .r_count = a->samples};
    struct image image;
    char footer[PROVENANCE_LINE];
    enum status status = image_allocate(1, &grid, PRECISION_DOUBLE, &image);
    if (status != STATUS_OK)
        return status;
    double complex *pixels = image.pixels[0];
    for (int n = 0; n < a->samples; n++)
        for (int p = 0; p < a->pings; p++)
            pixels[(size_t)n * (size_t)a->pings + (size_t)p] = records[(size_t)p * (size_t)a->samples + (size_t)n];
    provenance_line(footer);
    if (plot_image(path, PLOT_DIRECTORY, &(struct image_picture){.image = &image, .title = title, .footer = footer})
        != STATUS_OK) {
        shown_note(status_message());
        ++*undrawn;
    }
    image_free(&image);
    return STATUS_OK;
}

static enum status steps_draw(const struct scene *scene, const struct filtering *filtering, const char *directory,
                              int *undrawn)
{
    struct echoes echoes;
    enum status status = scene_simulate(scene, &echoes);
    if (status != STATUS_OK)
        return status;
    double complex *records = (double complex *)echoes.samples;
    for (enum step step = RECORDED; step < STEPS && status == STATUS_OK; step++) {
        char path[4200];
        if (step == COMPRESSED)
            filtering_compress(filtering, records);
        if (step == FILTERED)
            filtering_apply(filtering, records);
        if (!is_drawn(directory, step, path))
            status = records_draw(&scene->acquisition, records, path, steps[step].title, undrawn);
    }
    echoes_free(&echoes);
    return status;
}

enum status echo_figures_draw(const char *directory, int *undrawn)
{
    struct scene scene;
    struct spec spec = {0};
    struct filtering filtering;
    char path[4200];
    bool complete = true;
    for (enum step step = RECORDED; step < STEPS; step++)
        complete = is_drawn(directory, step, path) && complete;
    if (complete)
        return STATUS_OK;
    enum status status = scene_load("pf05/nine", SCENE_DIRECTORY, &scene);
    if (status != STATUS_OK)
        return status;
    status = spec_parse(POLAR_4, &spec);
    if (status == STATUS_OK)
        status = filtering_open(&scene.acquisition, &spec, &filtering);
    if (status == STATUS_OK) {
        status = steps_draw(&scene, &filtering, directory, undrawn);
        filtering_close(&filtering);
    }
    spec_free(&spec);
    scene_free(&scene);
    return status;
}
