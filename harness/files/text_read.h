/* A text file in memory. */
#ifndef SASBENCH_FILES_TEXT_READ_H
#define SASBENCH_FILES_TEXT_READ_H

#include <stddef.h>

#include "contract/status.h"

enum { TEXT_REASON_SIZE = 160 };

/* Read the whole regular file at `path`, of at most `most` bytes: *text, the caller's to free, ends with a zero byte
   that *length does not count. It reads nothing else, and never waits: not for the writer of a pipe, not for the
   kernel's log. Errors, with the cause in `reason`: STATUS_INVALID, or STATUS_FAILED without memory. */
enum status text_read(const char *path, size_t most, char **text, size_t *length, char reason[TEXT_REASON_SIZE]);

#endif
