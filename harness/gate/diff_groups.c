/* Findings by what may have caused them (diff_groups.h). */
#include "gate/diff_groups.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char precision_text[] = "precision=double";

static bool is_double(const char *spec)
{
    return strstr(spec, precision_text) != NULL;
}

/* "bp_sinc:taps=8,precision=double" and "bp_sinc:taps=8" are one cause. */
static void cause_make(const char *spec, char *cause, size_t size)
{
    const char *at = strstr(spec, precision_text);
    const size_t length = at ? (size_t)(at - spec) - (at > spec) : strlen(spec);
    snprintf(cause, size, "%.*s", (int)length, spec);
}

/* The size of the change: in slacks or, without them, relative; a row that is gone has the largest. */
static double distance(const struct finding *f)
{
    const double moved = fabs(f->after - f->before);
    if (isnan(moved))
        return INFINITY;
    return f->slack > 0 ? moved / f->slack : isnan(f->change) ? moved : fabs(f->change);
}

static int order_by_cause(const void *a, const void *b)
{
    const struct finding *x = *(const struct finding *const *)a, *y = *(const struct finding *const *)b;
    char cause[2][200];
    cause_make(x->spec, cause[0], sizeof cause[0]);
    cause_make(y->spec, cause[1], sizeof cause[1]);
    int order = (x->verdict > y->verdict) - (x->verdict < y->verdict);
    order = order ? order : (x->class > y->class) - (x->class < y->class);
    order = order ? order : strcmp(cause[0], cause[1]);
    order = order ? order : (distance(x) < distance(y)) - (distance(x) > distance(y));
    return order ? order : (x > y) - (x < y);
}

static int order_by_size(const void *a, const void *b)
{
    const struct finding_group *x = a, *y = b;
    int order = (x->verdict > y->verdict) - (x->verdict < y->verdict);
    order = order ? order : (x->class > y->class) - (x->class < y->class);
    order = order ? order : (x->count < y->count) - (x->count > y->count);
    return order ? order : (x->first > y->first) - (x->first < y->first);
}

/* Is this the first of the findings of one group with its metric, or its scene? */
static bool is_first(const struct finding *const *list, int k, bool by_scene)
{
    for (int n = 0; n < k; n++)
        if (strcmp(by_scene ? list[n]->scene : list[n]->metric, by_scene ? list[k]->scene : list[k]->metric) == 0)
            return false;
    return true;
}

enum { SEARCHED_MOST = 2000 }; /* beyond, metrics and scenes of a group are those of so many findings */

static void what_make(const struct finding *const *list, struct finding_group *group)
{
    int scenes = 0, doubles = 0;
    size_t used = 0;
    for (int k = 0; k < group->count && k < SEARCHED_MOST; k++) {
        scenes += is_first(list, k, true);
        doubles += is_double(list[k]->spec);
        if (is_first(list, k, false) && used < sizeof group->what - 100)
            used += (size_t)snprintf(group->what + used, sizeof group->what - used, "%s%.60s", used ? ", " : "",
                                     list[k]->metric);
    }
    const int searched = group->count < SEARCHED_MOST ? group->count : SEARCHED_MOST;
    char where[160];
    if (scenes == 1)
        snprintf(where, sizeof where, "%.150s", list[0]->scene);
    else
        snprintf(where, sizeof where, "%d scenes", scenes);
    snprintf(group->what + used, sizeof group->what - used, "%s on %s",
             doubles == 0          ? ""
             : doubles == searched ? " in double"
                                   : " in float and double",
             where);
}

enum status groups_make(const struct diff *diff, struct groups *groups)
{
    *groups = (struct groups){.groups = calloc((size_t)diff->finding_count + 1, sizeof *groups->groups),
                              .findings = calloc((size_t)diff->finding_count + 1, sizeof *groups->findings)};
    if (!groups->groups || !groups->findings) {
        groups_free(groups);
        return status_set(STATUS_FAILED, "no memory for %d findings", diff->finding_count);
    }
    for (int k = 0; k < diff->finding_count; k++)
        if (diff->findings[k].verdict != VERDICT_SAME)
            groups->findings[groups->finding_count++] = &diff->findings[k];
    qsort(groups->findings, (size_t)groups->finding_count, sizeof *groups->findings, order_by_cause);
    for (int k = 0; k < groups->finding_count; k++) {
        const struct finding *f = groups->findings[k];
        struct finding_group *group = groups->count > 0 ? &groups->groups[groups->count - 1] : NULL;
        char cause[200];
        cause_make(f->spec, cause, sizeof cause);
        if (!group || group->verdict != f->verdict || group->class != f->class || strcmp(group->spec, cause) != 0) {
            group = &groups->groups[groups->count++];
            *group = (struct finding_group){.verdict = f->verdict, .class = f->class, .first = k};
            snprintf(group->spec, sizeof group->spec, "%s", cause);
        }
        group->count++;
    }
    for (int k = 0; k < groups->count; k++)
        what_make(groups->findings + groups->groups[k].first, &groups->groups[k]);
    qsort(groups->groups, (size_t)groups->count, sizeof *groups->groups, order_by_size);
    return STATUS_OK;
}

void groups_free(struct groups *groups)
{
    free(groups->groups);
    free(groups->findings);
    *groups = (struct groups){0};
}
