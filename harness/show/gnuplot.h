/* gnuplot as a process that is watched. */
#ifndef SASBENCH_SHOW_GNUPLOT_H
#define SASBENCH_SHOW_GNUPLOT_H

#include <stdbool.h>
#include <stddef.h>

#include "status.h"

/* Run gnuplot on the file `script`; what it prints goes to the file `log`. *exit_status is as waitpid gives it. Errors:
   STATUS_FAILED where gnuplot is missing, or takes longer than plot_seconds_most (plot.h) and is ended. */
enum status gnuplot_run(const char *script, const char *log, int *exit_status);
/* Whether it was ended so: it would hang on every further picture. */
bool gnuplot_hung(void);
/* The first line of `log` that says something, for a message. */
void gnuplot_complaint(const char *log, char *text, size_t size);

#endif
