/* A results folder with planted measurements, and the claims that are evaluated by it. */
#ifndef SASBENCH_TEST_PLANTED_H
#define SASBENCH_TEST_PLANTED_H

#include "results/results_folder.h"
#include "claims/claims.h"
#include "tests/support.h"

/* Begin the test's folder anew, and read it back when all rows are there. */
extern struct results_folder *rows;
void planted_begin(void);
void planted_end(struct measured *measured);
/* Forget its measurements. */
void planted_clear(struct measured *measured);

/* A row as if it had been measured; other fields are undefined. */
struct measurement planted_row(const char *scene, const struct spec *spec);
void planted_add(const char *scene, const char *spec_text, double run_s, const char *stages);
/* Azimuth slices of targets [first, first + count) with one ISLR. */
void planted_islr(const char *scene, const char *spec_text, int first, int count, double islr_db);

/* The evaluation on a claim of results/claims.csv; the test fails when its verdict, as printed or corrected, is another
   one. */
struct evaluation evaluation_of(struct measured *measured, const char *id, enum scheme scheme);
void expect(struct measured *measured, const char *id, enum claim_verdict verdict);
void expect_corrected(struct measured *measured, const char *id, enum claim_verdict verdict);

/* Does a text stand in what the claim compares: its cells, or the rows of numbers.csv that they name? */
bool claim_has(const struct claims *claims, const struct claim *claim, const char *text);

/* Read a list of one claim with these two cells; the file is bad.csv in the test's folder. */
enum status planted_claim(const char *comparison, const char *arguments, struct claims *claims);

#endif
