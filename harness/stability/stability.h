/* Extreme scenes x algorithms x precisions x rounding modes x threads: where images are right, and how many digits
   they lose. */
#ifndef SASBENCH_STABILITY_STABILITY_H
#define SASBENCH_STABILITY_STABILITY_H

#include "imaging/spec.h"

struct stability_request {
    int scene_count, spec_count;
    const char *const *scenes; /* names or paths; none: all of scenes/extreme, or with `quick` one of each family */
    const struct spec *specs;  /* none: every algorithm, with plain paths and engines as well */
    const char *directory;     /* for stability.csv, expected.csv and stability.png */
    bool quick;                /* two of the four rounding modes */
    const char *shard;         /* "3/8": these scenes alone; NULL: all */
};

/* Print the table, write the files, and compare with the expected verdicts and bounds in `expected`. Errors:
   STATUS_INVALID for a scene that cannot be found or a folder that cannot be written; STATUS_FAILED when a verdict
   or a bound differs from the expected one, or, without expected ones, when an image fails. */
enum status stability_run(const struct stability_request *request, const char *expected);

#endif
