/* Records for back projection: range compressed, optionally upsampled by zero padding, with guard samples. */
#ifndef SASBENCH_BACKPROJECTION_TRACES_H
#define SASBENCH_BACKPROJECTION_TRACES_H

#include "contract/algorithm.h"

struct traces; /* the plan */

/* How a record is read. Raw echoes are correlated linearly with conj(pulse)/sum|pulse|^2 (BP22 Eq. (4), inverse
   transform along range). upsample > 1 evaluates the band-limited signal exactly (ZP15: zero padding of the spectrum,
   the bin at fs/2 shared between both ends). */
struct traces_form {
    int upsample;     /* >= 1 */
    int degree;       /* > 0: of Farrow branches (farrow.h), u in upsampled samples */
    int guard;        /* upsampled samples before and behind the record */
    bool preemphasis; /* the spectrum is divided by sinc^2(f/fs), the loss of linear interpolation */
    int first, count; /* the samples [first, first + count) that a row holds; count 0: all */
    double band;      /* > 0: compressed echoes hold nothing but |f| < band fs/2: a part of the record is enough for
                         values between samples; 0: they depend on all of it */
};

/* A row holds guard + (samples - 1) upsample + 1 + guard values; value guard + i lies at sample coordinate first +
   i/upsample of the record, t = t0 + (first + i/upsample)/fs. Guards continue the band-limited signal, periodically
   where it has no other continuation; with upsample = 1 or branches they read zero. With a degree > 0 a row holds
   degree + 1 of these one behind the other, the branches: the first two from transforms, the others from their
   neighbours (farrow.h).

   If a row holds part of the record and its values depend on a stretch of it only, only that stretch is read. Raw
   echoes that are only compressed read a pulse's length behind the row's samples. The transform is shorter, and the
   values are the same but for rounding. Values between the samples (upsample > 1, degree > 0) or with preemphasis
   depend on the whole record, which is transformed as one.

   With a `band`, values between samples are made of the row's samples and some beside them, over which the record
   fades to zero: by the running sum of a Kaiser window, whose spectrum ends at (1 - band) fs/2, so that nothing in the
   band is aliased. Raw echoes, whose flanks beyond any band reach far from a bright echo, are read as a whole; so are
   records of which a part is no shorter, and with preemphasis.

   Zero padding is done by phases: values i = n upsample + phase are the samples n of the signal phase/upsample samples
   earlier, hence an inverse transform of the record's own length L, of its spectrum times exp(j 2 pi nu
   phase/upsample). `upsample` short transforms replace one long one, and each is made for itself. */
struct traces_shape {
    int first, samples; /* of the record, in a row */
    int upsample, guard;
    int branches;   /* 1, or degree + 1 */
    int length;     /* of a row's branch, complex values */
    int from, read; /* the record's samples [from, from + read) are read; of compressed echoes periodically */
    int period;     /* L: of the transformed signal, >= samples + pulse - 1 if raw; its sample 0 is `from` */
    size_t pitch;   /* from one spectrum or plane to the next, complex values: whole cache lines; 0: none is made */
    double flops;   /* for one record: 5 N log2 N an FFT, 6 a complex product, 2 a real one */
    double bytes;   /* memory with one thread */
};

/* The functions of each precision, that of records and rows. */
struct traces_build {
    /* `period` of the shape without a plan; 0 where it is too long. */
    int (*period)(const struct acquisition *acquisition, const struct traces_form *form);
    /* `flops` of the shape without a plan, in two parts: of transforms and products, and *sums over neighbours. */
    double (*flops)(const struct acquisition *acquisition, const struct traces_form *form, double *sums);
    /* `threads`: number of threads that may call fill at the same time. Errors: STATUS_FAILED without memory,
       STATUS_UNSUPPORTED when a row is too long to index. *traces is NULL then. */
    enum status (*plan)(const struct acquisition *acquisition, const struct traces_form *form, int threads,
                        struct traces_shape *shape, struct traces **traces);
    /* Turn one record, complex [the acquisition's samples], into a row; `thread` < threads names the scratch to use. */
    void (*fill)(const struct traces *traces, int thread, const void *record, void *row);
    /* The same in two steps, where pitch > 0: a record's spectrum, complex [period], compressed; and from it one plane,
       number branch times upsample + phase, branch < 2: complex [period], of which value n is fine sample (from + n)
       upsample + phase. Both arrays begin at cache lines; the spectrum is not changed. */
    void (*spectrum)(const struct traces *traces, int thread, const void *record, void *spectrum);
    void (*plane)(const struct traces *traces, int thread, void *spectrum, int plane, void *values);
    void (*destroy)(void *traces);
};
extern const struct traces_build traces_float, traces_double;

static inline const struct traces_build *traces_of(enum precision precision)
{
    return precision == PRECISION_DOUBLE ? &traces_double : &traces_float;
}

#endif
