/* Back projection on BP22's full size in `bench` (bench_bp.h). Each line is measured in several rounds, a minute and
   more apart, since what else the machine does lasts for seconds to minutes; printed are medians of the rounds. */
#define _GNU_SOURCE /* strdup, setenv */
#include "bench/bench_bp.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "common/isa.h"
#include "common/peak.h"
#include "echoes/echo_data.h"
#include "files/paths.h"
#include "results/provenance.h"
#include "measure/scalar_loop.h"
#include "measure/timing.h"
#include "scene/simulate.h"
#include "bench/bench.h"
#include "bench/bench_once.h"

/* FLOPs of one pair are those of the method's own sums, without delays and phases: what the inner loop cannot avoid. */
static const struct method {
    const char *name, *settings; /* settings: ":key=value", or empty */
    double pair_flops;
    double rate; /* goal: of nearest's, by the general engine; 0: none */
} methods[] = {
    {"bp_nearest", "", 8, 0},          {"bp_linear", ":beta=8", 16, 0},     {"bp_sinc", ":taps=8", 40, 0.4},
    {"bp_zeropad", ":factor=8", 8, 0}, {"bp_farrow", ":degree=3", 20, 0.7}, {"bp_farrow", ":degree=5", 28, 0.5},
    {"bp_fitted", ":taps=4", 24, 0.6}, {"bp_fitted", ":taps=6", 32, 0},     {"bp_farrow", ":degree=4", 24, 0},
};
enum {
    METHODS = sizeof methods / sizeof *methods,
    NEAREST = 0,
    ZEROPAD = 3,
    FARROW_3 = 4,
    FARROW_5 = 5,
    BRIEF = 6,
    INVARIANT = 8,
    FARROW_4 = 8
};

static const struct bench_case {
    const char *scene, *engine, *isa; /* isa: "" for the processor's best */
    int rows;                         /* evenly spaced over the swath; 0: all */
    int methods, doubles;             /* the first ones of the table; those also in double */
    int alone, all;                   /* those on one thread, on all */
    double peak[2];                   /* goal: nearest's fraction of the peak in float, in double; 0: none */
} cases[] = {
    {"bp22/full_limited", "invariant", "", 0, INVARIANT, 3, 1, INVARIANT, {0.45, 0.50}},
    {"bp22/full_limited", "invariant", "v3", 0, 1, 1, 1, 0, {0.50, 0.55}},
    {"bp22/full", "invariant", "", 0, 1, 1, 0, 1, {0.30, 0.30}},
    {"bp22/full_limited", "general", "", 64, METHODS, METHODS, METHODS, METHODS, {0, 0}},
    {"bp22/full_limited", "general", "v3", 32, BRIEF, BRIEF, BRIEF, 0, {0, 0}},
    {"bp22/full_limited", "general", "baseline", 32, BRIEF, BRIEF, BRIEF, 0, {0, 0}},
};
enum { CASES = sizeof cases / sizeof *cases, GENERAL = 3 /* the first of the general engine's */ };

/* What is measured in each round. */
enum value { PLAN_S, RUN_S, SUM_S, RATE, PEAK, CONTROL, RUN_TO_SUM, GAIN, VALUES };
enum { ROUNDS = 3 };

/* One line of the table. */
struct line {
    int threads, runs; /* of all rounds; no runs: not measured */
    double pairs, plan_bytes, process_bytes;
    double value[VALUES][ROUNDS];
};

struct bench {
    FILE *file;
    struct bench_goals *goals;
    int threads;
    struct line lines[CASES][METHODS][2][2]; /* [case][method][precision][on one thread, on all] */
};

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

/* One round of a line; the peak and the scalar reference loop are measured before and after. */
static enum status measure(const struct subject *subject, int round, struct line *line)
{
    const struct method *method = subject->method;
    const struct problem *problem = subject->problem;
    char text[96];
    struct bench_sample sample;
    struct work work;
    snprintf(text, sizeof text, "%s%s%sengine=%s,precision=%s", method->name, method->settings,
             *method->settings ? "," : ":", subject->one->engine, precision_name(problem->precision));
    double peak = peak_flops(problem->precision, line->threads);
    struct scalar_loop loop = scalar_loop_choose(problem, subject->control_echoes);
    double control = scalar_loop_seconds(&loop);
    const enum status status =
        bench_once(text, problem, subject->echoes, line->threads, NULL, line->runs == 0 ? &work : NULL, &sample);
    peak = 0.5 * (peak + peak_flops(problem->precision, line->threads));
    control = 0.5 * (control + scalar_loop_seconds(&loop));
    scalar_loop_free(&loop);
    if (status != STATUS_OK)
        return status;
    if (line->runs == 0) {
        line->pairs = work.pairs;
        line->plan_bytes = work.bytes;
    }
    const double sums = bench_stage(&sample, "focus"), rate = line->pairs / sums;
    const double values[VALUES] = {
        [PLAN_S] = sample.plan_s,
        [RUN_S] = sample.run_s,
        [SUM_S] = sums,
        [RATE] = rate,
        [PEAK] = peak,
        [CONTROL] = control * rate,
        [RUN_TO_SUM] = sample.run_s / sums,
        [GAIN] = subject->alone->runs > 0 ? subject->alone->value[RUN_S][round] / sample.run_s : NAN,
    };
    for (int k = 0; k < VALUES; k++)
        line->value[k][round] = values[k];
    line->runs += sample.runs;
    if (round == 0)
        line->process_bytes = memory_peak();
    return STATUS_OK;
}

/* The median of all rounds; not sorted in place, as rounds of several values belong together. */
static double line_median(const struct line *line, enum value value)
{
    double values[ROUNDS];
    memcpy(values, line->value[value], sizeof values);
    return line->runs > 0 ? median(values, ROUNDS) : NAN;
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

/* The instruction set of a case. */
static const char *case_isa(const struct bench_case *one)
{
    return *one->isa ? one->isa : isa_name(isa_choose());
}

static void report(const struct bench *bench, const struct bench_case *one, const struct method *method,
                   const struct problem *problem, double peak, const struct line *line)
{
    const char *precision = precision_name(problem->precision);
    double v[VALUES];
    char gain[24] = "";
    for (int k = 0; k < VALUES; k++)
        v[k] = line_median(line, (enum value)k);
    if (line->threads > 1 && !isnan(v[GAIN]))
        snprintf(gain, sizeof gain, "%.3f", v[GAIN]);
    fprintf(bench->file,
            "%s,%s,%s,\"%s%s\",%s,%d,%d,%d,%.9g,%.4g,%.4g,%.4g,%.4g,%.4g,%g,%.4g,%.4g,%.4g,%.4g,%s,%.6g,%.6g\n",
            one->scene, one->engine, case_isa(one), method->name, method->settings, precision, line->threads,
            problem->patches[0].r_count, line->runs, line->pairs, v[PLAN_S], v[RUN_S], v[SUM_S], v[RATE], peak,
            method->pair_flops, method->pair_flops * v[RATE] / peak, v[RATE] / peak, v[CONTROL], v[RUN_TO_SUM], gain,
            line->plan_bytes, line->process_bytes);
    printf("%-17s %-9s %-8s %-10s%-18s %-6s %d %7.3f %7.3f %7.3f %6.3f %7.1f %7.2f %6s %6.0f\n", one->scene,
           one->engine, case_isa(one), method->name, method->settings, precision, line->threads, v[RUN_S], v[SUM_S],
           1e-9 * v[RATE], method->pair_flops * v[RATE] / peak, v[CONTROL], v[RUN_TO_SUM], *gain ? gain : "-",
           line->process_bytes / 0x1p20);
    fflush(stdout);
}

/* All lines of a case, one after the other in each round. */
static enum status case_measure(struct bench *bench, const struct bench_case *one, const struct scene *scene,
                                const struct grid *grid, const struct echoes echoes[2])
{
    struct line(*lines)[2][2] = bench->lines[one - cases];
    enum status status = STATUS_OK;
    for (int round = 0; round < ROUNDS; round++)
        for (int m = 0; m < one->methods; m++)
            for (int p = 0; p < 1 + (m < one->doubles); p++)
                for (int n = 0; n < 2 && status == STATUS_OK; n++) {
                    const struct problem problem = problem_make(&scene->acquisition, 1, grid, (enum precision)p);
                    lines[m][p][n].threads = n == 0 ? 1 : bench->threads;
                    if (n == 0 ? m < one->alone : m < one->all && (bench->threads > 1 || m >= one->alone))
                        status = measure(&(struct subject){one, &methods[m], &problem, &echoes[p],
                                                           &echoes[PRECISION_FLOAT], &lines[m][p][0]},
                                         round, &lines[m][p][n]);
                }
    for (int m = 0; m < one->methods; m++)
        for (int p = 0; p < 2; p++)
            for (int n = 0; n < 2 && status == STATUS_OK; n++) {
                const struct problem problem = problem_make(&scene->acquisition, 1, grid, (enum precision)p);
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
    return status;
}

/* Is it an instruction set below the one that is chosen? */
static bool isa_lower(const char *name)
{
    for (enum isa isa = ISA_BASELINE; isa < isa_choose(); isa++)
        if (strcmp(name, isa_name(isa)) == 0)
            return true;
    return false;
}

/* A case that asks for an instruction set is left out where there is no better one. */
static enum status bench_case(struct bench *bench, const struct bench_case *one)
{
    struct scene scene;
    struct echoes echoes[2] = {{0}, {0}};
    if (*one->isa && !isa_lower(one->isa))
        return STATUS_OK;
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
    if (status == STATUS_OK) {
        const char *before = getenv("SASBENCH_ISA");
        char *own = before ? strdup(before) : NULL;
        if (*one->isa)
            setenv("SASBENCH_ISA", one->isa, 1);
        status = case_measure(bench, one, &scene, &grid, echoes);
        if (*one->isa && own)
            setenv("SASBENCH_ISA", own, 1);
        else if (*one->isa)
            unsetenv("SASBENCH_ISA");
        free(own);
    }
    echoes_free(&echoes[PRECISION_DOUBLE]);
    echoes_free(&echoes[PRECISION_FLOAT]);
    scene_free(&scene);
    return status;
}

/* A line's rate against another's; NAN where one was not measured. */
static double rate_ratio(const struct line *line, const struct line *other)
{
    return line_median(line, RATE) / line_median(other, RATE);
}

static void peak_goals(struct bench *bench)
{
    for (int k = 0; k < CASES; k++)
        for (int p = 0; p < 2; p++) {
            const int all = bench->lines[k][NEAREST][p][0].runs == 0; /* the one that was measured */
            const struct line *line = &bench->lines[k][NEAREST][p][all];
            if (cases[k].peak[p] > 0 && line->runs > 0)
                bench_goal(bench->goals, GOAL_AT_LEAST, cases[k].peak[p],
                           methods[NEAREST].pair_flops * line_median(line, RATE) / peak_median(bench->lines[k], p, all),
                           "invariant engine, nearest, of the peak: %s, %s, %s", cases[k].scene, case_isa(&cases[k]),
                           precision_name((enum precision)p));
        }
}

/* The whole run over nearest's, on one thread: at the full size where only some rows were summed. */
static double full_ratio(const struct line *line, const struct line *nearest, double rows)
{
    const double sums = line_median(line, SUM_S), nearest_sums = line_median(nearest, SUM_S);
    return (line_median(line, RUN_S) + rows * sums) / (line_median(nearest, RUN_S) + rows * nearest_sums);
}

/* What accuracy costs: the invariant engine's whole run at full size, and the general engine's. */
static void full_goals(struct bench *bench)
{
    const double rows = 4800.0 / cases[GENERAL].rows - 1; /* as many more */
    struct line(*general)[2][2] = bench->lines[GENERAL];
    static const struct {
        int method;
        double ratio, error;
    } front[] = {{FARROW_3, 1.5, 1e-3}, {FARROW_4, 1.7, 1e-4}, {FARROW_5, 2.2, 1e-5}};
    for (size_t k = 0; k < sizeof front / sizeof *front; k++) {
        const struct method *method = &methods[front[k].method];
        bench_goal(
            bench->goals, GOAL_AT_MOST, front[k].ratio,
            full_ratio(&general[front[k].method][PRECISION_FLOAT][0], &general[NEAREST][PRECISION_FLOAT][0], rows),
            "general engine, error %.0e (%s%s), run over nearest's: full size", front[k].error, method->name,
            method->settings);
    }
    const int all = bench->threads > 1;
    const struct line *nearest = &bench->lines[0][NEAREST][PRECISION_FLOAT][all];
    const struct line *zeropad = &bench->lines[0][ZEROPAD][PRECISION_FLOAT][all];
    /* Twice what it was with one long transform for each record: 4.58 s of a core of 180 GFLOP/s. */
    bench_goal(bench->goals, GOAL_AT_LEAST, 0.296,
               methods[ZEROPAD].pair_flops * zeropad->pairs / line_median(zeropad, RUN_S)
                   / peak_median(bench->lines[0], PRECISION_FLOAT, all),
               "invariant engine, bp_zeropad of factor 8, whole run, of the peak: %s", cases[0].scene);
    bench_goal(bench->goals, GOAL_AT_MOST, 3,
               line_median(&bench->lines[0][FARROW_3][PRECISION_FLOAT][all], RUN_S) / line_median(nearest, RUN_S),
               "invariant engine, error 1e-3 (bp_farrow, degree 3), run over nearest's: %s", cases[0].scene);
    bench_goal(bench->goals, GOAL_AT_MOST, 4.5,
               line_median(&bench->lines[0][FARROW_5][PRECISION_FLOAT][all], RUN_S) / line_median(nearest, RUN_S),
               "invariant engine, error 1e-5 (bp_farrow, degree 5), run over nearest's: %s", cases[0].scene);
}

static void general_goals(struct bench *bench)
{
    struct line(*lines)[2][2] = bench->lines[GENERAL];
    for (int m = 0; m < METHODS; m++)
        if (methods[m].rate > 0)
            bench_goal(bench->goals, GOAL_AT_LEAST, methods[m].rate,
                       rate_ratio(&lines[m][PRECISION_FLOAT][0], &lines[NEAREST][PRECISION_FLOAT][0]),
                       "general engine, rate over nearest's: %s%s, float", methods[m].name, methods[m].settings);
    for (int m = 0; m < METHODS; m++)
        if (m == NEAREST || methods[m].rate > 0)
            bench_goal(bench->goals, GOAL_AT_LEAST, 0.5,
                       rate_ratio(&lines[m][PRECISION_DOUBLE][0], &lines[m][PRECISION_FLOAT][0]),
                       "general engine, double over float: %s%s", methods[m].name, methods[m].settings);
    for (int k = GENERAL + 1; k < CASES; k++) {
        double least[2] = {INFINITY, INFINITY};
        for (int p = 0; p < 2; p++)
            for (int m = 0; m < BRIEF; m++)
                least[p] = fmin(least[p], rate_ratio(&bench->lines[k - 1][m][p][0], &bench->lines[k][m][p][0]));
        for (int p = 0; p < 2 && bench->lines[k][NEAREST][0][0].runs > 0; p++)
            bench_goal(bench->goals, GOAL_AT_LEAST, 1, least[p],
                       "general engine, least rate of any method over %s's: %s, %s", cases[k].isa,
                       k - 1 == GENERAL ? isa_name(isa_choose()) : cases[k - 1].isa, precision_name((enum precision)p));
    }
}

static enum status measure_cases(FILE *file, struct bench_goals *goals)
{
    struct provenance provenance;
    struct bench *bench = calloc(1, sizeof *bench);
    if (!bench)
        return status_set(STATUS_FAILED, "no memory for a table of measurements");
    *bench = (struct bench){.file = file, .goals = goals, .threads = omp_get_max_threads()};
    provenance_fill(&provenance, bench->threads);
    fprintf(file, "# sasbench bench 4\n# machine: %s\n# compiler: %s\n# flags: %s\n# commit: %s\n# date: %s\n",
            provenance.machine, provenance.compiler, provenance.flags, provenance.commit, provenance.date);
    fprintf(file, "scene,engine,isa,algorithm,precision,threads,rows,runs,pairs,plan_s,run_s,sum_s,"
                  "pairs_per_s,peak_flops,flops_per_pair,fraction_of_peak,pairs_per_peak_flop,ratio_to_control,"
                  "run_to_sum,gain_of_threads,plan_bytes,process_bytes\n");
    printf("\n%-17s %-9s %-8s %-28s %-6s %s %7s %7s %7s %6s %7s %7s %6s %6s\n", "scene", "engine", "isa", "algorithm",
           "prec.", "t", "run s", "sums s", "Gpair/s", "peak", "control", "run/sum", "gain", "MiB");
    enum status status = STATUS_OK;
    for (int k = 0; k < CASES && status == STATUS_OK; k++)
        status = bench_case(bench, &cases[k]);
    if (status == STATUS_OK) {
        peak_goals(bench);
        full_goals(bench);
        general_goals(bench);
    }
    free(bench);
    return status;
}

enum status bench_bp(const char *directory, struct bench_goals *goals)
{
    return bench_file(directory, "bench", measure_cases, goals);
}
