/* What error laws of interpolators find out of a problem once, for all forecasts of it. */
#ifndef SASBENCH_BACKPROJECTION_KNOWN_H
#define SASBENCH_BACKPROJECTION_KNOWN_H

#include "backprojection/few_pixels.h"
#include "backprojection/scatter.h"

struct known {
    struct few_pixels few;
    struct scatter scatter;
};

/* Carries out few pixels, else some targets of many, and points the problem's `few` or `scatter` into *known, which must
   outlive it. Takes up to half a second. */
void known_find(struct problem *problem, struct known *known);
void known_free(struct known *known);

#endif
