/* The command line: one table of commands, one of options. */
#include <ctype.h>
#include <fcntl.h>
#include <getopt.h>
#include <limits.h>
#include <omp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "command/task.h"
#include "common/isa.h"
#include "guests/external.h"
#include "text/number.h"
#include "text/shown_text.h"
#include "text/suggestion.h"
#include "ranks/ranks.h"
#include "run/supervisor.h"
#include "text/text_append.h"
#include "results/provenance.h"
#include "show/table.h"

enum { THREADS_MOST = 1024 };

struct command {
    const char *name, *brief, *arguments, *summary;
    const char *options; /* the letters of the options it takes */
    int names_least, names_most;
    enum status (*run)(const struct task *task);
    bool supervised; /* a crash ends one measurement, and the others go on */
    bool hidden;     /* not for the terminal */
    bool every;      /* without a SPEC it takes each algorithm by its defaults */
};

static const struct command commands[] = {
    {"run", "compare algorithms on scenes: error against run time",
     "([SCENE ...] | --echoes FILE.mat [--grid GRID]) [--algorithm SPEC ...] [-o DIR] [--all] [--flops] "
     "[--shard I/N] [--timeout S]",
     "compare algorithms on scenes, or on recorded echoes: the fastest for each of four errors", "oategLFXU", 0,
     INT_MAX, command_run, true, .every = true},
    {"report", "make one page of a results folder", "DIR", "make one page of a results folder: DIR/report.html", "", 1,
     1, command_report, false},
    {"list", "list the algorithms", "", "list the algorithms, with summary, reference and traits", "", 0, 0,
     command_list, false},
    {"info", "explain an algorithm's settings, or an echo or image file", "(NAME | PLUGIN.so | FILE.mat)",
     "print an algorithm's parameters, with default, bounds and sweep; or the content of an echo or image file, with a "
     "grid to begin with",
     "", 1, 1, command_info, false},
    {"check", "which algorithms can image a scene, and which conditions fail",
     "(SCENE | --echoes FILE.mat [--grid GRID]) [--algorithm SPEC ...] [--all]",
     "check, before any work, which algorithms can image a scene, and which conditions fail or are near their limit; "
     "exit status 1 where an algorithm is refused",
     "aegL", 0, 1, command_check, .every = true},
    {"plan", "the fastest algorithm and settings within an error",
     "(SCENE | --echoes FILE.mat [--grid GRID]) [--error E | --time S] [--memory BYTES] [--nodes N] "
     "[-o FILE.csv] [--all]",
     "choose the fastest settings within an error, or the most exact within a time; exit status 1 where nothing fits",
     "oegtETYDL", 0, 1, command_plan, false},
    {"scenes", "draw a random scene from a seed", "random --seed N [-o FILE.cfg]",
     "draw a scene from a seed, of any band, array and range", "oS", 1, 1, command_scenes, false},
    {"simulate", "write a scene's echoes", "SCENE -o FILE.mat", "write a scene's echoes", "ot", 1, 1, command_simulate,
     false},
    {"image", "form one image",
     "(--scene SCENE | --echoes FILE.mat [--grid GRID]) --algorithm SPEC -o (FILE.mat | FILE.png) [--range DB] "
     "[--verify] [(--tile NxM | --memory BYTES) [--shard I/N]] [--timeout S]",
     "form one image, as numbers or as a picture; with --tile or --memory it continues where it was ended",
     "oseagtRWIXYU", 0, 0, command_image, false},
    {"show", "draw an image file", "FILE.mat [-o FILE.png] [--range DB]",
     "draw an image file; the picture is beside it, or at -o", "oR", 1, 1, command_show, false},
    {"score", "measure an image that another program formed",
     "(IMAGE.mat | IMAGE.npy) (SCENE | --echoes FILE.mat [--grid GRID]) [--name NAME] [--seconds S] [-o DIR]",
     "measure an image that another program formed of a scene's echoes, and add its row to a results folder", "oegtNK",
     1, 2, command_score, false},
    {"filter", "remove the echoes from outside a target area",
     "(SCENE | --echoes FILE.mat) [--algorithm wk_polar:...] -o FILE.mat",
     "remove the echoes from outside a target area, and print each target's kept energy", "oeat", 0, 1, command_filter,
     false},
    {"compare", "how two results, two images or two programs differ",
     "(OLD NEW | IMAGE.mat IMAGE.mat [-o FILE.png] | --ab OLD_BINARY NEW_BINARY [SCENE ...] [--algorithm SPEC ...]) "
     "[--markdown FILE] [--json FILE]",
     "list what got worse between two results folders or CSV files; how two image files differ; or what is slower of "
     "two programs, run side by side",
     "oaBMJ", 2, INT_MAX, command_compare, false},
    {"measure", "", "", "the other end of `compare --ab`, which starts it", "", 0, 0, command_measure, false, true},
    {"baseline", "measure the quality and work that the tests compare with", "[-o FILE.csv]",
     "measure quality and work of the gate's scenes anew, into results/baseline.csv", "ot", 0, 0, command_baseline,
     false},
    {"merge", "join the results folders of shards", "DIR ... -o DIR",
     "join the results folders of shards; a folder for each kind of machine", "o", 1, INT_MAX, command_merge, false},
    {"reproduce", "the papers' tables and claims beside ours", "[ID ...] [-o DIR] [--quick | --docs | --shard I/N]",
     "measure the papers' tables, figures and claims again, beside the printed numbers", "otXQG", 0, INT_MAX,
     command_reproduce, true},
    {"sweep", "error against run time, each algorithm over its settings",
     "([SCENE ...] | --echoes FILE.mat [--grid GRID]) [--algorithm SPEC ...] [--precision float|double] [-o DIR] "
     "[--all] [--shard I/N] [--timeout S]",
     "measure error against run time, each algorithm over its settings", "oategPLXU", 0, INT_MAX, command_sweep, true,
     .every = true},
    {"phase", "phase errors of the two-dimensional spectra (LBF21)", "([SCENE] [-o DIR] | --at FILE.csv)",
     "compute phase errors of the two-dimensional spectra (LBF21 Figs 2-9)", "oA", 0, 1, command_phase, false},
    {"stability", "digits lost on extreme scenes in all rounding modes",
     "[SCENE ...] [--algorithm SPEC ...] [-o DIR] [--quick] [--shard I/N]",
     "image extreme scenes in all rounding modes: verdicts and digits lost, against results/stability.csv", "oaQX", 0,
     INT_MAX, command_stability, false},
    {"conformance", "test every promise of one algorithm, also of a plug-in", "SPEC [--timeout S]",
     "test every promise of one algorithm: image, bits, memory, work, settings; exit status 1 where one is broken", "U",
     1, 1, command_conformance, false},
    {"bench", "speed of the engines against the processor's peak", "[SPEC ...] [-o DIR]",
     "measure the speed of the engines, or of the SPECs, against the processor's peak and the scalar reference loop",
     "ot", 0, INT_MAX, command_bench, false},
};

#define IN_TASK(field) offsetof(struct task, field)
/* Options and their values: a value goes to the text of struct task at the offset, an option without one sets a flag
   there. */
static const struct named {
    int letter; /* a lower-case letter works by itself, too */
    const char *name, *value, *text;
    size_t offset; /* 0: not stored */
} options[] = {
    {'o', "output", "PATH", "file or folder of the result", IN_TASK(output)},
    {'s', "scene", "SCENE", "a path, or a name below scenes/ without .cfg", IN_TASK(scene)},
    {'e', "echoes", "FILE", "recorded echoes in MATLAB format", IN_TASK(echoes)},
    {'a', "algorithm", "SPEC", "NAME, PLUGIN.so or external:COMMAND, then :key=value,...; all take precision=double",
     0},
    {'g', "grid", "GRID", "xmin:xstep:xcount,rmin:rstep:rcount[,angle] (m, degrees)", IN_TASK(grid)},
    {'t', "threads", "N", "OpenMP threads, 1 to 1024", IN_TASK(threads)},
    {'R', "range", "DB", "range of a picture below its peak, 60 dB unless given", IN_TASK(range)},
    {'I', "tile", "NxM", "form so many pixels along x and r at a time", IN_TASK(tile)},
    {'U', "timeout", "S", "longest silence of an external program, 600 s unless given", IN_TASK(timeout)},
    {'X', "shard", "I/N", "take the I-th of N parts of the work", IN_TASK(shard)},
    {'P', "precision", "WHICH", "float or double; both unless given, or stated by a SPEC", IN_TASK(precision)},
    {'E', "error", "E", "of the image after one gain (L2), 1e-3 unless given", IN_TASK(error)},
    {'T', "time", "S", "in place of --error: the least error within a run time", IN_TASK(time)},
    {'Y', "memory", "BYTES", "most memory of the image's process, as 2G; `plan`: 4G", IN_TASK(memory)},
    {'D', "nodes", "N", "the time on so many machines such as this one", IN_TASK(nodes)},
    {'S', "seed", "N", "a whole number from 0 to 1e15", IN_TASK(seed)},
    {'N', "name", "NAME", "of the image's program; the file's name unless given", IN_TASK(name)},
    {'K', "seconds", "S", "run time of that program; the row marks it as stated", IN_TASK(seconds)},
    {'A', "at", "FILE.csv", "points: columns d, r, F, f, fc, v, c", IN_TASK(at)},
    {'B', "ab", NULL, "run two programs side by side and compare their times", IN_TASK(ab)},
    {'Q', "quick", NULL, "less: one scene of each family (`stability`), or no times (`reproduce`)", IN_TASK(quick)},
    {'L', "all", NULL, "print every line, not the answer alone", IN_TASK(all)},
    {'F', "flops", NULL, "count FLOPs by the papers' formulas as well", IN_TASK(flops)},
    {'W', "verify", NULL, "measure the image's error on some of its pixels", IN_TASK(verify)},
    {'G', "docs", NULL, "write one page a paper into docs/papers", IN_TASK(docs)},
    {'M', "markdown", "FILE", "the findings as a comment for a CI", IN_TASK(markdown)},
    {'J', "json", "FILE", "the findings for trackers of benchmarks", IN_TASK(json)},
    {'h', "help", NULL, NULL, 0},
};
enum { OPTIONS = sizeof options / sizeof *options };
static const char exit_text[] = "\nExit status: 0 done, 1 a run failed or got worse, 2 bad usage or bad input.\n";

/* One screen; each command's help has its options. */
static void help(void)
{
    printf("sasbench compares imaging algorithms for multi-receiver synthetic aperture sonar\non identical echoes.\n\n"
           "Usage: sasbench COMMAND [ARGUMENTS]; begin with: ./sasbench run\n\n");
    for (size_t k = 0; k < sizeof commands / sizeof *commands; k++)
        if (!commands[k].hidden)
            printf("  %-11s %s\n", commands[k].name, commands[k].brief);
    printf("  %-11s %s\n", "test", "verify this build (a command of the script ./sasbench)");
    printf("\nhelp COMMAND     its arguments and options\nhelp columns     the columns of a run's table\n"
           "--version        version, commit, compiler, libraries, instruction set\n");
    fputs(exit_text, stdout);
}

static void help_command(const struct command *command)
{
    char text[300];
    snprintf(text, sizeof text, "Usage: sasbench %s%s%s", command->name, *command->arguments ? " " : "",
             command->arguments);
    table_text(stdout, 0, text);
    snprintf(text, sizeof text, "%s.", command->summary);
    putchar('\n');
    table_text(stdout, 0, text);
    for (int k = 0, shown = 0; k < OPTIONS; k++) {
        const struct named *o = &options[k];
        char brief[8] = "";
        if (!strchr(command->options, o->letter))
            continue;
        if (islower(o->letter))
            snprintf(brief, sizeof brief, "-%c, ", o->letter);
        snprintf(text, sizeof text, "--%s%s%s", o->name, o->value ? " " : "", o->value ? o->value : "");
        printf("%s  %-4s%-17s %s\n", shown++ ? "" : "\nOptions:\n", brief, text, o->text);
    }
    fputs(exit_text, stdout);
}

/* `text` NULL: OpenMP's default, from its own variable or the machine's processors. */
static enum status threads_parse(const char *text)
{
    const char *variable = getenv("OMP_NUM_THREADS");
    long long threads = omp_get_max_threads();
    const char *end = text ? whole_read(text, 1, THREADS_MOST, &threads) : "";
    if (!end || *end)
        return status_set(STATUS_INVALID, "--threads is '%s', must be a whole number from 1 to %d", text, THREADS_MOST);
    if (threads > THREADS_MOST && variable)
        return status_set(STATUS_INVALID, "OMP_NUM_THREADS is '%s', must be a whole number from 1 to %d", variable,
                          THREADS_MOST);
    omp_set_num_threads(threads < THREADS_MOST ? (int)threads : THREADS_MOST);
    return STATUS_OK;
}

/* Of external programs. */
static enum status timeout_parse(const char *text)
{
    double seconds = 0;
    const char *end = text ? number_read(text, &seconds) : NULL;
    if (text && (!end || *end || !(seconds > 0 && seconds <= 1e6)))
        return status_set(STATUS_INVALID, "--timeout is '%s', must be a number of seconds above 0, at most 1e6", text);
    if (text)
        external_timeout(seconds);
    return STATUS_OK;
}

/* Suggest the option that an unknown one meant, or report that a value stands without its option. */
static void option_meant(const struct command *command, int letter, const char *option, char meant[SUGGESTION_TEXT])
{
    struct suggestion suggestion = suggestion_begin(option);
    const char *bare = letter == 's' ? "SCENE" : letter == 'a' ? "SPEC" : "\n";
    suggestion.before = "--";
    for (const struct named *o = options; o < options + OPTIONS; o++)
        if (strchr(command->options, o->letter))
            suggestion_offer(&suggestion, o->name);
    suggestion_text(&suggestion, meant);
    if (strstr(command->arguments, bare))
        snprintf(meant, SUGGESTION_TEXT, "; %s stands without it: sasbench %s %.150s;", bare, command->name,
                 command->arguments);
}

static enum status option_refuse(const struct command *command, const char *option, const char *fault,
                                 const char *meant)
{
    char accepted[160] = "";
    for (const struct named *o = options; o < options + OPTIONS; o++)
        if (strchr(command->options, o->letter))
            text_append(accepted, sizeof accepted, "%s--%s", *accepted ? ", " : "", o->name);
    return status_set(STATUS_INVALID, "%s: option '%s' %s%s accepted: %s", command->name, option, fault, meant,
                      *accepted ? accepted : "none");
}

static enum status spec_add(struct task *task, const char *text)
{
    struct spec *specs = realloc(task->specs, ((size_t)task->spec_count + 1) * sizeof *specs);
    if (!specs)
        return status_set(STATUS_FAILED, "no memory for --algorithm %s", text);
    task->specs = specs;
    enum status status = spec_asked(text, &specs[task->spec_count]);
    task->spec_count += status == STATUS_OK;
    return status;
}

/* The option that getopt_long read last, as it is written: "-o", "--output". */
static void option_given(char *const *argv, int letter, char *text, size_t size)
{
    const char *word = argv[optind - 1];
    if (optarg && optarg == word) /* its value is an argument of its own */
        word = argv[optind - 2];
    bool is_long = strncmp(word, "--", 2) == 0 && (letter != '?' || !optopt);
    for (const struct named *o = options; o < options + OPTIONS && letter == '?'; o++) /* one without a value has one */
        is_long |= o->letter == optopt && strncmp(word, "--", 2) == 0;
    if (is_long)
        snprintf(text, size, "%.*s", (int)strcspn(word, "="), word);
    else
        snprintf(text, size, "-%c", letter == '?' ? optopt : letter);
}

static enum status empty_refuse(const struct command *command, const char *what)
{
    return status_set(STATUS_INVALID, "%s: %s is '', must be a path or a name", command->name, what);
}

/* Arguments after the command's name. */
static enum status parse(const struct command *command, int argc, char **argv, struct task *task, bool *helped)
{
    struct option known[OPTIONS + 1] = {{.name = NULL}};
    for (int k = 0; k < OPTIONS; k++)
        known[k] = (struct option){options[k].name, options[k].value ? required_argument : no_argument, NULL,
                                   options[k].letter};
    enum status status = STATUS_OK;
    opterr = 0;
    for (int letter; status == STATUS_OK && (letter = getopt_long(argc, argv, ":o:s:e:a:g:t:h", known, NULL)) != -1;) {
        char given[80], meant[SUGGESTION_TEXT];
        if (letter == 'h') {
            *helped = true;
            return STATUS_OK;
        }
        if (letter == ':')
            return option_refuse(command, argv[optind - 1], "needs a value", ";");
        option_given(argv, letter, given, sizeof given);
        if (letter == '?' || !strchr(command->options, letter)) {
            option_meant(command, letter, given, meant);
            return option_refuse(command, given, "is not one of this command", meant);
        }
        if (letter == 'a') {
            status = spec_add(task, optarg);
            continue;
        }
        const struct named *option = options;
        while (option->letter != letter)
            option++;
        void *field = (char *)task + option->offset;
        if (!option->value) {
            *(bool *)field = true;
            continue;
        }
        if (*(const char **)field)
            return option_refuse(command, given, "is given twice", ";");
        if (!*optarg && !strchr("gt", letter)) /* whose messages list what they accept */
            return empty_refuse(command, given);
        *(const char **)field = optarg;
    }
    task->names = (const char *const *)argv + optind;
    task->name_count = argc - optind;
    for (int k = 0; k < task->name_count && status == STATUS_OK; k++)
        if (!*task->names[k])
            status = empty_refuse(command, "an argument");
    const bool every = command->every && task->spec_count == 0;
    for (int k = 0; every && algorithms[k] && status == STATUS_OK; k++)
        status = spec_add(task, algorithms[k]->name);
    if (status == STATUS_OK)
        status = threads_parse(task->threads);
    if (status == STATUS_OK)
        status = timeout_parse(task->timeout);
    if (status == STATUS_OK && task->name_count < command->names_least)
        return status_set(STATUS_INVALID, "%s: an argument is missing: sasbench %s %s", command->name, command->name,
                          command->arguments);
    if (status == STATUS_OK && task->name_count > command->names_most)
        return status_set(STATUS_INVALID, "%s: '%s' is one argument too many: sasbench %s %s", command->name,
                          task->names[command->names_most], command->name, command->arguments);
    return status;
}

/* Is it an option, whose command is missing ahead of it? */
static bool is_option(const char *name)
{
    const char *bare = name + strspn(name, "-");
    const size_t length = strcspn(bare, "=");
    bool is = false;
    for (const struct named *o = options; o < options + OPTIONS && *name == '-'; o++)
        is |= name[1] == '-' ? strncmp(bare, o->name, length) == 0 && !o->name[length] : *bare == o->letter && !bare[1];
    return is;
}

static enum status command_find(const char *name, const struct command **found)
{
    char names[300] = "", meant[SUGGESTION_TEXT];
    struct suggestion suggestion = suggestion_begin(name);
    for (size_t k = 0; k < sizeof commands / sizeof *commands; k++) {
        if (strcmp(commands[k].name, name) == 0) {
            *found = &commands[k];
            return STATUS_OK;
        }
        if (commands[k].hidden)
            continue;
        text_append(names, sizeof names, "%s, ", commands[k].name);
        suggestion_offer(&suggestion, commands[k].name);
    }
    suggestion_offer(&suggestion, "--help");
    suggestion_offer(&suggestion, "--version");
    if (is_option(name))
        snprintf(meant, sizeof meant, " but an option, which stands behind one: sasbench COMMAND %.80s;", name);
    else
        suggestion_text(&suggestion, meant);
    if (strcmp(name, "test") == 0)
        return status_set(STATUS_INVALID,
                          "'test' is a command of the script ./sasbench: ./sasbench test [--all | NAME ...]");
    return status_set(STATUS_INVALID, "'%s' is not a command%s accepted: %stest, --help, --version", name, meant,
                      names);
}

/* Where a standard stream is closed, a results file would take its number, and what is printed would land in it. */
static void streams_open(void)
{
    int descriptor;
    do
        descriptor = open("/dev/null", O_RDWR);
    while (descriptor >= 0 && descriptor <= STDERR_FILENO);
    if (descriptor >= 0)
        close(descriptor);
}

/* What a report of a fault has to name. */
static void version(void)
{
    struct provenance provenance;
    provenance_fill(&provenance, omp_get_max_threads());
    printf("sasbench %s, commit %s\ncompiler: %s (%s)\nlibraries: %s\ninstruction set: %s\n", SASBENCH_VERSION,
           provenance.commit, provenance.compiler, provenance.flags, provenance.libraries, provenance.isa);
}

/* Join the ranks of mpirun, where they share this command's work. */
static enum status ranks_share(const struct command *command, const struct task *task)
{
    if (command->run != command_run && command->run != command_sweep && !task->tile)
        return status_set(STATUS_INVALID,
                          "%s: one of %d ranks, which do not share its work; accepted: run, sweep, image --tile, or "
                          "--shard",
                          command->name, ranks_started());
    return ranks_begin();
}

int main(int argc, char **argv)
{
    const char *name = argc < 2 ? "" : argv[1];
    const struct command *command = NULL;
    struct task task = {0};
    bool helped = strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || strcmp(name, "help") == 0;
    streams_open();
    signal(SIGXFSZ, SIG_IGN); /* a file beyond the limit is an error where it is written */
    const bool versioned = strcmp(name, "--version") == 0;
    enum status status = isa_check();
    const bool columns = strcmp(name, "help") == 0 && argc > 2 && strcmp(argv[2], "columns") == 0;
    if (status == STATUS_OK && strcmp(name, "help") == 0 && argc > 2 && !columns)
        status = command_find(argv[2], &command);
    else if (status == STATUS_OK && !helped && !versioned)
        status = command_find(name, &command);
    if (status == STATUS_OK && command && !helped)
        status = parse(command, argc - 1, argv + 1, &task, &helped);
    if (status == STATUS_OK && versioned)
        version();
    else if (status == STATUS_OK && columns)
        table_columns(stdout);
    else if (status == STATUS_OK && helped && command)
        help_command(command);
    else if (status == STATUS_OK && helped)
        help();
    else if (status == STATUS_OK) {
        if (ranks_started() > 1 && !task.shard)
            status = ranks_share(command, &task);
        if (status == STATUS_OK && (command->supervised || ranks_count() > 1))
            supervisor_begin();
        if (status == STATUS_OK)
            status = command->run(&task);
    }
    if (status == STATUS_OK && (fflush(stdout) != 0 || ferror(stdout)))
        status = status_set(STATUS_FAILED, "standard output cannot be written");
    for (int k = 0; k < task.spec_count; k++)
        spec_free(&task.specs[k]);
    free(task.specs);
    if (status != STATUS_OK && (task.shard || ranks_refuse()))
        shown_note(status_message());
    const int code = status == STATUS_OK ? 0 : status == STATUS_FAILED ? 1 : 2;
    if (ranks_count() == 1)
        return code;
    fflush(NULL);
    _exit(code); /* MPI is the parent's to end */
}
