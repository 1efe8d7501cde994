/* An image in tiles by azimuth transforms and by bp_factorised, which images each tile from a stretch of the track or
   by a tree of its own: against the exact image as good as the whole one and as promised, and at the seams no worse
   than elsewhere; whatever the pings hold that a tile does not read. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "imaging/imaging.h"
#include "tests/support.h"

#define SONAR                                                                                                          \
    "sonar = { fc = 150e3; bandwidth = 15e3; fs = 30e3; };\n"                                                          \
    "pulse = { kind = \"flat\"; };\n"
#define RECORD             "record = { first_sample = 740; samples = 240; };\n"
#define FIELD(x, r, count) "targets = { fields = ( { x = [" x "]; r = [" r "]; count = " count "; seed = 39; } ); };\n"
#define COLUMNS(first, count)                                                                                          \
    "x = { first = " first "; step = 0.02; count = " count "; }; r = { first = 20.0; step = 0.05; count = 6; }; };\n"
#define EIGHT  "array = { tx_length = 0.08; rx_length = 0.04; receivers = 8; first_offset = 0.04; pitch = 0.04; };\n"
#define ALONE  "array = { tx_length = 0.08; rx_length = 0.08; receivers = 1; };\n"
#define TAPER  "beam = { kind = \"txrx\"; truncation = \"sine\"; limit = 0.12; };\naperture_limit = 0.12;\n"
#define SHARP  "beam = { kind = \"rect\"; truncation = \"sine\"; limit = 0.09; };\naperture_limit = 0.09;\n"
#define ACROSS FIELD("-10.0, 10.0", "19.6, 21.0", "300")
#define AHEAD                                                                                                          \
    "array = { tx_length = 0.12; rx_length = 0.12; receivers = 1; };\n"                                                \
    "record = { first_sample = 680; samples = 400; };\n"                                                               \
    "beam = { kind = \"txrx\"; truncation = \"sine\"; limit = 0.08; squint = 20.0; };\naperture_limit = 0.08;\n"

static const struct seam_case {
    const char *name, *scene;
    int columns, rows; /* of a tile */
    double most;       /* of the difference from the image formed whole, relative L2 */
    double read;       /* pings of the narrowest tile, over all, at most */
    const char *specs[4];
} cases[] = {
    {"beam that tapers",
     SONAR EIGHT "track = { speed = 2.5; pri = 0.064; pings = 126; x_first = -10.0; };\n" RECORD TAPER ACROSS
                 "image = { " COLUMNS("-10.5", "1051"),
     300,
     6,
     3e-3,
     0.5,
     {"rma_delay", "rma_lbf:blocks=2", "rma_chirp", "bp_factorised:error=1e-3,stages=2"}},
    {"beam with sharp ends",
     SONAR EIGHT "track = { speed = 2.5; pri = 0.064; pings = 126; x_first = -10.0; };\n" RECORD SHARP ACROSS
                 "image = { " COLUMNS("-9.5", "951"),
     300,
     4,
     8e-3,
     0.5,
     {"rma_delay", "rma_numeric", "bp_factorised:error=1e-4,stages=1"}},
    {"towards -x",
     SONAR "array = { tx_length = 0.08; rx_length = 0.04; receivers = 8; first_offset = -0.04; pitch = -0.04; };\n"
           "track = { speed = -2.5; pri = 0.064; pings = 126; x_first = 10.0; };\n" RECORD TAPER ACROSS
           "image = { " COLUMNS("-9.5", "951"),
     300,
     6,
     2e-3,
     0.5,
     {"rma_delay", "rma_numeric", "bp_factorised:error=1e-3,stages=2"}},
    {"long array",
     SONAR "array = { tx_length = 0.08; rx_length = 0.04; receivers = 32; first_offset = 0.04; pitch = 0.04; };\n"
           "track = { speed = 2.5; pri = 0.24; pings = 34; x_first = -10.5; };\n" RECORD TAPER ACROSS
           "image = { " COLUMNS("-9.5", "951"),
     300,
     6,
     5e-3,
     0.7,
     {"rma_delay", "rma_numeric", "bp_factorised:error=1e-3,stages=1"}},
    {"track shorter than the aperture",
     SONAR EIGHT "track = { speed = 2.5; pri = 0.064; pings = 20; x_first = -1.6; };\n" RECORD TAPER ACROSS
                 "image = { " COLUMNS("-1.5", "151"),
     50,
     1,
     6e-3,
     1,
     {"rma_delay", "rma_numeric", "bp_factorised:error=1e-3,stages=1"}},
    {"one receiver",
     SONAR ALONE "track = { speed = 2.5; pri = 0.008; pings = 1000; x_first = -10.0; };\n" RECORD TAPER ACROSS
                 "image = { " COLUMNS("-10.5", "1051"),
     300,
     4,
     2e-3,
     0.5,
     {"rma_numeric", "wk_classic", "wk_squint", "bp_factorised:error=1e-3,stages=2"}},
    {"squint",
     SONAR AHEAD "track = { speed = 0.0; pri = 0.008; spacing = 0.02; pings = 1200; x_first = -19.0; };\n" ACROSS
                 "image = { " COLUMNS("-9.5", "951"),
     300,
     6,
     5e-4,
     0.5,
     {"wk_classic", "wk_squint", "bp_factorised:error=1e-3,stages=2"}},
    {"squint towards -x",
     SONAR AHEAD "track = { speed = 0.0; pri = 0.008; spacing = -0.02; pings = 1200; x_first = 5.0; };\n" ACROSS
                 "image = { " COLUMNS("-9.5", "951"),
     300,
     6,
     5e-4,
     0.5,
     {"wk_classic", "wk_squint"}},
    {"turned axes",
     SONAR AHEAD "track = { speed = 0.0; pri = 0.008; spacing = 0.02; pings = 1200; x_first = -12.0; };\n" FIELD(
         "-1.0, 15.0", "16.0, 23.0", "1500") "image = { angle = 20.0; " COLUMNS("-5.0", "601"),
     200,
     6,
     6e-3,
     0.5,
     {"wk_classic", "wk_squint", "bp_factorised:error=1e-3,stages=2"}},
};

enum { BESIDE = 8 }; /* columns to either side of a seam */

struct tiled {
    struct image image;
    double least; /* pings of the tile that reads the fewest, over all */
};

static double complex pixel(const struct image *image, int i, int j)
{
    const size_t k = (size_t)i * (size_t)image->patches[0].x_count + (size_t)j;
    return image->precision == PRECISION_DOUBLE ? ((const double complex *)image->pixels[0])[k]
                                                : ((const float complex *)image->pixels[0])[k];
}

/* Relative L2 of a - b over the columns beside the seams, or over all others. */
static double difference(const struct image *a, const struct image *b, int columns, bool beside)
{
    const struct grid *g = &a->patches[0];
    double off = 0, all = 0;
    for (int j = 0; j < g->x_count; j++) {
        const int from = j % columns, to = columns - from;
        const bool near = (from < BESIDE && j >= columns) || (to <= BESIDE && j + to < g->x_count);
        for (int i = 0; near == beside && i < g->r_count; i++) {
            off += pow(cabs(pixel(a, i, j) - pixel(b, i, j)), 2);
            all += pow(cabs(pixel(b, i, j)), 2);
        }
    }
    return sqrt(off / all);
}

/* One tile, of echoes that hold something else where it does not read. */
static void tile_form(const struct spec *spec, const struct problem *problem, const struct echoes *echoes,
                      struct tiled *tiled)
{
    const struct acquisition *a = problem->acquisition;
    const struct pixel_window *w = problem->window;
    const size_t ping = (size_t)a->receivers * (size_t)a->samples, size = precision_size(problem->precision);
    struct imaging imaging;
    struct image image;
    struct stages stages;
    struct echoes part;
    int count = 0;
    bool *read = malloc((size_t)a->pings * sizeof *read);
    assert_non_null(read);
    if (imaging_open(spec, problem, &imaging) != STATUS_OK)
        fail_msg("tile at %d, %d: %s", w->row, w->column, status_message());
    imaging_reads(&imaging, problem, read);
    assert_int_equal(echoes_convert(echoes, problem->precision, &part), STATUS_OK);
    for (int p = 0; p < a->pings; p++) {
        count += read[p];
        if (!read[p])
            memset((char *)part.samples + (size_t)p * ping * size, 0x7e, ping * size);
    }
    tiled->least = fmin(tiled->least, (double)count / a->pings);
    for (int again = 0; again < 2; again++) {
        stages_begin(&stages);
        assert_int_equal(imaging_execute(&imaging, &part, &stages), STATUS_OK);
    }
    if (imaging_finish(&imaging, &part, &image) != STATUS_OK)
        fail_msg("tile at %d, %d: %s", w->row, w->column, status_message());
    for (int i = 0; i < w->rows; i++) {
        const size_t to = (size_t)(w->row + i) * (size_t)problem->patches[0].x_count + (size_t)w->column;
        memcpy((char *)tiled->image.pixels[0] + to * size,
               (const char *)image.pixels[0] + (size_t)i * (size_t)w->columns * size, (size_t)w->columns * size);
    }
    image_free(&image);
    imaging_close(&imaging);
    echoes_free(&part);
    free(read);
}

static void tiles_form(const struct seam_case *c, const struct spec *spec, struct problem problem,
                       const struct echoes *echoes, struct tiled *tiled)
{
    const struct grid *g = &problem.patches[0];
    tiled->least = 1;
    assert_int_equal(image_allocate(1, g, problem.precision, &tiled->image), STATUS_OK);
    for (int j = 0; j < g->x_count; j += c->columns)
        for (int i = 0; i < g->r_count; i += c->rows) {
            const struct pixel_window window = {i, g->r_count - i < c->rows ? g->r_count - i : c->rows, j,
                                                g->x_count - j < c->columns ? g->x_count - j : c->columns};
            problem.window = &window;
            tile_form(spec, &problem, echoes, tiled);
        }
}

static void check(const struct seam_case *c, const char *text, const struct scene *scene, const struct echoes *echoes,
                  const struct image *exact)
{
    struct spec spec;
    struct image whole;
    struct tiled tiled;
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    const struct problem problem = scene_problem(scene, spec.precision);
    if (support_image(text, problem, echoes, &whole) != STATUS_OK)
        fail_msg("%s, %s: %s", c->name, text, status_message());
    tiles_form(c, &spec, problem, echoes, &tiled);
    const double promise = spec.algorithm->promise(spec.options), most = fmin(c->most, promise);
    for (int beside = 0; beside < 2; beside++) {
        const double error = difference(&tiled.image, exact, c->columns, beside);
        const double before = difference(&whole, exact, c->columns, beside);
        const double apart = difference(&tiled.image, &whole, c->columns, beside);
        if (!((error <= promise || before > promise) && error <= before + most / 2 && apart <= most))
            fail_msg("%s, %s, %s the seams: error %.3g, of the whole image %.3g (promised %.3g), apart %.3g", c->name,
                     text, beside ? "beside" : "off", error, before, promise, apart);
    }
    if (!(tiled.least <= c->read))
        fail_msg("%s, %s: every tile reads %.2f of the pings and more", c->name, text, tiled.least);
    image_free(&whole);
    image_free(&tiled.image);
    spec_free(&spec);
}

static void as_good_as_the_whole(void **state)
{
    (void)state;
    for (const struct seam_case *c = cases; c < cases + sizeof cases / sizeof *cases; c++) {
        struct scene scene;
        struct echoes echoes;
        struct image exact;
        support_write("seams.cfg", c->scene);
        support_scene(path_of("seams.cfg"), &scene);
        support_echoes(&scene, &echoes);
        assert_int_equal(
            support_image("reference:precision=double", scene_problem(&scene, PRECISION_DOUBLE), &echoes, &exact),
            STATUS_OK);
        for (size_t k = 0; k < sizeof c->specs / sizeof *c->specs && c->specs[k]; k++) {
            char text[100];
            const bool is_double = (k + (size_t)(c - cases)) % 2;
            snprintf(text, sizeof text, "%s%sprecision=%s", c->specs[k], strchr(c->specs[k], ':') ? "," : ":",
                     is_double ? "double" : "float");
            check(c, text, &scene, &echoes, &exact);
        }
        image_free(&exact);
        echoes_free(&echoes);
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_good_as_the_whole),
    };
    return cmocka_run_group_tests(tests, folder_make, folder_remove);
}
