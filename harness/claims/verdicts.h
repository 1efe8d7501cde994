/* How many claims have each verdict, and which: as printed on the terminal and as a page of the documentation. */
#ifndef SASBENCH_CLAIMS_VERDICTS_H
#define SASBENCH_CLAIMS_VERDICTS_H

#include "claims/claims.h"

/* Of each claim by its place in the list. */
struct verdicts {
    const struct claims *claims;
    bool evaluated[CLAIMS_MAX];
    bool noisy[CLAIMS_MAX]; /* as printed: nothing is decided because a time lies within the noise of its run */
    enum claim_verdict of[CLAIMS_MAX][SCHEMES];
};

/* A claim's evaluations by each scheme; one that names no scheme has the first alone. */
void verdicts_add(struct verdicts *verdicts, int claim, const struct evaluation evaluations[SCHEMES]);

/* The counts of those that were evaluated, by scheme. */
void verdicts_print(FILE *stream, const struct verdicts *verdicts);

/* The counts by paper and scheme, and a row for each claim that was evaluated, in Markdown; `head`: what was
   measured with what. Errors: of files. */
enum status verdicts_write(const char *path, const char *head, const struct verdicts *verdicts);

#endif
