/* gnuplot as processes that are watched. */
#ifndef SASBENCH_SHOW_GNUPLOT_H
#define SASBENCH_SHOW_GNUPLOT_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

#include "contract/status.h"

/* One that runs, from gnuplot_start until gnuplot_poll has found its end or a fault. */
struct gnuplot {
    pid_t process;
    double begin;    /* seconds_now() */
    int exit_status; /* once it has ended, as waitpid gives it */
};

/* Let gnuplot run the file `script`. `picture` and `log` are descriptors: what it writes to /dev/stdout goes to the
   one, what it prints to the other. It ends with this program. Errors: STATUS_FAILED. */
enum status gnuplot_start(const char *script, int picture, int log, struct gnuplot *gnuplot);
/* Whether it has ended, without waiting for it. Errors: STATUS_FAILED where it takes longer than plot_seconds_most
   (plot.h) and is ended. */
enum status gnuplot_poll(struct gnuplot *gnuplot, bool *ended);
/* What a loop around gnuplot_poll sleeps. */
void gnuplot_pause(void);
/* Whether it was ended so: it would hang on every further picture. */
bool gnuplot_hung(void);
/* The first line of `log` that says something, for a message. */
void gnuplot_complaint(int log, char *text, size_t size);

#endif
