/* The plans of a results folder: for each image of `auto` what was chosen, why not others, and what is left out. */
#ifndef SASBENCH_ADVISE_PLANS_H
#define SASBENCH_ADVISE_PLANS_H

#include <stdio.h>

#include "measure/spec.h"
#include "scene/scene.h"

/* Between plans_listen and plans_keep. */
struct plans {
    const struct scene *scene; /* borrowed, like the SPEC */
    const struct spec *spec;
    FILE *stream; /* NULL: nothing was chosen yet */
    char *rows;
    size_t size;
};

/* Hear of the next choice of `auto`; nothing for another algorithm. */
void plans_listen(const struct scene *scene, const struct spec *spec, struct plans *plans);
/* Write what was heard into DIRECTORY/plans.csv, in place of older rows of the same image; those of another program go.
   Errors: STATUS_INVALID for a file that is none of ours or cannot be written. */
enum status plans_keep(const char *directory, struct plans *plans);

#endif
