/* Findings about two states of the program, from results (diff.c) or from both programs run side by side (ab.c), and
   how they are shown (diff_show.c). */
#ifndef SASBENCH_GATE_DIFF_H
#define SASBENCH_GATE_DIFF_H

#include "results/results.h"

enum verdict {
    VERDICT_WORSE,   /* beyond the slack, or of --ab: beyond the effect that fails */
    VERDICT_GONE,    /* defined in OLD only */
    VERDICT_CHANGED, /* better by much or in many rows, which may be a fault in the measuring */
    VERDICT_WARNING, /* of --ab: slower, beyond the effect that warns */
    VERDICT_NOISY,   /* of --ab: too noisy to tell */
    VERDICT_BETTER,
    VERDICT_NEW, /* defined in NEW only */
    VERDICT_SAME,
    VERDICTS
};
extern const char *const verdict_names[VERDICTS];
extern const char *const class_names[]; /* by enum metric_class */
enum { CLASSES = CLASS_TIME + 1 };

/* One finding. Texts are borrowed or belong to the struct diff. */
struct finding {
    enum verdict verdict;
    enum metric_class class;
    const char *scene, *spec, *detail; /* detail: which target, which stage; may be empty */
    const char *metric, *unit;
    double before, after;                 /* NAN: not defined */
    const char *before_text, *after_text; /* instead of the numbers where not NULL */
    double change;                        /* after/before - 1 where that is clearer; else NAN */
    double change_low, change_high;       /* interval of the change; both 0: none */
    double slack;                         /* of `after`: a change within it counts as none; NAN: unknown */
    bool lower_is_better;
};

struct diff {
    int finding_count, finding_room;
    struct finding *findings;
    int counts[CLASSES][VERDICTS];
    bool to_baseline; /* OLD is a baseline: what changed asks for a new one */
    int text_count, text_room;
    char **texts; /* that findings and notes point to */
    int note_count;
    const char *notes[64]; /* remarks to read before the findings */
};

/* VERDICT_CHANGED instead of VERDICT_BETTER: a value of quality or work that is better by more than CHANGED_SLACKS
   slacks (of work, which has none: by more than CHANGED_WORK), a metric that is better in CHANGED_ROWS rows or more,
   and a row that is no longer refused. */
enum { CHANGED_SLACKS = 10, CHANGED_ROWS = 5 };
#define CHANGED_WORK 0.01

/* Compare two results folders or CSV files (a folder and a file: the folder's file of that kind). A row is matched by
   scene (and its content), algorithm, options and precision, and in targets.csv by target, axis and definition. Errors:
   STATUS_INVALID as results_read, for different kinds of files, and for a row given twice; STATUS_FAILED without
   memory. *diff is to be freed in any case. */
enum status diff_results(const char *old, const char *new, struct diff *diff);

/* For makers of findings: add a finding (copied, and counted), a remark, and a text that lives as long as the struct
   (NULL without memory, with the status message set). Errors: STATUS_FAILED without memory. */
enum status diff_add(struct diff *diff, const struct finding *finding);
enum status diff_note(struct diff *diff, const char *format, ...) __attribute__((format(printf, 2, 3)));
const char *diff_text(struct diff *diff, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Findings of any class with this verdict. */
int diff_count(const struct diff *diff, enum verdict verdict);
/* STATUS_FAILED, with the numbers, when anything got worse or is gone, or changed from a baseline. */
enum status diff_status(const struct diff *diff);
void diff_free(struct diff *diff);

/* Readable text: remarks, all findings but the same ones, grouped by what may have caused them,
   counts. */
void diff_print(const struct diff *diff, FILE *stream);
/* The same for a comment of a CI, as Markdown; at most 100 findings, the worst first. Errors: of text_file. */
enum status diff_markdown(const struct diff *diff, const char *path);
/* For trackers of benchmarks (github-action-benchmark's customSmallerIsBetter): [{"name", "unit", "value", "range"}] of
   every defined value of NEW that is better when it is smaller; range is the slack. Errors: of text_file. */
enum status diff_json(const struct diff *diff, const char *path);

#endif
