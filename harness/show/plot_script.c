/* Pictures in the making (plot_script.h). */
#include "show/plot_script.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "data/temporary.h"

void plot_file(const struct plot *plot, const char *name, char path[PATH_MAX + 32])
{
    snprintf(path, PATH_MAX + 32, "%s/%.30s", plot->directory, name);
    temporary_inside(path);
}

enum status plot_file_failed(const char *path)
{
    return status_set(STATUS_FAILED, "plot: cannot write '%s': %s", path, strerror(errno));
}

/* A gnuplot string: nothing but the single quote is special between single quotes. */
static void text_write(FILE *file, const char *text)
{
    fputc('\'', file);
    for (; *text; text++) {
        if (*text == '\'')
            fputc('\'', file);
        fputc((unsigned char)*text < ' ' ? ' ' : *text, file);
    }
    fputc('\'', file);
}

void plot_variable(FILE *file, const char *name, const char *text)
{
    fprintf(file, "%s = ", name);
    text_write(file, text);
    fputc('\n', file);
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

enum status plot_begin(struct plot *plot, const char *path)
{
    *plot = (struct plot){.path = path};
    if (gnuplot_hung())
        return hung_status(path);

    /* gnuplot takes an output that begins with '|' for a command. */
    char beside[PATH_MAX], name[PATH_MAX + 32];
    if (snprintf(beside, sizeof beside, "%s%s", *path == '/' ? "" : "./", path) >= (int)sizeof beside)
        return status_set(STATUS_FAILED, "plot: the path '%.200s' is too long", path);
    if (!temporary_folder(beside, plot->directory)) {
        *plot->directory = '\0';
        return plot_file_failed(path);
    }
    plot_file(plot, is_svg(path) ? "picture.svg" : "picture.png", plot->output);
    plot_file(plot, "run.gp", name);
    plot->preamble = fopen(name, "w");
    return plot->preamble ? STATUS_OK : plot_file_failed(name);
}

/* Removes what is left; accepts a plot whose beginning failed. */
void plot_end(struct plot *plot)
{
    if (plot->preamble)
        fclose(plot->preamble);
    if (*plot->directory)
        temporary_remove(plot->directory);
}

enum status plot_prepare(struct plot *plot, const char *plots_directory, const char *script)
{
    plot->plots_directory = plots_directory;
    plot->script = script;
    plot_variable(plot->preamble, "format", is_svg(plot->path) ? "svg" : "png");
    plot_variable(plot->preamble, "output", plot->output);
    plot_variable(plot->preamble, "plots", plots_directory);
    fprintf(plot->preamble, "load plots.'/%s'\n", script);
    bool written = !ferror(plot->preamble);
    written &= fclose(plot->preamble) == 0;
    plot->preamble = NULL;
    return written ? STATUS_OK : plot_file_failed(plot->directory);
}

enum status plot_start(struct plot *plot)
{
    char preamble[PATH_MAX + 32], log[PATH_MAX + 32];
    if (gnuplot_hung())
        return hung_status(plot->path);
    plot_file(plot, "run.gp", preamble);
    plot_file(plot, "log", log);
    return gnuplot_start(preamble, log, &plot->gnuplot);
}

enum status plot_poll(struct plot *plot, bool *ended)
{
    enum status status = gnuplot_poll(&plot->gnuplot, ended);
    if (status == STATUS_OK && *ended && plot->gnuplot.exit_status != 0) {
        char complaint[400], log[PATH_MAX + 32];
        plot_file(plot, "log", log);
        gnuplot_complaint(log, complaint, sizeof complaint);
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

/* Whether a picture reaches its end: gnuplot does not notice a full disk. */
static bool picture_is_whole(const char *path)
{
    static const char png[] = "\0\0\0\0IEND\xae\x42\x60\x82", svg[] = "</svg>";
    const char *wanted = is_svg(path) ? svg : png;
    const size_t size = is_svg(path) ? sizeof svg - 1 : sizeof png - 1;
    char end[32];
    FILE *file = fopen(path, "rb");
    if (!file)
        return false;
    size_t count = fseek(file, -(long)sizeof end, SEEK_END) == 0 ? fread(end, 1, sizeof end, file) : 0;
    fclose(file);
    while (is_svg(path) && count > 0 && end[count - 1] == '\n')
        count--;
    return count >= size && memcmp(end + count - size, wanted, size) == 0;
}

/* Put the picture in its place. */
enum status plot_place(const struct plot *plot)
{
    if (!picture_is_whole(plot->output))
        return status_set(STATUS_FAILED, "plot: gnuplot left '%s' without its end (is the disk full?)", plot->path);
    return rename(plot->output, plot->path) == 0 ? STATUS_OK : plot_file_failed(plot->path);
}

enum status plot_draw(struct plot *plot, const char *plots_directory, const char *script)
{
    enum status status = plot_run(plot, plots_directory, script);
    return status == STATUS_OK ? plot_place(plot) : status;
}
