/* The printed results of BP22, ZP15, LBF21, SQ18 and PF05: the list of their tables and figures, and their numbers,
   which are in results/published.csv alone. */
#ifndef SASBENCH_REPORT_PUBLISHED_H
#define SASBENCH_REPORT_PUBLISHED_H

#include "files/csv.h"

/* The columns of published.csv. */
enum published_column {
    PUBLISHED_TABLE,
    PUBLISHED_TARGET,
    PUBLISHED_METHOD,
    PUBLISHED_QUANTITY,
    PUBLISHED_UNIT,
    PUBLISHED_PAPER,
    PUBLISHED_SOURCE,
    PUBLISHED_NOTE
};

/* Errors: those of csv_read; STATUS_INVALID naming a column that is not in its place. */
enum status published_read(struct csv *csv);

/* The numbers of one method and quantity, in the file's order, into values [room]; returns their number. `targets`
   is a target, or FIRST..LAST for the rows from the first target's first to the last target's last. Empty cells are
   left out. */
int published_values(const struct csv *csv, const char *table, const char *targets, const char *method,
                     const char *quantity, double *values, int room);

/* One of the papers' tables or figures, or the claims; `id` is its name on the command line. */
struct paper_table {
    const char *id, *title;
    const char *assumption; /* what we had to assume */
    const char *base;       /* the method that times are divided by; NULL: no times */
};
extern const struct paper_table paper_tables[]; /* id NULL ends */

/* Identity: true by arithmetic or by the paper's own formulas and numbers alone; no measurement can change it. */
enum claim_verdict { CLAIM_HOLDS, CLAIM_ASSUMED, CLAIM_IDENTITY, CLAIM_FAILS, CLAIM_UNDECIDED, CLAIM_VERDICTS };
/* "holds", "holds under stated assumption", "identity", "does not hold", "cannot be decided". */
extern const char *const claim_verdict_names[CLAIM_VERDICTS];

#endif
