/* How findings are shown (diff.h): as text, as Markdown, as JSON. */
#include "gate/diff.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "data/shown_text.h"
#include "data/text_file.h"

enum { MARKDOWN_MOST = 100 }; /* findings: a comment has room for 65536 characters */

struct cell {
    char text[200];
};

static struct cell cell_value(double value, const char *text)
{
    struct cell cell = {""};
    if (text)
        snprintf(cell.text, sizeof cell.text, "%s", text);
    else if (!isnan(value))
        snprintf(cell.text, sizeof cell.text, "%.6g", value);
    shown_make(cell.text);
    return cell;
}

static struct cell cell_change(const struct finding *finding)
{
    struct cell cell = {""};
    if (finding->change_high > finding->change_low)
        snprintf(cell.text, sizeof cell.text, "%+.1f %% (%+.1f to %+.1f)", 100 * finding->change,
                 100 * finding->change_low, 100 * finding->change_high);
    else if (!isnan(finding->change))
        snprintf(cell.text, sizeof cell.text, "%+.3g %%", 100 * finding->change);
    else if (!isnan(finding->after - finding->before))
        snprintf(cell.text, sizeof cell.text, "%+.3g %s", finding->after - finding->before, finding->unit);
    return cell;
}

static int order_findings(const void *a, const void *b)
{
    const struct finding *x = *(const struct finding *const *)a, *y = *(const struct finding *const *)b;
    int order = (x->verdict > y->verdict) - (x->verdict < y->verdict);
    return order ? order : (x > y) - (x < y);
}

/* All findings but the same ones, the worst first, in an array that the caller frees; NULL without memory. */
static const struct finding **changed(const struct diff *diff, int *count)
{
    const struct finding **list = calloc((size_t)diff->finding_count + 1, sizeof *list);
    *count = 0;
    for (int k = 0; list && k < diff->finding_count; k++)
        if (diff->findings[k].verdict != VERDICT_SAME)
            list[(*count)++] = &diff->findings[k];
    if (list)
        qsort(list, (size_t)*count, sizeof *list, order_findings);
    return list;
}

static bool verdict_occurs(const struct diff *diff, int verdict)
{
    for (int class = 0; class < CLASSES; class ++)
        if (diff->counts[class][verdict] > 0)
            return true;
    return false;
}

static bool class_occurs(const struct diff *diff, int class)
{
    for (int verdict = 0; verdict < VERDICTS; verdict++)
        if (diff->counts[class][verdict] > 0)
            return true;
    return false;
}

/* "quality: 3 worse, 120 same", one text a class. */
static void print_counts(const struct diff *diff, FILE *stream, const char *before, const char *after)
{
    for (int class = 0; class < CLASSES; class ++) {
        const char *between = "";
        if (!class_occurs(diff, class))
            continue;
        fprintf(stream, "%s%s: ", before, class_names[class]);
        for (int verdict = 0; verdict < VERDICTS; verdict++)
            if (diff->counts[class][verdict] > 0) {
                fprintf(stream, "%s%d %s", between, diff->counts[class][verdict], verdict_names[verdict]);
                between = ", ";
            }
        fputs(after, stream);
    }
}

static const char *headline(const struct diff *diff)
{
    if (verdict_occurs(diff, VERDICT_WORSE) || verdict_occurs(diff, VERDICT_GONE))
        return "something got worse";
    if (verdict_occurs(diff, VERDICT_CHANGED))
        return diff->to_baseline ? "changed for the better: where that is meant, a new baseline is needed"
                                 : "nothing got worse; what changed for the better is to be reviewed";
    if (verdict_occurs(diff, VERDICT_WARNING))
        return "nothing failed, with a warning";
    return verdict_occurs(diff, VERDICT_NOISY) ? "nothing failed, not all could be judged" : "nothing got worse";
}

static int widest(int width, const char *text)
{
    int length = (int)strlen(text);
    return length > width ? length : width;
}

static void line_write(FILE *stream, const char *text)
{
    shown_write(stream, text);
    fputc('\n', stream);
}

void diff_print(const struct diff *diff, FILE *stream)
{
    int count;
    const struct finding **list = changed(diff, &count);
    for (int k = 0; k < diff->note_count; k++)
        line_write(stream, diff->notes[k]);
    int verdict_width = 8, change_width = 11;
    for (int k = 0; list && k < count; k++) {
        verdict_width = widest(verdict_width, verdict_names[list[k]->verdict]);
        change_width = widest(change_width, cell_change(list[k]).text);
    }
    if (count > 0)
        fprintf(stream, "\n%-*s %-17s %13s %13s %*s  %s\n", verdict_width, "verdict", "metric", "OLD", "NEW",
                change_width, "change", "of");
    for (int k = 0; list && k < count; k++) {
        const struct finding *f = list[k];
        fprintf(stream, "%-*s %-17s %13s %13s %*s  ", verdict_width, verdict_names[f->verdict], f->metric,
                cell_value(f->before, f->before_text).text, cell_value(f->after, f->after_text).text, change_width,
                cell_change(f).text);
        const char *const parts[] = {f->scene, " ", f->spec, *f->detail ? " " : "", f->detail};
        for (size_t n = 0; n < sizeof parts / sizeof *parts; n++)
            shown_write(stream, parts[n]);
        fputc('\n', stream);
    }
    fputc('\n', stream);
    print_counts(diff, stream, "", "\n");
    fprintf(stream, "%s\n", headline(diff));
    free(list);
}

static void markdown_cell(FILE *stream, const char *text)
{
    fputs("| ", stream);
    shown_markdown(stream, text);
    fputc(' ', stream);
}

enum status diff_markdown(const struct diff *diff, const char *path)
{
    int count;
    struct text_file file;
    const struct finding **list = changed(diff, &count);
    if (!list)
        return status_set(STATUS_FAILED, "no memory for %d findings", diff->finding_count);
    enum status status = text_file_open(path, &file);
    if (status == STATUS_OK) {
        fprintf(file.stream, "## sasbench: %s\n\n", headline(diff));
        print_counts(diff, file.stream, "- ", "\n");
        if (count > 0)
            fputs("\n| verdict | metric | OLD | NEW | change | scene | algorithm |\n|---|---|--:|--:|--:|---|---|\n",
                  file.stream);
        for (int k = 0; k < count && k < MARKDOWN_MOST; k++) {
            const struct finding *f = list[k];
            struct cell before = cell_value(f->before, f->before_text), after = cell_value(f->after, f->after_text);
            struct cell change = cell_change(f), of;
            snprintf(of.text, sizeof of.text, "%.150s%s%.40s", f->spec, *f->detail ? ", " : "", f->detail);
            const char *const cells[] = {
                verdict_names[f->verdict], f->metric, before.text, after.text, change.text, f->scene, of.text};
            for (size_t c = 0; c < sizeof cells / sizeof *cells; c++)
                markdown_cell(file.stream, cells[c]);
            fputs("|\n", file.stream);
        }
        if (count > MARKDOWN_MOST)
            fprintf(file.stream, "\n%d more are not shown.\n", count - MARKDOWN_MOST);
        fputc('\n', file.stream);
        for (int k = 0; k < diff->note_count; k++) {
            fputs("- ", file.stream);
            shown_markdown(file.stream, diff->notes[k]);
            fputc('\n', file.stream);
        }
        status = text_file_close(&file, status);
    }
    free(list);
    return status;
}

static void json_text(FILE *stream, const char *text)
{
    while (*text) {
        size_t length = shown_length(text);
        if (strchr("\"\\", *text))
            fputc('\\', stream);
        if (length)
            fwrite(text, 1, length, stream);
        else
            fputs("\\ufffd", stream);
        text += length ? length : 1;
    }
}

enum status diff_json(const struct diff *diff, const char *path)
{
    struct text_file file;
    const char *between = "[";
    enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    for (int k = 0; k < diff->finding_count; k++) {
        const struct finding *f = &diff->findings[k];
        if (!f->lower_is_better || !isfinite(f->after))
            continue;
        fprintf(file.stream, "%s\n  {\"name\": \"", between);
        between = ",";
        json_text(file.stream, f->scene);
        fputc(' ', file.stream);
        json_text(file.stream, f->spec);
        fputs(*f->detail ? " " : "", file.stream);
        json_text(file.stream, f->detail);
        fprintf(file.stream, " %s\", \"unit\": \"%s\", \"value\": %.9g", f->metric, f->unit, f->after);
        if (isfinite(f->slack))
            fprintf(file.stream, ", \"range\": \"%.3g\"", f->slack);
        fputc('}', file.stream);
    }
    fprintf(file.stream, "%s\n]\n", *between == '[' ? "[" : "");
    return text_file_close(&file, status);
}
