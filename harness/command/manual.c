/* The manual page sasbench(1), of the tables that --help prints. */
#include <ctype.h>
#include <stdio.h>

#include "command/commands.h"

/* Text as roff takes it: no macro at the beginning of a line, no hyphen for a minus. */
static void put(const char *text)
{
    if (*text == '.' || *text == '\'')
        fputs("\\&", stdout);
    for (; *text; text++)
        if (*text == '\\')
            fputs("\\e", stdout);
        else if (*text == '-')
            fputs("\\-", stdout);
        else
            putchar(*text);
}

static void put_option(const struct named *option)
{
    fputs(".TP\n.B ", stdout);
    if (islower(option->letter))
        printf("\\-%c, ", option->letter);
    fputs("\\-\\-", stdout);
    put(option->name);
    if (option->value)
        printf(" \\fI%s\\fR", option->value);
    putchar('\n');
    put(option->text);
    fputs(".\n", stdout);
}

static void put_command(const struct command *command)
{
    printf(".SS ");
    put(command->name);
    printf("\n.B sasbench %s\n", command->name);
    if (*command->arguments) {
        put(command->arguments);
        putchar('\n');
    }
    puts(".PP");
    put(command->summary);
    puts(".");
    for (const struct named *o = options; o->name; o++)
        if (command_takes(command, o))
            put_option(o);
    printf(".PP\nExample:\n.PP\n.RS 4\nsasbench ");
    put(command->example);
    printf("\n.RE\n");
}

void command_manual(void)
{
    printf(
        ".TH SASBENCH 1 \"\" \"sasbench %s\"\n.SH NAME\nsasbench \\- compare imaging algorithms for synthetic aperture "
        "sonar\n.SH SYNOPSIS\n.B sasbench\n.I COMMAND\n.RI [ ARGUMENTS ]\n.SH DESCRIPTION\n"
        "Compares imaging algorithms for multi-receiver synthetic aperture sonar on identical echoes, without the "
        "stop-and-hop\nassumption: error against run time. Begin with\n.BR \"sasbench run\" .\n"
        "Results are written below the current folder.\n.SH COMMANDS\n",
        SASBENCH_VERSION);
    for (const struct command *c = commands; c->name; c++)
        if (!c->hidden)
            put_command(c);
    printf(".SH EXIT STATUS\n");
    put(commands_exit + sizeof "Exit status: " - 1);
    printf(
        "\n.SH ENVIRONMENT\n.TP\n.B OMP_NUM_THREADS\nThreads, where \\-\\-threads is not given.\n.TP\n.B SASBENCH_ISA\n"
        "Instruction set of the inner loops: baseline, v3 or v4.\n.SH SEE ALSO\n.BR gnuplot (1),\n.BR mpirun (1)\n");
}
