/* gnuplot as a process (gnuplot.h). */
#define _GNU_SOURCE /* _Fork */
#include "show/gnuplot.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "contract/algorithm.h"
#include "show/plot.h"

double plot_seconds_most = 60;
static bool hung;

bool gnuplot_hung(void)
{
    return hung;
}

void gnuplot_complaint(int log, char *text, size_t size)
{
    snprintf(text, size, "no message");
    int copy = dup(log);
    FILE *file = copy < 0 ? NULL : fdopen(copy, "r");
    if (!file) {
        if (copy >= 0)
            close(copy);
        return;
    }
    rewind(file);
    /* A failed statement, a '^' below its fault, then "SCRIPT" line N: REASON. */
    char line[512], statement[200] = "";
    while (fgets(line, sizeof line, file)) {
        line[strcspn(line, "\r\n")] = '\0';
        const char *start = line + strspn(line, " \t^"), *reason = *start == '"' ? strstr(start, "\" line ") : NULL;
        if (reason) {
            snprintf(text, size, "%s%s%s", statement, *statement ? ": " : "", reason + 2);
            break;
        }
        if (*start && !*statement) {
            snprintf(statement, sizeof statement, "%.199s", start);
            snprintf(text, size, "%s", statement);
        }
    }
    fclose(file);
}

/* In the child, which ends with this program, by whatever ends it. A group of its own, so that what it starts can be
   ended with it. --default-settings: the user's own gnuplot start-up files stay out. */
static _Noreturn void child_run(pid_t parent, const char *script, int picture, int log)
{
    const int nothing = open("/dev/null", O_RDONLY);
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    signal(SIGXFSZ, SIG_DFL); /* which main ignores */
    if (getppid() == parent && dup2(nothing, STDIN_FILENO) >= 0 && dup2(picture, STDOUT_FILENO) >= 0
        && dup2(log, STDERR_FILENO) >= 0)
        execlp("gnuplot", "gnuplot", "--default-settings", script, (char *)NULL);
    dprintf(STDERR_FILENO, "cannot run gnuplot (Debian: gnuplot-nox): %s\n", strerror(errno));
    _exit(126);
}

enum status gnuplot_start(const char *script, int picture, int log, struct gnuplot *gnuplot)
{
    const pid_t parent = getpid();
    *gnuplot = (struct gnuplot){.begin = seconds_now(), .process = _Fork()};
    if (gnuplot->process == 0)
        child_run(parent, script, picture, log);
    return gnuplot->process > 0 ? STATUS_OK
                                : status_set(STATUS_FAILED, "plot: no process to run gnuplot in: %s", strerror(errno));
}

enum status gnuplot_poll(struct gnuplot *gnuplot, bool *ended)
{
    pid_t found = waitpid(gnuplot->process, &gnuplot->exit_status, WNOHANG);
    *ended = found == gnuplot->process;
    if (found < 0 && errno != EINTR)
        return status_set(STATUS_FAILED, "plot: cannot wait for gnuplot: %s", strerror(errno));
    if (found <= 0 && seconds_now() - gnuplot->begin > plot_seconds_most) {
        kill(-gnuplot->process, SIGKILL);
        waitpid(gnuplot->process, &gnuplot->exit_status, 0);
        hung = true;
        return status_set(STATUS_FAILED,
                          "plot: gnuplot did not end within %g s and was stopped; no more pictures "
                          "are drawn",
                          plot_seconds_most);
    }
    return STATUS_OK;
}

void gnuplot_pause(void)
{
    nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
}
