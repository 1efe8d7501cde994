/* This machine's rates. */
#ifndef SASBENCH_CHOICE_RATES_H
#define SASBENCH_CHOICE_RATES_H

#include "common/rates.h"

/* The rates in use: rates_built_in until others are set, so that choices are the same everywhere. One thread calls
   rates_set, before any plan is made. */
const struct rates *rates_get(void);
void rates_set(const struct rates *rates);
/* Are they plausible: none is negative or beyond reason, and all counted work takes time? */
bool rates_plausible(const struct rates *rates);

#endif
