/* The papers' tables and claims beside our own measurements: measured, printed, and written into a results folder. */
#ifndef SASBENCH_CLAIMS_REPRODUCE_H
#define SASBENCH_CLAIMS_REPRODUCE_H

#include "claims/claims.h"
#include "contract/status.h"

/* The tables of these ids (all of them when count is 0), measured where the folder does not have them yet. A shard
   ("3/8", NULL: none) is measured alone. Errors:
   STATUS_INVALID for an unknown id (listing the accepted ones), a folder whose claims.csv is the list of claims, or
   files that cannot be read or written; STATUS_FAILED when a measurement failed. */
enum status papers_reproduce(const char *const *ids, int count, const char *directory, const char *part);

enum { TABLES_MAX = 64 };

/* The request: tables by their place in paper_tables, claims by theirs in the list. */
struct selection {
    const struct claims *claims;
    bool tables[TABLES_MAX], asked[CLAIMS_MAX];
};

/* Print the requested tables and claims. Write them into reproduced.csv and claims.csv, with all others that the folder
   has the measurements of, so that no earlier result is lost. If all claims are requested, verdicts.md counts and lists
   them. Errors: those of measured_read, of files that cannot be written, of memory. */
enum status reproduced_report(const char *directory, const struct selection *selection);

/* Measure, under each set of assumptions and into DIR/sensitivity, what the verdicts of BP22, ZP15 and LBF21 on image
   quality and phase rest on. Write DIR/sensitivity.md: the verdicts that flip, a row a claim, a column a set of
   assumptions, and the IDs of those that do not. Verdicts on times, and those without a scene, are left out; what a set
   does not change is measured once. `measure` measures needs into a folder, which it makes. Errors: of measuring; of
   files. */
enum status sensitivity_study(const char *directory, const struct claims *claims,
                              enum status (*measure)(const char *directory, struct need *needs, int count));

/* Of each claim by its place in the list. */
struct verdicts {
    const struct claims *claims;
    bool evaluated[CLAIMS_MAX];
    bool noisy[CLAIMS_MAX]; /* as printed: undecided because a time lies within the noise of its run */
    enum claim_verdict of[CLAIMS_MAX][SCHEMES];
};

/* A claim's evaluations by each scheme; a claim that names no scheme has the first alone. */
void verdicts_add(struct verdicts *verdicts, int claim, const struct evaluation evaluations[SCHEMES]);

/* The counts of the evaluated claims, by scheme. */
void verdicts_print(FILE *stream, const struct verdicts *verdicts);

/* Write the counts by paper and scheme, and a row for each evaluated claim, in Markdown; `head`: what was measured with
   what. Errors: of files. */
enum status verdicts_write(const char *path, const char *head, const struct verdicts *verdicts);

#endif
