/* The width of the vectors of the instruction set that a file is being compiled for. */
#ifndef SASBENCH_COMMON_VECTOR_BYTES_H
#define SASBENCH_COMMON_VECTOR_BYTES_H

#if defined __AVX512F__
#define VECTOR_BYTES 64
#elif defined __AVX__
#define VECTOR_BYTES 32
#else
#define VECTOR_BYTES 16
#endif

#endif
