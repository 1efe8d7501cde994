/* Two results, row by row (diff.h): rows are matched by their sorted keys, values judged by the metric table. */
#include "gate/diff.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "measure/timing.h"

const char *const verdict_names[VERDICTS] = {[VERDICT_WORSE] = "worse",
                                             [VERDICT_GONE] = "gone",
                                             [VERDICT_CHANGED] = "changed",
                                             [VERDICT_WARNING] = "warning",
                                             [VERDICT_NOISY] = "too noisy to tell",
                                             [VERDICT_BETTER] = "better",
                                             [VERDICT_NEW] = "new",
                                             [VERDICT_SAME] = "same"};
const char *const class_names[] = {[CLASS_QUALITY] = "quality", [CLASS_WORK] = "work", [CLASS_TIME] = "time"};

/* --- What the findings are kept in --------------------------------------------------------------------------- */

/* Room for one more element; *array is replaced when it grows. */
static void *array_room(void *array, int count, int *room, size_t size)
{
    if (count < *room)
        return array;
    int more = *room ? 2 * *room : 64;
    void *longer = realloc(array, (size_t)more * size);
    if (longer)
        *room = more;
    else
        status_set(STATUS_FAILED, "no memory for %d findings", more);
    return longer;
}

enum status compare_add(struct compare *compare, const struct finding *finding)
{
    struct finding *findings =
        array_room(compare->findings, compare->finding_count, &compare->finding_room, sizeof *findings);
    if (!findings)
        return STATUS_FAILED;
    compare->findings = findings;
    findings[compare->finding_count++] = *finding;
    compare->counts[finding->class][finding->verdict]++;
    return STATUS_OK;
}

/* The text is kept; NULL without memory. */
static const char *text_keep(struct compare *compare, const char *format, va_list arguments)
{
    va_list again;
    va_copy(again, arguments);
    int length = vsnprintf(NULL, 0, format, again);
    va_end(again);
    char **texts = array_room(compare->texts, compare->text_count, &compare->text_room, sizeof *texts);
    if (!texts)
        return NULL;
    compare->texts = texts;
    char *text = malloc((size_t)length + 1);
    if (!text) {
        status_set(STATUS_FAILED, "no memory for a text of %d characters", length);
        return NULL;
    }
    vsnprintf(text, (size_t)length + 1, format, arguments);
    texts[compare->text_count++] = text;
    return text;
}

const char *compare_text(struct compare *compare, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const char *text = text_keep(compare, format, arguments);
    va_end(arguments);
    return text;
}

enum status compare_note(struct compare *compare, const char *format, ...)
{
    if (compare->note_count == (int)(sizeof compare->notes / sizeof *compare->notes))
        return STATUS_OK;
    va_list arguments;
    va_start(arguments, format);
    const char *text = text_keep(compare, format, arguments);
    va_end(arguments);
    if (!text)
        return STATUS_FAILED;
    compare->notes[compare->note_count++] = text;
    return STATUS_OK;
}

static int count_of(const struct compare *compare, enum verdict verdict)
{
    int count = 0;
    for (int class = 0; class < CLASSES; class ++)
        count += compare->counts[class][verdict];
    return count;
}

enum status compare_judge(const struct compare *compare)
{
    int worse = count_of(compare, VERDICT_WORSE), gone = count_of(compare, VERDICT_GONE);
    int changed = compare->to_baseline ? count_of(compare, VERDICT_CHANGED) : 0;
    if (worse + gone + changed == 0)
        return STATUS_OK;
    if (changed == 0)
        return status_set(STATUS_FAILED, "%d worse, %d gone", worse, gone);
    return status_set(STATUS_FAILED,
                      "%d worse, %d gone, %d changed for the better: where that is meant, ./sasbench baseline "
                      "writes a new baseline, to be reviewed",
                      worse, gone, changed);
}

void compare_free(struct compare *compare)
{
    for (int k = 0; k < compare->text_count; k++)
        free(compare->texts[k]);
    free(compare->texts);
    free(compare->findings);
    *compare = (struct compare){0};
}

/* --- Rows and their keys ------------------------------------------------------------------------------------- */

/* What tells a row from the others. Those of measurements have target 0 and no axis and definition. */
struct key {
    const char *scene, *algorithm, *options, *precision;
    int target;
    const char *axis, *definition;
    int row;
};

/* A comment "scene NAME: HASH". A name may hold anything, so that its length is kept. */
struct scene_content {
    const char *name, *hash; /* borrowed; the name ends at `length` */
    size_t length;
};

/* One of the two results, ready to be searched. */
struct side {
    struct results results;
    struct key *keys;               /* [row_count] sorted */
    struct scene_content *contents; /* [content_count] sorted by name */
    int content_count;
    bool *matched; /* [row_count] by row: found on the other side, too */
    bool *closed;  /* [row_count] by row: nothing more to say of what belongs to this row */
};

/* By measurement only. */
static int key_order_measurement(const void *a, const void *b)
{
    const struct key *x = a, *y = b;
    int order = strcmp(x->scene, y->scene);
    order = order ? order : strcmp(x->algorithm, y->algorithm);
    order = order ? order : strcmp(x->options, y->options);
    return order ? order : strcmp(x->precision, y->precision);
}

static int key_order(const void *a, const void *b)
{
    const struct key *x = a, *y = b;
    int order = key_order_measurement(a, b);
    order = order ? order : (x->target > y->target) - (x->target < y->target);
    order = order ? order : strcmp(x->axis, y->axis);
    return order ? order : strcmp(x->definition, y->definition);
}

/* Equal keys in the order of the file, so that a row given twice is told by its first line. */
static int key_order_row(const void *a, const void *b)
{
    const struct key *x = a, *y = b;
    int order = key_order(a, b);
    return order ? order : (x->row > y->row) - (x->row < y->row);
}

static int content_order(const void *a, const void *b)
{
    const struct scene_content *x = a, *y = b;
    int order = memcmp(x->name, y->name, x->length < y->length ? x->length : y->length);
    return order ? order : (x->length > y->length) - (x->length < y->length);
}

/* False where the comment is about something else. */
static bool content_read(const char *comment, struct scene_content *content)
{
    static const char head[] = "scene ";
    const char *colon = strrchr(comment, ':');
    if (strncmp(comment, head, strlen(head)) != 0 || !colon || colon < comment + strlen(head))
        return false;
    *content = (struct scene_content){comment + strlen(head), colon + 1, (size_t)(colon - comment) - strlen(head)};
    return true;
}

static struct key key_of(const struct results *results, int row)
{
    if (results->targets) {
        const struct target_row *t = &results->target_rows[row];
        return (struct key){t->scene, t->algorithm, t->options, t->precision, t->target, t->axis, t->definition, row};
    }
    const struct measurement *m = &results->measurements[row];
    return (struct key){m->scene, m->algorithm, m->options, m->precision, 0, "", "", row};
}

static void side_close(struct side *side)
{
    free(side->keys);
    free(side->contents);
    free(side->matched);
    free(side->closed);
    results_free(&side->results);
}

static enum status side_open(const char *path, struct side *side)
{
    *side = (struct side){0};
    enum status status = results_read(path, &side->results);
    if (status != STATUS_OK)
        return status;
    const struct csv *csv = &side->results.csv;
    size_t rows = (size_t)csv->row_count;
    side->keys = calloc(rows + 1, sizeof *side->keys);
    side->matched = calloc(rows + 1, sizeof *side->matched);
    side->closed = calloc(rows + 1, sizeof *side->closed);
    side->contents = calloc((size_t)csv->comment_count + 1, sizeof *side->contents);
    if (!side->keys || !side->matched || !side->closed || !side->contents)
        return status_set(STATUS_FAILED, "%s: no memory for %d rows", path, csv->row_count);
    for (int k = 0; k < csv->comment_count; k++)
        side->content_count += content_read(csv->comments[k], &side->contents[side->content_count]);
    qsort(side->contents, (size_t)side->content_count, sizeof *side->contents, content_order);
    for (int row = 0; row < csv->row_count; row++)
        side->keys[row] = key_of(&side->results, row);
    qsort(side->keys, rows, sizeof *side->keys, key_order_row);
    for (int k = 1; k < csv->row_count; k++)
        if (key_order(&side->keys[k - 1], &side->keys[k]) == 0)
            return status_set(STATUS_INVALID,
                              "%s:%d: the row of scene %s, algorithm %s, options '%s', precision %s "
                              "stands in line %d already; each may be given once",
                              path, csv->lines[side->keys[k].row], side->keys[k].scene, side->keys[k].algorithm,
                              side->keys[k].options, side->keys[k].precision, csv->lines[side->keys[k - 1].row]);
    return STATUS_OK;
}

static const struct key *side_find(const struct side *side, const struct key *key,
                                   int (*order)(const void *, const void *))
{
    return bsearch(key, side->keys, (size_t)side->results.csv.row_count, sizeof *side->keys, order);
}

/* The content of a scene as the file's head names it; NULL when it does not. */
static const char *side_hash(const struct side *side, const char *scene)
{
    const struct scene_content sought = {scene, NULL, strlen(scene)};
    const struct scene_content *found =
        bsearch(&sought, side->contents, (size_t)side->content_count, sizeof *side->contents, content_order);
    return found ? found->hash : NULL;
}

/* --- Judging ------------------------------------------------------------------------------------------------- */

static enum verdict judge(const struct metric *metric, double before, double after, double *slack)
{
    if (isnan(before))
        return VERDICT_NEW;
    if (isnan(after))
        return VERDICT_GONE;
    if (metric->better == BETTER_SMALL) {
        before = fabs(before);
        after = fabs(after);
    }
    *slack = fmax(*slack, metric->relative_slack * fabs(before));
    if (fabs(after - before) <= *slack)
        return VERDICT_SAME;
    bool improved = metric->better == BETTER_HIGHER ? after > before : after < before;
    return improved && metric->better != BETTER_NONE ? VERDICT_BETTER : VERDICT_WORSE;
}

/* How much longer NEW takes, each side divided by the control that was measured beside it: of the median and the least
   time, the ratio nearer to 1. What load does to a few runs seldom moves both. NAN when it cannot be told. */
static double time_ratio(const struct measurement *old, const struct measurement *new)
{
    double control = old->control_s / new->control_s, ratio = new->run_s / old->run_s *control;
    double least = new->run_min_s / old->run_min_s *control;
    bool whole = ratio > 0 && isfinite(ratio);
    if (!whole || !(least > 0 && isfinite(least)))
        return whole ? ratio : NAN;
    if ((ratio > 1) != (least > 1))
        return 1;
    return fabs(log(ratio)) < fabs(log(least)) ? ratio : least;
}

/* What two sides are compared with. */
struct work_place {
    struct compare *compare;
    struct side *old, *new;
    const struct metric *metrics;
    double *ratios; /* [ratio_count] of the times */
    int ratio_count;
    bool threads_differ;
};

/* The row as on the command line, for the findings. */
static enum status describe(struct compare *compare, const struct key *key, struct finding *finding)
{
    bool is_double = strcmp(key->precision, "double") == 0, options = *key->options;
    finding->scene = compare_text(compare, "%s", key->scene);
    finding->spec = compare_text(compare, "%s%s%s%s%s", key->algorithm, options || is_double ? ":" : "", key->options,
                                 options && is_double ? "," : "", is_double ? "precision=double" : "");
    finding->detail =
        *key->axis ? compare_text(compare, "target %d, %s, %s", key->target + 1, key->axis, key->definition) : "";
    return finding->scene && finding->spec && finding->detail ? STATUS_OK : STATUS_FAILED;
}

/* A finding about a whole row. */
static enum status add_row(struct compare *compare, const struct key *key, enum verdict verdict, const char *metric,
                           const char *before, const char *after)
{
    struct finding finding = {.verdict = verdict,
                              .class = CLASS_QUALITY,
                              .metric = metric,
                              .unit = "",
                              .before = NAN,
                              .after = NAN,
                              .change = NAN,
                              .slack = NAN,
                              .before_text = compare_text(compare, "%s", before),
                              .after_text = compare_text(compare, "%s", after)};
    if (!finding.before_text || !finding.after_text || describe(compare, key, &finding) != STATUS_OK)
        return STATUS_FAILED;
    return compare_add(compare, &finding);
}

static int status_rank(const char *status)
{
    return strcmp(status, "ok") == 0 ? 0 : strcmp(status, "unsupported") == 0 ? 1 : 2;
}

/* Two rows' times; undefined on one side is no matter: a baseline has none. */
static void judge_time(struct work_place *place, const struct key *key, const struct key *found,
                       struct finding *finding)
{
    const struct measurement *old = &place->old->results.measurements[key->row];
    const struct measurement *new = &place->new->results.measurements[found->row];
    double ratio = time_ratio(old, new), limit = 1 + place->metrics->relative_slack;
    bool same_threads = old->threads == new->threads;
    finding->verdict = VERDICTS;
    if (isnan(ratio) || !same_threads) {
        place->threads_differ |= !isnan(ratio) && !same_threads;
        return;
    }
    place->ratios[place->ratio_count++] = ratio;
    finding->change = ratio - 1;
    finding->slack = place->metrics->relative_slack * finding->before;
    finding->verdict = ratio > limit ? VERDICT_WORSE : ratio < 1 / limit ? VERDICT_BETTER : VERDICT_SAME;
}

static enum status judge_pair(struct work_place *place, const struct key *key, const struct key *found)
{
    struct compare *compare = place->compare;
    const struct results *old = &place->old->results, *new = &place->new->results;
    enum precision precision = strcmp(key->precision, "double") == 0 ? PRECISION_DOUBLE : PRECISION_FLOAT;
    const char *old_row =
        old->targets ? (const char *)&old->target_rows[key->row] : (const char *)&old->measurements[key->row];
    const char *new_row =
        new->targets ? (const char *)&new->target_rows[found->row] : (const char *)&new->measurements[found->row];
    if (!old->targets) {
        const char *before = old->measurements[key->row].status, *after = new->measurements[found->row].status;
        int worse = status_rank(after) - status_rank(before);
        if (worse != 0 || status_rank(after) != 0) {
            const char *reason = new->measurements[found->row].reason;
            place->old->closed[key->row] = place->new->closed[found->row] = true;
            const char *said = compare_text(compare, "%s%s%s", after, *reason ? ": " : "", reason);
            return !said ? STATUS_FAILED
                         : add_row(compare, key,
                                   worse > 0   ? VERDICT_WORSE
                                   : worse < 0 ? VERDICT_BETTER
                                               : VERDICT_SAME,
                                   "status", before, said);
        }
    }
    struct finding row = {.before = NAN};
    enum status status = describe(compare, key, &row);
    for (const struct metric *metric = place->metrics; metric->name && status == STATUS_OK; metric++) {
        struct finding finding = row;
        memcpy(&finding.before, old_row + metric->offset, sizeof finding.before);
        memcpy(&finding.after, new_row + metric->offset, sizeof finding.after);
        finding.class = metric->class;
        finding.metric = metric->name;
        finding.unit = metric->unit;
        finding.lower_is_better = metric->better == BETTER_LOWER;
        finding.slack = metric->absolute_slack[precision];
        finding.change = NAN;
        if (metric->class == CLASS_TIME) {
            judge_time(place, key, found, &finding);
        } else if (isnan(finding.before) && isnan(finding.after)) {
            continue;
        } else {
            finding.verdict = judge(metric, finding.before, finding.after, &finding.slack);
            if (finding.before != 0 && strcmp(metric->unit, "dB") != 0)
                finding.change = finding.after / finding.before - 1;
        }
        if (finding.verdict < VERDICTS)
            status = compare_add(compare, &finding);
    }
    return status;
}

/* The row of the measurement that a target's row belongs to has been told already. */
static bool is_closed(const struct side *measurements, const struct key *key)
{
    const struct key *found = measurements ? side_find(measurements, key, key_order_measurement) : NULL;
    return found && measurements->closed[found->row];
}

/* All rows of one pair of files in the order of OLD, then the rows of NEW alone. `measurements`: the sides of the
   measurements when these are their targets, else NULL. */
static enum status judge_sides(struct work_place *place, const struct side measurements[2])
{
    struct side *old = place->old, *new = place->new;
    enum status status = STATUS_OK;
    const char *told = "";
    for (int row = 0; row < old->results.csv.row_count && status == STATUS_OK; row++) {
        struct key key = key_of(&old->results, row);
        const struct key *found = side_find(new, &key, key_order);
        const char *before = side_hash(old, key.scene), *after = side_hash(new, key.scene);
        bool changed = found && before && after && strcmp(before, after) != 0;
        if (changed && !measurements && strcmp(told, key.scene) != 0) {
            told = key.scene;
            status = compare_note(place->compare,
                                  "scene %s has another content in NEW: its rows are not comparable, "
                                  "so that they are gone and new",
                                  key.scene);
        }
        if (status != STATUS_OK)
            break;
        if (found && !changed) {
            new->matched[found->row] = true;
            if (!measurements || !is_closed(&measurements[0], &key))
                status = judge_pair(place, &key, found);
        } else {
            old->closed[row] = true;
            if (!measurements || !is_closed(&measurements[0], &key))
                status = add_row(place->compare, &key, VERDICT_GONE, "row", "present", "");
        }
    }
    for (int row = 0; row < new->results.csv.row_count &&status == STATUS_OK; row++) {
        struct key key = key_of(&new->results, row);
        if (new->matched[row])
            continue;
        new->closed[row] = true;
        if (!measurements || !is_closed(&measurements[1], &key))
            status = add_row(place->compare, &key, VERDICT_NEW, "row", "", "present");
    }
    return status;
}

/* --- Files and folders --------------------------------------------------------------------------------------- */

static enum status note_side(struct compare *compare, const char *which, const char *path, const struct side *side)
{
    const struct csv *csv = &side->results.csv;
    const char *commit = csv_comment(csv, "commit"), *date = csv_comment(csv, "date"),
               *machine = csv_comment(csv, "machine");
    return compare_note(compare, "%s: %s, %d rows%s%s%s%s%s%s", which, path, csv->row_count, commit ? ", commit " : "",
                        commit ? commit : "", date ? ", " : "", date ? date : "", machine ? ", " : "",
                        machine ? machine : "");
}

static void finding_change(struct compare *compare, struct finding *finding)
{
    compare->counts[finding->class][finding->verdict]--;
    finding->verdict = VERDICT_CHANGED;
    compare->counts[finding->class][finding->verdict]++;
}

static bool is_betterment(const struct finding *finding)
{
    return finding->verdict == VERDICT_BETTER && finding->class != CLASS_TIME;
}

static bool is_much(const struct finding *finding)
{
    double change = fabs(finding->after - finding->before);
    if (finding->class == CLASS_WORK)
        return !(change <= CHANGED_WORK * fabs(finding->before));
    return !(change <= CHANGED_SLACKS * finding->slack); /* a status has no numbers: always */
}

/* A fault can flatter as well as harm: the findings from `first` on that are better by much, or in many rows. */
static void changes_find(struct compare *compare, int first, const struct metric *metrics_used)
{
    for (const struct metric *metric = metrics_used; metric->name; metric++) {
        int rows = 0;
        for (int k = first; k < compare->finding_count; k++)
            rows += is_betterment(&compare->findings[k]) && strcmp(compare->findings[k].metric, metric->name) == 0;
        for (int k = first; k < compare->finding_count && rows >= CHANGED_ROWS; k++)
            if (is_betterment(&compare->findings[k]) && strcmp(compare->findings[k].metric, metric->name) == 0)
                finding_change(compare, &compare->findings[k]);
    }
    for (int k = first; k < compare->finding_count; k++)
        if (is_betterment(&compare->findings[k]) && is_much(&compare->findings[k]))
            finding_change(compare, &compare->findings[k]);
}

static enum status judge_files(struct compare *compare, const char *const paths[2], struct side sides[2],
                               const struct side measurements[2])
{
    static const char *const names[2] = {"OLD", "NEW"};
    int before = compare->finding_count;
    struct work_place place = {compare, &sides[0], &sides[1], NULL, NULL, 0, false};
    enum status status = STATUS_OK;
    for (int k = 0; k < 2 && status == STATUS_OK; k++)
        status = side_open(paths[k], &sides[k]);
    for (int k = 0; k < 2 && status == STATUS_OK; k++)
        status = note_side(compare, names[k], paths[k], &sides[k]);
    if (status != STATUS_OK)
        return status;
    if (sides[0].results.targets != sides[1].results.targets)
        return status_set(STATUS_INVALID, "%s holds %s and %s holds %s; two of the same kind are needed", paths[0],
                          sides[0].results.targets ? "targets" : "measurements", paths[1],
                          sides[1].results.targets ? "targets" : "measurements");
    place.metrics = sides[0].results.targets ? target_metrics : metrics;
    place.ratios = calloc((size_t)sides[0].results.csv.row_count + 1, sizeof *place.ratios);
    if (!place.ratios)
        return status_set(STATUS_FAILED, "no memory for %d rows", sides[0].results.csv.row_count);
    compare->to_baseline |= !csv_comment(&sides[0].results.csv, "program");
    status = judge_sides(&place, measurements);
    changes_find(compare, before, place.metrics);
    if (status == STATUS_OK && place.threads_differ)
        status = compare_note(compare, "threads differ: times are not compared where they do");
    if (status == STATUS_OK && place.ratio_count > 0) {
        int count = place.ratio_count;
        status = compare_note(compare,
                              "time against the control: NEW takes %.3g of OLD (median of %d rows); a row alone is "
                              "judged beyond a factor of %g, finer by compare --ab",
                              median(place.ratios, count), count, 1 + metrics[0].relative_slack);
    }
    free(place.ratios);
    return status;
}

static bool is_folder(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

static bool exists(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0;
}

/* The file of this name in a folder; a file stands for itself. NULL without memory. */
static const char *path_in(struct compare *compare, const char *path, const char *name)
{
    return is_folder(path) ? compare_text(compare, "%s/%s", path, name) : path;
}

/* A folder has the file of the same kind as the other side, which is a file. */
static enum status kind_of(const char *const given[2], const char **name)
{
    const char *file = is_folder(given[0]) ? given[1] : given[0];
    struct results results;
    enum status status = results_read(file, &results);
    if (status == STATUS_OK)
        *name = results.targets ? "targets.csv" : "measurements.csv";
    results_free(&results);
    return status;
}

enum status compare_results(const char *old, const char *new, struct compare *compare)
{
    const char *const given[2] = {old, new};
    const char *name = "measurements.csv", *paths[2], *targets[2] = {NULL, NULL};
    bool folders = is_folder(old) && is_folder(new);
    struct side sides[2] = {0}, target_sides[2] = {0};
    enum status status = STATUS_OK;
    *compare = (struct compare){0};
    if (!folders && (is_folder(old) || is_folder(new)))
        status = kind_of(given, &name);
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        paths[k] = path_in(compare, given[k], name);
        if (folders)
            targets[k] = path_in(compare, given[k], "targets.csv");
        if (!paths[k] || (folders && !targets[k]))
            status = STATUS_FAILED;
    }
    if (status == STATUS_OK)
        status = judge_files(compare, paths, sides, NULL);
    if (status == STATUS_OK && folders && exists(targets[0]))
        status = judge_files(compare, targets, target_sides, sides);
    for (int k = 0; k < 2; k++) {
        side_close(&target_sides[k]);
        side_close(&sides[k]);
    }
    return status;
}
