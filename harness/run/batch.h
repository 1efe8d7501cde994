/* Scenes measured with algorithms into a results folder: the common part of run, sweep and reproduce. */
#ifndef SASBENCH_RUN_BATCH_H
#define SASBENCH_RUN_BATCH_H

#include "ranks/cells.h"
#include "results/provenance.h"
#include "results/results_folder.h"
#include "measure/session.h"
#include "scene/scenes.h"
#include "measure/timing.h"

struct batch {
    const char *directory; /* borrowed, or `own` */
    char own[4200];        /* of a rank other than 0 */
    struct provenance provenance;
    char footer[PROVENANCE_LINE]; /* below its pictures */
    struct results_folder *results;
    int threads;
    bool details;       /* for every scene: draw images and slices */
    bool works;         /* for every scene: print FLOPs by formula */
    enum effort effort; /* of times; EFFORT_WHOLE from batch_open on */
    double memory;      /* bytes; above 0: images are formed tile by tile, of echoes that stay in their file */
    bool in_turn;       /* time settings by rounds, so that a disturbed minute does not hit one setting alone */
    bool failed;        /* a measurement failed */
    int undrawn;        /* pictures that could not be drawn */
    struct shard shard;
    struct cells cells; /* where other processes take a part of them; else none */
    /* For the progress line: */
    int done, rows, measured; /* rows behind, rows in all, rows measured now */
    double begin;             /* monotonic clock, s: at the start */
    struct spent spent;       /* where the time went */
    double drawn_s;
};

enum { ROWS_MANY = 100 }; /* `run` times more rows than these briefly, and shows a scene in one line */

/* Open the folder (results_folder_open: finished rows of an earlier run are kept) and begin the terminal's table.
   rows: the number of measurements to come. Errors: as results_folder_open; *batch is then safe to close. */
enum status batch_open(const char *directory, int rows, bool details, struct batch *batch);

/* Before the first scene: take a part of the cells alone, those of `shard`, or those that rank 0 hands out; all where
   there is neither. A part is not drawn. batch_cells, of the scenes one by one; then batch_deal. Errors: STATUS_FAILED
   without memory, and as results_folder_scene. */
enum status batch_cells(struct batch *batch, const struct scene *scene, int spec_count, const struct spec *specs);
enum status batch_deal(struct batch *batch);
/* The scene to begin as the k-th. */
const struct scene *batch_nth(const struct batch *batch, const struct scene *scenes, int k);
/* After the last scene; rank 0 waits for the others and takes up their rows. *whole: all cells of the run are in the
   folder, and this process makes tables and pictures of them. Errors: as results_merge, results_folder_open. */
enum status batch_join(struct batch *batch, bool *whole);

/* Measure one scene with every spec: echoes and exact image once, then for each spec a row in the CSVs and on the
   terminal as soon as it is done. Existing rows are only printed; if an interrupted run left a picture of the scene
   out, its pictures are drawn. A failure or a refusal becomes a row, and so does a scene whose echoes cannot be
   made. Errors: STATUS_FAILED for a record that cannot be written. */
enum status batch_scene(struct batch *batch, const struct scene *scene, int spec_count, const struct spec *specs);

/* The finished row, or NULL; belongs to the record, valid until batch_close. */
const struct measurement *batch_find(const struct batch *batch, const struct scene *scene, const struct spec *spec);

/* Show which row comes next. */
void batch_progress(const struct batch *batch, const char *scene, const char *what);

/* Close the folder. Returns `status`, or STATUS_FAILED when that is OK but a measurement failed or a picture could not
   be drawn. */
enum status batch_close(struct batch *batch, enum status status);

#endif
