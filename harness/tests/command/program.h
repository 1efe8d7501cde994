/* The program run as a process in the test's folder: what it prints, leaves on disk and exits with. */
#ifndef SASBENCH_TEST_PROGRAM_H
#define SASBENCH_TEST_PROGRAM_H

#include <stdio.h>
#include <sys/types.h>

#include "tests/support.h"

#define COUNT_OF(array) (sizeof array / sizeof *array)

enum { ARGUMENTS_MAX = 16, SAYS_MAX = 4 };

/* Before the tests: the folder with the inputs that they share, and the program's path, from the environment variable
   SASBENCH_PROGRAM. folder_remove ends it. */
int inputs_make(void **state);
extern const char scene_text[]; /* a small scene: scene.cfg */
extern char long_name[5000];    /* longer than a path may be */

const char *path_in(const char *name); /* in the folder; valid until the next call */
void bytes_write(const char *name, const void *bytes, size_t size);
void text_write(const char *name, const char *text);
char *bytes_read(const char *name, size_t *size); /* with a zero byte behind; the caller frees it */

/* Start the program with these words after its name; NULL ends them where there are less than ARGUMENTS_MAX. It leads a
   process group of its own. */
pid_t program_start(const char *const *arguments, FILE *out, FILE *err);
struct outcome {
    int status; /* of exit, or -1 after a signal */
    char *out, *err;
};
struct outcome program_run(const char *const *arguments);
void outcome_free(struct outcome *outcome);
/* Runs to a good end without a word on standard error; returns what it printed, for the caller to free. */
char *program_output(const char *const *arguments);
void program_good(const char *const *arguments);

/* A command line, and texts that its refusal names. */
struct refusal {
    const char *arguments[ARGUMENTS_MAX], *says[SAYS_MAX];
};
/* An image of an echo file, which should not come about. */
#define ECHOES(file)                                                                                                   \
    {                                                                                                                  \
        "image", "--grid", "0:0.02:5,20:0.04:5", "-a", "bp_nearest", "-o", "x.mat", "--echoes", file                   \
    }
/* Whether the program exits with status 2 and one line of error that holds every text of `says`, prints nothing else,
   and writes nothing; prints what is wrong otherwise. */
bool is_refused(const char *const *arguments, const char *const *says);
void assert_all_refused(const struct refusal *refusals, size_t count);

#endif
