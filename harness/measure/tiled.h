/* Images formed tile by tile: echoes stay in their file, and each tile reads the pings that it needs. */
#ifndef SASBENCH_MEASURE_TILED_H
#define SASBENCH_MEASURE_TILED_H

#include "echoes/mat_tiles.h"
#include "imaging/imaging.h"
#include "imaging/probe.h"
#include "measure/timing.h"
#include "scene/scene.h"

/* Can an algorithm form tiles of a scene's image? Errors: STATUS_UNSUPPORTED, beginning with `command`. */
enum status tiled_check(const char *command, const struct spec *spec, const struct scene *scene);

/* Echoes of a scene: in memory, or of a recording those pings that were read. */
struct tile_echoes {
    struct echoes echoes;
    bool *has, *wanted; /* [pings]; NULL where all are in memory */
    int column;         /* first one of the stretch that they were read for */
    double largest;     /* of what was read */
};
/* Errors: STATUS_UNSUPPORTED where samples do not fit the precision as they are: the whole image would be of samples
   divided by a power of two; STATUS_FAILED without memory. *held needs tile_echoes_close in any case. */
enum status tile_echoes_open(const struct scene *scene, enum precision precision, struct tile_echoes *held);
void tile_echoes_close(struct tile_echoes *held);

/* One tile, formed by tile_form and released by tile_free; not to be copied. */
struct tile {
    struct pixel_window window;
    struct problem problem;
    struct imaging imaging;
    struct image image; /* of imaging.part */
    struct stages stages;
    double run_s; /* s, of imaging alone */
    struct work work;
};
/* Errors: as imaging_form, and of the file; nothing to free then. */
enum status tile_form(const struct spec *spec, const struct scene *scene, struct tile_echoes *held,
                      const struct tiles *tiles, int number, struct tile *tile);
void tile_free(struct tile *tile);

/* A whole image of a recording, its tiles chosen for `memory` bytes beside the image. Times, work and stages are sums
   over the tiles, of one run each; without a control. */
struct tiled_image {
    struct image image; /* of the scene's patch, freed by the caller */
    struct timing timing;
    struct probe_error error; /* against `reference` in the image's precision, on some pixels of each tile */
    struct tiles tiles;       /* their size */
};
/* Errors: as tile_choose and tile_form; nothing to free then. */
enum status tiled_measure(const struct spec *spec, const struct scene *scene, double memory, struct tiled_image *tiled);

#endif
