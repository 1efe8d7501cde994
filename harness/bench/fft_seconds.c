#include "bench/fft_seconds.h"

#include <fftw3.h>
#include <math.h>
#include <omp.h>
#include <string.h>

#include "contract/algorithm.h"

enum { RUNS = 5, STRIP = 16 /* columns: two lines of the cache */ };

/* Plans of one way; the unused are NULL. */
struct plans {
    int rows, columns, threads;
    fftwf_complex *data, *strips; /* strips: [threads][rows][STRIP] */
    fftwf_plan whole[2];          /* forward, inverse */
    fftwf_plan row[2], strip[2];  /* of a row; of a strip */
};

static void rows_transform(const struct plans *p, int sign)
{
#pragma omp parallel for schedule(static) num_threads(p->threads)
    for (int i = 0; i < p->rows; i++) {
        fftwf_complex *row = p->data + (size_t)i * (size_t)p->columns;
        fftwf_execute_dft(p->row[sign], row, row);
    }
}

static void columns_transform(const struct plans *p, int sign)
{
#pragma omp parallel for schedule(static) num_threads(p->threads)
    for (int j = 0; j < p->columns; j += STRIP) {
        const size_t width = (size_t)(p->columns - j < STRIP ? p->columns - j : STRIP), bytes = width * sizeof *p->data;
        fftwf_complex *strip = p->strips + (size_t)omp_get_thread_num() * (size_t)p->rows * STRIP;
        for (size_t i = 0; i < (size_t)p->rows; i++)
            memcpy(strip + i * STRIP, p->data + i * (size_t)p->columns + j, bytes);
        fftwf_execute_dft(p->strip[sign], strip, strip);
        for (size_t i = 0; i < (size_t)p->rows; i++)
            memcpy(p->data + i * (size_t)p->columns + j, strip + i * STRIP, bytes);
    }
}

static void by_strips(const struct plans *p)
{
    rows_transform(p, 0);
    columns_transform(p, 0);
    columns_transform(p, 1);
    rows_transform(p, 1);
}

static void by_plan(const struct plans *p)
{
    fftwf_execute(p->whole[0]);
    fftwf_execute(p->whole[1]);
}

static double best_of(const struct plans *p, void (*transform)(const struct plans *))
{
    double best = INFINITY;
    memset(p->data, 0, (size_t)p->rows * (size_t)p->columns * sizeof *p->data);
    for (int k = 0; k < RUNS; k++) {
        double begin = seconds_now();
        transform(p);
        best = fmin(best, seconds_now() - begin);
    }
    return best;
}

static void plans_make(struct plans *p)
{
    static const int signs[] = {FFTW_FORWARD, FFTW_BACKWARD};
    for (int k = 0; k < 2; k++) {
        fftwf_plan_with_nthreads(p->threads);
        p->whole[k] = fftwf_plan_dft_2d(p->rows, p->columns, p->data, p->data, signs[k], FFTW_MEASURE);
        fftwf_plan_with_nthreads(1);
        /* UNALIGNED: rows begin anywhere. */
        p->row[k] = fftwf_plan_dft_1d(p->columns, p->data, p->data, signs[k], FFTW_MEASURE | FFTW_UNALIGNED);
        p->strip[k] = fftwf_plan_many_dft(1, &p->rows, STRIP, p->strips, NULL, STRIP, 1, p->strips, NULL, STRIP, 1,
                                          signs[k], FFTW_MEASURE | FFTW_UNALIGNED);
    }
}

enum status fft_seconds(int rows, int columns, int threads, struct fft_seconds *seconds)
{
    struct plans p = {.rows = rows, .columns = columns, .threads = threads};
    enum status status = STATUS_OK;
    p.data = fftwf_malloc((size_t)rows * (size_t)columns * sizeof *p.data);
    p.strips = fftwf_malloc((size_t)threads * (size_t)rows * STRIP * sizeof *p.strips);
    if (p.data && p.strips && fftwf_init_threads()) {
        plans_make(&p);
        seconds->plan = best_of(&p, by_plan);
        memset(p.strips, 0, (size_t)threads * (size_t)rows * STRIP * sizeof *p.strips);
        seconds->strips = best_of(&p, by_strips);
        seconds->best = fmin(seconds->plan, seconds->strips);
        fftwf_plan plans[] = {p.whole[0], p.whole[1], p.row[0], p.row[1], p.strip[0], p.strip[1]};
        for (size_t k = 0; k < sizeof plans / sizeof *plans; k++)
            fftwf_destroy_plan(plans[k]);
    } else {
        status = status_set(STATUS_FAILED, "no memory or no threads for a transform of %d x %d", rows, columns);
    }
    fftwf_free(p.data);
    fftwf_free(p.strips);
    return status;
}
