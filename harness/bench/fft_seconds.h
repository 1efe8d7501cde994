/* FFTW's own time, the unit for the times of whole algorithms. */
#ifndef SASBENCH_BENCH_FFT_SECONDS_H
#define SASBENCH_BENCH_FFT_SECONDS_H

#include "contract/status.h"

/* s, best of five. Which is faster depends on the machine's caches. */
struct fft_seconds {
    double plan;   /* by one two-dimensional plan */
    double strips; /* rows by themselves, columns by strips that are copied to and fro */
    double best;   /* the smaller of both */
};

/* One forward and one inverse transform of rows x columns in place, float, planned by measurement. Errors:
   STATUS_FAILED without memory or threads. */
enum status fft_seconds(int rows, int columns, int threads, struct fft_seconds *seconds);

#endif
