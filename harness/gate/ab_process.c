/* The other program of ab_process.h: a process group of its own behind one socket. */
#define _GNU_SOURCE /* sched_setaffinity */
#include "gate/ab_process.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static const char greeting[] = "sasbench measure 1";

/* One processor for both sides of a round, so that nothing but the program differs; each in turn. */
static void processor_choose(int turn)
{
    cpu_set_t all, one;
    if (sched_getaffinity(0, sizeof all, &all) != 0)
        return;
    int left = turn % CPU_COUNT(&all);
    for (int k = 0; k < CPU_SETSIZE; k++)
        if (CPU_ISSET(k, &all) && left-- == 0) {
            CPU_ZERO(&one);
            CPU_SET(k, &one);
            sched_setaffinity(0, sizeof one, &one); /* where it is refused, the times are only noisier */
        }
}

/* In the child: never returns. */
static void child_run(const char *path, int turn, int socket)
{
    int nothing = open("/dev/null", O_WRONLY);
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    processor_choose(turn);
    if (nothing >= 0 && dup2(socket, STDIN_FILENO) >= 0 && dup2(socket, STDOUT_FILENO) >= 0
        && dup2(nothing, STDERR_FILENO) >= 0)
        execl(path, path, "measure", (char *)NULL);
    _exit(126);
}

/* Why it stopped answering: its process has ended, or is about to, or has only closed its output. */
static enum status silence(struct ab_process *process, const char *question)
{
    int state = 0;
    pid_t ended = 0;
    for (int k = 0; k < 100 && ended == 0; k++) {
        ended = waitpid(process->pid, &state, WNOHANG);
        if (ended == 0)
            nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    }
    char how[80] = "closed its output";
    if (ended > 0) {
        kill(-process->pid, SIGKILL); /* processes that it may have left */
        process->pid = 0;
        if (WIFSIGNALED(state))
            snprintf(how, sizeof how, "was ended by signal %d (%s)", WTERMSIG(state), strsignal(WTERMSIG(state)));
        else
            snprintf(how, sizeof how, "ended with status %d", WEXITSTATUS(state));
    }
    return status_set(STATUS_INVALID, "%s %s %s %s '%s'; a sasbench that has the command measure is needed",
                      process->role, process->path, how, *question ? "after" : "instead of",
                      *question ? question : greeting);
}

static enum status line_read(struct ab_process *process, const char *question, char *line, size_t size)
{
    char whole[8192];
    errno = 0;
    if (fgets(whole, sizeof whole, process->answers)) {
        const char *end = strchr(whole, '\n');
        if (!end)
            return status_set(STATUS_INVALID, "%s %s: a line is longer than %zu characters", process->role,
                              process->path, sizeof whole);
        snprintf(line, size, "%.*s", (int)(end - whole), whole);
        return STATUS_OK;
    }
    if (errno != EAGAIN)
        return silence(process, question);
    return status_set(STATUS_INVALID, "%s %s sends nothing for %g s %s '%s'", process->role, process->path,
                      process->patience_s, *question ? "after" : "instead of", *question ? question : greeting);
}

enum status ab_process_start(const char *role, const char *path, int turn, double patience_s,
                             struct ab_process *process)
{
    int sockets[2];
    struct stat about;
    *process = (struct ab_process){0};
    if (stat(path, &about) != 0 || !S_ISREG(about.st_mode) || access(path, X_OK) != 0)
        return status_set(STATUS_INVALID,
                          "%s %s is no program that can be run; a sasbench is needed, such as "
                          "build/harness/sasbench",
                          role, path);
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0)
        return status_set(STATUS_FAILED, "%s %s: no socket: %s", role, path, strerror(errno));
    pid_t pid = fork();
    if (pid == 0)
        child_run(path, turn, sockets[1]);
    close(sockets[1]);
    if (pid < 0) {
        close(sockets[0]);
        return status_set(STATUS_FAILED, "%s %s: no process: %s", role, path, strerror(errno));
    }
    setpgid(pid, pid); /* here, too: whoever comes first */
    const struct timeval patience = {(time_t)patience_s, (suseconds_t)(1e6 * (patience_s - floor(patience_s)))};
    setsockopt(sockets[0], SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    *process = (struct ab_process){role, path, pid, sockets[0], patience_s, fdopen(sockets[0], "r")};
    char line[200];
    enum status status = process->answers ? line_read(process, "", line, sizeof line)
                                          : status_set(STATUS_FAILED, "%s %s: no memory", role, path);
    if (status == STATUS_OK && strcmp(line, greeting) != 0)
        status = status_set(STATUS_INVALID, "%s %s sends '%.60s' in place of '%s': another version, or no sasbench",
                            role, path, line, greeting);
    if (status != STATUS_OK)
        ab_process_stop(process);
    return status;
}

enum status ab_process_ask(struct ab_process *process, const char *question, char *answer, size_t size)
{
    char line[8192];
    int length = snprintf(line, sizeof line, "%s\n", question);
    if (length >= (int)sizeof line || strchr(question, '\n'))
        return status_set(STATUS_INVALID, "'%.60s...' is too long for a question of one line", question);
    for (int sent = 0; sent < length;) {
        ssize_t some = send(process->socket, line + sent, (size_t)(length - sent), MSG_NOSIGNAL);
        if (some <= 0)
            return silence(process, question);
        sent += (int)some;
    }
    return line_read(process, question, answer, size);
}

void ab_process_stop(struct ab_process *process)
{
    if (process->pid > 0) {
        kill(-process->pid, SIGKILL);
        waitpid(process->pid, NULL, 0);
    }
    if (process->answers)
        fclose(process->answers);
    else if (process->path)
        close(process->socket);
    *process = (struct ab_process){0};
}
