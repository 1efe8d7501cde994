/* Folders of ranks (rank_folders.h). */
#include "ranks/rank_folders.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "files/folder.h"
#include "results/merge.h"
#include "text/number.h"

static const char prefix[] = "rank-";

void rank_folder(const char *directory, int number, char *path, size_t size)
{
    snprintf(path, size, "%s/%s%d", directory, prefix, number);
}

static int is_of_rank(const struct dirent *entry)
{
    long long number;
    const char *name = entry->d_name;
    const char *end =
        strncmp(name, prefix, strlen(prefix)) == 0 ? whole_read(name + strlen(prefix), 1, 1 << 30, &number) : NULL;
    return end && !*end;
}

/* Its rows are on the disk elsewhere. What else is in it stays, and it with that. */
static void folder_remove(const char *folder)
{
    static const char *const names[] = {"measurements.csv", "targets.csv", "plans.csv"};
    char path[4400];
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[k]);
        unlink(path);
    }
    rmdir(folder);
}

/* One without rows has nothing to join; it is removed where no rank of another run has it. */
static enum status folder_join(const char *folder, const char *directory)
{
    static struct merged merged[KINDS_OF_MACHINES];
    char path[4400];
    int count, lock = -1;
    snprintf(path, sizeof path, "%s/measurements.csv", folder);
    const enum status status =
        access(path, F_OK) == 0 ? results_merge(1, &folder, directory, merged, &count) : folder_take(folder, &lock);
    if (status == STATUS_OK)
        folder_remove(folder);
    folder_leave(lock);
    return status;
}

enum status rank_folders_join(const char *directory)
{
    struct dirent **entries;
    char path[4200], message[600] = "";
    const int count = scandir(directory, &entries, is_of_rank, alphasort);
    enum status status = STATUS_OK;
    for (int k = 0; k < count; k++) {
        snprintf(path, sizeof path, "%s/%s", directory, entries[k]->d_name);
        const enum status joined = folder_join(path, directory);
        if (joined != STATUS_OK && status == STATUS_OK) {
            status = joined;
            snprintf(message, sizeof message, "%s", status_message());
        }
        free(entries[k]);
    }
    if (count >= 0)
        free(entries);
    return status == STATUS_OK ? STATUS_OK : status_set(status, "%s", message);
}
