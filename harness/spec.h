/* SPEC on the command line: NAME or NAME:key=value,key=value. */
#ifndef SASBENCH_SPEC_H
#define SASBENCH_SPEC_H

#include "../algorithms/algorithm.h"

struct spec {
    const struct algorithm *algorithm;
    enum precision precision;
    void *options;                  /* options_size bytes, malloc'ed; NULL without options */
    char text[256];                 /* canonical options without precision, every param: "taps=8,window=none" */
};

/* Errors: STATUS_INVALID naming the SPEC, the key or value, and what is accepted. spec_free releases *spec. */
enum status spec_parse(const char *text, struct spec *spec);
void spec_free(struct spec *spec);

/* One param's value as text ("8", "kaiser") into a buffer. */
void param_format(const struct param *param, double value, char *text, size_t size);

#endif
