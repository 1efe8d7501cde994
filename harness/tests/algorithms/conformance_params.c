#include "tests/algorithms/conformance_params.h"

#include <stdio.h>
#include <string.h>

#include "imaging/spec.h"
#include "tests/assertions.h"

#define PARAM_FAIL(p, format, ...) fail_msg("%s, %s: " format, algorithm->name, (p)->name, __VA_ARGS__)

void conformance_check_param(const struct algorithm *algorithm, const struct param *p)
{
    size_t size = p->type == PARAM_REAL ? sizeof(double) : sizeof(int);
    if (p->size != size || p->offset % size != 0 || p->offset + size > algorithm->options_size)
        PARAM_FAIL(p, "a field of %zu bytes at %zu of %zu cannot hold its type; declare it by PARAM or PARAM_NAMED",
                   p->size, p->offset, algorithm->options_size);
    if (!(p->initial >= p->min && p->initial <= p->max))
        PARAM_FAIL(p, "the default is %g, must lie from %g to %g", p->initial, p->min, p->max);
    if (!p->summary || !*p->summary || (p->type == PARAM_CHOICE) != (p->choices != NULL))
        PARAM_FAIL(p, "%s", "needs a summary, and choices when it is one");
    char sweep[128], *rest = sweep;
    snprintf(sweep, sizeof sweep, "%s", p->sweep ? p->sweep : "");
    for (char *value; (value = strtok_r(rest, " ", &rest));) {
        char text[256];
        struct spec spec;
        snprintf(text, sizeof text, "%s:%s=%s", algorithm->name, p->name, value);
        if (spec_parse(text, &spec) != STATUS_OK)
            PARAM_FAIL(p, "its sweep holds %s: %s", value, status_message());
        spec_free(&spec);
    }
}
