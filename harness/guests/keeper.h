/* A program of a stranger and all that it starts. A process of ours, the keeper, waits for them: it ends them, and
   removes their folder, when we ask for it or end ourselves, whatever ends us. */
#ifndef SASBENCH_GUESTS_KEEPER_H
#define SASBENCH_GUESTS_KEEPER_H

#include <stdbool.h>
#include <sys/types.h>

#include "contract/status.h"

/* Two of them may live at once; only one thread at a time starts and ends them. */
struct keeper {
    pid_t pid;    /* 0: none */
    int to, from; /* write to the program's descriptor 3, read from its descriptor 4; writing never waits */
    int unread;   /* the other end of `to`: without it writing would raise SIGPIPE */
    int life;     /* while it is open they live */
    int end;      /* readable once the program has ended */
    struct keeper *next;
};

/* In a child, before what may crash: signals end it, in place of running a handler of ours or of a sanitizer. */
void signals_reset(void);

/* Start the program in the current folder, its output to FOLDER/log, which exists, with so many threads for libraries
   that ask OMP_NUM_THREADS and its like. A program that cannot be run has ended. Errors: STATUS_FAILED. */
enum status keeper_start(char *const *words, const char *folder, int threads, struct keeper *keeper);
/* Wait so long at most for the program's end: "ended by signal 9 (Killed)". False: it goes on. Asked once. */
bool keeper_ended(const struct keeper *keeper, double seconds, char *how, size_t size);
/* End them all, and remove the folder. */
void keeper_stop(struct keeper *keeper);

/* s of processor time that all programs kept now used so far, with all that they started. */
double keepers_busy_s(void);

#endif
