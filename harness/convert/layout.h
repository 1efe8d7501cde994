/* What each layout of recordings has in common: its fields, and how they become echoes. */
#ifndef SASBENCH_CONVERT_LAYOUT_H
#define SASBENCH_CONVERT_LAYOUT_H

#include "convert/layouts.h"
#include "echoes/matvar.h"

struct layout {
    const char *name; /* for messages */
    const struct wanted *fields;
    int field_count; /* <= WANTED_MAX */
    bool takes_several;
    const char *begin; /* what its files begin with, rather than having fields; NULL: fields */
    /* Read `count` files of it. *recording is zeroed before and the caller's afterwards, also after a failure. Errors:
       STATUS_INVALID naming file, field, value and what is accepted; STATUS_FAILED without memory. */
    enum status (*read)(const char *const *paths, int count, struct recording *recording);
};

extern const struct layout airsas_layout, cphd_layout, gotcha_layout, uff_layout, zea_layout;

/* variables_read and fields_check. Same ownership and errors. */
enum status fields_read(const char *path, const struct wanted *fields, int count, struct variable *variables);
/* Refuse numbers that are not finite. Errors: STATUS_INVALID naming the first. */
enum status fields_check(const char *path, const struct wanted *fields, int count, const struct variable *variables);
/* The real part of number i of a field. */
double field_number(const struct variable *field, size_t i);
/* Refuse a field whose shape does not fit; `why` says what it must fit. */
enum status field_refuse(const char *path, const struct wanted *wanted, const struct variable *field, const char *why);

#endif
