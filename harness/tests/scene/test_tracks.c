/* Tracks of scenes: measured places, and motion errors that the imager knows of or not. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <matio.h>

#include "metrics/metrics.h"
#include "scene/simulate.h"
#include "tests/support.h"

#define COUNT_OF(array) (sizeof array / sizeof *array)

/* study/quick with another track. */
static void scene_write(const char *name, const char *track)
{
    char text[2000];
    snprintf(text, sizeof text,
             "sonar = { fc = 150e3; bandwidth = 15e3; fs = 30e3; };\n"
             "pulse = { kind = \"lfm\"; duration = 2e-3; };\n"
             "array = { tx_length = 0.08; rx_length = 0.04; receivers = 8; first_offset = 0.04; pitch = 0.04; };\n"
             "track = { %s };\n"
             "record = { first_sample = 720; samples = 256; };\n"
             "beam = { kind = \"rect\"; truncation = \"tx\"; limit = 0.443; };\n"
             "targets = { points = ( { x = 0.0; r = 20.0; } ); };\n"
             "image = { around_targets = { half_x = 0.6; half_r = 0.15; x_step = 0.02; r_step = 0.025; }; };\n",
             track);
    support_write(name, text);
}

static void load(const char *track, struct scene *scene)
{
    scene_write("track.cfg", track);
    if (scene_load(path_of("track.cfg"), SASBENCH_ROOT "/scenes", scene) != STATUS_OK)
        fail_msg("%s", status_message());
}

#define EVEN "speed = 2.5; pri = 0.064; pings = 18; x_first = -1.52;"

static void assert_near(struct vector a, struct vector b, double tolerance)
{
    if (!(fabs(a.x - b.x) <= tolerance && fabs(a.y - b.y) <= tolerance && fabs(a.z - b.z) <= tolerance))
        fail_msg("(%.12g, %.12g, %.12g), not (%.12g, %.12g, %.12g)", a.x, a.y, a.z, b.x, b.y, b.z);
}

static void csv_write(const char *name, const char *head, double y, double yaw, const char *rest)
{
    char text[4000];
    int used = snprintf(text, sizeof text, "# by hand\n%s\n", head);
    for (int p = 0; p < 18; p++)
        used += snprintf(text + used, sizeof text - (size_t)used, "%.12g,%g,0,%g%s\n", -1.52 + p * 0.16, y, yaw, rest);
    support_write(name, text);
}

/* Places of an even track make the even track; yaw turns the receivers about the transmitter. */
static void measured_places_are_taken(void **state)
{
    (void)state;
    struct scene even, measured, turned;
    load(EVEN, &even);
    csv_write("even.csv", "x,y,z,yaw", 0, 0, "");
    load("file = \"even.csv\"; pri = 0.064;", &measured);
    const struct acquisition *a = &even.acquisition, *b = &measured.acquisition;
    assert_int_equal(b->pings, 18);
    for (int p = 0; p < 18; p++) {
        assert_near(b->tx[p], a->tx[p], 1e-12);
        assert_near(b->velocity[p], a->velocity[p], 1e-9);
        for (int m = 0; m < 8; m++)
            assert_near(b->rx[8 * p + m], a->rx[8 * p + m], 1e-12);
    }
    assert_true(acquisition_is_straight(b, NULL));
    csv_write("turned.csv", "x,y,z,yaw,vx,vy,vz", 0.3, 90, ",1,2,3");
    load("file = \"turned.csv\"; pri = 0.064;", &turned);
    const struct acquisition *c = &turned.acquisition;
    assert_near(c->tx[5], (struct vector){-1.52 + 5 * 0.16, 0.3, 0}, 1e-12);
    assert_near(c->rx[8 * 5 + 2], (struct vector){-1.52 + 5 * 0.16, 0.3 + 0.12, 0}, 1e-12);
    assert_near(c->velocity[5], (struct vector){1, 2, 3}, 0);
    assert_true(turned.hash != measured.hash);
    csv_write("turned.csv", "x,y,z,yaw,vx,vy,vz", 0.3, 90, ",1,2,3.5");
    const uint64_t before = turned.hash;
    scene_free(&turned);
    load("file = \"turned.csv\"; pri = 0.064;", &turned);
    assert_true(turned.hash != before); /* the file's content is the scene's */
    scene_free(&even);
    scene_free(&measured);
    scene_free(&turned);
}

static void matlab_places_are_taken(void **state)
{
    (void)state;
    double tx[54], yaw[18];
    struct scene scene;
    for (int p = 0; p < 18; p++) {
        tx[3 * p] = -1.52 + p * 0.16;
        tx[3 * p + 1] = 0.01 * p;
        tx[3 * p + 2] = 0;
        yaw[p] = 0;
    }
    mat_t *mat = Mat_CreateVer(path_of("track.mat"), NULL, MAT_FT_MAT5);
    matvar_t *variables[] = {Mat_VarCreate("tx", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, (size_t[]){3, 18}, tx, 0),
                             Mat_VarCreate("yaw", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, (size_t[]){18, 1}, yaw, 0)};
    for (int k = 0; k < 2; k++) {
        assert_int_equal(Mat_VarWrite(mat, variables[k], MAT_COMPRESSION_NONE), 0);
        Mat_VarFree(variables[k]);
    }
    Mat_Close(mat);
    load("file = \"track.mat\"; pri = 0.064;", &scene);
    assert_near(scene.acquisition.tx[9], (struct vector){-1.52 + 9 * 0.16, 0.09, 0}, 1e-12);
    assert_near(scene.acquisition.velocity[9], (struct vector){2.5, 0.01 / 0.064, 0}, 1e-9);
    scene_free(&scene);
}

#define SWAY "errors = ( { axis = \"sway\"; amplitude = 0.002; period = 0.8; phase = 30.0; } ); "

/* What the imager knows of is in its acquisition; what it does not is in the echoes alone. */
static void errors_are_known_or_not(void **state)
{
    (void)state;
    struct scene even, known, unknown;
    struct echoes echoes[2];
    load(EVEN, &even);
    load(EVEN SWAY "errors_known = true;", &known);
    load(EVEN SWAY, &unknown);
    assert_null(known.flown);
    assert_non_null(unknown.flown);
    for (int p = 0; p < 18; p++) {
        struct vector place = even.acquisition.tx[p];
        assert_near(unknown.acquisition.tx[p], place, 0);
        assert_near(unknown.acquisition.velocity[p], (struct vector){2.5, 0, 0}, 0);
        place.y += 0.002 * sin(2 * M_PI * p * 0.064 / 0.8 + M_PI / 6);
        assert_near(known.acquisition.tx[p], place, 1e-15);
        assert_near(unknown.flown->tx[p], place, 1e-15);
        assert_near(unknown.flown->rx[8 * p + 3], known.acquisition.rx[8 * p + 3], 0);
    }
    const double rate = known.acquisition.velocity[6].y;
    assert_true(fabs(rate - (known.acquisition.tx[7].y - known.acquisition.tx[5].y) / 0.128) < 1e-12);
    support_echoes(&known, &echoes[0]);
    support_echoes(&unknown, &echoes[1]);
    const size_t bytes = (size_t)18 * 8 * 256 * sizeof(double complex);
    assert_memory_equal(echoes[0].samples, echoes[1].samples, bytes);
    assert_ptr_equal(echoes[1].acquisition, &unknown.acquisition);

    /* Known errors are focused; unknown ones blur, which the sharpness tells. */
    struct sharpness sharpness[2];
    const struct scene *const scenes[2] = {&known, &unknown};
    for (int k = 0; k < 2; k++) {
        struct image image;
        const struct problem problem = problem_make(&scenes[k]->acquisition, 1, scenes[k]->patches, PRECISION_DOUBLE);
        assert_int_equal(support_image("bp_sinc:taps=16,window=kaiser,precision=double", problem, &echoes[k], &image),
                         STATUS_OK);
        sharpness[k] = metrics_sharpness(&image);
        image_free(&image);
    }
    print_message("peak %.4g known, %.4g unknown; entropy %.4g, %.4g\n", sharpness[0].peak, sharpness[1].peak,
                  sharpness[0].entropy, sharpness[1].entropy);
    assert_true(sharpness[1].peak < 0.75 * sharpness[0].peak);
    assert_true(sharpness[1].entropy > sharpness[0].entropy + 0.2);
    for (int k = 0; k < 2; k++)
        echoes_free(&echoes[k]);
    scene_free(&even);
    scene_free(&known);
    scene_free(&unknown);
}

/* A random walk: its steps have the stated deviation, and a seed says all. */
static void walks_are_drawn_by_their_seeds(void **state)
{
    (void)state;
    struct scene first, again, other;
    load("speed = 2.5; pri = 0.002; pings = 500; x_first = -1.0; errors_known = true; errors = ( { axis = \"heave\"; "
         "walk = 1e-3; seed = 5; }, "
         "{ axis = \"surge\"; walk = 1e-4; seed = 5; }, { axis = \"yaw\"; amplitude = 1.0; period = 0.4; } );",
         &first);
    load("speed = 2.5; pri = 0.002; pings = 500; x_first = -1.0; errors_known = true; errors = ( { axis = \"heave\"; "
         "walk = 1e-3; seed = 5; }, "
         "{ axis = \"surge\"; walk = 1e-4; seed = 5; }, { axis = \"yaw\"; amplitude = 1.0; period = 0.4; } );",
         &again);
    load("speed = 2.5; pri = 0.002; pings = 500; x_first = -1.0; errors_known = true; errors = ( { axis = \"heave\"; "
         "walk = 1e-3; seed = 6; } );",
         &other);
    double squares = 0, cross = 0;
    const struct acquisition *a = &first.acquisition;
    assert_true(a->tx[0].z == 0);
    for (int p = 1; p < 500; p++) {
        const double heave = a->tx[p].z - a->tx[p - 1].z, surge = a->tx[p].x - a->tx[p - 1].x - 0.005;
        squares += heave * heave;
        cross += heave * surge;
        assert_near(a->tx[p], again.acquisition.tx[p], 0);
    }
    assert_true(fabs(sqrt(squares / 499) / 1e-3 - 1) < 0.1); /* three times its deviation is 0.095 */
    assert_true(fabs(cross / 499) < 0.2 * 1e-7);             /* the two are drawn apart */
    assert_true(first.hash == again.hash && first.hash != other.hash);
    assert_true(a->tx[400].z != other.acquisition.tx[400].z);
    /* A quarter of a period of yaw: 1 degree of the last receiver's offset. */
    const struct vector rx = a->rx[8 * 50 + 7], tx = a->tx[50];
    assert_true(fabs(rx.y - tx.y - 0.32 * sin(M_PI / 180)) < 1e-12
                && fabs(rx.x - tx.x - 0.32 * cos(M_PI / 180)) < 1e-12);
    scene_free(&first);
    scene_free(&again);
    scene_free(&other);
}

static void wrong_tracks_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *track, *says;
    } cases[] = {
        {"pri = 0.064; pings = 18;", "key 'track.speed' is missing, must be a number that is finite m/s"},
        {"pri = 0.064; speed = 2.5;", "key 'track.pings' is missing, must be an integer >= 1"},
        {"file = \"even.csv\"; pri = 0.064; speed = 2.5;", "key 'track.speed' is 2.5, must be left out with `file`"},
        {"file = \"even.csv\"; pri = 0.064; pings = 18;", "key 'track.pings' is 18, must be left out with `file`"},
        {"file = \"even.csv\"; pri = 0.064; x_first = 1.0;", "must be left out with `file`"},
        {"file = \"even.csv\";", "key 'track.pri' is missing"},
        {"file = \"none.csv\"; pri = 0.064;", "none.csv"},
        {"file = \"none.mat\"; pri = 0.064;", "none.mat: cannot be read"},
        {"file = \"bare.csv\"; pri = 0.064;", "column 'z' is missing; x, y, z in m are needed"},
        {"file = \"word.csv\"; pri = 0.064;", "word.csv:2: y is 'wide'; a finite number is needed"},
        {"file = \"empty.csv\"; pri = 0.064;", "empty.csv: positions of 0 pings; of 1 to 67108864 are needed"},
        {"file = \"far.csv\"; pri = 0.064;", "far.csv: ping 2 lies at (0, 3e+12, 1) m; within +-1e+12 m is needed"},
        {"file = \"half.csv\"; pri = 0.064;", "column 'vy' is missing"},
        {EVEN "errors = ( { axis = \"roll\"; walk = 1e-3; } );",
         "key 'track.errors[0].axis' is \"roll\", must be one of"},
        {EVEN "errors = ( { axis = \"sway\"; } );", "either `amplitude` and `period` or `walk`"},
        {EVEN "errors = ( { amplitude = 1.0; walk = 1e-3; } );", "either `amplitude` and `period` or `walk`"},
        {EVEN "errors = ( { amplitude = 1.0; } );", "key 'track.errors[0].period' is missing, must be a number > 0 s"},
        {EVEN "errors = ( { walk = -1.0; } );", "key 'track.errors[0].walk' is -1"},
    };
    csv_write("even.csv", "x,y,z,yaw", 0, 0, "");
    support_write("bare.csv", "x,y\n1,2\n");
    support_write("word.csv", "x,y,z\n1,wide,3\n");
    support_write("empty.csv", "x,y,z\n");
    support_write("far.csv", "x,y,z\n1,2,3\n0,3e12,1\n");
    support_write("half.csv", "x,y,z,vx\n1,2,3,4\n");
    for (size_t k = 0; k < COUNT_OF(cases); k++) {
        struct scene scene;
        scene_write("track.cfg", cases[k].track);
        if (scene_load(path_of("track.cfg"), SASBENCH_ROOT "/scenes", &scene) != STATUS_INVALID
            || !strstr(status_message(), cases[k].says))
            fail_msg("%s: '%s' does not say '%s'", cases[k].track, status_message(), cases[k].says);
    }
}

/* Motion errors that the imager is not told of are a condition of the scene: the rms of their two-way phase. */
static void phases_of_unknown_errors_are_told(void **state)
{
    (void)state;
    static const struct {
        const char *track;
        double value; /* NAN: no such condition */
    } cases[] = {
        /* 1 mm across the track: 4 pi/lambda of it */
        {EVEN "errors = ( { axis = \"sway\"; amplitude = 1e-3; period = 1e9; phase = 90.0; } );", 4 * M_PI * 0.1},
        {EVEN "errors = ( { axis = \"sway\"; amplitude = 1e-5; period = 1e9; phase = 90.0; } );", 4 * M_PI * 1e-3},
        {EVEN "errors = ( { axis = \"sway\"; amplitude = 1e-3; period = 1e9; phase = 90.0; } ); errors_known = true;",
         NAN},
        /* half a degree about the transmitter: of 8 receivers the nearest is .35 mm off, m = 3 1.4, the farthest 2.8 */
        {EVEN "errors = ( { axis = \"yaw\"; amplitude = 0.5; period = 1e9; phase = 90.0; } );", 2 * M_PI * 0.182},
        {EVEN, NAN},
    };
    for (size_t n = 0; n < COUNT_OF(cases); n++) {
        struct scene scene;
        struct condition list[SCENE_CONDITIONS];
        double value = NAN;
        load(cases[n].track, &scene);
        for (int k = 0, count = scene_conditions(&scene, list); k < count; k++)
            if (strcmp(list[k].name, "motion") == 0) {
                value = list[k].value;
                assert_int_equal(list[k].severity, SEVERITY_WARN);
                assert_int_equal(condition_holds(&list[k]), value < 0.1);
            }
        if (isnan(cases[n].value))
            assert_true(isnan(value));
        else
            assert_close(value / cases[n].value, 1, 0.02);
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(measured_places_are_taken), cmocka_unit_test(matlab_places_are_taken),
        cmocka_unit_test(errors_are_known_or_not),   cmocka_unit_test(walks_are_drawn_by_their_seeds),
        cmocka_unit_test(wrong_tracks_are_refused),  cmocka_unit_test(phases_of_unknown_errors_are_told),
    };
    return cmocka_run_group_tests(tests, folder_make, folder_remove);
}
