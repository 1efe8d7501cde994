/* The library as other programs see it: its images against those of the harness, its errors, its threads. */
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "tests/assertions.h"
#include "echoes/echo_data.h"
#include "files/paths.h"
#include "imaging/imaging.h"
#include "library/libsasbench.h"
#include "scene/simulate.h"
#include "tests/support.h"

static struct sasbench *context;

static int begin(void **state)
{
    (void)state;
    return sasbench_open(2, data_path(DATA_SCENES), &context);
}

static int end(void **state)
{
    (void)state;
    sasbench_close(context);
    return 0;
}

static struct sasbench_scene *scene_of(const char *name)
{
    struct sasbench_scene *scene;
    if (sasbench_scene_load(context, name, &scene) != SAS_OK)
        fail_msg("%s", sasbench_message());
    return scene;
}

static void *room(const struct sasbench_scene *scene, bool image)
{
    const struct sas_acquisition *a = sasbench_scene_arrays(scene)->acquisition;
    const struct sas_grid *g = sasbench_scene_arrays(scene)->patches;
    const size_t pixels = (size_t)g->x_count * (size_t)g->r_count,
                 samples = (size_t)a->pings * (size_t)a->receivers * (size_t)a->samples;
    return calloc(image ? pixels : samples, sizeof(double complex));
}

/* What the program's `image` calls. */
static void image_expect(const char *name, const char *text, const void *pixels)
{
    struct scene scene;
    struct spec spec;
    struct echoes both, echoes;
    struct image image;
    assert_int_equal(scene_load(name, data_path(DATA_SCENES), &scene), STATUS_OK);
    assert_int_equal(spec_asked(text, &spec), STATUS_OK);
    assert_int_equal(scene_simulate(&scene, &both), STATUS_OK);
    assert_int_equal(echoes_convert(&both, spec.precision, &echoes), STATUS_OK);
    const struct problem problem = scene_problem(&scene, spec.precision);
    assert_int_equal(imaging_form(&spec, &problem, &echoes, &image, NULL), STATUS_OK);
    const size_t count = (size_t)scene.patches[0].x_count * (size_t)scene.patches[0].r_count;
    assert_memory_equal(image.pixels[0], pixels, count * precision_size(spec.precision));
    image_free(&image);
    echoes_free(&echoes);
    echoes_free(&both);
    spec_free(&spec);
    scene_free(&scene);
}

struct task {
    struct sasbench_scene *scene;
    const char *spec;
    void *pixels;
    int status;
};

static void *task_run(void *data)
{
    struct task *task = data;
    struct sasbench_plan *plan = NULL;
    void *samples = room(task->scene, false);
    task->status = sasbench_echoes(task->scene, SAS_DOUBLE, samples);
    if (task->status == SAS_OK)
        task->status = sasbench_plan(task->scene, task->spec, SAS_FLOAT, &plan);
    for (int k = 0; k < 3 && task->status == SAS_OK; k++)
        task->status = sasbench_execute(plan, SAS_DOUBLE, samples, &task->pixels);
    sasbench_plan_free(plan);
    free(samples);
    return NULL;
}

/* Two threads at once, on one scene, each plan executed again and again. */
static void images_are_the_programs(void **state)
{
    (void)state;
    static const char *const specs[] = {"bp_sinc",   "bp_farrow:precision=double", "bp_factorised", "rma_lbf",
                                        "rma_pca",   "rma_delay:precision=double", "bp_linear",     "reference",
                                        "bp_fitted", "monostatic | wk_squint"};
    enum { COUNT = sizeof specs / sizeof *specs };
    struct sasbench_scene *scene = scene_of("study/quick");
    for (int k = 0; k < COUNT; k += 2) {
        struct task tasks[2] = {{scene, specs[k], room(scene, true), 0}, {scene, specs[k + 1], room(scene, true), 0}};
        pthread_t threads[2];
        for (int n = 0; n < 2; n++)
            assert_int_equal(pthread_create(&threads[n], NULL, task_run, &tasks[n]), 0);
        for (int n = 0; n < 2; n++)
            pthread_join(threads[n], NULL);
        for (int n = 0; n < 2; n++) { /* alone: this plans with FFTW outside the library's turns */
            assert_int_equal(tasks[n].status, SAS_OK);
            image_expect("study/quick", tasks[n].spec, tasks[n].pixels);
            free(tasks[n].pixels);
        }
    }
    sasbench_scene_free(scene);
}

/* <A x, y> = <x, A' y>; more is in test_python.py. */
static void operators_are_adjoint(void **state)
{
    (void)state;
    struct sasbench_scene *scene = scene_of("study/sway");
    const struct sas_acquisition *a = sasbench_scene_arrays(scene)->acquisition;
    const struct sas_grid *g = sasbench_scene_arrays(scene)->patches;
    const int pixels = g->x_count * g->r_count, samples = a->pings * a->receivers * a->samples;
    double complex *x = room(scene, true), *back = room(scene, true), *y = room(scene, false),
                   *forward = room(scene, false);
    for (int k = 0; k < pixels; k++)
        x[k] = cexp(I * k * k);
    for (int k = 0; k < samples; k++)
        y[k] = cexp(2 * I * k * sin(k));
    assert_int_equal(sasbench_forward(scene, (const void *const[]){x}, forward), SAS_OK);
    assert_int_equal(sasbench_adjoint(scene, y, (void *const[]){back}), SAS_OK);
    double complex left = 0, right = 0;
    double norm = 0;
    for (int k = 0; k < samples; k++) {
        left += forward[k] * conj(y[k]);
        norm += creal(forward[k] * conj(forward[k]));
    }
    for (int k = 0; k < pixels; k++)
        right += x[k] * conj(back[k]);
    assert_true(norm > 1 && cabs(left - right) <= 1e-12 * sqrt(norm * samples));
    y[3] = NAN;
    assert_int_equal(sasbench_adjoint(scene, y, (void *const[]){back}), SAS_INVALID);
    x[3] = NAN;
    assert_int_equal(sasbench_forward(scene, (const void *const[]){x}, forward), SAS_INVALID);
    assert_non_null(strstr(sasbench_message(), "pixel 3 of"));
    free(x);
    free(back);
    free(y);
    free(forward);
    sasbench_scene_free(scene);
}

/* A scene of another's arrays and echoes images alike; an array that does not fit is named. */
static void scenes_are_made_of_arrays(void **state)
{
    (void)state;
    struct sasbench_scene *scene = scene_of("study/quick"), *made;
    struct sasbench_plan *plan;
    struct sasbench_arrays arrays = *sasbench_scene_arrays(scene);
    struct sas_acquisition acquisition = *arrays.acquisition;
    double *samples = room(scene, false);
    void *pixels = room(scene, true);
    assert_int_equal(sasbench_echoes(scene, SAS_DOUBLE, samples), SAS_OK);
    arrays.samples = samples;
    arrays.acquisition = &acquisition;
    assert_int_equal(sasbench_scene_make(context, &arrays, &made), SAS_OK);
    assert_int_equal(sasbench_plan(made, "bp_sinc", SAS_DOUBLE, &plan), SAS_OK);
    assert_int_equal(sasbench_plan_precision(plan), SAS_DOUBLE);
    assert_int_equal(sasbench_execute(plan, SAS_DOUBLE, samples, &pixels), SAS_OK);
    image_expect("study/quick", "bp_sinc:precision=double", pixels);
    samples[5] = NAN;
    assert_int_equal(sasbench_execute(plan, SAS_DOUBLE, samples, &pixels), SAS_INVALID);
    assert_string_equal(sasbench_message(),
                        "echoes: sample 2 of receiver 0 in ping 0 has nan; finite numbers are needed");
    sasbench_plan_free(plan);
    sasbench_scene_free(made);
    struct sasbench_scene *none;
    acquisition.sampling_hz = -1;
    samples[5] = 0;
    assert_int_equal(sasbench_scene_make(context, &arrays, &none), SAS_INVALID);
    assert_null(none);
    assert_non_null(strstr(sasbench_message(), "study/quick"));
    acquisition.rx_m = NULL;
    assert_int_equal(sasbench_scene_make(context, &arrays, &none), SAS_INVALID);
    free(samples);
    free(pixels);
    sasbench_scene_free(scene);
}

static int refuse(const struct sas_problem *problem, void **plan)
{
    (void)plan;
    return (problem->host->fail)(SAS_UNSUPPORTED, "%d pings are too many", problem->acquisition->pings);
}

static int execute(void *plan, const void *samples, void *const *pixels, void *run)
{
    (void)plan, (void)samples, (void)pixels, (void)run;
    return SAS_FAILED;
}

static void work(const void *plan, struct sas_work *out)
{
    (void)plan, (void)out;
}

static void destroy(void *plan)
{
    (void)plan;
}

static int column(const char *name)
{
    int k = 0, type;
    for (const char *at; (at = sasbench_column(SASBENCH_MEASUREMENTS, k, &type)) && strcmp(at, name) != 0;)
        k++;
    return k;
}

/* Rows of the program's algorithms and of the caller's, of an image that is scored; refusals are rows. */
static void rows_are_measured(void **state)
{
    (void)state;
    struct sasbench_scene *scene = scene_of("study/quick");
    struct sasbench_table *table;
    const struct sas_algorithm own = {sizeof own, SAS_ABI, "refuses", "none", 0,      0,
                                      NULL,       refuse,  execute,   work,   destroy};
    void *pixels = room(scene, true);
    assert_int_equal(sasbench_table(&table), SAS_OK);
    assert_int_equal(sasbench_run(scene, "bp_sinc", SAS_FLOAT, NULL, 0, table), SAS_OK);
    assert_int_equal(sasbench_run(scene, "mine", SAS_DOUBLE, &own, 0, table), SAS_OK);
    assert_int_equal(sasbench_score(scene, "zero", SAS_DOUBLE, (const void *const *)&pixels, NAN, table), SAS_OK);
    assert_int_equal(sasbench_table_count(table, SASBENCH_MEASUREMENTS), 3);
    const int error = column("error"), reason = column("reason"), status = column("status");
    assert_true(sasbench_table_number(table, SASBENCH_MEASUREMENTS, 0, error) < 0.1);
    assert_string_equal(sasbench_table_text(table, SASBENCH_MEASUREMENTS, 1, status), "unsupported");
    assert_string_equal(sasbench_table_text(table, SASBENCH_MEASUREMENTS, 1, reason), "mine: 18 pings are too many");
    assert_true(sasbench_table_number(table, SASBENCH_MEASUREMENTS, 2, error) == 1);
    assert_true(sasbench_table_count(table, SASBENCH_TARGETS) > 0);
    assert_true(isnan(sasbench_table_number(table, SASBENCH_MEASUREMENTS, 3, error)));
    assert_string_equal(sasbench_table_text(table, SASBENCH_MEASUREMENTS, 0, -1), "");
    sasbench_table_free(table);
    free(pixels);
    sasbench_scene_free(scene);
}

static void settings_are_listed(void **state)
{
    (void)state;
    struct sas_setting setting;
    const char *summary;
    int k = 0;
    while (strcmp(sasbench_algorithm(k, &summary, NULL), "bp_sinc") != 0)
        k++;
    assert_true(strlen(summary) > 0);
    assert_int_equal(sasbench_setting(k, 0, &setting), 1);
    assert_string_equal(setting.name, "taps");
    assert_int_equal(sasbench_setting(k, 99, &setting), 0);
    assert_null(sasbench_algorithm(1000, NULL, NULL));
    assert_null(sasbench_algorithm(-1, NULL, NULL));
}

static void errors_have_one_message(void **state)
{
    (void)state;
    struct sasbench_scene *scene;
    struct sasbench *none;
    assert_int_equal(sasbench_open(-1, NULL, &none), SAS_INVALID);
    assert_null(none);
    assert_string_equal(sasbench_message(), "threads is -1, must be 0 to 1024");
    assert_int_equal(sasbench_open(1, "/dev/null", &none), SAS_INVALID);
    assert_int_equal(sasbench_scene_load(context, "study/quik", &scene), SAS_INVALID);
    assert_null(scene);
    assert_non_null(strstr(sasbench_message(), "did you mean 'study/quick'?"));
    assert_int_equal(sasbench_scene_read(context, "/dev/null", NULL, &scene), SAS_INVALID);
    assert_string_equal(sasbench_message(), "/dev/null: is not a regular file; a MATLAB file is needed");
    struct sasbench_scene *quick = scene_of("study/quick");
    struct sasbench_plan *plan;
    assert_int_equal(sasbench_plan(quick, "bp_sinc", 7, &plan), SAS_INVALID);
    assert_int_equal(sasbench_plan(quick, "wk_polar", SAS_FLOAT, &plan), SAS_UNSUPPORTED);
    assert_int_equal(sasbench_plan(quick, "external:true", SAS_FLOAT, &plan), SAS_INVALID);
    assert_null(plan);
    sasbench_scene_free(quick);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(images_are_the_programs), cmocka_unit_test(scenes_are_made_of_arrays),
        cmocka_unit_test(rows_are_measured),       cmocka_unit_test(settings_are_listed),
        cmocka_unit_test(errors_have_one_message), cmocka_unit_test(operators_are_adjoint),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
