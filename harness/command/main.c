/* The command line. */
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

#include "command/commands.h"
#include "common/isa.h"
#include "contract/algorithm.h"
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

/* One screen; each command's help has its options. */
static void help(void)
{
    printf("sasbench compares imaging algorithms for multi-receiver synthetic aperture sonar\non identical echoes.\n\n"
           "Usage: sasbench COMMAND [ARGUMENTS]; begin with: %s run\n\n",
           program_called());
    for (const struct command *c = commands; c->name; c++)
        if (!c->hidden)
            printf("  %-11s %s\n", c->name, c->brief);
    if (*program_called() == '.')
        printf("  %-11s %s\n", "test", "verify this build (a command of the script ./sasbench)");
    printf("\nhelp COMMAND     its arguments and options\nhelp columns     the columns of a run's table\n"
           "--version        version, commit, compiler, libraries, instruction set\n");
    printf("\n%s\n", commands_exit);
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
    int shown = 0;
    for (const struct named *o = options; o->name; o++) {
        char brief[8] = "";
        if (!command_takes(command, o))
            continue;
        if (islower(o->letter))
            snprintf(brief, sizeof brief, "-%c, ", o->letter);
        snprintf(text, sizeof text, "--%s%s%s", o->name, o->value ? " " : "", o->value ? o->value : "");
        printf("%s  %-4s%-17s %s\n", shown++ ? "" : "\nOptions:\n", brief, text, o->text);
    }
    if (command->example)
        printf("\nExample: %s %s\n", program_called(), command->example);
    printf("\n%s\n", commands_exit);
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
    for (const struct named *o = options; o->name; o++)
        if (command_takes(command, o))
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
    for (const struct named *o = options; o->name; o++)
        if (command_takes(command, o))
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
    for (const struct named *o = options; o->name && letter == '?'; o++) /* one without a value has one */
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
    struct option known[OPTIONS_MOST + 1] = {{.name = NULL}};
    for (int k = 0; options[k].name; k++)
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
    for (const struct named *o = options; o->name && *name == '-'; o++)
        is |= name[1] == '-' ? strncmp(bare, o->name, length) == 0 && !o->name[length] : *bare == o->letter && !bare[1];
    return is;
}

static enum status command_find(const char *name, const struct command **found)
{
    char names[300] = "", meant[SUGGESTION_TEXT];
    struct suggestion suggestion = suggestion_begin(name);
    for (const struct command *c = commands; c->name; c++) {
        if (strcmp(c->name, name) == 0) {
            *found = c;
            return STATUS_OK;
        }
        if (c->hidden)
            continue;
        text_append(names, sizeof names, "%s, ", c->name);
        suggestion_offer(&suggestion, c->name);
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
    if (algorithm_find(name))
        return status_set(STATUS_INVALID, "'%s' is an algorithm, not a command: sasbench info %s", name, name);
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
    const bool tiles = command->run == command_image && image_is_tiled(task);
    if (command->run != command_run && command->run != command_sweep && !tiles)
        return status_set(STATUS_INVALID,
                          "%s: one of %d ranks, which do not share its work; accepted: run, sweep, image --tile or "
                          "--memory, --shard",
                          command->name, ranks_started());
    return ranks_begin();
}

/* Threads sleep while they wait for each other: where other work holds a core, spinning ones take up to a hundred times
   longer, and every time that is reported would be theirs. OpenMP reads it before main begins. */
static void threads_sleep(char **argv)
{
    char path[PATH_MAX]; /* and not /proc/self/exe, or the process would be called "exe" */
    const ssize_t length = readlink("/proc/self/exe", path, sizeof path - 1);
    path[length > 0 ? length : 0] = '\0';
    if (length > 0 && !getenv("OMP_WAIT_POLICY") && setenv("OMP_WAIT_POLICY", "passive", 0) == 0)
        execv(path, argv);
}

/* Helps that no command has; false where it is none of them. */
static bool helped_otherwise(int argc, char **argv)
{
    const char *name = argc > 1 ? argv[1] : "", *topic = argc > 2 ? argv[2] : "";
    if (strcmp(name, "complete") == 0)
        command_complete(argc - 2, argv + 2);
    else if (strcmp(name, "--version") == 0)
        version();
    else if (strcmp(name, "help") == 0 && strcmp(topic, "columns") == 0)
        table_columns(stdout);
    else if (strcmp(name, "help") == 0 && strcmp(topic, "manual") == 0)
        command_manual();
    else
        return false;
    return true;
}

int main(int argc, char **argv)
{
    const char *name = argc < 2 ? "" : argv[1];
    const struct command *command = NULL;
    struct task task = {0};
    bool helped = strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || strcmp(name, "help") == 0;
    threads_sleep(argv);
    streams_open();
    signal(SIGXFSZ, SIG_IGN); /* a file beyond the limit is an error where it is written */
    enum status status = isa_check();
    const bool otherwise = status == STATUS_OK && helped_otherwise(argc, argv);
    if (status == STATUS_OK && !otherwise && strcmp(name, "help") == 0 && argc > 2)
        status = command_find(argv[2], &command);
    else if (status == STATUS_OK && !otherwise && !helped)
        status = command_find(name, &command);
    if (status == STATUS_OK && command && !helped)
        status = parse(command, argc - 1, argv + 1, &task, &helped);
    if (status == STATUS_OK && helped && command)
        help_command(command);
    else if (status == STATUS_OK && helped && !otherwise)
        help();
    else if (status == STATUS_OK && !otherwise) {
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
