#include "backprojection/known.h"

void known_find(struct problem *problem, struct known *known)
{
    *known = (struct known){.few = {.pixels = 0}};
    problem->few = few_pixels_find(problem, &known->few) ? &known->few : NULL;
    problem->scatter = !problem->few && scatter_find(problem, &known->scatter) ? &known->scatter : NULL;
}

void known_free(struct known *known)
{
    few_pixels_free(&known->few);
}
