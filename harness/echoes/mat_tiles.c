/* Image files that are filled tile by tile (mat_tiles.h). */
#include "echoes/mat_tiles.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "echoes/matvar.h"

static const char head[] = "sasbench tiles 1\n", line_of_tiles[] = "tiles: %dx%d, %d in all\n";
static const char whole[] = "whole     ", unfinished[] = "unfinished";

static int tiles_deep(const struct tiles *tiles)
{
    return (tiles->grid.r_count + tiles->rows - 1) / tiles->rows;
}

int tiles_count(const struct tiles *tiles)
{
    return tiles_deep(tiles) * ((tiles->grid.x_count + tiles->columns - 1) / tiles->columns);
}

struct pixel_window tiles_window(const struct tiles *tiles, int number)
{
    const int deep = tiles_deep(tiles), row = (deep - 1 - number % deep) * tiles->rows;
    const int column = number / deep * tiles->columns;
    const int rows = tiles->grid.r_count - row, columns = tiles->grid.x_count - column;
    return (struct pixel_window){row, rows < tiles->rows ? rows : tiles->rows, column,
                                 columns < tiles->columns ? columns : tiles->columns};
}

int tiles_done(const struct tiles *tiles)
{
    int done = 0;
    for (int n = 0; n < tiles_count(tiles); n++)
        done += tiles->done[n];
    return done;
}

static enum status tiles_fail(const struct tiles *tiles, const char *what)
{
    return status_set(STATUS_FAILED, "%s: %s: %s", tiles->path, what, strerror(errno ? errno : EIO));
}

/* What is not written by libmatio. */
static void sets_fill(const struct tiles *tiles, struct set73 sets[2])
{
    sets[0] =
        (struct set73){"image", false, tiles->precision, 2, {(size_t)tiles->grid.x_count, (size_t)tiles->grid.r_count}};
    sets[1] = (struct set73){"status", true, PRECISION_FLOAT, 2, {sizeof unfinished - 1, 1}};
}

static bool offsets_find(const char *path, struct tiles *tiles)
{
    struct set73 sets[2];
    sets_fill(tiles, sets);
    tiles->image_at = set73_find(path, &sets[0]);
    tiles->status_at = set73_find(path, &sets[1]);
    return tiles->image_at > 0 && tiles->status_at > 0;
}

static bool status_write(const struct tiles *tiles, const char *text)
{
    uint16_t codes[sizeof unfinished - 1];
    for (size_t k = 0; k < sizeof codes / sizeof *codes; k++)
        codes[k] = (unsigned char)text[k];
    return write_at(tiles->file, codes, sizeof codes, tiles->status_at) && fdatasync(tiles->file) == 0;
}

/* Add what is written tile by tile. */
static bool sets_add(struct writer *writer)
{
    struct tiles *tiles = writer->with;
    const char *path = writer->temporary;
    struct set73 sets[2];
    sets_fill(tiles, sets);
    tiles->file = open(path, O_RDWR | O_CLOEXEC);
    return tiles->file >= 0 && set73_make(path, tiles->file, &sets[0]) && set73_make(path, tiles->file, &sets[1])
           && offsets_find(path, tiles) && status_write(tiles, unfinished);
}

/* The file, with all but its pixels; tiles->file is open then. */
static enum status file_make(struct tiles *tiles, const struct image_origin *origin)
{
    struct writer writer;
    if (writer_open(&writer, tiles->path, SIZE_MAX) != STATUS_OK)
        return writer.status;
    image_axes_write(&writer, &tiles->grid, 0);
    image_sayings_write(&writer, origin);
    writer.add = sets_add;
    writer.with = tiles;
    return writer_close(&writer);
}

/* A tile's numbers in the file, column by column; `write`: from `numbers`, else to them. */
static bool tile_move(const struct tiles *tiles, int number, bool write, char *numbers)
{
    const struct pixel_window w = tiles_window(tiles, number);
    const size_t size = precision_size(tiles->precision), bytes = (size_t)w.rows * size;
    for (int j = 0; j < w.columns; j++, numbers += bytes) {
        const size_t pixel = (size_t)(w.column + j) * (size_t)tiles->grid.r_count + (size_t)w.row;
        const off_t at = tiles->image_at + (off_t)(pixel * size);
        if (write ? !write_at(tiles->file, numbers, bytes, at)
                  : pread(tiles->file, numbers, bytes, at) != (ssize_t)bytes)
            return false;
    }
    return true;
}

static size_t tile_bytes(const struct tiles *tiles, int number)
{
    const struct pixel_window w = tiles_window(tiles, number);
    return (size_t)w.rows * (size_t)w.columns * precision_size(tiles->precision);
}

static unsigned long sum_of(const char *numbers, size_t bytes)
{
    unsigned long sum = crc32(0, NULL, 0);
    for (size_t at = 0; at < bytes; at += 1 << 30)
        sum = crc32(sum, (const unsigned char *)numbers + at, (uInt)(bytes - at < 1 << 30 ? bytes - at : 1 << 30));
    return sum;
}

enum status tiles_write(struct tiles *tiles, int number, const void *pixels)
{
    const struct pixel_window w = tiles_window(tiles, number);
    const size_t size = precision_size(tiles->precision), bytes = tile_bytes(tiles, number);
    char line[64], *turned = malloc(bytes);
    if (!turned)
        return status_set(STATUS_FAILED, "%s: out of memory for a tile of %zu bytes", tiles->path, bytes);
    for (size_t i = 0; i < (size_t)w.rows; i++)
        for (size_t j = 0; j < (size_t)w.columns; j++)
            memcpy(turned + (j * (size_t)w.rows + i) * size, (const char *)pixels + (i * (size_t)w.columns + j) * size,
                   size);
    errno = 0;
    bool written = tile_move(tiles, number, true, turned) && fdatasync(tiles->file) == 0;
    const int length = snprintf(line, sizeof line, "done %d %08lx\n", number, sum_of(turned, bytes));
    free(turned);
    /* Only once the numbers are on the disk. */
    written = written && write_at(tiles->own, line, (size_t)length, tiles->journal_end) && fdatasync(tiles->own) == 0;
    if (!written)
        return tiles_fail(tiles, "a tile cannot be written");
    tiles->journal_end += length;
    tiles->done[number] = true;
    return STATUS_OK;
}

/* The tiles that a journal claims, as far as the file has their numbers; of another writer's, those not done yet. */
static void claims_verify(struct tiles *tiles, const char *line, bool other)
{
    char *numbers = malloc((size_t)tiles->rows * (size_t)tiles->columns * precision_size(tiles->precision));
    for (const char *end; numbers && (end = strchr(line, '\n')); line = end + 1) {
        unsigned long sum;
        const int n = journal_claim(line, end, &sum);
        if (n >= 0 && n < tiles_count(tiles) && !(other && tiles->done[n]) && tile_move(tiles, n, false, numbers))
            tiles->done[n] = sum == sum_of(numbers, tile_bytes(tiles, n));
    }
    free(numbers);
}

static void other_verify(void *tiles, const char *text)
{
    claims_verify(tiles, text, true);
}

static void line_copy(const char *text, char *line, size_t size)
{
    snprintf(line, size, "%.*s", (int)strcspn(text, "\n"), text);
}

/* Names the first line that differs. */
static enum status settings_refuse(const struct tiles *tiles, const char *begun, const char *wanted)
{
    char theirs[600], ours[600];
    size_t same = 0, line = 0;
    while (begun[same] && begun[same] == wanted[same])
        if (begun[same++] == '\n')
            line = same;
    line_copy(begun + line, theirs, sizeof theirs);
    line_copy(wanted + line, ours, sizeof ours);
    return status_set(STATUS_INVALID,
                      "%s was begun with `%s`, this is `%s`; the same is needed to continue, or remove %s%s to begin "
                      "anew",
                      tiles->path, theirs, ours, tiles->path, TILES_JOURNAL);
}

/* `text`: the journal, from its second line on. */
static enum status tiles_continue(struct tiles *tiles, const char *text, const char *settings, bool *begun)
{
    if (strncmp(text, settings, strlen(settings)) != 0)
        return settings_refuse(tiles, text, settings);
    tiles->file = open(tiles->path, O_RDWR | O_CLOEXEC);
    *begun = tiles->file >= 0 && offsets_find(tiles->path, tiles);
    if (*begun) {
        claims_verify(tiles, text + strlen(settings), false);
        journals_each(tiles->path, other_verify, tiles);
    }
    return STATUS_OK;
}

static enum status tiles_begin(struct tiles *tiles, const char *settings, const struct image_origin *origin)
{
    if (tiles->file >= 0)
        close(tiles->file);
    tiles->file = -1;
    journals_clear(tiles->path);
    if (ftruncate(tiles->journal, 0) != 0)
        return tiles_fail(tiles, "its journal cannot be written");
    const enum status status = file_make(tiles, origin);
    if (status != STATUS_OK)
        return status;
    const size_t length = strlen(head);
    tiles->journal_end = (off_t)(length + strlen(settings));
    return write_at(tiles->journal, settings, strlen(settings), (off_t)length)
                   && write_at(tiles->journal, head, length, 0) && fsync(tiles->journal) == 0
               ? STATUS_OK
               : tiles_fail(tiles, "its journal cannot be written");
}

/* What journals claim. */
struct claims {
    int rows, columns, count;
    bool *done; /* [count] */
};

static void claims_mark(void *with, const char *text)
{
    const struct claims *claims = with;
    for (const char *end; (end = strchr(text, '\n')); text = end + 1) {
        unsigned long sum;
        const int n = journal_claim(text, end, &sum);
        if (n >= 0 && n < claims->count)
            claims->done[n] = true;
    }
}

/* False where there is no journal; nothing to free then. */
static bool claims_read(const char *path, struct claims *claims)
{
    char name[PATH_MAX];
    off_t end;
    *claims = (struct claims){.done = NULL};
    snprintf(name, sizeof name, "%s" TILES_JOURNAL, path);
    const int journal = open(name, O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
    char *text = journal >= 0 ? journal_read(journal, &end) : NULL;
    if (text && strncmp(text, head, strlen(head)) == 0
        && sscanf(text + strlen(head), line_of_tiles, &claims->columns, &claims->rows, &claims->count) == 3
        && claims->columns > 0 && claims->rows > 0 && claims->count > 0)
        claims->done = calloc((size_t)claims->count, sizeof *claims->done);
    if (claims->done) {
        claims_mark(claims, text);
        journals_each(path, claims_mark, claims);
    }
    free(text);
    if (journal >= 0)
        close(journal);
    return claims->done;
}

bool tiles_claimed(const char *path, int *done, int *count)
{
    struct claims claims;
    const bool read = claims_read(path, &claims);
    *done = 0;
    *count = claims.count;
    for (int n = 0; read && n < claims.count; n++)
        *done += claims.done[n];
    free(claims.done);
    return read;
}

void tiles_blank(const char *path, const struct grid *grid, double complex *pixels)
{
    struct claims claims;
    const bool read = claims_read(path, &claims);
    const struct tiles tiles = {.grid = *grid, .rows = claims.rows, .columns = claims.columns};
    for (int n = 0; read && tiles_count(&tiles) == claims.count && n < claims.count; n++) {
        const struct pixel_window w = tiles_window(&tiles, n);
        for (int i = w.row; i < w.row + w.rows && !claims.done[n]; i++)
            for (int j = w.column; j < w.column + w.columns; j++)
                pixels[(size_t)i * (size_t)grid->x_count + (size_t)j] = NAN;
    }
    free(claims.done);
}

/* `text`: of the journal. */
static enum status text_take(struct tiles *tiles, const char *text, bool first, const char *settings,
                             const struct image_origin *origin)
{
    bool begun = false;
    enum status status = STATUS_OK;
    const bool ours = strncmp(text, head, strlen(head)) == 0;
    if (*text && !ours)
        status = status_set(STATUS_INVALID, "%s" TILES_JOURNAL ": is no journal of tiles; remove it to begin anew",
                            tiles->path);
    if (status == STATUS_OK && ours)
        status = tiles_continue(tiles, text + strlen(head), settings, &begun);
    if (status != STATUS_OK || begun)
        return status;
    if (!first)
        return status_set(STATUS_INVALID, "%s: another program fills this file", tiles->path);
    if (!*text && tiles->writer > 0 && !tiles->anew && access(tiles->path, F_OK) == 0) {
        journal_remove(tiles->path);
        return status_set(STATUS_INVALID,
                          "%s: is there without a journal, finished or another's; remove it to begin anew",
                          tiles->path);
    }
    return tiles_begin(tiles, settings, origin);
}

static enum status own_take(struct tiles *tiles)
{
    tiles->own = tiles->journal;
    if (tiles->writer == 0)
        return STATUS_OK;
    const enum status status = journal_own(tiles->path, tiles->writer, &tiles->own);
    char *text = status == STATUS_OK ? journal_read(tiles->own, &tiles->journal_end) : NULL;
    if (status == STATUS_OK && !text)
        return tiles_fail(tiles, "its journal cannot be read");
    free(text);
    return status;
}

static enum status opened(struct tiles *tiles, const char *settings, const struct image_origin *origin)
{
    bool first;
    tiles->file = tiles->journal = tiles->own = -1;
    tiles->done = calloc((size_t)tiles_count(tiles), sizeof *tiles->done);
    enum status status = tiles->done ? journal_take(tiles->path, tiles->writer, &tiles->journal, &first)
                                     : tiles_fail(tiles, "out of memory for its tiles");
    char *text = status == STATUS_OK ? journal_read(tiles->journal, &tiles->journal_end) : NULL;
    if (status == STATUS_OK)
        status =
            text ? text_take(tiles, text, first, settings, origin) : tiles_fail(tiles, "its journal cannot be read");
    free(text);
    if (status == STATUS_OK)
        status = own_take(tiles);
    if (status == STATUS_OK && tiles->writer > 0)
        journal_share(tiles->journal);
    if (status != STATUS_OK)
        tiles_close(tiles);
    return status;
}

enum status tiles_open(struct tiles *tiles, const char *settings, const struct image_origin *origin)
{
    const size_t room = strlen(settings) + 100;
    char *all = malloc(room);
    if (!all)
        return tiles_fail(tiles, "out of memory for its settings");
    const int length = snprintf(all, room, line_of_tiles, tiles->columns, tiles->rows, tiles_count(tiles));
    snprintf(all + length, room - (size_t)length, "%s", settings);
    const enum status status = opened(tiles, all, origin);
    free(all);
    return status;
}

enum status tiles_seal(struct tiles *tiles, bool *sealed)
{
    int claimed = 0, count = 0;
    if (tiles->writer > 0 && tiles_claimed(tiles->path, &claimed, &count) && claimed >= count)
        journals_each(tiles->path, other_verify, tiles);
    *sealed = journal_is_gone(tiles->journal);
    if (*sealed || tiles_done(tiles) < tiles_count(tiles))
        return STATUS_OK;
    errno = 0;
    const bool finished =
        status_write(tiles, whole) && (journal_remove(tiles->path) || journal_is_gone(tiles->journal));
    if (finished)
        journals_clear(tiles->path);
    *sealed = finished;
    return finished ? STATUS_OK : tiles_fail(tiles, "cannot be finished");
}

void tiles_close(struct tiles *tiles)
{
    if (tiles->file >= 0)
        close(tiles->file);
    if (tiles->own >= 0 && tiles->own != tiles->journal)
        close(tiles->own);
    if (tiles->journal >= 0)
        close(tiles->journal);
    free(tiles->done);
    tiles->done = NULL;
    tiles->file = tiles->journal = tiles->own = -1;
}
