/* Pictures in the making (plot_script.h). */
#define _GNU_SOURCE /* memfd_create, _Fork */
#include "show/plot_script.h"

#include <errno.h>
#include <fcntl.h>
#include <omp.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "files/text_file.h"
#include "text/shown_text.h"
#include "contract/algorithm.h"
#include "show/plot.h"

/* ---- gnuplot as a process ---- */

double plot_seconds_most = 60;
static bool hung; /* a picture took too long: every further one would, too */

/* The first line of `log` that names a fault, for a message. */
static void gnuplot_complaint(int log, char *text, size_t size)
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

/* In the child, which ends with this program, however that ends. It has a group of its own, so that its own children
   can be ended with it. --default-settings: ignores the user's gnuplot start-up files. */
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

static enum status gnuplot_start(const char *script, int picture, int log, struct gnuplot *gnuplot)
{
    const pid_t parent = getpid();
    *gnuplot = (struct gnuplot){.begin = seconds_now(), .process = _Fork()};
    if (gnuplot->process == 0)
        child_run(parent, script, picture, log);
    return gnuplot->process > 0 ? STATUS_OK
                                : status_set(STATUS_FAILED, "plot: no process to run gnuplot in: %s", strerror(errno));
}

static enum status gnuplot_poll(struct gnuplot *gnuplot, bool *ended)
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

static void gnuplot_pause(void)
{
    nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
}

/* ---- a picture in the making ---- */

static enum status file_failed(const char *path)
{
    return status_set(STATUS_FAILED, "plot: '%.300s' cannot be drawn: %s", path, strerror(errno));
}

void plot_file_name(int descriptor, char name[PLOT_NAME])
{
    snprintf(name, PLOT_NAME, "/proc/%d/fd/%d", (int)getpid(), descriptor);
}

static enum status file_open(struct plot *plot, FILE **file)
{
    errno = EMFILE;
    const int descriptor = plot->file_count < PLOT_FILES_MOST ? memfd_create("data", MFD_CLOEXEC) : -1;
    *file = descriptor < 0 ? NULL : fdopen(descriptor, "w");
    if (*file) {
        plot->files[plot->file_count++] = *file;
        return STATUS_OK;
    }
    enum status status = file_failed(plot->path);
    if (descriptor >= 0)
        close(descriptor);
    return status;
}

enum status plot_file_open(struct plot *plot, const char *array, int index, FILE **file)
{
    char name[PLOT_NAME];
    enum status status = file_open(plot, file);
    if (status != STATUS_OK)
        return status;
    plot_file_name(fileno(*file), name);
    plot_array_write(plot->preamble, array, index, name);
    return STATUS_OK;
}

enum status plot_file_flush(const struct plot *plot, FILE *file)
{
    return stream_flush(file) ? STATUS_OK : file_failed(plot->path);
}

/* A gnuplot string: between single quotes only the single quote is special. In the manual two of them are one, but
   not at the beginning of a string (5.4). */
static void text_write(FILE *file, const char *text)
{
    fputc('\'', file);
    for (; *text; text++)
        if (*text == '\'')
            fputs("'.\"\\047\".'", file);
        else
            fputc((unsigned char)*text < ' ' ? ' ' : *text, file);
    fputc('\'', file);
}

void plot_variable(FILE *file, const char *name, const char *text)
{
    fprintf(file, "%s = ", name);
    text_write(file, text);
    fputc('\n', file);
}

void plot_path_variable(FILE *file, const char *name, const char *path)
{
    char *whole = realpath(path, NULL);
    plot_variable(file, name, whole ? whole : path);
    free(whole);
}

void plot_array(FILE *file, const char *name, int count)
{
    fprintf(file, "array %s[%d]\n", name, count);
}

void plot_array_write(FILE *file, const char *name, int index, const char *text)
{
    fprintf(file, "%s[%d] = ", name, index + 1);
    text_write(file, text);
    fputc('\n', file);
}

static bool is_svg(const char *path)
{
    size_t length = strlen(path);
    return length > 4 && strcmp(path + length - 4, ".svg") == 0;
}

static enum status hung_status(const char *path)
{
    return status_set(STATUS_FAILED, "plot: '%.300s' is not drawn: gnuplot did not end on a picture before", path);
}

enum status plot_begin(struct plot *plot, const char *path, bool named)
{
    *plot = (struct plot){.path = path, .named = named, .picture = -1, .log = -1};
    return hung ? hung_status(path) : file_open(plot, &plot->preamble);
}

void plot_end(struct plot *plot)
{
    for (int k = 0; k < plot->file_count; k++)
        fclose(plot->files[k]);
    if (plot->picture >= 0)
        close(plot->picture);
    if (plot->log >= 0)
        close(plot->log);
}

static enum status plot_prepare(struct plot *plot, const char *plots_directory, const char *script)
{
    plot->plots_directory = plots_directory;
    plot->script = script;
    plot_variable(plot->preamble, "format", is_svg(plot->path) ? "svg" : "png");
    plot_variable(plot->preamble, "output", "/dev/stdout");
    plot_path_variable(plot->preamble, "plots", plots_directory);
    fprintf(plot->preamble, "load plots.'/%s'\n", script);
    return plot_file_flush(plot, plot->preamble);
}

static enum status plot_start(struct plot *plot)
{
    char script[PLOT_NAME];
    if (hung)
        return hung_status(plot->path);
    plot->picture = memfd_create("picture", MFD_CLOEXEC);
    plot->log = memfd_create("log", MFD_CLOEXEC);
    if (plot->picture < 0 || plot->log < 0)
        return file_failed(plot->path);
    plot_file_name(fileno(plot->preamble), script);
    return gnuplot_start(script, plot->picture, plot->log, &plot->gnuplot);
}

static enum status plot_poll(struct plot *plot, bool *ended)
{
    enum status status = gnuplot_poll(&plot->gnuplot, ended);
    if (status == STATUS_OK && *ended && plot->gnuplot.exit_status != 0) {
        const int how = plot->gnuplot.exit_status;
        char complaint[400];
        if (WIFSIGNALED(how))
            snprintf(complaint, sizeof complaint, "ended by signal %d (%s)", WTERMSIG(how), strsignal(WTERMSIG(how)));
        else
            gnuplot_complaint(plot->log, complaint, sizeof complaint);
        return status_set(STATUS_FAILED, "plot: gnuplot failed on '%s' with %s/%s: %s", plot->path,
                          plot->plots_directory, plot->script, complaint);
    }
    return status;
}

enum status plot_run(struct plot *plot, const char *plots_directory, const char *script)
{
    bool ended = false;
    enum status status = plot_prepare(plot, plots_directory, script);
    if (status == STATUS_OK)
        status = plot_start(plot);
    while (status == STATUS_OK && !ended) {
        status = plot_poll(plot, &ended);
        if (!ended)
            gnuplot_pause();
    }
    return status;
}

/* Is the picture complete? gnuplot does not notice failed writes. */
static bool picture_is_whole(const struct plot *plot, off_t size)
{
    static const char png[] = "\0\0\0\0IEND\xae\x42\x60\x82", svg[] = "</svg>";
    const bool text = is_svg(plot->path);
    const char *wanted = text ? svg : png;
    const size_t length = text ? sizeof svg - 1 : sizeof png - 1;
    char end[32];
    const off_t from = size < (off_t)sizeof end ? 0 : size - (off_t)sizeof end;
    ssize_t count = pread(plot->picture, end, sizeof end, from);
    while (text && count > 0 && end[count - 1] == '\n')
        count--;
    return count >= (ssize_t)length && memcmp(end + count - length, wanted, length) == 0;
}

/* Put the picture in its place. */
static enum status plot_place(const struct plot *plot)
{
    struct text_file file;
    const off_t size = lseek(plot->picture, 0, SEEK_END);
    if (!picture_is_whole(plot, size))
        return status_set(STATUS_FAILED, "plot: gnuplot left '%s' without its end", plot->path);
    char *bytes = mmap(NULL, (size_t)size, PROT_READ, MAP_PRIVATE, plot->picture, 0);
    if (bytes == MAP_FAILED)
        return file_failed(plot->path);
    enum status status = plot->named ? text_file_open_named(plot->path, &file) : text_file_open(plot->path, &file);
    if (status == STATUS_OK) {
        fwrite(bytes, 1, (size_t)size, file.stream);
        status = text_file_close(&file, STATUS_OK);
    }
    munmap(bytes, (size_t)size);
    return status;
}

/* ---- later ---- */

enum { PROCESSES_MOST = 16 };

struct queued_plot {
    struct plot plot; /* its path is ours */
    bool started, done;
};

static void queued_end(struct queued_plot *queued)
{
    plot_end(&queued->plot);
    free((char *)queued->plot.path);
}

/* Takes over the plot, even on failure. */
static enum status add(struct plot_queue *queue, struct plot *plot, const char *plots_directory, const char *script)
{
    if (!queue->list)
        queue->list = malloc(PLOT_QUEUE_MOST * sizeof *queue->list);
    char *path = queue->list ? strdup(plot->path) : NULL;
    enum status status = path ? plot_prepare(plot, plots_directory, script)
                              : status_set(STATUS_FAILED, "plot: '%.300s': no memory", plot->path);
    if (status != STATUS_OK) {
        free(path);
        plot_end(plot);
        return status;
    }
    struct queued_plot *queued = &queue->list[queue->count++];
    *queued = (struct queued_plot){.plot = *plot};
    queued->plot.path = path;
    if (queue->count == PLOT_QUEUE_MOST)
        plot_queue_draw(queue);
    return STATUS_OK;
}

enum status plot_finish(struct plot *plot, enum status status, struct plot_queue *queue, const char *plots_directory,
                        const char *script)
{
    if (status == STATUS_OK && queue) {
        status = add(queue, plot, plots_directory, script);
    } else {
        if (status == STATUS_OK)
            status = plot_run(plot, plots_directory, script);
        if (status == STATUS_OK)
            status = plot_place(plot);
        plot_end(plot);
    }
    if (queue)
        undrawn_note(status, &queue->undrawn);
    return status;
}

void undrawn_note(enum status status, int *undrawn)
{
    if (status == STATUS_OK)
        return;
    shown_note(status_message());
    ++*undrawn;
}

/* One step of a picture: start it, check whether it is ready, put it into its place. */
static enum status advance(struct queued_plot *queued)
{
    bool ended = false;
    enum status status = STATUS_OK;
    if (!queued->started)
        status = plot_start(&queued->plot);
    else
        status = plot_poll(&queued->plot, &ended);
    queued->started = true;
    if (status == STATUS_OK && ended)
        status = plot_place(&queued->plot);
    queued->done = ended || status != STATUS_OK;
    return status;
}

void plot_queue_draw(struct plot_queue *queue)
{
    /* The last first: a scene's slices take longest. */
    const int threads = omp_get_max_threads(), most = threads < PROCESSES_MOST ? threads : PROCESSES_MOST;
    for (int done = 0; done < queue->count;) {
        int running = 0;
        done = 0;
        for (int k = queue->count - 1; k >= 0 && running < most; k--) {
            if (!queue->list[k].done)
                undrawn_note(advance(&queue->list[k]), &queue->undrawn);
            running += !queue->list[k].done;
        }
        for (int k = 0; k < queue->count; k++)
            done += queue->list[k].done;
        if (done < queue->count)
            gnuplot_pause();
    }
    plot_queue_free(queue);
}

void plot_queue_free(struct plot_queue *queue)
{
    for (int k = 0; k < queue->count; k++)
        queued_end(&queue->list[k]);
    free(queue->list);
    queue->list = NULL;
    queue->count = 0;
}
