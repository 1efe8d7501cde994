/* The settings of a parameter sweep (sweep_settings.h). */
#include "sweep/sweep_settings.h"

#include <stdlib.h>
#include <string.h>

void settings_free(struct sweep_settings *settings)
{
    for (int k = 0; k < settings->count; k++)
        spec_free(&settings->specs[k]);
    free(settings->specs);
    *settings = (struct sweep_settings){0};
}

/* Takes ownership of what *spec owns. */
static enum status settings_append(struct sweep_settings *settings, struct spec *spec)
{
    struct spec *specs = realloc(settings->specs, ((size_t)settings->count + 1) * sizeof *specs);
    if (!specs) {
        spec_free(spec);
        return status_set(STATUS_FAILED, "no memory for %d settings", settings->count + 1);
    }
    settings->specs = specs;
    specs[settings->count++] = *spec;
    return STATUS_OK;
}

/* Every spec with every value, the specs varying fastest. `values` are separated by blanks. */
static enum status settings_multiply(struct sweep_settings *settings, const char *key, const char *values)
{
    struct sweep_settings product = {0};
    char *copy = strdup(values), *rest = copy;
    enum status status = copy ? STATUS_OK : status_set(STATUS_FAILED, "no memory for the values of %s", key);
    for (char *value; status == STATUS_OK && (value = strsep(&rest, " "));)
        for (int k = 0; k < settings->count && status == STATUS_OK && *value; k++) {
            struct spec varied;
            status = spec_vary(&settings->specs[k], key, value, &varied);
            if (status == STATUS_OK)
                status = settings_append(&product, &varied);
        }
    free(copy);
    settings_free(status == STATUS_OK ? settings : &product);
    if (status == STATUS_OK)
        *settings = product;
    return status;
}

static bool settings_holds(const struct sweep_settings *settings, const struct spec *spec)
{
    for (int k = 0; k < settings->count; k++)
        if (spec_equal(&settings->specs[k], spec))
            return true;
    return false;
}

enum status settings_add(struct sweep_settings *settings, const struct spec *start)
{
    const struct algorithm *algorithm = start->algorithm;
    struct sweep_settings own = {0};
    struct spec copy;
    bool exact = algorithm->traits & TRAIT_EXACT;
    enum status status = spec_copy(start, &copy);
    if (status == STATUS_OK)
        status = settings_append(&own, &copy);
    for (const struct param *p = algorithm->params; status == STATUS_OK && !exact && p && p->name; p++)
        if (p->sweep && !p->terse && !spec_given(start, p->name))
            status = settings_multiply(&own, p->name, p->sweep);
    if (status == STATUS_OK && !exact && !spec_given(start, "precision"))
        status = settings_multiply(&own, "precision", "float double");
    for (int k = 0; k < own.count && status == STATUS_OK; k++)
        if (!settings_holds(settings, &own.specs[k])) {
            status = settings_append(settings, &own.specs[k]);
            own.specs[k] = (struct spec){.algorithm = NULL};
        }
    settings_free(&own);
    return status;
}

static enum status add(const struct spec *spec, const char *precision, struct sweep_settings *settings)
{
    struct spec fixed;
    if (!precision || spec_given(spec, "precision"))
        return settings_add(settings, spec);
    enum status status = spec_vary(spec, "precision", precision, &fixed);
    if (status != STATUS_OK)
        return status;
    status = settings_add(settings, &fixed);
    spec_free(&fixed);
    return status;
}

/* The exact image comes first: the others save its cost, and their PSLR and ISLR are compared with its. */
enum status settings_load(int count, const struct spec *specs, const char *precision, struct sweep_settings *settings)
{
    struct spec spec;
    enum status status = spec_parse("reference", &spec);
    if (status == STATUS_OK)
        status = settings_add(settings, &spec);
    spec_free(&spec);
    for (int k = 0; k < count && status == STATUS_OK; k++)
        status = add(&specs[k], precision, settings);
    return status;
}
