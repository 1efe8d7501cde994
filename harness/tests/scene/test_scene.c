/* Scene files: what the shipped ones hold, how keys arrive, what is refused and how that is said; grids. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/delay.h"
#include "data/random.h"
#include "scene/scene.h"
#include "scene/simulate.h"
#include "tests/assertions.h"
#include "tests/algorithms/reference_numbers.h"

#define SHIPPED         SASBENCH_ROOT "/scenes"
#define IMAGE           "image = { around_targets = { half_x = 0.2; half_r = 0.1; x_step = 0.02; r_step = 0.025; }; };"
#define NESTED          10 /* includes, at most */
#define COUNT_OF(array) (sizeof array / sizeof *array)

/* One group a line, so that every refusal can be checked for its line. */
static const char *const base_text =
    "description = \"test\";\n"
    "sonar = { fc = 150e3; bandwidth = 15e3; fs = 30e3; };\n"
    "pulse = { kind = \"lfm\"; duration = 2e-3; };\n"
    "array = { tx_length = 0.08; rx_length = 0.04; receivers = 4; first_offset = -0.06; pitch = 0.04; };\n"
    "track = { speed = 2.5; pri = 0.064; pings = 6; x_first = -0.32; };\n"
    "record = { first_sample = 720; samples = 256; };\n"
    "beam = { kind = \"txrx\"; truncation = \"tx\"; limit = 0.443; };\n"
    "targets = { points = ( { x = 0.1; r = 20.0; } ); };\n"
    "noise = { std = 0.1; seed = 3; };\n" IMAGE "\n";

static char folder[256];

static const char *path_in(const char *name)
{
    static char path[400];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static const char *numbered(int i)
{
    char name[20];
    snprintf(name, sizeof name, "%d.cfg", i);
    return path_in(name);
}

static void write_file(const char *name, const char *text)
{
    FILE *file = fopen(path_in(name), "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static enum status load_text(const char *text, struct scene *scene)
{
    write_file("scene.cfg", text);
    return scene_load(path_in("scene.cfg"), SHIPPED, scene);
}

static struct scene loaded(const char *text)
{
    struct scene scene;
    if (load_text(text, &scene) != STATUS_OK) {
        fail_msg("%s", status_message());
    }
    return scene;
}

/* base_text with its first `find` replaced. */
static char *varied(const char *find, const char *replace)
{
    const char *at = strstr(base_text, find);
    if (!at) {
        fail_msg("no '%s' in the base scene", find);
    }
    char *text = malloc(strlen(base_text) + strlen(replace) + 1);
    assert_non_null(text);
    sprintf(text, "%.*s%s%s", (int)(at - base_text), base_text, replace, at + strlen(find));
    return text;
}

static uint64_t hash_of(const char *text)
{
    struct scene scene = loaded(text);
    uint64_t hash = scene.hash;
    scene_free(&scene);
    return hash;
}

static void assert_message_has(const char *part, const char *what)
{
    if (!strstr(status_message(), part)) {
        fail_msg("%s: '%s' is not in the message: %s", what, part, status_message());
    }
}

static int setup(void **state)
{
    (void)state;
    const char *temporary = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/sasbench-scene-XXXXXX", temporary ? temporary : "/tmp");
    return mkdtemp(folder) ? 0 : -1;
}

static int teardown(void **state)
{
    (void)state;
    const char *const files[] = {"scene.cfg",    "other.cfg",     "third.cfg",       "_part.cfg",
                                 "sub/deep.cfg", "sub/_part.cfg", "sub/.hidden.cfg", "sub/text.txt"};
    for (size_t i = 0; i < COUNT_OF(files); i++) {
        unlink(path_in(files[i]));
    }
    for (int i = 0; i <= NESTED; i++) {
        unlink(numbered(i));
    }
    rmdir(path_in("sub"));
    return rmdir(folder);
}

/* ---- Shipped scenes ---- */

/* Every point is seen over its whole beam (the first and last ping hold nothing of it) and lies in the records. */
static void check_coverage(const struct scene *scene)
{
    const struct acquisition *a = &scene->acquisition;
    double widest_hz = a->fc - (scene->beam.per_frequency ? a->bandwidth / 2 : 0);
    for (int t = 0; t < scene->point_count; t++) {
        struct vector p = {scene->targets[t].x, scene->targets[t].r, 0};
        int seen = 0;
        for (int ping = 0; ping < a->pings; ping++) {
            for (int m = 0; m < a->receivers; m++) {
                double tau =
                    delay_exact(a->tx[ping], a->rx[ping * a->receivers + m], a->velocity[ping], p, a->sound_speed);
                if (beam_weight(scene, ping, m, p, tau, widest_hz) == 0) {
                    continue;
                }
                seen++;
                double q = (tau - a->t0[ping]) * a->fs;
                if (ping == 0 || ping == a->pings - 1 || !(q >= 50 && q <= a->samples - a->pulse_length - 50)) {
                    fail_msg("%s: target %d is seen at ping %d of %d, sample %g of %d", scene->name, t, ping, a->pings,
                             q, a->samples);
                }
            }
        }
        assert_true(seen > 0);
    }
}

static void shipped_scenes_load(void **state)
{
    (void)state;
    char **names;
    int count;
    assert_int_equal(scene_names(SHIPPED, &names, &count), STATUS_OK);
    assert_true(count >= 17);
    for (int i = 0; i < count; i++) {
        struct scene scene;
        if (scene_load(names[i], SHIPPED, &scene) != STATUS_OK) {
            fail_msg("%s", status_message());
        }
        assert_string_equal(scene.name, names[i]);
        assert_true(strlen(scene.description) > 10);
        assert_true(i == 0 || strcmp(names[i - 1], names[i]) < 0);
        assert_null(strstr(names[i], "/_"));
        double pixels = 0, pairs = (double)scene.acquisition.pings * scene.acquisition.receivers;
        for (int k = 0; k < scene.patch_count; k++) {
            pixels += (double)scene.patches[k].x_count * scene.patches[k].r_count;
        }
        assert_true(scene.full_size || pixels * pairs < 1e8); /* the exact image stays a matter of seconds */
        if (strncmp(names[i], "extreme/", 8) != 0) {
            check_coverage(&scene);
        }
        scene_free(&scene);
    }
    scene_names_free(names, count);
}

static void reference_scenes_have_the_reference_geometry(void **state)
{
    (void)state;
    const double target[4][2] = {{90, 0}, {74, 6}, {260, 16}, {50, 2.5}};
    const int active_pairs[4] = {520, 425, 1442, 1188};
    assert_int_equal(COUNT_OF(reference_scenes), 4);
    for (int i = 0; i < 4; i++) {
        const struct reference_scene *expected = &reference_scenes[i];
        struct scene scene;
        assert_int_equal(scene_load(expected->scene, SHIPPED, &scene), STATUS_OK);
        const struct acquisition *a = &scene.acquisition;
        assert_int_equal(scene.target_count, 1);
        assert_true(scene.targets[0].r == target[i][0] && scene.targets[0].x == target[i][1]);
        struct vector p = {scene.targets[0].x, scene.targets[0].r, 0};
        int active = 0;
        for (int k = 0; k < a->pings * a->receivers; k++) {
            double tau = delay_exact(a->tx[k / a->receivers], a->rx[k], a->velocity[0], p, a->sound_speed);
            active += beam_weight(&scene, k / a->receivers, k % a->receivers, p, tau, a->fc) != 0;
        }
        assert_int_equal(active, active_pairs[i]);
        for (int k = 0; k < 3; k++) {
            int ping = expected->delays[k].ping, m = expected->delays[k].receiver;
            double tau = delay_exact(a->tx[ping], a->rx[ping * a->receivers + m], a->velocity[ping], p, a->sound_speed);
            assert_true(fabs(tau - expected->delays[k].tau) < 1e-12);
            assert_true(fabs(beam_weight(&scene, ping, m, p, tau, a->fc) - expected->delays[k].weight) < 1e-12);
        }
        scene_free(&scene);
    }
}

static void full_size_scenes_have_their_papers_sizes(void **state)
{
    (void)state;
    struct scene full, limited;
    assert_int_equal(scene_load("bp22/full", SHIPPED, &full), STATUS_OK);
    assert_int_equal(scene_load(SHIPPED "/bp22/full_limited.cfg", SHIPPED, &limited), STATUS_OK);
    assert_string_equal(limited.name, "bp22/full_limited");
    assert_true(full.full_size && limited.full_size);
    assert_int_equal(full.patches[0].x_count, 2880);
    assert_int_equal(full.patches[0].r_count, 4800);
    assert_int_equal(full.reference_count, 6);
    assert_true(isinf(full.acquisition.aperture_limit));
    assert_true(limited.acquisition.aperture_limit == 0.125);
    assert_true(full.hash != limited.hash);
    assert_memory_equal(&full.patches[0], &limited.patches[0], sizeof full.patches[0]);
    scene_free(&full);
    scene_free(&limited);
}

/* ---- Keys ---- */

static void keys_arrive(void **state)
{
    (void)state;
    struct scene scene = loaded(base_text);
    const struct acquisition *a = &scene.acquisition;
    assert_string_equal(scene.name, "scene");
    assert_string_equal(scene.description, "test");
    assert_true(a->sound_speed == 1500 && a->fc == 150e3 && a->bandwidth == 15e3 && a->fs == 30e3);
    assert_true(a->tx_length == 0.08 && a->rx_length == 0.04 && isinf(a->aperture_limit));
    assert_true(a->pings == 6 && a->receivers == 4 && a->samples == 256);
    assert_true(!a->compressed && a->pulse_length == 60 && fabs(cabs(a->pulse[59]) - 1) < 1e-12);
    for (int p = 0; p < 6; p++) {
        double x = -0.32 + p * 2.5 * 0.064;
        assert_true(fabs(a->t0[p] - 0.024) < 1e-15);
        assert_true(fabs(a->tx[p].x - x) < 1e-12 && a->tx[p].y == 0 && a->tx[p].z == 0);
        assert_true(a->velocity[p].x == 2.5 && a->velocity[p].y == 0 && a->velocity[p].z == 0);
        for (int m = 0; m < 4; m++) {
            assert_true(fabs(a->rx[p * 4 + m].x - (x - 0.06 + 0.04 * m)) < 1e-12);
        }
    }
    assert_true(scene.pulse_kind == PULSE_LFM && scene.pulse_duration == 2e-3);
    assert_true(scene.beam.kind == BEAM_TXRX && scene.beam.truncation == TRUNCATION_TX && scene.beam.limit == 0.443);
    assert_true(!scene.beam.per_frequency && !scene.full_size);
    assert_true(scene.noise_std == 0.1 && scene.noise_seed == 3);
    assert_true(scene.point_count == 1 && scene.target_count == 1 && scene.targets[0].amplitude == 1);
    const struct grid *grid = &scene.patches[0];
    assert_true(scene.patch_count == 1 && grid->x_count == 21 && grid->r_count == 9);
    assert_true(fabs(grid->x_first + 10 * grid->x_step - 0.1) < 1e-12);
    assert_true(fabs(grid->r_first + 4 * grid->r_step - 20) < 1e-12);
    assert_true(scene.reference_count == 0 && !scene.reference_patches);
    scene_free(&scene);
}

static void choices_and_defaults_arrive(void **state)
{
    (void)state;
    struct scene scene = loaded(
        "full_size = true; aperture_limit = 0.5;\n"
        "sonar = { sound_speed = 340; fc = 40000; bandwidth = 5000L; fs = 10e3; };\n"
        "pulse = { kind = \"flat\"; };\n"
        "array = { receivers = 1; };\n"
        "track = { speed = -1; pri = 0.5; pings = 2; };\n"
        "record = { first_sample = -5; samples = 100; };\n"
        "targets = { points = ( { x = 0; r = -1; amplitude = (3, -4.5); }, { x = 1; r = 1; amplitude = -2; } );\n"
        "            fields = ( { x = [-1, 1]; r = (0.5, 1); count = 5; seed = 8; },\n"
        "                       { x = [2, 2]; r = [1, 1]; count = 2; seed = 9; } ); };\n"
        "image = { patches = (\n"
        " { x = { first = -1; step = 0.5; count = 3; }; r = { first = -1; step = 1; count = 2; }; },\n"
        " { x = { first = 0; step = 1; count = 1; }; r = { first = 1; step = 1; count = 1; }; } ); };\n");
    const struct acquisition *a = &scene.acquisition;
    assert_true(scene.full_size && a->aperture_limit == 0.5 && a->sound_speed == 340 && a->bandwidth == 5000);
    assert_true(a->compressed && a->pulse_length == 0 && !a->pulse && scene.pulse_kind == PULSE_FLAT);
    assert_true(a->tx[1].x == -0.5 && a->velocity[1].x == -1);
    assert_true(a->tx[0].x == 0 && a->rx[0].x == 0 && a->t0[0] == -5 / 10e3 && a->tx_length == 0);
    assert_true(scene.beam.kind == BEAM_RECT && scene.beam.truncation == TRUNCATION_NONE);
    assert_true(scene.noise_std == 0 && *scene.description == '\0');
    assert_true(scene.point_count == 2 && scene.target_count == 9);
    assert_true(creal(scene.targets[0].amplitude) == 3 && cimag(scene.targets[0].amplitude) == -4.5);
    assert_true(scene.targets[1].amplitude == -2 && scene.targets[0].r == -1);
    assert_true(scene.targets[7].x == 2 && scene.targets[8].r == 1);
    assert_true(scene.patch_count == 2 && scene.patches[0].x_count == 3 && scene.patches[1].r_first == 1);
    scene_free(&scene);
}

/* Values of another implementation of the generator, seed 1, and the moments of many draws. */
static void fields_can_be_repeated(void **state)
{
    (void)state;
    struct scene scene;
    assert_int_equal(scene_load("study/speckle", SHIPPED, &scene), STATUS_OK);
    assert_int_equal(scene.target_count, 40);
    assert_true(fabs(scene.targets[0].x - 0.38702427802045847) < 1e-12);
    assert_true(fabs(scene.targets[0].r - 100.32570673594209) < 1e-12);
    assert_true(cabs(scene.targets[0].amplitude - (0.2579231448960499 - 0.6997092155067307 * I)) < 1e-12);
    assert_true(fabs(scene.targets[1].x + 0.28197467629579354) < 1e-12);
    assert_true(cabs(scene.targets[1].amplitude - (-0.3077237362204419 + 1.2890287949588786 * I)) < 1e-12);
    scene_free(&scene);

    char *text =
        varied("points = ( { x = 0.1; r = 20.0; } );", "points = ( { x = 0; r = 20.0; } ); fields = "
                                                       "( { x = [-2, 4]; r = [19, 21]; count = 20000; seed = 5; } );");
    scene = loaded(text);
    double complex mean = 0;
    double energy = 0, x = 0, r_square = 0;
    for (int i = 1; i < scene.target_count; i++) {
        const struct target *target = &scene.targets[i];
        assert_true(target->x >= -2 && target->x <= 4 && target->r >= 19 && target->r <= 21);
        mean += target->amplitude / 20000;
        energy += creal(target->amplitude * conj(target->amplitude)) / 20000;
        x += target->x / 20000;
        r_square += (target->r - 20) * (target->r - 20) / 20000;
    }
    assert_true(cabs(mean) < 0.03 && fabs(energy - 1) < 0.03);
    assert_true(fabs(x - 1) < 0.05 && fabs(r_square - 1.0 / 3) < 0.01);
    scene_free(&scene);
    free(text);
}

static void reference_patches_are_cut_from_the_grid(void **state)
{
    (void)state;
    char *text = varied("around_targets = { half_x = 0.2; half_r = 0.1; x_step = 0.02; r_step = 0.025; };",
                        "x = { first = 0.03; step = 0.05; count = 40; };"
                        "r = { first = 19.5; step = 0.25; count = 7; };"
                        "reference = { half_x = 0.2; half_r = 0.5; };");
    struct scene scene = loaded(text);
    const struct grid *cut = scene.reference_patches;
    assert_true(scene.patch_count == 1 && scene.patches[0].x_count == 40 && scene.reference_count == 1);
    assert_true(cut->x_first == 0.03 && cut->x_step == 0.05 && cut->x_count == 6); /* 1 - 4 < 0 to 1 + 4 */
    assert_true(cut->r_first == 19.5 && cut->r_step == 0.25 && cut->r_count == 5);
    scene_free(&scene);
    free(text);
}

/* ---- @include and base ---- */

static void one_scene_varies_another(void **state)
{
    (void)state;
    write_file("other.cfg", base_text);
    write_file("_part.cfg", "sonar = { fc = 100e3; bandwidth = 10e3; fs = 30e3; };\n");
    struct scene scene = loaded("base = {\n  @include \"other.cfg\"\n};\n"
                                "track = { speed = 1; pri = 0.1; pings = 3; };\n"
                                "@include \"_part.cfg\"\n");
    assert_true(scene.acquisition.pings == 3 && scene.acquisition.tx[0].x == 0); /* x_first is not the base's */
    assert_true(scene.acquisition.fc == 100e3 && scene.acquisition.receivers == 4);
    assert_string_equal(scene.description, "test");
    uint64_t hash = scene.hash;
    scene_free(&scene);

    /* A variant of a variant, and the hash of the same content in one file. */
    write_file("third.cfg", "base = {\n@include \"other.cfg\"\n};\n@include \"_part.cfg\"\n"
                            "description = \"third\";\n");
    scene = loaded("base = {\n@include \"third.cfg\"\n};\ntrack = { speed = 1; pri = 0.1; pings = 3; };\n");
    assert_true(scene.acquisition.pings == 3 && scene.acquisition.fc == 100e3 && scene.noise_seed == 3);
    assert_string_equal(scene.description, "third");
    assert_true(scene.hash == hash);
    scene_free(&scene);

    /* What an included file gets wrong is said with that file's name and line. */
    write_file("_part.cfg", "\nsonar = { fc = 100e3; bandwidth = 10e3; fs = -3; };\n");
    struct scene bad;
    assert_int_equal(load_text("base = {\n@include \"other.cfg\"\n};\n@include \"_part.cfg\"\n", &bad), STATUS_INVALID);
    assert_message_has(path_in("_part.cfg:2: key 'sonar.fs' is -3, must be a number > 0 Hz"), "included");
    char *text = varied("fc = 150e3;", "fc = 150e3; colour = 3;");
    write_file("other.cfg", text);
    free(text);
    assert_int_equal(load_text("base = {\n@include \"other.cfg\"\n};\n", &bad), STATUS_INVALID);
    assert_message_has(path_in("other.cfg:2: key 'base.sonar.colour' is 3, must be left out"), "base");
}

/* The hash of the scene file `name` with includes that are not beside it looked for in `directory`. */
static uint64_t hash_of_file(const char *name, const char *directory)
{
    struct scene scene;
    if (scene_load(name, directory, &scene) != STATUS_OK) {
        fail_msg("%s", status_message());
    }
    uint64_t hash = scene.hash;
    scene_free(&scene);
    return hash;
}

/* From a folder elsewhere: speckle and near themselves include ../bp22/_array.cfg. */
static void shipped_scenes_can_be_included(void **state)
{
    (void)state;
    assert_true(hash_of("@include \"" SHIPPED "/study/speckle.cfg\"\n") == hash_of_file("study/speckle", SHIPPED));
    assert_true(hash_of("@include \"study/near.cfg\"\n") == hash_of_file("study/near", SHIPPED));
    struct scene scene;
    assert_int_equal(load_text("@include \"study/near\"\n", &scene), STATUS_INVALID);
    assert_message_has(path_in("scene.cfg:1: @include of "), "no extension");
    assert_message_has("study/near: No such file", "no extension");
    assert_message_has("from " SHIPPED, "no extension");
    assert_int_equal(load_text("@include \"/study/near.cfg\"\n", &scene), STATUS_INVALID);
    assert_message_has("@include of /study/near.cfg: No such file", "absolute");
}

/* The folder of the including file comes first, then the shipped scenes'; here that is the outer folder. */
static void includes_are_relative_to_their_file(void **state)
{
    (void)state;
    assert_int_equal(mkdir(path_in("sub"), 0777), 0);
    write_file("other.cfg", base_text);
    write_file("sub/deep.cfg", "base = {\n@include \"../other.cfg\"\n};\n@include \"_part.cfg\"");
    write_file("sub/_part.cfg", "sonar = { fc = 100e3; bandwidth = 10e3; fs = 30e3; };  # without a line's end");
    write_file("_part.cfg", "sonar = { fc = 200e3; bandwidth = 10e3; fs = 30e3; };\n");
    struct scene scene = loaded("@include \"sub/deep.cfg\"\nnoise = { std = 7; };\n");
    assert_true(scene.acquisition.fc == 100e3 && scene.acquisition.pings == 6 && scene.noise_std == 7);
    scene_free(&scene);

    assert_int_equal(scene_load("sub/deep", folder, &scene), STATUS_OK);
    assert_true(scene.acquisition.fc == 100e3);
    scene_free(&scene);
    assert_int_equal(unlink(path_in("sub/_part.cfg")), 0);
    assert_int_equal(scene_load("sub/deep", folder, &scene), STATUS_OK);
    assert_true(scene.acquisition.fc == 200e3);
    scene_free(&scene);
    assert_int_equal(mkdir(path_in("sub/_part.cfg"), 0777), 0); /* no file, but there */
    assert_int_equal(scene_load("sub/deep", folder, &scene), STATUS_INVALID);
    assert_message_has("sub/_part.cfg: not a regular file", "folder");
    assert_int_equal(rmdir(path_in("sub/_part.cfg")), 0);
}

/* The first line of each file counts as 1, wherever it is included, and the lines after an include go on. */
static void errors_name_the_line_of_their_file(void **state)
{
    (void)state;
    assert_int_equal(mkdir(path_in("sub"), 0777), 0);
    write_file("other.cfg", base_text);
    const struct {
        const char *scene, *deep, *part, *message; /* scene.cfg includes sub/deep.cfg, and that sub/_part.cfg */
    } cases[] = {
        {"", "", "fc = -1;", "sub/_part.cfg:1: key 'sonar.fc' is -1,"},
        {"", "", "fc = {{", "sub/_part.cfg:1: syntax error"},
        {"", "", "fc = 1; fc = 2;", "sub/_part.cfg:1: duplicate setting name"},
        {"", "", "fc = 3000000000;", "sub/_part.cfg:1: 3000000000 is out of range"},
        {"", "", "fc = \"a", "sub/_part.cfg:1: \"a is not closed"},
        {"", "", "/* here", "sub/_part.cfg:1: /* here is not closed, must end with */ in its file"},
        {"", "", "@include \"nosuch.cfg\"", "sub/_part.cfg:1: @include of "},
        {"", "", "@include nosuch", "sub/_part.cfg:1: @include nosuch is misplaced"},
        {"", "fish = 1;", "", "sub/deep.cfg:5: key 'sonar.fish' is 1,"},
        {"", "fish = ;", "", "sub/deep.cfg:5: syntax error"},
        {"", "fish = 3000000000;", "", "sub/deep.cfg:5: 3000000000 is out of range"},
        {"fish = 1;", "", "", "scene.cfg:8: key 'fish' is 1,"},
        {"fish = ;", "", "", "scene.cfg:8: syntax error"},
        {"fish = \"", "", "", "scene.cfg:8: \" is not closed"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[300], expected[500];
        struct scene scene;
        write_file("sub/_part.cfg", cases[i].part);
        snprintf(text, sizeof text, "\n\n  @include \"_part.cfg\"  # at the end of deep's third line\n\n%s\n",
                 cases[i].deep);
        write_file("sub/deep.cfg", text);
        snprintf(text, sizeof text,
                 "base = {\n@include \"other.cfg\"\n};\nsonar = {\n@include \"sub/deep.cfg\"\n};"
                 "\n\n%s\n",
                 cases[i].scene);
        assert_int_equal(load_text(text, &scene), STATUS_INVALID);
        snprintf(expected, sizeof expected, "%s/%s", folder, cases[i].message);
        if (strncmp(status_message(), expected, strlen(expected)) != 0) {
            fail_msg("case %zu: the message does not begin with '%s': %s", i, expected, status_message());
        }
    }
}

/* Files 0 to 9 each include the next, and scene.cfg the second or first: ten deep are accepted, eleven not. */
static void includes_have_bounds(void **state)
{
    (void)state;
    enum { LONG = 8 << 20 };
    struct scene scene;
    for (int i = 0; i < NESTED; i++) {
        char name[20], text[60];
        snprintf(name, sizeof name, "%d.cfg", i);
        snprintf(text, sizeof text, "@include \"%d.cfg\"\n", i + 1);
        write_file(name, text);
    }
    write_file("10.cfg", base_text);
    assert_true(hash_of("@include \"1.cfg\"\n") == hash_of(base_text));
    assert_int_equal(load_text("@include \"0.cfg\"\n", &scene), STATUS_INVALID);
    assert_message_has(path_in("9.cfg:1: @include of 10.cfg is nested too deep"), "depth");

    char *comment = malloc(LONG + 1);
    assert_non_null(comment);
    memset(comment, '#', LONG);
    comment[LONG] = '\0';
    write_file("0.cfg", comment);
    free(comment);
    char nine[400] = "";
    for (int i = 0; i < 9; i++) {
        strcat(nine, "@include \"0.cfg\"\n");
    }
    assert_int_equal(load_text(nine, &scene), STATUS_INVALID);
    assert_message_has("0.cfg: the scene is too long with this file, must have at most 67108864 bytes", "length");
}

static void hash_follows_the_content(void **state)
{
    (void)state;
    const char *const same[][2] = {
        {"sonar = {", "# a comment\nsonar = // another\n/* 99999999999 */ {"},
        {"fc = 150e3; bandwidth = 15e3;", "bandwidth: 15000, fc=150000.0"},
        {"test", "another description: it measures nothing"},
        {"half_x = 0.2;", "half_x = 2e-1"},
        {"sonar = {", "sonar = { sound_speed = 1500;"},
        {"points = (", "fields = (); points = ("},
    };
    const char *const other[][2] = {
        {"fc = 150e3", "fc = 150.001e3"},
        {"lfm", "lfm_time"},
        {"x_first = -0.32", "x_first = -0.33"},
        {"x = 0.1;", "x = 0.1000001;"},
        {"seed = 3", "seed = 4"},
        {"half_x = 0.2", "half_x = 0.22"},
        {"r = 20.0;", "r = 20.0; amplitude = [1.0, 0.1];"},
        {"limit = 0.443;", "limit = 0.443; per_frequency = true;"},
        {"{ x = 0.1; r = 20.0; }", "{ x = 0.1; r = 20.0; }, { x = 0.1; r = 20.0; }"},
    };
    uint64_t hash = hash_of(base_text);
    for (size_t i = 0; i < COUNT_OF(same); i++) {
        char *text = varied(same[i][0], same[i][1]);
        if (hash_of(text) != hash) {
            fail_msg("'%s' changes the hash", same[i][1]);
        }
        free(text);
    }
    for (size_t i = 0; i < COUNT_OF(other); i++) {
        char *text = varied(other[i][0], other[i][1]);
        if (hash_of(text) == hash) {
            fail_msg("'%s' leaves the hash", other[i][1]);
        }
        free(text);
    }
}

/* ---- Refusals ---- */

/* Each is base_text with `find` replaced; the message names the file, the line (0: none), and has both texts. */
static const struct refusal {
    const char *find, *replace;
    int line;
    const char *key, *accepted;
} refusals[] = {
    {"fs = 30e3;", "fs = -3;", 2, "key 'sonar.fs' is -3,", "> 0 Hz"},
    {"fs = 30e3;", "fs = 0.0;", 2, "key 'sonar.fs' is 0.0,", "> 0 Hz"},
    {"fs = 30e3;", "fs = 1e999;", 2, "key 'sonar.fs' is inf,", "> 0 Hz"},
    {"fs = 30e3;", "fs = nan;", 2, "syntax error", "libconfig"},
    {"fs = 30e3;", "fs = \"30e3\";", 2, "key 'sonar.fs' is \"30e3\",", "a number > 0 Hz"},
    {"fs = 30e3;", "fs = [30e3];", 2, "key 'sonar.fs' is an array [ ... ] of 30000.0,", "a number > 0 Hz"},
    {"fs = 30e3;", "", 2, "key 'sonar.fs' is missing,", "a number > 0 Hz"},
    {"fs = 30e3;", "fs = 10e3;", 2, "key 'sonar.fs' is 10000.0,", "at least sonar.bandwidth (15000 Hz)"},
    {"fs = 30e3;", "fs = 30e3; fs = 40e3;", 2, "duplicate setting name", "each key once"},
    {"fs = 30e3;", "fs = 30e3; colour = \"red\";", 2, "key 'sonar.colour' is \"red\",",
     "left out: unknown, accepted are sound_speed, fc, fs, bandwidth"},
    {"fc = 150e3;", "", 2, "key 'sonar.fc' is missing,", "> 0 Hz"},
    {"fc = 150e3;", "fc = 150e15;", 0, "phase error", "at most"},
    {"fc = 150e3;", "sound_speed = 0; fc = 150e3;", 2, "key 'sonar.sound_speed' is 0,", "> 0 and <= 1000000000 m/s"},
    {"bandwidth = 15e3;", "bandwidth = true;", 2, "key 'sonar.bandwidth' is true,", "a number > 0 Hz"},
    {"sonar = { fc = 150e3; bandwidth = 15e3; fs = 30e3; };", "", 0, "key 'sonar' is missing,", "a group { ... }"},
    {"sonar = { fc = 150e3; bandwidth = 15e3; fs = 30e3; };", "sonar = 3;", 2, "key 'sonar' is 3,", "a group"},
    {"description = \"test\";", "description = 3;", 1, "key 'description' is 3,", "a text of one line"},
    {"description = \"test\";", "description = \"a\\nb\";", 1, "key 'description' is", "a text of one line"},
    {"description = \"test\";", "descriptoin = \"test\";", 1, "key 'descriptoin' is \"test\",", "left out: unknown"},
    {"description = \"test\";", "full_size = 1;", 1, "key 'full_size' is 1,", "true or false"},
    {"description = \"test\";", "aperture_limit = 1.5;", 1, "key 'aperture_limit' is 1.5,", "> 0 and <= 1"},
    {"description = \"test\";", "aperture_limit = -0.1;", 1, "key 'aperture_limit' is -0.1,", "> 0 and <= 1"},
    {"description = \"test\";", "base = 3;", 1, "key 'base' is 3,", "a group { ... }"},
    {"description = \"test\";", "base = { fish = 1; };", 1, "key 'base.fish' is 1,", "left out: unknown"},
    {"\"lfm\"", "\"chirp\"", 3, "key 'pulse.kind' is \"chirp\",", "one of \"lfm\", \"lfm_time\", \"flat\""},
    {"\"lfm\"", "1", 3, "key 'pulse.kind' is 1,", "one of \"lfm\""},
    {"\"lfm\"", "\"flat\"", 3, "key 'pulse.duration' is 0.002,", "left out with pulse.kind \"flat\""},
    {"duration = 2e-3;", "", 3, "key 'pulse.duration' is missing,", "> 0 s"},
    {"duration = 2e-3;", "duration = 0;", 3, "key 'pulse.duration' is 0,", "> 0 s"},
    {"duration = 2e-3;", "duration = 0.1;", 3, "key 'pulse.duration' is 0.1,", "no longer than the record"},
    {"duration = 2e-3;", "duration = 1e300;", 3, "key 'pulse.duration' is 1e+300,", "no longer than the record"},
    {"receivers = 4;", "receivers = 0;", 4, "key 'array.receivers' is 0,", "an integer from 1 to 2147483647"},
    {"receivers = 4;", "receivers = 4.0;", 4, "key 'array.receivers' is 4.0,", "an integer from 1"},
    {"receivers = 4;", "receivers = -1;", 4, "key 'array.receivers' is -1,", "an integer from 1"},
    {"receivers = 4;", "receivers = 5000000000L;", 4, "key 'array.receivers' is 5000000000,", "an integer from 1"},
    {"receivers = 4;", "receivers = 4294967300;", 4, "4294967300 is out of range", "an integer from -2147483648"},
    {"receivers = 4;", "receivers = 0x100000004;", 4, "0x100000004 is out of range", "an integer from"},
    {"receivers = 4;", "receivers = 99999999999999999999L;", 4, "is out of range", "up to 2^63"},
    {"receivers = 4;", "", 4, "key 'array.receivers' is missing,", "an integer from 1"},
    {"tx_length = 0.08;", "", 4, "key 'array.tx_length' is missing,", "with beam.kind \"txrx\" or a beam.truncation"},
    {"tx_length = 0.08;", "tx_length = -1;", 4, "key 'array.tx_length' is -1,", "> 0 and <= 1e+12 m"},
    {"rx_length = 0.04;", "", 4, "key 'array.rx_length' is missing,", "> 0 m with beam.kind \"txrx\""},
    {"pitch = 0.04;", "", 4, "key 'array.pitch' is missing,", "other than 0 m with 4 receivers"},
    {"speed = 2.5;", "speed = 1500;", 5, "key 'track.speed' is 1500,", "below sonar.sound_speed (1500 m/s)"},
    {"speed = 2.5;", "speed = -1e400;", 5, "key 'track.speed' is -inf,", "a number that is finite m/s"},
    {"pri = 0.064;", "pri = -1;", 5, "key 'track.pri' is -1,", "> 0 s"},
    {"pri = 0.064;", "pri = 1e308;", 5, "key 'track.pri' is 1e+308,", "of 6 pings at 2.5 m/s"},
    {"pings = 6;", "pings = 6.5;", 5, "key 'track.pings' is 6.5,", "an integer from 1"},
    {"pings = 6;", "pings = 2147483647;", 5, "key 'track.pings' is 2147483647,",
     "such that 2147483647 pings x 4 receivers are at most 67108864 records"},
    {"receivers = 4;", "receivers = 1000000000;", 4, "key 'array.receivers' is 1000000000,",
     "such that 6 pings x 1000000000 receivers are at most 67108864 records"},
    {"samples = 256;", "samples = 1;", 6, "key 'record.samples' is 1,", "an integer from 2"},
    {"samples = 256;", "samples = 60;", 0, "no pixel meets any record", "must lie in the records'"},
    {"samples = 256;", "", 6, "key 'record.samples' is missing,", "an integer from 2"},
    {"first_sample = 720;", "first_sample = 720.0;", 6, "key 'record.first_sample' is 720.0,", "an integer"},
    {"first_sample = 720;", "first_sample = 7200;", 0, "no pixel meets any record", "0.24"},
    {"\"tx\"", "\"rx\"", 7, "key 'beam.truncation' is \"rx\",", "one of \"none\", \"tx\", \"mid\", \"doppler\""},
    {"limit = 0.443;", "", 7, "key 'beam.limit' is missing,", "a number > 0 with beam.truncation \"tx\""},
    {"limit = 0.443;", "limit = 0.0;", 7, "key 'beam.limit' is 0.0,", "> 0"},
    {"truncation = \"tx\";", "", 7, "key 'beam.limit' is 0.443,", "left out with beam.truncation \"none\""},
    {"limit = 0.443;", "limit = 0.443; per_frequency = 1;", 7, "key 'beam.per_frequency' is 1,", "true or false"},
    {"{ x = 0.1; r = 20.0; }", "", 8, "key 'targets.points' is a list ( ... ),", "at least one target"},
    {"{ x = 0.1; r = 20.0; }", "{ x = 0.1; r = 20.0; }, 3", 8, "key 'targets.points[1]' is 3,", "a group { ... }"},
    {"x = 0.1; r = 20.0;", "x = 0.1;", 8, "key 'targets.points[0].r' is missing,", "a number from -1e+12 to 1e+12 m"},
    {"r = 20.0;", "r = 1e13;", 8, "key 'targets.points[0].r' is 1e+13,", "from -1e+12 to 1e+12 m"},
    {"r = 20.0;", "r = 20.0; y = 3;", 8, "key 'targets.points[0].y' is 3,", "unknown, accepted are x, r, amplitude"},
    {"r = 20.0;", "r = 20.0; amplitude = [1, 2, 3];", 8, "key 'targets.points[0].amplitude' is an array",
     "a number or [re, im]"},
    {"r = 20.0;", "r = 20.0; amplitude = [1, 2.5];", 8, "mismatched element type in array", "arrays of one type"},
    {"r = 20.0;", "r = 20.0; amplitude = \"loud\";", 8, "key 'targets.points[0].amplitude' is \"loud\",", "[re, im]"},
    {"points = (", "fields = ( { x = [1, -1]; r = [1, 2]; count = 3; seed = 1; } ); points = (", 8,
     "key 'targets.fields[0].x' is an array [ ... ] of 1, -1,", "[min, max] with min <= max"},
    {"points = (", "fields = ( { x = [-1, 1]; r = [1, 2]; count = 3; } ); points = (", 8,
     "key 'targets.fields[0].seed' is missing,", "an integer from 0"},
    {"points = (", "fields = ( { x = [-1, 1]; r = [1, 2]; count = 20000000; seed = 1; } ); points = (", 8,
     "key 'targets.fields[0].count' is 20000000,", "an integer from 1 to 10000000"},
    {"points = (", "fields = ( { x = [-1, 1]; r = [1, 2]; count = 10000000; seed = 1; } ); points = (", 8,
     "key 'targets.fields[0].count' is 10000000,", "all targets are at most 10000000"},
    {"( { x = 0.1; r = 20.0; } )", "{ x = 0.1; r = 20.0; }", 8, "key 'targets.points' is a group", "a list ( ... )"},
    {"std = 0.1;", "std = -0.1;", 9, "key 'noise.std' is -0.1,", "a number from 0"},
    {"seed = 3;", "seed = 3.5;", 9, "key 'noise.seed' is 3.5,", "an integer from 0"},
    {"seed = 3;", "seed = -3;", 9, "key 'noise.seed' is -3,", "an integer from 0"},
    {"image = {", "image = { x = { first = 0; step = 1; count = 1; }; r = { first = 20; step = 1; count = 1; };", 10,
     "key 'image' is a group", "exactly one of `x` with `r`, `around_targets`, `patches`"},
    {IMAGE, "image = { };", 10, "key 'image' is a group", "exactly one of"},
    {IMAGE, "image = { x = { first = 0; step = 1; count = 1; }; };", 10, "key 'image.r' is missing,",
     "together with `x`"},
    {IMAGE, "image = { patches = (); };", 10, "key 'image.patches' is a list", "at least one patch"},
    {IMAGE,
     "image = { x = { first = 5; step = 0.1; count = 3; }; r = { first = 20; step = 1; count = 1; };"
     "reference = { half_x = 1; half_r = 1; }; };",
     10, "key 'image.reference' is a group", "holds a pixel of the image"},
    {IMAGE, "image = { x = { first = 5; step = 0.1; count = 0; }; r = { first = 20; step = 1; count = 1; }; };", 10,
     "key 'image.x.count' is 0,", "an integer from 1"},
    {IMAGE,
     "image = { x = { first = 5; step = 0.1; count = 2000000000; };"
     " r = { first = 20; step = 1; count = 2000000000; }; };",
     0, "2000000000 x 2000000000 pixels", "at most"},
    {"r_step = 0.025; }; };", "r_step = 0.025; }; reference = { half_x = 1; half_r = 1; }; };", 10,
     "key 'image.reference' is a group", "left out without `x` and `r`"},
    {"r_step = 0.025;", "r_step = 0;", 10, "key 'image.around_targets.r_step' is 0,", "> 0 m"},
    {"half_x = 0.2;", "half_x = 1e11;", 10, "key 'image.around_targets.half_x' is 1e+11,", "at most 1073741823 steps"},
    {"half_x = 0.2;", "half_x = -1;", 10, "key 'image.around_targets.half_x' is -1,", "from 0"},
    {"targets = { points = ( { x = 0.1; r = 20.0; } ); };", "", 0, "key 'targets.points' is missing,",
     "at least one target"},
    {"noise = {", "@include \"nosuch.cfg\"\nnoise = {", 9, "nosuch.cfg: No such file", "must be a readable file"},
    {"noise = {", "@include \".\"\nnoise = {", 9, "not a regular file", "must be a readable file"},
    {"noise = {", "base = {\n@include \"scene.cfg\"\n};\nnoise = {", 10, "nested too deep", "may include itself"},
    {"noise = {", "@include \"\"\nnoise = {", 9, "not a regular file", "must be a readable file"},
    {"noise = {", "@include nosuch\nnoise = {", 9, "@include nosuch is misplaced", "must be @include \"FILE\""},
    {"noise = {", "@include \"nosuch\nnoise = {", 9, "@include \"nosuch is misplaced", "must be @include \"FILE\""},
    {"noise = {", "base = { @include \"scene.cfg\"\n};\nnoise = {", 9, "is misplaced", "beginning of a line"},
    {"noise = {", "/* noise = {", 9, "/* noise = { std = 0.1; seed = 3; }; is not closed", "must end with */"},
    {"noise = {", "noise = {{", 9, "syntax error", "libconfig"},
    {"description = \"test\";", "description = \"test;", 1, "\"test; is not closed", "must end with \" on its line"},
    {"image = {", "image = { \"", 10, "is not closed", "must end with \""},
};

static void malformed_scenes_are_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(refusals); i++) {
        const struct refusal *refusal = &refusals[i];
        char *text = varied(refusal->find, refusal->replace), place[300];
        struct scene scene;
        enum status status = load_text(text, &scene);
        if (status != STATUS_INVALID) {
            fail_msg("'%s' gives status %d", refusal->replace, status);
        }
        snprintf(place, sizeof place, refusal->line ? "%s/scene.cfg:%d: " : "%s/scene.cfg: ", folder, refusal->line);
        if (strncmp(status_message(), place, strlen(place)) != 0) {
            fail_msg("'%s': the message does not begin with '%s': %s", refusal->replace, place, status_message());
        }
        assert_message_has(refusal->key, refusal->replace);
        assert_message_has(refusal->accepted, refusal->replace);
        assert_null(strchr(status_message(), '\n'));
        assert_true(!scene.name && !scene.targets && !scene.acquisition.tx);
        free(text);
    }
}

static void files_that_are_no_scenes_are_refused(void **state)
{
    (void)state;
    struct scene scene;
    assert_int_equal(scene_load("bp22/nosuch", SHIPPED, &scene), STATUS_INVALID);
    assert_message_has(SHIPPED "/bp22/nosuch.cfg: scene is not readable: No such file", "missing");
    assert_int_equal(scene_load("", SHIPPED, &scene), STATUS_INVALID);
    assert_int_equal(load_text("", &scene), STATUS_INVALID);
    assert_message_has("key 'sonar' is missing", "empty");

    assert_int_equal(mkdir(path_in("other.cfg"), 0777), 0);
    assert_int_equal(scene_load(path_in("other.cfg"), SHIPPED, &scene), STATUS_INVALID);
    assert_message_has("not a regular file", "folder");
    assert_int_equal(rmdir(path_in("other.cfg")), 0);

    FILE *file = fopen(path_in("scene.cfg"), "wb"); /* a zero inside, as of a damaged disk */
    assert_non_null(file);
    assert_int_equal(fwrite(base_text, 1, strlen(base_text) + 1, file), strlen(base_text) + 1);
    fclose(file);
    assert_int_equal(scene_load(path_in("scene.cfg"), SHIPPED, &scene), STATUS_INVALID);
    assert_message_has("holds a zero byte", "zero");
}

static void names_are_found_below_the_folder(void **state)
{
    (void)state;
    char **names;
    int count;
    write_file("scene.cfg", base_text);
    write_file("_part.cfg", "");
    assert_int_equal(mkdir(path_in("sub"), 0777), 0);
    write_file("sub/deep.cfg", "");
    write_file("sub/.hidden.cfg", "");
    write_file("sub/text.txt", "");
    assert_int_equal(scene_names(folder, &names, &count), STATUS_OK);
    assert_int_equal(count, 2);
    assert_string_equal(names[0], "scene");
    assert_string_equal(names[1], "sub/deep");
    struct scene scene;
    assert_int_equal(scene_load(names[0], folder, &scene), STATUS_OK);
    assert_string_equal(scene.name, "scene");
    scene_free(&scene);
    scene_names_free(names, count);

    assert_int_equal(scene_names(path_in("nosuch"), &names, &count), STATUS_INVALID);
    assert_message_has("nosuch: not a readable folder", "names");
    assert_true(!names && count == 0);
}

/* ---- Grids ---- */

static void grid_texts(void **state)
{
    (void)state;
    struct grid grid;
    assert_int_equal(grid_parse("-0.016:0.0001:320,0.03:5e-5:400", &grid), STATUS_OK);
    assert_true(grid.x_first == -0.016 && grid.x_step == 0.0001 && grid.x_count == 320);
    assert_true(grid.r_first == 0.03 && grid.r_step == 5e-5 && grid.r_count == 400);
    assert_int_equal(grid_parse("-20:0.2:201,-20:0.2:201", &grid), STATUS_OK);
    assert_true(grid.r_first == -20);
    const char *const bad[] = {
        "",
        "1",
        "0:1:2",
        "0:1:2,",
        "0:1:2,3:4",
        "0:1:2,3:4:5:6",
        "0:1:2,3:4:5,",
        "0:1:2;3:4:5",
        "a:1:2,3:4:5",
        "0:1:2.5,3:4:5",
        "0:1:0,3:4:5",
        "0:1:-2,3:4:5",
        "0:0:2,3:4:5",
        "0:-1:2,3:4:5",
        "0:1:2,3:nan:5",
        "inf:1:2,3:4:5",
        "0:inf:2,3:4:5",
        "0:1:3000000000,3:4:5",
        "0:1:99999999999999999999,3:4:5",
        "0:1:2000000000,0:1:2000000000",
        "1e12:1:5,0:1:1",
        "1e9:1e-9:5,0:1:1",
        "0,1:1:2,3:4:5",
    };
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        if (grid_parse(bad[i], &grid) != STATUS_INVALID) {
            fail_msg("'%s' is accepted", bad[i]);
        }
        assert_message_has("must ", bad[i]);
    }
}

static bool any_pixel_meets(const struct acquisition *a, const struct grid *grid)
{
    for (int i = 0; i < grid->r_count; i++) {
        for (int j = 0; j < grid->x_count; j++) {
            struct vector p = {grid->x_first + j * grid->x_step, grid->r_first + i * grid->r_step, 0};
            for (int k = 0; k < a->pings * a->receivers; k++) {
                int ping = k / a->receivers;
                double tau = delay_exact(a->tx[ping], a->rx[k], a->velocity[ping], p, a->sound_speed);
                double q = (tau - a->t0[ping]) * a->fs;
                if (q >= 0 && q <= a->samples - 1) {
                    return true;
                }
            }
        }
    }
    return false;
}

/* Against every pixel and pair, on random geometry with records so short that both answers are common. */
static void meeting_agrees_with_trying_every_pixel(void **state)
{
    (void)state;
    struct random random = random_seed(11, 0);
    int met = 0;
    for (int trial = 0; trial < 2000; trial++) {
        struct acquisition a = {
            .sound_speed = 1500, .fc = 1e5, .fs = 2e4, .bandwidth = 1e4, .samples = 2, .receivers = 2, .pings = 2};
        assert_int_equal(acquisition_allocate(&a), STATUS_OK);
        a.samples += (int)(3 * random_uniform(&random));
        for (int k = 0; k < 2; k++) {
            a.t0[k] = 0.02 * random_uniform(&random);
            a.tx[k] = (struct vector){4 * random_uniform(&random), random_uniform(&random), random_uniform(&random)};
            a.rx[2 * k] = (struct vector){a.tx[k].x + 3 * random_uniform(&random), 0, 0};
            a.rx[2 * k + 1] = (struct vector){a.tx[k].x, random_uniform(&random), 2};
            a.velocity[k] = (struct vector){700 * random_uniform(&random), 300 * random_uniform(&random), 0};
        }
        struct grid grid = {-2 + 4 * random_uniform(&random),  0.01 + random_uniform(&random), 9,
                            -5 + 10 * random_uniform(&random), 0.01 + random_uniform(&random), 7};
        bool expected = any_pixel_meets(&a, &grid);
        assert_int_equal(grid_meets_records(&a, 1, &grid, "trial"), expected ? STATUS_OK : STATUS_INVALID);
        met += expected;
        acquisition_free(&a);
    }
    assert_in_range(met, 300, 1700);
}

/* Both ends of a record belong to it: the delay is 1 s exactly, sample 4 from the emission. */
static void records_hold_their_ends(void **state)
{
    (void)state;
    const struct {
        double t0;
        int samples;
        enum status expected;
    } cases[] = {{0, 5, STATUS_OK}, {0, 4, STATUS_INVALID}, {1, 2, STATUS_OK}, {1.25, 2, STATUS_INVALID}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        struct acquisition a = {.sound_speed = 2,
                                .fc = 1,
                                .fs = 4,
                                .bandwidth = 1,
                                .samples = cases[i].samples,
                                .receivers = 1,
                                .pings = 1};
        assert_int_equal(acquisition_allocate(&a), STATUS_OK);
        a.t0[0] = cases[i].t0;
        assert_int_equal(grid_meets_records(&a, 1, &(struct grid){0, 1, 1, 1, 1, 1}, "ends"), cases[i].expected);
        acquisition_free(&a);
    }
}

static void odd_grids_meet_or_not(void **state)
{
    (void)state;
    struct scene scene = loaded(base_text); /* records from 24 to 32.5 ms: 18 to 24.4 m to either side */
    const struct {
        struct grid grid;
        enum status expected;
    } cases[] = {
        {{0, 0.1, 5, 20, 0.1, 5}, STATUS_OK},
        {{0, 0.1, 5, -21, 0.1, 5}, STATUS_OK}, /* the other side of the track */
        {{0, 0.1, 5, -10, 0.1, 5}, STATUS_INVALID},
        {{-1, 0.1, 21, -15, 0.1, 301}, STATUS_INVALID}, /* astride the track, all too near */
        {{-1, 0.1, 21, -25, 0.1, 501}, STATUS_OK},      /* astride, reaching far enough */
        {{-1, 50, 1, -100, 50, 5}, STATUS_INVALID},     /* -100 -50 0 50 100: steps over the records */
        {{-1, 50, 1, -80, 50, 5}, STATUS_OK},           /* holds 20 */
        {{-1e6, 1, 2000001, 1000, 1, 1}, STATUS_INVALID},
        {{-1e6, 0.5, 4000001, 20, 1, 1}, STATUS_OK},
        {{20, 1, 1, 0, 1, 1}, STATUS_OK}, /* ahead, on the track */
        {{0, 1, 1, 1e9, 1, 1}, STATUS_INVALID},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        if (grid_meets_records(&scene.acquisition, 1, &cases[i].grid, "the grid") != cases[i].expected) {
            fail_msg("case %zu is not %d", i, cases[i].expected);
        }
    }
    assert_message_has("the grid: no pixel meets any record", "message");
    assert_message_has("0.024 to 0.0325 s", "message");
    struct grid two[2] = {cases[2].grid, cases[0].grid};
    assert_int_equal(grid_meets_records(&scene.acquisition, 2, two, "both"), STATUS_OK);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shipped_scenes_load),
        cmocka_unit_test(reference_scenes_have_the_reference_geometry),
        cmocka_unit_test(full_size_scenes_have_their_papers_sizes),
        cmocka_unit_test_setup_teardown(keys_arrive, setup, teardown),
        cmocka_unit_test_setup_teardown(choices_and_defaults_arrive, setup, teardown),
        cmocka_unit_test_setup_teardown(fields_can_be_repeated, setup, teardown),
        cmocka_unit_test_setup_teardown(reference_patches_are_cut_from_the_grid, setup, teardown),
        cmocka_unit_test_setup_teardown(one_scene_varies_another, setup, teardown),
        cmocka_unit_test_setup_teardown(shipped_scenes_can_be_included, setup, teardown),
        cmocka_unit_test_setup_teardown(includes_are_relative_to_their_file, setup, teardown),
        cmocka_unit_test_setup_teardown(errors_name_the_line_of_their_file, setup, teardown),
        cmocka_unit_test_setup_teardown(includes_have_bounds, setup, teardown),
        cmocka_unit_test_setup_teardown(hash_follows_the_content, setup, teardown),
        cmocka_unit_test_setup_teardown(malformed_scenes_are_refused, setup, teardown),
        cmocka_unit_test_setup_teardown(files_that_are_no_scenes_are_refused, setup, teardown),
        cmocka_unit_test_setup_teardown(names_are_found_below_the_folder, setup, teardown),
        cmocka_unit_test(grid_texts),
        cmocka_unit_test(records_hold_their_ends),
        cmocka_unit_test(meeting_agrees_with_trying_every_pixel),
        cmocka_unit_test_setup_teardown(odd_grids_meet_or_not, setup, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
