/* The pictures of one scene in a batch, drawn beside its CSVs. Pictures that cannot be drawn are reported on
   standard error and counted; the measurements do not fail. An existing picture belongs to the existing row: old
   ones are removed before new ones are drawn. */
#ifndef SASBENCH_SHOW_PICTURES_H
#define SASBENCH_SHOW_PICTURES_H

#include "show/plot.h"
#include "show/plot_script.h"

struct pictures {
    const char *directory, *footer; /* borrowed, like scene and exact image; footer: where they are from */
    const struct scene *scene;
    const struct image *exact; /* without patches: no exact image */
    int spec_count;
    struct slice_line *lines; /* [point_count][spec_count]; without a label: no image */
    struct plot_queue queue;
};

/* Does DIR/SCENE-LABEL.png exist, or, with a label of NULL, DIR/SCENE-slices.png? */
bool picture_exists(const char *directory, const char *scene, const char *label);

/* Errors: STATUS_FAILED without memory. pictures_free accepts a zeroed struct. */
enum status pictures_begin(const char *directory, const char *footer, const struct scene *scene,
                           const struct image *exact, int spec_count, struct pictures *pictures);
/* Keep the data of one algorithm's picture (DIR/SCENE-LABEL.png) and slices. index: 0 to spec_count - 1. */
void pictures_add(struct pictures *pictures, int index, const char *label, const struct image *image);
/* Draw what was added, and the azimuth slices of all (DIR/SCENE-slices.png, .svg), one panel for each target inside
   a patch: after the measurements, on all processors. */
void pictures_draw(struct pictures *pictures);
void pictures_free(struct pictures *pictures);

#endif
