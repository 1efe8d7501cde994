/* The plans of a results folder: for each image of `auto` what was chosen, why not others, and what is left out. */
#ifndef SASBENCH_ADVISE_PLANS_H
#define SASBENCH_ADVISE_PLANS_H

#include "choice/choice.h"
#include "scene/scene.h"

/* One image of `auto`. */
struct plans {
    const struct scene *scene;
    const struct spec *spec; /* as it was asked for */
    const struct choice *choice;
};

/* Write it into DIRECTORY/plans.csv, in place of older rows of the same image; those of another program go. Errors:
   STATUS_INVALID for a file that is none of ours or cannot be written. */
enum status plans_keep(const char *directory, const struct plans *plans);

#endif
