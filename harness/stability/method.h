/* What each method promises: how it reads records, the error it may make against the right image, and what its engine
   changes on purpose. */
#ifndef SASBENCH_STABILITY_METHOD_H
#define SASBENCH_STABILITY_METHOD_H

#include "imaging/spec.h"
#include "stability/exact_image.h"

struct method {
    bool has_reading; /* `reading` can be done in extended precision: back projection */
    struct exact_reading reading;
    double error_most; /* relative L2 error of a right image: the method's error law with room for extreme scenes */
    double phase_rad;  /* what the engine changes the phase of a pair by on purpose: interpolated delays, short
                          polynomials */
    double weight;     /* and the weight of a sample: tabulated kernels */
};

/* `engine` is what the plan says of itself (struct work). A method that is not known has no reading, and the widest
 * error. */
struct method method_of(const struct spec *spec, const char *engine, const struct problem *problem);

#endif
