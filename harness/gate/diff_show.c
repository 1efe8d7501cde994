/* How findings are shown (diff.h): as text, as Markdown, as JSON. */
#include "gate/diff.h"

#include <math.h>
#include <string.h>
#include <stdio.h>
#include <stdlib.h>

#include "text/shown_text.h"
#include "files/text_file.h"

/* Findings put together by what may have caused them: one verdict on one kind of metric (quality, work, time) of one
   algorithm in one setting, whatever the precision, the scene and the metric. */
struct finding_group {
    enum verdict verdict;
    enum metric_class class;
    char spec[200];   /* without its precision */
    char what[400];   /* "error, pslr_db in float and double on 3 scenes" */
    int first, count; /* of the findings in struct groups */
};

struct groups {
    int count, finding_count;
    struct finding_group *groups;    /* [count] the worst verdict first, of those the largest */
    const struct finding **findings; /* [finding_count] by group, the largest change first; borrowed */
};

static const char precision_text[] = "precision=double";

static bool is_double(const char *spec)
{
    return strstr(spec, precision_text) != NULL;
}

/* "bp_sinc:taps=8,precision=double" and "bp_sinc:taps=8" are one cause. */
static void cause_make(const char *spec, char *cause, size_t size)
{
    const char *at = strstr(spec, precision_text);
    const size_t length = at ? (size_t)(at - spec) - (at > spec) : strlen(spec);
    snprintf(cause, size, "%.*s", (int)length, spec);
}

/* The size of the change: in slacks or, without them, relative; a row that is gone has the largest. */
static double distance(const struct finding *f)
{
    const double moved = fabs(f->after - f->before);
    if (isnan(moved))
        return INFINITY;
    return f->slack > 0 ? moved / f->slack : isnan(f->change) ? moved : fabs(f->change);
}

static int order_by_cause(const void *a, const void *b)
{
    const struct finding *x = *(const struct finding *const *)a, *y = *(const struct finding *const *)b;
    char cause[2][200];
    cause_make(x->spec, cause[0], sizeof cause[0]);
    cause_make(y->spec, cause[1], sizeof cause[1]);
    int order = (x->verdict > y->verdict) - (x->verdict < y->verdict);
    order = order ? order : (x->class > y->class) - (x->class < y->class);
    order = order ? order : strcmp(cause[0], cause[1]);
    order = order ? order : (distance(x) < distance(y)) - (distance(x) > distance(y));
    return order ? order : (x > y) - (x < y);
}

static int order_by_size(const void *a, const void *b)
{
    const struct finding_group *x = a, *y = b;
    int order = (x->verdict > y->verdict) - (x->verdict < y->verdict);
    order = order ? order : (x->class > y->class) - (x->class < y->class);
    order = order ? order : (x->count < y->count) - (x->count > y->count);
    return order ? order : (x->first > y->first) - (x->first < y->first);
}

/* Is this the first of the findings of one group with its metric, or its scene? */
static bool is_first(const struct finding *const *list, int k, bool by_scene)
{
    for (int n = 0; n < k; n++)
        if (strcmp(by_scene ? list[n]->scene : list[n]->metric, by_scene ? list[k]->scene : list[k]->metric) == 0)
            return false;
    return true;
}

enum { SEARCHED_MOST = 2000 }; /* beyond, metrics and scenes of a group are those of so many findings */

static void what_make(const struct finding *const *list, struct finding_group *group)
{
    int scenes = 0, doubles = 0;
    size_t used = 0;
    for (int k = 0; k < group->count && k < SEARCHED_MOST; k++) {
        scenes += is_first(list, k, true);
        doubles += is_double(list[k]->spec);
        if (is_first(list, k, false) && used < sizeof group->what - 100)
            used += (size_t)snprintf(group->what + used, sizeof group->what - used, "%s%.60s", used ? ", " : "",
                                     list[k]->metric);
    }
    const int searched = group->count < SEARCHED_MOST ? group->count : SEARCHED_MOST;
    char where[160];
    if (scenes == 1)
        snprintf(where, sizeof where, "%.150s", list[0]->scene);
    else
        snprintf(where, sizeof where, "%d scenes", scenes);
    snprintf(group->what + used, sizeof group->what - used, "%s on %s",
             doubles == 0          ? ""
             : doubles == searched ? " in double"
                                   : " in float and double",
             where);
}

static void groups_free(struct groups *groups)
{
    free(groups->groups);
    free(groups->findings);
    *groups = (struct groups){0};
}

/* All findings but the same ones, put together; freed with groups_free. Errors: STATUS_FAILED without memory. */
static enum status groups_make(const struct diff *diff, struct groups *groups)
{
    *groups = (struct groups){.groups = calloc((size_t)diff->finding_count + 1, sizeof *groups->groups),
                              .findings = calloc((size_t)diff->finding_count + 1, sizeof *groups->findings)};
    if (!groups->groups || !groups->findings) {
        groups_free(groups);
        return status_set(STATUS_FAILED, "no memory for %d findings", diff->finding_count);
    }
    for (int k = 0; k < diff->finding_count; k++)
        if (diff->findings[k].verdict != VERDICT_SAME)
            groups->findings[groups->finding_count++] = &diff->findings[k];
    qsort(groups->findings, (size_t)groups->finding_count, sizeof *groups->findings, order_by_cause);
    for (int k = 0; k < groups->finding_count; k++) {
        const struct finding *f = groups->findings[k];
        struct finding_group *group = groups->count > 0 ? &groups->groups[groups->count - 1] : NULL;
        char cause[200];
        cause_make(f->spec, cause, sizeof cause);
        if (!group || group->verdict != f->verdict || group->class != f->class || strcmp(group->spec, cause) != 0) {
            group = &groups->groups[groups->count++];
            *group = (struct finding_group){.verdict = f->verdict, .class = f->class, .first = k};
            snprintf(group->spec, sizeof group->spec, "%s", cause);
        }
        group->count++;
    }
    for (int k = 0; k < groups->count; k++)
        what_make(groups->findings + groups->groups[k].first, &groups->groups[k]);
    qsort(groups->groups, (size_t)groups->count, sizeof *groups->groups, order_by_size);
    return STATUS_OK;
}

/* --- What is shown --- */

enum {
    MARKDOWN_MOST = 100, /* findings: a comment has room for 65536 characters */
    SHOWN_MOST = 4       /* of each group on the terminal */
};

struct cell {
    char text[200];
};

/* Three digits, or as many as distinguish it from the other value. */
static struct cell cell_value(double value, double other, const char *text)
{
    struct cell cell = {""}, beside = {""};
    if (text)
        snprintf(cell.text, sizeof cell.text, "%s", text);
    for (int digits = 3; !text && !isnan(value) && digits <= 9; digits++) {
        snprintf(cell.text, sizeof cell.text, "%.*g", digits, value);
        snprintf(beside.text, sizeof beside.text, "%.*g", digits, other);
        if (value == other || strcmp(cell.text, beside.text) != 0)
            break;
    }
    shown_make(cell.text);
    return cell;
}

static struct cell cell_before(const struct finding *f)
{
    return cell_value(f->before, f->after, f->before_text);
}

static struct cell cell_after(const struct finding *f)
{
    return cell_value(f->after, f->before, f->after_text);
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

/* "quality: 3 worse, 120 same", one text a class. */
static void print_counts(const struct diff *diff, FILE *stream, const char *before)
{
    for (int class = 0; class < CLASSES; class ++) {
        bool any = false;
        for (int verdict = 0; verdict < VERDICTS; verdict++)
            if (diff->counts[class][verdict] > 0) {
                fprintf(stream, "%s%s%s%d %s", any ? ", " : before, any ? "" : class_names[class], any ? "" : ": ",
                        diff->counts[class][verdict], verdict_names[verdict]);
                any = true;
            }
        if (any)
            fputc('\n', stream);
    }
}

static const char *headline(const struct diff *diff)
{
    if (diff_count(diff, VERDICT_WORSE) || diff_count(diff, VERDICT_GONE))
        return "something got worse";
    if (diff_count(diff, VERDICT_CHANGED))
        return diff->to_baseline ? "changed for the better: where that is meant, a new baseline is needed"
                                 : "nothing got worse; what changed for the better is to be reviewed";
    if (diff_count(diff, VERDICT_WARNING))
        return "nothing failed, with a warning";
    return diff_count(diff, VERDICT_NOISY) ? "nothing failed, not all could be compared" : "nothing got worse";
}

static void line_write(FILE *stream, const char *text)
{
    shown_write(stream, text);
    fputc('\n', stream);
}

/* Better, new and noisy findings are only counted. */
static bool is_folded(enum verdict verdict)
{
    return verdict == VERDICT_NOISY || verdict == VERDICT_BETTER || verdict == VERDICT_NEW;
}

static void finding_print(const struct finding *f, FILE *stream)
{
    fprintf(stream, "  %-17s %11s %11s %11s  ", f->metric, cell_before(f).text, cell_after(f).text,
            cell_change(f).text);
    const char *const parts[] = {f->scene, " ", f->spec, *f->detail ? " " : "", f->detail};
    for (size_t n = 0; n < sizeof parts / sizeof *parts; n++)
        shown_write(stream, parts[n]);
    fputc('\n', stream);
}

static void group_print(const struct groups *groups, const struct finding_group *group, FILE *stream)
{
    fprintf(stream, "%s, %s of ", verdict_names[group->verdict], class_names[group->class]);
    shown_write(stream, group->spec);
    fprintf(stream, ": %d %s, ", group->count, group->count == 1 ? "value" : "values");
    line_write(stream, group->what);
    for (int k = 0; k < group->count && k < SHOWN_MOST && !is_folded(group->verdict); k++)
        finding_print(groups->findings[group->first + k], stream);
    if (group->count > SHOWN_MOST && !is_folded(group->verdict))
        fprintf(stream, "  and %d more\n", group->count - SHOWN_MOST);
}

void diff_print(const struct diff *diff, FILE *stream)
{
    struct groups groups;
    for (int k = 0; k < diff->note_count; k++)
        line_write(stream, diff->notes[k]);
    if (groups_make(diff, &groups) == STATUS_OK) {
        if (groups.count > 0)
            fprintf(stream, "\n  %-17s %11s %11s %11s  %s\n", "metric", "OLD", "NEW", "change", "of");
        for (int k = 0; k < groups.count; k++)
            group_print(&groups, &groups.groups[k], stream);
        groups_free(&groups);
    }
    fputc('\n', stream);
    print_counts(diff, stream, "");
    fprintf(stream, "%s\n", headline(diff));
}

static void markdown_cell(FILE *stream, const char *text)
{
    fputs("| ", stream);
    shown_markdown(stream, text);
    fputc(' ', stream);
}

static void markdown_groups(const struct groups *groups, FILE *stream)
{
    fputs("\n| verdict | of | values | metrics and scenes | the largest: OLD | NEW | change |\n"
          "|---|---|--:|---|--:|--:|--:|\n",
          stream);
    for (int k = 0; k < groups->count && k < MARKDOWN_MOST; k++) {
        const struct finding_group *group = &groups->groups[k];
        const struct finding *worst = groups->findings[group->first];
        const struct cell before = cell_before(worst), after = cell_after(worst), change = cell_change(worst);
        char count[16];
        snprintf(count, sizeof count, "%d", group->count);
        const char *const cells[] = {
            verdict_names[group->verdict], group->spec, count, group->what, before.text, after.text, change.text};
        for (size_t c = 0; c < sizeof cells / sizeof *cells; c++)
            markdown_cell(stream, cells[c]);
        fputs("|\n", stream);
    }
    if (groups->count > MARKDOWN_MOST)
        fprintf(stream, "\n%d more are not shown.\n", groups->count - MARKDOWN_MOST);
}

/* The findings one by one, folded away. */
static void markdown_findings(const struct groups *groups, FILE *stream)
{
    int shown = 0;
    fprintf(stream, "\n<details><summary>each value</summary>\n\n"
                    "| verdict | metric | OLD | NEW | change | scene | algorithm |\n|---|---|--:|--:|--:|---|---|\n");
    for (int n = 0; n < groups->count; n++)
        for (int k = 0; k < groups->groups[n].count && shown < MARKDOWN_MOST; k++, shown++) {
            const struct finding *f = groups->findings[groups->groups[n].first + k];
            const struct cell before = cell_before(f), after = cell_after(f), change = cell_change(f);
            struct cell of;
            snprintf(of.text, sizeof of.text, "%.150s%s%.40s", f->spec, *f->detail ? ", " : "", f->detail);
            const char *const cells[] = {
                verdict_names[f->verdict], f->metric, before.text, after.text, change.text, f->scene, of.text};
            for (size_t c = 0; c < sizeof cells / sizeof *cells; c++)
                markdown_cell(stream, cells[c]);
            fputs("|\n", stream);
        }
    if (groups->finding_count > shown)
        fprintf(stream, "\n%d more are not shown.\n", groups->finding_count - shown);
    fputs("\n</details>\n", stream);
}

enum status diff_markdown(const struct diff *diff, const char *path)
{
    struct text_file file;
    struct groups groups;
    enum status status = groups_make(diff, &groups);
    if (status != STATUS_OK)
        return status;
    status = text_file_open_named(path, &file);
    if (status == STATUS_OK) {
        fprintf(file.stream, "## sasbench: %s\n\n", headline(diff));
        for (int k = 0; k < diff->note_count; k++) {
            fputs("- ", file.stream);
            shown_markdown(file.stream, diff->notes[k]);
            fputc('\n', file.stream);
        }
        print_counts(diff, file.stream, "- ");
        if (groups.count > 0) {
            markdown_groups(&groups, file.stream);
            markdown_findings(&groups, file.stream);
        }
        status = text_file_close(&file, status);
    }
    groups_free(&groups);
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
    enum status status = text_file_open_named(path, &file);
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
