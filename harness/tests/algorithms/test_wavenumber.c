/* Omega-k imaging, broadside and squinted (SQ18), against numbers of an independent implementation and against exact
   images. */
#include "tests/algorithms/squint_numbers.h"
#include "tests/algorithms/squint_scenes.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/kaiser.h"
#include "scene/simulate.h"
#include "wavenumber/wk_engine.h"

static const double SPACING_M = 0.04;

static double radians(double degrees)
{
    return degrees * M_PI / 180;
}

/* The scenes' own echoes: the simulator's squinted beam, delays and phases. */
static void check_spectra(const struct scene *scene, const struct spectrum_number *numbers, size_t count)
{
    struct echoes echoes;
    support_echoes(scene, &echoes);
    for (size_t k = 0; k < count; k++) {
        double complex value = echo_spectrum(scene, &echoes, numbers[k].ping, numbers[k].f_hz);
        assert_true(cabs(value - (numbers[k].re + I * numbers[k].im)) <= 1e-9);
    }
    echoes_free(&echoes);
}

static void spectra(void **state)
{
    (void)state;
    struct scene scene;
    scene_sq18(&sonar_sq18, radians(20), &scene);
    check_spectra(&scene, sq18_spectra, sizeof sq18_spectra / sizeof *sq18_spectra);
    squint_scene_free(&scene);
    scene_pf05(&scene);
    check_spectra(&scene, pf05_spectra, sizeof pf05_spectra / sizeof *pf05_spectra);
    squint_scene_free(&scene);
}

/* A beam along the track hears what lies ahead, and nothing of what lies behind, whose sine off the axis is as
   small. */
static void behind_the_beam(void **state)
{
    (void)state;
    for (int side = -1; side <= 1; side += 2) {
        struct scene scene;
        struct echoes echoes;
        double energy = 0;
        scene_sq18(&sonar_sq18, radians(89), &scene);
        scene.targets[0].x = side * 45 * sin(radians(89));
        scene.targets[0].r = 45 * cos(radians(side > 0 ? 89 : 89.9)); /* 1.1 degrees off the axis run backwards */
        scene.target_count = scene.point_count = 1;
        support_echoes(&scene, &echoes);
        const size_t count = (size_t)scene.acquisition.pings * (size_t)scene.acquisition.samples;
        for (size_t n = 0; n < count; n++)
            energy += pow(cabs(((const double complex *)echoes.samples)[n]), 2);
        assert_true(side > 0 ? energy > 1 : energy == 0);
        echoes_free(&echoes);
        squint_scene_free(&scene);
    }
}

/* Exact images, which the others are measured against. The numbers are scaled by spacing and bin over bandwidth. */
static void check_image(const struct scene *scene, const struct image_number *numbers, int count)
{
    const struct acquisition *a = &scene->acquisition;
    struct echoes echoes;
    struct image image;
    struct grid patches[16];
    support_echoes(scene, &echoes);
    for (int k = 0; k < count; k++)
        patches[k] = (struct grid){numbers[k].x, 1, 1, numbers[k].r, 1, 1, 0};
    assert_int_equal(image_allocate(count, patches, PRECISION_DOUBLE, &image), STATUS_OK);
    exact_image(scene, &echoes, a->sound_speed / a->fc / (4 * SPACING_M), &image);
    double scale = SPACING_M * spectrum_sum(a) * a->fs / a->samples / a->bandwidth;
    for (int k = 0; k < count; k++)
        assert_true(cabs(scale * image_pixel(&image, k, 0, 0) - (numbers[k].re + I * numbers[k].im)) <= 1e-6);
    image_free(&image);
    echoes_free(&echoes);
}

static void exact_images(void **state)
{
    (void)state;
    struct scene scene;
    scene_sq18(&sonar_sq18, radians(20), &scene);
    check_image(&scene, sq18_image, sizeof sq18_image / sizeof *sq18_image);
    squint_scene_free(&scene);
    scene_pf05(&scene);
    check_image(&scene, pf05_image, sizeof pf05_image / sizeof *pf05_image);
    squint_scene_free(&scene);
}

static void *planned(const char *text, const struct problem *problem, struct spec *spec)
{
    void *plan;
    assert_int_equal(spec_parse(text, spec), STATUS_OK);
    assert_int_equal(algorithm_plan(spec->algorithm, problem, spec->options, &plan), STATUS_OK);
    return plan;
}

static void plan_free(struct spec *spec, void *plan)
{
    spec->algorithm->destroy(plan);
    spec_free(spec);
}

/* A plan's line at kx0, focused onto as many rows from r' = 0 as its range transform has, holds its Stolt-interpolated
   cells: their transform at ky0, the weight taken off. */
static double complex rotated_cell(struct wk *wk, const struct rotated_number *number)
{
    struct wk_patch *patch = &wk->patches[0];
    double seconds[WK_STAGES], bin = round(number->ky0 * patch->length * patch->grid.r_step / (2 * M_PI));
    patch->own.r_step = 2 * M_PI * bin / (patch->length * number->ky0);
    wk->kx_first = number->kx0;
    wk->lines = 1;
    double complex sum = 0;
    for (int base = 0; base < patch->length;
         base += patch->own.r_count) { /* as many rows at a time as there is room for */
        patch->own.r_first = base * patch->own.r_step;
        wk_line_double_baseline(wk, 0, 0, seconds);
        for (int i = 0; i < patch->own.r_count && base + i < patch->length; i++)
            sum += ((double complex *)wk->focused)[(size_t)i * wk->line_stride]
                   * cexp(-2 * M_PI * I * fmod((base + i) * bin / patch->length, 1));
    }
    double kappa = sqrt(number->k_r * number->k_r - number->kx * number->kx);
    double weight = sqrt(2 * M_PI / kappa) * wk->sound_speed / (4 * M_PI) * 2 * M_PI
                    / (patch->length * patch->own.r_step * wk->fs) * patch->length;
    return sum / weight * cexp(-I * (M_PI / 4 + number->kx * wk->x_middle));
}

static void rotated_spectrum(void **state)
{
    (void)state;
    struct scene scene;
    struct echoes echoes;
    struct spec spec;
    struct squint_sonar sonar = sonar_sq18; /* a longer record: cut off sidelobes are in no number */
    sonar.samples = 2048;
    sonar.first_sample = 476;
    scene_sq18(&sonar, radians(20), &scene);
    const struct acquisition *a = &scene.acquisition;
    const struct grid grid = {0, 0.04, 2, 15, 0.03, 1024, radians(20)};
    const struct problem problem = problem_make(a, 1, &grid, PRECISION_DOUBLE);
    support_echoes(&scene, &echoes);
    struct wk *wk = planned("wk_squint:pad=2", &problem, &spec);
    wk_transform_double.range(wk, echoes.samples);
    wk_transform_double.azimuth(wk);
    for (size_t k = 0; k < sizeof sq18_rotated / sizeof *sq18_rotated; k++) {
        const struct rotated_number *number = &sq18_rotated[k];
        double complex value = rotated_cell(wk, number) * SPACING_M * spectrum_sum(a) / a->samples;
        double complex expected = number->re + I * number->im;
        print_message("Kx0 = %g, Ky0 = %g: off by %.2e\n", number->kx0, number->ky0,
                      cabs(value - expected) / cabs(expected));
        assert_true(cabs(value - expected) <= 5e-3 * cabs(expected));
    }
    plan_free(&spec, wk);
    echoes_free(&echoes);
    squint_scene_free(&scene);
}

/* The error of a SPEC's image of a scene against the exact one. */
static double error_of(const char *spec, const struct problem *problem, const struct echoes *echoes,
                       const struct image *exact)
{
    struct image image;
    if (support_image(spec, *problem, echoes, &image) != STATUS_OK)
        fail_msg("%s: %s", spec, status_message());
    double error = support_difference(&image, exact);
    print_message("  %s: %.2e\n", spec, error);
    image_free(&image);
    return error;
}

/* At each of SQ18's angles, in turned axes: within 0.3 % with 8 taps and the azimuth padded twice. What the padding is
   for shows at 45 degrees. */
static void squints(void **state)
{
    (void)state;
    static const double degrees[] = {0, 10, 20, 30, 45};
    for (size_t k = 0; k < sizeof degrees / sizeof *degrees; k++) {
        struct imaged s;
        print_message("%g degrees\n", degrees[k]);
        make_imaged(&sonar_sq18, radians(degrees[k]), radians(degrees[k]), &s);
        double classic = error_of("wk_classic:pad=2", &s.problem, &s.echoes, &s.exact);
        double padded = error_of("wk_squint:pad=2", &s.problem, &s.echoes, &s.exact);
        double less = error_of("wk_squint", &s.problem, &s.echoes, &s.exact);
        double unpadded = error_of("wk_squint:pad=1", &s.problem, &s.echoes, &s.exact);
        assert_true(classic <= 3e-3 && padded <= 3e-3 && less <= 3e-3);
        if (degrees[k] > 40)
            assert_true(unpadded > 5 * padded);
        free_imaged(&s);
    }
}

/* Ways to unfold make one image; so do grids in any axes; double confirms float. */
static void ways(void **state)
{
    (void)state;
    static const char *const specs[] = {"wk_classic:unfold=stuff,pad=2",   "wk_classic:unfold=baseband,pad=2",
                                        "wk_classic:unfold=support,pad=2", "wk_classic:pad=2,precision=double",
                                        "wk_squint:precision=double",      "wk_polar"};
    struct imaged s;
    for (int turned = -10; turned <= 20; turned += 10) {
        print_message("axes at %d degrees\n", turned);
        make_imaged(&sonar_sq18, radians(20), radians(turned), &s);
        for (size_t k = 0; k < sizeof specs / sizeof *specs; k++)
            assert_true(error_of(specs[k], &s.problem, &s.echoes, &s.exact) <= 3e-3);
        free_imaged(&s);
    }
}

/* The platform moves on while the pulse travels: v/c = 0.02, and backwards along the track. */
static void motion(void **state)
{
    (void)state;
    static const double speeds[] = {30, -30};
    for (int k = 0; k < 4; k++) {
        struct squint_sonar sonar = sonar_sq18;
        struct imaged s;
        sonar.speed = speeds[k % 2];
        double squint = k < 2 ? 0 : radians(20);
        print_message("%g m/s, %g rad\n", sonar.speed, squint);
        make_imaged(&sonar, squint, squint, &s);
        assert_true(error_of("wk_classic:pad=2", &s.problem, &s.echoes, &s.exact) <= 4e-3);
        assert_true(error_of("wk_squint", &s.problem, &s.echoes, &s.exact) <= 4e-3);
        free_imaged(&s);
    }
}

/* A track run the other way gives the same image. */
static void reversed(void **state)
{
    (void)state;
    struct imaged s;
    make_imaged(&sonar_sq18, radians(20), radians(20), &s);
    struct acquisition *a = &s.scene.acquisition;
    double complex *samples = (double complex *)s.echoes.samples;
    for (int p = 0; p < a->pings / 2; p++) {
        int q = a->pings - 1 - p;
        double x = a->tx[p].x;
        a->tx[p].x = a->rx[p].x = a->tx[q].x;
        a->tx[q].x = a->rx[q].x = x;
        for (int n = 0; n < a->samples; n++) {
            double complex value = samples[p * a->samples + n];
            samples[p * a->samples + n] = samples[q * a->samples + n];
            samples[q * a->samples + n] = value;
        }
    }
    assert_true(error_of("wk_classic:pad=2", &s.problem, &s.echoes, &s.exact) <= 3e-3);
    assert_true(error_of("wk_squint", &s.problem, &s.echoes, &s.exact) <= 3e-3);
    free_imaged(&s);
}

static struct image executed(const struct spec *spec, void *plan, const struct imaged *s)
{
    struct image image;
    struct stages stages = {0};
    support_image_make(s->patches, s->problem.patch_count, PRECISION_DOUBLE, &image);
    assert_int_equal(spec->algorithm->execute(plan, &s->echoes, &image, &stages), STATUS_OK);
    return image;
}

/* Places, phases and weights of cells by polynomials make the image of the closed forms, which stand where the
   polynomials are off: without nodes they always are. Twice the taps change little. */
static void fits(void **state)
{
    (void)state;
    static const char *const specs[] = {"wk_classic", "wk_squint"};
    static const char *const longer[] = {"wk_classic:taps=16,precision=double", "wk_squint:taps=16,precision=double"};
    for (int k = 0; k < 6; k++) {
        struct imaged s;
        struct spec spec;
        make_imaged(&sonar_sq18, radians(k / 2 * 22.5), radians(k / 2 * 22.5), &s);
        struct wk *plan = planned(specs[k % 2], &s.problem, &spec);
        struct image more, exact, fitted = executed(&spec, plan, &s);
        plan->fit = (struct fit_nodes){0};
        exact = executed(&spec, plan, &s);
        assert_int_equal(support_image(longer[k % 2], s.problem, &s.echoes, &more), STATUS_OK);
        double error = support_difference(&fitted, &exact), taps = support_difference(&fitted, &more);
        print_message("%s, %g degrees: %.1e, taps %.1e\n", specs[k % 2], k / 2 * 22.5, error, taps);
        assert_true(error > 0 && error <= 1e-6);
        assert_true(taps > 0 && taps <= 2e-4);
        image_free(&fitted);
        image_free(&exact);
        image_free(&more);
        plan_free(&spec, plan);
        free_imaged(&s);
    }
}

/* The azimuth kernel's polynomials are the kernel, whatever its taps and padding. */
static void azimuth_kernels(void **state)
{
    (void)state;
    struct scene scene;
    struct grid patches[5];
    scene_sq18(&sonar_sq18, radians(20), &scene);
    patches_around(&scene, radians(20), 0.04, 7, patches);
    const struct problem problem = problem_make(&scene.acquisition, 5, patches, PRECISION_DOUBLE);
    double worst = 0;
    for (int k = 0; k < 20; k++) {
        static const char *const taps[] = {"4", "6", "8", "12", "16"};
        char text[100];
        struct spec spec;
        snprintf(text, sizeof text, "wk_squint:taps=%s,pad=%d", taps[k % 5], 1 + k / 5);
        struct wk *plan = planned(text, &problem, &spec);
        const struct wk_kernel *kernel = &plan->azimuth_kernel;
        for (int i = 0; i < kernel->taps / 2 * 65; i++) {
            const double *c = (const double *)kernel->values + WK_POWERS * (i / 65), u = i % 65 / 64.0;
            double value = 0, exact = kaiser_value(kernel->taps, kernel->shape, u - (1 - kernel->taps / 2 + i / 65));
            for (int power = WK_POWERS - 1; power >= 0; power--)
                value = value * (u - 0.5) + c[power];
            worst = fmax(worst, fabs(value - exact));
        }
        plan_free(&spec, plan);
    }
    print_message("off by %.1e\n", worst);
    assert_true(worst <= 1e-6);
    squint_scene_free(&scene);
}

/* Azimuth samples over those recorded at 20 degrees: SQ18's zeros. */
static void sizes(void **state)
{
    (void)state;
    static const struct {
        const char *spec;
        double size;
    } cases[] = {{"wk_classic:unfold=stuff", 7},
                 {"wk_classic:unfold=baseband", 2},
                 {"wk_classic:unfold=support", 1.36},
                 {"wk_squint:pad=1", 1},
                 {"wk_squint", 1.5}};
    struct scene scene;
    struct grid patches[5];
    scene_sq18(&sonar_sq18, radians(20), &scene);
    patches_around(&scene, radians(20), 0.04, 7, patches);
    const struct problem problem = problem_make(&scene.acquisition, 5, patches, PRECISION_FLOAT);
    double flops[5];
    for (int k = 0; k < 5; k++) {
        struct spec spec;
        void *plan = planned(cases[k].spec, &problem, &spec);
        print_message("%s: %.3f\n", cases[k].spec, wk_size_factor(plan));
        assert_true(fabs(wk_size_factor(plan) - cases[k].size) <= 0.02 * cases[k].size);
        flops[k] = spec.algorithm->work(plan).flops;
        plan_free(&spec, plan);
    }
    assert_true(flops[0] > flops[1] && flops[1] > flops[2]);
    squint_scene_free(&scene);
}

static void refuses(const struct acquisition *a, const struct grid *grid, const char *reason)
{
    static const char *const specs[] = {"wk_classic", "wk_squint", "wk_polar"};
    struct problem problem = problem_make(a, 1, grid, PRECISION_FLOAT);
    for (int k = 0; k < 3; k++) {
        struct spec spec;
        void *plan;
        assert_int_equal(spec_parse(specs[k], &spec), STATUS_OK);
        enum status status = algorithm_plan(spec.algorithm, &problem, spec.options, &plan);
        spec_free(&spec);
        if (status != STATUS_UNSUPPORTED)
            fail_msg("%s: status %d, must be refused for \"%s\"", specs[k], status, reason);
        assert_null(plan);
        if (!strstr(status_message(), reason))
            fail_msg("\"%s\" does not say \"%s\"", status_message(), reason);
    }
}

static void refusals(void **state)
{
    (void)state;
    struct scene scene;
    struct grid patches[5];
    scene_sq18(&sonar_sq18, radians(20), &scene);
    patches_around(&scene, 0, 0.04, 7, patches);
    struct acquisition a = scene.acquisition;
    a.echo_squint = radians(89);
    refuses(&a, patches, "condition squint: the angle of the beam's axis off broadside (degrees) is 89; at most 78.5");
    a = scene.acquisition;
    a.aperture_limit = 0.01; /* the beam ends at 0.025 */
    refuses(&a, patches, "condition whole_aperture");
    a = scene.acquisition;
    a.pings = 1;
    refuses(&a, patches, "condition pings");
    a = scene.acquisition;
    a.echo_sine = 0.2; /* pings 0.04 m apart sample 0.0625 */
    a.aperture_limit = INFINITY;
    refuses(&a, patches, "condition doppler");
    a = scene.acquisition;
    a.receivers = 2;
    a.pings = 128;
    refuses(&a, patches, "condition one_receiver");
    struct grid elsewhere = patches[0];
    elsewhere.x_first -= 40;
    refuses(&scene.acquisition, &elsewhere, "condition in_beam: patches that lie in no ping's beam is 1; at most 0");
    elsewhere = patches[0];
    elsewhere.angle_rad = radians(-40); /* turned about the origin: off the beam */
    refuses(&scene.acquisition, &elsewhere, "condition in_beam: patches that lie in no ping's beam is 1; at most 0");
    elsewhere.angle_rad = 0;
    elsewhere.r_first = -0.1;
    refuses(&scene.acquisition, &elsewhere, "condition in_front");
    elsewhere = (struct grid){100 * tan(radians(20)), 0.04, 3, 100, 0.04, 3, 0};
    refuses(&scene.acquisition, &elsewhere, "condition in_record");
    squint_scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spectra),      cmocka_unit_test(behind_the_beam),
        cmocka_unit_test(exact_images), cmocka_unit_test(rotated_spectrum),
        cmocka_unit_test(squints),      cmocka_unit_test(ways),
        cmocka_unit_test(motion),       cmocka_unit_test(reversed),
        cmocka_unit_test(sizes),        cmocka_unit_test(refusals),
        cmocka_unit_test(fits),         cmocka_unit_test(azimuth_kernels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
