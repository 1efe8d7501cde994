/* Large arrays that are not read again soon, written past the caches: a line that is written whole is then not read
   first. Without such stores in the processor these are plain ones. */
#ifndef SASBENCH_COMMON_STREAM_H
#define SASBENCH_COMMON_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

enum { STREAM_BYTES = 16 }; /* of one store; arrays written begin at a multiple of it */

/* Is an array too large to stay in the caches until it is read again? */
static inline bool stream_pays(double bytes)
{
    return bytes > 16e6;
}

/* STREAM_BYTES, the first half from one place and the second from another. */
static inline void stream_halves(void *to, const void *first, const void *second)
{
#ifdef __SSE2__
    const __m128d low = _mm_load_sd(first);
    _mm_stream_pd(to, _mm_loadh_pd(low, second));
#else
    memcpy(to, first, STREAM_BYTES / 2);
    memcpy((char *)to + STREAM_BYTES / 2, second, STREAM_BYTES / 2);
#endif
}

static inline void stream_copy(void *to, const void *from, size_t bytes)
{
    size_t at = 0;
#ifdef __SSE2__
    if ((uintptr_t)to % STREAM_BYTES == 0)
        for (; at + STREAM_BYTES <= bytes; at += STREAM_BYTES)
            _mm_stream_si128((void *)((char *)to + at), _mm_loadu_si128((const void *)((const char *)from + at)));
#endif
    memcpy((char *)to + at, (const char *)from + at, bytes - at);
}

/* Before another thread may read the array. */
static inline void stream_end(void)
{
#ifdef __SSE2__
    _mm_sfence();
#endif
}

#endif
