/* The program among faults of its surroundings: other programs in its folder, signals, full disks, closed streams,
   links. Its path is in the environment variable SASBENCH_PROGRAM. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support.h"

#include "files/csv.h"
#include "files/folder.h"
#include "files/text_file.h"

#define QUICK "\"$SASBENCH_PROGRAM\" run study/quick -a bp_nearest -a bp_linear -o r"

static void assert_says(const char *name, const char *part)
{
    char *text = support_read(name);
    if (!text || !strstr(text, part))
        fail_msg("no '%s' in: %s", part, text ? text : "");
    free(text);
}

/* Measured rows, which must be whole; -1: there is no such file. */
static int rows_of(const char *name)
{
    struct csv csv;
    if (!support_exists(name))
        return -1;
    if (csv_read(path_of(name), CSV_TAIL_KEEP, &csv) != STATUS_OK)
        fail_msg("%s", status_message());
    int rows = csv.row_count;
    csv_free(&csv);
    return rows;
}

/* Nothing is left on its way to its place, in the folder and one level below. */
#define assert_nothing_temporary() assert_shell("! ls -A . * | grep -E '^[.]sasbench|[.]tmp$|[.]part$'", 0)

/* Every command that writes into a folder is refused while another works there, and nothing changes. */
static void folders_belong_to_one_program(void **state)
{
    (void)state;
    static const char *const commands[] = {
        QUICK,
        "\"$SASBENCH_PROGRAM\" sweep gate/points -a bp_nearest -o r",
        "\"$SASBENCH_PROGRAM\" reproduce lbf21_flops -o r",
        "\"$SASBENCH_PROGRAM\" report r",
        "\"$SASBENCH_PROGRAM\" phase -o r",
        "\"$SASBENCH_PROGRAM\" bench -o r",
        "\"$SASBENCH_PROGRAM\" baseline -o r/baseline.csv",
    };
    int lock;
    assert_shell(QUICK, 0);
    assert_shell("ls -lA --full-time r > before", 0);
    assert_int_equal(folder_take(path_of("r"), &lock), STATUS_OK);
    for (size_t k = 0; k < sizeof commands / sizeof *commands; k++) {
        assert_shell("rm -f err", 0);
        assert_shell(commands[k], 2);
        assert_says("err", "sasbench: r: another sasbench is at work in this folder");
    }
    assert_shell("ls -lA --full-time r | cmp - before", 0);
    folder_leave(lock);
    assert_shell(QUICK, 0);
}

/* Five at once: those that are refused say so, and no row is lost. */
static void programs_at_once_lose_no_row(void **state)
{
    (void)state;
    assert_shell("for a in nearest linear sinc zeropad nearest:engine=general; do"
                 " (\"$SASBENCH_PROGRAM\" run study/quick -a bp_$a -o r; echo $? >> codes) & done; wait",
                 0);
    char *codes = support_read("codes");
    int done = 0, refused = 0;
    for (const char *at = codes; *at; at++) {
        done += *at == '0';
        refused += *at == '2';
    }
    free(codes);
    assert_int_equal(done + refused, 5);
    assert_true(done >= 1);
    assert_int_equal(rows_of("r/measurements.csv"), done);
    assert_int_equal(rows_of("r/targets.csv"), 5 * done);
}

/* The slices come after the last row: a run that is cut between the two draws them when it is taken up again. Nothing
   is measured anew then. */
static void cut_run_draws_its_pictures(void **state)
{
    (void)state;
    assert_shell(QUICK, 0);
    assert_shell("cp r/measurements.csv before; rm r/study_quick-slices.png", 0);
    assert_shell(QUICK, 0);
    assert_true(support_exists("r/study_quick-slices.png"));
    assert_shell("rm r/study_quick-bp_nearest.png", 0);
    assert_shell(QUICK, 0);
    assert_true(support_exists("r/study_quick-bp_nearest.png"));
    assert_shell("grep -v '^#' before > a; grep -v '^#' r/measurements.csv | cmp - a", 0);
}

/* Whatever ends the program, nothing of what it was making is left, and a gnuplot that hangs is ended, too. */
static void signals_leave_nothing(void **state)
{
    (void)state;
    static const char *const signals[] = {"HUP", "INT", "TERM", "KILL"};
    support_write("gnuplot", "#!/bin/sh\necho $$ > \"$OLDPWD/started\"\nexec sleep 100\n");
    assert_shell("mkdir bin; mv gnuplot bin; chmod +x bin/gnuplot", 0);
    for (size_t k = 0; k < sizeof signals / sizeof *signals; k++) {
        char line[400];
        snprintf(line, sizeof line,
                 "export OLDPWD=\"$PWD\"; rm -f started; PATH=\"$PWD/bin:$PATH\" exec env --default-signal " QUICK
                 " & child=$!;"
                 " while ! [ -s started ]; do sleep .01; done; kill -%s $child; wait $child; test $? -gt 128",
                 signals[k]);
        assert_shell(line, 0);
        assert_nothing_temporary();
        assert_shell("k=0; while readlink /proc/$(cat started)/exe > exe; do sleep .01; k=$((k + 1)); test $k -lt 500 "
                     "|| exit 9; done; rm exe",
                     0);
    }
    assert_shell(QUICK, 0);
    assert_nothing_temporary();
    assert_int_equal(rows_of("r/measurements.csv"), 2);
}

/* Where pictures cannot be drawn, everything is measured, and the exit status says it. */
static void missing_pictures_are_told(void **state)
{
    (void)state;
    support_write(
        "gnuplot",
        "#!/bin/sh\nsed -n \"s/^output = '\\(.*\\)'/\\1/p\" \"$2\" | while read p; do echo half > \"$p\"; done\n");
    assert_shell("mkdir bin; mv gnuplot bin; chmod +x bin/gnuplot", 0);
    assert_shell("PATH=\"$PWD/bin:$PATH\" " QUICK, 1);
    assert_says("err", "without its end");
    assert_says("err", "6 pictures could not be drawn");
    assert_int_equal(rows_of("r/measurements.csv"), 2);
    assert_shell("! ls r | grep png", 0);
    assert_nothing_temporary();
    assert_shell(QUICK, 0); /* the next call draws them */
    assert_shell("test $(ls r | grep -c png) = 4", 0);
}

/* A results file would take the number of a closed stream, and get what is printed. */
static void closed_streams(void **state)
{
    (void)state;
    assert_shell(QUICK " >&-", 0);
    assert_shell(QUICK " <&- >&- 2>&-", 0);
    assert_int_equal(rows_of("r/measurements.csv"), 2);
    assert_shell("rm -r r", 0);
    assert_shell(QUICK " <&- >&- 2>&-", 0);
    assert_int_equal(rows_of("r/measurements.csv"), 2);
    assert_shell("\"$SASBENCH_PROGRAM\" simulate study/quick -o e.mat <&- >&- 2>&-", 0);
}

/* What cannot be printed is an error, also of what only prints. */
static void full_standard_output(void **state)
{
    (void)state;
    static const char *const commands[] = {QUICK, "\"$SASBENCH_PROGRAM\" list", "\"$SASBENCH_PROGRAM\" info bp_sinc",
                                           "\"$SASBENCH_PROGRAM\" --help", "\"$SASBENCH_PROGRAM\" run --help"};
    for (size_t k = 0; k < sizeof commands / sizeof *commands; k++) {
        char line[300];
        snprintf(line, sizeof line, "%s >/dev/full", commands[k]);
        assert_shell("rm -f err", 0);
        assert_shell(line, 1);
        assert_says("err", "standard output cannot be written");
    }
    assert_int_equal(rows_of("r/measurements.csv"), 2);
}

static void text_put(const char *path, const char *text)
{
    struct text_file file;
    if (text_file_open_named(path, &file) != STATUS_OK)
        fail_msg("%s", status_message());
    fputs(text, file.stream);
    if (text_file_close(&file, STATUS_OK) != STATUS_OK)
        fail_msg("%s", status_message());
}

/* A link that the user names stays a link: what it stands for is written. One that stands for nothing is refused. */
static void links_are_followed(void **state)
{
    (void)state;
    struct stat info;
    struct text_file file;
    support_write("real.csv", "old\n");
    assert_shell(
        "ln -s real.csv link.csv; ln -s link.csv chain.csv; ln -s nowhere dangling.csv; ln -s real.mat link.mat;"
        "touch real.mat; mkdir real; ln -s real r",
        0);
    text_put(path_of("chain.csv"), "new\n");
    assert_shell("test -L link.csv && test -L chain.csv && test \"$(cat real.csv)\" = new", 0);
    assert_int_equal(text_file_open_named(path_of("dangling.csv"), &file), STATUS_INVALID);
    assert_non_null(strstr(status_message(), "dangling.csv"));
    assert_shell("\"$SASBENCH_PROGRAM\" simulate study/quick -o link.mat", 0);
    assert_shell("test -L link.mat && test -s real.mat", 0);
    assert_shell("\"$SASBENCH_PROGRAM\" simulate study/quick -o dangling.csv", 2);
    assert_shell(QUICK, 0);
    assert_shell("test -L r && test -s real/measurements.csv", 0);
    assert_int_equal(stat(path_of("real.csv"), &info), 0);
    mode_t mask = umask(0);
    umask(mask);
    assert_int_equal(info.st_mode & 0777, 0666 & ~mask);
    assert_nothing_temporary();
}

/* A name of standard output is standard output, a pipe or a file. Neither the link nor the file is replaced. */
static void standard_output_by_name(void **state)
{
    (void)state;
    assert_shell("cp \"$ROOT/results/baseline.csv\" a.csv", 0);
    assert_shell("ln -s /dev/stdout named; ls -l /dev/stdout named > before", 0);
    for (int k = 0; k < 3; k++) {
        static const char *const names[] = {"/dev/stdout", "named", "/proc/self/fd/1"};
        char line[300];
        snprintf(line, sizeof line,
                 "{ echo ahead; \"$SASBENCH_PROGRAM\" compare a.csv a.csv --markdown %s; echo behind; } > to",
                 names[k]);
        assert_shell(line, 0);
        assert_says("to", "ahead\n");
        assert_says("to", "behind\n");
        assert_says("to", "\n## ");
        snprintf(line, sizeof line, "\"$SASBENCH_PROGRAM\" compare a.csv a.csv --markdown %s | grep -q '^## '",
                 names[k]);
        assert_shell(line, 0);
    }
    assert_shell("ls -l /dev/stdout named | cmp - before", 0);
    assert_nothing_temporary();
}

/* Names that the shell and gnuplot would take apart. */
static void folder_names(void **state)
{
    (void)state;
    static const char *const names[] = {"it's a \"q\"", "-dash", "$(x)`y`;b|c", "%d\\\\n{a,b}*"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        assert_int_equal(setenv("NAME", names[k], 1), 0);
        assert_shell("\"$SASBENCH_PROGRAM\" run study/quick -a bp_nearest -o \"$NAME\"", 0);
        assert_shell("test $(ls -- \"$NAME\" | grep -c png) = 2", 0);
    }
    assert_shell("ls -A > before", 0);
    assert_shell("\"$SASBENCH_PROGRAM\" run study/quick -o \"$(printf 'two\\nlines')\"", 2);
    assert_says("err", "two?lines: the name holds the control character 0x0a");
    assert_shell("\"$SASBENCH_PROGRAM\" run study/quick -o $(printf %05000d 0)", 2);
    assert_shell(
        "\"$SASBENCH_PROGRAM\" run study/quick -o $(for k in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do"
        " printf %0200d/ 0; done)",
        2);
    assert_says("err", "a folder's may have");
    assert_shell("ls -A | cmp - before", 0);
}

/* A limit of the files' size stands for a full disk, at every size: reported, exit 1 or 2, and the next call mends
   it. */
static void files_beyond_the_limit(void **state)
{
    (void)state;
    static const int blocks[] = {0, 1, 4, 16, 48}; /* of 512 bytes: no row, some, all but the pictures */
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) {
        char line[300];
        snprintf(line, sizeof line, "{ ulimit -f %d; " QUICK "; } 2>&1 | cat > limited", blocks[k]);
        assert_shell("rm -rf r", 0);
        assert_shell(line, 0);
        assert_says("limited", "sasbench: ");
        assert_shell("! find r | grep -E '[.](png|svg)$' | while read p; do tail -c 8 \"$p\" | grep -qE 'IEND|</svg>' "
                     "|| echo cut; done"
                     " | grep cut",
                     0);
        assert_nothing_temporary();
        assert_shell(QUICK, 0);
        assert_int_equal(rows_of("r/measurements.csv"), 2);
        assert_int_equal(rows_of("r/targets.csv"), 10);
    }
}

#define SWEEP                                                                                                          \
    "\"$SASBENCH_PROGRAM\" sweep study/quick -a bp_zeropad:factor=2 -a bp_zeropad:factor=4 -a bp_zeropad:factor=8 -o " \
    "r"

/* What a sweep lacks is told where it is called, too, with the reason. */
static void sweeps_that_lack_pictures(void **state)
{
    (void)state;
    assert_shell("mkdir -p r/study_quick-error_time.svg; " SWEEP, 1);
    assert_says("err", "r/study_quick-error_time.svg: cannot be written: Is a directory");
    assert_says("err", "1 picture could not be drawn");
    assert_shell("rmdir r/study_quick-error_time.svg", 0);
    assert_nothing_temporary();
    assert_shell(SWEEP " && test $(ls r | grep -c svg) = 3", 0);
}

/* Disks of all sizes up to that of a whole report: it is whole, or its failure names the disk. */
static void reports_on_full_disks(void **state)
{
    (void)state;
    if (support_shell("unshare -rm mount -t tmpfs tmpfs .") != 0)
        skip(); /* where no file system can be mounted, not even in a name space of one's own */
    assert_shell(SWEEP " && rm r/*.svg r/*.png && mkdir m", 0);
    assert_shell("unshare -rm sh -c 'mount -t tmpfs tmpfs m; full=0; for size in $(seq 40 12 400); do"
                 " mount -o remount,size=${size}k m; rm -rf m/r; cp -r r m/r 2>/dev/null || continue;"
                 " \"$SASBENCH_PROGRAM\" report m/r 2>said; code=$?; cat said >&2;"
                 " if [ $code = 0 ]; then [ -s m/r/report.html ] || exit 3;"
                 " else full=1; [ $code = 1 ] && [ $(wc -l <said) = 1 ] && grep -q \"No space left on device\" said || "
                 "exit 4; fi;"
                 " ls -A m/r | grep -q \"^[.]sasbench\" && exit 5; done; exit $((1 - full))'",
                 0);
}

/* The reason of a write that failed long before the file is closed, and left nothing to be written. */
static void late_reasons(void **state)
{
    (void)state;
    struct text_file file;
    const struct rlimit little = {1 << 13, RLIM_INFINITY};
    struct rlimit before;
    static char much[1 << 16];
    memset(much, 'a', sizeof much);
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    assert_int_equal(text_file_open(path_of("a.csv"), &file), STATUS_OK);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &little), 0);
    fwrite(much, 1, sizeof much, file.stream);
    enum status status = text_file_close(&file, STATUS_OK);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    assert_int_equal(status, STATUS_FAILED);
    assert_non_null(strstr(status_message(), "a.csv: cannot be written: File too large"));
    assert_nothing_temporary();
}

/* Filtered echoes replace a file whole or not at all. */
static void filtered_echoes_are_whole(void **state)
{
    (void)state;
    static const char *const lines[] = {
        "{ trap '' XFSZ; ulimit -f 8; exec \"$SASBENCH_PROGRAM\" filter gate/squint -o old.mat; }",
        "\"$SASBENCH_PROGRAM\" filter gate/squint -a wk_polar:subapertures=99 -o old.mat",
    };
    support_write("old.mat", "old\n");
    for (size_t k = 0; k < sizeof lines / sizeof *lines; k++) {
        assert_shell(lines[k], 2);
        assert_shell("test \"$(cat old.mat)\" = old", 0);
        assert_nothing_temporary();
    }
    assert_shell("\"$SASBENCH_PROGRAM\" filter gate/squint -o old.mat", 0);
    assert_shell("test $(stat -c %s old.mat) -gt 100000", 0);
    assert_nothing_temporary();
}

/* An aperture that ends before each pixel's: a reason, and no image of zeros. */
static void scenes_without_pairs_are_refused(void **state)
{
    (void)state;
    support_write("none.cfg", "base = {\n@include \"study/quick.cfg\"\n};\naperture_limit = 0.05;\n"
                              "image = { x = { first = 12.0; step = 0.01; count = 10; };\n"
                              "          r = { first = 16.5; step = 0.01; count = 10; }; };\n");
    assert_shell("\"$SASBENCH_PROGRAM\" run none.cfg -a bp_nearest -o r", 0);
    assert_shell("grep -q 'unsupported.*no ping and pixel meet within beam' r/measurements.csv", 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(folders_belong_to_one_program, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(programs_at_once_lose_no_row, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(cut_run_draws_its_pictures, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(signals_leave_nothing, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(missing_pictures_are_told, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(closed_streams, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(full_standard_output, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(links_are_followed, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(standard_output_by_name, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(folder_names, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(files_beyond_the_limit, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(sweeps_that_lack_pictures, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(reports_on_full_disks, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(late_reasons, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(scenes_without_pairs_are_refused, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(filtered_echoes_are_whole, folder_make, folder_remove),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
