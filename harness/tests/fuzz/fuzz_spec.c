/* Any text as SPEC and as GRID. What is accepted as a SPEC, written out again, is the same SPEC. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "imaging/spec.h"
#include "scene/scene.h"
#include "tests/fuzz/input.h"

static void spec_try(const char *text)
{
    struct spec spec, again;
    if (spec_parse(text, &spec) != STATUS_OK) {
        if (!*status_message())
            fuzz_fail("refused without a message");
        return;
    }
    char written[512];
    snprintf(written, sizeof written, "%s:%s%sprecision=%s", spec.algorithm->name, spec.text, *spec.text ? "," : "",
             spec.precision == PRECISION_DOUBLE ? "double" : "float");
    if (spec_parse(written, &again) != STATUS_OK || !spec_equal(&spec, &again))
        fuzz_fail("'%s' is another SPEC: %s", written, status_message());
    spec_free(&again);
    spec_free(&spec);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct grid grid;
    char *text = malloc(size + 1);
    if (!text)
        return 0;
    memcpy(text, data, size);
    text[size] = '\0';
    spec_try(text);
    if (grid_parse(text, &grid) == STATUS_OK
        && !(grid.x_count >= 1 && grid.r_count >= 1 && grid.x_step > 0 && grid.r_step > 0))
        fuzz_fail("a grid of %d x %d pixels", grid.x_count, grid.r_count);
    free(text);
    return 0;
}
