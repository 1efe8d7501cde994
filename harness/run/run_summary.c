/* The results of a run (run_summary.h). */
#include "run/run_summary.h"
#include "files/paths.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "echoes/echo_data.h"
#include "text/shown_text.h"
#include "text/text_append.h"
#include "show/plot_points.h"
#include "show/table.h"

enum { BOUNDS = 4, WIDTH_MOST = 132, LINE = 600, REFUSALS_MOST = 12 };
static char bounds[BOUNDS][LINE] = {"1e-1", "1e-2", "1e-3", "1e-4"};

struct run {
    struct results rows; /* those of the run, by scene */
    const struct spec *specs;
    int spec_count;
};

static bool is_named(const struct measurement *row, const char *algorithm)
{
    return strcmp(row->algorithm, algorithm) == 0;
}

static bool is_of(const struct measurement *row, const struct scene *scene, const struct spec *spec)
{
    return strcmp(row->scene, scene->name) == 0 && is_named(row, spec->algorithm->name)
           && strcmp(row->options, spec->text) == 0 && strcmp(row->precision, precision_name(spec->precision)) == 0;
}

/* "2.9ms" */
static void time_append(char *text, size_t size, double seconds)
{
    static const char *const units[] = {"s", "ms", "us"};
    int unit = 0;
    for (; unit < 2 && seconds < 0.995; unit++)
        seconds *= 1e3;
    text_append(text, size, seconds < 9.95 ? "%.1f%s" : "%.0f%s", seconds, units[unit]);
}

/* "bp_farrow 2.9ms 38x", with its settings where the run has several of the algorithm. */
static void cell_format(const struct run *run, const struct measurement *row, char *text, size_t size)
{
    const double speed_up = row->control_s / row->run_s;
    int same = 0;
    for (int k = 0; k < run->spec_count; k++)
        same += is_named(row, run->specs[k].algorithm->name);
    if (same > 1)
        measurement_spec(row, text, size);
    else
        snprintf(text, size, "%s", row->algorithm);
    text_append(text, size, " ");
    time_append(text, size, row->run_s);
    if (isfinite(speed_up))
        text_append(text, size, speed_up < 9.95 ? " %.1fx" : " %.0fx", speed_up);
}

static void none_format(const struct run *run, const char *scene, char *text, size_t size)
{
    double least = INFINITY;
    for (int k = 0; k < run->rows.csv.row_count; k++) {
        const struct measurement *row = &run->rows.measurements[k];
        if (strcmp(row->scene, scene) == 0 && !is_named(row, "reference"))
            least = fmin(least, row->error);
    }
    if (isfinite(least))
        snprintf(text, size, "none: least %.1e", least);
    else
        snprintf(text, size, "no image");
}

/* A line of a scene, or of the titles: cells behind bars, in their columns; further left where the rest needs the
   room, and on a next line without room. */
static void line_print(FILE *stream, const char *scene, char cells[BOUNDS][LINE], int width, int first)
{
    char line[LINE];
    int rest = 0;
    snprintf(line, sizeof line, "%s", scene);
    shown_make(line);
    for (int k = 0; k < BOUNDS; k++)
        rest += (int)strlen(cells[k]) + 1;
    for (int k = 0; k < BOUNDS; k++) {
        const int column = first + k * (width - first) / BOUNDS, length = (int)strlen(cells[k]);
        int used = (int)strlen(line);
        if (used + 1 + length > width) {
            fprintf(stream, "%s\n", line);
            *line = '\0';
            used = 0;
        }
        const int room = width + 1 - rest, at = column < room ? column : room;
        text_append(line, sizeof line, "%*s|%s", at > used ? at - used - 1 : 0, "", cells[k]);
        rest -= length + 1;
    }
    fprintf(stream, "%s\n", line);
}

static void scene_print(FILE *stream, const struct run *run, const char *scene, int width, int first)
{
    char cells[BOUNDS][LINE];
    const struct measurement *last = NULL;
    for (int k = 0; k < BOUNDS; k++) {
        const struct measurement *best = scene_fastest(&run->rows, scene, strtod(bounds[k], NULL));
        if (k > 0 && best == last)
            snprintf(cells[k], sizeof cells[k], "=");
        else if (best)
            cell_format(run, best, cells[k], sizeof cells[k]);
        else
            none_format(run, scene, cells[k], sizeof cells[k]);
        last = best;
    }
    line_print(stream, scene, cells, width, first);
}

/* ---- refusals ---- */

/* Length of "rma_" in an algorithm's name. */
static int family_length(const char *name)
{
    return (int)strcspn(name, "_") + (strchr(name, '_') != NULL);
}

/* "one_receiver": the condition that a refusal names, or nothing. */
static void condition_name(const char *reason, char *text, size_t size)
{
    const char *begin = strstr(reason, "condition ");
    begin = begin ? begin + strlen("condition ") : "";
    snprintf(text, size, "%.*s", (int)strcspn(begin, ":"), begin);
}

/* "Refused: wk_* on 16 scenes (one_receiver), ..." */
static void refused_print(FILE *stream, const struct run *run)
{
    struct {
        const struct measurement *row, *last; /* the first and the latest */
        int scenes;
        bool several; /* several algorithms of the family */
    } list[REFUSALS_MOST];
    char text[1500] = "", name[2][80];
    int count = 0;
    for (int k = 0; k < run->rows.csv.row_count; k++) {
        const struct measurement *row = &run->rows.measurements[k];
        int n = 0;
        if (strcmp(row->status, "unsupported") != 0)
            continue;
        condition_name(row->reason, name[0], sizeof name[0]);
        for (; n < count; n++) {
            condition_name(list[n].row->reason, name[1], sizeof name[1]);
            if (strcmp(name[0], name[1]) == 0
                && strncmp(row->algorithm, list[n].row->algorithm, (size_t)family_length(row->algorithm)) == 0)
                break;
        }
        if (n == REFUSALS_MOST)
            continue;
        if (n == count) {
            list[count].row = list[count].last = row;
            list[count].several = false;
            list[count++].scenes = 1;
        }
        list[n].scenes += strcmp(list[n].last->scene, row->scene) != 0;
        list[n].several |= !is_named(row, list[n].row->algorithm);
        list[n].last = row;
    }
    for (int n = 0; n < count; n++) {
        const char *algorithm = list[n].row->algorithm;
        condition_name(list[n].row->reason, name[0], sizeof name[0]);
        if (n == 0)
            text_append(text, sizeof text, "Refused (%s check SCENE: why): ", program_called());
        text_append(text, sizeof text, "%s%.*s%s on %d %s%s%s%s", n ? ", " : "",
                    list[n].several ? family_length(algorithm) : (int)strlen(algorithm), algorithm,
                    list[n].several ? "*" : "", list[n].scenes, list[n].scenes > 1 ? "scenes" : "scene",
                    *name[0] ? " (" : "", name[0], *name[0] ? ")" : "");
    }
    if (count > 0)
        table_text(stream, 0, text);
}

/* ---- quality of times and choices ---- */

/* A choice compared with the fastest of the others within the same error. */
static void auto_print(FILE *stream, const struct run *run)
{
    const struct measurement *worst = NULL;
    double most = 0;
    int count = 0, fast = 0;
    for (int k = 0; k < run->rows.csv.row_count; k++) {
        const struct measurement *row = &run->rows.measurements[k], *best = NULL;
        const char *error = strstr(row->options, "error=");
        if (is_named(row, "auto") && error && row->run_s > 0)
            best = scene_fastest(&run->rows, row->scene, strtod(error + strlen("error="), NULL));
        if (!best || is_named(best, "auto"))
            continue;
        const double ratio = row->run_s / best->run_s;
        count++;
        fast += ratio <= 1.1;
        if (ratio > most) {
            most = ratio;
            worst = row;
        }
    }
    if (count > 0) {
        char text[400];
        snprintf(text, sizeof text,
                 "auto takes at most %.1f times as long as the fastest (%.200s), at most 1.1 times on %d of %d scenes",
                 most, worst->scene, fast, count);
        shown_make(text);
        table_text(stream, 0, text);
    }
}

static void times_print(FILE *stream, const struct run *run, const char *spent)
{
    char text[400];
    int noisy = 0, timed = 0;
    for (int k = 0; k < run->rows.csv.row_count; k++) {
        timed += run->rows.measurements[k].run_s > 0;
        noisy += is_noisy(&run->rows.measurements[k]);
    }
    snprintf(text, sizeof text, "%s", spent);
    if (noisy > 0)
        text_append(text, sizeof text, "%s%d of %d times noisy (~)", *spent ? "; " : "", noisy, timed);
    table_text(stream, 0, text);
}

void run_summary_print(FILE *stream, const struct results *results, int scene_count, const struct scene *scenes,
                       int spec_count, const struct spec *specs, const char *spent)
{
    struct run run = {.specs = specs, .spec_count = spec_count};
    int width = table_width(stream), longest = 0;
    width = width < WIDTH_MOST ? width : WIDTH_MOST;
    run.rows.measurements = calloc((size_t)results->csv.row_count + 1, sizeof *run.rows.measurements);
    if (!run.rows.measurements)
        return;
    for (int s = 0; s < scene_count; s++) {
        longest = (int)strlen(scenes[s].name) > longest ? (int)strlen(scenes[s].name) : longest;
        for (int row = 0; row < results->csv.row_count; row++)
            for (int k = 0; k < spec_count; k++)
                if (is_of(&results->measurements[row], &scenes[s], &specs[k]))
                    run.rows.measurements[run.rows.csv.row_count++] = results->measurements[row];
    }
    const int first = (longest < width / 5 ? longest : width / 5) + 1;
    fputs("\nFastest within a relative error: time, speed-up over the scalar loop\n"
          "(=: the same as to its left)\n",
          stream);
    line_print(stream, "scene", bounds, width, first);
    for (int s = 0; s < scene_count; s++)
        scene_print(stream, &run, scenes[s].name, width, first);
    refused_print(stream, &run);
    auto_print(stream, &run);
    times_print(stream, &run, spent);
    free(run.rows.measurements);
}
