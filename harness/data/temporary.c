/* Temporary files and folders (temporary.h). */
#define _GNU_SOURCE /* mkostemp */
#include "data/temporary.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static const char pattern[] = ".sasbench-";

/* What exists now, for the signal handler. One that finds no place here is left to the next sweep. */
enum { NAMES_MAX = 2048 };
static char *volatile names[NAMES_MAX];
static volatile sig_atomic_t process_groups[PROCESSES_MOST];

/* Signals that end the program. */
static const int numbers[] = {SIGHUP, SIGINT, SIGQUIT, SIGPIPE, SIGALRM, SIGTERM, SIGXCPU};
enum { NUMBERS = sizeof numbers / sizeof *numbers };
static pthread_t first; /* the thread that makes and removes files; OpenMP's others compute */

void temporary_hold(sigset_t *before)
{
    sigset_t held;
    sigemptyset(&held);
    for (int k = 0; k < NUMBERS; k++)
        sigaddset(&held, numbers[k]);
    pthread_sigmask(SIG_BLOCK, &held, before);
}

void temporary_release(const sigset_t *before)
{
    pthread_sigmask(SIG_SETMASK, before, NULL);
}

static void name_add(const char *path)
{
    for (int k = 0; k < NAMES_MAX; k++)
        if (!names[k]) {
            names[k] = strdup(path);
            return;
        }
}

static void name_drop(const char *path)
{
    for (int k = 0; k < NAMES_MAX; k++) {
        char *name = names[k];
        if (name && strcmp(name, path) == 0) {
            names[k] = NULL;
            free(name); /* which `path` may be */
            return;
        }
    }
}

/* "FOLDER/.sasbench-XXXXXX" for mkstemp and mkdtemp. */
static bool name_beside(const char *path, char made[PATH_MAX])
{
    const char *slash = strrchr(path, '/');
    int folder = slash ? (int)(slash - path) + 1 : 0;
    if (snprintf(made, PATH_MAX, "%.*s%sXXXXXX", folder, path, pattern) < PATH_MAX)
        return true;
    errno = ENAMETOOLONG;
    return false;
}

int temporary_file(const char *path, char made[PATH_MAX])
{
    sigset_t before;
    temporary_hold(&before);
    int descriptor = name_beside(path, made) ? mkostemp(made, O_CLOEXEC) : -1;
    if (descriptor >= 0)
        name_add(made);
    temporary_release(&before);
    if (descriptor < 0)
        return -1;
    mode_t mask = umask(0); /* the rights of any new file, not mkstemp's */
    umask(mask);
    fchmod(descriptor, 0666 & ~mask);
    return descriptor;
}

bool temporary_folder(const char *path, char made[PATH_MAX])
{
    sigset_t before;
    temporary_hold(&before);
    bool good = name_beside(path, made) && mkdtemp(made);
    if (good)
        name_add(made);
    temporary_release(&before);
    return good;
}

void temporary_inside(const char *path)
{
    name_drop(path);
    name_add(path);
}

void temporary_moved(const char *made)
{
    name_drop(made);
}

/* A file, or a folder with the files in it. */
static void remove_whole(int parent, const char *name)
{
    if (unlinkat(parent, name, 0) == 0)
        return;
    int descriptor = openat(parent, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    DIR *directory = descriptor < 0 ? NULL : fdopendir(descriptor);
    if (directory) {
        for (struct dirent *entry; (entry = readdir(directory));)
            unlinkat(descriptor, entry->d_name, 0);
        closedir(directory);
    } else if (descriptor >= 0) {
        close(descriptor);
    }
    unlinkat(parent, name, AT_REMOVEDIR);
}

void temporary_remove(const char *made)
{
    int reason = errno;
    size_t length = strlen(made);
    remove_whole(AT_FDCWD, made);
    for (int k = 0; k < NAMES_MAX; k++) {
        char *name = names[k];
        if (name && strncmp(name, made, length) == 0 && (!name[length] || name[length] == '/'))
            name_drop(name);
    }
    errno = reason;
}

void temporary_sweep(const char *directory)
{
    DIR *entries = opendir(directory);
    if (!entries)
        return;
    for (struct dirent *entry; (entry = readdir(entries));)
        if (strncmp(entry->d_name, pattern, strlen(pattern)) == 0)
            remove_whole(dirfd(entries), entry->d_name);
    closedir(entries);
}

/* `old` becomes `new` in the list of groups; 0 is a free place. */
static void group_change(pid_t old, pid_t new)
{
    for (int k = 0; k < PROCESSES_MOST; k++)
        if (process_groups[k] == old) {
            process_groups[k] = (sig_atomic_t) new;
            return;
        }
}

void temporary_process_add(pid_t group)
{
    group_change(0, group);
}

void temporary_process_drop(pid_t group)
{
    group_change(group, 0);
}

/* Only what a handler may call. On another thread it would work beside the first, which makes and removes files, or
   ends the program meanwhile. */
static void end(int number)
{
    if (!pthread_equal(pthread_self(), first)) {
        pthread_kill(first, number);
        return;
    }
    for (int k = 0; k < PROCESSES_MOST; k++)
        if (process_groups[k] > 0) {
            kill(-(pid_t)process_groups[k], SIGKILL);
            waitpid((pid_t)process_groups[k], NULL, 0); /* it writes no more */
        }
    for (int k = 0; k < NAMES_MAX; k++)
        if (names[k])
            unlink(names[k]);
    for (int k = 0; k < NAMES_MAX; k++) /* the folders that held them */
        if (names[k])
            rmdir(names[k]);
    signal(number, SIG_DFL);
    raise(number); /* it ends the program when this returns */
}

void temporary_guard(void)
{
    struct sigaction action = {.sa_handler = end}, before;
    first = pthread_self();
    for (int k = 0; k < NUMBERS; k++)
        sigaddset(&action.sa_mask, numbers[k]);
    for (int k = 0; k < NUMBERS; k++)
        if (sigaction(numbers[k], NULL, &before) == 0 && before.sa_handler == SIG_DFL)
            sigaction(numbers[k], &action, NULL);
}
