/* Where the errors of an interpolator go. Its response depends on the fraction delta of a sample that is read,

       H(nu, delta) = sum over n of  c_n(nu) exp(j 2 pi n delta):

   beside the image, c_0, it makes others of the same echoes, whose pairs have the phase 2 pi n fs tau more. Those n
   that are not 0 add up elsewhere, where the delays of a target and of a pixel, which has another wavelength, differ
   alike from ping to ping; most of it may lie outside of a narrow image. */
#ifndef SASBENCH_BACKPROJECTION_SCATTER_H
#define SASBENCH_BACKPROJECTION_SCATTER_H

#include "contract/algorithm.h"

enum { SCATTER_ORDERS = 22 };

struct scatter {
    double share[SCATTER_ORDERS]; /* of some orders n: the energy inside the image over that of order 0, at most 1 */
    double most;                  /* of these */
};

/* Carries out some targets at single frequencies: those that are known, or some evenly over the image. Shares are
   planned with, above what is found. False where none are known: the beam is, or noise comes from all sides, or the
   image is so large that it would take long; then count all that is scattered. */
bool scatter_find(const struct problem *problem, struct scatter *scatter);

/* Of the order n >= 1; the greatest known where it is not among those that are found. */
double scatter_share(const struct scatter *scatter, int order);

#endif
