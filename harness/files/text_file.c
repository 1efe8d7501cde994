/* Text files that get their name when they are whole (text_file.h). */
#define _GNU_SOURCE /* asprintf */
#include "files/text_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void text_file_free(struct text_file *file)
{
    place_drop(&file->place, &file->made);
    place_close(&file->place);
    free(file->path);
}

/* The standard stream that `info` is, under any name (/dev/stdout, a file that it is redirected to), or -1: replacing
   it would part it from what else is printed there. */
static int standard_stream(const struct stat *info)
{
    struct stat stream;
    for (int k = STDOUT_FILENO; k <= STDERR_FILENO; k++)
        if (fstat(k, &stream) == 0 && stream.st_dev == info->st_dev && stream.st_ino == info->st_ino)
            return k;
    return -1;
}

static FILE *made_open(struct text_file *file)
{
    int copy = place_make(&file->place, &file->made) ? fcntl(file->made.descriptor, F_DUPFD_CLOEXEC, 0) : -1;
    FILE *stream = copy < 0 ? NULL : fdopen(copy, "w");
    if (!stream && copy >= 0)
        close(copy);
    return stream;
}

/* Find a folder in the way before all is written, not after. */
static bool folder_in_the_way(const struct place *place)
{
    struct stat info;
    if (fstatat(place->folder, place->name, &info, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISDIR(info.st_mode))
        return false;
    errno = EISDIR;
    return true;
}

static FILE *standard_open(int standard)
{
    int copy = fflush(standard == STDOUT_FILENO ? stdout : stderr) == 0 ? dup(standard) : -1;
    return copy < 0 ? NULL : fdopen(copy, "w");
}

static enum status file_open(const char *path, bool named, struct text_file *file)
{
    struct stat info;
    bool exists = named && stat(path, &info) == 0;
    int standard = exists ? standard_stream(&info) : -1;
    *file = (struct text_file){.path = strdup(path), .place.folder = -1, .made.descriptor = -1};
    if (file->path && standard >= 0)
        file->stream = standard_open(standard);
    else if (file->path && exists && !S_ISREG(info.st_mode))
        file->stream = fopen(path, "w");
    else if (file->path && place_open(path, named, &file->place) && !folder_in_the_way(&file->place))
        file->stream = made_open(file);
    if (file->stream)
        return STATUS_OK;
    /* A full disk may be free again for the same call. */
    const bool full = errno == ENOSPC || errno == EDQUOT || errno == EIO;
    enum status status =
        full ? status_set(STATUS_FAILED, "%s: cannot be written: %s", path, strerror(errno))
             : status_set(STATUS_INVALID, "%s: cannot be written: %s; name a place that can", path, strerror(errno));
    text_file_free(file);
    return status;
}

enum status text_file_open(const char *path, struct text_file *file)
{
    return file_open(path, false, file);
}

enum status text_file_in(const char *directory, const char *name, struct text_file *file)
{
    char *path;
    if (asprintf(&path, "%s/%s", directory, name) < 0)
        return status_set(STATUS_FAILED, "no memory for a name");
    const enum status status = text_file_open(path, file);
    free(path);
    return status;
}

enum status text_file_open_named(const char *path, struct text_file *file)
{
    return file_open(path, true, file);
}

/* The reason why a file could not grow before: a full disk is still full. The file is to be dropped. */
static int reason_now(int descriptor)
{
    struct stat info;
    if (fstat(descriptor, &info) != 0 || !S_ISREG(info.st_mode))
        return EIO;
    const int reason = posix_fallocate(descriptor, info.st_size, 1 << 16);
    const bool cut = ftruncate(descriptor, info.st_size) == 0;
    return cut && (reason == ENOSPC || reason == EDQUOT || reason == EFBIG) ? reason : EIO;
}

/* After an earlier failed write errno has changed: often a retry of the rest fails again, with the same. */
bool stream_flush(FILE *stream)
{
    errno = 0;
    if (fflush(stream) == 0 && !ferror(stream))
        return true;
    errno = errno ? errno : reason_now(fileno(stream));
    return false;
}

bool stream_close(FILE *stream)
{
    bool flushed = stream_flush(stream);
    int reason = errno;
    bool closed = fclose(stream) == 0;
    if (!flushed)
        errno = reason;
    return flushed && closed;
}

/* Is all of it on the disk, if it is a file? */
static enum status file_sync(struct text_file *file, enum status status)
{
    if (status != STATUS_OK
        || (stream_flush(file->stream) && (file->made.descriptor < 0 || place_sync(fileno(file->stream)))))
        return status;
    return status_set(STATUS_FAILED, "%s: cannot be written: %s", file->path, strerror(errno));
}

static enum status file_put(struct text_file *file, enum status status)
{
    if (status == STATUS_OK && file->made.descriptor >= 0 && !place_put(&file->place, &file->made))
        status = status_set(STATUS_FAILED, "%s: cannot be replaced: %s", file->path, strerror(errno));
    text_file_free(file);
    return status;
}

enum status text_file_close(struct text_file *file, enum status status)
{
    status = file_sync(file, status);
    if (!stream_close(file->stream) && status == STATUS_OK)
        status = status_set(STATUS_FAILED, "%s: cannot be closed: %s", file->path, strerror(errno));
    return file_put(file, status);
}

enum status text_file_keep(struct text_file *file, FILE **stream)
{
    *stream = file->stream;
    enum status status = file_put(file, file_sync(file, STATUS_OK));
    if (status != STATUS_OK) {
        fclose(*stream);
        *stream = NULL;
    }
    return status;
}
