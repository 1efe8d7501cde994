/* An image file of version 7.3 that is filled tile by tile. It is created at its full size and is a valid MATLAB file
   from then on; pixels are written in their place. A journal beside it has the settings and, once a tile is on the
   disk, its checksum: after any end of the program, the next one continues. When the image is whole, the journal is
   removed; until then the file's variable `status` is "unfinished". */
#ifndef SASBENCH_ECHOES_MAT_TILES_H
#define SASBENCH_ECHOES_MAT_TILES_H

#include "echoes/matfile.h"
#include "echoes/tile_journals.h"

#include <sys/types.h>

struct tiles {
    const char *path;         /* these are set by the caller */
    struct grid grid;         /* of the whole image */
    enum precision precision; /* of its pixels */
    int rows, columns;        /* of a tile; the last ones may have less */
    int writer;               /* from 1, where several fill the file, each its own tiles; 0: one alone */
    bool anew;                /* an image that is there without a journal is replaced, though there are writers */
    bool *done;               /* [tiles_count] */
    int file, journal, own;   /* `journal`: of the settings; `own`: of this writer's tiles */
    off_t image_at, status_at, journal_end;
};

int tiles_count(const struct tiles *tiles);
int tiles_done(const struct tiles *tiles);
/* Tiles of a stretch of columns follow one another, the farthest first, which mostly needs the pings of all. */
struct pixel_window tiles_window(const struct tiles *tiles, int number);

/* Create the file, or continue one: the tiles of its journal are verified by their checksums, and are done. `settings`:
   lines "KEY: VALUE" of all that determines pixels but for the tiles themselves. Errors: STATUS_INVALID where its
   settings differ (the first that differs is named), where another program fills it, where a writer finds an image
   without a journal, which others have finished, and as image_file_write; nothing to close then. */
enum status tiles_open(struct tiles *tiles, const char *settings, const struct image_origin *origin);
/* Write pixels [rows][columns] of a tile to the disk. Errors: STATUS_FAILED. */
enum status tiles_write(struct tiles *tiles, int number, const void *pixels);
/* Finish the file where all tiles are done, those of other writers verified as by tiles_open: *sealed, also where
   another writer did it. Errors: STATUS_FAILED. */
enum status tiles_seal(struct tiles *tiles, bool *sealed);
void tiles_close(struct tiles *tiles);

/* What the journals beside an image file claim, unverified; false where there is none. */
bool tiles_claimed(const char *path, int *done, int *count);
/* Set those pixels [r_count][x_count] to NAN that lie in tiles which the journals do not claim; none where there is no
   journal. */
void tiles_blank(const char *path, const struct grid *grid, double complex *pixels);

#endif
