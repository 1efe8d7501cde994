/* The pictures of one scene in a batch, drawn beside its CSVs. What cannot be drawn is reported on standard error and
   counted, but does not fail what was measured. A picture that is there is that of the row that is there: old ones are
   removed before theirs are drawn. */
#ifndef SASBENCH_SHOW_PICTURES_H
#define SASBENCH_SHOW_PICTURES_H

#include "show/plot.h"
#include "show/plot_script.h"

struct pictures {
    const char *directory, *footer; /* borrowed, like scene and exact image; footer: where they are from */
    const struct scene *scene;
    const struct image *exact; /* without patches: there is none */
    int spec_count;
    struct slice_line *lines; /* [point_count][spec_count]; without a label: no image */
    int undrawn;              /* pictures that could not be drawn */
    struct plot_queue queue;
};

/* Whether DIR/SCENE-LABEL.png is there, or, with a label of NULL, DIR/SCENE-slices.png. */
bool picture_exists(const char *directory, const char *scene, const char *label);

/* Errors: STATUS_FAILED without memory. pictures_free accepts a zeroed struct. */
enum status pictures_begin(const char *directory, const char *footer, const struct scene *scene,
                           const struct image *exact, int spec_count, struct pictures *pictures);
/* Keep what one algorithm's picture (DIR/SCENE-LABEL.png) and slices are drawn from. index: 0 to spec_count - 1. */
void pictures_add(struct pictures *pictures, int index, const char *label, const struct image *image);
/* Draw what was added, and the azimuth slices of all (DIR/SCENE-slices.png, .svg), one panel for each target that a
   patch holds: after the measurements, on all processors. */
void pictures_draw(struct pictures *pictures);
void pictures_free(struct pictures *pictures);

#endif
