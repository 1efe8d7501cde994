/* `bench NAME`: any algorithm of the list, at the first of the papers' sizes that it takes. As in bench.c, everything
   is a ratio of one run, and printed are medians of several rounds. */
#include "bench/bench_algorithms.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/peak.h"
#include "echoes/echo_data.h"
#include "files/paths.h"
#include "files/text_file.h"
#include "measure/imaging.h"
#include "results/provenance.h"
#include "measure/timing.h"
#include "scene/scene.h"
#include "scene/simulate.h"
#include "bench/fft_seconds.h"

enum { ROUNDS = 3 };

/* Tried in this order. */
static const struct candidate {
    const char *scene;
    int rows;   /* evenly spaced over the swath; 0: all */
    bool exact; /* exact algorithms, too, which are slow */
    bool pairs; /* only algorithms that sum pairs: others cost as much for few rows as for all */
} candidates[] = {
    {"bp22/full_limited", 64, false, true}, /* back projection */
    {"lbf21/real_size", 0, false, false},   /* range migration */
    {"sq18/full_20", 0, false, false},      /* omega-k */
    {"sweep/speckle", 0, true, false},
};
enum { CANDIDATES = sizeof candidates / sizeof *candidates };

/* A scene with its echoes. */
struct loaded {
    struct scene scene;
    struct grid grid;
    struct echoes echoes[2]; /* by enum precision */
};

static void loaded_close(struct loaded *loaded)
{
    echoes_free(&loaded->echoes[PRECISION_DOUBLE]);
    echoes_free(&loaded->echoes[PRECISION_FLOAT]);
    scene_free(&loaded->scene);
}

static struct problem loaded_problem(const struct loaded *loaded, enum precision precision)
{
    return problem_make(&loaded->scene.acquisition, 1, &loaded->grid, precision);
}

static struct grid candidate_grid(const struct candidate *candidate, const struct scene *scene)
{
    struct grid grid = scene->patches[0];
    if (candidate->rows > 0) {
        grid.r_step *= (double)grid.r_count / candidate->rows;
        grid.r_count = candidate->rows;
    }
    return grid;
}

/* *loaded is to be closed when it went well. */
static enum status loaded_open(const struct candidate *candidate, struct loaded *loaded)
{
    *loaded = (struct loaded){0};
    enum status status = scene_load(candidate->scene, SCENE_DIRECTORY, &loaded->scene);
    if (status != STATUS_OK)
        return status;
    loaded->grid = candidate_grid(candidate, &loaded->scene);
    status = scene_simulate(&loaded->scene, &loaded->echoes[PRECISION_DOUBLE]);
    if (status == STATUS_OK)
        status = echoes_convert(&loaded->echoes[PRECISION_DOUBLE], PRECISION_FLOAT, &loaded->echoes[PRECISION_FLOAT]);
    if (status != STATUS_OK)
        loaded_close(loaded);
    return status;
}

/* Whether an algorithm takes the problem, without its echoes: its plan and its work say so. */
static enum status candidate_try(const struct spec *spec, const struct candidate *candidate)
{
    struct scene scene;
    struct imaging imaging;
    enum status status = scene_load(candidate->scene, SCENE_DIRECTORY, &scene);
    if (status != STATUS_OK)
        return status;
    struct grid grid = candidate_grid(candidate, &scene);
    struct problem problem = problem_make(&scene.acquisition, 1, &grid, spec->precision);
    status = imaging_open(spec, &problem, &imaging);
    if (status == STATUS_OK) {
        if (candidate->pairs && !(imaging.algorithm->work(imaging.plan).pairs > 0))
            status = status_set(STATUS_UNSUPPORTED, "%s sums no pairs", spec->algorithm->name);
        imaging_close(&imaging);
    }
    scene_free(&scene);
    return status;
}

static enum status candidate_find(const struct spec *spec, const struct candidate **found)
{
    enum status status = STATUS_UNSUPPORTED;
    for (int k = 0; k < CANDIDATES && status == STATUS_UNSUPPORTED; k++) {
        *found = &candidates[k];
        if (candidates[k].exact || !(spec->algorithm->traits & TRAIT_EXACT))
            status = candidate_try(spec, &candidates[k]);
    }
    return status;
}

/* One line of the table: medians over the rounds. */
struct line {
    int threads;
    double run_s[ROUNDS], plan_s[ROUNDS], control[ROUNDS], peak[ROUNDS]; /* control: its time by ours */
    struct timing timing;                                                /* of the last round */
    struct fft_seconds fft;                                              /* NAN where it is no measure */
};

static enum status line_measure(const struct spec *spec, const struct loaded *loaded, int threads, struct line *line)
{
    const int all = omp_get_max_threads();
    const struct problem problem = loaded_problem(loaded, spec->precision);
    enum status status = STATUS_OK;
    line->threads = threads;
    omp_set_num_threads(threads);
    for (int round = 0; round < ROUNDS && status == STATUS_OK; round++) {
        struct image image = {0};
        double peak = peak_flops(spec->precision, threads);
        struct control control = control_begin(&problem, &loaded->echoes[PRECISION_FLOAT]);
        status = timing_measure(spec, &problem, &loaded->echoes[spec->precision], &control, EFFORT_WHOLE, NULL, &image,
                                &line->timing);
        control_end(&control);
        line->peak[round] = (peak + peak_flops(spec->precision, threads)) / 2;
        line->run_s[round] = line->timing.run_s;
        line->plan_s[round] = line->timing.plan_s;
        line->control[round] = line->timing.control_s / line->timing.run_s;
        image_free(&image);
    }
    omp_set_num_threads(all);
    line->fft = (struct fft_seconds){NAN, NAN, NAN};
    const struct acquisition *a = &loaded->scene.acquisition;
    if (status == STATUS_OK && line->timing.work.pairs == 0 && spec->precision == PRECISION_FLOAT)
        status = fft_seconds(a->pings * a->receivers, a->samples, threads, &line->fft);
    return status;
}

/* The whole run, and what follows the range compression, in FFTW's transforms of as many values as were recorded. */
static void fft_ratios(const struct line *line, double run_s, double *whole, double *after)
{
    double sum = 0, compress = 0;
    for (int k = 0; k < line->timing.stages.count; k++) {
        sum += line->timing.stages.stage[k].seconds;
        compress +=
            strcmp(line->timing.stages.stage[k].name, "compress") == 0 ? line->timing.stages.stage[k].seconds : 0;
    }
    *whole = run_s / line->fft.best;
    *after = *whole * (1 - compress / sum);
}

/* `alone`: the same on one thread. */
static void line_write(FILE *file, const struct spec *spec, const struct loaded *loaded, struct line *line,
                       const struct line *alone)
{
    const struct work *work = &line->timing.work;
    const double run_s = median(line->run_s, ROUNDS), plan_s = median(line->plan_s, ROUNDS);
    const double rate = work->flops / run_s, fraction = rate / median(line->peak, ROUNDS);
    const double control = median(line->control, ROUNDS), gain = alone->run_s[ROUNDS / 2] / run_s; /* sorted by then */
    char name[300];
    snprintf(name, sizeof name, "%s%s%s", spec->algorithm->name, *spec->text ? ":" : "", spec->text);
    double whole, after;
    fft_ratios(line, run_s, &whole, &after);
    fprintf(file, "%s,%s,\"%s\",%s,%d,%d,%d,%.4g,%.4g,%.9g,%.4g,%.4g,%.9g,%.4g,%.4g,%.4g,%.6g,%.4g,%.4g,%.4g,%.4g\n",
            loaded->scene.name, spec->algorithm->name, spec->text, precision_name(spec->precision), line->threads,
            loaded->grid.x_count, loaded->grid.r_count, plan_s, run_s, work->flops, rate, fraction, work->pairs,
            work->pairs / run_s, control, gain, work->bytes, line->fft.plan, line->fft.strips, whole, after);
    printf("%-17s %-28s %-6s %2d %8.4g %8.4g %7.2f %6.3f %7.3f %8.3g %6.2f\n", loaded->scene.name, name,
           precision_name(spec->precision), line->threads, plan_s, run_s, 1e-9 * rate, fraction,
           1e-9 * work->pairs / run_s, control, gain);
    if (isfinite(whole))
        printf("    %.3g of FFTW's forward and inverse transforms of as many values as were recorded, %.3g after range "
               "compression (one plan %.4g s, strips %.4g s)\n",
               whole, after, line->fft.plan, line->fft.strips);
    fflush(stdout);
}

static enum status spec_bench(FILE *file, const struct spec *spec)
{
    const struct candidate *candidate;
    struct loaded loaded;
    struct line alone = {0}, together = {0};
    enum status status = candidate_find(spec, &candidate);
    if (status == STATUS_OK)
        status = loaded_open(candidate, &loaded);
    if (status != STATUS_OK)
        return status;
    status = line_measure(spec, &loaded, 1, &alone);
    if (status == STATUS_OK)
        line_write(file, spec, &loaded, &alone, &alone);
    if (status == STATUS_OK && omp_get_max_threads() > 1)
        status = line_measure(spec, &loaded, omp_get_max_threads(), &together);
    if (status == STATUS_OK && omp_get_max_threads() > 1)
        line_write(file, spec, &loaded, &together, &alone);
    loaded_close(&loaded);
    return status;
}

/* In the precision that it names, or in both. */
static enum status text_bench(FILE *file, const char *text)
{
    struct spec given, varied;
    enum status status = spec_parse(text, &given);
    if (status != STATUS_OK)
        return status;
    if (spec_given(&given, "precision"))
        status = spec_bench(file, &given);
    for (int p = 0; p < 2 && !spec_given(&given, "precision") && status == STATUS_OK; p++) {
        status = spec_vary(&given, "precision", precision_name((enum precision)p), &varied);
        if (status == STATUS_OK) {
            status = spec_bench(file, &varied);
            spec_free(&varied);
        }
    }
    spec_free(&given);
    return status;
}

static void head_write(FILE *file)
{
    struct provenance provenance;
    provenance_fill(&provenance, omp_get_max_threads());
    fprintf(
        file,
        "# sasbench bench_algorithms 2\n# machine: %s\n# compiler: %s\n# flags: %s\n# commit: %s\n# date: %s\n"
        "# isa: %s\n"
        "scene,algorithm,options,precision,threads,columns,rows,plan_s,run_s,flops,flops_per_s,fraction_of_peak,pairs,"
        "pairs_per_s,ratio_to_control,gain_of_threads,plan_bytes,fft_plan_s,fft_strips_s,run_to_fft,after_to_fft\n",
        provenance.machine, provenance.compiler, provenance.flags, provenance.commit, provenance.date, provenance.isa);
    printf("%-17s %-28s %-6s %2s %8s %8s %7s %6s %7s %8s %6s\n", "scene", "algorithm", "prec.", "t", "plan s", "run s",
           "GFLOP/s", "peak", "Gpair/s", "control", "gain");
}

enum status bench_algorithms(const char *directory, const char *const *specs, int count)
{
    char path[4096];
    struct text_file file;
    snprintf(path, sizeof path, "%s/bench_algorithms.csv", directory);
    enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    head_write(file.stream);
    for (int k = 0; k < count && status == STATUS_OK; k++)
        status = text_bench(file.stream, specs[k]);
    status = text_file_close(&file, status);
    if (status == STATUS_OK)
        printf("\nResults: %s\n", path);
    return status;
}
