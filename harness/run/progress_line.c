#include "run/progress_line.h"

#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#include "common/clock.h"
#include "common/progress.h"

enum { TERMINAL_S = 1, LOG_S = 60 };

static struct {
    pthread_mutex_t mutex;
    char text[600];
    bool shown, started;
    double begin; /* s: of the text */
    double told;  /* s: when a line was last written */
} line = {.mutex = PTHREAD_MUTEX_INITIALIZER, .told = NAN};

/* With the mutex locked. Uses write(): a child forked meanwhile must find no lock of stdio or malloc. */
static void tell(bool terminal)
{
    char text[800], since[40] = "", share[20] = "";
    const double now = clock_monotonic(), seconds = now - line.begin, done = progress_share();
    if (seconds >= TERMINAL_S)
        snprintf(since, sizeof since, ", %d s", (int)seconds);
    if (done > 0 && *since)
        snprintf(share, sizeof share, ", %d %%", (int)(100 * done));
    struct winsize size;
    int room = sizeof line.text;
    if (terminal && ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) /* a longer line would wrap */
        room = (int)fmax(0, size.ws_col - 1.0 - (double)strlen(since) - (double)strlen(share));
    const int length =
        snprintf(text, sizeof text, terminal ? "\r\033[K%.*s%s%s\r" : "%.*s%s%s\n", room, line.text, since, share);
    line.told = now;
    if (write(STDERR_FILENO, text, (size_t)length) < 0)
        return; /* nobody reads any more */
}

static void *tell_on(void *arguments)
{
    const bool terminal = isatty(STDERR_FILENO);
    const struct timespec second = {.tv_sec = 1};
    (void)arguments;
    for (;;) {
        nanosleep(&second, NULL);
        pthread_mutex_lock(&line.mutex);
        if (line.shown && (terminal || clock_monotonic() - line.told >= LOG_S))
            tell(terminal);
        pthread_mutex_unlock(&line.mutex);
    }
    return NULL;
}

/* Start one thread with all signals blocked; without it only the beginning is shown. */
static void start(void)
{
    pthread_t thread;
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    if (pthread_create(&thread, NULL, tell_on, NULL) == 0)
        pthread_detach(thread);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
}

void progress_line(bool logged, const char *format, ...)
{
    const bool terminal = isatty(STDERR_FILENO);
    va_list arguments;
    if (!terminal && !logged)
        return;
    pthread_mutex_lock(&line.mutex);
    va_start(arguments, format);
    vsnprintf(line.text, sizeof line.text, format, arguments);
    va_end(arguments);
    progress_part(0, 0, 0);
    line.begin = clock_monotonic();
    line.told = isnan(line.told) ? line.begin : line.told;
    line.shown = true;
    if (terminal)
        tell(true);
    const bool started = line.started;
    line.started = true;
    pthread_mutex_unlock(&line.mutex);
    if (!started)
        start();
}

void progress_line_clear(void)
{
    static const char clear[] = "\r\033[K";
    pthread_mutex_lock(&line.mutex);
    if (line.shown && isatty(STDERR_FILENO) && write(STDERR_FILENO, clear, sizeof clear - 1) < 0)
        line.shown = false;
    line.shown = false;
    pthread_mutex_unlock(&line.mutex);
}
