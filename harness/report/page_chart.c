/* Charts of a page as SVG (page_chart.h). */
#include "report/page_chart.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "files/folder.h"
#include "files/paths.h"
#include "text/text_append.h"
#include "show/chart.h"
#include "show/table.h"

/* --- Commands --------------------------------------------------------------------------------------------------- */

void measured_again(const struct measurement *row, char *text, size_t size)
{
    char word[1000];
    snprintf(word, sizeof word, "%s/%.500s.cfg", data_path(DATA_SCENES), row->scene);
    const bool shipped = place_is_file(word);
    snprintf(word, sizeof word, "%.500s%s", row->scene, shipped ? "" : ".cfg");
    snprintf(text, size, "%s run ", program_called());
    text_append_word(text, size, word);
    text_append(text, size, " --algorithm ");
    measurement_spec(row, word, sizeof word);
    text_append_word(text, size, word);
    text_append(text, size, " -o results/again");
}

/* --- Points and axes -------------------------------------------------------------------------------------------- */

/* A point by gnuplot's number of its filled ones. */
static void mark_write(FILE *stream, const struct family *family, bool open, double x, double y, double size)
{
    static const char *const paths[] = {[1] = "M-1 0H1M0 -1V1",
                                        [2] = "M-.8-.8L.8 .8M-.8 .8L.8-.8",
                                        [3] = "M-1 0H1M0 -1V1M-.7-.7L.7 .7M-.7 .7L.7-.7",
                                        [5] = "M-.8-.8H.8V.8H-.8Z",
                                        [7] = "M-.9 0A.9 .9 0 1 1 .9 0A.9 .9 0 1 1-.9 0Z",
                                        [9] = "M0-1.1L1 .7H-1Z",
                                        [11] = "M0 1.1L1-.7H-1Z",
                                        [13] = "M0-1.2L1.1 0L0 1.2L-1.1 0Z",
                                        [15] = "M0-1.1L1-.3L.6 .9H-.6L-1-.3Z"};
    const bool known = family->point > 0 && family->point < (int)(sizeof paths / sizeof *paths) && paths[family->point];
    const char *path = paths[known ? family->point : 3];
    const bool lines = !strchr(path, 'Z');
    fprintf(stream, "<path transform=\"translate(%.1f %.1f) scale(%g)\" fill=\"%s\" stroke=\"%s\" d=\"%s\"/>", x, y,
            size, lines || open ? "#fff" : family->colour, family->colour, path);
}

/* Lines at powers of ten, on short axes also at 2 and 5 of them, with their texts. Relative costs appear as
   speed-up. */
static void axis_write(FILE *stream, const struct chart *chart, bool vertical, double text_px)
{
    const double low = vertical ? chart->error_low : chart->cost_low,
                 high = vertical ? chart->error_high : chart->cost_high, decades = log10(high / low);
    double before = -INFINITY;
    for (int decade = (int)floor(log10(low)); decade <= (int)ceil(log10(high)); decade++)
        for (int k = 0; k < (decades < 1.7 ? 3 : 1); k++) {
            const double value = (double[]){1, 2, 5}[k] * pow(10, decade);
            const double at = vertical ? chart_y(chart, value) : chart_x(chart, value);
            if (!(value >= low && value <= high))
                continue;
            fprintf(stream,
                    vertical ? "<path class=\"grid\" d=\"M0 %.1fH%.1f\"/>"
                             : "<path class=\"grid\" d=\"M%.1f 0V%.1f\"/>",
                    at, vertical ? chart->width : chart->height);
            if (fabs(at - before) < (vertical ? 1.8 : 4) * text_px)
                continue;
            before = at;
            if (vertical)
                fprintf(stream, "<text class=\"end\" x=\"-4\" y=\"%.1f\">%de%d</text>", at + 0.35 * text_px,
                        (int[]){1, 2, 5}[k], decade);
            else
                fprintf(stream, "<text class=\"middle\" x=\"%.1f\" y=\"%.1f\">%g%s</text>", at,
                        chart->height + 1.25 * text_px, chart->relative ? 1 / value : value,
                        chart->relative ? "x" : "");
        }
}

/* The front as steps: the error reached within a time. */
static void front_write(FILE *stream, const struct chart *chart, const struct points *points)
{
    for (int k = 0; k < points->front_count; k++) {
        const struct measurement *row = points->list[points->front[k]].row;
        const double x = chart_x(chart, chart_cost(chart, row)), y = chart_y(chart, row->error);
        if (isfinite(x))
            fprintf(stream, k ? "H%.1fV%.1f" : "<path class=\"front\" d=\"M%.1f %.1f", x, y);
    }
    fputs(points->front_count ? "\"/>\n" : "", stream);
}

static void row_tell(const struct measurement *row, char *text, size_t size)
{
    measurement_spec(row, text, size);
    text_append(text, size, ": error %.1e, %s", row->error, cell_run_time(row).text);
    if (row->control_s > 0)
        text_append(text, size, ", %s", cell_significant(row->control_s / row->run_s, "x").text);
}

/* --- One scene -------------------------------------------------------------------------------------------------- */

static void point_write(struct page *page, const struct families *families, const struct chart *chart,
                        const struct point *point)
{
    const struct family *family = family_of(families, point->row->algorithm);
    const double y = chart_y(chart, point->row->error);
    char told[700], command[1500];
    double low, high;
    row_tell(point->row, told, sizeof told);
    fputs("<g", page->stream);
    if (point->on_front) {
        fputs(" class=\"point\" tabindex=\"0\" role=\"img\" aria-label=\"", page->stream);
        page_text(page, told);
        fputc('"', page->stream);
    }
    fputs("><title>", page->stream);
    page_text(page, told);
    if (point->on_front) {
        measured_again(point->row, command, sizeof command);
        fputc('\n', page->stream);
        page_text(page, command);
    }
    fputs("</title>", page->stream);
    measurement_interval(point->row, &low, &high);
    if (high > low)
        fprintf(page->stream, "<path stroke=\"%s\" d=\"M%.1f %.1fH%.1f\"/>", family->colour, chart_x(chart, low), y,
                chart_x(chart, high));
    mark_write(page->stream, family, strcmp(point->row->precision, "double") == 0, chart_x(chart, point->row->run_s), y,
               4.5);
    fputs("</g>\n", page->stream);
}

enum status page_chart(struct page *page, const struct families *families, const struct points *points)
{
    enum { LEFT = 46, RIGHT = 8, TOP = 8, BOTTOM = 38, WIDTH = 520, HEIGHT = 350 };
    if (points->count == 0)
        return STATUS_OK;
    const struct chart chart = chart_fit(points, 1, false, WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM);
    struct chart_label *labels = calloc((size_t)points->count + 1, sizeof *labels);
    if (!labels)
        return status_set(STATUS_FAILED, "%s: no memory for %d names", points->scene, points->count);
    fprintf(page->stream, "<svg class=\"chart\" viewBox=\"%d %d %d %d\" role=\"group\" aria-label=\"", -LEFT, -TOP,
            WIDTH, HEIGHT);
    page_text(page, points->scene);
    fprintf(page->stream, ": error against run time, %d points, %d on the Pareto front\">\n", points->count,
            points->front_count);
    axis_write(page->stream, &chart, true, 11);
    axis_write(page->stream, &chart, false, 11);
    fprintf(page->stream, "<text class=\"middle\" x=\"%g\" y=\"%g\">run time (s)</text>\n", chart.width / 2,
            chart.height + 30);
    front_write(page->stream, &chart, points);
    if (isfinite(points->control_s))
        fprintf(page->stream,
                "<path class=\"loop\" d=\"M%.1f 0V%g\"><title>the scalar reference loop: %s</title></path>\n",
                chart_x(&chart, points->control_s), chart.height, cell_time(points->control_s).text);
    const int count = chart_label(&chart, points, 6.6, labels);
    for (int k = 0; k < count; k++) {
        const struct point *point = &points->list[labels[k].point];
        const double x = chart_x(&chart, point->row->run_s), y = chart_y(&chart, point->row->error);
        if (labels[k].apart)
            fprintf(page->stream, "<path class=\"lead\" d=\"M%.1f %.1fL%.1f %.1f\"/>", x, y,
                    fmin(fmax(x, labels[k].x), labels[k].x + labels[k].width),
                    labels[k].y + (labels[k].y < y ? 5 : -5));
        fprintf(page->stream, "<text fill=\"%s\" x=\"%.1f\" y=\"%.1f\">",
                family_of(families, point->row->algorithm)->colour, labels[k].x, labels[k].y + 4);
        page_text(page, labels[k].text);
        fputs("</text>\n", page->stream);
    }
    for (int k = 0; k < points->count; k++)
        point_write(page, families, &chart, &points->list[k]);
    fputs("</svg>\n", page->stream);
    free(labels);
    return STATUS_OK;
}

/* --- All scenes ------------------------------------------------------------------------------------------------- */

static void panel_write(struct page *page, const struct families *families, const struct chart *chart,
                        const struct points *points, int number)
{
    fprintf(page->stream, "<a href=\"#scene-%d\">", number);
    page_text(page, points->scene);
    fprintf(page->stream, "<svg viewBox=\"-28 -4 182 108\" role=\"img\" aria-label=\"");
    page_text(page, points->scene);
    fputs(": error against speed-up", page->stream);
    for (int k = 0; k < points->front_count; k++) {
        char told[700];
        row_tell(points->list[points->front[k]].row, told, sizeof told);
        fputs(k ? "; " : "; the front: ", page->stream);
        page_text(page, told);
    }
    fputs("\">", page->stream);
    axis_write(page->stream, chart, true, 8.5);
    axis_write(page->stream, chart, false, 8.5);
    front_write(page->stream, chart, points);
    for (int k = 0; k < points->count; k++) {
        const struct measurement *row = points->list[k].row;
        const double x = chart_x(chart, chart_cost(chart, row));
        if (isfinite(x))
            mark_write(page->stream, family_of(families, row->algorithm), strcmp(row->precision, "double") == 0, x,
                       chart_y(chart, row->error), 3);
    }
    fputs("</svg></a>\n", page->stream);
}

static bool algorithm_seen(const struct points *scenes, int s, int k)
{
    for (int t = 0; t <= s; t++)
        for (int n = 0; n < (t < s ? scenes[t].count : k); n++)
            if (strcmp(scenes[t].list[n].row->algorithm, scenes[s].list[k].row->algorithm) == 0)
                return true;
    return false;
}

void page_overview(struct page *page, const struct families *families, const struct points *scenes, int count)
{
    const struct chart chart = chart_fit(scenes, count, true, 150, 88);
    if (!(chart.cost_low > 0 && chart.cost_high > chart.cost_low))
        return;
    fputs("<div class=\"overview\">\n", page->stream);
    for (int s = 0; s < count; s++)
        if (scenes[s].count > 0)
            panel_write(page, families, &chart, &scenes[s], s + 1);
    fputs("</div>\n<p class=\"legend\">\n", page->stream);
    for (int s = 0; s < count; s++)
        for (int k = 0; k < scenes[s].count; k++) {
            const char *name = scenes[s].list[k].row->algorithm;
            if (algorithm_seen(scenes, s, k))
                continue;
            fputs("<span><svg viewBox=\"-6 -6 12 12\" aria-hidden=\"true\">", page->stream);
            mark_write(page->stream, family_of(families, name), false, 0, 0, 4.5);
            fputs("</svg> ", page->stream);
            page_text(page, name);
            fputs("</span>\n", page->stream);
        }
    fputs("</p>\n", page->stream);
}

/* ---- colours ---- */

void families_read(const char *plots_directory, struct families *families)
{
    char path[4096], line[200];
    *families = (struct families){.list = {{"others", "#666666", 3}}};
    snprintf(path, sizeof path, "%s/families.gp", plots_directory);
    FILE *file = fopen(path, "r");
    while (file && families->count < FAMILIES_MOST && fgets(line, sizeof line, file)) {
        struct family family;
        if (sscanf(line, "%31s #%6[0-9a-f] %d", family.name, family.colour + 1, &family.point) == 3) {
            family.colour[0] = '#';
            families->list[families->count++] = family;
        }
    }
    families->count += families->count == 0;
    if (file)
        fclose(file);
}

const struct family *family_of(const struct families *families, const char *algorithm)
{
    for (int k = 0; k < families->count; k++)
        if (strcmp(families->list[k].name, algorithm) == 0)
            return &families->list[k];
    return &families->list[families->count - 1];
}
