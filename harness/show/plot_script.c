/* Pictures in the making (plot_script.h). */
#define _GNU_SOURCE /* memfd_create */
#include "show/plot_script.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "files/text_file.h"

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

/* A gnuplot string: nothing but the single quote is special between single quotes. Two of them are one in its manual,
   but not at the beginning of a string (5.4). */
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
    return gnuplot_hung() ? hung_status(path) : file_open(plot, &plot->preamble);
}

/* Removes what is left; accepts a plot whose beginning failed. */
void plot_end(struct plot *plot)
{
    for (int k = 0; k < plot->file_count; k++)
        fclose(plot->files[k]);
    if (plot->picture >= 0)
        close(plot->picture);
    if (plot->log >= 0)
        close(plot->log);
}

enum status plot_prepare(struct plot *plot, const char *plots_directory, const char *script)
{
    plot->plots_directory = plots_directory;
    plot->script = script;
    plot_variable(plot->preamble, "format", is_svg(plot->path) ? "svg" : "png");
    plot_variable(plot->preamble, "output", "/dev/stdout");
    plot_path_variable(plot->preamble, "plots", plots_directory);
    fprintf(plot->preamble, "load plots.'/%s'\n", script);
    return plot_file_flush(plot, plot->preamble);
}

enum status plot_start(struct plot *plot)
{
    char script[PLOT_NAME];
    if (gnuplot_hung())
        return hung_status(plot->path);
    plot->picture = memfd_create("picture", MFD_CLOEXEC);
    plot->log = memfd_create("log", MFD_CLOEXEC);
    if (plot->picture < 0 || plot->log < 0)
        return file_failed(plot->path);
    plot_file_name(fileno(plot->preamble), script);
    return gnuplot_start(script, plot->picture, plot->log, &plot->gnuplot);
}

enum status plot_poll(struct plot *plot, bool *ended)
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

bool plot_is_empty(const struct plot *plot)
{
    struct stat info;
    return fstat(plot->picture, &info) == 0 && info.st_size == 0;
}

/* Whether a picture reaches its end: gnuplot does not notice where it cannot write. */
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
enum status plot_place(const struct plot *plot)
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

enum status plot_draw(struct plot *plot, const char *plots_directory, const char *script)
{
    enum status status = plot_run(plot, plots_directory, script);
    return status == STATUS_OK ? plot_place(plot) : status;
}
