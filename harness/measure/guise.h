/* The echoes of repeated runs in changing guises, so that an image kept from an earlier run is found. All algorithms
   image the echoes and the negated ones in turn. Between these, guests that are linear image them with a random half of
   the pings negated, and with the other half, drawn anew each time. */
#ifndef SASBENCH_MEASURE_GUISE_H
#define SASBENCH_MEASURE_GUISE_H

#include "contract/algorithm.h"

enum { GUISES = 4 }; /* plain, a half of the pings negated, all, the other half */

struct guise {
    const struct algorithm *algorithm;
    struct echoes *echoes;
    bool *half;                  /* [pings] which of them are negated first; NULL: all together */
    int *heard, count;           /* pings with samples that are not 0 */
    void *kept;                  /* a guest's samples, where there is room for a copy */
    size_t size;                 /* of them, bytes */
    int runs;                    /* so far */
    double complex sums[GUISES]; /* of the last image in each guise */
    bool known[GUISES];
};

/* The echoes are borrowed. Call guise_end in any case. */
struct guise guise_begin(const struct algorithm *algorithm, struct echoes *echoes);
/* Ahead of a run: fill the image with NaN, which a run must replace. */
void guise_spoil(const struct image *image);
/* After a run: hold its image against those before, and put on the next guise. Errors: STATUS_FAILED for an image of
   the negated echoes that is not the negated image, one of others that is the same, and changed samples. */
enum status guise_next(struct guise *guise, const struct image *image);
/* Is the last image that of the echoes, or the negated one? */
bool guise_plain(const struct guise *guise);
/* Restore the echoes, and their image if it is the negated one. Errors: STATUS_FAILED for changed samples. */
enum status guise_end(struct guise *guise, struct image *image);

#endif
