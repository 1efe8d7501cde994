/* The rates that planning goes by (choice/rates.h), measured on this machine once and kept in the user's cache:
   $XDG_CACHE_HOME/sasbench/rates.csv, or .cache/sasbench/rates.csv in the home folder. */
#ifndef SASBENCH_ADVISE_MACHINE_RATES_H
#define SASBENCH_ADVISE_MACHINE_RATES_H

#include <stddef.h>

#include "choice/rates.h"

/* Measure them: some seconds on one thread, without the time that it waits for a processor. Errors: as planning and
   imaging. */
enum status machine_rates_measure(struct rates *rates);

/* The file's path; empty where the environment names no folder. */
void machine_rates_path(char *path, size_t size);
/* Let planning go by the rates of the file, where it holds plausible ones of this machine, instruction set and program;
   *found (may be NULL) says whether it does. Nothing else changes. */
void machine_rates_use(bool *found);
/* Write rates there, and let planning go by them. Errors: STATUS_FAILED for rates that are not plausible, which nothing
   goes by; as text_file_open. */
enum status machine_rates_keep(const struct rates *rates);
/* Let planning go by those of the file, or measure and keep them where it has none, with a note. Rates
   that cannot be kept are measured again next time, with a warning. Errors: as machine_rates_measure. */
enum status machine_rates_need(void);

#endif
