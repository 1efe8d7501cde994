/* A text file that is whole or not there. */
#ifndef SASBENCH_FILES_TEXT_FILE_H
#define SASBENCH_FILES_TEXT_FILE_H

#include <stdio.h>

#include "files/folder.h"
#include "contract/status.h"

struct text_file {
    FILE *stream; /* write here */
    char *path;
    struct place place;
    struct made made; /* none where `path` is no regular file, or a standard stream: these are written directly */
};

/* Begin a file for `path`, where it replaces what has that name: a link is not followed. Errors: STATUS_INVALID naming
   it when it cannot be written, STATUS_FAILED on a full disk; nothing to close then. */
enum status text_file_open(const char *path, struct text_file *file);
enum status text_file_in(const char *directory, const char *name, struct text_file *file);
/* The same for a path that the user gave: a link stays, and its target is replaced; what is no regular file is written
   directly. */
enum status text_file_open_named(const char *path, struct text_file *file);
/* Put the file in its place when `status` is OK, and drop it otherwise. Returns `status`, or STATUS_FAILED when it
   could not be written to its end. */
enum status text_file_close(struct text_file *file, enum status status);
/* The same, but its stream goes on at the end of the file in its place; NULL on failure. */
enum status text_file_keep(struct text_file *file, FILE **stream);

/* Has everything written to a stream, now and before, left it? If not, errno has the reason. stream_close: close it. */
bool stream_flush(FILE *stream);
bool stream_close(FILE *stream);

#endif
