/* The functions of claims.csv that look numbers up: in the results folder, in published.csv, in scenes. */
#ifndef SASBENCH_CLAIMS_LOOKUP_H
#define SASBENCH_CLAIMS_LOOKUP_H

#include "claims/quantity.h"

/* Is it the name of such a function? */
bool lookup_exists(const char *name);
/* The call of `name`, which stands at `at` and whose opening parenthesis was taken. `accepted` are other functions'
   names, for the message when there is none of that name. Errors: as quantities_read. */
enum status lookup_read(struct formula *formula, const char *at, const char *name, const char *accepted,
                        struct values *values);

#endif
