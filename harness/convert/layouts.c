/* The table of layouts, and which one a file has. */
#include "convert/layouts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "convert/layout.h"
#include "text/text_append.h"

static const struct layout *const layouts[] = {&gotcha_layout, &airsas_layout, &cphd_layout, &uff_layout, &zea_layout};

enum { LAYOUTS = sizeof layouts / sizeof *layouts };

double field_number(const struct variable *field, size_t i)
{
    return creal(field->values[i]);
}

enum status field_refuse(const char *path, const struct wanted *wanted, const struct variable *field, const char *why)
{
    char shape[120] = "";
    for (int k = 0; k < DIMENSIONS_MOST; k++)
        if (k < 3 || field->dims[k] != 1)
            text_append(shape, sizeof shape, "%s%zu", k ? " x " : "", field->dims[k]);
    return status_set(STATUS_INVALID, "%s: variable `%s` is [%s], %s; %s is needed", path, wanted->name, shape, why,
                      wanted->accepted);
}

enum status fields_check(const char *path, const struct wanted *fields, int count, const struct variable *variables)
{
    for (int k = 0; k < count; k++) {
        const struct variable *v = &variables[k];
        for (size_t i = 0; v->values && i < variable_count(v); i++) {
            const double complex z = v->values[i];
            if (!isfinite(creal(z)) || !isfinite(cimag(z)))
                return status_set(STATUS_INVALID,
                                  "%s: variable `%s` at (%zu, %zu, %zu) is %g%+gi; finite numbers are "
                                  "needed",
                                  path, fields[k].name, i % v->dims[0] + 1, i / v->dims[0] % v->dims[1] + 1,
                                  i / v->dims[0] / v->dims[1] + 1, creal(z), cimag(z));
        }
    }
    return STATUS_OK;
}

enum status fields_read(const char *path, const struct wanted *fields, int count, struct variable *variables)
{
    enum status status = variables_read(path, fields, count, variables);
    if (status != STATUS_OK)
        return status;
    status = fields_check(path, fields, count, variables);
    if (status != STATUS_OK)
        variables_free(variables, count);
    return status;
}

/* How many of a layout's fields the file has, whatever is in them. */
static enum status fields_count(const char *path, const struct layout *layout, int *found)
{
    const struct pings none = {0};
    struct wanted any[WANTED_MAX] = {{.name = NULL}};
    struct variable variables[WANTED_MAX];
    for (int k = 0; k < layout->field_count; k++)
        any[k] = (struct wanted){layout->fields[k].name, KIND_COMPLEX, true, layout->fields[k].accepted, &none};
    const enum status status = variables_read(path, any, layout->field_count, variables);
    *found = 0;
    for (int k = 0; k < layout->field_count && status == STATUS_OK; k++)
        *found += variables[k].dims[0] > 0;
    return status;
}

/* The layout whose files begin as this one does; NULL: none. */
static const struct layout *layout_by_beginning(const char *path)
{
    char begin[16] = "";
    struct stat stats;
    FILE *file = stat(path, &stats) == 0 && S_ISREG(stats.st_mode) ? fopen(path, "rb") : NULL;
    if (file) {
        begin[fread(begin, 1, sizeof begin - 1, file)] = '\0';
        fclose(file);
    }
    for (int k = 0; k < LAYOUTS; k++)
        if (layouts[k]->begin && strncmp(begin, layouts[k]->begin, strlen(layouts[k]->begin)) == 0)
            return layouts[k];
    return NULL;
}

static enum status layout_find(const char *path, const struct layout **layout)
{
    char known[600] = "";
    int most = 0;
    *layout = layout_by_beginning(path);
    if (*layout)
        return STATUS_OK;
    for (int k = 0; k < LAYOUTS; k++) {
        int found = 0;
        const enum status status = layouts[k]->fields ? fields_count(path, layouts[k], &found) : STATUS_OK;
        if (status != STATUS_OK)
            return status;
        if (found > most) {
            most = found;
            *layout = layouts[k];
        }
        text_append(known, sizeof known, "%s%s (%s, ...)", k ? ", " : "", layouts[k]->name,
                    layouts[k]->fields ? layouts[k]->fields[0].name : layouts[k]->begin);
    }
    return most > 0 ? STATUS_OK
                    : status_set(STATUS_INVALID, "%s: has no field of a known layout; known: %s", path, known);
}

void recording_free(struct recording *recording)
{
    if (recording->source_close)
        recording->source_close(recording->source.with);
    echoes_free(&recording->echoes);
    acquisition_free(&recording->acquisition);
}

enum status recording_read(const char *const *paths, int count, struct recording *recording)
{
    const struct layout *first = NULL, *other = NULL;
    *recording = (struct recording){.layout = NULL};
    enum status status = layout_find(paths[0], &first);
    for (int k = 1; k < count && status == STATUS_OK; k++) {
        status = layout_find(paths[k], &other);
        if (status == STATUS_OK && other != first)
            status = status_set(STATUS_INVALID, "%s: is %s, %s is %s; files of one layout are needed", paths[k],
                                other->name, paths[0], first->name);
    }
    if (status != STATUS_OK)
        return status;
    if (count > 1 && !first->takes_several)
        return status_set(STATUS_INVALID, "%s: is %s, of which one file is converted at a time; %d are given", paths[0],
                          first->name, count);
    recording->layout = first->name;
    status = first->read(paths, count, recording);
    if (status == STATUS_OK)
        status = acquisition_check(&recording->acquisition, paths[0]);
    if (status != STATUS_OK)
        recording_free(recording);
    return status;
}
