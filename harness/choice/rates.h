/* This machine's rates. */
#ifndef SASBENCH_CHOICE_RATES_H
#define SASBENCH_CHOICE_RATES_H

#include "contract/forecast_time.h"

/* The rates in use: rates_built_in until others are set, so that choices are the same everywhere. One thread calls
   rates_set, before any plan is made. */
const struct rates *rates_get(void);
void rates_set(const struct rates *rates);
/* Are they plausible: none is negative or beyond reason, and all counted work takes time? */
bool rates_plausible(const struct rates *rates);
/* Seconds of a run by all of OpenMP's threads that takes one `alone` seconds. */
double rates_run(double alone);

#endif
