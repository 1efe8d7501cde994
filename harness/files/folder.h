/* A folder of results, which only one program at a time may use, and the places of files. */
#ifndef SASBENCH_FILES_FOLDER_H
#define SASBENCH_FILES_FOLDER_H

#include <limits.h>
#include <stdbool.h>

#include "contract/status.h"

/* Make a folder and those above it, like mkdir -p; one that exists is fine. Errors: STATUS_INVALID naming it. */
enum status directory_make(const char *directory);

/* Take a folder that exists. The lock is the kernel's: it ends with the process, whatever ends that, and leaves no
   file. A second program is refused at once. Until folder_leave, every path that begins with the folder's name leads
   into this very folder, through no link, whatever replaces the name. Errors: STATUS_INVALID when another program works
   there, for what is no folder, and for one that another user owns or that all users share. */
enum status folder_take(const char *directory, int *lock);
/* Take the folder that a single file is written into, so that no second program writes the same one. What is no regular
   file needs no lock: *lock is then -1. Errors: as folder_take. */
enum status folder_take_around(const char *path, int *lock);
/* Accepts -1. */
void folder_leave(int lock);

/* The place of a new file: its name in a folder that is held open. What already has that name is replaced, also a
   link. */
struct place {
    int folder;
    bool borrowed; /* of a folder that is taken */
    char name[NAME_MAX + 1];
};
/* Find the place of a path. `named`: the user gave it, and means a link's target. False: errno has the reason. */
bool place_open(const char *path, bool named, struct place *place);
void place_close(struct place *place);
/* A file that is being made. It has no name until it is whole: the kernel then removes what a killed program was
   writing. Where a file system needs a name, it begins with ".sasbench-". */
struct made {
    int descriptor;
    char name[24]; /* empty: none */
};
/* Open an empty file for writing, in the place's folder. False: errno has the reason. */
bool place_make(const struct place *place, struct made *made);
/* Remove what killed programs left there under temporary names: what nobody locks, nor has written for an hour. */
void place_tidy(const struct place *place);
/* Give it a temporary name, for a library that needs one. False: errno has the reason. */
bool place_name(const struct place *place, struct made *made);
/* Give it its name, and close it. True: the name outlasts a power cut. */
bool place_put(const struct place *place, struct made *made);
/* Drop it, and keep errno. Accepts one that has its name, or was not made. */
void place_drop(const struct place *place, struct made *made);
/* Open a file for reading; in a folder that is taken, through no link. `flags`: more of them. -1: errno has the
   reason. */
int place_read(const char *path, int flags);
/* Is there a regular file, and no link? */
bool place_is_file(const char *path);
/* Remove a file, if it is there. */
void place_clear(const char *path);
/* Let its content outlast a power cut; true also where a file system cannot report it. */
bool place_sync(int descriptor);

#endif
