/* Files that come with the program (paths.h). */
#include "files/paths.h"

#include <limits.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const below[DATA_COUNT] = {
    [DATA_SCENES] = "scenes",
    [DATA_BENCH] = "scenes/bench",
    [DATA_EXTREME] = "scenes/extreme",
    [DATA_PLOTS] = "plots",
    [DATA_PUBLISHED] = "results/published.csv",
    [DATA_CLAIMS] = "results/claims.csv",
    [DATA_NUMBERS] = "results/numbers.csv",
    [DATA_STABILITY] = "results/stability.csv",
    [DATA_BASELINE] = "results/baseline.csv",
    [DATA_PAGES] = "docs/papers",
};

static pthread_once_t once = PTHREAD_ONCE_INIT;
static char paths[DATA_COUNT][PATH_MAX + 32];
static bool installed;

static void paths_make(void)
{
    char root[PATH_MAX], beside[PATH_MAX + sizeof SASBENCH_DATA + 8];
    const ssize_t length = readlink("/proc/self/exe", root, sizeof root - 1);
    root[length > 0 ? length : 0] = '\0';
    char *const name = strrchr(root, '/');
    if (name)
        *name = '\0';
    const bool absolute = *SASBENCH_DATA == '/';
    snprintf(beside, sizeof beside, "%s%s%s", absolute ? "" : root, absolute ? "" : "/../", SASBENCH_DATA);
    installed = name && realpath(beside, root);
    for (int k = 0; k < DATA_COUNT; k++)
        snprintf(paths[k], sizeof paths[k], "%s/%s", installed ? root : SASBENCH_ROOT, below[k]);
}

const char *data_path(enum data which)
{
    pthread_once(&once, paths_make);
    return paths[which];
}

const char *program_called(void)
{
    pthread_once(&once, paths_make);
    return installed ? "sasbench" : "./sasbench";
}
