/* gnuplot as a process (gnuplot.h). */
#define _GNU_SOURCE /* posix_spawn_file_actions_addfchdir_np */
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

#include "contract/algorithm.h"
#include "files/temporary.h"
#include "show/plot.h"

extern char **environ;

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

/* gnuplot in a process group of its own, so that what it starts can be ended with it; `mask` is its signal mask. */
static int spawn(int directory, const char *script, int picture, int log, const sigset_t *mask, pid_t *child)
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
            error = posix_spawn_file_actions_adddup2(&actions, picture, STDOUT_FILENO);
        if (!error)
            error = posix_spawn_file_actions_adddup2(&actions, log, STDERR_FILENO);
        if (!error)
            error = posix_spawn_file_actions_addfchdir_np(&actions, directory);
        if (!error)
            error = posix_spawnattr_setsigdefault(&attributes, &usual);
        if (!error)
            error = posix_spawnattr_setsigmask(&attributes, mask);
        if (!error)
            error = posix_spawnattr_setflags(&attributes,
                                             POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
        if (!error)
            error = posix_spawnp(child, "gnuplot", &actions, &attributes, arguments, environ);
        posix_spawnattr_destroy(&attributes);
    }
    posix_spawn_file_actions_destroy(&actions);
    return error;
}

enum status gnuplot_start(int directory, const char *script, int picture, int log, struct gnuplot *gnuplot)
{
    *gnuplot = (struct gnuplot){.begin = seconds_now()};
    sigset_t before;
    temporary_hold(&before);
    int error = spawn(directory, script, picture, log, &before, &gnuplot->process);
    if (!error)
        temporary_process_add(gnuplot->process);
    temporary_release(&before);
    if (error)
        return status_set(STATUS_FAILED, "plot: cannot run gnuplot (Debian: gnuplot-nox): %s", strerror(error));
    return STATUS_OK;
}

/* The process is gone, or given up. */
static void forget(struct gnuplot *gnuplot)
{
    temporary_process_drop(gnuplot->process);
    gnuplot->process = 0;
}

enum status gnuplot_poll(struct gnuplot *gnuplot, bool *ended)
{
    pid_t found = waitpid(gnuplot->process, &gnuplot->exit_status, WNOHANG);
    *ended = found == gnuplot->process;
    if (found < 0 && errno != EINTR) {
        const int reason = errno;
        forget(gnuplot);
        return status_set(STATUS_FAILED, "plot: cannot wait for gnuplot: %s", strerror(reason));
    }
    if (found <= 0 && seconds_now() - gnuplot->begin > plot_seconds_most) {
        kill(-gnuplot->process, SIGKILL);
        waitpid(gnuplot->process, &gnuplot->exit_status, 0);
        forget(gnuplot);
        hung = true;
        return status_set(STATUS_FAILED,
                          "plot: gnuplot did not end within %g s and was stopped; no more pictures "
                          "are drawn",
                          plot_seconds_most);
    }
    if (*ended)
        forget(gnuplot);
    return STATUS_OK;
}

void gnuplot_pause(void)
{
    nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
}
