/* Journals of tiles (tile_journals.h). */
#include "echoes/tile_journals.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "text/number.h"

enum { WAIT_MS = 20, WAITS = 30 * 1000 / WAIT_MS }; /* for the writer that makes the file */

static enum status journal_open(const char *path, int writer, int *journal)
{
    char name[PATH_MAX];
    const int length = writer > 0 ? snprintf(name, sizeof name, "%s" TILES_JOURNAL ".%d", path, writer)
                                  : snprintf(name, sizeof name, "%s" TILES_JOURNAL, path);
    if (length >= (int)sizeof name)
        return status_set(STATUS_INVALID, "%.100s...: path too long for a journal beside it", path);
    *journal = open(name, O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    return *journal >= 0 ? STATUS_OK
                         : status_set(STATUS_FAILED, "%s: its journal cannot be opened: %s", path, strerror(errno));
}

bool journal_remove(const char *path)
{
    char name[PATH_MAX];
    return snprintf(name, sizeof name, "%s" TILES_JOURNAL, path) < (int)sizeof name && unlink(name) == 0;
}

static enum status taken(const char *path)
{
    return status_set(STATUS_INVALID, "%s: another program fills this file", path);
}

bool journal_is_gone(int journal)
{
    struct stat file;
    return fstat(journal, &file) == 0 && file.st_nlink == 0;
}

enum status journal_take(const char *path, int writer, int *journal, bool *first)
{
    for (int n = 0; n < WAITS; n++) {
        struct stat file;
        enum status status = journal_open(path, 0, journal);
        if (status != STATUS_OK)
            return status;
        *first = flock(*journal, LOCK_EX | LOCK_NB) == 0;
        if (!*first && writer == 0)
            return taken(path);
        const bool shared = !*first && flock(*journal, LOCK_SH | LOCK_NB) == 0;
        const bool begun = fstat(*journal, &file) == 0 && file.st_size > 0;
        if ((*first || (shared && begun)) && !journal_is_gone(*journal))
            return STATUS_OK;
        close(*journal);
        *journal = -1;
        poll(NULL, 0, WAIT_MS);
    }
    return taken(path);
}

void journal_share(int journal)
{
    flock(journal, LOCK_SH);
}

enum status journal_own(const char *path, int writer, int *journal)
{
    const enum status status = journal_open(path, writer, journal);
    return status == STATUS_OK && flock(*journal, LOCK_EX | LOCK_NB) != 0 ? taken(path) : status;
}

char *journal_read(int journal, off_t *end)
{
    struct stat file;
    if (fstat(journal, &file) != 0)
        return NULL;
    char *text = malloc((size_t)file.st_size + 1);
    ssize_t length = text ? pread(journal, text, (size_t)file.st_size, 0) : -1;
    while (length > 0 && text[length - 1] != '\n')
        length--;
    if (length >= 0)
        text[length] = '\0';
    *end = length;
    return text;
}

int journal_claim(const char *line, const char *end, unsigned long *sum)
{
    int number, length = 0;
    return sscanf(line, "done %d %8lx%n", &number, sum, &length) == 2 && line + length == end ? number : -1;
}

/* The names of all writers' journals, in their folder. */
static void names_each(const char *path, void (*each)(void *with, int folder, const char *name), void *with)
{
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path;
    const size_t length = strlen(base);
    char folder[PATH_MAX];
    if (snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path + 1) : 1, slash ? path : ".")
        >= (int)sizeof folder)
        return;
    DIR *open = opendir(folder);
    for (struct dirent *entry; open && (entry = readdir(open));) {
        const char *name = entry->d_name, *rest = name + length + strlen(TILES_JOURNAL ".");
        long long writer;
        if (strncmp(name, base, length) != 0
            || strncmp(name + length, TILES_JOURNAL ".", strlen(TILES_JOURNAL ".")) != 0)
            continue;
        const char *end = whole_read(rest, 1, INT_MAX, &writer);
        if (end && !*end)
            each(with, dirfd(open), name);
    }
    if (open)
        closedir(open);
}

struct reader {
    void (*each)(void *with, const char *text);
    void *with;
};

static void text_read(void *with, int folder, const char *name)
{
    const struct reader *reader = with;
    off_t end;
    const int journal = openat(folder, name, O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
    char *text = journal >= 0 ? journal_read(journal, &end) : NULL;
    if (text)
        reader->each(reader->with, text);
    free(text);
    if (journal >= 0)
        close(journal);
}

void journals_each(const char *path, void (*each)(void *with, const char *text), void *with)
{
    names_each(path, text_read, &(struct reader){each, with});
}

static void name_remove(void *with, int folder, const char *name)
{
    (void)with;
    unlinkat(folder, name, 0);
}

void journals_clear(const char *path)
{
    names_each(path, name_remove, NULL);
}
