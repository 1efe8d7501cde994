/* Range migration in `bench`: LBF21's real-data size, 8 range blocks, float, all threads, everything in one run. */
#define _GNU_SOURCE /* sincos */
#include "bench/bench_rma.h"

#include <fftw3.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "echoes/echo_data.h"
#include "files/text_file.h"
#include "measure/spec.h"
#include "measure/imaging.h"
#include "measure/timing.h"
#include "bench/bench_once.h"
#include "bench/fft_seconds.h"

enum {
    BLOCKS = 8,
    RECEIVERS = 48,
    AZIMUTH = 3840,
    RANGE = 4096,    /* 80 pings of 48 receivers at full rate */
    BINS = RANGE / 2 /* the pulse's band */
};

/* What a stage is counted as; a name that is not here comes before the phases. */
static const char *const phase_stages[] = {"bulk", "differential", NULL};
static const char *const later_stages[] = {"reconstruct", "stolt", "focus", "inverse", NULL};

/* Of stages of these names; NULL: of all. */
static double stages_seconds(const struct stages *stages, const char *const *names)
{
    double sum = 0;
    for (int k = 0; k < stages->count; k++) {
        bool counts = !names;
        for (const char *const *name = names; name && *name; name++)
            counts = counts || strcmp(stages->stage[k].name, *name) == 0;
        sum += counts ? stages->stage[k].seconds : 0;
    }
    return sum;
}

/* One SPEC at the whole size: warmed up and repeated, or a single execution. */
static enum status image_seconds(const char *text, const struct problem *problem, const struct echoes *echoes,
                                 bool repeated, struct timing *timing)
{
    struct spec spec;
    struct image image = {0};
    struct imaging imaging;
    enum status status = spec_parse(text, &spec);
    if (status != STATUS_OK)
        return status;
    if (repeated) {
        struct control control = control_begin(problem, echoes);
        status = timing_measure(&spec, problem, echoes, &control, EFFORT_WHOLE, NULL, &image, timing);
        control_end(&control);
    } else {
        status = imaging_open(&spec, problem, &imaging);
        if (status == STATUS_OK) {
            stages_begin(&timing->stages);
            status = imaging_execute(&imaging, echoes, &timing->stages);
            imaging_close(&imaging);
        }
    }
    image_free(&image);
    spec_free(&spec);
    return status;
}

/* What libm takes for nothing but the sine and the cosine of as many cells as one range block has in the pulse's
   band, in float and in double: timed on one receiver's. */
static void sincos_seconds(double seconds[2])
{
    double sum = 0;
    for (int precision = 0; precision < 2; precision++) {
        double begin = seconds_now();
#pragma omp parallel for reduction(+ : sum)
        for (int line = 0; line < AZIMUTH; line++)
            for (int k = 0; k < BINS; k++) {
                double angle = 6.28 * ((double)k / BINS - 0.5) + 1e-5 * line, s, c;
                float angle_float = (float)angle, s_float, c_float;
                if (precision == PRECISION_DOUBLE) {
                    sincos(angle, &s, &c);
                    sum += s + c;
                } else {
                    sincosf(angle_float, &s_float, &c_float);
                    sum += s_float + c_float;
                }
            }
        seconds[precision] = RECEIVERS * (seconds_now() - begin);
    }
    volatile double used = sum; /* or nothing would be computed */
    (void)used;
}

struct measured {
    struct timing eight, one, libm, delay; /* rma_lbf with as many blocks, and one by libm; rma_delay */
    struct fft_seconds fft;
    double cells[2];    /* s, by precision: sincos_seconds */
    double delay_share; /* of rma_delay's time: after its range compression */
};

static enum status measure(const struct problem *problem, const struct echoes *echoes, struct measured *m)
{
    static const char *const compression[] = {"compress", NULL};
    *m = (struct measured){.delay_share = 1};
    enum status status = image_seconds("rma_lbf:blocks=8", problem, echoes, true, &m->eight);
    if (status == STATUS_OK)
        status = image_seconds("rma_lbf:blocks=1", problem, echoes, true, &m->one);
    if (status == STATUS_OK)
        status = image_seconds("rma_lbf:blocks=1,phases=libm", problem, echoes, false, &m->libm);
    if (status == STATUS_OK)
        status = image_seconds("rma_delay", problem, echoes, true, &m->delay);
    if (status == STATUS_OK)
        status = fft_seconds(AZIMUTH, RANGE, omp_get_max_threads(), &m->fft);
    if (status != STATUS_OK)
        return status;
    m->delay_share -= stages_seconds(&m->delay.stages, compression) / stages_seconds(&m->delay.stages, NULL);
    sincos_seconds(m->cells);
    return STATUS_OK;
}

static void report(const struct measured *m, FILE *file, struct bench_goals *goals)
{
    const int threads = omp_get_max_threads();
    const double run = m->eight.run_s, phase = stages_seconds(&m->eight.stages, phase_stages);
    const double later = stages_seconds(&m->eight.stages, later_stages);
    const double one_phase = stages_seconds(&m->one.stages, phase_stages);
    const double libm_phase = stages_seconds(&m->libm.stages, phase_stages);
    const double delay = m->delay.run_s, delay_later = m->delay_share * delay;
    const struct fft_seconds fft = m->fft;
    const double *const cells = m->cells;
    const struct {
        const char *name, *unit, *meaning;
        double value;
    } rows[] = {
        {"run", "s", "8 range blocks, median", run},
        {"phase", "s", "of it the phase stage (bulk and differential)", phase},
        {"after", "s", "of it everything after the phase stage", later},
        {"after_share", "1", "share of the run (0.40 at most)", later / run},
        {"phase_one", "s", "phase stage with one range block", one_phase},
        {"phase_one_libm", "s", "the same by formula and libm for each cell", libm_phase},
        {"phase_ratio", "1", "how much slower that is (10 at least)", libm_phase / one_phase},
        {"phase_ratio_blocks", "1", "and with 8 blocks, each as long as the one", BLOCKS * libm_phase / phase},
        {"sincos_double", "s", "sines and cosines alone, of one block's cells: libm in double",
         cells[PRECISION_DOUBLE]},
        {"sincos_float", "s", "and libm in float", cells[PRECISION_FLOAT]},
        {"sincos_ratio", "1", "libm's double ones alone, to the whole phase stage",
         cells[PRECISION_DOUBLE] / one_phase},
        {"fft2", "s", "FFTW, 2-D forward and inverse of 3840 x 4096 by one plan, best of five", fft.plan},
        {"fft2_strips", "s", "the same by rows, and by columns in copied strips", fft.strips},
        {"run_ratio", "1", "run in the faster of these transforms", run / fft.best},
        {"delay_run", "s", "rma_delay, median", delay},
        {"delay_ratio", "1", "rma_delay's run in the faster of these transforms", delay / fft.best},
        {"delay_after_ratio", "1", "and what follows its range compression", delay_later / fft.best},
    };
    fprintf(file, "# sasbench bench_rma 2\n# threads: %d\nscene,algorithm,precision,quantity,unit,value\n", threads);
    printf("\nRange migration of LBF21's real-data size, float, %d threads\n", threads);
    bench_goal(goals, GOAL_AT_MOST, 12, run / fft.best,
               "rma_lbf, 8 blocks, run over FFTW's transforms: lbf21/real_size");
    bench_goal(goals, GOAL_AT_MOST, 4, delay / fft.best, "rma_delay, run over FFTW's transforms: lbf21/real_size");
    bench_goal(goals, GOAL_AT_MOST, 2, delay_later / fft.best,
               "rma_delay, after range compression, over FFTW's transforms: lbf21/real_size");
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        fprintf(file, "lbf21/real_size,%s,float,%s,%s,%.6g\n",
                strncmp(rows[k].name, "delay", 5) == 0 ? "rma_delay" : "rma_lbf", rows[k].name, rows[k].unit,
                rows[k].value);
        printf("%9.4g %-2s %s\n", rows[k].value, strcmp(rows[k].unit, "s") == 0 ? "s" : "", rows[k].meaning);
    }
    fflush(stdout);
}

enum status bench_rma(const char *directory, struct bench_goals *goals)
{
    char path[4096];
    struct scene scene;
    struct echoes echoes;
    snprintf(path, sizeof path, "%s/bench_rma.csv", directory);
    struct text_file file;
    enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    status = bench_scene("lbf21/real_size", &scene, &echoes);
    if (status == STATUS_OK) {
        struct problem problem = scene_problem(&scene, PRECISION_FLOAT);
        struct measured measured;
        status = measure(&problem, &echoes, &measured);
        if (status == STATUS_OK)
            report(&measured, file.stream, goals);
        echoes_free(&echoes);
        scene_free(&scene);
    }
    status = text_file_close(&file, status);
    if (status == STATUS_OK)
        printf("Results: %s\n", path);
    return status;
}
