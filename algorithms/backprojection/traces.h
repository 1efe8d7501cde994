/* Records as back projection reads them: range compressed, upsampled by zero padding if asked, with guard samples. */
#ifndef SASBENCH_BACKPROJECTION_TRACES_H
#define SASBENCH_BACKPROJECTION_TRACES_H

#include "algorithm.h"

struct traces; /* the plan */

/* A row holds guard + (samples - 1) upsample + 1 + guard values; value guard + i lies at sample coordinate i/upsample
   of the record, t = t0 + i/(upsample fs). Raw echoes are correlated linearly with conj(pulse)/sum|pulse|^2 (BP22 Eq.
   (4), inverse transform along range). upsample > 1 evaluates the band-limited signal exactly (ZP15: zero padding of
   the spectrum, the bin at fs/2 shared between both ends) and continues it into the guards, periodically where it has
   no other continuation; with upsample = 1 the guards read zero. With a degree > 0 a row holds degree + 1 of these
   one behind the other: the Farrow branches of the band-limited signal (farrow.h), u in upsampled samples. */
struct traces_shape {
    int samples, upsample, guard;
    int branches; /* 1, or degree + 1 */
    int length;   /* of a row's branch, complex values */
    double flops; /* for one record: 5 N log2 N an FFT, 6 a complex product */
    double bytes; /* held with one thread */
};

/* `threads`: how many threads may call fill at once; `degree`: 0, or of Farrow branches. Errors: STATUS_FAILED
   without memory, STATUS_UNSUPPORTED when a row is too long to index. *traces is NULL then. */
enum status traces_plan_float(const struct acquisition *acquisition, int upsample, int degree, int guard, int threads,
                              struct traces_shape *shape, struct traces **traces);
enum status traces_plan_double(const struct acquisition *acquisition, int upsample, int degree, int guard, int threads,
                               struct traces_shape *shape, struct traces **traces);
/* Turn one record, complex [samples], into a row; `thread` < threads names the scratch to use. */
void traces_fill_float(const struct traces *traces, int thread, const float complex *record, float complex *row);
void traces_fill_double(const struct traces *traces, int thread, const double complex *record, double complex *row);
void traces_destroy_float(struct traces *traces);
void traces_destroy_double(struct traces *traces);

#endif
