/* What BP22, ZP15, LBF21, SQ18 and PF05 claim, sentence by sentence, and how our measurements comparison it:
   results/claims.csv, a row a claim, names what is compared (quantity.h) and by which comparison (below).

   What counts as agreement is the printed number with its last digit's rounding; where a sentence gives no number
   ("slightly", "far less") the criterion says what was taken. */
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

/* Does it say that no measurement can change the answer? */
bool comparison_identity(const char *text);

/* Decide by a cell "COMPARISON(...) and COMPARISON(...) else COMPARISON(...)": the claim holds if all comparisons
   ahead of the first `else` agree (a cell that begins with `else` has none), and under its assumption if all of a
   part behind one do; where none does but noise hides what one says, nothing is decided. "identity COMPARISON(...)"
   is for what no measurement can change. Their numbers and answers are appended to the evidence. Errors: as
   quantities_read. */
enum status comparisons_read(struct formula *formula, const char *column, const char *text,
                             struct evaluation *evaluation);

#define CLAIMS_FILE  SASBENCH_ROOT "/results/claims.csv"
#define NUMBERS_FILE SASBENCH_ROOT "/results/numbers.csv" /* that claims name */

/* Texts belong to the file that was read. */
struct claim {
    const char *id, *paper, *section, *claim;
    const char *criterion; /* the comparisons in words, or why nothing can be decided */
    const char *comparison, *arguments;
    int line;
    bool by_scheme; /* it names LBF: it has a verdict as printed and one corrected (sources.h) */
    bool phases;    /* it asks for the phase study */
    bool rules;     /* it asks for the rules' study */
    bool scenes;    /* it asks for a number of a scene */
    bool times;     /* it asks for a time, or for a scene that is for times */
    bool measures;  /* else it is decided by formulas and printed numbers alone */
    int need_count;
    struct need *needs; /* [need_count] the measurements that it asks for; owned */
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

/* The verdict on a claim by one scheme. The evidence is one line: the numbers, the criterion, each comparison with its
   threshold, the settings, the scenes with what these assume, and the tables whose printed numbers are used. Where a
   measurement is missing, failed or unsupported: CLAIM_UNDECIDED with the reason in place of numbers and
   comparisons. */
struct evaluation claim_evaluate(const struct claims *claims, const struct claim *claim, enum scheme scheme,
                                 struct measured *measured);

#endif
