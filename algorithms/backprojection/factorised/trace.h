/* A straight line through a subaperture's image, resampled as a record from its centre for the general engine's sums
   (general/sum.h). trace.c is built for each precision and instruction set. */
#ifndef SASBENCH_BACKPROJECTION_FACTORISED_TRACE_H
#define SASBENCH_BACKPROJECTION_FACTORISED_TRACE_H

#include "common/isa.h"
#include "backprojection/factorised/tree.h"
#include "backprojection/general/sum.h"

enum { TRACE_PLACES = 256 }; /* made at a time */

struct polar_image {
    const void *values; /* real [lines][re, im][pitch] */
    size_t pitch;
    int line_first, lines, place_first, places;
    double rho, sine; /* steps */
    const struct polar_taps *range, *angle;
};

/* A straight line, `offset` m beside the centre: (along, offset) in axes turned by the angle of the sine `sine` and the
   cosine `cosine` to the image's. */
struct polar_crossing {
    double offset, sine, cosine;
};

/* Fill `row`, of `layout`, with the Farrow branches (of range->branches) of samples [first, first + count) of the image
   along the line: sample j at rho = j step. `trace`: real [2][trace_pitch], scratch for count + taps - 1 values and a
   whole vector. The samples' places, with half the taps to either side, lie in the image. Returns how many lie beside
   its lines and read zero: none in a correct tree. */
typedef int polar_trace_function(const struct polar_image *image, const struct polar_crossing *line, int first,
                                 int count, void *trace, size_t trace_pitch, const struct bp_layout *layout, void *row);
ISA_DECLARE(polar_trace_function, polar_trace);

#endif
