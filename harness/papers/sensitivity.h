/* Which verdicts depend on what the papers do not print? */
#ifndef SASBENCH_PAPERS_SENSITIVITY_H
#define SASBENCH_PAPERS_SENSITIVITY_H

#include "papers/claims.h"

/* Measure all that verdicts on image quality rest on under each set of assumptions, into DIR/sensitivity-NAME, and
   write DIR/sensitivity.md: a row a claim, a column an assumption, flips marked. Verdicts on times, and those of
   the phase study, take no part. `measure` measures needs into a folder. Errors: of measuring; of files. */
enum status sensitivity_study(const char *directory, const struct claims *claims,
                              enum status (*measure)(const char *directory, struct need *needs, int count));

#endif
