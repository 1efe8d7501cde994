/* Algorithms in shared objects, as a stranger makes them: with the installed header and the template of docs/plugin
   alone. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "files/csv.h"
#include "tests/command/program.h"

/* The template, built; cc NAME.so FLAGS compiles NAME.c with the installed header. */
static int plugin_make(void **state)
{
    inputs_make(state);
    assert_shell(
        "build=$(dirname \"$SASBENCH_PROGRAM\")/..\n"
        "meson install -C \"$build\" --no-rebuild --destdir \"$PWD/installed\" >&2\n"
        "mv installed/usr/local/include include\n"
        "cp \"$ROOT\"/docs/plugin/* .\n"
        "CPATH=$PWD/include meson setup built >&2 && CPATH=$PWD/include ninja -C built >&2 && cp built/mine.so .\n"
        "printf '%s\\n' '#!/bin/sh' 'name=$1; shift' "
        "'exec cc -std=gnu17 -O1 -fopenmp -Wall -Wextra -Werror -shared -fPIC -Iinclude -o \"$name.so\" \"$@\" -lm'"
        " >plug && chmod +x plug",
        0);
    return 0;
}

static char *cell_of(const char *file, int row, const char *column)
{
    struct csv csv;
    assert_int_equal(csv_read(path_in(file), CSV_TAIL_KEEP, &csv), STATUS_OK);
    assert_true(row < csv.row_count);
    char *cell = strdup(csv_cell(&csv, row, csv_column(&csv, column)));
    csv_free(&csv);
    return cell;
}

static void assert_cell(const char *file, int row, const char *column, const char *wanted)
{
    char *cell = cell_of(file, row, column);
    assert_string_equal(cell, wanted);
    free(cell);
}

/* The file's only algorithm comment. */
static void origin_of(const char *file, char *text, size_t size)
{
    struct csv csv;
    assert_int_equal(csv_read(path_in(file), CSV_TAIL_KEEP, &csv), STATUS_OK);
    const char *origin = csv_comment(&csv, "algorithm ./mine.so");
    assert_non_null(origin);
    snprintf(text, size, "%s", origin);
    csv_free(&csv);
}

/* The header is installed, and compiles alone in either language. */
static void header_is_public(void **state)
{
    (void)state;
    text_write("alone.c", "#include <sasbench.h>\nint size = (int)sizeof(struct sas_problem) + SAS_ABI;\n");
    text_write("alone.cc", "#include <sasbench.h>\n"
                           "static int execute(void *, const void *, void *const *, void *) { return SAS_OK; }\n"
                           "static int plan(const struct sas_problem *problem, void **)\n"
                           "{ return SAS_HAS(problem, struct sas_problem, host) ? SAS_OK : SAS_FAILED; }\n"
                           "static void work(const void *, sas_work *) {}\nstatic void destroy(void *) {}\n"
                           "const sas_algorithm sas_plugin = {sizeof sas_plugin, SAS_ABI, \"a\", \"b\", 0, 0, nullptr,"
                           " plan, execute, work, destroy};\n");
    assert_shell("cc -std=c11 -Wall -Wextra -Wpedantic -Werror -fsyntax-only -Iinclude alone.c", 0);
    assert_shell("c++ -std=c++11 -Wall -Wextra -Wpedantic -Werror -fsyntax-only -Iinclude alone.cc", 0);
    assert_shell("test $(wc -l <mine.c) -le 60", 0);
}

/* The template's image is that of our own truncated sinc, with its counts, on two scenes, in every command. */
static void template_is_measured(void **state)
{
    (void)state;
    program_good((const char *const[ARGUMENTS_MAX]){"run", "study/quick", "gate/squint", "-a", "./mine.so", "-a",
                                                    "./mine.so:taps=4,precision=double", "-a", "bp_sinc", "-o", "run"});
    for (int scene = 0; scene < 2; scene++) {
        char *error = cell_of("run/measurements.csv", 3 * scene, "error");
        char *ours = cell_of("run/measurements.csv", 3 * scene + 2, "error");
        assert_cell("run/measurements.csv", 3 * scene, "status", "ok");
        assert_cell("run/measurements.csv", 3 * scene, "algorithm", "./mine.so");
        assert_cell("run/measurements.csv", 3 * scene + 1, "options", "taps=4");
        assert_true(fabs(atof(error) - atof(ours)) < 1e-2 * atof(ours));
        free(error);
        free(ours);
        char *pairs = cell_of("run/measurements.csv", 3 * scene + 2, "pairs");
        assert_cell("run/measurements.csv", 3 * scene, "pairs", pairs);
        free(pairs);
    }
    program_good((const char *const[ARGUMENTS_MAX]){"image", "--scene", "study/quick", "-a", "mine.so", "-o", "i.png"});
    program_good((const char *const[ARGUMENTS_MAX]){"sweep", "study/quick", "-a", "./mine.so", "-o", "sweep"});
    char *told = program_output((const char *const[ARGUMENTS_MAX]){"info", "mine.so"});
    assert_non_null(strstr(told, "mine.so: back projection by a truncated sinc\n"));
    assert_non_null(strstr(told, "taps        8          1 to 64                  2 4 8 16\n"));
    free(told);
    char *points = support_read("sweep/measurements.csv");
    assert_non_null(strstr(points, "./mine.so,taps=16,double"));
    free(points);
}

/* What was built anew is measured anew; other algorithms' rows, and those of the same file, stay. */
static void rebuilt_is_measured_anew(void **state)
{
    (void)state;
    static const char *const arguments[ARGUMENTS_MAX] = {"run", "study/quick", "-a", "./mine.so",
                                                         "-a",  "bp_nearest",  "-o", "anew"};
    char first[80], second[80];
    program_good(arguments);
    origin_of("anew/measurements.csv", first, sizeof first);
    char *ours = cell_of("anew/measurements.csv", 1, "run_s"), *theirs = cell_of("anew/measurements.csv", 0, "run_s");
    program_good(arguments);
    assert_cell("anew/measurements.csv", 0, "run_s", theirs);
    free(theirs);
    assert_shell("sed 's/BP22/BP 22/' mine.c >other.c && cp mine.so kept.so && ./plug mine other.c", 0);
    struct outcome outcome = program_run(arguments);
    assert_int_equal(outcome.status, 0);
    assert_non_null(strstr(outcome.err, "the algorithm ./mine.so has changed; the old rows are kept in"));
    outcome_free(&outcome);
    origin_of("anew/measurements.csv", second, sizeof second);
    assert_string_not_equal(first, second);
    assert_cell("anew/measurements.csv", 0, "algorithm", "bp_nearest");
    assert_cell("anew/measurements.csv", 0, "run_s", ours);
    assert_cell("anew/measurements.csv", 1, "algorithm", "./mine.so");
    free(ours);
    assert_shell("mv kept.so mine.so", 0);
}

/* Two of one name in two folders are two algorithms. */
static void names_stay_apart(void **state)
{
    (void)state;
    assert_shell(
        "mkdir 'a b' c && cp mine.so 'a b/'; sed 's/8, 1, 64/2, 1, 64/' mine.c >c/mine.c && ./plug c/mine c/mine.c", 0);
    program_good(
        (const char *const[ARGUMENTS_MAX]){"run", "study/quick", "-a", "a b/mine.so", "-a", "c/mine.so", "-o", "two"});
    assert_cell("two/measurements.csv", 0, "algorithm", "a b/mine.so");
    assert_cell("two/measurements.csv", 0, "options", "taps=8");
    assert_cell("two/measurements.csv", 1, "algorithm", "c/mine.so");
    assert_cell("two/measurements.csv", 1, "options", "taps=2");
    program_good((const char *const[ARGUMENTS_MAX]){"report", "two"});
    /* A file that names a shared object loads nothing. */
    assert_shell("rm -r 'a b' c", 0);
    program_good((const char *const[ARGUMENTS_MAX]){"report", "two"});
}

/* A plug-in compiled against the header of ABI 1, without filters and without the last field of two structs. */
static void earlier_header_is_taken(void **state)
{
    (void)state;
    assert_shell("mkdir -p earlier && sed '/const char \\*sweep;/d; /char skipped/d; /^struct sas_filter {/,/^};/d; "
                 "/sas_filter_plugin;/d;"
                 " s/^\\(#define SAS_ABI \\+\\).*/\\11/' include/sasbench.h >earlier/sasbench.h"
                 " && grep -q 'SAS_ABI  *1$' earlier/sasbench.h && ! grep -q 'struct sas_filter {' earlier/sasbench.h"
                 " && sed 's/, \"2 4 8 16\"//' mine.c >early.c"
                 " && cc -std=gnu17 -O1 -fopenmp -Werror -shared -fPIC -Iearlier -o early.so early.c -lm",
                 0);
    program_good((const char *const[ARGUMENTS_MAX]){"run", "study/quick", "-a", "./early.so", "-o", "early"});
    assert_cell("early/measurements.csv", 0, "status", "ok");
}

/* What no plug-in is, by name. */
static void faulty_objects_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *name, *edit, *says[2];
    } faults[] = {
        {"symbol",
         "s/sas_plugin =/another =/; s/sizeof sas_plugin/sizeof another/",
         {"defines neither `sas_plugin` nor `sas_filter_plugin`", "symbol"}},
        {"newer",
         "s/SAS_ABI/SAS_ABI + 1/",
         {"has ABI 3, of a newer sasbench.h; this program takes 1 to 2", "newer.so"}},
        {"none", "s/SAS_ABI/0/", {"has ABI 0; this program takes", "none.so"}},
        {"size",
         "s/sizeof sas_plugin/sizeof sas_plugin + 8/",
         {"struct sas_algorithm has 80 bytes, of a newer", "size.so"}},
        {"small", "s/sizeof sas_plugin/16/", {"struct sas_algorithm has 16 bytes; this", "small.so"}},
        {"setting", "s/{sizeof taps/{sizeof taps + 8/", {"settings of 80 bytes each", "newer sasbench.h"}},
        {"initial", "s/8, 1, 64/65, 1, 64/", {"setting 1, 'taps': its default is not within", "initial.so"}},
        {"callback", "s/make, execute/NULL, execute/", {"leaves out summary, reference, plan", "callback.so"}},
        {"undefined", "s/SAS_OK;/SAS_OK + no_such_function();/", {"cannot be loaded", "no_such_function"}},
    };
    for (size_t k = 0; k < COUNT_OF(faults); k++) {
        char lines[600], spec[40];
        snprintf(spec, sizeof spec, "./%s.so", faults[k].name);
        snprintf(lines, sizeof lines,
                 "{ echo 'int no_such_function(void);'; sed '%s' mine.c; } >%s.c && ! cmp -s mine.c %s.c"
                 " && ./plug %s -Wno-unused-function %s.c",
                 faults[k].edit, faults[k].name, faults[k].name, faults[k].name, faults[k].name);
        assert_shell(lines, 0);
        const struct refusal refusal = {{"run", "study/quick", "-a", spec, "-o", "x"},
                                        {faults[k].says[0], faults[k].says[1]}};
        assert_all_refused(&refusal, 1);
    }
    text_write("text.so", "no object\n");
    static const struct refusal refusals[] = {
        {{"run", "study/quick", "-a", "./text.so", "-o", "x"}, {"text.so: cannot be loaded: ", "file too short"}},
        {{"run", "study/quick", "-a", "absent.so", "-o", "x"}, {"absent.so: cannot be read: No such file"}},
        {{"run", "study/quick", "-a", "./mine.so:tabs=3", "-o", "x"}, {"did you mean 'taps'?"}},
        {{"run", "study/quick", "-a", "./mine.so:taps=65", "-o", "x"}, {"a whole number from 1 to 64"}},
        {{"info", "absent.so"}, {"absent.so: cannot be read"}},
    };
    assert_all_refused(refusals, COUNT_OF(refusals));
}

/* Nor what cannot be loaded without ending what loads it, nor a table of settings that cannot be given. */
static void faulty_loads_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *edit, *says;
    } faults[] = {
        {"s/^static int make/__attribute__((constructor)) static void begin(void) { abort(); }\\n&/",
         "cannot be loaded: this ends by signal 6"},
        {"s/^static int make/__attribute__((constructor)) static void begin(void) { exit(0); }\\n&/",
         "cannot be loaded: this ends the program with exit status 0"},
        {"s/^static int make/#include <signal.h>\\n__attribute__((constructor)) static void begin(void) { "
         "raise(SIGSTOP); }\\n&/",
         "cannot be loaded: this stops by signal 19"},
        {"s/static const struct sas_setting/const struct sas_setting/; s/1, &taps/1, NULL/", "but `settings` is NULL"},
        {"s/\"taps\"/\"precision\"/", "its name is that of another setting, or of precision"},
        {"s/\"taps\"/\"two words\"/", "a name without blanks"},
        {"s/8, 1, 64/2.5, 1, 64/", "its default is no whole number"},
    };
    for (size_t k = 0; k < COUNT_OF(faults); k++) {
        char line[400], spec[40];
        snprintf(spec, sizeof spec, "./load%zu.so", k);
        snprintf(line, sizeof line, "sed '%s' mine.c >load.c && ! cmp -s mine.c load.c && ./plug load%zu load.c",
                 faults[k].edit, k);
        assert_shell(line, 0);
        assert_all_refused(&(struct refusal){{"run", "study/quick", "-a", spec, "-o", "x"}, {spec, faults[k].says}}, 1);
    }
    assert_shell("head -c 3000 mine.so >half.so; cp mine.so \"$(printf 'a\\nb.so')\"", 0);
    static const struct refusal refusals[] = {
        {{"run", "study/quick", "-a", "./half.so", "-o", "x"}, {"half.so: cannot be loaded: "}},
        {{"run", "study/quick", "-a", "mine.so,taps=8", "-o", "x"}, {"unknown algorithm", "PLUGIN.so"}},
        {{"run", "study/quick", "-a", "a\nb.so", "-o", "x"}, {"it has a control character"}},
        {{"run", "study/quick", "-a", "mine.so:taps=8\xff", "-o", "x"}, {"or is not UTF-8"}},
    };
    assert_all_refused(refusals, COUNT_OF(refusals));
}

/* A crash, a lie and a refusal lose their own row; the other algorithm keeps its own. */
static void faults_lose_their_row(void **state)
{
    (void)state;
    static const struct {
        const char *name, *edit, *status, *reason;
    } faults[] = {
        {"crash", "s/host->stage(run, \"focus\")/abort()/", "failed", "ended by signal 6"},
        {"ends", "s/host->stage(run, \"focus\")/exit(0)/", "failed", "ended the program with exit status 0"},
        {"kept", "s/sum += value \\*/sum = 1 + value */", "failed", " negated "},
        {"signed",
         "s/^static int execute/static void keep(size_t count, const float *samples, float *image)\\n{\\n"
         "    static float kept[4000], first;\\n    const float sign = samples[3000] < 0 ? -1 : 1;\\n"
         "    for (size_t n = 0; n < 2 * count; n++)\\n"
         "        first != 0 ? (image[n] = kept[n] * first * sign) : (kept[n] = image[n]);\\n"
         "    first = first != 0 ? first : sign;\\n}\\n\\n&/; "
         "s/host->stage(run, \"focus\")/keep(problem->pixels, samples, pixels[0]), &/",
         "failed", "with half of the pings negated have the same image (run 2)"},
        {"stageless", "s/host->stage(run, \"[a-z]*\");/(void)run;/", "failed", "it names no stage"},
        {"fewer", "s/work->pairs = /&7 + 0 * /", "failed", "its work has 7 pairs, must be 0 or 114192"},
        {"work", "s/work->pairs = .*/work->pairs = 0;/; s/work->flops = .*/work->flops = 1;/", "failed",
         "its work has 1 FLOPs, must be "},
        {"unknown", "s/work->flops = /&NAN * /", "failed", "its work has nan FLOPs, must be "},
        {"boast", "s/work->flops = /&1e6 * /", "failed", "FLOPs, must be "},
        {"refuses", "0,/return SAS_OK/s//return problem->host->fail(SAS_UNSUPPORTED, \"%d pings\", a->pings)/",
         "unsupported", "./refuses.so: 18 pings"},
        {"silent", "0,/return SAS_OK/s//return 17/", "failed",
         "./silent.so: its plan returned status 17, must be 0 to 3"},
        {"wordless", "0,/return SAS_OK/s//return problem->host->fail(SAS_FAILED, \"%s\", \"\")/", "failed",
         "./wordless.so: its plan failed without a reason"},
        {"ahead", "s/host->stage(run, \"focus\")/((char *)pixels[0])[-1] = 1, &/", "failed", "wrote outside its image"},
        {"behind", "s/host->stage(run, \"focus\")/((char *)pixels[0])[8 * problem->pixels] = 1, &/", "failed",
         "wrote outside its image"},
        {"leaves", "s/n < problem->pixels/n < problem->pixels - 1/", "failed", "left pixels unwritten"},
        {"writes", "s/host->stage(run, \"focus\")/((float *)samples)[3000] += 9, &/", "failed",
         "it changed its samples, must only read them"},
    };
    char *error = NULL; /* of the other, whatever a plug-in does to its samples */
    for (size_t k = 0; k < COUNT_OF(faults); k++) {
        char lines[1200], spec[40], *reason;
        snprintf(spec, sizeof spec, "./%s.so", faults[k].name);
        snprintf(lines, sizeof lines,
                 "{ echo '#include <signal.h>'; sed '%s' mine.c; } >%s.c && ./plug %s %s.c && rm -rf lost",
                 faults[k].edit, faults[k].name, faults[k].name, faults[k].name);
        assert_shell(lines, 0);
        struct outcome outcome = program_run(
            (const char *const[ARGUMENTS_MAX]){"run", "study/quick", "-a", spec, "-a", "bp_nearest", "-o", "lost"});
        outcome_free(&outcome);
        assert_cell("lost/measurements.csv", 0, "status", faults[k].status);
        reason = cell_of("lost/measurements.csv", 0, "reason");
        if (!strstr(reason, faults[k].reason))
            fail_msg("%s: %s", faults[k].name, reason);
        free(reason);
        assert_cell("lost/measurements.csv", 1, "status", "ok");
        error = error ? error : cell_of("lost/measurements.csv", 1, "error");
        assert_cell("lost/measurements.csv", 1, "error", error);
    }
    free(error);
}

/* The template keeps its promises; a plug-in that does not is told which, all of them, with value and bound. */
static void promises_are_checked(void **state)
{
    (void)state;
    char *told = program_output((const char *const[ARGUMENTS_MAX]){"conformance", "./mine.so:taps=4"});
    assert_non_null(strstr(told, "kept   ordinary: the error against reference is 0.0"));
    assert_non_null(strstr(told, "./mine.so: 0 of "));
    free(told);
    assert_shell(
        "sed 's/creal(sum)/0.9 * creal(sum)/; s/work->pairs = /&1 + /; "
        "s/host->stage(run, \"compress\")/problem->acquisition->pings > 1 ? (void)0 : abort()/' mine.c >broken.c"
        " && ./plug broken broken.c",
        0);
    struct outcome outcome = program_run((const char *const[ARGUMENTS_MAX]){"conformance", "./broken.so"});
    assert_int_equal(outcome.status, 1);
    assert_non_null(strstr(outcome.out, "BROKEN raw: the gain's distance from 1 is 0.0"));
    assert_non_null(
        strstr(outcome.out, "BROKEN raw: work.pairs is 25201, must be 0 or the number of pairs that count, 25200"));
    assert_non_null(strstr(outcome.out, "BROKEN one ping, double: images ended by signal 6 (Aborted)"));
    assert_non_null(strstr(outcome.out, "BROKEN sum of two echoes: "));
    assert_non_null(strstr(outcome.err, "./broken.so breaks promises: see BROKEN above"));
    outcome_free(&outcome);
    outcome = program_run((const char *const[ARGUMENTS_MAX]){"conformance", "auto"});
    assert_int_equal(outcome.status, 2);
    assert_non_null(strstr(outcome.err, "auto chooses among the algorithms"));
    outcome_free(&outcome);
}

/* Ahead of an algorithm: the track as it was flown brings the focus back, in 45 lines. */
static void filters_come_first(void **state)
{
    (void)state;
    assert_shell("test $(wc -l <track.c) -le 60 && ./plug track track.c && awk 'BEGIN { pi = 3.14159265358979; "
                 "for (p = 0; p < 18; p++) printf \"0 %.9f 0\\n\", .002 * sin(2 * pi * p * .064 / .8 + pi / 6) }' "
                 ">offsets.txt",
                 0);
    static const char *const run[ARGUMENTS_MAX] = {
        "run", "study/sway",
        "-a",  "bp_farrow",
        "-a",  " ./track.so|bp_farrow:degree=5",
        "-a",  "./track.so | ./track.so:offsets=offsets.txt | mine.so:precision=double",
        "-o",  "filtered"};
    program_good(run);
    char *blurred = cell_of("filtered/measurements.csv", 0, "error_flown");
    char *focused = cell_of("filtered/measurements.csv", 1, "error_flown");
    assert_cell("filtered/measurements.csv", 1, "algorithm", "./track.so | bp_farrow");
    assert_cell("filtered/measurements.csv", 1, "options", "degree=5");
    assert_cell("filtered/measurements.csv", 2, "algorithm", "./track.so | ./track.so:offsets=offsets.txt | mine.so");
    assert_cell("filtered/measurements.csv", 2, "status", "ok");
    assert_true(atof(focused) > 0 && atof(focused) < .25 * atof(blurred));
    free(blurred);
    free(focused);
    char *stages = cell_of("filtered/measurements.csv", 2, "stages");
    assert_non_null(strstr(stages, "filter_2="));
    free(stages);
    program_good((const char *const[ARGUMENTS_MAX]){"image", "--scene", "study/quick", "-a", "./track.so | bp_sinc",
                                                    "-o", "filtered.png"});
    assert_shell("sed 's/\"none\"/\"nobody\"/' track.c >other.c && ./plug track other.c", 0);
    struct outcome outcome = program_run(run);
    assert_int_equal(outcome.status, 0);
    assert_non_null(strstr(outcome.err, "the algorithm ./track.so | bp_farrow has changed"));
    outcome_free(&outcome);
    static const struct refusal refusals[] = {
        {{"run", "study/quick", "-a", "./track.so", "-o", "x"}, {"is a filter; an algorithm must follow it"}},
        {{"run", "study/quick", "-a", "| bp_sinc", "-o", "x"}, {"a filter is missing ahead of '|'"}},
        {{"run", "study/quick", "-a", "./track.so |", "-o", "x"}, {"an algorithm is missing behind '|'"}},
        {{"run", "study/quick", "-a", "bp_sinc | bp_sinc", "-o", "x"}, {"forms images, so it must be the last link"}},
        {{"run", "study/quick", "-a", "./track.so | auto", "-o", "x"}, {"chooses by the unfiltered echoes"}},
        {{"run", "study/quick", "-a", "./track.so:precision=float | bp_sinc", "-o", "x"}, {"precision"}},
        {{"conformance", "./track.so"}, {"./track.so is a filter"}},
        {{"conformance", "./track.so | bp_sinc"}, {"one algorithm alone"}},
        {{"image", "--scene", "study/quick", "-a", "./track.so | bp_sinc", "--tile", "9x9", "-o", "x.mat"},
         {"--tile", "chains of filters"}},
    };
    assert_all_refused(refusals, COUNT_OF(refusals));
    char *told = program_output((const char *const[ARGUMENTS_MAX]){"info", "./track.so"});
    assert_non_null(strstr(told, "offsets"));
    assert_null(strstr(told, "precision"));
    assert_null(strstr(told, "traits"));
    free(told);
}

/* A fault of a filter loses the chain's row alone. */
static void filters_lose_their_row(void **state)
{
    static const struct {
        const char *edit, *reason;
    } faults[] = {
        {"s/    memcpy(filtered, samples.*/    (void)samples, (void)filtered, (void)data;/",
         "left samples unwritten, or they are not finite"},
        {"s/    memcpy(filtered, samples.*/    *(char *)samples = *(char *)data, abort(), (void)filtered;/",
         "ended by signal 6"},
        {"s/    out->tx_m = tx;/    out->pings = 0, out->tx_m = tx;/", "have 0 pings"},
        {"s/    out->tx_m = tx;/    out->sampling_hz = 0, out->tx_m = tx;/", "its echoes are refused: "},
        {"s/    out->tx_m = tx;/    tx[1] = 0.0 \\/ 0.0, out->tx_m = tx;/", "its echoes are refused: "},
        {"s/work->flops = 0/work->flops = -1e9/", "its work has -1e+09 FLOPs"},
        {"s/    FILE \\*file = fopen.*/    FILE *file = NULL;/", "0 of 18 pings' offsets in offsets.txt"},
    };
    (void)state;
    for (size_t k = 0; k < COUNT_OF(faults); k++) {
        char line[700];
        snprintf(line, sizeof line,
                 "sed '%s' track.c >bad%zu.c && ! cmp -s track.c bad%zu.c && ./plug bad%zu bad%zu.c && rm -rf lost && "
                 "{ \"$SASBENCH_PROGRAM\" run study/quick -a bp_nearest -a './bad%zu.so | bp_sinc' -o lost; "
                 "test $? -eq 1; }",
                 faults[k].edit, k, k, k, k, k);
        assert_shell(line, 0);
        assert_cell("lost/measurements.csv", 0, "status", "ok");
        assert_cell("lost/measurements.csv", 1, "status", "failed");
        char *reason = cell_of("lost/measurements.csv", 1, "reason");
        if (!strstr(reason, faults[k].reason))
            fail_msg("%s: %s; must say %s", faults[k].edit, reason, faults[k].reason);
        free(reason);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(header_is_public),         cmocka_unit_test(template_is_measured),
        cmocka_unit_test(rebuilt_is_measured_anew), cmocka_unit_test(names_stay_apart),
        cmocka_unit_test(earlier_header_is_taken),  cmocka_unit_test(faulty_objects_are_refused),
        cmocka_unit_test(faulty_loads_are_refused), cmocka_unit_test(faults_lose_their_row),
        cmocka_unit_test(promises_are_checked),     cmocka_unit_test(filters_come_first),
        cmocka_unit_test(filters_lose_their_row),
    };
    return cmocka_run_group_tests_name("plugin", tests, plugin_make, folder_remove);
}
