/* gnuplot as a process (gnuplot.h). */
#include "show/gnuplot.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "algorithm.h"
#include "data/temporary.h"
#include "show/plot.h"

extern char **environ;

double plot_seconds_most = 60;
static bool hung;

bool gnuplot_hung(void)
{
    return hung;
}

void gnuplot_complaint(const char *log, char *text, size_t size)
{
    snprintf(text, size, "no message");
    FILE *file = fopen(log, "r");
    if (!file)
        return;
    char line[512];
    while (fgets(line, sizeof line, file)) {
        line[strcspn(line, "\r\n")] = '\0';
        const char *start = line + strspn(line, " \t^");
        if (*start) {
            snprintf(text, size, "%s", start);
            break;
        }
    }
    fclose(file);
}

/* gnuplot in a process group of its own, so that what it starts can be ended with it. */
static int gnuplot_start(const char *script, const char *log, pid_t *child)
{
    /* --default-settings: the user's own gnuplot start-up files stay out. */
    char *arguments[] = {"gnuplot", "--default-settings", (char *)script, NULL};
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t usual;
    int error = posix_spawn_file_actions_init(&actions);
    if (error)
        return error;
    error = posix_spawnattr_init(&attributes);
    if (!error) {
        sigemptyset(&usual);
        sigaddset(&usual, SIGXFSZ); /* which main ignores */
        error = posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
        if (!error)
            error = posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log, O_WRONLY | O_CREAT, 0600);
        if (!error)
            error = posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
        if (!error)
            error = posix_spawnattr_setsigdefault(&attributes, &usual);
        if (!error)
            error = posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
        if (!error)
            error = posix_spawnp(child, "gnuplot", &actions, &attributes, arguments, environ);
        posix_spawnattr_destroy(&attributes);
    }
    posix_spawn_file_actions_destroy(&actions);
    return error;
}

/* *exit_status is as waitpid gives it. */
static enum status gnuplot_wait(pid_t child, int *exit_status)
{
    double begin = seconds_now();
    for (pid_t ended; (ended = waitpid(child, exit_status, WNOHANG)) != child;) {
        if (ended < 0 && errno != EINTR)
            return status_set(STATUS_FAILED, "plot: cannot wait for gnuplot: %s", strerror(errno));
        if (ended == 0 && seconds_now() - begin > plot_seconds_most) {
            kill(-child, SIGKILL);
            waitpid(child, exit_status, 0);
            hung = true;
            return status_set(STATUS_FAILED,
                              "plot: gnuplot did not end within %g s and was stopped; no more pictures "
                              "are drawn",
                              plot_seconds_most);
        }
        nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
    }
    return STATUS_OK;
}

enum status gnuplot_run(const char *script, const char *log, int *exit_status)
{
    pid_t child;
    int error = gnuplot_start(script, log, &child);
    if (error)
        return status_set(STATUS_FAILED, "plot: cannot run gnuplot (Debian: gnuplot-nox): %s", strerror(error));
    temporary_process(child);
    enum status status = gnuplot_wait(child, exit_status);
    temporary_process(0);
    return status;
}
