/* Omega-k in `bench` (bench_wk.h): float, all threads, everything in one run. */
#include "bench/bench_wk.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "echoes/echo_data.h"
#include "files/text_file.h"
#include "measure/timing.h"
#include "bench/bench_once.h"
#include "bench/fft_seconds.h"

enum { AZIMUTH = 3840, RANGE = 4096 };

/* Median seconds of a SPEC on a problem. */
static enum status spec_seconds(const char *text, const struct problem *problem, const struct echoes *echoes,
                                double *seconds)
{
    struct spec spec;
    struct image image = {0};
    struct timing timing;
    enum status status = spec_parse(text, &spec);
    if (status != STATUS_OK)
        return status;
    struct control control = control_begin(problem, echoes);
    status = timing_measure(&spec, problem, echoes, &control, EFFORT_WHOLE, NULL, &image, &timing);
    control_end(&control);
    if (status == STATUS_OK)
        *seconds = timing.run_s;
    image_free(&image);
    spec_free(&spec);
    return status;
}

struct bench_case {
    const char *scene, *spec, *meaning;
    double most; /* goal: in FFTW's transforms by one plan; 0: none */
};

/* In one run, one scene after the other: what a squint costs each of them. */
static const struct bench_case cases[] = {
    {"sq18/full_00", "wk_classic", "broadside, 3840 columns of 4096 samples", 3},
    {"sq18/full_20", "wk_squint", "20 degrees, axes turned", 0},
    {"sq18/full_20", "wk_classic:unfold=support", "20 degrees, the support unfolded", 0},
    {"sq18/full_20", "wk_classic:unfold=baseband", "20 degrees, zeros after basebanding", 0},
    {"sq18/full_20", "wk_classic:unfold=stuff", "20 degrees, zeros to the full band", 0},
};

static enum status case_measure(const struct bench_case *c, const struct fft_seconds *transform, FILE *file,
                                struct bench_goals *goals)
{
    struct scene scene;
    struct echoes echoes;
    double seconds = 0;
    enum status status = bench_scene(c->scene, &scene, &echoes);
    if (status != STATUS_OK)
        return status;
    const struct problem problem = scene_problem(&scene, PRECISION_FLOAT);
    status = spec_seconds(c->spec, &problem, &echoes, &seconds);
    echoes_free(&echoes);
    scene_free(&scene);
    if (status == STATUS_OK) {
        fprintf(file, "%s,%s,float,run,s,%.6g\n", c->scene, c->spec, seconds);
        fprintf(file, "%s,%s,float,run_ratio,1,%.6g\n", c->scene, c->spec, seconds / transform->plan);
        fprintf(file, "%s,%s,float,run_ratio_strips,1,%.6g\n", c->scene, c->spec, seconds / transform->strips);
        printf("%9.4g s %7.3g x %7.3g x  %-28s %s\n", seconds, seconds / transform->plan, seconds / transform->strips,
               c->spec, c->meaning);
        if (c->most > 0)
            bench_goal(goals, GOAL_AT_MOST, c->most, seconds / transform->plan, "%s, run over FFTW's transforms: %s",
                       c->spec, c->scene);
        fflush(stdout);
    }
    return status;
}

enum status bench_wk(const char *directory, struct bench_goals *goals)
{
    char path[4096];
    struct text_file file;
    struct fft_seconds transform;
    snprintf(path, sizeof path, "%s/bench_wk.csv", directory);
    enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    const int threads = omp_get_max_threads();
    status = fft_seconds(AZIMUTH, RANGE, threads, &transform);
    if (status == STATUS_OK) {
        fprintf(file.stream, "# sasbench bench_wk 1\n# threads: %d\nscene,algorithm,precision,quantity,unit,value\n",
                threads);
        fprintf(file.stream, "sq18/full_00,fftw,float,fft2,s,%.6g\nsq18/full_00,fftw,float,fft2_strips,s,%.6g\n",
                transform.plan, transform.strips);
        printf(
            "\nOmega-k at %d x %d, float, %d threads, in units of FFTW's forward and inverse transform: %.4g s by one "
            "plan, %.4g s by rows and copied strips of columns\n",
            AZIMUTH, RANGE, threads, transform.plan, transform.strips);
    }
    for (size_t k = 0; status == STATUS_OK && k < sizeof cases / sizeof *cases; k++)
        status = case_measure(&cases[k], &transform, file.stream, goals);
    status = text_file_close(&file, status);
    if (status == STATUS_OK)
        printf("Results: %s\n", path);
    return status;
}
