/* A text file that is whole or not there. */
#ifndef SASBENCH_DATA_TEXT_FILE_H
#define SASBENCH_DATA_TEXT_FILE_H

#include <stdio.h>

#include "status.h"

struct text_file {
    FILE *stream;        /* write here */
    char *path, *beside; /* beside NULL: what is at `path` is no regular file, or a standard stream, and is
                                       written to as it is */
};

/* The path itself, or what a symbolic link stands for; the link stays. Freed by the caller; NULL: errno says why. */
char *place_follow(const char *path);

/* Begin a file beside `path`. Errors: STATUS_INVALID naming it when it cannot be written; nothing is then left to
   close. */
enum status text_file_open(const char *path, struct text_file *file);
/* Put the file in its place when `status` is OK, and drop it otherwise. Returns `status`, or STATUS_FAILED when it
   could not be written to its end. */
enum status text_file_close(struct text_file *file, enum status status);

#endif
