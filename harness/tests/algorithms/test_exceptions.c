/* No plan and no image raises a floating-point exception that tells of a number lost: invalid, division by zero,
   overflow. Each stays visible as NaN or infinity unless something masks it, and what masks it today may not
   tomorrow. */
#include <fenv.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support.h"

#define SCENES SASBENCH_ROOT "/scenes"

/* Settings that choose other code than the defaults do. */
static const char *const specs[] = {
    "reference",
    "bp_nearest",
    "bp_nearest:engine=general",
    "bp_nearest:engine=general,exact=true",
    "bp_linear",
    "bp_linear:engine=general",
    "bp_sinc",
    "bp_sinc:engine=general",
    "bp_sinc:engine=general,exact=true,window=kaiser",
    "bp_zeropad",
    "bp_zeropad:engine=general",
    "bp_farrow",
    "bp_farrow:engine=general",
    "bp_farrow:degree=9,factor=2,engine=general,exact=true",
    "bp_fitted",
    "bp_fitted:factor=4,engine=general",
    "bp_factorised",
    "bp_factorised:stages=2,base=4",
    "rma_lbf",
    "rma_lbf:variant=printed,blocks=2,spacing=uniform,blend=off,stolt=16,sum=after",
    "rma_pca",
    "rma_wu",
    "rma_numeric",
    "rma_delay",
    "rma_chirp",
    "wk_classic",
    "wk_classic:unfold=stuff,taps=4",
    "wk_squint",
    "wk_polar",
    "rma_lbf:phases=libm",
};
enum { SPECS = sizeof specs / sizeof *specs, QUICK_SPECS = SPECS - 1 /* all but the last, which is slow */ };

enum { LOST = FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW };

static void flags_clear(void)
{
#pragma omp parallel
    feclearexcept(FE_ALL_EXCEPT);
}

/* Those of all threads of the pool that plan and execute ran in. */
static int flags_raised(void)
{
    int raised = 0;
#pragma omp parallel reduction(| : raised)
    raised |= fetestexcept(LOST);
    return raised;
}

static const char *flag_names(int raised)
{
    static char text[100];
    snprintf(text, sizeof text, "%s%s%s", raised & FE_INVALID ? " invalid" : "",
             raised & FE_DIVBYZERO ? " division by zero" : "", raised & FE_OVERFLOW ? " overflow" : "");
    return text;
}

/* How many of plan and execute raised one. */
static int image_faults(const char *scene, const char *text, struct problem problem, const struct echoes *echoes)
{
    struct spec spec;
    struct echoes converted;
    struct image image;
    struct stages stages;
    void *plan;
    int raised[2] = {0};
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    problem.precision = spec.precision;
    flags_clear();
    enum status status = algorithm_plan(spec.algorithm, &problem, spec.options, &plan);
    raised[0] = flags_raised();
    if (status == STATUS_OK) {
        assert_int_equal(echoes_convert(echoes, spec.precision, &converted), STATUS_OK);
        assert_int_equal(image_allocate(problem.patch_count, problem.patches, spec.precision, &image), STATUS_OK);
        flags_clear();
        stages_begin(&stages);
        assert_int_equal(spec.algorithm->execute(plan, &converted, &image, &stages), STATUS_OK);
        raised[1] = flags_raised();
        assert_true(image_is_finite(&image));
        image_free(&image);
        echoes_free(&converted);
        spec.algorithm->destroy(plan);
    }
    spec_free(&spec);
    for (int k = 0; k < 2; k++)
        if (raised[k])
            print_error("%s, %s: %s raises%s\n", scene, text, k ? "execute" : "plan", flag_names(raised[k]));
    return (raised[0] != 0) + (raised[1] != 0);
}

static int scene_faults(const struct scene *scene, int spec_count)
{
    struct problem problem = problem_make(&scene->acquisition, scene->patch_count, scene->patches, PRECISION_DOUBLE);
    struct echoes echoes;
    int faults = 0;
    support_echoes(scene, &echoes);
    for (int k = 0; k < spec_count; k++)
        for (int d = 0; d < 2; d++) {
            char text[200];
            snprintf(text, sizeof text, "%s%sprecision=%s", specs[k], strchr(specs[k], ':') ? "," : ":",
                     d ? "double" : "float");
            faults += image_faults(scene->name, text, problem, &echoes);
        }
    echoes_free(&echoes);
    return faults;
}

static void shipped_scenes_raise_none(void **state)
{
    (void)state;
    static const char *const names[] = {"study/quick", "gate/points", "gate/field", "gate/blocks", "zp15/target"};
    int faults = 0;
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        struct scene scene;
        support_scene(names[k], &scene);
        faults += scene_faults(&scene, SPECS);
        scene_free(&scene);
    }
    assert_int_equal(faults, 0);
}

/* All of scenes/extreme, but those whose file is refused. */
static void stability_scenes_raise_none(void **state)
{
    (void)state;
    char **names;
    int count, faults = 0, read = 0;
    assert_int_equal(scene_names(SCENES "/extreme", &names, &count), STATUS_OK);
    for (int k = 0; k < count; k++) {
        char name[200];
        struct scene scene;
        snprintf(name, sizeof name, "extreme/%s", names[k]);
        enum status status = scene_load(name, SCENES, &scene);
        if (status != STATUS_OK) {
            assert_int_equal(status, STATUS_INVALID);
            continue;
        }
        read++;
        faults += scene_faults(&scene, QUICK_SPECS);
        scene_free(&scene);
    }
    scene_names_free(names, count);
    assert_true(read > 40);
    assert_int_equal(faults, 0);
}

/* What is stiff in each: keys that replace those of study/quick. */
static const struct {
    const char *name, *keys;
} extremes[] = {
    {"near", "record = { first_sample = 0; samples = 256; }; targets = { points = ( { x = 0.0; r = 0.5; } ); };"},
    {"on_track", "record = { first_sample = 0; samples = 256; };"
                 "targets = { points = ( { x = 0.0; r = 0.0; } ); };"},
    {"on_receiver", "record = { first_sample = 0; samples = 256; }; beam = { kind = \"txrx\"; };"
                    "targets = { points = ( { x = 0.04; r = 0.0; } ); };"
                    "image = { x = { first = -0.2; step = 0.01; count = 41; };"
                    " r = { first = -0.1; step = 0.01; count = 21; }; };"},
    {"offset", "track = { speed = 2.5; pri = 0.064; pings = 18; x_first = 1e6; };"
               "targets = { points = ( { x = 1000001.0; r = 20.0; } ); };"
               "beam = { kind = \"rect\"; };"},
    {"fast", "track = { speed = 300.0; pri = 5e-4; pings = 18; x_first = -1.35; }; beam = { kind = \"rect\"; };"},
    {"backward", "track = { speed = -2.5; pri = 0.064; pings = 18; x_first = 1.52; };"},
    {"one_ping", "track = { speed = 2.5; pri = 0.064; pings = 1; };"},
    {"faint", "targets = { points = ( { x = 0.0; r = 20.0; amplitude = 1e-44; } ); };"},
    {"bright", "targets = { points = ( { x = 0.0; r = 20.0; amplitude = 1e60; } ); };"},
    {"silent", "targets = { points = ( { x = 0.0; r = 20.0; amplitude = 0; } ); };"},
    {"narrow", "sonar = { fc = 150e3; bandwidth = 500; fs = 30e3; };"},
    {"low", "sonar = { fc = 2e3; bandwidth = 15e3; fs = 30e3; }; beam = { kind = \"rect\"; };"},
    {"wide", "sonar = { fc = 8.5e3; bandwidth = 15e3; fs = 30e3; }; beam = { kind = \"rect\"; };"
             "array = { tx_length = 0.4; rx_length = 0.2; receivers = 8; first_offset = 0.1; pitch = 0.1; };"
             "track = { speed = 2.5; pri = 0.16; pings = 18; x_first = -3.4; };"
             "record = { first_sample = 0; samples = 2000; };"}, /* wavenumbers that the lowest frequency has not */
    {"limited", "aperture_limit = 0.01;"},
    {"partly_met", "record = { first_sample = 799; samples = 64; }; pulse = { kind = \"flat\"; };"},
};

static void extreme_scenes_raise_none(void **state)
{
    (void)state;
    int faults = 0;
    for (size_t k = 0; k < sizeof extremes / sizeof *extremes; k++) {
        char name[60], text[1000];
        struct scene scene;
        snprintf(name, sizeof name, "%s.cfg", extremes[k].name);
        snprintf(text, sizeof text, "base = {\n@include \"study/quick.cfg\"\n};\n%s\n", extremes[k].keys);
        support_write(name, text);
        enum status status = scene_load(path_of(name), SCENES, &scene);
        if (status != STATUS_OK)
            print_error("%s\n", status_message());
        assert_int_equal(status, STATUS_OK);
        faults += scene_faults(&scene, SPECS);
        scene_free(&scene);
    }
    assert_int_equal(faults, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shipped_scenes_raise_none),
        cmocka_unit_test(stability_scenes_raise_none),
        cmocka_unit_test_setup_teardown(extreme_scenes_raise_none, folder_make, folder_remove),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
