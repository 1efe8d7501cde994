/* Algorithms from outside the table, made at run time from the text that names them in a SPEC, ahead of the colon of
   its settings: `./my.so` of `./my.so:taps=8`. That text is the algorithm's name in every row, so that a row's SPEC can
   be given again, and two of one name in two folders stay apart. */
#ifndef SASBENCH_GUESTS_GUESTS_H
#define SASBENCH_GUESTS_GUESTS_H

#include <stdbool.h>

#include "contract/algorithm.h"

/* A kind of them: a row of `kinds` in guests.c. */
struct guest_kind {
    /* How many characters at the beginning of a SPEC name one of this kind; 0: it names none. */
    size_t (*length)(const char *spec);
    /* Make it. `name` lives as long as the program. Fill *algorithm, zeroed but for its name; what it points to, its
       `method` included, stays until the program ends. Errors: STATUS_INVALID naming place and cause. */
    enum status (*make)(const char *name, struct algorithm *algorithm);
};
extern const struct guest_kind guest_plugin;   /* a shared object: plugin_load.c */
extern const struct guest_kind guest_external; /* any program: external.c */
extern const struct guest_kind guest_chain;    /* filters ahead of an algorithm: imaging/chain.c; no row of `kinds` */

/* Make the algorithm that a SPEC names, unless the table has it, or it was made before; it is kept until the program
   ends. Only for a SPEC that the user gave: it runs foreign code. Errors: as `make`. */
enum status guest_invite(const char *spec);

/* The algorithm that a SPEC begins with, of the table or invited before; *rest is what follows its name, "" or
   ":settings". NULL without one; *rest then is behind the name that is not known. */
const struct algorithm *guest_find(const char *spec, const char **rest);

/* The last link of a chain "FILTER | FILTER | ALGORITHM:settings", without blanks ahead of it; else the SPEC itself. */
const char *guest_last(const char *spec);
/* Does a link of the SPEC name code from outside the program? */
bool guest_foreign(const char *spec);
/* The same SPEC with one blank on either side of each '|', malloc'ed; NULL without memory. */
char *guest_settle(const char *spec);

#endif
