/* The cells of a run, each a scene with a SPEC, and which of them this process takes: those of its shard, by a
   partition that all shards compute alike; or, among the ranks of mpirun, the next that rank 0 hands out (ranks.h).
   Scenes with more work come first, and of a scene the cells with more work. */
#ifndef SASBENCH_RANKS_CELLS_H
#define SASBENCH_RANKS_CELLS_H

#include "imaging/spec.h"
#include "scene/scene.h"

struct shard {
    int number, count; /* from 1; count 0: no shard */
};
/* "3/8"; NULL is none. Errors: STATUS_INVALID. */
enum status shard_parse(const char *command, const char *text, struct shard *shard);

struct cells_one {
    char *name;
    int scene;   /* among the cells' scenes */
    double work; /* counted, FLOPs; the same on every machine */
    bool mine;
};
struct cells {
    struct cells_one *list; /* [count], in the order in which they are dealt, once they are */
    int count;
    struct cell_scene {
        char *name;
        double work, opening; /* of all its cells; of its echoes and its exact image */
    } * scenes;               /* [scene_count] as they were added */
    int scene_count;
    int next; /* of ranks: the cell that was handed out and not begun; count: none is left; -1: ask */
};

/* Errors: STATUS_FAILED without memory. cells_free accepts a zeroed struct. */
enum status cells_add(struct cells *cells, const struct scene *scene, int spec_count, const struct spec *specs);
void cells_free(struct cells *cells);
/* Order them, and mark those of a shard; all where it is none. Each cell is of one shard, whatever the order in which
   they were added. Errors: STATUS_FAILED without memory. */
enum status cells_deal(struct cells *cells, const struct shard *shard);
/* Of all scenes in the order of their cells the k-th, as it was added. */
int cells_scene(const struct cells *cells, int k);
/* Is this the cell of a place in their order? */
bool cells_is(const struct cells *cells, int n, const char *scene, const struct spec *spec);
/* The place of a cell in their order; -1: none. */
int cells_find(const struct cells *cells, const char *scene, const struct spec *spec);

#endif
