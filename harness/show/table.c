/* The terminal's table of measurements. */
#include "show/table.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "data/shown_text.h"
#include "measure/outcome.h"

#define WIDTH      110
#define SPEC_WIDTH 34
/* Titles, units and values alike: algorithm, time, speed-up, rate, three errors, width, PSLR, ISLR. */
#define LAYOUT "  %-34s %8s %8s %9s %7s %7s %7s %6s %6s %6s\n"

/* The scene whose heading stands above the last row: there is one terminal, and so one table. */
static char last_scene[256];

struct cell cell_significant(double value, const char *unit)
{
    struct cell cell = {"-"};
    if (isfinite(value))
        snprintf(cell.text, sizeof cell.text, value < 1 ? "%.2f%s" : value < 999.5 ? "%.3g%s" : "%.0f%s", value, unit);
    return cell;
}

struct cell cell_time(double seconds)
{
    if (seconds < 0.9995e-3)
        return cell_significant(1e6 * seconds, " us");
    return seconds < 0.9995 ? cell_significant(1e3 * seconds, " ms") : cell_significant(seconds, " s");
}

/* Algorithms that sum pairs are rated by pairs, the others by operations. */
static struct cell cell_rate(const struct measurement *row)
{
    return row->pairs > 0 ? cell_significant(1e-9 * row->pairs / row->run_s, " Gp/s")
                          : cell_significant(1e-9 * row->flops / row->run_s, " GF/s");
}

static struct cell cell_error(double value)
{
    struct cell cell = {"-"};
    if (isfinite(value))
        snprintf(cell.text, sizeof cell.text, "%.1e", value);
    return cell;
}

static struct cell cell_fixed(double value)
{
    struct cell cell = {"-"};
    if (isfinite(value))
        snprintf(cell.text, sizeof cell.text, "%.2f", value);
    return cell;
}

/* Text broken at blanks, each line behind `indent` blanks; a word longer than a line is broken anywhere. */
static void print_wrapped(FILE *stream, int indent, const char *text)
{
    int room = WIDTH - indent;
    while (*text) {
        int length = (int)strcspn(text, "\n");
        if (length > room) {
            length = room;
            while (length > 0 && text[length] != ' ')
                length--;
            length = length > 0 ? length : room;
        }
        fprintf(stream, "%*s%.*s\n", indent, "", length, text);
        text += length;
        text += strspn(text, " \n");
    }
}

void table_header(FILE *stream)
{
    *last_scene = '\0';
    fputs("time      median seconds from raw echoes to complex image\n"
          "speed-up  against the scalar reference loop timed beside, which takes out the machine's momentary speed\n"
          "rate      10^9 pixel-pulse pairs (Gp/s) or, where none are summed, operations (GF/s) a second\n"
          "error     against the exact image, relative L2; +gain: after one best complex gain; phase: rms over the\n"
          "          strong pixels\n"
          "width     of the targets' main lobes at -3 dB, PSLR and ISLR of their azimuth slices (medians)\n\n",
          stream);
    fprintf(stream, LAYOUT, "algorithm", "time", "speed-up", "rate", "error", "+gain", "phase", "width", "PSLR",
            "ISLR");
    fprintf(stream, LAYOUT, "", "", "", "", "", "", "rad", "mm", "dB", "dB");
}

void measurement_spec(const struct measurement *row, char *text, size_t size)
{
    bool other_precision = strcmp(row->precision, "float") != 0;
    snprintf(text, size, "%s%s%s%s%s", row->algorithm, *row->options || other_precision ? ":" : "", row->options,
             *row->options && other_precision ? "," : "", other_precision ? "precision=double" : "");
}

void table_row(FILE *stream, const struct measurement *row)
{
    if (strcmp(last_scene, row->scene) != 0) {
        char scene[WIDTH + 1];
        snprintf(scene, sizeof scene, "%s", row->scene);
        shown_make(scene);
        fprintf(stream, "\n%s\n", scene);
        snprintf(last_scene, sizeof last_scene, "%s", row->scene);
    }
    char spec[512];
    measurement_spec(row, spec, sizeof spec);
    shown_make(spec);
    bool ok = strcmp(row->status, "ok") == 0, own_line = !ok || strlen(spec) > SPEC_WIDTH;
    if (own_line)
        print_wrapped(stream, 2, spec);
    if (ok) {
        fprintf(stream, LAYOUT, own_line ? "" : spec, cell_time(row->run_s).text,
                cell_significant(row->control_s / row->run_s, "x").text, cell_rate(row).text,
                cell_error(row->error).text, cell_error(row->error_gain).text, cell_error(row->phase_rms_rad).text,
                cell_fixed(1e3 * row->width_m).text, cell_fixed(row->pslr_db).text, cell_fixed(row->islr_db).text);
        const char *warning = strstr(row->reason, OUTCOME_WARNING);
        if (warning) {
            char text[1024];
            snprintf(text, sizeof text, "%s", warning);
            shown_make(text);
            print_wrapped(stream, 4, text);
        }
    } else {
        char text[1024];
        snprintf(text, sizeof text, "%s: %s", row->status, row->reason);
        shown_make(text);
        print_wrapped(stream, 4, text);
    }
}

void table_works_header(FILE *stream)
{
    fprintf(stream, "  %-*s FLOPs counted, by the papers' formulas\n", SPEC_WIDTH, "");
}

void table_work(FILE *stream, const char *spec, const struct work *work)
{
    fprintf(stream, "  %-*s %6.1e", SPEC_WIDTH, spec, work->flops);
    for (int k = 0; k < (int)(sizeof work->published / sizeof *work->published) && work->published[k].source; k++)
        fprintf(stream, ", %.1e %s", work->published[k].flops, work->published[k].source);
    fputs("\n", stream);
}
