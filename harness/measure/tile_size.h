/* The tile of an image that a process of a given memory forms, by what its plan holds. */
#ifndef SASBENCH_MEASURE_TILE_SIZE_H
#define SASBENCH_MEASURE_TILE_SIZE_H

#include "echoes/mat_tiles.h"
#include "imaging/spec.h"
#include "scene/scene.h"

/* Of the dearest tile: a whole one, the farthest, as near to the middle of the track as the image has pixels. Tiles at
   the image's end may be smaller. */
struct tile_cost {
    double bytes; /* of the process with one thread */
    double flops; /* of the tile */
    int pings;    /* that it reads, */
    int first;    /* from this one */
    int last;     /* to this one */
};
/* Its pixels. */
struct pixel_window tile_dearest(const struct acquisition *a, const struct tiles *tiles);
/* By a plan of that tile, of the size tiles->columns x tiles->rows. Errors: those of the plan. */
enum status tile_cost(const struct spec *spec, const struct scene *scene, const struct tiles *tiles,
                      struct tile_cost *cost);

/* Choose tiles->columns and tiles->rows for a memory in bytes: the highest tile, of the image's height or of 1/2, 1/4
   ... of it, whose tiles along the track read no more than twice the track in all; if none does, the one that reads the
   least. It is as wide as fits. Errors: STATUS_UNSUPPORTED where none fits, and those of plans. */
enum status tile_choose(const struct spec *spec, const struct scene *scene, double bytes, struct tiles *tiles,
                        struct tile_cost *cost);

#endif
