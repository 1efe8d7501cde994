/* `plan` of an image that is beyond memory: one tile is planned, and stands for all. `plan --nodes`: the image on
   several machines. */
#ifndef SASBENCH_COMMAND_PLAN_TILES_H
#define SASBENCH_COMMAND_PLAN_TILES_H

#include "advise/planned.h"
#include "measure/tile_size.h"

/* The tiles of the chosen setting. */
struct tiled {
    struct tiles tiles; /* columns is 0 where the image is formed whole */
    struct tile_cost cost;
    double flop_s; /* s: of one FLOP, by the predicted time of the image */
};

/* Is its image, with its echoes, beyond the memory, whatever the algorithm? Only an image of one patch has tiles. */
bool plan_is_tiled(const struct scene *scene, double bytes);
/* As planned_make; of an image beyond the memory times and counted work are those of all tiles, and memory is that of a
   process that forms one after the other. Errors: also as tile_choose. */
enum status plan_make(const struct scene *scene, const struct budget *budget, bool both, struct planned *planned,
                      struct tiled *tiled);

/* Print the tiles, and what they read and write. */
void tiles_print(const struct scene *scene, const struct tiled *tiled);
/* --nodes: the image, one setting of which was found, on machines such as this one: for 1, 2, 4 ... of them the tile,
   the time, and what is read and written. Errors: STATUS_UNSUPPORTED for an image of several patches, and
   as tile_cost. */
enum status nodes_print(int nodes, const struct scene *scene, const struct planned *planned, const struct tiled *tiled);

#endif
