/* A scene file and all its includes as one text for libconfig. libconfig 1.5 itself finds includes in one folder
   only, ends the program on including a folder, and silently wraps integers beyond int. */
#define _GNU_SOURCE /* asprintf */
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "files/text_read.h"
#include "scene/text.h"

#define INCLUDE_DEPTH 10                /* also stops files that include themselves */
#define TEXT_MAX      ((size_t)1 << 26) /* bytes with all includes: a few files can include each other very often */

struct source {
    const char *path;
    int line, depth; /* the current line; depth of includes */
};

static enum status file_expand(struct scene_text *text, const char *path, const struct source *asked_by);

static void character_add(struct scene_text *text, char c)
{
    text->text[text->length++] = c;
    text->line += c == '\n';
}

/* Begin a line of text that comes from `source`. */
static enum status piece_begin(struct scene_text *text, const struct source *source)
{
    if (text->length > 0 && text->text[text->length - 1] != '\n') {
        character_add(text, '\n');
    }
    struct text_piece *longer = realloc(text->pieces, ((size_t)text->piece_count + 1) * sizeof *longer);
    char *path = strdup(source->path);
    if (longer) {
        text->pieces = longer;
    }
    if (!longer || !path) {
        free(path);
        return status_set(STATUS_FAILED, "%.300s: out of memory for the scene", source->path);
    }
    longer[text->piece_count++] = (struct text_piece){.path = path, .line = source->line, .first_line = text->line};
    return STATUS_OK;
}

static char *path_join(const char *folder, size_t folder_length, const char *name, size_t name_length)
{
    const bool separate = folder_length > 0 && folder[folder_length - 1] != '/';
    char *path;
    const int length =
        asprintf(&path, "%.*s%s%.*s", (int)folder_length, folder, separate ? "/" : "", (int)name_length, name);
    return length < 0 ? NULL : path;
}

/* The path of the file `name` in @include: absolute, beside `asked_by`, or shipped; NULL without memory. */
static char *path_find(const char *name, size_t length, const char *asked_by, const char *scene_directory)
{
    const char *slash = *name == '/' ? NULL : strrchr(asked_by, '/');
    char *beside = path_join(asked_by, slash ? (size_t)(slash + 1 - asked_by) : 0, name, length);
    if (*name == '/' || !beside || access(beside, F_OK) == 0) {
        return beside;
    }
    char *shipped = path_join(scene_directory, strlen(scene_directory), name, length);
    bool found = shipped && access(shipped, F_OK) == 0;
    free(found ? beside : shipped);
    return found ? shipped : beside;
}

/* Length of a piece of the file in a message. */
static int shown(size_t length)
{
    return length < 60 ? (int)length : 60;
}

/* `c` is at @include in `content`; *length becomes that of @include "FILE". */
static enum status include_expand(struct scene_text *text, const struct source *source, const char *content,
                                  const char *c, size_t *length)
{
    const char *before = c, *name = c + strlen("@include");
    while (before > content && (before[-1] == ' ' || before[-1] == '\t')) {
        before--;
    }
    name += strspn(name, " \t");
    bool quoted = *name++ == '"';
    size_t name_length = quoted ? strcspn(name, "\"\n") : 0;
    if (!quoted || name[name_length] != '"' || (before > content && before[-1] != '\n')) {
        return status_set(STATUS_INVALID,
                          "%.300s:%d: %.*s is misplaced, must be @include \"FILE\" at the beginning "
                          "of a line",
                          source->path, source->line, shown(strcspn(c, "\r\n")), c);
    }
    *length = (size_t)(name + name_length + 1 - c);
    if (source->depth == INCLUDE_DEPTH) {
        return status_set(STATUS_INVALID,
                          "%.300s:%d: @include of %.*s is nested too deep, must be at most %d files "
                          "deep, and no file may include itself",
                          source->path, source->line, shown(name_length), name, INCLUDE_DEPTH);
    }
    char *path = path_find(name, name_length, source->path, text->scene_directory);
    enum status status =
        path ? file_expand(text, path, source)
             : status_set(STATUS_FAILED, "%.300s:%d: out of memory for @include", source->path, source->line);
    free(path);
    return status == STATUS_OK ? piece_begin(text, source) : status;
}

/* `c` is at a number of `length` characters. */
static enum status number_check(const struct source *source, const char *c, size_t length)
{
    const char *digits = c + strspn(c, "+-");
    bool hexadecimal = digits[0] == '0' && (digits[1] == 'x' || digits[1] == 'X');
    char *end;
    errno = 0;
    long long value = strtoll(c, &end, hexadecimal ? 16 : 10);
    size_t suffix = strspn(end, "L");
    bool whole = end + suffix == c + length, fits = suffix > 0 || (value >= INT_MIN && value <= INT_MAX);
    if (whole && (errno == ERANGE || !fits)) {
        return status_set(STATUS_INVALID,
                          "%.300s:%d: %.*s is out of range, must be an integer from %d to %d; larger "
                          "numbers are written like 5e9 or, up to 2^63, 5000000000L",
                          source->path, source->line, shown(length), c, INT_MIN, INT_MAX);
    }
    return STATUS_OK;
}

static enum status not_closed(const struct source *source, const char *c, const char *end)
{
    return status_set(STATUS_INVALID, "%.300s:%d: %.*s is not closed, must end with %s", source->path, source->line,
                      shown(strcspn(c, "\r\n")), c, end);
}

static enum status content_expand(struct scene_text *text, struct source *source, const char *content)
{
    const char *word = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.*+-";
    enum status status = piece_begin(text, source);
    for (const char *c = content; *c && status == STATUS_OK;) {
        size_t length = strspn(c, word);
        if (*c == '#' || strncmp(c, "//", 2) == 0) {
            length = strcspn(c, "\n");
        } else if (strncmp(c, "/*", 2) == 0) {
            const char *end = strstr(c + 2, "*/");
            if (!end) {
                return not_closed(source, c, "*/ in its file");
            }
            length = (size_t)(end + 2 - c);
        } else if (*c == '"') {
            for (length = 1; c[length] && !strchr("\"\n", c[length]);) {
                length += c[length] == '\\' && c[length + 1] ? 2 : 1;
            }
            if (c[length++] != '"') {
                return not_closed(source, c, "\" on its line");
            }
        } else if (strncmp(c, "@include", 8) == 0) {
            length = 0;
            status = include_expand(text, source, content, c, &length);
            c += length;
            continue;
        } else if (length > 0 && strchr("+-0123456789", *c)) {
            status = number_check(source, c, length);
        } else if (length == 0) {
            length = 1;
        }
        for (const char *end = c + length; c < end; c++) {
            character_add(text, *c);
            source->line += *c == '\n';
        }
    }
    return status;
}

/* Make room for a file of `length` characters. */
static enum status room_make(struct scene_text *text, size_t length, const char *path)
{
    text->room += length + sizeof "\n\n"; /* a line's end before the file and one after it */
    if (text->room > TEXT_MAX) {
        return status_set(STATUS_INVALID,
                          "%.300s: the scene is too long with this file, must have at most %zu bytes "
                          "with all that it includes",
                          path, TEXT_MAX);
    }
    char *longer = realloc(text->text, text->room);
    if (!longer) {
        return status_set(STATUS_FAILED, "%.300s: out of memory for the scene", path);
    }
    text->text = longer;
    return STATUS_OK;
}

/* `asked_by` (NULL for the scene itself) is the file that includes this one. */
static enum status file_expand(struct scene_text *text, const char *path, const struct source *asked_by)
{
    char *content, reason[TEXT_REASON_SIZE];
    size_t length;
    enum status status = text_read(path, TEXT_MAX, &content, &length, reason);
    if (status != STATUS_OK && asked_by) {
        return status_set(status,
                          "%.300s:%d: @include of %.200s: %s; must be a readable file, its path "
                          "absolute, or from the folder of this file, or from %.200s",
                          asked_by->path, asked_by->line, path, reason, text->scene_directory);
    }
    if (status != STATUS_OK) {
        return status_set(status,
                          "%.300s: scene is not readable: %s; must be the path of a .cfg file, or "
                          "the name of a shipped scene without .cfg",
                          path, reason);
    }
    struct source source = {.path = path, .line = 1, .depth = asked_by ? asked_by->depth + 1 : 0};
    status = room_make(text, length, path);
    if (status == STATUS_OK) {
        status = content_expand(text, &source, content);
    }
    free(content);
    return status;
}

enum status scene_text_read(const char *path, const char *scene_directory, struct scene_text *text)
{
    *text = (struct scene_text){.scene_directory = scene_directory, .line = 1};
    enum status status = file_expand(text, path, NULL);
    if (status == STATUS_OK) {
        text->text[text->length] = '\0';
    } else {
        scene_text_free(text);
    }
    return status;
}

void scene_text_free(struct scene_text *text)
{
    for (int i = 0; i < text->piece_count; i++) {
        free(text->pieces[i].path);
    }
    free(text->pieces);
    free(text->text);
    *text = (struct scene_text){0};
}
