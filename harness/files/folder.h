/* A folder of results, which belongs to one program at a time, and the places of files. */
#ifndef SASBENCH_FILES_FOLDER_H
#define SASBENCH_FILES_FOLDER_H

#include <limits.h>
#include <stdbool.h>

#include "contract/status.h"

/* Make a folder and those above it, like mkdir -p; one that exists is fine. Errors: STATUS_INVALID naming it. */
enum status directory_make(const char *directory);

/* Take a folder that exists. The lock is the kernel's: it
   goes with the process, whatever ends it, and leaves no file. A second program does not wait: it is refused at once.
   Until folder_leave, every path that begins with the folder's name leads into this very folder, whatever is put in
   its place, and through no link. Errors: STATUS_INVALID when another program works there, for what is no folder, and
   for one that another user owns or that all users share. */
enum status folder_take(const char *directory, int *lock);
/* The folder that a single file is written into, so that no second program writes the same one. What is no regular file
   needs no lock, *lock is -1 then. Errors: as folder_take. */
enum status folder_take_around(const char *path, int *lock);
/* Accepts -1. */
void folder_leave(int lock);

/* Where a file is made: its name in a folder that is held open. What has that name already is replaced, also where it
   is a link. */
struct place {
    int folder;
    bool borrowed; /* of a folder that is taken */
    char name[NAME_MAX + 1];
};
/* The place of a path. `named`: by the user, who means what a link stands for. False: errno says why. */
bool place_open(const char *path, bool named, struct place *place);
void place_close(struct place *place);
/* A file on its way to its place. It has no name there until it is whole: what a killed program was writing, the kernel
   removes. Where a file system knows no files without names it has one that begins with ".sasbench-". */
struct made {
    int descriptor;
    char name[24]; /* empty: none */
};
/* An empty file, open for writing, in the place's folder. False: errno says why. */
bool place_make(const struct place *place, struct made *made);
/* Let it have such a name, for a library that takes no file without one. False: errno says why. */
bool place_name(const struct place *place, struct made *made);
/* Give it its name, which outlasts a power cut when this is true, and close it. */
bool place_put(const struct place *place, struct made *made);
/* Drop it; errno stays. Accepts one that is put, or was not made. */
void place_drop(const struct place *place, struct made *made);
/* Open a file for reading: in a folder that is taken through no link. `flags`: more of them. -1: errno says why. */
int place_read(const char *path, int flags);
/* Whether a regular file is there, and no link. */
bool place_is_file(const char *path);
/* Remove a file, if it is there. */
void place_clear(const char *path);
/* Its content outlasts a power cut; true also where a file system cannot tell. */
bool place_sync(int descriptor);

#endif
