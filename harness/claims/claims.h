/* The claims of BP22, ZP15, LBF21, SQ18 and PF05, sentence by sentence, compared with our measurements. Each row of
   results/claims.csv is a claim: what is compared (quantity.h), and by which comparison (below).

   A result agrees with a printed number within the rounding of its last digit. Where a sentence gives no number
   ("slightly", "far less") the criterion has the limit that we took. */
#ifndef SASBENCH_CLAIMS_CLAIMS_H
#define SASBENCH_CLAIMS_CLAIMS_H

#include "report/published.h"
#include "claims/quantity.h"
#include "papers/tables.h"

struct evaluation {
    enum claim_verdict verdict;
    char evidence[4000]; /* one line, with the numbers */
};

/* Is it a cell with comparisons, or the word `undecided`? */
bool comparison_decides(const char *text);

/* Is it a cell whose answer no measurement can change? */
bool comparison_identity(const char *text);

/* Decide by a cell "COMPARISON(...) and COMPARISON(...) else COMPARISON(...)". The claim holds if all comparisons ahead
   of the first `else` agree (a cell that begins with `else` has none), and under its assumption if all of a part behind
   one agree. If none does but noise hides the answer of one, it is undecided. "identity COMPARISON(...)" is for what no
   measurement can change. Numbers and answers are appended to the evidence. Errors: as quantities_read. */
enum status comparisons_read(struct formula *formula, const char *column, const char *text,
                             struct evaluation *evaluation);

/* Texts belong to the file that was read. */
struct claim {
    const char *id, *paper, *section, *claim;
    const char *criterion; /* the comparisons in words, or why nothing can be decided */
    const char *comparison, *arguments;
    const char *changed; /* "DATE, from VERDICT: REASON" where the criterion changed with the result known; else "" */
    int line;
    bool by_scheme; /* it names LBF: it has a verdict as printed and one corrected (sources.h) */
    bool phases;    /* it needs the phase study */
    bool rules;     /* it needs the rules' study */
    bool scenes;    /* it needs a number of a scene */
    bool times;     /* it needs a time, or a scene that is for times */
    bool measures;  /* else formulas and printed numbers alone decide it */
    int need_count;
    struct need *needs; /* [need_count] the measurements that it needs; owned */
};

enum { CLAIMS_MAX = 400 }; /* that are evaluated together */
struct claims {
    struct csv csv, numbers;
    int count;
    struct claim *claims; /* [count] */
};

/* Every row is checked to its end before the first is evaluated. Errors: those of csv_read; STATUS_INVALID naming file,
   line, column, value and what is accepted. claims_free releases what was read and accepts a zeroed struct. */
enum status claims_read(const char *path, struct claims *claims);
void claims_free(struct claims *claims);

/* The verdict on a claim by one scheme. The evidence is one line: numbers, criterion, each comparison with its
   threshold, settings, scenes with their assumptions, and the tables whose printed numbers are used. Where a
   measurement is missing, failed or unsupported: CLAIM_UNDECIDED with the reason in place of numbers and
   comparisons. */
struct evaluation claim_evaluate(const struct claims *claims, const struct claim *claim, enum scheme scheme,
                                 struct measured *measured);

#endif
