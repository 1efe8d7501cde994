#include "planner/known.h"

#include "backprojection/coarse.h"

/* Images whose pixels miss less than this show all places alike; of others, errors are up to so much larger again. */
static const double COARSE_LEAST = 1.05, COARSE_MARGIN = 1.15;

void known_find(const struct problem *problem, struct known *known)
{
    const double coarse = coarse_factor(problem);
    *known = (struct known){.problem = *problem, .coarse = coarse < COARSE_LEAST ? 1 : coarse * COARSE_MARGIN};
    if (few_pixels_find(problem, &known->few))
        known->problem.few = &known->few;
    else if (known->coarse == 1 && scatter_find(problem, &known->scatter))
        known->problem.scatter = &known->scatter;
}

void known_free(struct known *known)
{
    few_pixels_free(&known->few);
}

enum status known_forecast(const struct known *known, const struct algorithm *algorithm, const void *options,
                           struct forecast *forecast)
{
    const enum status status = algorithm_forecast(algorithm, &known->problem, options, forecast);
    for (int cause = 0; cause < CAUSES && status == STATUS_OK; cause++)
        if (cause != CAUSE_SPECTRUM && !(cause == CAUSE_INTERPOLATION && known->problem.few)) /* of the pixels' own */
            forecast->error[cause] *= known->coarse;
    return status;
}
