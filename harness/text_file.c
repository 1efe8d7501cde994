/* Text files made beside their place and renamed when they are whole (text_file.h). */
#include "text_file.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static void text_file_free(struct text_file *file)
{
    free(file->path);
    free(file->beside);
    *file = (struct text_file){0};
}

enum status text_file_open(const char *path, struct text_file *file)
{
    struct stat info;
    size_t size = strlen(path) + sizeof ".part";
    *file = (struct text_file){.path = strdup(path)};
    if (stat(path, &info) != 0 || S_ISREG(info.st_mode))
        file->beside = malloc(size);
    if (file->beside)
        snprintf(file->beside, size, "%s.part", path);
    file->stream = file->path ? fopen(file->beside ? file->beside : path, "w") : NULL;
    if (file->stream)
        return STATUS_OK;
    enum status status = status_set(STATUS_INVALID, "%s: cannot be written: %s; name a place that can", path,
                                    strerror(errno));
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
    if (status != STATUS_OK && file->beside)
        remove(file->beside);
    text_file_free(file);
    return status;
}
