/* A child does the work, its parent waits (supervisor.h). They share one page of notes. */
#define _GNU_SOURCE /* MAP_ANONYMOUS */
#include "run/supervisor.h"

#include <errno.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ranks/ranks.h"
#include "text/shown_text.h"

enum { CRASHES_MAX = 256, TASK_MAX = 800 };

static struct notes {
    volatile sig_atomic_t busy; /* within a task */
    char task[TASK_MAX];        /* the latest */
    char folder[400];           /* measurements are kept there */
    int crash_count;
    struct {
        char task[TASK_MAX], how[120];
    } crashes[CRASHES_MAX];
} * notes;

static volatile sig_atomic_t child;

void supervisor_enter(const char *task)
{
    if (notes) {
        snprintf(notes->task, sizeof notes->task, "%s", task);
        notes->busy = true;
    }
}

void supervisor_leave(void)
{
    if (notes)
        notes->busy = false;
}

void supervisor_keeps(const char *folder)
{
    if (notes)
        snprintf(notes->folder, sizeof notes->folder, "%s", folder);
}

const char *supervisor_crash(const char *task)
{
    for (int k = 0; notes && k < notes->crash_count; k++)
        if (strncmp(notes->crashes[k].task, task, TASK_MAX - 1) == 0)
            return notes->crashes[k].how;
    return NULL;
}

static void forward(int number)
{
    if (child > 0)
        kill((pid_t)child, number);
}

/* Did a fault end the process, and not a user? */
static bool is_crash(int state)
{
    static const int faults[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS, SIGTRAP, SIGKILL};
    if (!notes->busy || notes->crash_count == CRASHES_MAX)
        return false;
    bool crash = WIFEXITED(state);
    for (size_t k = 0; k < sizeof faults / sizeof *faults; k++)
        crash |= WIFSIGNALED(state) && WTERMSIG(state) == faults[k];
    return crash;
}

static void crash_note(int state)
{
    char *how = notes->crashes[notes->crash_count].how;
    const size_t size = sizeof notes->crashes[0].how;
    if (WIFSIGNALED(state))
        snprintf(how, size, "ended by signal %d (%s)", WTERMSIG(state), strsignal(WTERMSIG(state)));
    else
        snprintf(how, size, "ended the program with exit status %d", WEXITSTATUS(state));
    memcpy(notes->crashes[notes->crash_count].task, notes->task, sizeof notes->task);
    notes->crash_count++;
    notes->busy = false;
    fputs("sasbench: ", stderr);
    shown_write(stderr, notes->task);
    fprintf(stderr, ": %s; the run resumes without it\n", how);
}

/* The parent's part; returns when another child is needed. */
static void wait_for_child(void)
{
    int state;
    while (ranks_wait((pid_t)child, &state) < 0)
        if (errno != EINTR)
            _exit(1);
    child = 0;
    if (is_crash(state)) {
        crash_note(state);
        return;
    }
    if (WIFSIGNALED(state)) {
        sigset_t all;
        const bool interrupted = WTERMSIG(state) == SIGINT || WTERMSIG(state) == SIGTERM;
        if (*notes->folder && interrupted && ranks_number() <= 1) { /* rank 0 may be what died */
            fputs("sasbench: interrupted; ", stderr);
            shown_write(stderr, notes->folder);
            fputs(" holds what was measured, the same command goes on from there\n", stderr);
        }
        signal(WTERMSIG(state), SIG_DFL);
        sigfillset(&all);
        raise(WTERMSIG(state));
        sigprocmask(SIG_UNBLOCK, &all, NULL);
    }
    const int status = WIFEXITED(state) ? WEXITSTATUS(state) : 1;
    ranks_end(status);
    _exit(status);
}

void supervisor_begin(void)
{
    static const int forwarded[] = {SIGHUP, SIGINT, SIGQUIT, SIGALRM, SIGTERM, SIGXCPU};
    const pid_t parent = getpid();
    struct sigaction before[sizeof forwarded / sizeof *forwarded];
    sigset_t all, mask;
    void *page = mmap(NULL, sizeof *notes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (page == MAP_FAILED)
        return;
    notes = page;
    fflush(NULL);
    sigfillset(&all);
    sigprocmask(SIG_BLOCK, &all, &mask);
    for (size_t k = 0; k < sizeof forwarded / sizeof *forwarded; k++) {
        struct sigaction action = {.sa_handler = forward};
        sigaction(forwarded[k], NULL, &before[k]);
        if (before[k].sa_handler != SIG_IGN)
            sigaction(forwarded[k], &action, NULL);
    }
    for (;;) {
        pid_t process = ranks_prepare() ? fork() : -1;
        if (process <= 0) { /* the child; or no other process can do the work */
            for (size_t k = 0; k < sizeof forwarded / sizeof *forwarded; k++)
                sigaction(forwarded[k], &before[k], NULL);
            sigprocmask(SIG_SETMASK, &mask, NULL);
            if (process == 0 && (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != parent))
                _exit(1);
            return;
        }
        child = (sig_atomic_t)process;
        sigprocmask(SIG_SETMASK, &mask, NULL);
        wait_for_child();
        sigprocmask(SIG_BLOCK, &all, NULL);
    }
}
