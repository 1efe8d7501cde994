/* The text of a scene file with all that it includes. Used within scene/ only. */
#ifndef SASBENCH_SCENE_TEXT_H
#define SASBENCH_SCENE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

#include "contract/status.h"

/* Lines of the text from `first_line` on, which are those of the file `path` from `line` on. */
struct text_piece {
    char *path;
    int line, first_line;
};

/* A scene file with all that it includes in place, and where each line is from. Freed with scene_text_free. */
struct scene_text {
    char *text;
    size_t length, room; /* bytes filled, allocated */
    int line;            /* the last one */
    int piece_count;
    struct text_piece *pieces;   /* [piece_count], in the order of the text */
    const char *scene_directory; /* of the shipped scenes */
};

/* Put the scene file at `path` and all that it includes (where includes are found: scenes/README.md) together, and
   refuse what libconfig would take wrongly. Errors: STATUS_INVALID; nothing to free then. */
enum status scene_text_read(const char *path, const char *scene_directory, struct scene_text *text);
void scene_text_free(struct scene_text *text);

#endif
