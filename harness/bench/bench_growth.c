/* Growth over image sizes and settings (bench_growth.h). */
#include "bench/bench_growth.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <string.h>

#include "echoes/echo_data.h"
#include "measure/imaging.h"
#include "results/provenance.h"
#include "bench/bench.h"
#include "bench/bench_once.h"

static const struct size {
    int columns, rows;
} sizes[] = {{100, 100}, {400, 700}, {1200, 2000}, {2880, 4800}};
enum { SIZES = sizeof sizes / sizeof *sizes, MIDDLE = 1 /* the size whose memory is asked for */ };

/* The general engine takes ten times as long: its time a pair has settled by the third size. */
static const struct subject {
    const char *spec;
    int sizes;
} subjects[] = {
    {"bp_nearest:engine=invariant", SIZES},
    {"bp_linear:engine=invariant", SIZES},
    {"bp_sinc:engine=invariant", SIZES},
    {"bp_zeropad:engine=invariant", SIZES},
    {"bp_farrow:degree=3,engine=invariant", SIZES},
    {"bp_farrow:degree=5,engine=invariant", SIZES},
    {"bp_fitted:taps=6,engine=invariant", SIZES},
    {"bp_nearest:engine=general", 3},
    {"bp_sinc:engine=general", 3},
    {"bp_farrow:degree=3,engine=general", 3},
    {"bp_farrow:degree=5,engine=general", 3},
};

/* Memory over a setting. */
static const struct range {
    const char *format;
    int values[8];
} ranges[] = {
    {"bp_sinc:taps=%d", {2, 4, 8, 16, 32, 64}},
    {"bp_zeropad:factor=%d", {1, 2, 4, 8, 16, 32, 64, 128}},
    {"bp_farrow:degree=%d", {2, 3, 4, 5, 6, 7, 8, 9}},
    {"bp_fitted:factor=%d", {1, 2, 4}},
};

/* As many columns and rows of the grid, from its middle. */
static struct grid middle_of(const struct grid *grid, const struct size *size)
{
    struct grid cut = *grid;
    cut.x_count = size->columns;
    cut.r_count = size->rows;
    cut.x_first += (grid->x_count - cut.x_count) / 2 * grid->x_step;
    cut.r_first += (grid->r_count - cut.r_count) / 2 * grid->r_step;
    return cut;
}

/* A plan alone. */
static enum status plan_measure(const char *text, const struct problem *problem, struct work *work)
{
    struct spec spec;
    struct imaging imaging;
    enum status status = spec_parse(text, &spec);
    if (status != STATUS_OK)
        return status;
    status = imaging_open(&spec, problem, &imaging);
    if (status == STATUS_OK) {
        *work = spec.algorithm->work(imaging.plan);
        imaging_close(&imaging);
    }
    spec_free(&spec);
    return status;
}

/* One line: planned, and where there are echoes, run. setting < 0: none. */
static enum status line_measure(FILE *file, const char *text, const struct problem *problem,
                                const struct echoes *echoes, int setting)
{
    const struct grid *grid = problem->patches;
    struct bench_sample sample = {0};
    struct work work;
    const enum status status = echoes ? bench_once(text, problem, echoes, omp_get_max_threads(), NULL, &work, &sample)
                                      : plan_measure(text, problem, &work);
    if (status != STATUS_OK)
        return status;
    const int name = (int)strcspn(text, ":");
    fprintf(file, "%.*s,\"%s\",%s,", name, text, text + name + (text[name] == ':'), work.engine);
    if (setting >= 0)
        fprintf(file, "%d", setting);
    fprintf(file, ",%d,%d,%.9g,", grid->x_count, grid->r_count, work.pairs);
    if (sample.runs > 0)
        fprintf(file, "%.4g,%.4g", sample.run_s, 1e9 * sample.run_s / work.pairs);
    else
        fprintf(file, ",");
    fprintf(file, ",%.6g\n", work.bytes);
    if (sample.runs > 0)
        printf("%-38s %5d x %-5d %8.3f ns a pair %8.0f MiB\n", text, grid->x_count, grid->r_count,
               1e9 * sample.run_s / work.pairs, work.bytes / 0x1p20);
    fflush(stdout);
    return STATUS_OK;
}

static enum status lines_measure(FILE *file, const struct scene *scene, const struct echoes *echoes)
{
    enum status status = STATUS_OK;
    for (size_t k = 0; k < sizeof subjects / sizeof *subjects; k++)
        for (int n = 0; n < subjects[k].sizes && status == STATUS_OK; n++) {
            const struct grid grid = middle_of(&scene->patches[0], &sizes[n]);
            const struct problem problem = problem_make(&scene->acquisition, 1, &grid, PRECISION_FLOAT);
            status = line_measure(file, subjects[k].spec, &problem, echoes, -1);
        }
    const struct grid grid = middle_of(&scene->patches[0], &sizes[MIDDLE]);
    const struct problem problem = problem_make(&scene->acquisition, 1, &grid, PRECISION_FLOAT);
    for (size_t k = 0; k < sizeof ranges / sizeof *ranges; k++)
        for (int n = 0; n < 8 && ranges[k].values[n] > 0 && status == STATUS_OK; n++) {
            char text[64];
            snprintf(text, sizeof text, ranges[k].format, ranges[k].values[n]);
            status = line_measure(file, text, &problem, NULL, ranges[k].values[n]);
        }
    return status;
}

static enum status growth_measure(FILE *file, struct bench_goals *goals)
{
    (void)goals; /* none */
    struct provenance provenance;
    struct scene scene;
    struct echoes echoes;
    enum status status = bench_scene("bp22/full_limited", &scene, &echoes);
    if (status != STATUS_OK)
        return status;
    provenance_fill(&provenance, omp_get_max_threads());
    printf("\n");
    fprintf(file,
            "# sasbench growth 1\n# machine: %s\n# compiler: %s\n# flags: %s\n# commit: %s\n# date: %s\n# isa: %s\n"
            "algorithm,options,engine,setting,columns,rows,pairs,run_s,ns_per_pair,plan_bytes\n",
            provenance.machine, provenance.compiler, provenance.flags, provenance.commit, provenance.date,
            provenance.isa);
    status = lines_measure(file, &scene, &echoes);
    echoes_free(&echoes);
    scene_free(&scene);
    return status;
}

enum status bench_growth(const char *directory)
{
    return bench_file(directory, "growth", growth_measure, NULL);
}
