/* `image --tile`: the bits of the whole image, also after kill -9 at moments that differ each time; what is refused,
   and what a damaged or torn file costs. */
#define _GNU_SOURCE /* F_OFD_SETLK */
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "echoes/mat_tiles.h"
#include "tests/command/program.h"

#define IMAGE(spec, file) "image", "-s", "study/quick", "-t", "1", "-a", spec, "-o", file
#define SPEC              "bp_sinc:taps=8"

static void assert_same_image(const char *one, const char *other)
{
    struct grid a, b;
    double complex *pixels, *others;
    assert_int_equal(image_file_read(path_of(one), &a, &pixels), STATUS_OK);
    assert_int_equal(image_file_read(path_of(other), &b, &others), STATUS_OK);
    assert_true(a.x_first == b.x_first && a.x_step == b.x_step && a.r_first == b.r_first && a.r_step == b.r_step);
    assert_true(a.x_count == b.x_count && a.r_count == b.r_count && a.angle_rad == b.angle_rad);
    assert_memory_equal(pixels, others, grid_pixels(&a) * sizeof *pixels);
    free(pixels);
    free(others);
}

static void bits_of_the_whole(void **state)
{
    (void)state;
    static const char *const specs[] = {SPEC, SPEC ",precision=double", "bp_nearest", "reference"};
    for (size_t k = 0; k < COUNT_OF(specs); k++) {
        program_good((const char *const[]){IMAGE(specs[k], "whole.mat"), NULL});
        program_good((const char *const[]){IMAGE(specs[k], "tiled.mat"), "--tile", "17x5", NULL});
        assert_same_image("whole.mat", "tiled.mat");
        assert_false(support_exists("tiled.mat" TILES_JOURNAL));
        program_good((const char *const[]){"info", "tiled.mat", NULL});
    }
}

/* Of an echo file, of which a tile reads the pings that it meets. */
static void recordings_are_read_in_part(void **state)
{
    (void)state;
    static const char *const specs[] = {SPEC, "bp_fitted", "bp_farrow:precision=double"};
#define ECHO_IMAGE(spec, file) "image", "-e", "e.mat", "-g", "-0.6:0.02:61,19.85:0.025:13", "-a", spec, "-o", file
    program_good((const char *const[]){"simulate", "study/quick", "-o", "e.mat", NULL});
    for (size_t k = 0; k < COUNT_OF(specs); k++) {
        program_good((const char *const[]){ECHO_IMAGE(specs[k], "whole.mat"), NULL});
        program_good((const char *const[]){ECHO_IMAGE(specs[k], "tiled.mat"), "--tile", "17x5", NULL});
        assert_same_image("whole.mat", "tiled.mat");
    }
}

/* End the program so many seconds after its start, if it still runs. */
static void kill_after(const char *const *arguments, double seconds)
{
    FILE *sink = tmpfile();
    assert_non_null(sink);
    const pid_t child = program_start(arguments, sink, sink);
    nanosleep(&(struct timespec){(time_t)seconds, (long)(1e9 * (seconds - (double)(time_t)seconds))}, NULL);
    kill(child, SIGKILL);
    assert_int_equal(waitpid(child, NULL, 0), child);
    fclose(sink);
}

/* A part of a run, as a signal leaves it: killed once `least` tiles are there. Another begins where one came to its
   end. */
static void image_begin(const char *spec, const char *tile, int least)
{
    const char *const arguments[ARGUMENTS_MAX] = {IMAGE(spec, "x.mat"), "--tile", tile};
    int done, count;
    do {
        unlink(path_of("x.mat" TILES_JOURNAL));
        FILE *sink = tmpfile();
        assert_non_null(sink);
        const pid_t child = program_start(arguments, sink, sink);
        bool ended = false;
        while (!ended && !(tiles_claimed(path_of("x.mat"), &done, &count) && done >= least)) {
            nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
            ended = waitpid(child, NULL, WNOHANG) == child;
        }
        kill(child, SIGKILL);
        assert_true(ended || waitpid(child, NULL, 0) == child);
        fclose(sink);
    } while (!tiles_claimed(path_of("x.mat"), &done, &count) || done < least || done == count);
}

static void killed(void **state)
{
    (void)state;
    const char *given = getenv("SASBENCH_KILLS");
    const char *const arguments[ARGUMENTS_MAX] = {IMAGE("reference", "x.mat"), "--tile", "8x2"};
    struct random random = random_seed(39, 1);
    struct image_file file;
    program_good((const char *const[]){IMAGE("reference", "whole.mat"), NULL});
    double begin = seconds_now();
    program_good(arguments);
    const double seconds = seconds_now() - begin;
    int before = 0, done = 0, count;
    for (int n = given ? atoi(given) : 8; n > 0; n--) {
        kill_after(arguments, random_uniform(&random) * seconds / 2);
        if (support_exists("x.mat")) {
            assert_int_equal(image_file_open(path_of("x.mat"), &file), STATUS_OK);
            image_file_close(&file);
        }
        before = tiles_claimed(path_of("x.mat"), &done, &count) ? before : 0;
        assert_true(done >= before); /* nothing is lost */
        before = done;
    }
    program_good(arguments);
    assert_same_image("whole.mat", "x.mat");
    assert_false(support_exists("x.mat" TILES_JOURNAL));
}

/* What `compare` prints of a tiled image, of version 7.3, and a whole one, of version 5. */
static double difference(const char *tiled, const char *whole)
{
    char *told = program_output((const char *const[]){"compare", tiled, whole, NULL});
    double error = NAN;
    assert_int_equal(sscanf(told, "Relative error %lf", &error), 1);
    free(told);
    return error;
}

#define TILES_OF(file, spec, grid, output) "image", "-e", file, "-a", spec, "-g", grid, "-t", "1", "-o", output
static const char wide[] = "-0.6:0.02:61,19.85:0.025:13", narrow[] = "-0.06:0.02:6,19.95:0.025:3";

/* Algorithms whose tiles differ a little: ragged tiles, one pixel each, after kills, and of shards that are killed. */
static void transforms_in_tiles(void **state)
{
    (void)state;
    static const double MOST = 4e-3; /* measured: 7e-5 to 3.0e-3 */
    static const char *const cases[][2] = {{"q.mat", "rma_delay"},
                                           {"q.mat", "rma_lbf"},
                                           {"q.mat", "bp_factorised"},
                                           {"one.mat", "wk_classic"},
                                           {"one.mat", "wk_squint"}};
    struct random random = random_seed(39, 3);
    text_write("one.cfg", "base = {\n@include \"study/quick.cfg\"\n};\n"
                          "array = { tx_length = 0.08; rx_length = 0.04; receivers = 1; first_offset = 0.0; "
                          "pitch = 0.04; };\n"
                          "track = { speed = 2.5; pri = 0.008; pings = 150; x_first = -1.5; };\n");
    program_good((const char *const[]){"simulate", "study/quick", "-o", "q.mat", NULL});
    program_good((const char *const[]){"simulate", "one.cfg", "-o", "one.mat", NULL});
    for (size_t k = 0; k < COUNT_OF(cases); k++) {
        const char *const file = cases[k][0], *const spec = cases[k][1];
        struct outcome outcome;
        for (int n = 0; n < 3; n++) { /* may warn: tile_overlap */
            const char *const grid = n ? wide : narrow, *const tile = n == 0 ? "1x1" : n == 1 ? "20x13" : "7x5";
            outcome = program_run((const char *const[ARGUMENTS_MAX]){TILES_OF(file, spec, grid, "whole.mat")});
            outcome_free(&outcome);
            outcome =
                program_run((const char *const[ARGUMENTS_MAX]){TILES_OF(file, spec, grid, "t.mat"), "--tile", tile});
            assert_int_equal(outcome.status, 0);
            outcome_free(&outcome);
            const double error = difference("t.mat", "whole.mat");
            if (!(error <= MOST))
                fail_msg("%s, tiles of %s: %g", spec, tile, error);
        }
        unlink(path_of("x.mat"));
        for (int n = 0; n < 12; n++) { /* by itself, then parts of three */
            const char *const part = n < 4 ? NULL : n % 3 == 0 ? "1/3" : n % 3 == 1 ? "2/3" : "3/3";
            const char *const arguments[ARGUMENTS_MAX] = {TILES_OF(file, spec, wide, "x.mat"), "--tile", "7x5",
                                                          part ? "--shard" : NULL, part};
            kill_after(arguments, 0.2 * random_uniform(&random));
        }
        outcome = program_run((const char *const[ARGUMENTS_MAX]){TILES_OF(file, spec, wide, "x.mat"), "--tile", "7x5"});
        assert_int_equal(outcome.status, 0);
        outcome_free(&outcome);
        assert_same_image("t.mat", "x.mat");
    }
}

/* Shards begin together, and one of them is killed and begun again: the last to end finishes the file. */
static void shards_fill_one_file(void **state)
{
    (void)state;
    enum { SHARDS = 3 };
    static const char *const parts[SHARDS] = {"1/3", "2/3", "3/3"};
    struct random random = random_seed(39, 2);
    program_good((const char *const[]){IMAGE("reference", "whole.mat"), NULL});
    for (int n = 0; n < 4; n++) {
        pid_t children[SHARDS];
        FILE *sink = tmpfile();
        int status;
        unlink(path_of("s.mat"));
        for (int k = 0; k < SHARDS; k++)
            children[k] = program_start(
                (const char *const[ARGUMENTS_MAX]){IMAGE("reference", "s.mat"), "--tile", "8x2", "--shard", parts[k]},
                sink, sink);
        nanosleep(&(struct timespec){.tv_nsec = (long)(1e8 * random_uniform(&random))}, NULL);
        kill(children[n % SHARDS], SIGKILL);
        for (int k = 0; k < SHARDS; k++)
            assert_int_equal(waitpid(children[k], &status, 0), children[k]);
        fclose(sink);
        if (support_exists("s.mat" TILES_JOURNAL))
            program_good((const char *const[ARGUMENTS_MAX]){IMAGE("reference", "s.mat"), "--tile", "8x2", "--shard",
                                                            parts[n % SHARDS]});
        assert_same_image("whole.mat", "s.mat");
        for (int k = 0; k <= SHARDS; k++) {
            char name[60];
            snprintf(name, sizeof name, k ? "s.mat" TILES_JOURNAL ".%d" : "s.mat" TILES_JOURNAL, k);
            assert_false(support_exists(name));
        }
    }
    /* A shard does not replace what is finished. */
    static const struct refusal refusals[] = {
        {{IMAGE("reference", "s.mat"), "--tile", "8x2", "--shard", "1/3"}, {"s.mat", "without a journal"}},
        {{IMAGE("reference", "t.mat"), "--shard", "1/3"}, {"--shard 1/3", "--tile"}},
    };
    assert_all_refused(refusals, COUNT_OF(refusals));
    assert_same_image("whole.mat", "s.mat");
}

/* What shards have begun, a process by itself finishes; while one of them runs, it is refused. */
static void one_finishes_shards(void **state)
{
    (void)state;
    int done, count;
    unlink(path_of("s.mat"));
    program_good((const char *const[ARGUMENTS_MAX]){IMAGE("reference", "s.mat"), "--tile", "8x2", "--shard", "2/3"});
    assert_true(tiles_claimed(path_of("s.mat"), &done, &count));
    assert_in_range(done, count / 3, count / 3 + 1);
    const int journal = open(path_of("s.mat" TILES_JOURNAL), O_RDWR);
    assert_int_equal(flock(journal, LOCK_SH | LOCK_NB), 0);
    struct outcome outcome = program_run((const char *const[]){IMAGE("reference", "s.mat"), "--tile", "8x2", NULL});
    assert_int_equal(outcome.status, 2);
    outcome_free(&outcome);
    close(journal);
    char *told = program_output((const char *const[ARGUMENTS_MAX]){IMAGE("reference", "s.mat"), "--tile", "8x2"}),
         wanted[60];
    snprintf(wanted, sizeof wanted, "%d of %d tiles were done", done, count);
    assert_non_null(strstr(told, wanted));
    free(told);
    assert_same_image("whole.mat", "s.mat");
}

static void others_are_refused(void **state)
{
    (void)state;
    image_begin("reference", "8x2", 2);
    char *text = program_output((const char *const[]){"info", "x.mat", NULL});
    assert_non_null(strstr(text, "tiles are done"));
    free(text);
    const struct refusal refusals[] = {
        {{IMAGE("reference", "x.mat"), "--tile", "9x2"}, {"tiles: 8x2", "tiles: 9x2", "x.mat.tiles"}},
        {{IMAGE("bp_nearest", "x.mat"), "--tile", "8x2"}, {"algorithm: reference", "algorithm: bp_nearest"}},
        {{IMAGE("bp_nearest", "x.mat"), "--tile", "8"}, {"--tile", "'8'"}},
        {{IMAGE("bp_nearest", "x.mat"), "--tile", "0x8"}, {"--tile", "'0x8'"}},
        {{IMAGE("bp_nearest", "x.png"), "--tile", "8x2"}, {"--tile", "FILE.mat"}},
        {{IMAGE("wk_polar", "x.mat"), "--tile", "8x2"}, {"--tile", "wk_polar", "filter"}},
        {{IMAGE("wk_classic", "none.mat"), "--tile", "8x2"}, {"wk_classic", "one_receiver"}},
        {{IMAGE("auto", "x.mat"), "--tile", "8x2"}, {"--tile", "auto"}},
    };
    for (size_t k = 0; k < COUNT_OF(refusals); k++) {
        struct outcome outcome = program_run(refusals[k].arguments);
        if (outcome.status != 2)
            fail_msg("refusal %zu: status %d", k, outcome.status);
        for (int n = 0; n < SAYS_MAX && refusals[k].says[n]; n++)
            if (!strstr(outcome.err, refusals[k].says[n]))
                fail_msg("refusal %zu lacks '%s': %s", k, refusals[k].says[n], outcome.err);
        outcome_free(&outcome);
    }
    const int journal = open(path_of("x.mat" TILES_JOURNAL), O_RDWR);
    assert_int_equal(flock(journal, LOCK_EX | LOCK_NB), 0);
    struct outcome outcome = program_run((const char *const[]){IMAGE("reference", "x.mat"), "--tile", "8x2", NULL});
    assert_int_equal(outcome.status, 2);
    assert_non_null(strstr(outcome.err, "another program"));
    outcome_free(&outcome);
    close(journal);
}

/* A tile that the journal claims but whose numbers are others is formed again, and a line cut short is no line. */
static void damage_is_mended(void **state)
{
    (void)state;
    char wrong[] = "done 0 00000000\ndone 1";
    image_begin("reference", "8x2", 3);
    int done, count, kept;
    assert_true(tiles_claimed(path_of("x.mat"), &done, &count));
    const int file = open(path_of("x.mat" TILES_JOURNAL), O_WRONLY | O_APPEND);
    assert_int_equal(write(file, wrong, strlen(wrong)), (ssize_t)strlen(wrong));
    close(file);
    assert_true(tiles_claimed(path_of("x.mat"), &kept, &count) && kept == done); /* tile 0 counts once */
    struct outcome outcome = program_run((const char *const[]){IMAGE("reference", "x.mat"), "--tile", "8x2", NULL});
    assert_int_equal(outcome.status, 0);
    assert_int_equal(sscanf(strstr(outcome.out, ".mat: ") + 6, "%d of", &kept), 1);
    assert_int_equal(kept, done - 1);
    outcome_free(&outcome);
    program_good((const char *const[]){IMAGE("reference", "whole.mat"), NULL});
    assert_same_image("whole.mat", "x.mat");
}

/* Of a part of the shards: what is drawn has no value in the other tiles, and its title counts them. */
static void missing_tiles_are_shown(void **state)
{
    (void)state;
    struct grid g;
    double complex *pixels, *drawn;
    unlink(path_of("s.mat"));
    program_good((const char *const[ARGUMENTS_MAX]){IMAGE("reference", "s.mat"), "--tile", "17x9", "--shard", "2/3"});
    assert_int_equal(image_file_read(path_of("s.mat"), &g, &pixels), STATUS_OK);
    assert_int_equal(image_file_read(path_of("s.mat"), &g, &drawn), STATUS_OK);
    tiles_blank(path_of("s.mat"), &g, drawn);
    for (int n = 0; n < g.x_count * g.r_count; n++) { /* tiles of two rows of them, the farthest first */
        const int number = 2 * (n % g.x_count / 17) + (n / g.x_count < 9);
        assert_true(3 * number / 8 == 1 ? drawn[n] == pixels[n] && pixels[n] != 0 : isnan(creal(drawn[n])));
    }
    free(drawn);
    free(pixels);
    char *told = program_output((const char *const[]){"show", "s.mat", "-o", "s.png", NULL});
    assert_non_null(strstr(told, "reference, unfinished: 3 of 8 tiles\n"));
    free(told);
    static const struct refusal refusals[] = {
        {{"compare", "s.mat", "s.mat"}, {"s.mat: the image is unfinished"}},
        {{"score", "s.mat", "study/quick"}, {"s.mat: the image is unfinished"}},
    };
    assert_all_refused(refusals, COUNT_OF(refusals));
    for (int n = 0; n <= 2; n += 2)
        unlink(path_of(n ? "s.mat" TILES_JOURNAL ".2" : "s.mat" TILES_JOURNAL));
    told = program_output((const char *const[]){"show", "s.mat", "-o", "s.png", NULL});
    assert_null(strstr(told, "tiles"));
    free(told);
}

/* A program killed while it wrote a file of version 7.3 leaves it under a temporary name: the next one removes it, once
   nobody locks it nor writes to it. */
static void leftovers_are_removed(void **state)
{
    (void)state;
    enum { GONE, LOCKED, YOUNG, LINK, OTHER, FILES };
    static const char *const names[FILES] = {".sasbench-0123456789ab", ".sasbench-0123456789ac",
                                             ".sasbench-0123456789ad", ".sasbench-0123456789ae",
                                             ".sasbench-0123456789a"};
    const struct timespec past[2] = {{.tv_sec = 1000000000}, {.tv_sec = 1000000000}};
    struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    for (int k = 0; k < FILES; k++) {
        if (k == LINK)
            assert_int_equal(symlink(names[OTHER], path_of(names[k])), 0);
        else
            text_write(names[k], "half");
        if (k != YOUNG)
            assert_int_equal(utimensat(AT_FDCWD, path_of(names[k]), past, AT_SYMLINK_NOFOLLOW), 0);
    }
    const int owner = open(path_of(names[LOCKED]), O_RDWR);
    assert_int_equal(fcntl(owner, F_OFD_SETLK, &lock), 0);
    for (int n = 0; n < 2; n++) {
        unlink(path_of("l.mat"));
        program_good((const char *const[ARGUMENTS_MAX]){IMAGE("bp_nearest", "l.mat"), "--tile", "17x9"});
        for (int k = 0; k < FILES; k++) {
            struct stat info;
            const bool there = lstat(path_of(names[k]), &info) == 0;
            if (there == (k == GONE || (k == LOCKED && n == 1)))
                fail_msg("%s is %s", names[k], there ? "there" : "gone");
        }
        if (n == 0)
            close(owner);
    }
}

/* No room for the pixels: said before the work, and nothing is left but an empty journal. */
static void full_disks_are_told(void **state)
{
    (void)state;
    assert_shell("ulimit -f 100; \"$SASBENCH_PROGRAM\" image -s study/quick -a bp_nearest -o full.mat --tile 17x5", 2);
    assert_false(support_exists("full.mat"));
}

/* A disk of so many KB: either the image is there, or the program says why not and leaves nothing. */
static void small_disks_are_told(void **state)
{
    (void)state;
    if (system("unshare -rm true 2> /dev/null") != 0)
        skip();
    assert_shell(
        "mkdir disk && unshare -rm sh -c 'mount -t tmpfs -o size=4k tmpfs disk; all=0; "
        "for k in 4 8 12 16 32 64 96 128 160 256 512; do mount -o remount,size=${k}k disk; "
        "\"$SASBENCH_PROGRAM\" image -s study/quick -a bp_nearest -o disk/x.mat --tile 17x9 > told 2>&1; got=$?; "
        "case $got in 0) test -e disk/x.mat && all=1 ;; "
        "2) grep -q \"No space left\" told && test ! -e disk/x.mat ;; *) false ;; esac "
        "|| { echo $k: $got; cat told; exit 1; }; rm -rf disk/* disk/.sas*; done; test $all = 1'",
        0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(bits_of_the_whole),
                                       cmocka_unit_test(recordings_are_read_in_part),
                                       cmocka_unit_test(killed),
                                       cmocka_unit_test(transforms_in_tiles),
                                       cmocka_unit_test(shards_fill_one_file),
                                       cmocka_unit_test(one_finishes_shards),
                                       cmocka_unit_test(others_are_refused),
                                       cmocka_unit_test(damage_is_mended),
                                       cmocka_unit_test(missing_tiles_are_shown),
                                       cmocka_unit_test(leftovers_are_removed),
                                       cmocka_unit_test(full_disks_are_told),
                                       cmocka_unit_test(small_disks_are_told)};
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
