/* Command lines that are refused: each with exit status 2 and one line that names what is wrong and what is accepted;
   nothing is written. */
#include <stdlib.h>
#include <unistd.h>

#include "tests/command/program.h"

/* --- Bad command lines ----------------------------------------------------------------------------------------- */

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

static const struct refusal usages[] = {
    {{NULL}, {"is not a command", "accepted: run, report, list, info, check, plan, scenes, simulate, convert, image"}},
    {{""}, {"'' is not a command", "accepted: run, report, list"}},
    {{"focus"}, {"'focus' is not a command", "accepted: run, report, list"}},
    {{"help", "focus"}, {"'focus' is not a command", "accepted: run, report, list"}},
    {{"rnu"}, {"'rnu' is not a command; did you mean 'run'?", "accepted: run, report, list"}},
    {{"simulat", "study/quick"}, {"did you mean 'simulate'?"}},
    {{"run", "study/quik", "-o", "r"}, {"study/quik.cfg: there is no such scene", "did you mean 'study/quick'?"}},
    {{"run", "study/quick", "--algoritm", "bp_sinc"}, {"'--algoritm'", "did you mean '--algorithm'?"}},
    {{"info", "bp_sicn"}, {"unknown algorithm 'bp_sicn'; did you mean 'bp_sinc'?"}},
    {{"benchmark"}, {"'benchmark' is not a command; did you mean 'bench'?"}},
    {{"rep"}, {"'rep' is not a command; did you mean 'report' or 'reproduce'?"}},
    {{"r"}, {"did you mean 'run', 'report' or 'reproduce'?"}},
    {{"-"}, {"'-' is not a command; accepted: run, report, list"}},
    {{"-V"}, {"'-V' is not a command; did you mean '--version'?"}},
    {{"version"}, {"'version' is not a command; did you mean '--version'?"}},
    {{"--hlep"}, {"'--hlep' is not a command; did you mean '--help'?"}},
    {{"--threads", "2", "list"}, {"'--threads' is not a command but an option", "sasbench COMMAND --threads;"}},
    {{"-t", "2", "list"}, {"'-t' is not a command but an option", "sasbench COMMAND -t;"}},
    {{"--algorithm=bp_sinc", "run"}, {"is not a command but an option", "sasbench COMMAND --algorithm=bp_sinc;"}},
    {{"reproduce", "table3", "-o", "r"}, {"'table3' is not a table; did you mean 'bp22_t3' or 'lbf21_t3'?"}},
    {{"reproduce", "Fig. 8", "-o", "r"}, {"'Fig. 8' is not a table; did you mean 'bp22_f8' or 'lbf21_f8'?"}},
    {{"reproduce", "bp22_t5", "-o", "r"}, {"did you mean 'bp22_t1', 'bp22_t3' or 'bp22_t4'?", "accepted: bp22_t1"}},
    {{"reproduce", "bp22-4.1-99", "-o", "r"}, {"did you mean 'bp22-4.1-9'?"}},
    {{"run", "quick", "-o", "r"}, {"quick.cfg: there is no such scene; did you mean 'study/quick'?"}},
    {{"run", "study/quick", "bp_sinc", "-o", "r"}, {"there is no such scene", "--algorithm bp_sinc"}},
    {{"run", "bp_sinc:taps=8", "-o", "r"}, {"there is no such scene", "--algorithm bp_sinc:taps=8"}},
    {{"sweep", "--quick=3"}, {"sweep: option '--quick' is not one of this command"}},
    {{"bench", "--algorithm", "bp_sinc"}, {"option '--algorithm'", "; SPEC stands without it: sasbench bench [SPEC"}},
    {{"two\nlines"}, {"'two?lines' is not a command"}},
    {{"--threads"}, {"'--threads' is not a command but an option"}},
    {{"list", "all"}, {"list: 'all' is one argument too many"}},
    {{"list", "-o", "x"}, {"list: option '-o' is not one of this command", "accepted: none"}},
    {{"sweep", "study/quick", "-P", "float"}, {"sweep: option '-P' is not one of this command", "--precision"}},
    {{"info"}, {"info: an argument is missing", "NAME"}},
    {{"info", "no_such_algorithm"}, {"'no_such_algorithm'", "accepted: reference, bp_nearest"}},
    {{"info", "bp_sinc", "bp_linear"}, {"info: 'bp_linear' is one argument too many"}},
    {{"compare", "a.csv"}, {"compare: an argument is missing", "OLD NEW"}},
    {{"compare", "a.csv", "b.csv", "c.csv"}, {"'c.csv' is one argument too many without --ab"}},
    {{"compare", "a.csv", "b.csv", "-a", "bp_sinc"}, {"'--algorithm' is one argument too many without --ab"}},
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
     {"simulate: option '--grid' is not one of this command", "accepted: --output, --threads"}},
    {{"simulate", "study/quick", "-o", "x.mat", "--colour"}, {"option '--colour'", "accepted: --output"}},
    {{"simulate", "study/quick", "-o", "x.mat", "-z"}, {"option '-z'", "accepted: --output"}},
    {{"image", "-a", "bp_nearest", "-o", "x.mat"}, {"image: exactly one of --scene SCENE and --echoes FILE.mat"}},
    {{"image", "--scene", "study/quick", "--echoes", "good.mat", "-a", "bp_nearest", "-o", "x.mat"},
     {"image: exactly one of --scene SCENE and --echoes FILE.mat"}},
    {{"image", "--echoes", "good.mat", "-a", "bp_nearest", "-o", "x.mat"},
     {"good.mat: variable `image_grid` is missing; --grid"}},
    {{"image", "--scene", "study/quick", "-o", "x.mat"}, {"--algorithm SPEC is missing; `-a auto`"}},
    {{"image", "--scene", "study/quick", "-o", "x.mat", "-a", "bp_nearest", "-a", "bp_sinc"},
     {"--algorithm is given twice"}},
    {{"image", "--scene", "study/quick", "-a", "bp_nearest"}, {"image: -o FILE.mat is missing"}},
    {{"image", "study/quick", "-a", "bp_nearest", "-o", "x.mat"}, {"'study/quick' is one argument too many"}},
    {{"run", "--scene", "study/quick", "-o", "r"},
     {"run: option '--scene'", "; SCENE stands without it: sasbench run ([SCENE", "accepted: --output, --echoes"}},
    {{"run", "-sX"}, {"run: option '-s' is not one of this command; SCENE stands without it"}},
    {{"run", "study/quick", "study/quick", "-o", "r"}, {"scene study/quick is given twice"}},
    {{"run", "study/quick", "-a", "bp_linear", "-a", "bp_linear:beta=8", "-o", "r"},
     {"--algorithm bp_linear is given twice with the same settings"}},
    {{"bench", "bp_nearest", "no_such_algorithm"}, {"'no_such_algorithm'", "accepted: reference, bp_nearest"}},
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
    {SPEC("BP_SINC"), {"unknown algorithm 'BP_SINC'; did you mean 'bp_sinc'?", "accepted: reference"}},
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
    {SPEC("bp_sinc:tap=8"), {"unknown key 'tap'; did you mean 'taps'?", "accepted: taps, window,"}},
    {SPEC("bp_sinc:window=kaizer"), {"window is 'kaizer'; did you mean 'kaiser'?", "accepted: none"}},
    {SPEC("sinc"), {"unknown algorithm 'sinc'; did you mean 'bp_sinc'?"}},
    {SPEC("bp_sinc:window=hann"), {"window is 'hann'", "accepted: none, kaiser, kaiser_band"}},
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

static void bad_usage_is_refused(void **state)
{
    (void)state;
    assert_all_refused(usages, COUNT_OF(usages));
}

/* --- Bad places ------------------------------------------------------------------------------------------------ */

#define RUN_INTO(place)                                                                                                \
    {                                                                                                                  \
        "run", "study/quick", "-a", "bp_nearest", "-o", place                                                          \
    }

static const struct refusal places[] = {
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
    {{"image", "--scene", "study/quick", "-a", "bp_nearest", "-o", "x.jpg"},
     {"image: -o x.jpg has another ending", "accepted: FILE.mat, FILE.png, FILE.svg"}},
    {{"image", "--scene", "study/quick", "-a", "bp_nearest", "-o", "x.mat", "--range", "40"},
     {"image: --range 40 applies to pictures"}},
    {{"image", "--scene", "study/quick", "-a", "bp_nearest", "-o", "x.png", "--range", "-40"},
     {"image: --range is '-40'", "from 1 to 400"}},
    {{"image", "--scene", "study/quick", "-a", "bp_nearest", "-o", "nowhere/x.png"},
     {"nowhere/x.png: cannot be written"}},
    {{"show", "good.mat"}, {"good.mat holds echoes, not an image", "image --echoes good.mat"}},
    {{"show", "missing.mat"}, {"missing.mat: cannot be read"}},
    {{"show", "good.mat", "-o", "x.mat"}, {"show: -o x.mat has another ending", "FILE.png, FILE.svg"}},
    {{"show", "good.mat", "--range", "low"}, {"show: --range is 'low'", "from 1 to 400"}},
    {{"info", "missing.mat"}, {"missing.mat: cannot be read"}},
    {{"info", "half.mat"}, {"half.mat: is cut short"}},
    {{"image", "--scene", "study/quick", "-a", "bp_nearest", "-o", "mat"}, {"image: -o mat has another ending"}},
    {{"simulate", "study/quick", "-o", "x.csv"}, {"simulate: -o x.csv has another ending", "accepted: FILE.mat"}},
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
    {RUN_INTO("foreign"), {"foreign/measurements.csv:1: the first line is not '# sasbench", "name another folder"}},
    {RUN_INTO("crowded"), {"crowded/targets.csv", "a regular file"}},

    {{"simulate", "nowhere/scene", "-o", "x.mat"}, {"nowhere/scene.cfg", "the name of a shipped scene"}},
    {{"simulate", "study", "-o", "x.mat"}, {"study.cfg", "the name of a shipped scene"}},
    {{"simulate", "", "-o", "x.mat"}, {"simulate: an argument is ''", "a name"}},
    {{"simulate", "missing.cfg", "-o", "x.mat"}, {"missing.cfg: scene is not readable", "the path of a .cfg file"}},
    {{"simulate", "folder.cfg", "-o", "x.mat"}, {"folder.cfg", "not a regular file", "the path of a .cfg file"}},
    {{"simulate", "empty.cfg", "-o", "x.mat"}, {"empty.cfg: key 'sonar' is missing", "must be a group"}},
    {{"simulate", "binary.cfg", "-o", "x.mat"}, {"binary.cfg:", "must be", "text"}},
    {{"run", "study/quick", "missing.cfg", "-o", "r"}, {"missing.cfg: scene is not readable"}},
    {{"image", "--scene", "missing.cfg", "-a", "bp_nearest", "-o", "x.mat"}, {"missing.cfg: scene is not readable"}},

    {ECHOES("missing.mat"), {"missing.mat: cannot be read"}},
    {ECHOES(""), {"image: --echoes is ''", "a path"}},
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

static void bad_places_are_refused(void **state)
{
    (void)state;
    assert_all_refused(places, COUNT_OF(places));
}

static void unknown_instruction_sets_are_refused(void **state)
{
    (void)state;
    static const char *const list[ARGUMENTS_MAX] = {"list"};
    static const char *const says[SAYS_MAX] = {"SASBENCH_ISA=avx2", "baseline, v3 and v4"};
    setenv("SASBENCH_ISA", "avx2", 1);
    assert_true(is_refused(list, says));
    setenv("SASBENCH_ISA", "v3", 1);
    free(program_output(list));
    unsetenv("SASBENCH_ISA");
}

/* As --threads is, which goes before it. */
static void threads_of_the_environment_have_a_bound(void **state)
{
    (void)state;
    static const char *const simulate[ARGUMENTS_MAX] = {"simulate", "study/quick", "-o", "x.mat"};
    static const char *const given[ARGUMENTS_MAX] = {"simulate", "study/quick", "-o", "x.mat", "--threads", "2"};
    static const char *const many[] = {"1025", "20000", "99999", "2000000000"};
    char before[32];
    snprintf(before, sizeof before, "%s", getenv("OMP_NUM_THREADS") ? getenv("OMP_NUM_THREADS") : "2");
    for (size_t k = 0; k < COUNT_OF(many); k++) {
        const char *const says[SAYS_MAX] = {"OMP_NUM_THREADS is '", many[k], "a whole number from 1 to 1024"};
        setenv("OMP_NUM_THREADS", many[k], 1);
        assert_true(is_refused(simulate, says));
    }
    free(program_output(given));
    unlink(path_in("x.mat"));
    setenv("OMP_NUM_THREADS", before, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_usage_is_refused),
        cmocka_unit_test(bad_places_are_refused),
        cmocka_unit_test(unknown_instruction_sets_are_refused),
        cmocka_unit_test(threads_of_the_environment_have_a_bound),
    };
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
