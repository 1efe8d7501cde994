/* The plans of a results folder: for each image of `auto` the chosen setting, why not others, and what is left out. */
#ifndef SASBENCH_ADVISE_PLANS_H
#define SASBENCH_ADVISE_PLANS_H

#include "choice/choice.h"
#include "scene/scene.h"

/* One image of `auto`. */
struct plans {
    const struct scene *scene;
    const struct spec *spec; /* as the user gave it */
    const struct choice *choice;
};

/* Write it into DIRECTORY/plans.csv, in place of older rows of the same image; rows of another program are removed.
   Errors: STATUS_INVALID for a file with other columns, or that cannot be written. */
enum status plans_keep(const char *directory, const struct plans *plans);

#endif
