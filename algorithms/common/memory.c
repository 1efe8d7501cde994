#include "common/memory.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

enum { LINE = 64 /* bytes of the cache's */ };

/* Available memory and swap, by Linux's own estimate; INFINITY without one. */
static double machine_free(void)
{
    double free_bytes = 0, kilobytes;
    char line[128];
    FILE *file = fopen("/proc/meminfo", "r");
    while (file && fgets(line, sizeof line, file))
        if (sscanf(line, "MemAvailable: %lf", &kilobytes) == 1 || sscanf(line, "SwapFree: %lf", &kilobytes) == 1)
            free_bytes += 1024 * kilobytes;
    if (file)
        fclose(file);
    return free_bytes > 0 ? free_bytes : INFINITY;
}

/* The rest within the limit on the process's address space. */
static double limit_free(void)
{
    struct rlimit limit;
    double pages;
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
        return INFINITY;
    FILE *file = fopen("/proc/self/statm", "r");
    bool known = file && fscanf(file, "%lf", &pages) == 1;
    if (file)
        fclose(file);
    return fmax(0, (double)limit.rlim_cur - (known ? pages * (double)sysconf(_SC_PAGESIZE) : 0));
}

enum status memory_check(double bytes, const char *what)
{
    if (bytes < 0x1p26)
        return STATUS_OK;
    double free_bytes = fmin(machine_free(), limit_free());
    if (bytes <= free_bytes)
        return STATUS_OK;
    return status_set(STATUS_FAILED, "no memory for %s: %.3g GB are needed, %.3g GB are free", what, bytes / 1e9,
                      free_bytes / 1e9);
}

static void *aligned(size_t alignment, size_t unit, size_t bytes)
{
    const size_t units = bytes > 0 ? (bytes + unit - 1) / unit : 1;
    void *memory;
    return posix_memalign(&memory, alignment, units * unit) == 0 ? memory : NULL;
}

void *memory_aligned(size_t alignment, size_t bytes)
{
    return aligned(alignment, alignment, bytes);
}

void *memory_columns(size_t alignment, size_t bytes)
{
    static const size_t huge = 1 << 21;
    if (bytes < 4 * huge)
        return memory_aligned(alignment, bytes);
    void *memory = aligned(huge, alignment, bytes);
#ifdef MADV_HUGEPAGE
    if (memory)
        madvise(memory, bytes, MADV_HUGEPAGE); /* advice: without it the pages are small */
#endif
    return memory;
}

void memory_clear(void *memory, size_t bytes)
{
    const size_t step = 1 << 22;
#pragma omp parallel for if (bytes > step)
    for (size_t at = 0; at < bytes; at += step)
        memset((char *)memory + at, 0, bytes - at < step ? bytes - at : step);
}

/* A page ahead of the memory stores its size. */
void *memory_sparse(size_t bytes, bool huge)
{
    const size_t page = (size_t)sysconf(_SC_PAGESIZE), all = bytes + page;
    if (all < bytes)
        return NULL;
    char *memory = mmap(NULL, all, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (memory == MAP_FAILED)
        return NULL;
#ifdef MADV_HUGEPAGE
    madvise(memory, all, huge ? MADV_HUGEPAGE : MADV_NOHUGEPAGE); /* advice */
#endif
    *(size_t *)memory = all;
    return memory + page;
}

void memory_sparse_drop(void *memory, size_t begin, size_t end)
{
    const size_t page = (size_t)sysconf(_SC_PAGESIZE), first = (begin + page - 1) / page * page;
    const size_t last = end / page * page;
    if (first < last)
        madvise((char *)memory + first, last - first, MADV_DONTNEED);
}

void memory_sparse_free(void *memory)
{
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    if (memory)
        munmap((char *)memory - page, *(size_t *)(void *)((char *)memory - page));
}

struct stored {
    struct stored *before;
    void *thing;
    void (*release)(void *thing);
};

static void *keep(struct store *store, void *thing, void (*release)(void *thing), size_t bytes, double share)
{
    struct stored *stored = thing ? malloc(sizeof *stored) : NULL;
    if (!stored) {
        store->failed = true;
        if (thing)
            release(thing);
        return NULL;
    }
    *stored = (struct stored){store->last, thing, release};
    store->last = stored;
    store->bytes += share * (double)bytes + (double)sizeof *stored;
    return thing;
}

void *store_keep(struct store *store, void *thing, void (*release)(void *thing))
{
    return keep(store, thing, release, 0, 1);
}

void *store_take(struct store *store, size_t count, size_t size, double share)
{
    const size_t bytes = (count * size + LINE - 1) / LINE * LINE;
    void *memory = keep(store, memory_columns(LINE, bytes), free, bytes, share);
    if (memory)
        memory_clear(memory, bytes);
    return memory;
}

void *store_room(struct store *store, size_t count, size_t size, double share)
{
    const size_t bytes = count * size;
    return keep(store, memory_aligned(LINE, bytes), free, bytes, share);
}

void store_release(struct store *store)
{
    while (store->last) {
        struct stored *last = store->last;
        store->last = last->before;
        last->release(last->thing);
        free(last);
    }
    *store = (struct store){0};
}
