/* What can be said of a paper's claim, as it is written into claims.csv and shown on a page. */
#ifndef SASBENCH_REPORT_VERDICT_H
#define SASBENCH_REPORT_VERDICT_H

/* Identity: true by arithmetic or by the paper's own formulas and numbers alone; no measurement can change it. */
enum claim_verdict { CLAIM_HOLDS, CLAIM_ASSUMED, CLAIM_IDENTITY, CLAIM_FAILS, CLAIM_UNDECIDED, CLAIM_VERDICTS };
/* "holds", "holds under stated assumption", "identity", "does not hold", "cannot be decided". */
extern const char *const claim_verdict_names[CLAIM_VERDICTS];

#endif
