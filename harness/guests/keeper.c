/* A process that waits for a stranger's program (keeper.h). */
#define _GNU_SOURCE /* nftw, pipe2, close_range */
#include "guests/keeper.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* The keeper's descriptors; the first two are the program's alone. */
enum { HEARS = 3, SAYS, LIFE, END, KEPT };
enum { STOP_MS = 20000 }; /* to end what begins others all the time */

/* What goes to END, first of all: why the program cannot be run, or how it ended. */
struct ending {
    int error, state;
};

static struct keeper *kept; /* the newest first */

/* ---- all that a process started ---- */

struct process {
    pid_t pid, parent;
    double seconds;
    bool ours;
};

/* Its line in /proc: behind the name, which may hold anything, the third field and on. */
static bool process_read(pid_t pid, struct process *process)
{
    char path[40], text[1024];
    snprintf(path, sizeof path, "/proc/%d/stat", (int)pid);
    const int file = open(path, O_RDONLY | O_CLOEXEC);
    const ssize_t length = file >= 0 ? read(file, text, sizeof text - 1) : 0;
    if (file >= 0)
        close(file);
    text[length > 0 ? length : 0] = '\0';
    const char *behind = strrchr(text, ')');
    int parent;
    unsigned long own[2];
    long others[2];
    if (!behind
        || sscanf(behind + 1, " %*c %d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu %ld %ld", &parent, &own[0], &own[1],
                  &others[0], &others[1])
               != 5)
        return false;
    const double tick = 1.0 / (double)sysconf(_SC_CLK_TCK);
    struct timespec used;
    clockid_t clock; /* finer than ticks */
    *process = (struct process){pid, parent, tick * (double)(others[0] + others[1]), false};
    process->seconds += clock_getcpuclockid(pid, &clock) == 0 && clock_gettime(clock, &used) == 0
                            ? (double)used.tv_sec + 1e-9 * (double)used.tv_nsec
                            : tick * (double)(own[0] + own[1]);
    return true;
}

/* All that `root` started, and itself, [*count]; NULL without memory or /proc. */
static struct process *processes_of(pid_t root, int *count)
{
    struct process *list = NULL;
    int room = 0, all = 0;
    DIR *folder = opendir("/proc");
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        if (all == room) {
            room = 2 * room + 256;
            struct process *more = realloc(list, (size_t)room * sizeof *list);
            if (!more)
                break;
            list = more;
        }
        if (isdigit((unsigned char)*entry->d_name) && process_read((pid_t)atoi(entry->d_name), &list[all])) {
            list[all].ours = list[all].pid == root;
            all++;
        }
    }
    if (folder)
        closedir(folder);
    for (bool found = true; found;) {
        found = false;
        for (int k = 0; k < all; k++)
            for (int j = 0; j < all && !list[k].ours; j++)
                found |= list[k].ours = list[j].ours && list[j].pid == list[k].parent;
    }
    *count = 0;
    for (int k = 0; k < all; k++)
        if (list[k].ours)
            list[(*count)++] = list[k];
    return list;
}

double keepers_busy_s(void)
{
    double sum = 0;
    for (const struct keeper *keeper = kept; keeper; keeper = keeper->next) {
        int count = 0;
        struct process *list = processes_of(keeper->pid, &count);
        for (int k = 0; k < count; k++)
            sum += list[k].seconds;
        free(list);
    }
    return sum;
}

/* ---- the keeper's process ---- */

static int remove_one(const char *path, const struct stat *info, int kind, struct FTW *place)
{
    (void)info;
    (void)kind;
    (void)place;
    remove(path);
    return 0;
}

/* `program` 0: none. It is not waited for until here, so that no other process has got its number. */
static void __attribute__((noreturn)) stop(pid_t program, const char *folder)
{
    for (int k = 0; k < STOP_MS; k++) {
        int count = 0;
        if (program > 0)
            kill(-program, SIGKILL); /* at once, whatever they begin meanwhile */
        struct process *list = processes_of(getpid(), &count);
        for (int n = 0; n < count; n++)
            if (list[n].pid != getpid())
                kill(list[n].pid, SIGKILL);
        free(list);
        pid_t ended;
        while ((ended = waitpid(-1, NULL, WNOHANG)) > 0)
            program = ended == program ? 0 : program;
        if (ended < 0)
            break;
        usleep(1000);
    }
    nftw(folder, remove_one, 16, FTW_DEPTH | FTW_PHYS | FTW_MOUNT);
    _exit(0);
}

void signals_reset(void)
{
    for (int k = 1; k < NSIG; k++)
        signal(k, SIG_DFL);
}

static void __attribute__((noreturn)) program_run(char *const *words, const char *folder, int threads, pid_t parent)
{
    static const char *const limits[] = {"OMP_NUM_THREADS",     "OPENBLAS_NUM_THREADS",   "MKL_NUM_THREADS",
                                         "NUMEXPR_NUM_THREADS", "VECLIB_MAXIMUM_THREADS", "NUMBA_NUM_THREADS"};
    char path[4200], number[16];
    sigset_t none;
    snprintf(path, sizeof path, "%s/log", folder);
    snprintf(number, sizeof number, "%d", threads);
    for (size_t k = 0; k < sizeof limits / sizeof *limits; k++)
        setenv(limits[k], number, 1);
    const int log = open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    setpgid(0, 0);
    signals_reset();
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
    if (prctl(PR_SET_PDEATHSIG, SIGKILL) == 0 && getppid() == parent && dup2(log, STDOUT_FILENO) >= 0
        && dup2(log, STDERR_FILENO) >= 0 && fcntl(HEARS, F_SETFD, 0) == 0 && fcntl(SAYS, F_SETFD, 0) == 0)
        execvp(*words, words);
    const struct ending ending = {.error = errno};
    _exit(write(END, &ending, sizeof ending) == sizeof ending ? 127 : 126);
}

/* `ends` are its ends of the pipes, in the order of HEARS to END. */
static void __attribute__((noreturn)) keep(char *const *words, const char *folder, int threads, const int ends[4])
{
    int high[4];
    const int nothing = open("/dev/null", O_RDWR);
    sigset_t all;
    sigfillset(&all);
    sigprocmask(SIG_SETMASK, &all, NULL);
    setpgid(0, 0);
    for (int k = 0; k < 3; k++)
        dup2(nothing, k);
    for (int k = 0; k < 4; k++)
        high[k] = fcntl(ends[k], F_DUPFD_CLOEXEC, 100);
    for (int k = 0; k < 4; k++)
        if (dup3(high[k], HEARS + k, O_CLOEXEC) < 0)
            _exit(1);
    close_range(KEPT, ~0u, 0);
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    const int signals = signalfd(-1, &all, SFD_CLOEXEC);
    const pid_t parent = getpid(), program = fork();
    if (program == 0)
        program_run(words, folder, threads, parent);
    const struct ending none = {.error = errno};
    if (program < 0 && write(END, &none, sizeof none) < 0)
        _exit(1);
    setpgid(program, program); /* whoever of both comes first */
    close(HEARS);
    close(SAYS);
    for (bool ended = program < 0;;) {
        struct pollfd polled[] = {{LIFE, POLLIN, 0}, {signals, POLLIN, 0}};
        struct signalfd_siginfo number;
        siginfo_t info = {.si_pid = 0};
        poll(polled, 2, -1);
        if (polled[1].revents && read(signals, &number, sizeof number) < 0)
            break;
        if (!ended && waitid(P_PID, (id_t)program, &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid > 0) {
            const struct ending ending = {.state = info.si_code == CLD_EXITED ? (info.si_status & 0xff) << 8
                                                                              : info.si_status & 0x7f};
            ended = write(END, &ending, sizeof ending) >= 0 || errno != EINTR;
        }
        if (polled[0].revents)
            break;
    }
    stop(program < 0 ? 0 : program, folder);
}

/* ---- our side ---- */

enum status keeper_start(char *const *words, const char *folder, int threads, struct keeper *keeper)
{
    int pipes[4][2], made = 0;
    *keeper = (struct keeper){.pid = 0};
    while (made < 4 && pipe2(pipes[made], O_CLOEXEC) == 0)
        made++;
    const int ends[4] = {pipes[0][0], pipes[1][1], pipes[2][0], pipes[3][1]};
    const bool ready = made == 4 && fcntl(pipes[0][1], F_SETFL, O_NONBLOCK) == 0;
    const pid_t pid = ready ? fork() : -1;
    if (pid == 0)
        keep(words, folder, threads, ends);
    if (pid < 0) {
        const int error = errno;
        for (int k = 0; k < 2 * made; k++)
            close(pipes[k / 2][k % 2]);
        return status_set(STATUS_FAILED, "no process can be started: %s", strerror(error));
    }
    for (int k = 1; k < 4; k++)
        close(ends[k]);
    *keeper = (struct keeper){pid, pipes[0][1], pipes[1][0], pipes[0][0], pipes[2][1], pipes[3][0], kept};
    kept = keeper;
    return STATUS_OK;
}

bool keeper_ended(const struct keeper *keeper, double seconds, char *how, size_t size)
{
    struct pollfd polled = {keeper->end, POLLIN, 0};
    struct ending ending;
    if (poll(&polled, 1, (int)(1000 * seconds)) <= 0)
        return false;
    if (read(keeper->end, &ending, sizeof ending) != sizeof ending)
        snprintf(how, size, "ended, and with it the process that kept it");
    else if (ending.error)
        snprintf(how, size, "cannot be run: %s", strerror(ending.error));
    else if (WIFSIGNALED(ending.state))
        snprintf(how, size, "ended by signal %d (%s)", WTERMSIG(ending.state), strsignal(WTERMSIG(ending.state)));
    else
        snprintf(how, size, "ended with exit status %d", WEXITSTATUS(ending.state));
    return true;
}

void keeper_stop(struct keeper *keeper)
{
    struct keeper **link = &kept;
    if (keeper->pid <= 0)
        return;
    while (*link && *link != keeper)
        link = &(*link)->next;
    if (*link)
        *link = keeper->next;
    const int ours[] = {keeper->life, keeper->to, keeper->from, keeper->unread, keeper->end};
    for (size_t k = 0; k < sizeof ours / sizeof *ours; k++)
        close(ours[k]);
    while (waitpid(keeper->pid, NULL, 0) < 0 && errno == EINTR)
        ;
    *keeper = (struct keeper){.pid = 0};
}
