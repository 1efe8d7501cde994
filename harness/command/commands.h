/* The command line: one table of commands, one of options. */
#ifndef SASBENCH_COMMAND_COMMANDS_H
#define SASBENCH_COMMAND_COMMANDS_H

#include <stddef.h>

#include "command/task.h"

struct command {
    const char *name, *brief, *arguments, *summary;
    const char *options; /* the letters of the options it takes */
    int names_least, names_most;
    enum status (*run)(const struct task *task);
    bool supervised; /* a crash ends one measurement, and the others go on */
    bool hidden;     /* not for the terminal */
    bool every;      /* without a SPEC it takes each algorithm by its defaults */
    const char *example;
};
/* Ends with a NULL name. */
extern const struct command commands[];

/* Options and their values: a value goes to the text of struct task at the offset, an option without one sets a flag
   there. */
struct named {
    int letter; /* a lower-case letter works by itself, too */
    const char *name, *value, *text;
    size_t offset; /* 0: not stored */
};
/* Ends with a NULL name; at most so many. */
enum { OPTIONS_MOST = 40 };
extern const struct named options[];

extern const char commands_exit[]; /* what the exit status means */

/* Print, a line each, what may stand for the last of the words behind the program's name. */
void command_complete(int count, char *const *words);
/* Print sasbench(1). */
void command_manual(void);

/* Does the command take the option? */
bool command_takes(const struct command *command, const struct named *option);

#endif
