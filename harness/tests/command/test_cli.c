/* The whole program as a user meets it: run as a process, what it prints, leaves on disk and exits with. Its path is
   in the environment variable SASBENCH_PROGRAM. */
#include <fts.h>
#include <limits.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <matio.h>

#include "tests/support.h"

#include "data/csv.h"
#include "scene/matfile.h"

#define COUNT_OF(array) (sizeof array / sizeof *array)

enum { ARGUMENTS_MAX = 14, SAYS_MAX = 4 };

static char program[PATH_MAX];
static char long_name[5000];

/* --- Files ----------------------------------------------------------------------------------------------------- */

static const char *path_in(const char *name)
{
    static char path[600];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static void bytes_write(const char *name, const void *bytes, size_t size)
{
    FILE *file = fopen(path_in(name), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static void text_write(const char *name, const char *text)
{
    bytes_write(name, text, strlen(text));
}

/* With a zero byte behind. */
static char *stream_read(FILE *file, size_t *size)
{
    char *text = NULL;
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    *size = (size_t)ftell(file);
    rewind(file);
    text = calloc(1, *size + 1);
    assert_non_null(text);
    assert_int_equal(fread(text, 1, *size, file), *size);
    return text;
}

static char *bytes_read(const char *name, size_t *size)
{
    FILE *file = fopen(path_in(name), "rb");
    assert_non_null(file);
    char *bytes = stream_read(file, size);
    fclose(file);
    return bytes;
}

static int compare_names(const FTSENT **a, const FTSENT **b)
{
    return strcmp((*a)->fts_name, (*b)->fts_name);
}

/* Every file below the folder with its size and time: two equal texts mean that nothing was written. */
static char *folder_state(void)
{
    char *text = NULL, *roots[] = {folder, NULL};
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    FTS *tree = fts_open(roots, FTS_PHYSICAL | FTS_NOCHDIR, compare_names);
    assert_non_null(stream);
    assert_non_null(tree);
    for (FTSENT *entry; (entry = fts_read(tree));) {
        const struct stat *about = entry->fts_statp;
        if (entry->fts_info == FTS_F)
            fprintf(stream, "%s %lld %lld.%09ld\n", entry->fts_path, (long long)about->st_size,
                    (long long)about->st_mtim.tv_sec, about->st_mtim.tv_nsec);
        else if (entry->fts_info == FTS_D)
            fprintf(stream, "%s\n", entry->fts_path);
    }
    fts_close(tree);
    fclose(stream);
    return text;
}

/* --- Processes ------------------------------------------------------------------------------------------------- */

struct outcome {
    int status; /* of exit, or -1 after a signal */
    char *out, *err;
};

static pid_t program_start(const char *const *arguments, FILE *out, FILE *err)
{
    char *words[ARGUMENTS_MAX + 2] = {program};
    for (int k = 0; k < ARGUMENTS_MAX && arguments[k]; k++)
        words[k + 1] = (char *)arguments[k];
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        setpgid(0, 0);
        alarm(120);
        if (chdir(folder) == 0 && dup2(fileno(out), STDOUT_FILENO) >= 0 && dup2(fileno(err), STDERR_FILENO) >= 0)
            execv(program, words);
        _exit(127);
    }
    return child;
}

static struct outcome program_run(const char *const *arguments)
{
    FILE *out = tmpfile(), *err = tmpfile();
    assert_non_null(out);
    assert_non_null(err);
    int status;
    size_t size;
    pid_t child = program_start(arguments, out, err);
    assert_int_equal(waitpid(child, &status, 0), child);
    struct outcome outcome = {WIFEXITED(status) ? WEXITSTATUS(status) : -1, stream_read(out, &size),
                              stream_read(err, &size)};
    fclose(out);
    fclose(err);
    return outcome;
}

static void outcome_free(struct outcome *outcome)
{
    free(outcome->out);
    free(outcome->err);
}

/* Runs to a good end without a word on standard error; returns what it printed. */
static char *program_output(const char *const *arguments)
{
    struct outcome outcome = program_run(arguments);
    if (outcome.status != 0 || *outcome.err)
        fail_msg("sasbench %s ... exits with %d: %s", arguments[0], outcome.status, outcome.err);
    free(outcome.err);
    return outcome.out;
}

static void program_good(const char *const *arguments)
{
    free(program_output(arguments));
}

/* One line "sasbench: ..." that holds every text of `says`. */
static bool line_says(const char *line, const char *const *says)
{
    const char *end = strchr(line, '\n');
    bool good = strncmp(line, "sasbench: ", strlen("sasbench: ")) == 0 && end && !end[1];
    for (int k = 0; k < SAYS_MAX && says[k]; k++)
        good &= strstr(line, says[k]) != NULL;
    return good;
}

/* Exit status 2, one line of error, nothing else printed, nothing written. Tells and returns false otherwise. */
static bool is_refused(const char *const *arguments, const char *const *says)
{
    char *before = folder_state();
    struct outcome outcome = program_run(arguments);
    char *after = folder_state();
    bool said = line_says(outcome.err, says), untouched = strcmp(before, after) == 0;
    bool good = outcome.status == 2 && said && !*outcome.out && untouched;
    if (!good) {
        print_message("sasbench");
        for (int k = 0; k < ARGUMENTS_MAX && arguments[k]; k++)
            print_message(" '%.100s'", arguments[k]);
        print_message("\n  exits with %d, %s%s, says: %s", outcome.status, *outcome.out ? "prints" : "prints nothing",
                      untouched ? "" : ", WRITES", outcome.err);
        for (int k = 0; k < SAYS_MAX && says[k]; k++)
            print_message("  to be said: %s\n", says[k]);
    }
    free(before);
    free(after);
    outcome_free(&outcome);
    return good;
}

/* --- Bad command lines ----------------------------------------------------------------------------------------- */

struct refusal {
    const char *arguments[ARGUMENTS_MAX], *says[SAYS_MAX];
};

static void assert_all_refused(const struct refusal *refusals, size_t count)
{
    int failures = 0;
    for (size_t k = 0; k < count; k++)
        failures += !is_refused(refusals[k].arguments, refusals[k].says);
    assert_int_equal(failures, 0);
}

#define SPEC(text)                                                                                                     \
    {                                                                                                                  \
        "image", "--scene", "study/quick", "-o", "x.mat", "--algorithm", text                                          \
    }
#define GRID(text)                                                                                                     \
    {                                                                                                                  \
        "image", "--echoes", "good.mat", "-o", "x.mat", "-a", "bp_nearest", "--grid", text                             \
    }
#define THREADS(text)                                                                                                  \
    {                                                                                                                  \
        "simulate", "study/quick", "-o", "x.mat", "--threads", text                                                    \
    }
#define FORM_OF_GRID "must be xmin:xstep:xcount,rmin:rstep:rcount"

static void bad_usage_is_refused(void **state)
{
    (void)state;
    static const struct refusal refusals[] = {
        {{NULL}, {"is not a command", "accepted: list, info, simulate, image, run"}},
        {{""}, {"'' is not a command", "accepted: list"}},
        {{"focus"}, {"'focus' is not a command", "accepted: list"}},
        {{"two\nlines"}, {"'two?lines' is not a command"}},
        {{"--threads"}, {"'--threads' is not a command"}},
        {{"list", "all"}, {"list: 'all' is one argument too many"}},
        {{"list", "-o", "x"}, {"list: option '-o' is not one of this command", "accepted: none"}},
        {{"info"}, {"info: an argument is missing", "NAME"}},
        {{"info", "no_such_algorithm"}, {"'no_such_algorithm'", "accepted: reference, bp_nearest"}},
        {{"info", "bp_sinc", "bp_linear"}, {"info: 'bp_linear' is one argument too many"}},
        {{"compare", "a.csv"}, {"compare: an argument is missing", "OLD NEW"}},
        {{"compare", "a.csv", "b.csv", "c.csv"}, {"'c.csv' is too much without --ab"}},
        {{"compare", "a.csv", "b.csv", "-a", "bp_sinc"}, {"'--algorithm' is too much without --ab"}},
        {{"compare", "--ab", "a", "b"}, {"OLD a is no program that can be run"}},
        {{"compare", "--ab", "/bin/true", "/bin/true"}, {"OLD /bin/true ended with status 0", "sasbench measure 1"}},
        {{"compare", "--ab", "a", "b", "no/scene"}, {"no/scene"}},
        {{"simulate", "-o", "x.mat"}, {"simulate: an argument is missing", "SCENE"}},
        {{"simulate", "study/quick"}, {"simulate: -o FILE.mat is missing"}},
        {{"simulate", "study/quick", "-o"}, {"simulate: option '-o' needs a value", "accepted: --output"}},
        {{"simulate", "study/quick", "--output"}, {"simulate: option '--output' needs a value"}},
        {{"simulate", "study/quick", "-o", "x.mat", "-o", "y.mat"}, {"simulate: option '-o' is given twice"}},
        {{"simulate", "study/quick", "-t", "1", "-t", "2", "-o", "x.mat"}, {"option '-t' is given twice"}},
        {{"simulate", "study/quick", "study/near", "-o", "x.mat"}, {"'study/near' is one argument too many"}},
        {{"simulate", "study/quick", "-o", "x.mat", "--grid", "0:1:1,20:1:1"},
         {"simulate: option '-g' is not one of this command", "accepted: --output, --threads"}},
        {{"simulate", "study/quick", "-o", "x.mat", "--colour"}, {"option '--colour'", "accepted: --output"}},
        {{"simulate", "study/quick", "-o", "x.mat", "-z"}, {"option '-z'", "accepted: --output"}},
        {{"image", "-a", "bp_nearest", "-o", "x.mat"}, {"image: exactly one of --scene SCENE and --echoes FILE.mat"}},
        {{"image", "--scene", "study/quick", "--echoes", "good.mat", "-a", "bp_nearest", "-o", "x.mat"},
         {"image: exactly one of --scene SCENE and --echoes FILE.mat"}},
        {{"image", "--echoes", "good.mat", "-a", "bp_nearest", "-o", "x.mat"}, {"--echoes good.mat needs --grid"}},
        {{"image", "--scene", "study/quick", "-o", "x.mat"}, {"0 --algorithm SPEC given, exactly one is needed"}},
        {{"image", "--scene", "study/quick", "-o", "x.mat", "-a", "bp_nearest", "-a", "bp_sinc"},
         {"2 --algorithm SPEC given, exactly one is needed"}},
        {{"image", "--scene", "study/quick", "-a", "bp_nearest"}, {"image: -o FILE.mat is missing"}},
        {{"image", "study/quick", "-a", "bp_nearest", "-o", "x.mat"}, {"'study/quick' is one argument too many"}},
        {{"run", "--scene", "study/quick", "-o", "r"}, {"run: option '-s'", "accepted: --output, --algorithm"}},
        {{"run", "study/quick", "study/quick", "-o", "r"}, {"scene study/quick is given twice"}},
        {{"run", "study/quick", "-a", "bp_linear", "-a", "bp_linear:beta=8", "-o", "r"},
         {"--algorithm bp_linear is given twice with the same settings"}},
        {{"run", "study/quick", "-a"}, {"run: option '-a' needs a value"}},

        {THREADS("0"), {"--threads is '0'", "a whole number from 1 to 1024"}},
        {THREADS("-1"), {"--threads is '-1'", "from 1 to 1024"}},
        {THREADS("1025"), {"--threads is '1025'", "from 1 to 1024"}},
        {THREADS("two"), {"--threads is 'two'", "from 1 to 1024"}},
        {THREADS("1e9"), {"--threads is '1e9'", "from 1 to 1024"}},
        {THREADS("1.5"), {"--threads is '1.5'", "from 1 to 1024"}},
        {THREADS(""), {"--threads is ''", "from 1 to 1024"}},
        {THREADS("99999999999999999999"), {"--threads is '99999999999999999999'", "from 1 to 1024"}},

        {SPEC(""), {"unknown algorithm ''", "accepted: reference, bp_nearest"}},
        {SPEC("BP_SINC"), {"unknown algorithm 'BP_SINC'", "accepted: reference"}},
        {SPEC("bp_sinc taps=8"), {"unknown algorithm 'bp_sinc taps=8'", "accepted: reference"}},
        {SPEC("bp_sinc:"), {"'bp_sinc:'", "'' is not a setting", "key=value"}},
        {SPEC("bp_sinc:taps"), {"'taps' is not a setting", "key=value"}},
        {SPEC("bp_sinc:taps=8,"), {"'' is not a setting", "key=value"}},
        {SPEC("bp_sinc:taps="), {"taps is ''", "a whole number from 2 to"}},
        {SPEC("bp_sinc:taps=0"), {"taps is '0'", "a whole number from 2 to"}},
        {SPEC("bp_sinc:taps=8.5"), {"taps is '8.5'", "a whole number"}},
        {SPEC("bp_sinc:taps=nan"), {"taps is 'nan'", "a whole number"}},
        {SPEC("bp_sinc:taps=99999999999999999999"), {"taps is '99999999999999999999'", "a whole number"}},
        {SPEC("bp_sinc:taps=7"), {"bp_sinc: taps is 7, must be even"}},
        {SPEC("bp_sinc:taps=8,taps=8"), {"taps is given twice", "each key once"}},
        {SPEC("bp_sinc:beta=8"), {"unknown key 'beta'", "accepted: taps, window,"}},
        {SPEC("bp_sinc:window=hann"), {"window is 'hann'", "accepted: none, kaiser"}},
        {SPEC("bp_nearest:precision=half"), {"precision is 'half'", "accepted: float, double"}},
        {SPEC("bp_linear:beta=-1"), {"beta is '-1'", "a whole number from 0 to"}},
        {SPEC("bp_zeropad:factor=0"), {"factor is '0'", "a whole number from 1 to"}},

        {GRID(""), {"grid ''", FORM_OF_GRID}},
        {GRID("0:0.1:5"), {"grid '0:0.1:5'", FORM_OF_GRID}},
        {GRID("0:0.1:5,20:0.1"), {"grid '0:0.1:5,20:0.1'", FORM_OF_GRID}},
        {GRID("0:0.1:5,20:0.1:5,"), {"grid '0:0.1:5,20:0.1:5,'", FORM_OF_GRID}},
        {GRID("0:0.1:5 20:0.1:5"), {"grid '0:0.1:5 20:0.1:5'", FORM_OF_GRID}},
        {GRID("0:0.1:5,20:0.1:five"), {"grid '0:0.1:5,20:0.1:five'", FORM_OF_GRID}},
        {GRID("0,5:0.1:5,20:0.1:5"), {"grid '0,5:0.1:5,20:0.1:5'", FORM_OF_GRID}},
        {GRID("0:0.1:0,20:0.1:5"), {"grid '0:0.1:0,20:0.1:5'", "counts from 1"}},
        {GRID("0:0.1:-5,20:0.1:5"), {"grid '0:0.1:-5,20:0.1:5'", "counts from 1"}},
        {GRID("0:0.1:2.5,20:0.1:5"), {"grid '0:0.1:2.5,20:0.1:5'", "counts from 1"}},
        {GRID("0:0.1:99999999999,20:0.1:5"), {"99999999999", "counts from 1 to 2147483647"}},
        {GRID("0:0:5,20:0.1:5"), {"step along x is 0 m", "must be > 0"}},
        {GRID("0:0.1:5,20:-0.1:5"), {"step along r is -0.1 m", "must be > 0"}},
        {GRID("0:nan:5,20:0.1:5"), {"grid '0:nan:5,20:0.1:5'", "plain decimal"}},
        {GRID("0:inf:5,20:0.1:5"), {"grid '0:inf:5,20:0.1:5'", "plain decimal"}},
        {GRID("nan:0.1:5,20:0.1:5"), {"grid 'nan:0.1:5,20:0.1:5'", "plain decimal"}},
        {GRID("1e13:0.1:5,20:0.1:5"), {"along x spans 1e+13", "within +-1e+12 m"}},
        {GRID("0:0.1:5,20:1e-17:5"), {"step along r is 1e-17 m", "must be >"}},
        {GRID("0:1e-3:2000000000,20:1e-3:2000000000"), {"2000000000 x 2000000000 pixels", "must be at most"}},
        {GRID("0:0.1:5,200:0.1:5"), {"0:0.1:5,200:0.1:5: no pixel meets any record", "0.024 to 0.0325 s"}},
    };
    assert_all_refused(refusals, COUNT_OF(refusals));
}

/* --- Bad places ------------------------------------------------------------------------------------------------ */

#define ECHOES(file)                                                                                                   \
    {                                                                                                                  \
        "image", "--grid", "0:0.1:5,20:0.1:5", "-a", "bp_nearest", "-o", "x.mat", "--echoes", file                     \
    }
#define RUN_INTO(place)                                                                                                \
    {                                                                                                                  \
        "run", "study/quick", "-a", "bp_nearest", "-o", place                                                          \
    }

static void bad_places_are_refused(void **state)
{
    (void)state;
    static const struct refusal refusals[] = {
        {{"simulate", "study/quick", "-o", "nowhere/x.mat"}, {"nowhere/x.mat: cannot be written"}},
        {{"simulate", "study/quick", "-o", "plain.txt/x.mat"}, {"plain.txt/x.mat: cannot be written"}},
        {{"simulate", "study/quick", "-o", "foreign"}, {"foreign: cannot be written", "not a regular file"}},
        {{"simulate", "study/quick", "-o", "/dev/full"}, {"/dev/full: cannot be written"}},
        {{"simulate", "study/quick", "-o", ""}, {"simulate: -o is ''", "a path"}},
        {{"baseline", "-o", ""}, {"baseline: -o is ''"}},
        {{"compare", "a.csv", "b.csv", "--markdown", ""}, {"compare: --markdown is ''", "a path"}},
        {{"compare", "a.csv", "b.csv", "--json", ""}, {"compare: --json is ''", "a path"}},
        {{"compare", "a.csv", ""}, {"compare: an argument is ''"}},
        {{"report", ""}, {"report: an argument is ''"}},
        {{"phase", "--at", ""}, {"phase: --at is ''"}},
        {{"simulate", "study/quick", "-o", long_name}, {"cannot be written", "too long"}},
        {{"image", "--scene", "study/quick", "-a", "bp_nearest", "-o", "nowhere/x.mat"},
         {"nowhere/x.mat: cannot be written"}},
        {{"image", "--scene", "study/quick", "-a", "bp_nearest", "-o", "plain.txt/x.mat"},
         {"plain.txt/x.mat: cannot be written"}},
        {{"image", "--scene", "study/quick", "-a", "bp_nearest", "-o", "foreign"}, {"foreign: cannot be written"}},
        {{"image", "--scene", "study/quick", "-a", "bp_nearest", "-o", "/dev/full"}, {"/dev/full: cannot be written"}},
        {RUN_INTO("plain.txt"), {"plain.txt: cannot be made", "name a folder that can be written"}},
        {RUN_INTO("plain.txt/results"), {"plain.txt/results: cannot be made", "name a folder"}},
        {RUN_INTO(""), {"run: -o is ''", "a path"}},
        {RUN_INTO("/dev/full"), {"/dev/full: cannot be made", "name a folder"}},
        {RUN_INTO(long_name), {"xxxxxx"}},
        {RUN_INTO("foreign"), {"foreign/measurements.csv:1: not a file of ours", "name another folder"}},
        {RUN_INTO("crowded"), {"crowded/targets.csv", "a regular file"}},

        {{"simulate", "nowhere/scene", "-o", "x.mat"}, {"nowhere/scene.cfg", "the name of a shipped scene"}},
        {{"simulate", "study", "-o", "x.mat"}, {"study.cfg", "the name of a shipped scene"}},
        {{"simulate", "", "-o", "x.mat"}, {"simulate: an argument is ''", "a name"}},
        {{"simulate", "missing.cfg", "-o", "x.mat"}, {"missing.cfg: scene is not readable", "the path of a .cfg file"}},
        {{"simulate", "folder.cfg", "-o", "x.mat"}, {"folder.cfg", "not a regular file", "the path of a .cfg file"}},
        {{"simulate", "empty.cfg", "-o", "x.mat"}, {"empty.cfg: key 'sonar' is missing", "must be a group"}},
        {{"simulate", "binary.cfg", "-o", "x.mat"}, {"binary.cfg:", "must be", "text"}},
        {{"run", "study/quick", "missing.cfg", "-o", "r"}, {"missing.cfg: scene is not readable"}},
        {{"image", "--scene", "missing.cfg", "-a", "bp_nearest", "-o", "x.mat"},
         {"missing.cfg: scene is not readable"}},

        {ECHOES("missing.mat"), {"missing.mat: cannot be read"}},
        {ECHOES(""), {"image: -e is ''", "a path"}},
        {ECHOES("foreign"), {"foreign: is not a regular file", "a MATLAB file is needed"}},
        {ECHOES("/dev/zero"), {"/dev/zero: is not a regular file"}},
        {ECHOES("empty.mat"), {"empty.mat: is not a MATLAB file of version 5 or 7.3"}},
        {ECHOES("plain.txt"), {"plain.txt: is not a MATLAB file of version 5 or 7.3"}},
        {ECHOES("binary.cfg"), {"binary.cfg: is not a MATLAB file of version 5 or 7.3"}},
        {ECHOES("head.mat"), {"head.mat: variable `format` is missing", "\"sas-echoes 1\""}},
        {ECHOES("begun.mat"), {"begun.mat: is not a MATLAB file of version 5 or 7.3"}},
        {ECHOES("half.mat"), {"half.mat: is cut short"}},
        {ECHOES("short.mat"), {"short.mat: is cut short"}},
        {ECHOES("long.mat"), {"long.mat: is cut short or damaged"}},
        {ECHOES("damaged.mat"), {"damaged.mat:", "damaged"}},
    };
    assert_all_refused(refusals, COUNT_OF(refusals));
}

/* --- Bad scenes ------------------------------------------------------------------------------------------------ */

static const char scene_text[] =
    "sonar = { fc = 150e3; bandwidth = 15e3; fs = 30e3; };\n"
    "pulse = { kind = \"lfm\"; duration = 2e-3; };\n"
    "array = { tx_length = 0.08; rx_length = 0.04; receivers = 4; first_offset = 0.04; pitch = 0.04; };\n"
    "track = { speed = 2.5; pri = 0.032; pings = 12; x_first = -0.5; };\n"
    "record = { first_sample = 720; samples = 256; };\n"
    "beam = { kind = \"rect\"; truncation = \"tx\"; limit = 0.443; };\n"
    "targets = { points = ( { x = 0.0; r = 20.0; } ); };\n"
    "noise = { std = 0.0; seed = 3; };\n"
    "image = { around_targets = { half_x = 0.3; half_r = 0.1; x_step = 0.02; r_step = 0.025; }; };\n";

/* scene_text with its first `find` replaced. */
static void scene_write(const char *name, const char *find, const char *replace)
{
    const char *at = strstr(scene_text, find);
    if (!at)
        fail_msg("no '%s' in the scene", find);
    FILE *file = fopen(path_in(name), "w");
    assert_non_null(file);
    fprintf(file, "%.*s%s%s", (int)(at - scene_text), scene_text, replace, at + strlen(find));
    assert_int_equal(fclose(file), 0);
}

static void bad_scenes_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *find, *replace, *says[SAYS_MAX];
    } scenes[] = {
        {"sonar = { fc = 150e3;", "sonar = {", {"bad.cfg:1: key 'sonar.fc' is missing", "> 0 Hz"}},
        {"image =", "picture =", {"bad.cfg", "picture", "accepted are"}},
        {"pings = 12", "pings = 12; pongs = 3", {"bad.cfg:4: key 'track.pongs'", "accepted are speed, pri, pings"}},
        {"fc = 150e3", "fc = 0", {"key 'sonar.fc' is 0", "a number > 0 Hz"}},
        {"fc = 150e3", "fc = -150e3", {"key 'sonar.fc' is -150000", "a number > 0 Hz"}},
        {"fc = 150e3", "fc = 1e999", {"key 'sonar.fc' is inf", "a number > 0 Hz"}},
        {"fc = 150e3", "fc = nan", {"bad.cfg:1:", "must be libconfig text"}},
        {"fc = 150e3", "fc = \"high\"", {"key 'sonar.fc' is \"high\"", "a number > 0 Hz"}},
        {"fc = 150e3", "fc = 1e15", {"bad.cfg", "phase error"}},
        {"fs = 30e3", "fs = 10e3", {"key 'sonar.fs' is 10000", "at least sonar.bandwidth (15000 Hz)"}},
        {"bandwidth = 15e3", "bandwidth = 0.0", {"key 'sonar.bandwidth' is 0", "a number > 0 Hz"}},
        {"fs = 30e3", "fs = 30e3; sound_speed = 0", {"key 'sonar.sound_speed' is 0", "> 0"}},
        {"\"lfm\"", "\"chirp\"", {"key 'pulse.kind' is \"chirp\"", "\"lfm\", \"lfm_time\", \"flat\""}},
        {"duration = 2e-3", "duration = 1.0", {"key 'pulse.duration' is 1.0", "no longer than the record"}},
        {"duration = 2e-3; ", "", {"key 'pulse.duration' is missing", "> 0 s"}},
        {"receivers = 4", "receivers = 0", {"key 'array.receivers' is 0", "an integer from 1"}},
        {"receivers = 4", "receivers = 4.5", {"key 'array.receivers' is 4.5", "an integer"}},
        {"pitch = 0.04", "pitch = 0", {"key 'array.pitch' is 0", "other than 0 m"}},
        {"tx_length = 0.08", "tx_length = -1", {"key 'array.tx_length' is -1", "> 0 and <= 1e+12 m"}},
        {"speed = 2.5", "speed = 1500", {"key 'track.speed' is 1500", "below sonar.sound_speed (1500 m/s)"}},
        {"speed = 2.5", "speed = -2000.0", {"key 'track.speed' is -2000", "below sonar.sound_speed"}},
        {"pri = 0.032", "pri = 0", {"key 'track.pri' is 0", "> 0 s"}},
        {"pings = 12", "pings = 0", {"key 'track.pings' is 0", "an integer from 1"}},
        {"pings = 12", "pings = -12", {"key 'track.pings' is -12", "an integer from 1"}},
        {"pings = 12", "pings = true", {"key 'track.pings' is true", "an integer from 1"}},
        {"pings = 12", "pings = 99999999999", {"bad.cfg:4: 99999999999 is out of range", "an integer from"}},
        {"pings = 12", "pings = 2000000000", {"key 'track.pings' is 2000000000", "at most"}},
        {"samples = 256", "samples = 1", {"key 'record.samples' is 1", "an integer from 2"}},
        {"first_sample = 720; ", "", {"bad.cfg:5: key 'record.first_sample' is missing", "an integer"}},
        {"\"tx\"", "\"rx\"", {"key 'beam.truncation' is \"rx\"", "\"tx\", \"mid\", \"doppler\""}},
        {"limit = 0.443", "limit = 0", {"key 'beam.limit' is 0", "a number > 0"}},
        {"r = 20.0", "r = 1e13", {"key 'targets.points[0].r' is 1e+13", "from -1e+12 to 1e+12"}},
        {"r = 20.0", "r = 2000.0", {"bad.cfg: no pixel meets any record", "must lie in the records' 0.024 to"}},
        {"( { x = 0.0; r = 20.0; } )", "()", {"key 'targets.points'", "at least one target"}},
        {"std = 0.0", "std = -1", {"bad.cfg:8: key 'noise.std' is -1", "from 0 to"}},
        {"std = 0.0", "std = 1e999", {"key 'noise.std' is inf"}},
        {"seed = 3", "seed = -3", {"key 'noise.seed' is -3", "an integer from 0"}},
        {"x_step = 0.02", "x_step = 0.0", {"x_step' is 0", "> 0 m"}},
        {"half_x = 0.3", "half_x = 1e12", {"half_x' is 1e+12", "at most"}},
        {"0.025; };", "0.025; }; patches = ();", {"key 'image'", "exactly one of"}},
        {"sonar", "aperture_limit = 2; sonar", {"key 'aperture_limit' is 2", "> 0 and <= 1"}},
        {"sonar", "@include \"missing.cfg\"\nsonar", {"bad.cfg:1: @include", "must be a readable file"}},
        {"30e3; };", "30e3;", {"bad.cfg:10:", "must be libconfig text"}},
        {"\"lfm\"", "\"lfm", {"bad.cfg:2: ", "\"lfm", "not closed"}},
        {"fs = 30e3", "fs = 30e3; fs = 40e3", {"bad.cfg:1:", "each key once"}},
    };
    static const char *const arguments[ARGUMENTS_MAX] = {"simulate", "bad.cfg", "-o", "x.mat"};
    static const char *const good[ARGUMENTS_MAX] = {"simulate", "scene.cfg", "-o", "x.mat"};
    int failures = 0;
    program_good(good); /* what is refused below is refused for its fault */
    remove(path_in("x.mat"));
    for (size_t k = 0; k < COUNT_OF(scenes); k++) {
        scene_write("bad.cfg", scenes[k].find, scenes[k].replace);
        failures += !is_refused(arguments, scenes[k].says);
    }
    remove(path_in("bad.cfg"));
    assert_int_equal(failures, 0);
}

/* --- Bad echo files -------------------------------------------------------------------------------------------- */

/* A variable of an echo file, all its numbers `value`. */
struct item {
    const char *name;
    size_t dims[3]; /* dims[0] 0: left out */
    double value;
    enum { REAL, COMPLEX, TEXT } kind;
};

enum { VALUES_MAX = 64 * 2 * 3 };

static const struct item items[] = {
    {"samples", {64, 2, 3}, 1, COMPLEX}, {"compressed", {1, 1, 1}, 1, REAL},   {"fs", {1, 1, 1}, 30e3, REAL},
    {"fc", {1, 1, 1}, 150e3, REAL},      {"bandwidth", {1, 1, 1}, 15e3, REAL}, {"sound_speed", {1, 1, 1}, 1500, REAL},
    {"t0", {1, 1, 1}, 0.026, REAL},      {"tx", {3, 3, 1}, 0, REAL},           {"rx", {3, 2, 3}, 0, REAL},
    {"velocity", {3, 1, 1}, 0, REAL},
};

static void item_write(mat_t *mat, const struct item *item)
{
    static double values[VALUES_MAX];
    size_t dims[3] = {item->dims[0], item->dims[1], item->dims[2]};
    for (size_t k = 0; k < VALUES_MAX; k++)
        values[k] = item->value;
    char text[] = "sas";
    mat_complex_split_t parts = {values, values};
    matvar_t *variable = NULL;
    if (item->kind == TEXT)
        variable = Mat_VarCreate(item->name, MAT_C_CHAR, MAT_T_UTF8, 2, (size_t[]){1, 3}, text, 0);
    else
        variable =
            Mat_VarCreate(item->name, MAT_C_DOUBLE, MAT_T_DOUBLE, dims[2] == 1 ? 2 : 3, dims,
                          item->kind == COMPLEX ? (void *)&parts : values, item->kind == COMPLEX ? MAT_F_COMPLEX : 0);
    assert_non_null(variable);
    assert_int_equal(Mat_VarWrite(mat, variable, MAT_COMPRESSION_NONE), 0);
    Mat_VarFree(variable);
}

/* The items with one in place of that of its name, or beside them. */
static void items_write(const char *name, const struct item *other)
{
    char format[] = "sas-echoes 1";
    mat_t *mat = Mat_CreateVer(path_in(name), NULL, MAT_FT_MAT5);
    assert_non_null(mat);
    if (strcmp(other->name, "format") != 0) {
        matvar_t *variable =
            Mat_VarCreate("format", MAT_C_CHAR, MAT_T_UTF8, 2, (size_t[]){1, strlen(format)}, format, 0);
        assert_int_equal(Mat_VarWrite(mat, variable, MAT_COMPRESSION_NONE), 0);
        Mat_VarFree(variable);
    }
    for (size_t k = 0; k < COUNT_OF(items); k++)
        if (strcmp(items[k].name, other->name) != 0)
            item_write(mat, &items[k]);
    if (other->dims[0] > 0)
        item_write(mat, other);
    Mat_Close(mat);
}

static void bad_echoes_are_refused(void **state)
{
    (void)state;
    static const struct {
        struct item item;
        const char *says[SAYS_MAX];
    } files[] = {
        {{"format", {0}, 0, TEXT}, {"`format` is missing", "\"sas-echoes 1\" is needed"}},
        {{"format", {1, 3, 1}, 0, TEXT}, {"`format` is \"sas\"", "\"sas-echoes 1\" is needed"}},
        {{"format", {1, 1, 1}, 1, REAL}, {"`format` is numeric", "\"sas-echoes 1\" is needed"}},
        {{"samples", {0}, 0, COMPLEX}, {"`samples` is missing", "[N x M x P]"}},
        {{"samples", {1, 3, 1}, 0, TEXT}, {"`samples` is text", "[N x M x P]"}},
        {{"samples", {64, 2, 3}, NAN, COMPLEX}, {"`samples` at (1, 1, 1) is nan", "finite"}},
        {{"samples", {64, 2, 3}, INFINITY, COMPLEX}, {"`samples` at (1, 1, 1) is inf", "finite"}},
        {{"samples", {1, 2, 3}, 1, COMPLEX}, {"number of samples is 1", "at least 2"}},
        {{"samples", {64, 3, 2}, 1, COMPLEX}, {"`tx` is [3 x 3 x 1]", "samples [64 x 3 x 2]", "[3 x P]"}},
        {{"samples", {64, 1, 3}, 1, COMPLEX}, {"`rx` is [3 x 2 x 3]", "samples [64 x 1 x 3]", "[3 x M x P]"}},
        {{"compressed", {1, 1, 1}, 2, REAL}, {"`compressed` is 2", "0 (raw) or 1"}},
        {{"compressed", {1, 1, 1}, 0, REAL}, {"pulse has 0 samples", "at least 1"}},
        {{"pulse", {8, 1, 1}, 1, COMPLEX}, {"pulse has 8 samples", "compressed echoes have none"}},
        {{"pulse", {4, 4, 1}, 1, COMPLEX}, {"`pulse` is [4 x 4 x 1]", "[K x 1]"}},
        {{"fs", {0}, 0, REAL}, {"`fs` is missing", "a scalar in Hz"}},
        {{"fs", {2, 1, 1}, 30e3, REAL}, {"`fs` is [2 x 1 x 1]", "a scalar in Hz"}},
        {{"fs", {1, 3, 1}, 0, TEXT}, {"`fs` is text", "a scalar in Hz"}},
        {{"fs", {1, 1, 1}, 30e3, COMPLEX}, {"`fs` is complex", "a scalar in Hz"}},
        {{"fs", {1, 1, 1}, 10e3, REAL}, {"bandwidth is 15000 Hz", "at most fs = 10000 Hz"}},
        {{"fs", {1, 1, 1}, NAN, REAL}, {"fs is nan Hz", "> 0"}},
        {{"fc", {1, 1, 1}, 0, REAL}, {"fc is 0 Hz", "> 0"}},
        {{"bandwidth", {1, 1, 1}, -15e3, REAL}, {"bandwidth is -15000 Hz", "> 0"}},
        {{"sound_speed", {1, 1, 1}, INFINITY, REAL}, {"sound_speed is inf m/s", "finite"}},
        {{"t0", {1, 2, 1}, 0.026, REAL}, {"`t0` is [1 x 2 x 1]", "[1 x P]"}},
        {{"t0", {1, 1, 1}, NAN, REAL}, {"t0 of ping 1 is nan s", "finite"}},
        {{"t0", {1, 1, 1}, 1e9, REAL}, {"phase error", "at most 0.001"}},
        {{"t0", {1, 1, 1}, 1, REAL}, {"no pixel meets any record"}},
        {{"tx", {2, 3, 1}, 0, REAL}, {"`tx` is [2 x 3 x 1]", "[3 x P]"}},
        {{"tx", {3, 3, 1}, INFINITY, REAL}, {"tx of ping 1 is (inf", "finite"}},
        {{"rx", {3, 2, 1}, 0, REAL}, {"`rx` is [3 x 2 x 1]", "[3 x M x P]"}},
        {{"rx", {3, 2, 3}, NAN, REAL}, {"rx 1 of ping 1 is (nan", "finite"}},
        {{"velocity", {3, 2, 1}, 0, REAL}, {"`velocity` is [3 x 2 x 1]", "[3 x 1] or [3 x P]"}},
        {{"velocity", {3, 1, 1}, 1500, REAL}, {"velocity of ping 1", "below sound_speed = 1500 m/s"}},
        {{"beam_limit", {1, 1, 1}, 0, REAL}, {"`beam_limit` is 0", "(0, 1]"}},
        {{"beam_limit", {1, 1, 1}, 1.5, REAL}, {"`beam_limit` is 1.5", "(0, 1]"}},
        {{"tx_length", {1, 1, 1}, -1, REAL}, {"tx_length is -1 m", ">= 0"}},
    };
    static const struct refusal refusal = {ECHOES("bad.mat"), {"bad.mat"}};
    static const struct item whole = {"beam_limit", {1, 1, 1}, 0.5, REAL};
    int failures = 0;
    items_write("bad.mat", &whole);
    program_good(refusal.arguments); /* what is refused below is refused for its fault */
    remove(path_in("x.mat"));
    for (size_t k = 0; k < COUNT_OF(files); k++) {
        items_write("bad.mat", &files[k].item);
        failures += !is_refused(refusal.arguments, files[k].says);
    }
    remove(path_in("bad.mat"));
    assert_int_equal(failures, 0);
}

/* --- What works ------------------------------------------------------------------------------------------------ */

static void assert_holds(const char *text, const char *part)
{
    if (!strstr(text, part))
        fail_msg("no '%s' in: %s", part, text);
}

static void help_list_and_info_tell_everything(void **state)
{
    (void)state;
    static const char *const helps[][ARGUMENTS_MAX] = {{"--help"}, {"-h"}, {"help"}, {"run", "--help"}};
    static const char *const commands[] = {"  list", "  info", "  simulate", "  image", "  run", "  test", "--threads"};
    for (size_t k = 0; k < COUNT_OF(helps); k++) {
        char *text = program_output(helps[k]);
        for (size_t n = 0; n < COUNT_OF(commands); n++)
            assert_holds(text, commands[n]);
        free(text);
    }
    static const char *const facts[] = {"sasbench 0.", "commit ", "compiler: ", "libraries: fftw", "instruction set: "};
    char *version = program_output((const char *const[ARGUMENTS_MAX]){"--version"});
    for (size_t n = 0; n < COUNT_OF(facts); n++)
        assert_holds(version, facts[n]);
    free(version);
    char *list = program_output((const char *const[ARGUMENTS_MAX]){"list"});
    for (int k = 0; algorithms[k]; k++) {
        assert_holds(list, algorithms[k]->name);
        assert_holds(list, algorithms[k]->summary);
        assert_holds(list, algorithms[k]->reference);
        char *info = program_output((const char *const[ARGUMENTS_MAX]){"info", algorithms[k]->name});
        assert_holds(info, algorithms[k]->name);
        assert_holds(info, "precision");
        for (const struct param *param = algorithms[k]->params; param && param->name; param++) {
            assert_holds(info, param->name);
            assert_holds(info, param->summary);
            if (param->sweep)
                assert_holds(info, param->sweep);
        }
        free(info);
    }
    free(list);
}

static void file_and_scene_give_the_same_image(void **state)
{
    (void)state;
    static const char *const simulate[ARGUMENTS_MAX] = {"simulate", "study/quick", "-o", "echoes.mat"};
    static const char *const from_scene[ARGUMENTS_MAX] = {
        "image", "--scene", "study/quick", "--algorithm", "bp_sinc:precision=double", "-o", "scene.mat"};
    static const char *const from_file[ARGUMENTS_MAX] = {"image",
                                                         "--echoes",
                                                         "echoes.mat",
                                                         "--grid",
                                                         "-0.6:0.02:61,19.85:0.025:13",
                                                         "--algorithm",
                                                         "bp_sinc:precision=double",
                                                         "-o",
                                                         "file.mat",
                                                         "--threads",
                                                         "1"};
    struct grid grid[2];
    double complex *pixels[2];
    program_good(simulate);
    program_good(from_scene);
    program_good(from_file);
    const char *const files[] = {"scene.mat", "file.mat"};
    for (int k = 0; k < 2; k++) {
        if (image_file_read(path_in(files[k]), &grid[k], &pixels[k]) != STATUS_OK)
            fail_msg("%s", status_message());
        assert_int_equal(grid[k].x_count, 61);
        assert_int_equal(grid[k].r_count, 13);
        assert_true(fabs(grid[k].x_first + 0.6) < 1e-9 && fabs(grid[k].x_step - 0.02) < 1e-9);
        assert_true(fabs(grid[k].r_first - 19.85) < 1e-9 && fabs(grid[k].r_step - 0.025) < 1e-9);
    }
    double peak = 0, difference = 0;
    int brightest = 0;
    for (int i = 0; i < 61 * 13; i++) {
        if (cabs(pixels[0][i]) > peak) {
            peak = cabs(pixels[0][i]);
            brightest = i;
        }
        difference = worse_of(difference, cabs(pixels[0][i] - pixels[1][i]));
    }
    assert_int_equal(brightest, 6 * 61 + 30); /* the target at (0, 20) m */
    if (!(difference <= 1e-9 * peak))
        fail_msg("largest difference %g of a peak of %g", difference, peak);
    free(pixels[0]);
    free(pixels[1]);
}

static void csv_load(const char *name, struct csv *csv)
{
    if (csv_read(path_in(name), CSV_TAIL_DROP, csv) != STATUS_OK)
        fail_msg("%s", status_message());
}

/* The first row that is no comment. */
static void assert_header(const char *name, const char *header)
{
    size_t size;
    char *text = bytes_read(name, &size), *line = text;
    while (*line == '#')
        line += strcspn(line, "\n") + 1;
    line[strcspn(line, "\n")] = '\0';
    assert_true(line > text); /* a comment block tells where the rows come from */
    assert_string_equal(line, header);
    free(text);
}

static void assert_rows_kept(const struct csv *before, const struct csv *after)
{
    assert_true(after->row_count >= before->row_count);
    for (int row = 0; row < before->row_count; row++)
        for (int k = 0; k < before->column_count; k++)
            assert_string_equal(csv_cell(after, row, k), csv_cell(before, row, k));
}

/* Pictures in a folder below ours, each of them a PNG from signature to end. */
static int pictures_count(const char *name)
{
    static const char begin[] = "\x89PNG\r\n\x1a\n", end[] = "IEND\xae\x42\x60\x82";
    char path[600], *roots[] = {path, NULL};
    int count = 0;
    snprintf(path, sizeof path, "%s", path_in(name));
    FTS *tree = fts_open(roots, FTS_PHYSICAL | FTS_NOCHDIR, NULL);
    assert_non_null(tree);
    for (FTSENT *entry; (entry = fts_read(tree));) {
        const char *extension = strrchr(entry->fts_name, '.');
        if (entry->fts_info != FTS_F || !extension || strcmp(extension, ".png") != 0)
            continue;
        size_t size;
        char *bytes = bytes_read(entry->fts_path + strlen(folder) + 1, &size);
        assert_true(size > 1000);
        assert_memory_equal(bytes, begin, sizeof begin - 1);
        assert_memory_equal(bytes + size - (sizeof end - 1), end, sizeof end - 1);
        free(bytes);
        count++;
    }
    fts_close(tree);
    return count;
}

static int rows_with_status(const struct csv *csv, const char *status)
{
    int count = 0;
    for (int row = 0; row < csv->row_count; row++)
        count += strcmp(csv_cell(csv, row, csv_column(csv, "status")), status) == 0;
    return count;
}

static void run_leaves_its_results_and_keeps_them(void **state)
{
    (void)state;
    static const char *const run[ARGUMENTS_MAX] = {"run", "study/quick", "-o", "results/quick"};
    struct csv first, second;
    char *table = program_output(run);
    assert_holds(table, "study/quick");
    int count = 0;
    for (; algorithms[count]; count++)
        assert_holds(table, algorithms[count]->name);
    free(table);
    assert_header("results/quick/measurements.csv",
                  "scene,algorithm,options,precision,threads,engine,status,reason,skipped,plan_s,run_s,run_min_s,"
                  "runs,control_s,stages,flops_published,flops,pairs,bytes,error,error_gain,phase_rms_rad,width_m,"
                  "pslr_db,islr_db");
    assert_header("results/quick/targets.csv", "scene,algorithm,options,precision,target,axis,definition,extent_m,"
                                               "position_error_m,phase_error_rad,width_m,pslr_db,islr_db");
    csv_load("results/quick/measurements.csv", &first);
    assert_int_equal(first.row_count, count);
    int good = rows_with_status(&first, "ok");
    assert_true(good >= 5); /* reference and the back projections image everything */
    assert_int_equal(rows_with_status(&first, "failed"), 0);
    assert_int_equal(pictures_count("results/quick"), good + 1);
    for (int row = 0; row < good; row++) {
        double run_s, error;
        assert_string_equal(csv_cell(&first, row, csv_column(&first, "scene")), "study/quick");
        assert_true(csv_number(csv_cell(&first, row, csv_column(&first, "run_s")), &run_s) && run_s > 0);
        assert_true(csv_number(csv_cell(&first, row, csv_column(&first, "error")), &error) && error < 0.5);
    }

    struct timespec begin, end;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    program_good(run);
    clock_gettime(CLOCK_MONOTONIC, &end);
    double seconds = (double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec);
    if (!(seconds < 1)) /* measuring anew takes half a second an algorithm */
        fail_msg("a repeated run takes %g s", seconds);
    csv_load("results/quick/measurements.csv", &second);
    assert_int_equal(second.row_count, first.row_count);
    assert_rows_kept(&first, &second);
    csv_free(&first);
    csv_free(&second);
}

static void unsupported_is_a_row_with_a_reason(void **state)
{
    (void)state;
    static const char *const run[ARGUMENTS_MAX] = {"run", "scene.cfg", "-a", "bp_sinc:taps=7", "-o", "results/odd"};
    struct csv csv;
    program_good(run);
    csv_load("results/odd/measurements.csv", &csv);
    assert_int_equal(csv.row_count, 1);
    assert_string_equal(csv_cell(&csv, 0, csv_column(&csv, "status")), "unsupported");
    assert_holds(csv_cell(&csv, 0, csv_column(&csv, "reason")), "taps is 7");
    assert_string_equal(csv_cell(&csv, 0, csv_column(&csv, "run_s")), "");
    assert_int_equal(pictures_count("results/odd"), 0);
    csv_free(&csv);
}

/* Rows that are whole by now; 0 while there is no file. */
static int rows_now(const char *name)
{
    struct csv csv;
    if (csv_read(path_in(name), CSV_TAIL_DROP, &csv) != STATUS_OK)
        return 0;
    int count = csv.row_count;
    csv_free(&csv);
    return count;
}

static void interrupted_run_goes_on(void **state)
{
    (void)state;
    static const char *const run[ARGUMENTS_MAX] = {"run",        "scene.cfg", "study/quick", "-a",
                                                   "bp_nearest", "-o",        "results/cut"};
    static const char measurements[] = "results/cut/measurements.csv", targets[] = "results/cut/targets.csv";
    struct csv before, after;
    int status;
    FILE *sink = tmpfile();
    assert_non_null(sink);
    pid_t child = program_start(run, sink, sink);
    while (rows_now(measurements) == 0 && waitpid(child, &status, WNOHANG) == 0)
        nanosleep(&(struct timespec){0, 2000000}, NULL);
    kill(-child, SIGKILL); /* with the gnuplot that it may have started */
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status));
    fclose(sink);
    csv_load(measurements, &before);
    assert_int_equal(before.row_count, 1);

    program_good(run);
    csv_load(measurements, &after);
    assert_rows_kept(&before, &after);
    assert_int_equal(after.row_count, 2);
    assert_int_equal(rows_with_status(&after, "ok"), 2);
    assert_string_equal(csv_cell(&after, 1, csv_column(&after, "scene")), "study/quick");
    assert_int_equal(rows_now(targets), 2 * 5); /* one target: three definitions along x, two along r */
    /* Each scene's image, and the slices of the scene that the second call measured. */
    assert_in_range(pictures_count("results/cut"), 3, 4);
    csv_free(&before);
    csv_free(&after);
}

/* --- The folder ------------------------------------------------------------------------------------------------ */

/* The echo file that the others are cut and damaged from. */
static void echo_files_write(void)
{
    struct scene scene;
    struct echoes echoes;
    size_t size;
    support_scene("study/quick", &scene);
    support_echoes(&scene, &echoes);
    if (echo_file_write(path_in("good.mat"), &echoes, NULL) != STATUS_OK)
        fail_msg("%s", status_message());
    echoes_free(&echoes);
    scene_free(&scene);
    char *bytes = bytes_read("good.mat", &size);
    bytes_write("begun.mat", bytes, 100); /* inside the head of 128 bytes */
    bytes_write("head.mat", bytes, 128);
    bytes_write("half.mat", bytes, size / 2);
    bytes_write("short.mat", bytes, size - 1);
    bytes_write("long.mat", bytes, size + 1); /* bytes_read adds one */
    memset(bytes + size / 2, 0xff, 1000);     /* amid the packed samples */
    bytes_write("damaged.mat", bytes, size);
    free(bytes);
}

/* The folder is where the program runs: all paths are relative to it. */
static int inputs_make(void **state)
{
    const char *path = getenv("SASBENCH_PROGRAM");
    if (!path || !realpath(path, program)) {
        print_error("SASBENCH_PROGRAM must be the path of the program to test\n");
        return -1;
    }
    /* The program's own temporary files are to be seen, too. */
    if (folder_make(state) != 0 || setenv("TMPDIR", folder, 1) != 0)
        return -1;
    memset(long_name, 'x', sizeof long_name - 1);
    if (mkdir(path_in("folder.cfg"), 0777) != 0 || mkdir(path_in("foreign"), 0777) != 0
        || mkdir(path_in("crowded"), 0777) != 0 || mkdir(path_in("crowded/targets.csv"), 0777) != 0)
        return -1;
    text_write("scene.cfg", scene_text);
    text_write("plain.txt", "plain text\n");
    text_write("foreign/measurements.csv", "volt,ampere\n1,2\n");
    text_write("empty.cfg", "");
    text_write("empty.mat", "");
    bytes_write("binary.cfg",
                "\x7f"
                "ELF\x02\x01\x00\x03\xff\xfe",
                10);
    echo_files_write();
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_usage_is_refused),
        cmocka_unit_test(bad_places_are_refused),
        cmocka_unit_test(bad_scenes_are_refused),
        cmocka_unit_test(bad_echoes_are_refused),
        cmocka_unit_test(help_list_and_info_tell_everything),
        cmocka_unit_test(file_and_scene_give_the_same_image),
        cmocka_unit_test(run_leaves_its_results_and_keeps_them),
        cmocka_unit_test(unsupported_is_a_row_with_a_reason),
        cmocka_unit_test(interrupted_run_goes_on),
    };
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
