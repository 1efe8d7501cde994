/* The settings that `sweep` measures: every algorithm over the values of its params. */
#ifndef SASBENCH_SWEEP_SWEEP_SETTINGS_H
#define SASBENCH_SWEEP_SWEEP_SETTINGS_H

#include "imaging/spec.h"

/* Freed with settings_free, which accepts a zeroed struct. */
struct sweep_settings {
    struct spec *specs; /* [count], no two equal */
    int count;
};

/* Append `start` with every combination of the values in its params' `sweep`, in float and in double. Values given
   in the SPEC stay, and so do the defaults of terse params. An exact algorithm has nothing to trade: it is appended
   once, unchanged. Errors: STATUS_FAILED without memory; STATUS_INVALID when `sweep` names a value that the param
   refuses. */
enum status settings_add(struct sweep_settings *settings, const struct spec *start);
/* The exact image, then these SPECs over their settings; in `precision`, "float" or "double", where a SPEC states none
   (NULL: in both). Errors: as settings_add, spec_vary. */
enum status settings_load(int count, const struct spec *specs, const char *precision, struct sweep_settings *settings);
void settings_free(struct sweep_settings *settings);

#endif
