/* Text files made beside their place and renamed when they are whole (text_file.h). */
#include "data/text_file.h"

#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "data/temporary.h"

static void text_file_free(struct text_file *file)
{
    free(file->path);
    free(file->beside);
    *file = (struct text_file){0};
}

/* The standard stream that `info` is, by whatever name it was given (/dev/stdout, a file that it is led into), or -1:
   to replace it would part it from what else is printed there. */
static int standard_stream(const struct stat *info)
{
    struct stat stream;
    for (int k = STDOUT_FILENO; k <= STDERR_FILENO; k++)
        if (fstat(k, &stream) == 0 && stream.st_dev == info->st_dev && stream.st_ino == info->st_ino)
            return k;
    return -1;
}

static FILE *beside_open(struct text_file *file)
{
    char made[PATH_MAX];
    int descriptor = temporary_file(file->path, made);
    if (descriptor < 0)
        return NULL;
    file->beside = strdup(made);
    FILE *stream = file->beside ? fdopen(descriptor, "w") : NULL;
    if (!stream) {
        close(descriptor);
        temporary_remove(made);
    }
    return stream;
}

char *place_follow(const char *path)
{
    struct stat info;
    bool link = lstat(path, &info) == 0 && S_ISLNK(info.st_mode);
    return link ? realpath(path, NULL) : strdup(path);
}

enum status text_file_open(const char *path, struct text_file *file)
{
    struct stat info;
    bool exists = stat(path, &info) == 0;
    int standard = exists ? standard_stream(&info) : -1;
    bool beside = standard < 0 && (!exists || S_ISREG(info.st_mode));
    *file = (struct text_file){.path = beside ? place_follow(path) : strdup(path)};
    if (file->path && standard >= 0) {
        int copy = fflush(standard == STDOUT_FILENO ? stdout : stderr) == 0 ? dup(standard) : -1;
        file->stream = copy < 0 ? NULL : fdopen(copy, "w");
    } else if (file->path) {
        file->stream = beside ? beside_open(file) : fopen(path, "w");
    }
    if (file->stream)
        return STATUS_OK;
    enum status status =
        status_set(STATUS_INVALID, "%s: cannot be written: %s; name a place that can", path, strerror(errno));
    text_file_free(file);
    return status;
}

enum status text_file_close(struct text_file *file, enum status status)
{
    bool written = !ferror(file->stream);
    written = fclose(file->stream) == 0 && written;
    if (status == STATUS_OK && !written)
        status = status_set(STATUS_FAILED, "%s: cannot be written: %s", file->path, strerror(errno));
    if (status == STATUS_OK && file->beside && rename(file->beside, file->path) != 0)
        status = status_set(STATUS_FAILED, "%s: cannot be replaced: %s", file->path, strerror(errno));
    if (file->beside && status == STATUS_OK)
        temporary_moved(file->beside);
    else if (file->beside)
        temporary_remove(file->beside);
    text_file_free(file);
    return status;
}
