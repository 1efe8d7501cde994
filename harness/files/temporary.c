/* Temporary files and folders (temporary.h). */
#include "files/temporary.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static const char pattern[] = ".sasbench-";

/* What exists now, for the signal handler. One that finds no place here is left to the next sweep. */
enum { NAMES_MAX = 2048 };
struct name {
    int folder; /* descriptor */
    char text[];
};
static struct name *volatile names[NAMES_MAX];
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

static void name_add(int folder, const char *text)
{
    struct name *name = malloc(sizeof *name + strlen(text) + 1);
    int k = 0;
    while (k < NAMES_MAX && names[k])
        k++;
    if (!name || k == NAMES_MAX) {
        free(name);
        return;
    }
    name->folder = folder;
    strcpy(name->text, text);
    names[k] = name;
}

/* text NULL: all in the folder. */
static void name_drop(int folder, const char *text)
{
    for (int k = 0; k < NAMES_MAX; k++) {
        struct name *name = names[k];
        if (name && name->folder == folder && (!text || strcmp(name->text, text) == 0)) {
            names[k] = NULL;
            free(name);
        }
    }
}

/* Lock what was made. False: a sweep took it for one that is left, before it was locked. */
static bool mark(int descriptor)
{
    struct stat info;
    if (flock(descriptor, LOCK_EX | LOCK_NB) != 0)
        return errno != EWOULDBLOCK; /* without locks nobody sweeps it, either */
    return fstat(descriptor, &info) != 0 || info.st_nlink > 0;
}

/* Opens under a name that nobody foresees, and that is not there yet: -1 where that cannot be. */
static int made_open(int folder, char made[TEMPORARY_NAME], int (*open_new)(int folder, const char *name))
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_";
    unsigned char random[12];
    int descriptor = -1;
    errno = EEXIST;
    for (int attempt = 0; attempt < 100 && descriptor < 0 && errno == EEXIST; attempt++) {
        if (getrandom(random, sizeof random, 0) != (ssize_t)sizeof random)
            return -1;
        strcpy(made, pattern);
        char *end = made + strlen(made);
        for (size_t k = 0; k < sizeof random; k++)
            *end++ = letters[random[k] % (sizeof letters - 1)];
        *end = '\0';
        descriptor = open_new(folder, made);
        if (descriptor >= 0 && !mark(descriptor)) {
            close(descriptor);
            descriptor = -1;
            errno = EEXIST;
        }
    }
    return descriptor;
}

static int file_open(int folder, const char *name)
{
    return openat(folder, name, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
}

bool temporary_ours(int folder)
{
    struct stat info, made_info;
    char made[TEMPORARY_NAME];
    int made_file = made_open(folder, made, file_open);
    bool ours = made_file >= 0 && fstat(folder, &info) == 0 && fstat(made_file, &made_info) == 0;
    if (ours && !(ours = info.st_uid == made_info.st_uid))
        errno = EPERM;
    if (made_file >= 0) {
        close(made_file);
        temporary_remove(folder, made, -1);
    }
    return ours;
}

/* Between its making and its opening another may have put a folder of his own there. */
static int folder_open(int folder, const char *name)
{
    if (mkdirat(folder, name, 0700) != 0)
        return -1;
    int descriptor = openat(folder, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (descriptor >= 0 && temporary_ours(descriptor))
        return descriptor;
    temporary_remove(folder, name, descriptor);
    if (errno == EEXIST)
        errno = EPERM; /* not to be tried again */
    return -1;
}

static int made_known(int folder, char made[TEMPORARY_NAME], int (*open_new)(int folder, const char *name))
{
    sigset_t before;
    temporary_hold(&before);
    int descriptor = made_open(folder, made, open_new);
    if (descriptor >= 0)
        name_add(folder, made);
    temporary_release(&before);
    return descriptor;
}

int temporary_file(int folder, char made[TEMPORARY_NAME])
{
    return made_known(folder, made, file_open);
}

int temporary_folder(int folder, char made[TEMPORARY_NAME])
{
    return made_known(folder, made, folder_open);
}

void temporary_inside(int inside, const char *name)
{
    name_drop(inside, name);
    name_add(inside, name);
}

void temporary_moved(int folder, const char *made)
{
    name_drop(folder, made);
}

/* What is in a folder, by `remove_one`. */
static void all_remove(int folder, void (*remove_one)(int folder, const char *name))
{
    int copy = openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *entries = copy < 0 ? NULL : fdopendir(copy);
    for (struct dirent *entry; entries && (entry = readdir(entries));)
        remove_one(folder, entry->d_name);
    if (entries)
        closedir(entries);
    else if (copy >= 0)
        close(copy);
}

static void file_remove(int folder, const char *name)
{
    unlinkat(folder, name, 0);
}

void temporary_remove(int folder, const char *made, int inside)
{
    int reason = errno;
    if (inside >= 0) {
        all_remove(inside, file_remove);
        name_drop(inside, NULL);
    }
    unlinkat(folder, made, inside < 0 ? 0 : AT_REMOVEDIR);
    name_drop(folder, made);
    if (inside >= 0)
        close(inside);
    errno = reason;
}

static void left_remove(int folder, const char *name)
{
    if (strncmp(name, pattern, strlen(pattern)) != 0 || unlinkat(folder, name, 0) == 0)
        return;
    int inside = openat(folder, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (inside >= 0)
        temporary_remove(folder, name, inside);
}

/* Only where no process holds it. */
static void dead_remove(int folder, const char *name)
{
    if (strncmp(name, pattern, strlen(pattern)) != 0)
        return;
    int held = openat(folder, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (held >= 0 && flock(held, LOCK_EX | LOCK_NB) == 0)
        left_remove(folder, name);
    if (held >= 0)
        close(held);
}

void temporary_sweep(int folder, bool ours)
{
    all_remove(folder, ours ? left_remove : dead_remove);
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
            unlinkat(names[k]->folder, names[k]->text, 0);
    for (int k = 0; k < NAMES_MAX; k++) /* the folders that held them */
        if (names[k])
            unlinkat(names[k]->folder, names[k]->text, AT_REMOVEDIR);
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
