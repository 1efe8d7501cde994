/* What is found out of a problem once, for all forecasts of it. */
#ifndef SASBENCH_PLANNER_KNOWN_H
#define SASBENCH_PLANNER_KNOWN_H

#include "backprojection/few_pixels.h"
#include "backprojection/scatter.h"

struct known {
    struct problem problem; /* with `few` or `scatter`, of this struct, which it must not outlive */
    struct few_pixels few;
    struct scatter scatter;
    double coarse; /* by how much errors are larger beside what coarse pixels show (backprojection/coarse.h) */
};

/* Carries out few pixels, or some targets of many. Takes up to half a second. *known must not be moved. */
void known_find(const struct problem *problem, struct known *known);
void known_free(struct known *known);

/* The forecast of an algorithm, which has one, by what is known. Errors: the algorithm's. */
enum status known_forecast(const struct known *known, const struct algorithm *algorithm, const void *options,
                           struct forecast *forecast);

#endif
