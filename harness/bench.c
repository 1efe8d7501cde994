/* The command `bench`: how near every engine comes to the machine's limits on BP22's full-size scene. Ratios of one run:
   against the processor's multiply-add peak, and against the control loop. */
#include <errno.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../algorithms/isa.h"
#include "../algorithms/pairs.h"
#include "../algorithms/peak.h"
#include "bench_rma.h"
#include "control.h"
#include "echo_data.h"
#include "record.h"
#include "simulate.h"
#include "task.h"
#include "timing.h"

enum { ROWS = 64 };                     /* of the general engine's problem, evenly spaced over the swath */

static const char *const methods[] = {"bp_nearest", "bp_linear:beta=8", "bp_sinc:taps=8", "bp_zeropad:factor=8"};
enum { METHODS = sizeof methods / sizeof *methods };
/* FLOPs of one pair in the method's own sums, without delays and phases. */
static const double pair_flops[METHODS] = {8, 16, 40, 8};

static const struct {
    const char *scene, *engine;
} cases[] = {
    {"bp22/full_limited", "invariant"},
    {"bp22/full", "invariant"},
    {"bp22/full_limited", "general"},
};

struct bench {
    FILE *file;
    double peak[2][2];                  /* [precision][0: one thread, 1: all] FLOP/s */
    int threads;
};

static double stage_seconds(const struct stages *stages, const char *name)
{
    for (int k = 0; k < stages->count; k++)
        if (strcmp(stages->stage[k].name, name) == 0)
            return stages->stage[k].seconds;
    return NAN;
}

static enum status measure(struct bench *bench, const struct scene *scene, const char *engine, int method,
                           enum precision precision, int threads, const struct problem *whole,
                           const struct echoes *echoes, const struct echoes *control_echoes)
{
    char text[96];
    struct spec spec;
    struct image image;
    struct timing timing;
    struct problem problem = *whole;
    problem.precision = precision;
    snprintf(text, sizeof text, "%s%sengine=%s,precision=%s", methods[method], strchr(methods[method], ':') ? "," : ":",
             engine, precision_name(precision));
    enum status status = spec_parse(text, &spec);
    if (status != STATUS_OK)
        return status;
    omp_set_num_threads(threads);
    status = image_allocate(problem.patch_count, problem.patches, precision, &image);
    if (status == STATUS_OK) {
        status = timing_measure(spec.algorithm, &problem, spec.options, echoes, control_echoes, &image, &timing);
        image_free(&image);
    }
    const char *algorithm = spec.algorithm->name;
    omp_set_num_threads(bench->threads);
    spec_free(&spec);
    if (status != STATUS_OK)
        return status;
    double sums = stage_seconds(&timing.stages, "focus"), rate = timing.work.pairs / sums;
    double peak = bench->peak[precision][threads > 1];
    fprintf(bench->file, "%s,%s,%s,%s,%d,%d,%.9g,%.6g,%.6g,%.6g,%.6g,%.4g,%.4g,%.4g,%.6g\n", scene->name, engine,
            algorithm, precision_name(precision), threads, timing.runs,
            timing.work.pairs, timing.run_s, sums, rate, pair_flops[method], pair_flops[method] * rate / peak,
            rate / peak, timing.control_s / sums, timing.work.bytes);
    fflush(bench->file);
    printf("%-18s %-9s %-20s %-6s %d  %8.3f %8.3f %9.3f %7.3f %9.4f %8.1f %7.0f\n", scene->name, engine, methods[method],
           precision_name(precision), threads, timing.run_s, sums, 1e-9 * rate, pair_flops[method] * rate / peak,
           rate / peak, timing.control_s / sums, timing.work.bytes / 1e6);
    fflush(stdout);
    return STATUS_OK;
}

static enum status bench_case(struct bench *bench, const char *name, const char *engine)
{
    struct scene scene;
    struct echoes echoes[2];
    enum status status = scene_load(name, SCENE_DIRECTORY, &scene);
    if (status != STATUS_OK)
        return status;
    struct problem problem = {&scene.acquisition, scene.patch_count, scene.patches, PRECISION_FLOAT};
    struct grid rows = scene.patches[0];
    if (strcmp(engine, "general") == 0) {
        rows.r_step *= (double)rows.r_count / ROWS;
        rows.r_count = ROWS;
        problem.patches = &rows;
    }
    status = scene_simulate(&scene, &echoes[PRECISION_DOUBLE]);
    if (status == STATUS_OK) {
        status = echoes_convert(&echoes[PRECISION_DOUBLE], PRECISION_FLOAT, &echoes[PRECISION_FLOAT]);
        for (int m = 0; m < METHODS && status == STATUS_OK; m++)
            for (int p = 0; p < 2 && status == STATUS_OK; p++) {
                enum precision precision = p ? PRECISION_DOUBLE : PRECISION_FLOAT;
                status = measure(bench, &scene, engine, m, precision, bench->threads, &problem, &echoes[precision],
                                 &echoes[PRECISION_FLOAT]);
                if (m == 0 && bench->threads > 1 && status == STATUS_OK)
                    status = measure(bench, &scene, engine, m, precision, 1, &problem, &echoes[precision],
                                     &echoes[PRECISION_FLOAT]);
            }
        echoes_free(&echoes[PRECISION_DOUBLE]);
        echoes_free(&echoes[PRECISION_FLOAT]);
    }
    scene_free(&scene);
    return status;
}

enum status command_bench(const struct task *task)
{
    const char *directory = task->output ? task->output : "results/bench";
    char path[4096];
    struct bench bench = {.threads = omp_get_max_threads()};
    enum status status = directory_make(directory);
    snprintf(path, sizeof path, "%s/bench.csv", directory);
    if (status == STATUS_OK && !(bench.file = fopen(path, "w")))
        status = status_set(STATUS_INVALID, "%.300s: cannot be written: %s; must be a writable folder", path,
                            strerror(errno));
    if (status != STATUS_OK)
        return status;
    fprintf(bench.file, "# sasbench bench 1\n# isa: %s\n", isa_name(isa_choose()));
    for (int p = 0; p < 2; p++) {
        bench.peak[p][0] = peak_flops((enum precision)p, 1);
        bench.peak[p][1] = peak_flops((enum precision)p, bench.threads);
        fprintf(bench.file, "# peak %s: %.4g FLOP/s on 1 thread, %.4g on %d\n", precision_name((enum precision)p),
                bench.peak[p][0], bench.peak[p][1], bench.threads);
        printf("multiply-add peak, %s (%s): %.1f GFLOP/s on one thread, %.1f on %d\n", precision_name((enum precision)p),
               isa_name(isa_choose()), 1e-9 * bench.peak[p][0], 1e-9 * bench.peak[p][1], bench.threads);
    }
    fprintf(bench.file, "scene,engine,algorithm,precision,threads,runs,pairs,run_s,sum_s,pairs_per_s,flops_per_pair,"
                        "fraction_of_peak,pairs_per_peak_flop,ratio_to_control,bytes\n");
    printf("\n%-18s %-9s %-20s %-6s %s  %8s %8s %9s %7s %9s %8s %7s\n", "scene", "engine", "algorithm", "prec.", "t",
           "run s", "sums s", "Gpairs/s", "of peak", "pair/FLOP", "control", "MB");
    for (size_t k = 0; k < sizeof cases / sizeof *cases && status == STATUS_OK; k++)
        status = bench_case(&bench, cases[k].scene, cases[k].engine);
    if (fclose(bench.file) != 0 && status == STATUS_OK)
        status = status_set(STATUS_FAILED, "%.300s: cannot be written: %s", path, strerror(errno));
    if (status == STATUS_OK)
        printf("\nResults: %s\n", path);
    return status == STATUS_OK ? bench_rma(directory) : status;
}
