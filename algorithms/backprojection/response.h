/* An interpolator's response: its value for the signal exp(j 2 pi nu q) at the fraction delta of a sample, over the
   exact value,

       H(nu, delta) = sum over k of  h_k(delta) exp(j 2 pi nu (k - delta)). */
#ifndef SASBENCH_BACKPROJECTION_RESPONSE_H
#define SASBENCH_BACKPROJECTION_RESPONSE_H

#include "backprojection/bp.h"
#include "backprojection/farrow.h"
#include "backprojection/law_spectrum.h"

struct response {
    const struct interpolator *in;
    const struct law_spectrum *spectrum;
    double gains[LAW_NODES][FARROW_MOST + 1]; /* of branches */
    double *taps;                             /* [in->taps] */
};

/* The arguments must outlive it. False without memory; then there is nothing to free. */
bool response_begin(const struct interpolator *interpolator, const struct law_spectrum *spectrum,
                    struct response *response);
/* H at each frequency of the spectrum, list [spectrum->count]; the fraction, 0 to 1, is of upsampled samples. */
void response_at(struct response *response, double fraction, double complex *list);
void response_end(struct response *response);

#endif
