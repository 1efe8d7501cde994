/* Lines of the command `bench`, measured (bench_line.h). Rounds lie apart, since other load on the machine lasts for
   seconds to minutes. */
#define _GNU_SOURCE /* strdup, setenv */
#include "bench/bench_line.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <fftw3.h>

#include "common/isa.h"
#include "common/peak.h"
#include "measure/outcome.h"
#include "contract/algorithm.h"

bool bench_line_here(const struct bench_line *line)
{
    bool lower = !*line->isa;
    for (enum isa isa = ISA_BASELINE; isa < isa_choose(); isa++)
        lower |= strcmp(line->isa, isa_name(isa)) == 0;
    return lower;
}

/* ---- FFTW's own time, the unit for the times of whole algorithms ---- */

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

/* One forward and one inverse transform of rows x columns in place, float, planned by measurement. Errors:
   STATUS_FAILED without memory or threads. */
static enum status fft_seconds(int rows, int columns, int threads, struct fft_seconds *seconds)
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

/* ---- lines ---- */

/* FFTW's time for records or image, whichever is larger along each axis; the last one is kept. */
static enum status transforms_measure(const struct acquisition *a, struct bench_line *line)
{
    static struct {
        int azimuth, range, threads;
        struct fft_seconds seconds;
    } kept;
    const int records = a->pings * a->receivers;
    const int azimuth = records > line->columns ? records : line->columns;
    const int range = a->samples > line->rows ? a->samples : line->rows;
    line->fft = (struct fft_seconds){NAN, NAN, NAN};
    if (line->row.pairs > 0 || line->spec.precision != PRECISION_FLOAT)
        return STATUS_OK;
    if (kept.azimuth != azimuth || kept.range != range || kept.threads != line->threads) {
        const enum status status = fft_seconds(azimuth, range, line->threads, &kept.seconds);
        if (status != STATUS_OK)
            return status;
        kept.azimuth = azimuth, kept.range = range, kept.threads = line->threads;
    }
    line->fft = kept.seconds;
    return STATUS_OK;
}

/* The last round's row, which is of all rounds. */
static enum status line_keep(struct session *session, struct bench_line *line)
{
    struct outcome outcome;
    outcome_measure(session, &line->spec, EFFORT_WHOLE, line->samples, &outcome);
    enum status status = STATUS_OK;
    if (strcmp(outcome.row.status, "ok") != 0)
        status = status_set(STATUS_FAILED, "%s with %s:%s: %s", line->scene, line->spec.algorithm->name,
                            line->spec.text, outcome.reason);
    line->row = outcome.row;
    line->measured = true;
    snprintf(line->engine, sizeof line->engine, "%s", outcome.work.engine);
    snprintf(line->stages, sizeof line->stages, "%s", outcome.stages);
    line->row.engine = line->engine;
    line->row.stages = line->stages;
    const struct problem problem = session_problem(session->scene, line->spec.algorithm, line->spec.precision);
    line->columns = problem.patches[0].x_count;
    line->rows = problem.patches[0].r_count;
    outcome_free(&outcome);
    return status;
}

static enum status line_round(struct session *session, struct bench_line *line, int round)
{
    const int all = omp_get_max_threads();
    const char *before = getenv("SASBENCH_ISA");
    char *own = before ? strdup(before) : NULL;
    enum status status = STATUS_OK;
    if (*line->isa)
        setenv("SASBENCH_ISA", line->isa, 1);
    omp_set_num_threads(line->threads);
    line->peaks[2 * round] = peak_flops(line->spec.precision, line->threads);
    if (round < TIMING_ROUNDS - 1)
        outcome_round(session, &line->spec, line->samples);
    else
        status = line_keep(session, line);
    line->peaks[2 * round + 1] = peak_flops(line->spec.precision, line->threads);
    omp_set_num_threads(all);
    if (*line->isa && own)
        setenv("SASBENCH_ISA", own, 1);
    else if (*line->isa)
        unsetenv("SASBENCH_ISA");
    free(own);
    return status;
}

enum status bench_lines_measure(const struct scene *scene, struct bench_line *const *lines, int count)
{
    struct session session;
    enum status status = session_open(scene, &session);
    if (status != STATUS_OK)
        return status;
    for (int k = 0; k < count && status == STATUS_OK; k++)
        if (!(lines[k]->samples = calloc(1, sizeof *lines[k]->samples)))
            status = status_set(STATUS_FAILED, "%s: no memory for the times of %d lines", scene->name, count);
    for (int round = 0; round < TIMING_ROUNDS; round++)
        for (int k = 0; k < count && status == STATUS_OK; k++)
            status = line_round(&session, lines[k], round);
    for (int k = 0; k < count; k++) {
        free(lines[k]->samples);
        lines[k]->samples = NULL;
        if (status == STATUS_OK)
            status = transforms_measure(&scene->acquisition, lines[k]);
    }
    session_close(&session);
    return status;
}

/* ---- values ---- */

const char *const bench_values[] = {"run_s",   "sum_s",     "full_s", "rate", "run_rate",
                                    "phase_s", "focused_s", "error",  NULL};
enum value { RUN_S, SUM_S, FULL_S, RATE, RUN_RATE, PHASE_S, FOCUSED_S, ERROR };
enum { FULL_ROWS = 4800 }; /* of BP22's image */

static double stages_s(const struct bench_line *line, const char *const *names)
{
    double sum = 0;
    for (; *names; names++)
        sum += fmax(0, measurement_stage(&line->row, *names)); /* fmax: without those that it does not have */
    return sum;
}

double bench_value(const struct bench_line *line, int value)
{
    static const char *const phases[] = {"bulk", "differential", NULL}, *const compression[] = {"compress", NULL};
    const double run_s = line->row.run_s, sum_s = measurement_stage(&line->row, "focus");
    switch ((enum value)value) {
    case RUN_S: return run_s;
    case SUM_S: return sum_s;
    case FULL_S: return run_s + ((double)FULL_ROWS / line->rows - 1) * sum_s;
    case RATE: return line->row.pairs / sum_s;
    case RUN_RATE: return line->row.pairs / run_s;
    case PHASE_S: return stages_s(line, phases);
    case FOCUSED_S: return run_s - stages_s(line, compression);
    case ERROR: return line->row.error;
    }
    return NAN;
}

double bench_peak(const struct bench_line *line)
{
    double sorted[2 * TIMING_ROUNDS];
    memcpy(sorted, line->peaks, sizeof sorted);
    return median(sorted, 2 * TIMING_ROUNDS);
}
