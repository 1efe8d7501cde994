/* Shared by the files with Fourier transforms (for each precision). */
#ifndef SASBENCH_COMMON_FFT_H
#define SASBENCH_COMMON_FFT_H

#include <math.h>

#include "common/memory.h"
#include "common/real.h"

static inline void fft_destroy(void *plan)
{
    FFTW(destroy_plan)(plan);
}

/* Into another array, which saves FFTW copies of its own, or in place. ESTIMATE: the same algorithm, hence the same
   bits, at every planning. */
static inline void *fft_line(struct store *store, int length, complex_real *from, complex_real *to, int sign)
{
    return store_keep(store, FFTW(plan_dft_1d)(length, from, to, sign, FFTW_ESTIMATE), fft_destroy);
}

/* The same of `width` lines side by side. */
static inline void *fft_strip(struct store *store, int length, int width, complex_real *from, complex_real *to,
                              int sign)
{
    return store_keep(
        store, FFTW(plan_many_dft)(1, &length, width, from, NULL, width, 1, to, NULL, width, 1, sign, FFTW_ESTIMATE),
        fft_destroy);
}

static inline complex_real rotor(double cycles)
{
    double angle = 2 * M_PI * (cycles - floor(cycles + 0.5));
    return (real)cos(angle) + (real)sin(angle) * (complex_real)I;
}

#endif
