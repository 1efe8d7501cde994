/* Reading a text file whole (text_read.h). */
#include "files/text_read.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "files/folder.h"

static enum status reason_set(char *reason, enum status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static enum status reason_set(char *reason, enum status status, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(reason, TEXT_REASON_SIZE, format, arguments);
    va_end(arguments);
    return status;
}

/* No more than the file's size, so that one that grows has an end. The kernel's own files have size 0. */
static enum status descriptor_read(int descriptor, size_t most, char **text, size_t *length, char *reason)
{
    struct stat info;
    if (fstat(descriptor, &info) != 0 || !S_ISREG(info.st_mode)) {
        return reason_set(reason, STATUS_INVALID, "not a regular file");
    }
    const size_t size = (size_t)info.st_size;
    if (size > most) {
        return reason_set(reason, STATUS_INVALID, "has %zu bytes, must have at most %zu", size, most);
    }
    if (!(*text = malloc(size + 1))) {
        return reason_set(reason, STATUS_FAILED, "no memory for %zu bytes", size);
    }
    ssize_t count = 1;
    for (*length = 0; *length < size && count > 0; *length += count > 0 ? (size_t)count : 0) {
        count = read(descriptor, *text + *length, size - *length);
    }
    if (size == 0) {
        count = read(descriptor, *text, 1);
    }
    if (count < 0) {
        return reason_set(reason, STATUS_INVALID, "cannot be read: %s", strerror(errno));
    }
    if (count > 0 && size == 0) {
        return reason_set(reason, STATUS_INVALID, "not a file of a disk");
    }
    (*text)[*length] = '\0';
    const size_t zero = strlen(*text);
    return zero == *length ? STATUS_OK
                           : reason_set(reason, STATUS_INVALID, "holds a zero byte at offset %zu, must be text", zero);
}

enum status text_read(const char *path, size_t most, char **text, size_t *length, char reason[TEXT_REASON_SIZE])
{
    struct stat info;
    *text = NULL;
    *length = 0;
    if (lstat(path, &info) == 0 && !S_ISREG(info.st_mode) && !S_ISLNK(info.st_mode)) { /* devices may act when opened */
        return reason_set(reason, STATUS_INVALID, "not a regular file");
    }
    const int descriptor = place_read(path, O_NONBLOCK | O_NOCTTY);
    if (descriptor < 0) {
        return reason_set(reason, STATUS_INVALID, "%s",
                          errno == ELOOP ? "a symbolic link, which is not followed" : strerror(errno));
    }
    const enum status status = descriptor_read(descriptor, most, text, length, reason);
    close(descriptor);
    if (status != STATUS_OK) {
        free(*text);
        *text = NULL;
    }
    return status;
}
