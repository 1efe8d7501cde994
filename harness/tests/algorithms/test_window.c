/* A window of an image has the bits of the whole image, by every back projection, in both precisions and by both
   engines, whatever the records hold that it does not read. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "imaging/imaging.h"
#include "tests/support.h"

static const struct window_case {
    const char *name;
    int pings, receivers, samples, first_sample;
    double spacing, wobble, speed, limit;
    struct grid grid;
    struct pixel_window window;
    int unread; /* pings that are not read, at least */
} cases[] = {
    {"tables, limited", 60, 3, 700, 750, 0.2, 0, 2.5, 0.05, {-6, 0.05, 601, 20, 0.03, 37, 0}, {5, 19, 201, 111}, 30},
    {"tables", 33, 2, 700, 700, 0.2, 0, 2.5, INFINITY, {-4, 0.02, 1703, 20, 0.03, 11, 0}, {3, 1, 907, 313}, 0},
    {"tables, records' ends", 33, 2, 110, 753, 0.2, 0, 2.5, 0.3, {-4, 0.1, 91, 18, 0.03, 171, 0}, {60, 71, 17, 40}, 0},
    {"tables, backwards", 40, 2, 700, 700, -0.2, 0, -2.5, 0.1, {-8, 0.04, 301, 20, 0.03, 11, 0}, {0, 11, 7, 90}, 10},
    {"tables, one row of eight", 60, 2, 500, 750, 0.2, 0, 2.5, 0.3, {-6, 0.2, 61, 20, 0.003, 20, 0}, {9, 1, 10, 40}, 0},
    {"tables, rows of four", 60, 1, 500, 750, 0.2, 0, 2.5, 0.1, {-6, 0.1, 121, 20, 0.03, 21, 0}, {5, 3, 30, 60}, 5},
    {"long rows", 41, 3, 400, 750, 0.2, 0.03, 2.5, 0.1, {-5.013, 0.021, 1331, 19.87, 0.31, 9, 0}, {2, 3, 701, 90}, 10},
    {"long columns",
     9,
     3,
     600,
     700,
     0.3,
     0.05,
     2.5,
     INFINITY,
     {-1.2, 0.31, 9, 17.03, 0.0151, 905, 0},
     {351, 260, 3, 2}},
    {"joined pings", 42, 1, 600, 700, 0.2, 0, 2.5, 0.1, {-4.0127, 0.02, 801, 16.3, 0.4, 7, 0}, {1, 5, 390, 45}, 10},
    {"joined pings, records' ends",
     20,
     1,
     110,
     740,
     0.4,
     0.1,
     75,
     0.3,
     {-4.5, 0.03, 501, 18.1, 0.4, 7, 0},
     {1, 5, 250, 70}},
    {"long records, in parts",
     5,
     4,
     2200,
     600,
     0.3,
     0,
     2.5,
     INFINITY,
     {-1.2, 0.31, 3, 17.03, 0.0313, 1100, 0},
     {500, 130, 1, 2}},
    {"on the track", 6, 3, 400, 0, 0.02, 0.05, 2.5, INFINITY, {-1.1, 0.02, 191, -0.4, 0.05, 87, 0}, {3, 60, 70, 21}},
    {"turned", 31, 3, 600, 700, 0.2, 0.02, 2.5, 0.1, {-3, 0.021, 401, 19.87, 0.31, 9, 0.1}, {2, 3, 201, 90}, 5},
};

static const char *const specs[] = {"bp_nearest",
                                    "bp_nearest:engine=general",
                                    "bp_linear:beta=8",
                                    "bp_linear:beta=2,preemphasis=on",
                                    "bp_linear:engine=general",
                                    "bp_sinc:taps=6",
                                    "bp_sinc:taps=8,engine=general",
                                    "bp_fitted",
                                    "bp_fitted:engine=general",
                                    "bp_farrow:degree=3",
                                    "bp_farrow:degree=7",
                                    "bp_farrow:degree=4,engine=general",
                                    "bp_zeropad:factor=4",
                                    "bp_zeropad:factor=4,engine=general",
                                    "reference"};

static void case_make(const struct window_case *c, struct acquisition *a, struct echoes *echoes)
{
    struct random random = random_seed(39, (uint64_t)(c - cases));
    *a = support_acquisition(c->pings, c->receivers, c->samples);
    a->aperture_limit = c->limit;
    for (int p = 0; p < c->pings; p++) {
        a->t0[p] = c->first_sample / a->fs;
        a->tx[p] = (struct vector){(p - c->pings / 2) * c->spacing, c->wobble * sin(p), c->wobble * cos(p)};
        a->velocity[p].x = c->speed;
        for (int m = 0; m < c->receivers; m++) {
            a->rx[p * c->receivers + m] = a->tx[p];
            a->rx[p * c->receivers + m].x += 0.04 * (m + 1);
        }
    }
    support_noise(a, &random, echoes);
}

/* The window's image, of echoes that hold something else where they are not read; how many pings these are. */
static int window_form(const struct spec *spec, const struct problem *problem, const struct echoes *echoes,
                       struct imaging *imaging, struct image *image)
{
    const int pings = problem->acquisition->pings;
    const size_t ping = (size_t)problem->acquisition->receivers * (size_t)problem->acquisition->samples;
    struct stages stages;
    struct echoes part;
    int unread = 0;
    bool *read = malloc((size_t)pings * sizeof *read);
    assert_non_null(read);
    assert_int_equal(imaging_open(spec, problem, imaging), STATUS_OK);
    imaging_reads(imaging, problem, read);
    assert_int_equal(echoes_convert(echoes, problem->precision, &part), STATUS_OK);
    for (int p = 0; p < pings; p++) {
        unread += !read[p];
        for (size_t n = (size_t)p * ping; !read[p] && n < ((size_t)p + 1) * ping; n++)
            if (problem->precision == PRECISION_DOUBLE)
                ((double complex *)part.samples)[n] = 1e9;
            else
                ((float complex *)part.samples)[n] = 1e9f;
    }
    for (int again = 0; again < 2; again++) {
        stages_begin(&stages);
        assert_int_equal(imaging_execute(imaging, &part, &stages), STATUS_OK);
    }
    assert_int_equal(imaging_finish(imaging, &part, image), STATUS_OK);
    echoes_free(&part);
    free(read);
    return unread;
}

static void check(const struct window_case *c, const char *text, enum precision precision, const struct acquisition *a,
                  const struct echoes *echoes)
{
    const size_t size = precision_size(precision);
    struct spec spec;
    struct problem problem = problem_make(a, 1, &c->grid, precision);
    struct imaging imaging;
    struct image whole, part;
    struct echoes converted;
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    assert_int_equal(echoes_convert(echoes, precision, &converted), STATUS_OK);
    assert_int_equal(imaging_form(&spec, &problem, &converted, &whole, NULL), STATUS_OK);
    problem.window = &c->window;
    const int unread = window_form(&spec, &problem, echoes, &imaging, &part);
    const struct pixel_window *w = &c->window;
    for (int i = 0; i < w->rows; i++) {
        const char *row = (const char *)whole.pixels[0];
        row += ((size_t)(w->row + i) * (size_t)c->grid.x_count + (size_t)w->column) * size;
        const char *own = (const char *)part.pixels[0] + (size_t)i * (size_t)w->columns * size;
        if (memcmp(row, own, (size_t)w->columns * size) != 0)
            fail_msg("%s, %s, %s: row %d of the window has other bits", c->name, text, precision_name(precision), i);
    }
    if (unread < c->unread)
        fail_msg("%s, %s: %d pings are not read, %d are not needed", c->name, text, unread, c->unread);
    image_free(&part);
    imaging_close(&imaging);
    image_free(&whole);
    echoes_free(&converted);
    spec_free(&spec);
}

static void bits_of_the_whole(void **state)
{
    (void)state;
    for (const struct window_case *c = cases; c < cases + sizeof cases / sizeof *cases; c++) {
        struct acquisition a;
        struct echoes echoes;
        case_make(c, &a, &echoes);
        for (size_t s = 0; s < sizeof specs / sizeof *specs; s++)
            for (int precision = PRECISION_FLOAT; precision <= PRECISION_DOUBLE; precision++)
                check(c, specs[s], (enum precision)precision, &a, &echoes);
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

static void others_refuse(void **state)
{
    (void)state;
    struct acquisition a;
    struct echoes echoes;
    struct spec spec;
    struct imaging imaging;
    case_make(&cases[0], &a, &echoes);
    struct problem problem = problem_make(&a, 1, &cases[0].grid, PRECISION_FLOAT);
    problem.window = &cases[0].window;
    assert_int_equal(spec_parse("wk_polar", &spec), STATUS_OK);
    assert_int_equal(imaging_open(&spec, &problem, &imaging), STATUS_UNSUPPORTED);
    spec_free(&spec);
    echoes_free(&echoes);
    acquisition_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(bits_of_the_whole), cmocka_unit_test(others_refuse)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
