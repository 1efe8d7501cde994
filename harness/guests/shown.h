/* Acquisitions and grids as others see them, by sasbench.h. */
#ifndef SASBENCH_GUESTS_SHOWN_H
#define SASBENCH_GUESTS_SHOWN_H

#include "contract/acquisition.h"
#include "contract/algorithm.h"
#include "sasbench.h"

/* Borrows the arrays. */
struct sas_acquisition acquisition_show(const struct acquisition *acquisition);
struct sas_grid grid_show(const struct grid *grid);

/* Copy what others state into *out, whose fields that sasbench.h lacks stay as they are. Errors: STATUS_INVALID naming
   `name`, number, value and what is accepted; STATUS_FAILED without memory. *out is then {0}. */
enum status acquisition_take(const char *name, const struct sas_acquisition *shown, struct acquisition *out);

#endif
