/* What BP22, ZP15 and LBF21 claim, sentence by sentence, and how our measurements judge it.

   A claim is a row of a table: a function looks up what was measured and compares it with the numbers that the
   sentence itself gives. What counts as agreement is the printed number with its last digit's rounding; where a
   sentence gives no number ("slightly", "far less") the evidence states the criterion that was taken. */
#ifndef SASBENCH_PAPERS_CLAIMS_H
#define SASBENCH_PAPERS_CLAIMS_H

#include "papers/reproduce.h"

enum claim_verdict { CLAIM_HOLDS, CLAIM_ASSUMED, CLAIM_FAILS, CLAIM_UNDECIDED, CLAIM_VERDICTS };
/* "holds", "holds under stated assumption", "does not hold", "cannot be decided". */
extern const char *const claim_verdict_names[CLAIM_VERDICTS];

struct finding {
    enum claim_verdict verdict;
    char evidence[800]; /* one line, with the numbers */
};

struct claim {
    const char *id, *paper, *section, *claim;
    struct finding (*judge)(struct measured *measured); /* what it asks for in vain makes the claim undecided */
};

/* All claims, in tables ended by an id of NULL; the list of tables is ended by NULL. */
extern const struct claim claims_bp22[], claims_zp15[], claims_lbf21_phase[], claims_lbf21[];
extern const struct claim *const claim_tables[];

/* The verdict on a claim. Where a measurement is missing, failed or unsupported: CLAIM_UNDECIDED with the reason. */
struct finding claim_judge(const struct claim *claim, struct measured *measured);

/* ---- for the functions of the claims ---- */

/* Holds if `strict`; else under the assumption that the evidence names if `assumed`; else it does not. */
struct finding finding(bool strict, bool assumed, const char *format, ...) __attribute__((format(printf, 3, 4)));
struct finding finding_undecided(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Of values over several targets. */
struct spread {
    double least, median, largest;
};
/* Of what `spec` has above `other` (NULL: of its own values) in a field of the azimuth slices of targets [first,
   first + count) of a scene: SPREAD(measured, scene, spec, other, "pixel", islr_db, 0, 24). */
#define SPREAD(measured, scene, spec, other, definition, field, first, count)                                        \
    spread_of(measured, scene, spec, other, definition, offsetof(struct target_row, field), #field, first, count)
struct spread spread_of(struct measured *measured, const char *scene, const char *spec, const char *other,
                        const char *definition, size_t offset, const char *name, int first, int count);
/* The larger magnitude of its ends. */
double spread_magnitude(struct spread spread);
/* Of two sets of targets together; the median is the mean of both. */
struct spread spread_join(struct spread a, struct spread b);

#endif
