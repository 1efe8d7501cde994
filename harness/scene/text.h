/* The text of a scene file with all its includes. Used within scene/ only. */
#ifndef SASBENCH_SCENE_TEXT_H
#define SASBENCH_SCENE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

#include "contract/status.h"

/* Lines of the text from `first_line` on; in the file `path` they begin at `line`. */
struct text_piece {
    char *path;
    int line, first_line;
};

/* A scene file with all includes in place, and the origin of each line. Freed with scene_text_free. */
struct scene_text {
    char *text;
    size_t length, room; /* bytes filled, allocated */
    int line;            /* the last one */
    int piece_count;
    struct text_piece *pieces;   /* [piece_count], in the order of the text */
    const char *scene_directory; /* of the shipped scenes */
};

/* Assemble the scene file at `path` and all its includes (search rules: scenes/README.md), and refuse text that
   libconfig would misread. Errors: STATUS_INVALID; nothing to free then. */
enum status scene_text_read(const char *path, const char *scene_directory, struct scene_text *text);
void scene_text_free(struct scene_text *text);

#endif
