/* Chooses: plans every algorithm that has a forecast for the problem (planner/planner.h), and runs the fastest whose
   predicted error is within the budget. `auto` is a word of C, hence the file's name.

   Error: the chosen one's, predicted with a margin of 1.12. The choice is the same in float and in double, unless
   rounding is near the budget, and for any number of threads; it follows the rates of planner/rates.h. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "backprojection/bp.h"
#include "planner/planner.h"

struct options {
    double error, memory;
};

static const struct param params[] = {
    {PARAM(struct options, error), .summary = "relative L2 error of the image after one best complex gain, at most",
     .initial = 1e-3, .min = 1e-12, .max = 1, .sweep = "1e-1 1e-2 1e-3 1e-4 1e-5"},
    {PARAM(struct options, memory), .summary = "GB that the process may take, echoes and image among them",
     .initial = 4, .min = 1e-6, .max = 1e6, .terse = true},
    {.name = NULL},
};

struct automatic {
    const struct algorithm *algorithm; /* the chosen one */
    void *plan;
    char name[CANDIDATE_NAME];
    double error; /* predicted */
    int rejected;
};

static int conditions(const struct problem *problem, const void *method, const void *options, struct condition *list,
                      int room)
{
    (void)method, (void)options;
    return conditions_sampled(problem, list, room);
}

static double promise(const void *options)
{
    return ((const struct options *)options)->error;
}

static enum status nothing_fits(const struct options *options, const struct choice *choice)
{
    const struct candidate *best = NULL;
    char name[CANDIDATE_NAME];
    for (int k = 0; k < choice->count; k++)
        if (choice->list[k].error < INFINITY && choice->list[k].error == choice->least)
            best = &choice->list[k];
    if (!best)
        return status_set(STATUS_UNSUPPORTED, "auto: every candidate is refused; the first: %s",
                          choice->list[0].reason);
    candidate_name(best, name);
    return status_set(
        STATUS_UNSUPPORTED,
        "auto: condition budget: no candidate has an error of at most %.3g in %.3g GB; the least predicted "
        "is %.3g, of %s (cure: a larger error, or more memory)",
        options->error, options->memory, best->error, name);
}

static struct {
    void (*hear)(void *to, const struct problem *problem, const struct budget *budget, const struct choice *choice);
    void *to;
} listener;

void automatic_tell(void (*hear)(void *to, const struct problem *problem, const struct budget *budget,
                                 const struct choice *choice),
                    void *to)
{
    listener.hear = hear;
    listener.to = to;
}

static enum status plan(const struct problem *problem, const void *method, const void *options, void **plan)
{
    const struct options *o = options;
    const struct budget budget = {o->error, 1e9 * o->memory};
    struct choice choice;
    struct condition list[CONDITIONS_MAX];
    *plan = NULL;
    const int count = conditions(problem, method, options, list, CONDITIONS_MAX);
    enum status status = conditions_check("auto", list, count);
    if (status != STATUS_OK)
        return status;
    status = planner_choose(problem, &budget, &choice);
    if (status != STATUS_OK)
        return status;
    if (listener.hear)
        listener.hear(listener.to, problem, &budget, &choice);
    struct automatic *automatic = choice.found ? malloc(sizeof *automatic) : NULL;
    if (automatic) {
        *automatic = (struct automatic){.algorithm = choice.list[0].algorithm,
                                        .plan = choice.plan,
                                        .error = choice.list[0].error,
                                        .rejected = choice.count - 1};
        candidate_name(&choice.list[0], automatic->name);
        choice.plan = NULL;
        *plan = automatic;
    } else
        status = choice.found ? status_set(STATUS_FAILED, "auto: no memory for the plan") : nothing_fits(o, &choice);
    choice_free(&choice);
    return status;
}

static enum status execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    const struct automatic *automatic = plan;
    return automatic->algorithm->execute(automatic->plan, echoes, image, stages);
}

static struct work work(const void *plan)
{
    const struct automatic *automatic = plan;
    struct work work = automatic->algorithm->work(automatic->plan);
    char skipped[sizeof work.skipped];
    snprintf(skipped, sizeof skipped, "%s", work.skipped);
    snprintf(work.engine, sizeof work.engine, "%s", automatic->name);
    snprintf(work.skipped, sizeof work.skipped, "%d other settings: an error of %.2g is predicted%s%.180s",
             automatic->rejected, automatic->error, *skipped ? "; " : "", skipped);
    work.bytes += sizeof *automatic;
    return work;
}

static void destroy(void *plan)
{
    struct automatic *automatic = plan;
    if (!automatic)
        return;
    automatic->algorithm->destroy(automatic->plan);
    free(automatic);
}

const struct algorithm automatic = {
    .name = "auto",
    .summary = "the fastest of all whose predicted error is within a budget",
    .reference = "this project; error laws in docs/error_laws.md",
    .traits = TRAIT_ANY_TRACK | TRAIT_APERTURE_LIMIT,
    .options_size = sizeof(struct options),
    .params = params,
    .conditions = conditions,
    .promise = promise,
    .plan = plan,
    .execute = execute,
    .work = work,
    .destroy = destroy,
};
