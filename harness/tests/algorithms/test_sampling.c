/* What is told of the pings' times and of the places where pings and receivers sample the track: arrays that lie along
   the track, across it or upright, tracks of any shape. */
#include <math.h>
#include <string.h>

#include "imaging/spec.h"
#include "scene/scene.h"
#include "tests/support.h"

enum { PINGS = 41, RECEIVERS = 8, SAMPLES = 2400 };
static const double element = 0.08, speed = 2.5;

/* A straight track, its receivers at `offset`, seen by the half-power beam: at 20 m 1.1 m to either side. */
static struct acquisition make(double spacing, const struct vector offset[RECEIVERS])
{
    struct acquisition a = support_acquisition(PINGS, RECEIVERS, SAMPLES);
    a.tx_length = element;
    a.pri = spacing / speed;
    for (int p = 0; p < PINGS; p++) {
        a.tx[p].x = (p - PINGS / 2) * spacing;
        a.velocity[p].x = speed;
        for (int m = 0; m < RECEIVERS; m++)
            a.rx[p * RECEIVERS + m] = (struct vector){a.tx[p].x + offset[m].x, offset[m].y, offset[m].z};
    }
    return a;
}

/* The condition of that name; a value of NAN: there is none. */
static struct condition told(const struct acquisition *a, const char *name)
{
    static const struct grid grid = {-0.1, 0.02, 11, 19.9, 0.025, 9, 0};
    const struct problem problem = problem_make(a, 1, &grid, PRECISION_DOUBLE);
    struct condition list[CONDITIONS_MAX + CONDITIONS_SCENE];
    int count = conditions_scene(&problem, list);
    count += conditions_sampled(&problem, list + count, CONDITIONS_MAX);
    for (int k = 0; k < count; k++)
        if (strcmp(list[k].name, name) == 0)
            return list[k];
    return (struct condition){.value = NAN};
}

/* Arrays of eight receivers, and how far apart their phase centres lie along the track, from ping to ping as well. */
struct layout {
    const char *what;
    double pitch, row_pitch, skew; /* m along the track: in a row, from row to row, of receivers by chance */
    int rows;
    double across, up; /* m: from row to row */
    double spacing;    /* m */
    double sampled;    /* m: the step of the phase centres along the track, on the mean */
    double ghost;
};

static const struct layout layouts[] = {
    {"a row", 0.04, 0, 0, 1, 0, 0, 0.16, 0.02, 0},
    {"a row with gaps", 0.04, 0, 0, 1, 0, 0, 0.2, 0.025, 0.25},
    {"a row, two deep", 0.04, 0, 0, 1, 0, 0, 0.08, 0.02, 0},
    {"a row, two deep within 1 %", 0.04, 0, 0, 1, 0, 0, 0.0808, 0.0202, 0.01},
    {"a row against the track", -0.04, 0, 0, 1, 0, 0, 0.16, 0.02, 0},
    {"two rows, one above the other", 0.04, 0, 0, 2, 0, 0.05, 0.08, 0.02, 0},
    {"two rows side by side", 0.04, 0, 0, 2, 0.05, 0, 0.08, 0.02, 0},
    {"two rows that undersample", 0.08, 0, 0, 2, 0, 0.05, 0.16, 0.04, 0},
    {"two rows that undersample, 2 mm aside", 0.08, 0.002, 0, 2, 0, 0.05, 0.16, 0.04, 0},
    {"two rows that undersample, off by 1 mm", 0.08, 0, 1e-3, 2, 0.05, 0, 0.16, 0.04, NAN},
    {"two rows, offset by half a pitch", 0.08, 0.04, 0, 2, 0, 0.05, 0.16, 0.02, 0},
    {"four rows", 0.08, 0, 0, 4, 0, 0.05, 0.08, 0.04, 0},
    {"across the track", 0, 0, 0, 8, 0.05, 0, 0.02, 0.02, 0},
    {"across the track, undersampling", 0, 0, 0, 8, 0.05, 0, 0.16, 0.16, 0},
    {"upright", 0, 0, 0, 8, 0, 0.05, 0.02, 0.02, 0},
    {"upright, undersampling", 0, 0, 0, 8, 0, 0.05, 0.16, 0.16, 0},
    {"upright, slanting by 1 mm, undersampling", 0, 1e-3 / 7, 0, 8, 0, 0.05, 0.16, 0.16, 0},
    {"all in one place", 0, 0, 0, 8, 0, 0, 0.16, 0.16, 0},
};

static void arrays_sample_where_they_are(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof layouts / sizeof *layouts; k++)
        for (int serpentine = 0; serpentine < 2; serpentine++) {
            const struct layout *l = &layouts[k];
            const int columns = RECEIVERS / l->rows;
            struct vector offset[RECEIVERS];
            for (int m = 0; m < RECEIVERS; m++) {
                const int row = m / columns, in_row = m % columns;
                const int column = serpentine && row % 2 ? columns - 1 - in_row : in_row;
                offset[m] =
                    (struct vector){0.04 + column * l->pitch + row * l->row_pitch + l->skew * (m * 3 % 5 - 2) / 2,
                                    row * l->across, row * l->up};
            }
            struct acquisition a = make(l->spacing, offset);
            const struct condition doppler = told(&a, "doppler"), ghost = told(&a, "ghost");
            double far = 0;
            for (int m = 0; m < RECEIVERS; m++)
                far = fmax(far, fabs(offset[m].x + speed * 0.027));
            const double reach =
                (PINGS / 2 * l->spacing + 0.1) / 19.9; /* of the track, which may end inside the beam */
            const double sine = fmin(0.443 * 0.01 / element, reach) + far / 19.9 / 2;
            const double expected = (a.fc + a.bandwidth / 2) * 2 * sine / a.sound_speed * 2 * l->sampled;
            print_message("%s: doppler %.3g (%.3g), ghost %.3g\n", l->what, doppler.value, expected, ghost.value);
            if (!(fabs(doppler.value / expected - 1) < 0.04) || condition_holds(&doppler) != (expected < 1.05))
                fail_msg("%s: doppler %g, about %g expected", l->what, doppler.value, expected);
            if (!isnan(l->ghost) && !(fabs(ghost.value - l->ghost) < 1e-9))
                fail_msg("%s: ghost %g, %g expected: %s", l->what, ghost.value, l->ghost, ghost.cure);
            acquisition_free(&a);
        }
}

/* A track of any shape at `speed`: straight, across, upright, a circle, two legs with a way between them, and one along
   which the pings lie closer and closer. */
static struct vector place_at(int shape, int p, double spacing)
{
    const double along = p * spacing, radius = PINGS * spacing / (2 * M_PI), turn = 2 * asin(spacing / 2 / radius);
    switch (shape) {
    case 0: return (struct vector){-along, 0, 0};
    case 1: return (struct vector){0, along, 5};
    case 2: return (struct vector){0, 0, along};
    case 3: return (struct vector){radius * cos(turn * p), 20 + radius * sin(turn * p), 3};
    default: return p < PINGS / 2 ? (struct vector){along, 0, 0} : (struct vector){-200 + along, 4, 0};
    }
}

static void pings_come_in_their_own_time(void **state)
{
    (void)state;
    for (int n = 0; n < 20; n++) {
        const struct vector offset[RECEIVERS] = {{0, 0, 0}};
        const int shape = n % 5;
        const double interval = n < 10 ? 0.05 : 0.02;
        const bool stated = n % 10 < 5;
        struct acquisition a = make(speed * interval, offset);
        a.pri = stated ? interval : 0;
        for (int p = 0; p < PINGS; p++) {
            const struct vector moved = place_at(shape, p, speed * interval);
            a.tx[p] = moved;
            a.velocity[p] = (struct vector){0, stated ? 0 : speed, 0};
            for (int m = 0; m < RECEIVERS; m++)
                a.rx[p * RECEIVERS + m] = moved;
        }
        a.tx_length = 0; /* all pings see all */
        const struct condition unambiguous = told(&a, "unambiguous");
        a.pri = 0.1;
        const double delay = told(&a, "unambiguous").value * 0.1;
        if (!(fabs(unambiguous.value * interval / delay - 1) < 1e-9))
            fail_msg("shape %d: %g for a delay of %g s and pings %g s apart", shape, unambiguous.value, delay,
                     interval);
        acquisition_free(&a);
    }
}

/* Nothing tells the time from ping to ping where nothing moves and no pri is stated. */
static void unknown_times_are_not_made_up(void **state)
{
    (void)state;
    const struct vector offset[RECEIVERS] = {{0, 0, 0}};
    struct acquisition a = make(0.16, offset);
    a.pri = 0;
    memset(a.velocity, 0, PINGS * sizeof *a.velocity);
    assert_true(isnan(told(&a, "unambiguous").value));
    assert_close(told(&a, "ping_spacing").value, 0, 0);
    for (int p = 0; p < PINGS; p++) { /* in one place, though they have a speed */
        a.tx[p].x = 0;
        a.velocity[p].x = speed;
    }
    assert_true(isnan(told(&a, "unambiguous").value));
    acquisition_free(&a);
}

/* Scene files state speed, pri and spacing, of which one follows from the others. */
static void speed_and_spacing_agree(void **state)
{
    (void)state;
    static const struct {
        const char *track, *cure;
        double off, unambiguous; /* unambiguous as delay of 80 ms over the pri */
    } tracks[] = {
        {"speed = 1.8; pri = 0.33333; spacing = 0.6; pings = 40; x_first = -10.0;", NULL, 0, 0.08 / 0.33333},
        {"speed = 1.8; pri = 0.05; spacing = 0.6; pings = 40; x_first = -10.0;", "0.09 m, the pings lie 0.6 m", 0.85,
         1.6},
        {"speed = 3.6; pri = 0.33333; spacing = 0.6; pings = 40; x_first = -10.0;", "1.2 m, the pings lie 0.6 m", 1,
         0.08 / 0.33333},
        {"speed = -1.8; pri = 0.33333; spacing = 0.6; pings = 40; x_first = -10.0;", "0.59999 m, the pings lie 0.6 m",
         2, 0.08 / 0.33333},
        {"speed = -1.8; pri = 0.33333; spacing = -0.6; pings = 40; x_first = 10.0;", NULL, 0, 0.08 / 0.33333},
        {"speed = 0.0; pri = 0.05; spacing = 0.6; pings = 40; x_first = -10.0;", NULL, 0, 1.6},
        {"speed = 1.8; pri = 0.33333; pings = 40; x_first = -10.0; errors_known = true;"
         "errors = ( { axis = \"surge\"; walk = 0.05; }, { axis = \"sway\"; walk = 0.3; } );",
         NULL, 0, 0.08 / 0.33333},
    };
    for (size_t k = 0; k < sizeof tracks / sizeof *tracks; k++) {
        char text[1000];
        struct scene scene;
        snprintf(text, sizeof text, "base = {\n@include \"study/template.cfg\"\n};\ntrack = { %s };\n",
                 tracks[k].track);
        support_write("scene.cfg", text);
        if (scene_load(path_of("scene.cfg"), SASBENCH_ROOT "/scenes", &scene) != STATUS_OK)
            fail_msg("%s", status_message());
        const struct condition off = told(&scene.acquisition, "ping_spacing");
        const double delay = told(&scene.acquisition, "unambiguous").value * scene.acquisition.pri;
        assert_close(off.value, tracks[k].off, 1e-4);
        assert_true(condition_holds(&off) == !tracks[k].cure && (!tracks[k].cure || strstr(off.cure, tracks[k].cure)));
        assert_close(delay / scene.acquisition.pri / tracks[k].unambiguous, 20.0 / 60, 0.02);
        scene_free(&scene);
    }
}

/* A beam that a recording does not tell is the first thing to tell. */
static void an_unknown_beam_is_named(void **state)
{
    (void)state;
    const struct vector offset[RECEIVERS] = {{0, 0, 0}};
    struct acquisition a = make(0.16, offset);
    struct condition doppler = told(&a, "doppler");
    assert_true(!condition_holds(&doppler) && !strstr(doppler.cure, "tx_length"));
    a.tx_length = 0;
    doppler = told(&a, "doppler");
    assert_true(!condition_holds(&doppler) && strstr(doppler.cure, "tx_length"));
    a.echo_sine = INFINITY; /* known to come from everywhere */
    doppler = told(&a, "doppler");
    assert_true(!condition_holds(&doppler) && !strstr(doppler.cure, "tx_length"));
    acquisition_free(&a);
}

/* And what range migration refuses for it. */
static void refusals_name_the_unknown_beam(void **state)
{
    (void)state;
    static const struct grid grid = {-0.1, 0.02, 11, 19.9, 0.025, 9, 0};
    static const char *const specs[] = {"rma_lbf", "rma_pca", "rma_wu", "rma_numeric", "rma_delay", "rma_chirp"};
    struct vector offset[RECEIVERS] = {{0, 0, 0}};
    for (size_t k = 0; k < sizeof specs / sizeof *specs; k++)
        for (int known = 0; known < 2; known++) {
            for (int m = 0; m < RECEIVERS; m++)
                offset[m].x = 0.04 * (m + 1);
            struct acquisition a = make(0.16, offset);
            struct spec spec;
            void *plan;
            a.tx_length = known ? element : 0;
            const struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
            assert_int_equal(spec_parse(specs[k], &spec), STATUS_OK);
            const enum status status = algorithm_plan(spec.algorithm, &problem, spec.options, &plan);
            print_message("%s: %s\n", specs[k], status == STATUS_OK ? "planned" : status_message());
            assert_int_equal(status, known ? STATUS_OK : STATUS_UNSUPPORTED);
            assert_true(known || strstr(status_message(), "cure: tx_length and rx_length"));
            spec.algorithm->destroy(plan);
            spec_free(&spec);
            acquisition_free(&a);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(arrays_sample_where_they_are),
        cmocka_unit_test(pings_come_in_their_own_time),
        cmocka_unit_test(unknown_times_are_not_made_up),
        cmocka_unit_test_setup_teardown(speed_and_spacing_agree, folder_make, folder_remove),
        cmocka_unit_test(an_unknown_beam_is_named),
        cmocka_unit_test(refusals_name_the_unknown_beam),
    };
    return cmocka_run_group_tests_name("sampling", tests, NULL, NULL);
}
