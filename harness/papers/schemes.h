/* LBF21's method in two schemes, each of which has a verdict of its own: as the paper prints it (theta at the carrier,
   sub-blocks of equal width, cut out and put together with hard edges: section IV-C), and corrected (theta at F, blocks
   evenly spaced in 1/r that blend). The paper's other methods have no sub-blocks and are the same in both. */
#ifndef SASBENCH_PAPERS_SCHEMES_H
#define SASBENCH_PAPERS_SCHEMES_H

#include <stdbool.h>
#include <stddef.h>

enum scheme { SCHEME_PRINTED, SCHEME_CORRECTED, SCHEMES };
/* "as printed", "corrected". */
extern const char *const scheme_names[SCHEMES];

/* The SPEC that `text` means: "LBF:OPTIONS" is rma_lbf with the scheme's options and these; any other text is itself.
   Returns whether the text depends on the scheme. */
bool scheme_spec(enum scheme scheme, const char *text, char *spec, size_t size);

/* The formula of the phase study that `name` means: LBF is Eq. (5), LBF7 is Eq. (7), both with theta at the carrier
   in the one scheme, and Eq. (5) with theta at F in the other. Returns whether the name depends on the scheme. */
bool scheme_formula(enum scheme scheme, const char *name, const char **formula);

#endif
