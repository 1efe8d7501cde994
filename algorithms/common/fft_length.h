#ifndef SASBENCH_COMMON_FFT_LENGTH_H
#define SASBENCH_COMMON_FFT_LENGTH_H

/* The smallest length >= n whose prime factors FFTW handles best (2, 3, 5, 7); 0 when it exceeds INT_MAX. */
int fft_length(long long n);

/* The smallest length >= n whose odd part (of 3 and 5) is at most four times its power of two: seldom 10 % longer, up
   to three times faster where FFTW plans by estimate. 0 when it exceeds INT_MAX. */
int fft_length_fast(long long n);

/* The length of the quickest transform of n or more values, up to a quarter longer than the last: most often a power of
   two, or five times one. For work of transforms alone: all other work grows with the length. */
int fft_length_quick(long long n);

/* Seconds a FLOP of a transform of n, over those of a short power of two: 1 to 6, by its prime factors and its length.
   Measured where FFTW plans by estimate; for a single length it errs by up to a factor of 1.6. */
double fft_slowness(int n);

/* FLOPs of one complex transform, 5 n log2 n: the count that both papers and FFTW's own benchmark use. */
double fft_flops(double n);

/* The greatest common divisor of a >= 1 and b >= 0. */
int common_divisor(int a, int b);

#endif
