/* SPEC on the command line: NAME or NAME:key=value,key=value; NAME of the table, or invited (guests.h). */
#ifndef SASBENCH_IMAGING_SPEC_H
#define SASBENCH_IMAGING_SPEC_H

#include <stdint.h>

#include "contract/algorithm.h"

struct spec {
    const struct algorithm *algorithm;
    enum precision precision;
    void *options;  /* options_size bytes, malloc'ed; NULL without options */
    char text[256]; /* canonical options without precision, every param: "taps=8,window=none" */
    uint64_t given; /* bit k: params[k] was named in the SPEC; the bit above the last: precision */
};

/* Errors: STATUS_INVALID naming the SPEC, the key or value, and what is accepted. spec_free releases *spec. */
enum status spec_parse(const char *text, struct spec *spec);
/* The same of a SPEC that the user gave, which may name code of the user's own. Errors: also as guest_invite. */
enum status spec_asked(const char *text, struct spec *spec);
/* The same of a SPEC from a file of the program's: a chain of its own algorithms at most. */
enum status spec_own(const char *text, struct spec *spec);
void spec_free(struct spec *spec);

/* A copy; the same with one more setting. Errors: STATUS_FAILED without memory; as spec_parse, also when the key was
   given before. The copy is then zeroed. */
enum status spec_copy(const struct spec *spec, struct spec *copy);
enum status spec_vary(const struct spec *spec, const char *key, const char *value, struct spec *varied);
/* Was the key named in the SPEC? */
bool spec_given(const struct spec *spec, const char *key);
/* Do both ask for the same image? */
bool spec_equal(const struct spec *a, const struct spec *b);

/* One param's value as text ("8", "kaiser") into a buffer. */
void param_format(const struct param *param, double value, char *text, size_t size);

#endif
