/* The vector of the instruction set that a file is being compiled for. */
#ifndef SASBENCH_COMMON_LANES_H
#define SASBENCH_COMMON_LANES_H

#include "common/real.h"

enum { LANES = VECTOR_BYTES / sizeof(real) };

/* Loaded and stored wherever it lies. */
typedef real vector_real __attribute__((vector_size(VECTOR_BYTES), aligned(sizeof(real)), may_alias));

/* Hold a loaded vector in its register: else the compiler loads it anew for each product, and loads are the limit. */
#if defined __x86_64__
#define HOLD(vector) __asm__("" : "+v"(vector))
#else
#define HOLD(vector) ((void)0)
#endif

/* Keep a pointer whole: else the compiler splits it into a base and an index and adds them for each load. */
#define OPAQUE(pointer) __asm__("" : "+r"(pointer))

#endif
