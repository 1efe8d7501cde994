/* The terminal's table of measurements. */
#include "show/table.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "text/number.h"
#include "text/shown_text.h"
#include "text/text_append.h"
#include "measure/outcome.h"
#include "imaging/spec.h"

enum { WIDTH_WIDE = 110, WIDTH_LEAST = 80 };
enum { REFUSALS = 8 }; /* distinct reasons of one scene */

/* There is one terminal, and so one table. */
static struct {
    int width, spec_width;
    bool brief;      /* one line a scene */
    bool titled;     /* the column titles are printed */
    char scene[256]; /* of the rows since its heading */
    bool blind;      /* the last titles were for a scene without targets */
    int images, refused, failed;
    struct {
        char reason[600], names[300];
    } refusals[REFUSALS]; /* of the scene, the reason without the algorithm's name */
    char warned[4000];    /* the scene's warnings so far, each with a newline */
} table = {.width = WIDTH_WIDE, .spec_width = 34};

struct cell cell_significant(double value, const char *unit)
{
    struct cell cell = {"-"};
    if (isfinite(value))
        snprintf(cell.text, sizeof cell.text, value < 1 ? "%.2f%s" : value < 999.5 ? "%.3g%s" : "%.0f%s", value, unit);
    return cell;
}

struct cell cell_time(double seconds)
{
    if (seconds <= 0)
        return cell_significant(NAN, "");
    if (seconds < 0.9995e-3)
        return cell_significant(1e6 * seconds, " us");
    return seconds < 0.9995 ? cell_significant(1e3 * seconds, " ms") : cell_significant(seconds, " s");
}

bool is_noisy(const struct measurement *row)
{
    return strstr(row->reason, OUTCOME_NOISE) != NULL;
}

struct cell cell_run_time(const struct measurement *row)
{
    struct cell cell = cell_time(row->run_s);
    if (is_noisy(row))
        strcat(cell.text, "~");
    return cell;
}

struct cell cell_place(double place, double step)
{
    const double digits = place == 0 ? 0 : ceil(log10(fabs(place) / step)) + 2;
    struct cell cell;
    snprintf(cell.text, sizeof cell.text, "%.*g", (int)fmin(fmax(digits, 6), 15), place == 0 ? 0 : place); /* no -0 */
    return cell;
}

/* The rate is in pairs for algorithms that sum pairs, in operations for the others. */
static struct cell cell_rate(const struct measurement *row)
{
    return row->pairs > 0 ? cell_significant(1e-9 * row->pairs / row->run_s, " Gp/s")
                          : cell_significant(1e-9 * row->flops / row->run_s, " GF/s");
}

struct cell cell_metric(const struct column *column, const struct measurement *row)
{
    const double value = column->shown.scale * *(const double *)((const char *)row + column->offset);
    struct cell cell = {"-"};
    if (!column->shown.format)
        return cell_significant(value, "");
    if (isfinite(value))
        snprintf(cell.text, sizeof cell.text, column->shown.format, value);
    return cell;
}

bool measurement_is_blind(const struct measurement *row)
{
    return strstr(row->reason, OUTCOME_NO_TARGETS) && isfinite(row->entropy);
}

/* Text broken at blanks, each line behind `indent` blanks; a word longer than a line is broken anywhere. */
static void wrapped_print(FILE *stream, int width, int indent, const char *text)
{
    int room = width - indent;
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

static void print_wrapped(FILE *stream, int indent, const char *text)
{
    wrapped_print(stream, table.width, indent, text);
}

/* The width of a metric's column; 0: not shown. */
static int metric_width(const struct column *column, bool blind)
{
    if (!column->shown.brief || !column_is_shown(column, !blind) || (column->shown.wide && table.width < WIDTH_WIDE))
        return 0;
    return column->shown.of == SHOWN_OF_ALL ? 7 : 6;
}

/* The columns ahead of the metrics: SPEC, time, speed-up and, where there is room, rate. */
static void line_begin(FILE *stream, const char *spec, const char *time, const char *speed_up, const char *rate)
{
    fprintf(stream, "  %s%*s %8s %8s", spec, table.spec_width - (int)shown_columns(spec), "", time, speed_up);
    if (table.width >= WIDTH_WIDE)
        fprintf(stream, " %9s", rate);
}

/* The metrics of a row. Without a row, their units or titles; of a blind scene only those that differ. */
static void line_end(FILE *stream, bool blind, const struct measurement *row, bool units)
{
    for (const struct column *column = measurement_columns; column->name; column++) {
        const int width = metric_width(column, blind);
        const char *title = blind && column->shown.of == SHOWN_OF_ALL ? "" : column->shown.brief;
        if (width)
            fprintf(stream, " %*s", width, row ? cell_metric(column, row).text : units ? column->shown.unit : title);
    }
    fputc('\n', stream);
}

static void titles_print(FILE *stream)
{
    line_begin(stream, "algorithm", "time", "speed-up", "rate");
    line_end(stream, false, NULL, false);
    line_begin(stream, "", "", "", "");
    line_end(stream, false, NULL, true);
}

/* Columns of the terminal: from COLUMNS, else from the terminal, else those of a wide table. */
int table_width(FILE *stream)
{
    const char *given = getenv("COLUMNS");
    struct winsize size;
    long long columns = 0;
    if (given && whole_read(given, 1, 10000, &columns))
        return columns < WIDTH_LEAST ? WIDTH_LEAST : (int)columns;
    if (!isatty(fileno(stream)) || ioctl(fileno(stream), TIOCGWINSZ, &size) != 0 || size.ws_col == 0)
        return WIDTH_WIDE;
    return size.ws_col < WIDTH_LEAST ? WIDTH_LEAST : size.ws_col;
}

void table_text(FILE *stream, int indent, const char *text)
{
    wrapped_print(stream, table_width(stream), indent, text);
}

void table_columns(FILE *stream)
{
    fputs("time      median seconds from the echoes in memory to the complex image; with ~\n"
          "          it is noisy: the middle half of the runs spans more than 10 % of it,\n"
          "          or other work had the processors, or the machine's speed changed\n"
          "speed-up  against the scalar reference loop timed beside, which takes out the\n"
          "          machine's momentary speed\n"
          "rate      10^9 pixel-record pairs (Gp/s) or, where none are summed, operations\n"
          "          (GF/s) a second; as +gain only where lines have 110 columns\n"
          "error     against the exact image, relative L2; +gain: after one best gain;\n"
          "          phase: rms over the strong pixels\n"
          "width     of the targets' main lobes at -3 dB, PSLR and ISLR of their azimuth\n"
          "          slices (medians); where a scene has no targets: the image's entropy,\n"
          "          contrast, and peak over median\n",
          stream);
}

void table_begin(FILE *stream, bool brief)
{
    *table.scene = '\0';
    table.brief = brief;
    table.titled = false;
    table.width = table_width(stream) < WIDTH_WIDE ? WIDTH_LEAST : WIDTH_WIDE;
    table.spec_width = table.width == WIDTH_WIDE ? WIDTH_WIDE - 31 : WIDTH_LEAST - 20;
    for (const struct column *column = measurement_columns; column->name; column++)
        table.spec_width -= metric_width(column, false) ? 1 + metric_width(column, false) : 0;
}

void measurement_spec(const struct measurement *row, char *text, size_t size)
{
    bool other_precision = strcmp(row->precision, "float") != 0;
    snprintf(text, size, "%s%s%s%s%s", row->algorithm, *row->options || other_precision ? ":" : "", row->options,
             *row->options && other_precision ? "," : "", other_precision ? "precision=double" : "");
}

static void text_print(FILE *stream, const char *before, const char *text)
{
    char shown[1100];
    snprintf(shown, sizeof shown, "%s%s", before, text);
    shown_make(shown);
    print_wrapped(stream, 4, shown);
}

/* "warning: condition ghost: ..." becomes ghost, "warning: target 5: ..." becomes target 5 not measured; others have no
   name. */
static void warned_names(char *text, size_t size)
{
    static const char *const before[] = {OUTCOME_WARNING, "condition "};
    *text = '\0';
    for (const char *line = table.warned; *line; line += strcspn(line, "\n") + 1) {
        const char *name = line;
        for (size_t k = 0; k < sizeof before / sizeof *before; k++)
            name += strncmp(name, before[k], strlen(before[k])) == 0 ? strlen(before[k]) : 0;
        const size_t length = strcspn(name, ":\n");
        if (name[length] == ':')
            text_append(text, size, "%s%.*s%s", *text ? ", " : "", (int)length, name,
                        strncmp(name, "target ", strlen("target ")) == 0 ? " not measured" : "");
    }
}

void table_scene_end(FILE *stream)
{
    char text[1000], names[600];
    if (table.brief && *table.scene) {
        warned_names(names, sizeof names);
        snprintf(text, sizeof text, "%-23.80s %3d images", table.scene, table.images);
        if (table.refused > 0)
            text_append(text, sizeof text, ", %d refused", table.refused);
        if (table.failed > 0)
            text_append(text, sizeof text, ", %d failed", table.failed);
        if (*names)
            text_append(text, sizeof text, ", warned: %s", names);
        shown_make(text);
        table_text(stream, 0, text);
    }
    for (int k = 0; k < REFUSALS && *table.refusals[k].reason && !table.brief; k++) {
        snprintf(text, sizeof text, "refused: %s: %s", table.refusals[k].names, table.refusals[k].reason);
        shown_make(text);
        print_wrapped(stream, 2, text);
    }
    memset(table.refusals, 0, sizeof table.refusals);
    *table.scene = '\0';
}

void table_scene(FILE *stream, const char *name, const char *what)
{
    char scene[WIDTH_WIDE + 1];
    table_scene_end(stream);
    snprintf(table.scene, sizeof table.scene, "%s", name);
    table.blind = false;
    table.images = table.refused = table.failed = 0;
    *table.warned = '\0';
    if (table.brief)
        return;
    if (!table.titled)
        titles_print(stream);
    table.titled = true;
    snprintf(scene, sizeof scene, "%s", name);
    shown_make(scene);
    fprintf(stream, "\n%s%s%s\n", scene, *what ? ": " : "", what);
}

void table_warning(FILE *stream, const char *text)
{
    text_append(table.warned, sizeof table.warned, "%s\n", text);
    if (!table.brief)
        text_print(stream, "", text);
}

static bool is_warned(const char *text)
{
    const size_t length = strlen(text);
    for (const char *line = table.warned; *line; line += strcspn(line, "\n") + 1)
        if (strcspn(line, "\n") == length && strncmp(line, text, length) == 0)
            return true;
    return false;
}

bool warning_next(const char **at, char *text, size_t size)
{
    for (const char *warning; (warning = strstr(*at, OUTCOME_WARNING));) {
        const char *end = strstr(warning, "; " OUTCOME_WARNING);
        *at = end ? end + 2 : "";
        snprintf(text, size, "%.*s", end ? (int)(end - warning) : (int)size - 1, warning);
        if (strncmp(text, OUTCOME_NOISE, strlen(OUTCOME_NOISE)) != 0)
            return true;
    }
    return false;
}

/* Print the warnings that were not printed yet. */
static void warnings_print(FILE *stream, const char *reason)
{
    char text[1024];
    while (warning_next(&reason, text, sizeof text))
        if (!is_warned(text))
            table_warning(stream, text);
}

static void ok_print(FILE *stream, const struct measurement *row, const char *spec)
{
    if (table.brief) {
        warnings_print(stream, row->reason);
        return;
    }
    const bool own_line = shown_columns(spec) > (size_t)table.spec_width;
    const bool blind = measurement_is_blind(row);
    if (blind && !table.blind) {
        line_begin(stream, "", "", "", "");
        line_end(stream, true, NULL, false);
    }
    table.blind |= blind;
    if (own_line)
        print_wrapped(stream, 2, spec);
    line_begin(stream, own_line ? "" : spec, cell_run_time(row).text,
               cell_significant(row->control_s / row->run_s, "x").text, cell_rate(row).text);
    line_end(stream, blind, row, false);
    warnings_print(stream, row->reason);
}

/* A reason for which several algorithms refuse is printed once, below the scene's rows, without the cure. */
static void refusal_keep(const struct measurement *row, const char *spec)
{
    const size_t name = strlen(row->algorithm);
    const char *reason = row->reason;
    if (strncmp(reason, row->algorithm, name) == 0 && strncmp(reason + name, ": ", 2) == 0)
        reason += name + 2;
    int k = 0;
    char kept[sizeof table.refusals[0].reason];
    const char *cure = strstr(reason, " (cure: ");
    snprintf(kept, sizeof kept, "%.*s", cure ? (int)(cure - reason) : (int)sizeof kept, reason);
    while (k < REFUSALS - 1 && *table.refusals[k].reason && strcmp(table.refusals[k].reason, kept) != 0)
        k++;
    text_append(table.refusals[k].names, sizeof table.refusals[k].names, "%s%s", *table.refusals[k].names ? ", " : "",
                spec);
    memcpy(table.refusals[k].reason, kept, sizeof kept);
}

/* A SPEC without default values. */
static void spec_shown(const struct measurement *row, char *text, size_t size)
{
    struct spec usual;
    struct measurement shown = *row;
    if (spec_parse(row->algorithm, &usual) == STATUS_OK) {
        if (strcmp(usual.text, row->options) == 0)
            shown.options = "";
        spec_free(&usual);
    }
    measurement_spec(&shown, text, size);
    shown_make(text);
}

void table_row(FILE *stream, const struct measurement *row)
{
    char spec[512];
    if (strcmp(table.scene, row->scene) != 0)
        table_scene(stream, row->scene, "");
    spec_shown(row, spec, sizeof spec);
    if (strcmp(row->status, "ok") == 0) {
        table.images++;
        ok_print(stream, row, spec);
    } else if (strcmp(row->status, "unsupported") == 0) {
        table.refused++;
        refusal_keep(row, spec);
    } else {
        table.failed++;
        fprintf(stream, "  %s%s%s\n", table.brief ? table.scene : "", table.brief ? ": " : "", spec);
        text_print(stream, "failed: ", row->reason);
    }
}

void table_works_header(FILE *stream)
{
    if (table.width == WIDTH_WIDE)
        fprintf(stream, "  %-*s FLOPs counted, by the papers' formulas\n", table.spec_width, "");
    else
        fputs("  FLOPs counted, by the papers' formulas\n", stream);
}

void table_work(FILE *stream, const char *spec, const struct work *work)
{
    char text[400];
    int used = snprintf(text, sizeof text, "%.1e", work->flops);
    for (int k = 0; k < (int)(sizeof work->published / sizeof *work->published) && work->published[k].source; k++)
        used += snprintf(text + used, sizeof text - (size_t)used, ", %.1e %.60s", work->published[k].flops,
                         work->published[k].source);
    const size_t width = (size_t)table.spec_width;
    if (table.width == WIDTH_WIDE && strlen(spec) <= width && 3 + width + strlen(text) <= WIDTH_WIDE) {
        fprintf(stream, "  %-*s %s\n", table.spec_width, spec, text);
    } else {
        print_wrapped(stream, 2, spec);
        print_wrapped(stream, 4, text);
    }
}
