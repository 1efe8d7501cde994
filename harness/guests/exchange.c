/* Files between the program and an external one (exchange.h). */
#define _GNU_SOURCE /* O_NOFOLLOW */
#include "guests/exchange.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "echoes/matfile.h"
#include "echoes/matvar.h"
#include "echoes/npy.h"
#include "files/folder.h"
#include "text/shown_text.h"

enum { HEAD = 128, LOG_MOST = 65536 }; /* bytes ahead of the samples; of a log that is kept */

static void path_of(const struct exchange *exchange, const char *name, char path[5000])
{
    snprintf(path, 5000, "%s/%s", exchange->folder, name);
}

/* A line ends what names the folder to the program. */
enum status exchange_folder(struct exchange *exchange)
{
    const char *base = getenv("TMPDIR");
    char *whole = base && *base ? realpath(base, NULL) : NULL;
    *exchange = (struct exchange){.samples = -1};
    const bool fits = whole && !strchr(whole, '\n') && strlen(whole) < sizeof exchange->folder - 32;
    snprintf(exchange->folder, sizeof exchange->folder, "%.4060s/sasbench-XXXXXX", fits ? whole : "/tmp");
    free(whole);
    if (mkdtemp(exchange->folder))
        return STATUS_OK;
    return status_set(STATUS_FAILED, "no folder %.600s can be made: %s", exchange->folder, strerror(errno));
}

static bool all_written(int file, const void *bytes, size_t count, off_t at)
{
    const char *next = bytes;
    while (count > 0) {
        const ssize_t written = pwrite(file, next, count, at);
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0)
            return false;
        next += written;
        at += written;
        count -= (size_t)written;
    }
    return true;
}

/* Echo file without samples, with the normal of each ping's beam (sasbench.h), from which aperture_limit counts. */
static enum status problem_write(const char *path, const struct problem *problem)
{
    struct acquisition shown = *problem->acquisition;
    const size_t pings = (size_t)shown.pings;
    struct vector *normals = calloc(pings, sizeof *normals);
    struct grid *patches = calloc((size_t)problem->patch_count, sizeof *patches);
    struct writer writer;
    enum status status = normals && patches ? writer_open(&writer, path, pings * (size_t)shown.receivers * 24)
                                            : status_set(STATUS_FAILED, "%s: no memory", path);
    if (status == STATUS_OK) {
        for (int p = 0; p < shown.pings; p++)
            normals[p] = acquisition_normal(problem->acquisition, p);
        memcpy(patches, problem->patches, (size_t)problem->patch_count * sizeof *patches);
        shown.echo_sine = shown.echo_squint = shown.area.half_x = 0; /* what plans alone know stays hidden */
        write_text(&writer, "format", "sas-echoes 1");
        acquisition_write(&writer, &shown,
                          &(struct echo_notes){.patch_count = problem->patch_count, .patches = patches});
        write_reals(&writer, "normal", 3, pings, 1, &normals->x);
        status = writer_close(&writer);
    }
    free(normals);
    free(patches);
    return status;
}

static enum status write_refuse(const struct exchange *exchange)
{
    return status_set(STATUS_FAILED, "%.600s/samples.npy cannot be written: %s", exchange->folder, strerror(errno));
}

enum status exchange_open(struct exchange *exchange, const struct problem *problem)
{
    const struct acquisition *a = problem->acquisition;
    char path[5000], head[HEAD + 1], text[HEAD - 10];
    path_of(exchange, "problem.mat", path);
    enum status status = problem_write(path, problem);
    if (status != STATUS_OK)
        return status;
    exchange->bytes = samples_bytes(a, problem->precision);
    snprintf(text, sizeof text, "{'descr': '<c%zu', 'fortran_order': False, 'shape': (%d, %d, %d), }",
             precision_size(problem->precision), a->pings, a->receivers, a->samples);
    snprintf(head, sizeof head, "\x93NUMPY\x01%c%c%c%-117s\n", '\0', HEAD - 10, '\0', text);
    path_of(exchange, "samples.npy", path);
    exchange->samples = open(path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (exchange->samples < 0 || !all_written(exchange->samples, head, HEAD, 0)
        || ftruncate(exchange->samples, (off_t)(HEAD + exchange->bytes)) != 0)
        return write_refuse(exchange);
    return STATUS_OK;
}

enum status exchange_give(const struct exchange *exchange, const void *samples)
{
    char path[5000];
    path_of(exchange, "image.npy", path);
    if (unlink(path) != 0 && errno != ENOENT)
        return status_set(STATUS_FAILED, "image.npy of before cannot be removed: %s", strerror(errno));
    return all_written(exchange->samples, samples, exchange->bytes, HEAD) ? STATUS_OK : write_refuse(exchange);
}

/* Through no link, and waiting for no other process. */
enum status exchange_take(const struct exchange *exchange, const struct image *image)
{
    char path[5000];
    struct stat info;
    path_of(exchange, "image.npy", path);
    const int file = open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (file < 0)
        return status_set(STATUS_INVALID, "said `took` without an image.npy: %s", strerror(errno));
    FILE *stream = fstat(file, &info) == 0 && S_ISREG(info.st_mode) ? fdopen(file, "rb") : NULL;
    if (!stream) {
        close(file);
        return status_set(STATUS_INVALID, "image.npy is not a file");
    }
    const enum status status = npy_pixels_read(stream, "image.npy", image);
    fclose(stream);
    return status;
}

/* The log's first bytes, or its last, ended by a zero. */
static size_t log_read(const struct exchange *exchange, bool last, char *bytes, size_t most)
{
    char path[5000];
    struct stat info;
    path_of(exchange, "log", path);
    const int file = open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    ssize_t found = 0;
    if (file >= 0 && fstat(file, &info) == 0 && S_ISREG(info.st_mode))
        found = pread(file, bytes, most, last && info.st_size > (off_t)most ? info.st_size - (off_t)most : 0);
    if (file >= 0)
        close(file);
    bytes[found > 0 ? found : 0] = '\0';
    return found > 0 ? (size_t)found : 0;
}

void exchange_log_line(const struct exchange *exchange, bool last, char *line, size_t size)
{
    char text[401];
    size_t end = log_read(exchange, last, text, sizeof text - 1);
    for (size_t k = 0; k < end; k++) /* a zero would hide what is behind it */
        text[k] = text[k] ? text[k] : '?';
    while (end > 0 && strchr(" \t\r\n", text[end - 1]))
        text[--end] = '\0';
    const char *begin = last ? strrchr(text, '\n') : NULL;
    if (!last)
        text[strcspn(text, "\n")] = '\0';
    snprintf(line, size, "%s", begin ? begin + 1 : text);
    shown_make(line);
}

void exchange_log_keep(const struct exchange *exchange, const char *results, const char *heading)
{
    static char bytes[LOG_MOST + 1];
    char path[5000];
    struct place place;
    const size_t count = log_read(exchange, true, bytes, LOG_MOST);
    snprintf(path, sizeof path, "%s/external.log", results);
    if (count == 0 || !place_open(path, false, &place))
        return;
    const int file = openat(place.folder, place.name, O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (file >= 0) {
        dprintf(file, "== %s\n", heading);
        if (write(file, bytes, count) < 0 || (bytes[count - 1] != '\n' && write(file, "\n", 1) < 0))
            shown_note("external.log cannot be written");
        close(file);
    }
    place_close(&place);
}

void exchange_close(struct exchange *exchange)
{
    if (exchange->samples >= 0)
        close(exchange->samples);
    exchange->samples = -1;
}
