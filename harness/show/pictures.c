/* The pictures of one scene in a batch: each image in decibels, and the azimuth slices of all overlaid. */
#include "show/pictures.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "metrics/metrics.h"
#include "files/folder.h"
#include "files/paths.h"

/* The slices' path with a label of NULL. */
static void path_make(const char *directory, const char *scene, const char *label, char *path, size_t size)
{
    char name[700];
    snprintf(name, sizeof name, "%s.png", label ? label : "slices");
    picture_path(directory, scene, name, path, size);
}

bool picture_exists(const char *directory, const char *scene, const char *label)
{
    char path[4096];
    path_make(directory, scene, label, path, sizeof path);
    return place_is_file(path);
}

enum status pictures_begin(const char *directory, const char *footer, const struct scene *scene,
                           const struct image *exact, int spec_count, struct pictures *pictures)
{
    char path[4096];
    *pictures = (struct pictures){directory, footer, scene, exact, spec_count, NULL, {NULL, 0, 0}};
    pictures->lines = calloc((size_t)scene->point_count * (size_t)spec_count + 1, sizeof *pictures->lines);
    if (!pictures->lines)
        return status_set(STATUS_FAILED, "%s: no memory for slices", scene->name);
    path_make(directory, scene->name, NULL, path, sizeof path);
    place_clear(path);
    return STATUS_OK;
}

void pictures_free(struct pictures *pictures)
{
    for (int k = 0; pictures->lines && k < pictures->scene->point_count * pictures->spec_count; k++) {
        free((char *)pictures->lines[k].label);
        free(pictures->lines[k].position_m);
        free(pictures->lines[k].power_db);
        free(pictures->lines[k].difference_db);
    }
    free(pictures->lines);
    plot_queue_free(&pictures->queue);
    *pictures = (struct pictures){0};
}

/* The exact image if it has all pixels of the picture; NULL otherwise, and for the exact image itself. */
static const struct image *pictures_exact(const struct pictures *pictures, const struct image *image)
{
    const struct image *exact = pictures->exact;
    return exact->patch_count == image->patch_count && pictures->scene->reference_count == 0 ? exact : NULL;
}

void pictures_add(struct pictures *pictures, int index, const char *label, const struct image *image)
{
    const struct scene *scene = pictures->scene;
    char path[4096], title[700];
    path_make(pictures->directory, scene->name, label, path, sizeof path);
    place_clear(path);
    snprintf(title, sizeof title, "%s: %s", scene->name, label);
    const struct image_picture picture = {.image = image,
                                          .reference = pictures_exact(pictures, image),
                                          .title = title,
                                          .footer = pictures->footer,
                                          .targets = scene->targets,
                                          .target_count = scene->point_count};
    (void)plot_image(&pictures->queue, path, data_path(DATA_PLOTS), &picture); /* the measurement does not fail */
    for (int t = 0; t < scene->point_count; t++) {
        struct slice_line *line = &pictures->lines[t * pictures->spec_count + index];
        line->label = strdup(label);
        metrics_slice_samples(image, &scene->acquisition, &scene->targets[t], AXIS_AZIMUTH, &line->position_m,
                              &line->power_db, &line->count);
        if (picture.reference && picture.reference != image)
            line->difference_db = metrics_slice_difference(image, picture.reference, &scene->acquisition,
                                                           &scene->targets[t], AXIS_AZIMUTH, line->count);
    }
}

/* Does any image have a slice through target t? */
static bool target_is_imaged(const struct pictures *pictures, int t)
{
    for (int k = 0; k < pictures->spec_count; k++)
        if (pictures->lines[t * pictures->spec_count + k].count > 0)
            return true;
    return false;
}

void pictures_draw(struct pictures *pictures)
{
    const struct scene *scene = pictures->scene;
    char path[4096], title[600];
    char(*texts)[64] = calloc((size_t)scene->point_count + 1, sizeof *texts);
    const char **titles = calloc((size_t)scene->point_count + 1, sizeof *titles);
    struct slice_line *lines = calloc((size_t)scene->point_count * (size_t)pictures->spec_count + 1, sizeof *lines);
    int count = 0, panels = 0;
    for (int t = 0; lines && texts && titles && t < scene->point_count; t++) {
        if (!target_is_imaged(pictures, t))
            continue;
        snprintf(texts[panels], sizeof texts[panels], "T%d: x = %.10g m, r = %.10g m", t + 1, scene->targets[t].x,
                 scene->targets[t].r);
        titles[panels] = texts[panels];
        panels++;
        for (int k = 0; k < pictures->spec_count; k++) /* without a label there is no image: unsupported or failed */
            if (pictures->lines[t * pictures->spec_count + k].label)
                lines[count++] = pictures->lines[t * pictures->spec_count + k];
    }
    if (panels > 0) {
        path_make(pictures->directory, scene->name, NULL, path, sizeof path);
        snprintf(title, sizeof title, "%s: azimuth slices", scene->name);
        const struct slices_picture picture = {.title = title,
                                               .footer = pictures->footer,
                                               .panel_count = panels,
                                               .line_count = count / panels,
                                               .panel_titles = titles,
                                               .lines = lines};
        for (int svg = 0; svg < 2; svg++) { /* papers use curves, too */
            (void)plot_slices(&pictures->queue, path, data_path(DATA_PLOTS), &picture);
            plot_path_svg(path);
        }
    }
    plot_queue_draw(&pictures->queue);
    free(lines);
    free(texts);
    free(titles);
}
