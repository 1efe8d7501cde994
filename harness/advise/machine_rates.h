/* The rates that planning uses (choice/rates.h), measured on this machine once and kept in the user's cache:
   $XDG_CACHE_HOME/sasbench/rates.csv, or .cache/sasbench/rates.csv in the home folder. */
#ifndef SASBENCH_ADVISE_MACHINE_RATES_H
#define SASBENCH_ADVISE_MACHINE_RATES_H

#include <stddef.h>

#include "choice/rates.h"

/* Measure the rates: some seconds on one thread, without the time that it waits for a processor. Errors: as planning
   and imaging. */
enum status machine_rates_measure(struct rates *rates);

/* Plan with the file's rates if they are plausible and of this machine, instruction set and program; *found (may be
   NULL): whether they are. Nothing else changes. */
void machine_rates_use(bool *found);
/* Write rates to the file, and plan with them. Errors: STATUS_FAILED for implausible rates, which are not used; as
   text_file_open. */
enum status machine_rates_keep(const struct rates *rates);
/* Plan with the file's rates, or measure and keep them where it has none, with a note. Rates that cannot be kept are
   measured again next time, with a warning. Errors: as machine_rates_measure. */
enum status machine_rates_need(void);

#endif
