/* Recordings in public layouts as echoes. */
#ifndef SASBENCH_CONVERT_LAYOUTS_H
#define SASBENCH_CONVERT_LAYOUTS_H

#include "echoes/matfile.h"

struct recording {
    const char *layout; /* its name */
    struct acquisition acquisition;
    struct echoes echoes; /* double; they point to this acquisition, so the struct must stay where it is */
    /* Echoes that may not fit into memory: of this acquisition, made some pings at a time. No `pings`: `echoes` has
       them. */
    struct sample_source source;
    void (*source_close)(void *with); /* NULL: nothing to close */
    char note[200];                   /* what the user must know of the conversion; empty: nothing */
};

/* Read count >= 1 files, all of one layout, which their fields decide; freed with recording_free. Errors, with nothing
   to free: STATUS_INVALID naming file, field, value and what is accepted; STATUS_FAILED without memory. */
enum status recording_read(const char *const *paths, int count, struct recording *recording);
void recording_free(struct recording *recording);

#endif
