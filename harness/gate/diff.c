/* Two results, row by row (diff.h): rows are matched by their keys (diff_side.h), values compared by slacks. */
#include "gate/diff.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "gate/diff_side.h"
#include "measure/timing.h"

/* --- Comparing ------------------------------------------------------------------------------------------------- */

static enum verdict values_compare(const struct column *metric, double before, double after, double *slack)
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

/* NEW's time over OLD's, each divided by the scalar reference loop measured beside it: of the median and the
   least time, the ratio nearer to 1. Load on a few runs seldom moves both. NAN when it cannot be reported. */
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

/* What a comparison of two sides needs. */
struct comparing {
    struct diff *diff;
    struct diff_side *old, *new;
    const struct column *columns;
    double *ratios; /* [ratio_count] of the times */
    int ratio_count;
    bool threads_differ;
};

/* The row as on the command line, for the findings. */
static enum status describe(struct diff *diff, const struct row_key *key, struct finding *finding)
{
    bool is_double = strcmp(key->precision, "double") == 0, options = *key->options;
    finding->scene = diff_text(diff, "%s", key->scene);
    finding->spec = diff_text(diff, "%s%s%s%s%s", key->algorithm, options || is_double ? ":" : "", key->options,
                              options && is_double ? "," : "", is_double ? "precision=double" : "");
    finding->detail =
        *key->axis ? diff_text(diff, "target %d, %s, %s", key->target + 1, key->axis, key->definition) : "";
    return finding->scene && finding->spec && finding->detail ? STATUS_OK : STATUS_FAILED;
}

/* A finding about a whole row. */
static enum status add_row(struct diff *diff, const struct row_key *key, enum verdict verdict, const char *metric,
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
                              .before_text = diff_text(diff, "%s", before),
                              .after_text = diff_text(diff, "%s", after)};
    if (!finding.before_text || !finding.after_text || describe(diff, key, &finding) != STATUS_OK)
        return STATUS_FAILED;
    return diff_add(diff, &finding);
}

static int status_rank(const char *status)
{
    return strcmp(status, "ok") == 0 ? 0 : strcmp(status, "unsupported") == 0 ? 1 : 2;
}

/* Compare two rows' times. A time on one side only does not matter: a baseline has none. */
static void time_compare(struct comparing *comparing, const struct row_key *key, const struct row_key *found,
                         const struct column *metric, struct finding *finding)
{
    const struct measurement *old = &comparing->old->results.measurements[key->row];
    const struct measurement *new = &comparing->new->results.measurements[found->row];
    double ratio = time_ratio(old, new), limit = 1 + metric->relative_slack;
    bool same_threads = old->threads == new->threads;
    finding->verdict = VERDICTS;
    if (isnan(ratio) || !same_threads) {
        comparing->threads_differ |= !isnan(ratio) && !same_threads;
        return;
    }
    comparing->ratios[comparing->ratio_count++] = ratio;
    finding->change = ratio - 1;
    finding->slack = metric->relative_slack * finding->before;
    finding->verdict = ratio > limit ? VERDICT_WORSE : ratio < 1 / limit ? VERDICT_BETTER : VERDICT_SAME;
}

static enum status pair_compare(struct comparing *comparing, const struct row_key *key, const struct row_key *found)
{
    struct diff *diff = comparing->diff;
    const struct results *old = &comparing->old->results, *new = &comparing->new->results;
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
            comparing->old->closed[key->row] = comparing->new->closed[found->row] = true;
            const char *said = diff_text(diff, "%s%s%s", after, *reason ? ": " : "", reason);
            return !said ? STATUS_FAILED
                         : add_row(diff, key,
                                   worse > 0   ? VERDICT_WORSE
                                   : worse < 0 ? VERDICT_BETTER
                                               : VERDICT_SAME,
                                   "status", before, said);
        }
    }
    struct finding row = {.before = NAN};
    enum status status = describe(diff, key, &row);
    for (const struct column *metric = metric_first(comparing->columns); metric && status == STATUS_OK;
         metric = metric_first(metric + 1)) {
        struct finding finding = row;
        if (csv_column(&old->csv, metric->name) < 0 || csv_column(&new->csv, metric->name) < 0)
            continue; /* files of another version */
        memcpy(&finding.before, old_row + metric->offset, sizeof finding.before);
        memcpy(&finding.after, new_row + metric->offset, sizeof finding.after);
        finding.class = metric->class;
        finding.metric = metric->name;
        finding.unit = metric->unit;
        finding.lower_is_better = metric->better == BETTER_LOWER;
        finding.slack = metric->absolute_slack[precision];
        finding.change = NAN;
        if (metric->class == CLASS_TIME) {
            time_compare(comparing, key, found, metric, &finding);
        } else if (isnan(finding.before) && isnan(finding.after)) {
            continue;
        } else {
            finding.verdict = values_compare(metric, finding.before, finding.after, &finding.slack);
            if (finding.before != 0 && strcmp(metric->unit, "dB") != 0)
                finding.change = finding.after / finding.before - 1;
        }
        if (finding.verdict < VERDICTS)
            status = diff_add(diff, &finding);
    }
    return status;
}

/* The row of the measurement that a target's row belongs to has been reported already. */
static bool is_closed(const struct diff_side *measurements, const struct row_key *key)
{
    const struct row_key *found = measurements ? side_find_measurement(measurements, key) : NULL;
    return found && measurements->closed[found->row];
}

/* All rows of one pair of files in the order of OLD, then the rows of NEW alone. `measurements`: the sides of the
   measurements when these are their targets, else NULL. */
static enum status sides_compare(struct comparing *comparing, const struct diff_side measurements[2])
{
    struct diff_side *old = comparing->old, *new = comparing->new;
    enum status status = STATUS_OK;
    const char *reported = "";
    for (int row = 0; row < old->results.csv.row_count && status == STATUS_OK; row++) {
        struct row_key key = row_key_of(&old->results, row);
        const struct row_key *found = side_find(new, &key);
        const char *before = side_hash(old, key.scene), *after = side_hash(new, key.scene);
        bool changed = found && before && after && strcmp(before, after) != 0;
        if (changed && !measurements && strcmp(reported, key.scene) != 0) {
            reported = key.scene;
            status = diff_note(comparing->diff,
                               "scene %s has another content in NEW: its rows are not comparable, "
                               "so that they are gone and new",
                               key.scene);
        }
        if (status != STATUS_OK)
            break;
        if (found && !changed) {
            new->matched[found->row] = true;
            if (!measurements || !is_closed(&measurements[0], &key))
                status = pair_compare(comparing, &key, found);
        } else {
            old->closed[row] = true;
            if (!measurements || !is_closed(&measurements[0], &key))
                status = add_row(comparing->diff, &key, VERDICT_GONE, "row", "present", "");
        }
    }
    for (int row = 0; row < new->results.csv.row_count &&status == STATUS_OK; row++) {
        struct row_key key = row_key_of(&new->results, row);
        if (new->matched[row])
            continue;
        new->closed[row] = true;
        if (!measurements || !is_closed(&measurements[1], &key))
            status = add_row(comparing->diff, &key, VERDICT_NEW, "row", "", "present");
    }
    return status;
}

/* --- Files and folders --------------------------------------------------------------------------------------- */

static enum status note_side(struct diff *diff, const char *which, const char *path, const struct diff_side *side)
{
    const struct csv *csv = &side->results.csv;
    const char *commit = csv_comment(csv, "commit"), *date = csv_comment(csv, "date"),
               *machine = csv_comment(csv, "machine");
    return diff_note(diff, "%s: %s, %d rows%s%s%s%s%s%s", which, path, csv->row_count, commit ? ", commit " : "",
                     commit ? commit : "", date ? ", " : "", date ? date : "", machine ? ", " : "",
                     machine ? machine : "");
}

static void finding_change(struct diff *diff, struct finding *finding)
{
    diff->counts[finding->class][finding->verdict]--;
    finding->verdict = VERDICT_CHANGED;
    diff->counts[finding->class][finding->verdict]++;
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

/* A fault can flatter as well as harm: mark the findings from `first` on that are better by much, or in many rows. */
static void changes_find(struct diff *diff, int first, const struct column *columns)
{
    for (const struct column *metric = metric_first(columns); metric; metric = metric_first(metric + 1)) {
        int rows = 0;
        for (int k = first; k < diff->finding_count; k++)
            rows += is_betterment(&diff->findings[k]) && strcmp(diff->findings[k].metric, metric->name) == 0;
        for (int k = first; k < diff->finding_count && rows >= CHANGED_ROWS; k++)
            if (is_betterment(&diff->findings[k]) && strcmp(diff->findings[k].metric, metric->name) == 0)
                finding_change(diff, &diff->findings[k]);
    }
    for (int k = first; k < diff->finding_count; k++)
        if (is_betterment(&diff->findings[k]) && is_much(&diff->findings[k]))
            finding_change(diff, &diff->findings[k]);
}

static enum status files_compare(struct diff *diff, const char *const paths[2], struct diff_side sides[2],
                                 const struct diff_side measurements[2])
{
    static const char *const names[2] = {"OLD", "NEW"};
    int before = diff->finding_count;
    struct comparing comparing = {diff, &sides[0], &sides[1], NULL, NULL, 0, false};
    enum status status = STATUS_OK;
    for (int k = 0; k < 2 && status == STATUS_OK; k++)
        status = side_open(paths[k], &sides[k]);
    for (int k = 0; k < 2 && status == STATUS_OK; k++)
        status = note_side(diff, names[k], paths[k], &sides[k]);
    if (status != STATUS_OK)
        return status;
    if (sides[0].results.targets != sides[1].results.targets)
        return status_set(STATUS_INVALID, "%s holds %s and %s holds %s; two of the same kind are needed", paths[0],
                          sides[0].results.targets ? "targets" : "measurements", paths[1],
                          sides[1].results.targets ? "targets" : "measurements");
    comparing.columns = sides[0].results.targets ? target_columns : measurement_columns;
    comparing.ratios = calloc((size_t)sides[0].results.csv.row_count + 1, sizeof *comparing.ratios);
    if (!comparing.ratios)
        return status_set(STATUS_FAILED, "no memory for %d rows", sides[0].results.csv.row_count);
    diff->to_baseline |= !csv_comment(&sides[0].results.csv, "program");
    status = sides_compare(&comparing, measurements);
    changes_find(diff, before, comparing.columns);
    if (status == STATUS_OK && comparing.threads_differ)
        status = diff_note(diff, "threads differ: times are not compared where they do");
    if (status == STATUS_OK && comparing.ratio_count > 0) {
        int count = comparing.ratio_count;
        status = diff_note(
            diff,
            "time against the scalar reference loop: NEW takes %.3g times as long as OLD (median of %d rows); "
            "one row alone is compared beyond a factor of %g (--ab: finer)",
            median(comparing.ratios, count), count, 1 + metric_first(measurement_columns)->relative_slack);
    }
    free(comparing.ratios);
    return status;
}

static bool is_folder(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

/* The file of this name in a folder; a file stands for itself. NULL without memory. */
static const char *path_in(struct diff *diff, const char *path, const char *name)
{
    return is_folder(path) ? diff_text(diff, "%s/%s", path, name) : path;
}

/* The name of a folder's file of the same kind as the other side, a file. */
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

enum status diff_results(const char *old, const char *new, struct diff *diff)
{
    const char *const given[2] = {old, new};
    const char *name = "measurements.csv", *paths[2], *targets[2] = {NULL, NULL};
    bool folders = is_folder(old) && is_folder(new);
    struct diff_side sides[2] = {0}, target_sides[2] = {0};
    enum status status = STATUS_OK;
    *diff = (struct diff){0};
    if (!folders && (is_folder(old) || is_folder(new)))
        status = kind_of(given, &name);
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        paths[k] = path_in(diff, given[k], name);
        if (folders)
            targets[k] = path_in(diff, given[k], "targets.csv");
        if (!paths[k] || (folders && !targets[k]))
            status = STATUS_FAILED;
    }
    if (status == STATUS_OK)
        status = files_compare(diff, paths, sides, NULL);
    if (status == STATUS_OK && folders && access(targets[0], F_OK) == 0)
        status = files_compare(diff, targets, target_sides, sides);
    for (int k = 0; k < 2; k++) {
        side_close(&target_sides[k]);
        side_close(&sides[k]);
    }
    return status;
}
