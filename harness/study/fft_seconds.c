#include "study/fft_seconds.h"

#include <fftw3.h>
#include <math.h>
#include <string.h>

#include "algorithm.h"

enum { TRANSFORM_RUNS = 5 };

enum status fft_seconds(int rows, int columns, int threads, double *seconds)
{
    const size_t bytes = (size_t)rows * (size_t)columns * sizeof(fftwf_complex);
    fftwf_complex *data = fftwf_malloc(bytes);
    if (!data || !fftwf_init_threads()) {
        fftwf_free(data);
        return status_set(STATUS_FAILED, "no memory or no threads for a transform of %d x %d", rows, columns);
    }
    fftwf_plan_with_nthreads(threads);
    fftwf_plan forward = fftwf_plan_dft_2d(rows, columns, data, data, FFTW_FORWARD, FFTW_MEASURE);
    fftwf_plan inverse = fftwf_plan_dft_2d(rows, columns, data, data, FFTW_BACKWARD, FFTW_MEASURE);
    fftwf_plan_with_nthreads(1);
    memset(data, 0, bytes);
    *seconds = INFINITY;
    for (int k = 0; k < TRANSFORM_RUNS; k++) {
        double begin = seconds_now();
        fftwf_execute(forward);
        fftwf_execute(inverse);
        *seconds = fmin(*seconds, seconds_now() - begin);
    }
    fftwf_destroy_plan(forward);
    fftwf_destroy_plan(inverse);
    fftwf_free(data);
    return STATUS_OK;
}
