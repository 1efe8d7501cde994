/* Recordings in public layouts as echoes. */
#ifndef SASBENCH_CONVERT_LAYOUTS_H
#define SASBENCH_CONVERT_LAYOUTS_H

#include "echoes/echo_data.h"

/* Read the files, all of one layout, which their fields decide. *layout is its name, never freed. *acquisition and
   *echoes (double) are the caller's: acquisition_free, echoes_free. Errors, with nothing to free: STATUS_INVALID naming
   file, field, value and what is accepted; STATUS_FAILED without memory. */
enum status convert_read(const char *const *paths, int count, const char **layout, struct acquisition *acquisition,
                         struct echoes *echoes);

#endif
