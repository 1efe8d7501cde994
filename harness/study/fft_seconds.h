/* FFTW's own time: what whole algorithms are measured in. */
#ifndef SASBENCH_STUDY_FFT_SECONDS_H
#define SASBENCH_STUDY_FFT_SECONDS_H

#include "status.h"

/* One forward and one inverse transform of rows x columns in place, float, planned by measurement, best of five. Errors:
   STATUS_FAILED without memory or threads. */
enum status fft_seconds(int rows, int columns, int threads, double *seconds);

#endif
