/* The command `bench`: how near the engines come to the machine's limits at the papers' sizes. Everything is a ratio of
   one run: against the processor's multiply-add peak, and against the scalar reference loop. Each line is measured in
   several rounds, a minute and more apart, since what else the machine does lasts for seconds to minutes; printed are
   medians of the rounds. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "common/isa.h"
#include "common/peak.h"
#include "study/bench.h"
#include "study/bench_algorithms.h"
#include "study/bench_growth.h"
#include "study/bench_rma.h"
#include "study/bench_wk.h"
#include "data/echo_data.h"
#include "data/folder.h"
#include "show/plot.h"
#include "measure/provenance.h"
#include "scene/simulate.h"
#include "data/paths.h"
#include "data/text_file.h"
#include "measure/spec.h"
#include "measure/timing.h"

/* FLOPs of one pair are those of the method's own sums, without delays and phases: what the inner loop cannot avoid. */
static const struct method {
    const char *name, *settings; /* settings: ":key=value", or empty */
    double pair_flops;
} methods[] = {
    {"bp_nearest", "", 8},          {"bp_linear", ":beta=8", 16},   {"bp_sinc", ":taps=8", 40},
    {"bp_zeropad", ":factor=8", 8}, {"bp_farrow", ":degree=3", 20}, {"bp_farrow", ":degree=5", 28},
    {"bp_fitted", ":taps=6", 32},
};
enum { METHODS = sizeof methods / sizeof *methods };

static const struct bench_case {
    const char *scene, *engine;
    int rows;           /* evenly spaced over the swath; 0: all */
    int methods, alone; /* the first ones of the table; those also on one thread */
} cases[] = {
    {"bp22/full_limited", "invariant", 0, METHODS, 1},
    {"bp22/full", "invariant", 0, 1, 0},
    {"bp22/full_limited", "general", 64, METHODS, METHODS},
};

struct bench {
    FILE *file;
    int threads;
};

/* What is measured in each round. */
enum value { PLAN_S, RUN_S, SUM_S, RATE, PEAK, CONTROL, RUN_TO_SUM, GAIN, VALUES };
enum { ROUNDS = 3 };

/* One line of the table. */
struct line {
    int threads, runs; /* of all rounds; no runs: not measured */
    double pairs, plan_bytes, process_bytes;
    double value[VALUES][ROUNDS];
};

static double stage_seconds(const struct stages *stages, const char *name)
{
    for (int k = 0; k < stages->count; k++)
        if (strcmp(stages->stage[k].name, name) == 0)
            return stages->stage[k].seconds;
    return NAN;
}

/* The most memory that the process has held so far, in bytes. */
static double memory_peak(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? 1024.0 * (double)usage.ru_maxrss : NAN;
}

/* What a line measures. */
struct subject {
    const struct bench_case *one;
    const struct method *method;
    const struct problem *problem;
    const struct echoes *echoes, *control_echoes; /* of the problem's precision; in float */
    const struct line *alone;                     /* the line on one thread */
};

/* One round of a line; the peak is measured before and after, as the scalar reference loop is. */
static enum status measure(const struct bench *bench, const struct subject *subject, int round, struct line *line)
{
    const struct method *method = subject->method;
    const struct problem *problem = subject->problem;
    char text[96];
    struct spec spec;
    struct image image;
    struct timing timing;
    snprintf(text, sizeof text, "%s%s%sengine=%s,precision=%s", method->name, method->settings,
             *method->settings ? "," : ":", subject->one->engine, precision_name(problem->precision));
    enum status status = spec_parse(text, &spec);
    if (status != STATUS_OK)
        return status;
    omp_set_num_threads(line->threads);
    double peak = 0.5 * peak_flops(problem->precision, line->threads);
    struct control control = control_begin(problem, subject->control_echoes);
    status = timing_measure(&spec, problem, subject->echoes, &control, EFFORT_WHOLE, NULL, &image, &timing);
    control_end(&control);
    peak += 0.5 * peak_flops(problem->precision, line->threads);
    image_free(&image);
    spec_free(&spec);
    omp_set_num_threads(bench->threads);
    if (status != STATUS_OK)
        return status;
    const double sums = stage_seconds(&timing.stages, "focus"), rate = timing.work.pairs / sums;
    const double values[VALUES] = {
        [PLAN_S] = timing.plan_s,
        [RUN_S] = timing.run_s,
        [SUM_S] = sums,
        [RATE] = rate,
        [PEAK] = peak,
        [CONTROL] = timing.control_s / sums,
        [RUN_TO_SUM] = timing.run_s / sums,
        [GAIN] = subject->alone->runs > 0 ? subject->alone->value[RUN_S][round] / timing.run_s : NAN,
    };
    for (int k = 0; k < VALUES; k++)
        line->value[k][round] = values[k];
    line->runs += timing.runs;
    line->pairs = timing.work.pairs;
    line->plan_bytes = timing.work.bytes;
    if (round == 0)
        line->process_bytes = memory_peak();
    return STATUS_OK;
}

/* The median of the peak in all rounds of all lines of a precision on as many threads: one sample is off by as much as
   what else the machine does. */
static double peak_median(struct line lines[METHODS][2][2], int precision, int n)
{
    double peaks[METHODS * ROUNDS];
    int count = 0;
    for (int m = 0; m < METHODS; m++)
        for (int round = 0; round < ROUNDS && lines[m][precision][n].runs > 0; round++)
            peaks[count++] = lines[m][precision][n].value[PEAK][round];
    return count > 0 ? median(peaks, count) : NAN;
}

static void report(const struct bench *bench, const struct bench_case *one, const struct method *method,
                   const struct problem *problem, double peak, struct line *line)
{
    const char *precision = precision_name(problem->precision);
    double v[VALUES];
    char gain[24] = "";
    for (int k = 0; k < VALUES; k++)
        v[k] = median(line->value[k], ROUNDS);
    if (line->threads > 1 && !isnan(v[GAIN]))
        snprintf(gain, sizeof gain, "%.3f", v[GAIN]);
    fprintf(bench->file, "%s,%s,%s%s,%s,%d,%d,%d,%.9g,%.4g,%.4g,%.4g,%.4g,%.4g,%g,%.4g,%.4g,%.4g,%.4g,%s,%.6g,%.6g\n",
            one->scene, one->engine, method->name, method->settings, precision, line->threads,
            problem->patches[0].r_count, line->runs, line->pairs, v[PLAN_S], v[RUN_S], v[SUM_S], v[RATE], peak,
            method->pair_flops, method->pair_flops * v[RATE] / peak, v[RATE] / peak, v[CONTROL], v[RUN_TO_SUM], gain,
            line->plan_bytes, line->process_bytes);
    printf("%-17s %-9s %-10s%-9s %-6s %d %7.3f %7.3f %7.3f %6.3f %8.5f %7.1f %7.2f %6s %6.0f\n", one->scene,
           one->engine, method->name, method->settings, precision, line->threads, v[RUN_S], v[SUM_S], 1e-9 * v[RATE],
           method->pair_flops * v[RATE] / peak, v[RATE] / peak, v[CONTROL], v[RUN_TO_SUM], *gain ? gain : "-",
           line->process_bytes / 0x1p20);
    fflush(stdout);
}

static enum status bench_case(struct bench *bench, const struct bench_case *one)
{
    struct scene scene;
    struct echoes echoes[2] = {{0}, {0}};
    enum status status = scene_load(one->scene, SCENE_DIRECTORY, &scene);
    if (status != STATUS_OK)
        return status;
    struct grid grid = scene.patches[0];
    if (one->rows > 0) {
        grid.r_step *= (double)grid.r_count / one->rows;
        grid.r_count = one->rows;
    }
    status = scene_simulate(&scene, &echoes[PRECISION_DOUBLE]);
    if (status == STATUS_OK)
        status = echoes_convert(&echoes[PRECISION_DOUBLE], PRECISION_FLOAT, &echoes[PRECISION_FLOAT]);
    struct line lines[METHODS][2][2] = {0}; /* [method][precision][on one thread, on all] */
    for (int round = 0; round < ROUNDS; round++)
        for (int m = 0; m < one->methods; m++)
            for (int p = 0; p < 2; p++)
                for (int n = 0; n < 2 && status == STATUS_OK; n++) {
                    const bool alone = m < one->alone && n == 0,
                               all = n == 1 && (bench->threads > 1 || m >= one->alone);
                    struct problem problem = {&scene.acquisition, 1, &grid, (enum precision)p};
                    lines[m][p][n].threads = n == 0 ? 1 : bench->threads;
                    if (alone || all)
                        status = measure(bench,
                                         &(struct subject){one, &methods[m], &problem, &echoes[p],
                                                           &echoes[PRECISION_FLOAT], &lines[m][p][0]},
                                         round, &lines[m][p][n]);
                }
    for (int m = 0; m < one->methods; m++)
        for (int p = 0; p < 2; p++)
            for (int n = 0; n < 2 && status == STATUS_OK; n++) {
                struct problem problem = {&scene.acquisition, 1, &grid, (enum precision)p};
                if (lines[m][p][n].runs > 0)
                    report(bench, one, &methods[m], &problem, peak_median(lines, p, n), &lines[m][p][n]);
            }
    for (int p = 0; p < 2; p++)
        for (int n = 0; n < 2 && status == STATUS_OK; n++) {
            const double peak = peak_median(lines, p, n);
            if (isfinite(peak))
                printf("multiply-add peak, %s, on %d thread%s: %.1f GFLOP/s\n", precision_name((enum precision)p),
                       n ? bench->threads : 1, n && bench->threads > 1 ? "s" : "", 1e-9 * peak);
        }
    echoes_free(&echoes[PRECISION_DOUBLE]);
    echoes_free(&echoes[PRECISION_FLOAT]);
    scene_free(&scene);
    return status;
}

static enum status measure_cases(FILE *file)
{
    struct provenance provenance;
    struct bench bench = {.file = file, .threads = omp_get_max_threads()};
    provenance_fill(&provenance, bench.threads);
    fprintf(file, "# sasbench bench 3\n# machine: %s\n# compiler: %s\n# flags: %s\n# commit: %s\n# date: %s\n",
            provenance.machine, provenance.compiler, provenance.flags, provenance.commit, provenance.date);
    fprintf(file, "# isa: %s\n", isa_name(isa_choose()));
    fprintf(file, "scene,engine,algorithm,precision,threads,rows,runs,pairs,plan_s,run_s,sum_s,pairs_per_s,"
                  "peak_flops,flops_per_pair,fraction_of_peak,pairs_per_peak_flop,ratio_to_control,run_to_sum,"
                  "gain_of_threads,plan_bytes,process_bytes\n");
    printf("\n%-17s %-9s %-19s %-6s %s %7s %7s %7s %6s %8s %7s %7s %6s %6s\n", "scene", "engine", "algorithm", "prec.",
           "t", "run s", "sums s", "Gpair/s", "peak", "pair/FL", "control", "run/sum", "gain", "MiB");
    enum status status = STATUS_OK;
    for (size_t k = 0; k < sizeof cases / sizeof *cases && status == STATUS_OK; k++)
        status = bench_case(&bench, &cases[k]);
    return status;
}

/* Back projection on BP22's full size. */
static enum status bench_bp(const char *directory)
{
    return bench_file(directory, "bench", measure_cases);
}

enum status bench_file(const char *directory, const char *name, enum status (*measure_into)(FILE *file))
{
    char csv[4096], picture[4096], script[60], footer[PROVENANCE_LINE];
    struct text_file file;
    snprintf(csv, sizeof csv, "%s/%s.csv", directory, name);
    snprintf(script, sizeof script, "%s.gp", name);
    enum status status = text_file_open(csv, &file);
    if (status != STATUS_OK)
        return status;
    status = text_file_close(&file, measure_into(file.stream));
    provenance_line(footer);
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        snprintf(picture, sizeof picture, "%s/%s.%s", directory, name, k ? "svg" : "png");
        status = plot_csv(picture, PLOT_DIRECTORY, script, csv, footer);
    }
    if (status == STATUS_OK)
        printf("\nResults: %s/%s.csv, %s.png, %s.svg\n", directory, name, name, name);
    return status;
}

/* Each measures into files of its own in the folder. */
static enum status (*const parts[])(const char *directory) = {bench_bp, bench_growth, bench_rma, bench_wk};

static enum status specs_check(const char *const *specs, int count)
{
    enum status status = STATUS_OK;
    for (int k = 0; k < count && status == STATUS_OK; k++) {
        struct spec spec;
        status = spec_parse(specs[k], &spec);
        if (status == STATUS_OK)
            spec_free(&spec);
    }
    return status;
}

enum status bench_run(const char *directory, const char *const *specs, int count)
{
    int lock = -1;
    enum status status = specs_check(specs, count);
    if (status == STATUS_OK)
        status = directory_make(directory);
    if (status == STATUS_OK)
        status = folder_take(directory, &lock);
    if (status == STATUS_OK && count > 0)
        status = bench_algorithms(directory, specs, count);
    for (size_t k = 0; k < sizeof parts / sizeof *parts && count == 0 && status == STATUS_OK; k++)
        status = parts[k](directory);
    folder_leave(lock);
    return status;
}
