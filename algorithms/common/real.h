/* One source, two precisions: a file that includes this is compiled once with REAL_DOUBLE=0 and once with 1. */
#ifndef SASBENCH_COMMON_REAL_H
#define SASBENCH_COMMON_REAL_H

#include <complex.h>
#include <fftw3.h>

#if REAL_DOUBLE
typedef double real;
typedef double complex complex_real;
#define REAL_NAME(name) name##_double
#define FFTW(name)      fftw_##name
#else
typedef float real;
typedef float complex complex_real;
#define REAL_NAME(name) name##_float
#define FFTW(name)      fftwf_##name
#endif

/* Files that are also built for several instruction sets (BP_ISA): name_precision_isa. */
#define REAL_JOIN(name, isa)          name##_##isa
#define REAL_JOIN_EXPANDED(name, isa) REAL_JOIN(name, isa)
#define REAL_ISA_NAME(name)           REAL_JOIN_EXPANDED(REAL_NAME(name), BP_ISA)

/* The width of the vectors of the instruction set that a file is being compiled for. */
#if defined __AVX512F__
#define VECTOR_BYTES 64
#elif defined __AVX__
#define VECTOR_BYTES 32
#else
#define VECTOR_BYTES 16
#endif

#endif
