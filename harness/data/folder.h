/* A folder of results, which belongs to one program at a time. */
#ifndef SASBENCH_DATA_FOLDER_H
#define SASBENCH_DATA_FOLDER_H

#include "status.h"

/* Make a folder and those above it, like mkdir -p; one that exists is fine. Errors: STATUS_INVALID naming it. */
enum status directory_make(const char *directory);

/* Take a folder that exists, and sweep away what a killed program left on its way there. The lock is the kernel's: it
   goes with the process, whatever ends it, and leaves no file. A second program does not wait: it is refused at once.
   Errors: STATUS_INVALID when another program works there, or for what is no folder. */
enum status folder_take(const char *directory, int *lock);
/* The folder that a single file is written into, so that no second program writes the same one. Nothing is swept away:
   what else lies there is not ours alone. What is no regular file needs no lock, *lock is -1 then. Errors: as
   folder_take. */
enum status folder_take_around(const char *path, int *lock);
/* Accepts -1. */
void folder_leave(int lock);

#endif
