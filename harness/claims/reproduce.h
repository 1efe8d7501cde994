/* The papers' tables and claims beside our own measurements: measured, printed, and written into a results folder. */
#ifndef SASBENCH_CLAIMS_REPRODUCE_H
#define SASBENCH_CLAIMS_REPRODUCE_H

#include "claims/claims.h"
#include "contract/status.h"

/* What `reproduce` is asked for; texts are borrowed. */
struct reproduction {
    const char *const *ids; /* [count] tables, claims, or `sensitivity` alone; 0: all tables and claims */
    int count;
    const char *directory, *shard; /* shard: "3/8", or NULL; it is measured alone */
    bool quick;                    /* image quality and phase alone: no times, full-size scenes or scenes from seeds */
    bool docs;                     /* write the pages of docs/papers afterwards */
};
/* Measure what the folder does not have yet, and report it. What is quick, and `sensitivity`, is measured into
   DIR/untimed. Errors: STATUS_INVALID for an unknown id (listing the accepted ones), parts of the request that exclude
   each other, a folder whose claims.csv is the list of claims, or files that cannot be read or written; STATUS_FAILED
   when a measurement failed. */
enum status papers_reproduce(const struct reproduction *request);

enum { TABLES_MAX = 64 };

/* The request: tables by their place in paper_tables, claims by theirs in the list. */
struct selection {
    const struct claims *claims;
    bool tables[TABLES_MAX], asked[CLAIMS_MAX];
};

/* Print the requested tables and claims. Write them into reproduced.csv and claims.csv, with all others that the folder
   has the measurements of, so that no earlier result is lost. Errors: those of measured_read, of files that cannot be
   written, of memory. */
enum status reproduced_report(const char *directory, const struct selection *selection);

/* The head of a file: "sasbench WHAT 1", where, when and with what it was measured. */
void reproduced_head(FILE *file, const char *what, const struct measured *measured);

/* Measure into `untimed`, under each set of assumptions, what the verdicts on image quality and phase rest on. Write
   DIR/sensitivity.csv: a row a claim, scheme and set, with the verdict. Verdicts on times, and those without a scene,
   are left out; what a set does not change is measured once. `measure` measures needs into a folder, which it makes.
   Errors: of measuring; of files. */
enum status sensitivity_study(const char *directory, const char *untimed, const struct claims *claims,
                              enum status (*measure)(const char *directory, struct need *needs, int count));

/* One page a paper, as Markdown, from claims.csv, reproduced.csv, sensitivity.csv (unless it is missing) and the
   pictures of the folder `from`, into the folder `to`, which is made: what does not hold, how near the printed numbers
   are, each table, figure and claim. Errors: of files; STATUS_INVALID where a claim is missing in claims.csv. */
enum status pages_write(const char *from, const char *to, const struct claims *claims);

#endif
