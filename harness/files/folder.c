/* Folders of results and places in them (folder.h). */
#define _GNU_SOURCE /* group_member, O_PATH, O_TMPFILE */
#include "files/folder.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* With room for the longest name of a file in it. */
enum { DIRECTORY_MAX = PATH_MAX - NAME_MAX - 2 };

enum { RETRIES = 20 }; /* for the lock: a second */

/* The folders that are taken now. */
struct taken {
    struct taken *next;
    int descriptor;
    char path[];
};
static struct taken *taken_now;

/* --- Ways -------------------------------------------------------------------------------------------------------- */

/* The rest of a path behind a folder's name; NULL when the path does not lead into it. */
static const char *rest_of(const char *path, const char *directory)
{
    size_t length = strlen(directory);
    while (length > 0 && directory[length - 1] == '/')
        length--;
    if (strncmp(path, directory, length) != 0 || path[length] != '/')
        return NULL;
    const char *rest = path + length + strspn(path + length, "/");
    return *rest ? rest : NULL;
}

/* The innermost folder taken that a path leads into, or NULL. */
static const struct taken *taken_find(const char *path, const char **rest)
{
    const struct taken *found = NULL;
    for (const struct taken *taken = taken_now; taken; taken = taken->next) {
        const char *this_rest = rest_of(path, taken->path);
        if (this_rest && (!found || strlen(this_rest) < strlen(*rest))) {
            found = taken;
            *rest = this_rest;
        }
    }
    return found;
}

/* The folder of the last name on a way that begins in `folder` and follows no link: `folder` itself, or one to be
   closed. -1: errno has the reason. */
static int way_walk(int folder, const char *rest, const char **name)
{
    int at = folder;
    for (const char *slash; at >= 0 && (slash = strchr(rest, '/')); rest = slash + strspn(slash, "/")) {
        char part[NAME_MAX + 1];
        const int length = (int)(slash - rest);
        const bool good = length < (int)sizeof part && !(length == 2 && strncmp(rest, "..", 2) == 0);
        snprintf(part, sizeof part, "%.*s", length, rest);
        const int next = good ? openat(at, part, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC) : -1;
        const int reason = good ? errno : EINVAL;
        if (at != folder)
            close(at);
        errno = reason;
        at = next;
    }
    *name = rest;
    return at;
}

/* The folder that a path's last name lies in; *borrowed: not to be closed. */
static int way_open(const char *path, const char **name, bool *borrowed)
{
    char directory[PATH_MAX] = ".";
    const char *rest, *slash = strrchr(path, '/');
    const struct taken *found = taken_find(path, &rest);
    int folder = found ? way_walk(found->descriptor, rest, name) : -1;
    *borrowed = found && folder == found->descriptor;
    if (found)
        return folder;
    *name = slash ? slash + 1 : path;
    if (slash
        && snprintf(directory, sizeof directory, "%.*s", slash == path ? 1 : (int)(slash - path), path) >= PATH_MAX) {
        errno = ENAMETOOLONG;
        return -1;
    }
    folder = open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    return folder < 0 && errno == EACCES ? open(directory, O_PATH | O_DIRECTORY | O_CLOEXEC) : folder;
}

static char *link_follow(const char *path)
{
    struct stat info;
    bool link = lstat(path, &info) == 0 && S_ISLNK(info.st_mode);
    return link ? realpath(path, NULL) : strdup(path);
}

bool place_open(const char *path, bool named, struct place *place)
{
    const char *name;
    char *followed = named ? link_follow(path) : strdup(path);
    place->folder = followed ? way_open(followed, &name, &place->borrowed) : -1;
    if (place->folder >= 0
        && snprintf(place->name, sizeof place->name, "%s", *name ? name : ".") >= (int)sizeof place->name) {
        place_close(place);
        errno = ENAMETOOLONG;
    }
    int reason = errno;
    free(followed);
    errno = reason;
    return place->folder >= 0;
}

void place_close(struct place *place)
{
    if (place->folder >= 0 && !place->borrowed)
        close(place->folder);
    place->folder = -1;
}

bool place_sync(int descriptor)
{
    return fsync(descriptor) == 0 || (errno != EIO && errno != ENOSPC && errno != EDQUOT);
}

static const char made_prefix[] = ".sasbench-";
enum { MADE_DIGITS = 12 };

/* An unpredictable name that is not there yet; `try_name` makes it, or -1. */
static int name_make(int folder, struct made *made, int (*try_name)(int folder, const struct made *made))
{
    int result = -1;
    errno = EEXIST;
    for (int attempt = 0; attempt < 100 && result < 0 && errno == EEXIST; attempt++) {
        uint64_t random;
        if (getrandom(&random, sizeof random, 0) != sizeof random)
            return -1;
        snprintf(made->name, sizeof made->name, "%s%0*" PRIx64, made_prefix, MADE_DIGITS, random >> 16);
        result = try_name(folder, made);
    }
    return result;
}

static int name_link(int folder, const struct made *made)
{
    char path[32];
    snprintf(path, sizeof path, "/proc/self/fd/%d", made->descriptor);
    return linkat(AT_FDCWD, path, folder, made->name, AT_SYMLINK_FOLLOW);
}

static int name_open(int folder, const struct made *made)
{
    return openat(folder, made->name, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
}

/* Held while the program lives; of its own open file, whatever others lock by other descriptors. False: another holds
   it, or the file system has no locks. */
static bool made_lock(int descriptor)
{
    struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    return fcntl(descriptor, F_OFD_SETLK, &lock) == 0;
}

static void leftover_remove(int folder, const char *name)
{
    enum { OLD_S = 3600 }; /* some file systems keep locks from other machines: who lives writes */
    struct stat info;
    const int file = openat(folder, name, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (file >= 0 && fstat(file, &info) == 0 && S_ISREG(info.st_mode) && info.st_uid == geteuid()
        && time(NULL) - info.st_mtime > OLD_S && made_lock(file))
        unlinkat(folder, name, 0);
    if (file >= 0)
        close(file);
}

void place_tidy(const struct place *place)
{
    const int own = openat(place->folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *list = own >= 0 ? fdopendir(own) : NULL;
    for (struct dirent *entry; list && (entry = readdir(list));)
        if (strncmp(entry->d_name, made_prefix, strlen(made_prefix)) == 0
            && strlen(entry->d_name) == strlen(made_prefix) + MADE_DIGITS
            && strspn(entry->d_name + strlen(made_prefix), "0123456789abcdef") == MADE_DIGITS)
            leftover_remove(place->folder, entry->d_name);
    if (list)
        closedir(list);
    else if (own >= 0)
        close(own);
}

bool place_make(const struct place *place, struct made *made)
{
    *made = (struct made){.descriptor = openat(place->folder, ".", O_TMPFILE | O_RDWR | O_CLOEXEC, 0666)};
    if (made->descriptor < 0 && (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL))
        made->descriptor = name_make(place->folder, made, name_open);
    if (made->descriptor >= 0)
        made_lock(made->descriptor);
    return made->descriptor >= 0;
}

bool place_name(const struct place *place, struct made *made)
{
    return *made->name || name_make(place->folder, made, name_link) == 0;
}

/* No signal comes between the two names. */
bool place_put(const struct place *place, struct made *made)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before);
    const bool put = place_name(place, made) && renameat(place->folder, made->name, place->folder, place->name) == 0;
    if (put)
        *made->name = '\0';
    place_drop(place, made);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return put && place_sync(place->folder);
}

void place_drop(const struct place *place, struct made *made)
{
    const int reason = errno;
    if (*made->name)
        unlinkat(place->folder, made->name, 0);
    if (made->descriptor >= 0)
        close(made->descriptor);
    *made = (struct made){.descriptor = -1};
    errno = reason;
}

/* Does what we make in a folder belong to the folder's owner? */
static bool folder_ours(int folder, const struct stat *info)
{
    const struct place place = {.folder = folder};
    struct stat made_info;
    struct made made;
    bool ours = place_make(&place, &made) && fstat(made.descriptor, &made_info) == 0;
    place_drop(&place, &made);
    return ours && info->st_uid == made_info.st_uid;
}

int place_read(const char *path, int flags)
{
    struct place place;
    const char *rest;
    if (!taken_find(path, &rest))
        return open(path, O_RDONLY | O_CLOEXEC | flags);
    if (!place_open(path, false, &place))
        return -1;
    int descriptor = openat(place.folder, place.name, O_RDONLY | O_NOFOLLOW | O_CLOEXEC | flags);
    int reason = errno;
    place_close(&place);
    errno = reason;
    return descriptor;
}

bool place_is_file(const char *path)
{
    struct place place;
    struct stat info;
    if (!place_open(path, false, &place))
        return false;
    bool is_file = fstatat(place.folder, place.name, &info, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(info.st_mode);
    place_close(&place);
    return is_file;
}

void place_clear(const char *path)
{
    struct place place;
    if (place_open(path, false, &place)) {
        unlinkat(place.folder, place.name, 0);
        place_close(&place);
    }
}

/* --- Folders ----------------------------------------------------------------------------------------------------- */

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

/* Make one folder that outlasts a power cut; false: errno has the reason. */
static bool one_make(const char *path)
{
    struct place place;
    bool made = place_open(path, false, &place) && mkdirat(place.folder, place.name, 0777) == 0;
    int reason = errno;
    if (made)
        place_sync(place.folder);
    place_close(&place);
    errno = reason;
    return made;
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
    for (size_t length = strlen(path); length > 1 && path[length - 1] == '/'; length--)
        path[length - 1] = '\0';
    for (char *at = path; *at; at++) {
        if (*at == '/' && at != path) {
            *at = '\0';
            one_make(path); /* the last one's status decides */
            *at = '/';
        }
    }
    if (!one_make(path) && (errno != EEXIST || stat(path, &info) != 0 || !S_ISDIR(info.st_mode)))
        status = status_set(STATUS_INVALID, "%s: cannot be made: %s; name a folder that can be written", directory,
                            strerror(errno));
    free(path);
    return status;
}

/* In a folder where others may write, our files can be replaced by theirs. Root is trusted; as root, e.g. in a
   container, any folder is accepted. */
static enum status owner_check(const char *directory, int descriptor)
{
    struct stat info;
    if (fstat(descriptor, &info) != 0)
        return status_set(STATUS_INVALID, "%s: cannot be read: %s", directory, strerror(errno));
    if ((info.st_mode & S_ISVTX) && (info.st_mode & S_IWOTH))
        return status_set(STATUS_INVALID, "%s: all users share this folder; name one inside it, which is made",
                          directory);
    const bool shared = (info.st_mode & S_IWGRP) && (info.st_gid == getegid() || group_member(info.st_gid));
    if (geteuid() == 0 || info.st_uid == geteuid() || info.st_uid == 0 || shared || folder_ours(descriptor, &info))
        return STATUS_OK;
    return status_set(
        STATUS_INVALID,
        "%s: belongs to another user (%ld); accepted: a folder of your own, of root's, or one that a group "
        "of yours may write to",
        directory, (long)info.st_uid);
}

static enum status lock_get(const char *directory, int descriptor)
{
    int taken = flock(descriptor, LOCK_EX | LOCK_NB);
    for (int k = 0; k < RETRIES && taken != 0 && errno == EWOULDBLOCK; k++) { /* a killed program may still be ending */
        nanosleep(&(struct timespec){.tv_nsec = 50000000}, NULL);
        taken = flock(descriptor, LOCK_EX | LOCK_NB);
    }
    if (taken != 0 && errno == EWOULDBLOCK)
        return status_set(STATUS_INVALID,
                          "%s: another sasbench is at work in this folder; let it end, or name another folder",
                          directory);
    if (taken != 0)
        fprintf(stderr, "sasbench: %s: this file system cannot lock a folder (%s); start no second program in it\n",
                directory, strerror(errno));
    return STATUS_OK;
}

static enum status taken_add(const char *directory, int descriptor)
{
    struct taken *taken = malloc(sizeof *taken + strlen(directory) + 1);
    if (!taken)
        return status_set(STATUS_FAILED, "%s: no memory", directory);
    *taken = (struct taken){.next = taken_now, .descriptor = descriptor};
    strcpy(taken->path, directory);
    taken_now = taken;
    return STATUS_OK;
}

/* Ours: results, and nothing else. */
static enum status take(const char *directory, bool ours, int *lock)
{
    *lock = -1;
    /* The folder itself is locked. Programs that we start do not inherit the lock. */
    int descriptor = place_read(directory, O_DIRECTORY);
    if (descriptor < 0)
        return status_set(STATUS_INVALID, "%s: cannot be opened: %s; a folder is needed", directory, strerror(errno));
    enum status status = ours ? owner_check(directory, descriptor) : STATUS_OK;
    if (status == STATUS_OK)
        status = lock_get(directory, descriptor);
    if (status == STATUS_OK && ours)
        status = taken_add(directory, descriptor);
    if (status != STATUS_OK) {
        close(descriptor);
        return status;
    }
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
    for (struct taken **at = &taken_now; *at; at = &(*at)->next)
        if ((*at)->descriptor == lock) {
            struct taken *left = *at;
            *at = left->next;
            free(left);
            break;
        }
    if (lock >= 0)
        close(lock);
}
