/* The papers' tables and figures beside our own numbers. */
#ifndef SASBENCH_PAPERS_TABLES_H
#define SASBENCH_PAPERS_TABLES_H

#include "papers/sources.h"

/* The smallest upsampling rate that satisfies BP22 Eq. (20) for bin and resolution (m) at wavelength lambda (m). */
int upsampling_rate(double bin_m, double resolution_m, double wavelength_m);

/* One line of reproduced.csv. Texts are borrowed. */
struct reproduced {
    const char *table, *target, *method, *quantity, *definition, *unit;
    double paper, ours;            /* NAN: not printed, or not measured */
    const char *assumption, *note; /* of the table; of the printed number */
    char missing[400];             /* why `ours` is missing */
};
/* All lines, malloc'ed, [*count], for the caller to free. Tables whose numbers come from plans, which may be large,
   are evaluated only where `asked` ([place in paper_tables]; NULL: all). Errors: STATUS_FAILED without memory. */
enum status tables_evaluate(struct measured *measured, const bool *asked, struct reproduced **lines, int *count);

/* Has it times, or numbers from plans, which may be large? */
bool table_is_full_size(const struct paper_table *table);

/* Is it a figure of the phase study? */
bool table_has_phases(const char *id);

#endif
