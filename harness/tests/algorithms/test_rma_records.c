/* The records of range migration: the lower rate of raw ones, and where they begin. */
#include <complex.h>
#include <fftw3.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/fft_length.h"
#include "common/pulse_band.h"
#include "range_migration/rma_engine.h"
#include "scene/simulate.h"
#include "tests/algorithms/rma_scenes.h"

/* A copy of raw records, compressed at their own rate, without what the lower rate does not carry. */
static struct echoes compress(const struct acquisition *raw, const struct echoes *echoes,
                              const struct acquisition *compressed)
{
    const int samples = raw->samples, length = fft_length_fast((long long)samples + raw->pulse_length - 1);
    struct pulse_band band;
    assert_int_equal(pulse_band_find(raw, length, &band), STATUS_OK);
    const double share = rma_share(raw, &(struct rma_method){.terms = 2, .taps = 16}, band.half_hz);
    assert_true(share < 0.8);
    double complex *filter = pulse_filter(raw, length), *record = fftw_malloc((size_t)length * sizeof *record);
    double complex *made = malloc((size_t)raw->pings * raw->receivers * samples * sizeof *made), *to = made;
    fftw_plan forward = fftw_plan_dft_1d(length, record, record, FFTW_FORWARD, FFTW_ESTIMATE),
              backward = fftw_plan_dft_1d(length, record, record, FFTW_BACKWARD, FFTW_ESTIMATE);
    const double complex *from = echoes->samples;
    for (int k = 0; k < raw->pings * raw->receivers; k++, from += samples, to += samples) {
        memset(record, 0, (size_t)length * sizeof *record);
        memcpy(record, from, (size_t)samples * sizeof *record);
        fftw_execute(forward);
        for (int bin = 0; bin < length; bin++)
            record[bin] *= fabs(pulse_bin_frequency(raw, bin, length)) > share * raw->fs / 2 ? 0 : filter[bin];
        fftw_execute(backward);
        memcpy(to, record, (size_t)samples * sizeof *to);
    }
    fftw_destroy_plan(forward);
    fftw_destroy_plan(backward);
    fftw_free(record);
    fftw_free(filter);
    return (struct echoes){compressed, echoes->precision, made, 0};
}

/* A linear chirp in place of compressed echoes. */
static void make_raw(double duration, struct scene *scene)
{
    struct acquisition *a = &scene->acquisition;
    a->compressed = false;
    scene->pulse_kind = PULSE_LFM;
    scene->pulse_duration = duration;
    a->pulse_length = pulse_length_lfm(duration, a->fs);
    a->pulse = calloc((size_t)a->pulse_length, sizeof *a->pulse);
    pulse_lfm(a->bandwidth, duration, a->fs, a->pulse_length, a->pulse);
}

/* Raw records are compressed to a lower rate where their band allows it: the image is that of records compressed at
   full rate but for the smear of blocks' edges and for what the taps leave. */
static void lower_rate(void **state)
{
    (void)state;
    static const struct {
        const char *spec;
        double bound;
    } runs[] = {{"rma_numeric:blocks=1,precision=double", 2e-4},
                {"rma_lbf:blocks=6,precision=double", 2e-4},
                {"rma_lbf:blocks=6,blend=off,precision=double", 3e-4},
                {"rma_pca:sum=after,precision=double", 2e-4},
                {"rma_delay:precision=double", 3e-4},
                {"rma_delay", 3e-4},
                {"rma_chirp:precision=double", 3e-4}};
    static const double targets[] = {60.2, 64.1};
    static const struct grid part = {-0.14, 0.02, 15, 59, 0.02, 300};
    struct scene scene;
    struct echoes raw;
    make_scene(&(struct rma_track){12, 24, 1100, 40e3, 2900 / 40e3, -5.5 * 24 * 0.02, 24 * 0.02, 0.04}, &scene);
    struct acquisition *a = &scene.acquisition, full = *a;
    add_targets(&scene, 2, targets);
    make_raw(10e-3, &scene);
    assert_int_equal(scene_simulate(&scene, &raw), STATUS_OK);
    struct echoes compressed = compress(a, &raw, &full);
    const struct problem problem = problem_make(a, 1, &part, PRECISION_DOUBLE),
                         given = problem_make(&full, 1, &part, PRECISION_DOUBLE);
    for (size_t k = 0; k < sizeof runs / sizeof *runs; k++) {
        struct image image;
        form(runs[k].spec, given, &compressed, &image);
        print_message("    %.2f of the memory:\n",
                      support_work(runs[k].spec, problem).bytes / support_work(runs[k].spec, given).bytes);
        assert_up_to(swath_error(runs[k].spec, problem, &raw, &image), runs[k].bound, "%s", runs[k].spec);
        image_free(&image);
    }
    free((void *)compressed.samples);
    echoes_free(&raw);
    free_scene(&scene);
}

/* Records that begin where the first row does: the flanks of pulses before it are kept at a lower rate. */
static void begin(void **state)
{
    (void)state;
    static const char *const specs[] = {"rma_numeric", "rma_delay", "rma_chirp", "rma_lbf:blocks=6"};
    static const double targets[] = {61.1, 65};
    static const struct grid part = {-0.14, 0.02, 15, 60, 0.1, 90};
    struct scene scene;
    struct echoes raw;
    struct image exact;
    make_scene(&(struct rma_track){12, 24, 1400, 40e3, 3200 / 40e3, -5.5 * 24 * 0.02, 24 * 0.02, 0.04}, &scene);
    scene.acquisition.bandwidth = 5e3;
    add_targets(&scene, 2, targets);
    make_raw(20e-3, &scene);
    assert_int_equal(scene_simulate(&scene, &raw), STATUS_OK);
    const struct problem problem = problem_make(&scene.acquisition, 1, &part, PRECISION_DOUBLE);
    form("reference:precision=double", problem, &raw, &exact);
    for (size_t k = 0; k < sizeof specs / sizeof *specs; k++)
        assert_up_to(swath_error(specs[k], problem, &raw, &exact), 2e-3, "%s", specs[k]);
    image_free(&exact);
    echoes_free(&raw);
    free_scene(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(lower_rate), cmocka_unit_test(begin)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
