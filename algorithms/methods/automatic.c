/* The name and the settings of a choice that the harness makes with the echoes at hand, ahead of an ordinary plan
   (harness/choice/choice.h). `auto` is a word of C, hence the file's name. */
#include "automatic.h"

static const struct param params[] = {
    {PARAM(struct automatic_options, error),
     .summary = "relative L2 error of the image after one best complex gain, at most", .initial = 1e-3, .min = 1e-12,
     .max = 1, .sweep = "1e-1 1e-2 1e-3 1e-4 1e-5"},
    {PARAM(struct automatic_options, memory), .summary = "GB that the process may take, echoes and image among them",
     .initial = 4, .min = 1e-6, .max = 1e6, .terse = true},
    {.name = NULL},
};

static int conditions(const struct problem *problem, const void *method, const void *options, struct condition *list,
                      int room)
{
    (void)method;
    (void)options;
    return conditions_sampled(problem, list, room);
}

static double promise(const void *options)
{
    return ((const struct automatic_options *)options)->error;
}

const struct algorithm automatic = {
    .name = "auto",
    .summary = "the fastest of all whose error, measured on some pixels, is within a budget",
    .reference = "this project; docs/planning.md",
    .traits = TRAIT_ANY_TRACK | TRAIT_APERTURE_LIMIT,
    .options_size = sizeof(struct automatic_options),
    .params = params,
    .conditions = conditions,
    .promise = promise,
};
