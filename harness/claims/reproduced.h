/* What becomes of the papers' tables and claims once all is measured: files in the folder, and text on the terminal. */
#ifndef SASBENCH_CLAIMS_REPRODUCED_H
#define SASBENCH_CLAIMS_REPRODUCED_H

#include "claims/claims.h"

enum { TABLES_MAX = 64 };

/* What was asked for: tables by their place in paper_tables, claims by theirs in the list. */
struct selection {
    const struct claims *claims;
    bool tables[TABLES_MAX], asked[CLAIMS_MAX];
};

/* Print the tables and claims asked for; write reproduced.csv and claims.csv with these, and with what else the folder
   holds all measurements of, so that nothing that was measured earlier is lost. Where all claims were asked for,
   verdicts.md counts and lists them. Errors: those of measured_read, of
   files that cannot be written, of memory. */
enum status reproduced_report(const char *directory, const struct selection *selection);

#endif
