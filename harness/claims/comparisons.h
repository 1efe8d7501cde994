/* Comparisons: comparisons that decide a claim, by name in claims.csv. */
#ifndef SASBENCH_CLAIMS_COMPARISONS_H
#define SASBENCH_CLAIMS_COMPARISONS_H

#include "report/verdict.h"
#include "claims/quantity.h"

struct evaluation {
    enum claim_verdict verdict;
    char evidence[4000]; /* one line, with the numbers */
};

/* Is it a cell with comparisons, or the word `undecided`? */
bool comparison_decides(const char *text);

/* Does it say that no measurement can change the answer? */
bool comparison_identity(const char *text);

/* Decide by a cell "COMPARISON(...) and COMPARISON(...) else COMPARISON(...)": the claim holds if all comparisons
   ahead of the first `else` agree (a cell that begins with `else` has none), and under its assumption if all of a
   part behind one do; where none does but noise hides what one says, nothing is decided. "identity COMPARISON(...)"
   is for what no measurement can change. Their numbers and answers are appended to the evidence. Errors: as
   quantities_read. */
enum status comparisons_read(struct formula *formula, const char *column, const char *text,
                             struct evaluation *evaluation);

#endif
