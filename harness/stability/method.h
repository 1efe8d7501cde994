/* The promise of each method: how it reads records, its largest error against the right image, and the deliberate
   approximations of its engine. */
#ifndef SASBENCH_STABILITY_METHOD_H
#define SASBENCH_STABILITY_METHOD_H

#include "imaging/spec.h"
#include "stability/exact_image.h"

struct method {
    bool has_reading; /* extended precision can do the `reading`: back projection */
    struct exact_reading reading;
    double error_most; /* relative L2 error of a right image: the method's error law with room for extreme scenes */
    double phase_rad;  /* deliberate change of a pair's phase by the engine: interpolated delays, short polynomials */
    double weight;     /* and of a sample's weight: tabulated kernels */
};

/* `engine` is the plan's text (struct work). A method without an error law of its own has no reading, and the widest
   error. */
struct method method_of(const struct spec *spec, const char *engine, const struct problem *problem);

#endif
