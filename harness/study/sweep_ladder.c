/* Ladders of settings (sweep_ladder.h). */
#include "study/sweep_ladder.h"

#include <stdlib.h>
#include <string.h>

void ladder_free(struct ladder *ladder)
{
    for (int k = 0; k < ladder->count; k++)
        spec_free(&ladder->specs[k]);
    free(ladder->specs);
    *ladder = (struct ladder){0};
}

/* Takes over what *spec owns. */
static enum status ladder_append(struct ladder *ladder, struct spec *spec)
{
    struct spec *specs = realloc(ladder->specs, ((size_t)ladder->count + 1) * sizeof *specs);
    if (!specs) {
        spec_free(spec);
        return status_set(STATUS_FAILED, "no memory for %d settings", ladder->count + 1);
    }
    ladder->specs = specs;
    specs[ladder->count++] = *spec;
    return STATUS_OK;
}

/* Every spec with every value, the specs varying fastest. `values` are separated by blanks. */
static enum status ladder_multiply(struct ladder *ladder, const char *key, const char *values)
{
    struct ladder product = {0};
    char *copy = strdup(values), *rest = copy;
    enum status status = copy ? STATUS_OK : status_set(STATUS_FAILED, "no memory for the ladder of %s", key);
    for (char *value; status == STATUS_OK && (value = strsep(&rest, " "));)
        for (int k = 0; k < ladder->count && status == STATUS_OK && *value; k++) {
            struct spec varied;
            status = spec_vary(&ladder->specs[k], key, value, &varied);
            if (status == STATUS_OK)
                status = ladder_append(&product, &varied);
        }
    free(copy);
    ladder_free(status == STATUS_OK ? ladder : &product);
    if (status == STATUS_OK)
        *ladder = product;
    return status;
}

static bool ladder_holds(const struct ladder *ladder, const struct spec *spec)
{
    for (int k = 0; k < ladder->count; k++)
        if (spec_equal(&ladder->specs[k], spec))
            return true;
    return false;
}

enum status ladder_add(struct ladder *ladder, const struct spec *start)
{
    const struct algorithm *algorithm = start->algorithm;
    struct ladder own = {0};
    struct spec copy;
    bool exact = algorithm->traits & TRAIT_EXACT;
    enum status status = spec_copy(start, &copy);
    if (status == STATUS_OK)
        status = ladder_append(&own, &copy);
    for (const struct param *p = algorithm->params; status == STATUS_OK && !exact && p && p->name; p++)
        if (p->sweep && !p->terse && !spec_given(start, p->name))
            status = ladder_multiply(&own, p->name, p->sweep);
    if (status == STATUS_OK && !exact && !spec_given(start, "precision"))
        status = ladder_multiply(&own, "precision", "float double");
    for (int k = 0; k < own.count && status == STATUS_OK; k++)
        if (!ladder_holds(ladder, &own.specs[k])) {
            status = ladder_append(ladder, &own.specs[k]);
            own.specs[k] = (struct spec){.algorithm = NULL};
        }
    ladder_free(&own);
    return status;
}
