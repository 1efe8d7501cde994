#include "tests/allocations.h"

#include <complex.h>
#include <fftw3.h>
#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

enum { MOST = 1 << 14 };

static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static bool counting;
static int calls, refuse_call = -1;
static struct allocations count;
static struct {
    const void *block;
    size_t size;
} held[MOST];

void allocations_begin(int refuse)
{
    count = (struct allocations){0};
    calls = 0;
    refuse_call = refuse;
    counting = true;
}

struct allocations allocations_now(void)
{
    return count;
}

struct allocations allocations_end(void)
{
    counting = false;
    return count;
}

/* Is this the call that gets NULL? */
static bool refused(void)
{
    if (!counting)
        return false;
    pthread_mutex_lock(&mutex);
    bool refuse = calls++ == refuse_call;
    count.refused += refuse;
    pthread_mutex_unlock(&mutex);
    return refuse;
}

static void *taken(void *block, size_t size)
{
    if (!counting || !block)
        return block;
    pthread_mutex_lock(&mutex);
    if (count.blocks < MOST) {
        held[count.blocks].block = block;
        held[count.blocks].size = size;
        count.blocks++;
        count.bytes += (double)size;
    }
    count.taken++;
    pthread_mutex_unlock(&mutex);
    return block;
}

static void freed(const void *block)
{
    if (!counting || !block)
        return;
    pthread_mutex_lock(&mutex);
    count.freed++;
    for (int k = 0; k < count.blocks; k++)
        if (held[k].block == block) {
            count.bytes -= (double)held[k].size;
            held[k] = held[--count.blocks];
            break;
        }
    pthread_mutex_unlock(&mutex);
}

#define TAKES(name, parameters, arguments, size)                                                                       \
    void *__real_##name parameters;                                                                                    \
    void *__wrap_##name parameters;                                                                                    \
    void *__wrap_##name parameters                                                                                     \
    {                                                                                                                  \
        return refused() ? NULL : taken(__real_##name arguments, size);                                                \
    }
#define FREES(name)                                                                                                    \
    void __real_##name(void *block);                                                                                   \
    void __wrap_##name(void *block);                                                                                   \
    void __wrap_##name(void *block)                                                                                    \
    {                                                                                                                  \
        freed(block);                                                                                                  \
        __real_##name(block);                                                                                          \
    }
TAKES(malloc, (size_t size), (size), size)
TAKES(calloc, (size_t n, size_t size), (n, size), n *size)
TAKES(aligned_alloc, (size_t alignment, size_t size), (alignment, size), size)
TAKES(strdup, (const char *text), (text), strlen(text) + 1)
FREES(free)
TAKES(memory_sparse, (size_t size, bool huge), (size, huge), size)
FREES(memory_sparse_free)

void *__real_realloc(void *block, size_t size);
void *__wrap_realloc(void *block, size_t size);
void *__wrap_realloc(void *block, size_t size)
{
    if (refused())
        return NULL;
    void *moved = __real_realloc(block, size);
    if (moved)
        freed(block);
    return taken(moved, size);
}

int __real_posix_memalign(void **block, size_t alignment, size_t size);
int __wrap_posix_memalign(void **block, size_t alignment, size_t size);
int __wrap_posix_memalign(void **block, size_t alignment, size_t size)
{
    int error = refused() ? 12 : __real_posix_memalign(block, alignment, size);
    if (!error)
        taken(*block, size);
    return error;
}

static void *planned(void *plan)
{
    if (counting) {
        pthread_mutex_lock(&mutex);
        count.plans += plan != NULL;
        pthread_mutex_unlock(&mutex);
    }
    return plan;
}

#define PLANS(X, name, parameters, arguments)                                                                          \
    X##_plan __real_##X##_plan_##name parameters;                                                                      \
    X##_plan __wrap_##X##_plan_##name parameters;                                                                      \
    X##_plan __wrap_##X##_plan_##name parameters                                                                       \
    {                                                                                                                  \
        return planned(__real_##X##_plan_##name arguments);                                                            \
    }
/* The planners of one kind; `signs` and `sign` are the last arguments of it ahead of the flags. */
#define KIND(X, kind, from, to, signs, sign)                                                                           \
    PLANS(X, kind##_1d, (int a, from *in, to *out, signs unsigned flags), (a, in, out, sign flags))                    \
    PLANS(X, kind##_2d, (int a, int b, from *in, to *out, signs unsigned flags), (a, b, in, out, sign flags))          \
    PLANS(X, kind##_3d, (int a, int b, int c, from *in, to *out, signs unsigned flags),                                \
          (a, b, c, in, out, sign flags))                                                                              \
    PLANS(X, kind, (int rank, const int *n, from *in, to *out, signs unsigned flags), (rank, n, in, out, sign flags))  \
    PLANS(X, many_##kind,                                                                                              \
          (int rank, const int *n, int many, from *in, const int *ie, int is, int id, to *out, const int *oe, int os,  \
           int od, signs unsigned flags),                                                                              \
          (rank, n, many, in, ie, is, id, out, oe, os, od, sign flags))                                                \
    PLANS(X, guru_##kind,                                                                                              \
          (int rank, const X##_iodim *n, int loops, const X##_iodim *loop, from *in, to *out, signs unsigned flags),   \
          (rank, n, loops, loop, in, out, sign flags))
#define COMMA ,
#define PRECISION(X, R)                                                                                                \
    TAKES(X##_malloc, (size_t size), (size), size)                                                                     \
    TAKES(X##_alloc_real, (size_t n), (n), n * sizeof(R))                                                              \
    TAKES(X##_alloc_complex, (size_t n), (n), n * sizeof(R complex))                                                   \
    FREES(X##_free)                                                                                                    \
    KIND(X, dft, X##_complex, X##_complex, int direction COMMA, direction COMMA)                                       \
    KIND(X, dft_r2c, R, X##_complex, , )                                                                               \
    KIND(X, dft_c2r, X##_complex, R, , )                                                                               \
    PLANS(X, r2r_1d, (int n, R *in, R *out, X##_r2r_kind kind, unsigned flags), (n, in, out, kind, flags))             \
    void __real_##X##_destroy_plan(X##_plan plan);                                                                     \
    void __wrap_##X##_destroy_plan(X##_plan plan);                                                                     \
    void __wrap_##X##_destroy_plan(X##_plan plan)                                                                      \
    {                                                                                                                  \
        count.plans_destroyed += counting && plan;                                                                     \
        __real_##X##_destroy_plan(plan);                                                                               \
    }
/* NOLINTBEGIN(readability-function-size): the parameters are those of FFTW. */
PRECISION(fftw, double)
PRECISION(fftwf, float)
/* NOLINTEND(readability-function-size) */
