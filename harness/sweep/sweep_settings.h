/* The settings that `sweep` measures: every algorithm over the values of its params. */
#ifndef SASBENCH_SWEEP_SWEEP_SETTINGS_H
#define SASBENCH_SWEEP_SWEEP_SETTINGS_H

#include "imaging/spec.h"

/* Freed with settings_free, which accepts a zeroed struct. */
struct sweep_settings {
    struct spec *specs; /* [count], no two equal */
    int count;
};

/* Append `start` with every combination of the values that its params' `sweep` names, in float and in double. What
   was given in the SPEC stays as it is, and so do the terse params, whose defaults are meant to be kept. An exact
   algorithm has nothing to trade: it is appended once, as it is. Errors: STATUS_FAILED without memory; STATUS_INVALID
   when `sweep` names a value that the param does not take. */
enum status settings_add(struct sweep_settings *settings, const struct spec *start);
void settings_free(struct sweep_settings *settings);

#endif
