/* Which verdicts depend on what the papers do not print? */
#ifndef SASBENCH_CLAIMS_SENSITIVITY_H
#define SASBENCH_CLAIMS_SENSITIVITY_H

#include "claims/claims.h"

/* Measure all that verdicts of BP22, ZP15 and LBF21 on image quality and phase rest on under each set of assumptions,
   into DIR/sensitivity, and write DIR/sensitivity.md: the verdicts that flip, a row a claim, a column a set of
   assumptions, and the IDs of those that do not. Verdicts on times, and those that no scene takes part in, are left
   out; what a set does not change is measured once. `measure` measures needs into a folder, which it makes. Errors: of
   measuring; of files. */
enum status sensitivity_study(const char *directory, const struct claims *claims,
                              enum status (*measure)(const char *directory, struct need *needs, int count));

#endif
