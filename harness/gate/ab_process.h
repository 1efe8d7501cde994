/* A program that runs beside this one and answers its questions line by line: one side of `compare --ab`. */
#ifndef SASBENCH_GATE_AB_PROCESS_H
#define SASBENCH_GATE_AB_PROCESS_H

#include <stdio.h>
#include <sys/types.h>

#include "contract/status.h"

struct ab_process {
    const char *role, *path; /* of messages: "OLD"; the program. Borrowed */
    pid_t pid;               /* 0: none */
    int socket;              /* to its standard input and output; its standard error is dropped */
    double patience_s;       /* it answers within this or has failed */
    FILE *answers;           /* reads from the socket */
};

/* Start `path measure` on the `turn`-th of the processors that we may use, round and round, and read its greeting.
   Errors: STATUS_INVALID naming role, path and the fault (cannot be run, wrong greeting, ends, no answer); nothing is
   then left to stop. */
enum status ab_process_start(const char *role, const char *path, int turn, double patience_s,
                             struct ab_process *process);
/* Send a line (without its end), receive one. Errors: as above; the process is still to be stopped. */
enum status ab_process_ask(struct ab_process *process, const char *question, char *answer, size_t size);
/* End it and all that it started; does nothing to a zeroed struct. */
void ab_process_stop(struct ab_process *process);

#endif
