/* Folders of results (folder.h). */
#include "data/folder.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "data/temporary.h"

/* With room for the longest name of a file in it. */
enum { DIRECTORY_MAX = PATH_MAX - NAME_MAX - 2 };

enum { RETRIES = 20 }; /* for the lock: a second */

static enum status name_check(const char *directory)
{
    if (strlen(directory) > DIRECTORY_MAX)
        return status_set(STATUS_INVALID, "%.100s...: a path of %zu bytes; a folder's may have %d", directory,
                          strlen(directory), (int)DIRECTORY_MAX);
    for (const char *at = directory; *at; at++)
        if ((unsigned char)*at < ' ' || *at == 0x7f)
            return status_set(STATUS_INVALID,
                              "%s: the name holds the control character 0x%02x; name a folder without "
                              "one",
                              directory, (unsigned)*at);
    return STATUS_OK;
}

enum status directory_make(const char *directory)
{
    struct stat info;
    enum status status = name_check(directory);
    char *path = status == STATUS_OK ? strdup(directory) : NULL;
    if (status == STATUS_OK && !path)
        status = status_set(STATUS_FAILED, "%s: no memory", directory);
    if (status != STATUS_OK)
        return status;
    for (char *at = path; *at; at++) {
        if (*at == '/' && at != path) {
            *at = '\0';
            mkdir(path, 0777); /* the last one tells whether it went well */
            *at = '/';
        }
    }
    if (mkdir(path, 0777) != 0 && (errno != EEXIST || stat(path, &info) != 0 || !S_ISDIR(info.st_mode)))
        status = status_set(STATUS_INVALID, "%s: cannot be made: %s; name a folder that can be written", directory,
                            strerror(errno));
    free(path);
    return status;
}

/* Swept: what killed programs left there is removed. */
static enum status take(const char *directory, bool swept, int *lock)
{
    *lock = -1;
    /* The folder itself is what is locked. Programs that we start do not inherit it. */
    int descriptor = open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0)
        return status_set(STATUS_INVALID, "%s: cannot be opened: %s; a folder is needed", directory, strerror(errno));
    int taken = flock(descriptor, LOCK_EX | LOCK_NB);
    for (int k = 0; k < RETRIES && taken != 0 && errno == EWOULDBLOCK; k++) { /* one that was killed is still ending */
        nanosleep(&(struct timespec){.tv_nsec = 50000000}, NULL);
        taken = flock(descriptor, LOCK_EX | LOCK_NB);
    }
    if (taken != 0) {
        if (errno == EWOULDBLOCK) {
            close(descriptor);
            return status_set(STATUS_INVALID,
                              "%s: another sasbench is at work in this folder; let it end, or name "
                              "another folder",
                              directory);
        }
        fprintf(stderr, "sasbench: %s: this file system cannot lock a folder (%s); start no second program in it\n",
                directory, strerror(errno));
    }
    if (swept)
        temporary_sweep(directory);
    *lock = descriptor;
    return STATUS_OK;
}

enum status folder_take(const char *directory, int *lock)
{
    *lock = -1;
    enum status status = name_check(directory);
    return status == STATUS_OK ? take(directory, true, lock) : status;
}

enum status folder_take_around(const char *path, int *lock)
{
    struct stat info;
    const char *slash = strrchr(path, '/');
    *lock = -1;
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode)) /* written to as it is */
        return STATUS_OK;
    char *directory = slash ? strndup(path, slash == path ? 1 : (size_t)(slash - path)) : strdup(".");
    if (!directory)
        return status_set(STATUS_FAILED, "%s: no memory for the name of its folder", path);
    enum status status = take(directory, false, lock);
    free(directory);
    return status;
}

void folder_leave(int lock)
{
    if (lock >= 0)
        close(lock);
}
