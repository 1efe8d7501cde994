/* Numbers that claims.csv asks for by name (quantity.h). */
#include "claims/quantity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "text/text_append.h"
#include "imaging/spec.h"
#include "papers/tables.h"
#include "papers/assumptions.h"
#include "papers/rules.h"
#include "papers/unimaged.h"
#include "papers/phase.h"

enum { TEXTS_MAX = 5 };
struct call;
struct lookup {
    const char *name, *texts;
    const char *kinds; /* of the texts: s scene, p SPEC, w one of words, r a range from 0 on, t targets, - any */
    int method;        /* the text that may be "A - B": the difference of two methods; 0: none */
    enum status (*read)(struct formula *formula, struct call *call, struct values *values);
    const char *const *words[2];
    double most[2]; /* of ranges */
};

/* A call: its texts, where each stands, and the metric that the function's name means. */
struct call {
    char text[TEXTS_MAX][200];
    const char *at[TEXTS_MAX];
    const struct column *metric;
    int word;           /* place of the last text that is a word in its list */
    double range[2][2]; /* of the texts that are ranges, in their order */
    int first;          /* target, from 0; -1: none */
};

/* ---- checks of a call's texts ---- */

static enum status scene_check(const struct formula *formula, const struct call *call, int k)
{
    return assumed_scene_exists(call->text[k])
               ? STATUS_OK
               : formula_error(formula, call->at[k],
                               "there is no scene '%s'; a name below scenes/ is accepted, and @ with one of the "
                               "assumptions of the sensitivity behind it",
                               call->text[k]);
}

/* Replace the SPEC by that of the scheme, and check it. */
static enum status spec_check(struct formula *formula, struct call *call, int k)
{
    struct spec spec;
    char text[sizeof call->text[0]];
    formula->by_scheme |= scheme_spec(formula->scheme, assumed_text(call->text[k]), text, sizeof text);
    strcpy(call->text[k], text);
    const enum status status = spec_own(call->text[k], &spec);
    spec_free(&spec); /* zeroed where it was refused */
    return status == STATUS_OK ? STATUS_OK : formula_error(formula, call->at[k], "%s", status_message());
}

/* Is the text one of the words, which NULL ends? */
static enum status word_check(const struct formula *formula, struct call *call, int k, const char *const *words)
{
    char accepted[300] = "";
    const char *text = assumed_text(call->text[k]);
    memmove(call->text[k], text, strlen(text) + 1); /* may be the same text */
    for (int n = 0; words[n]; n++) {
        call->word = n;
        if (strcmp(words[n], call->text[k]) == 0)
            return STATUS_OK;
        text_append(accepted, sizeof accepted, "%s%s", n ? ", " : "", words[n]);
    }
    return formula_error(formula, call->at[k], "'%s' is not accepted; %s are", call->text[k], accepted);
}

/* "A" or "A..B", A <= B, within [low, high]. */
static enum status range_check(const struct formula *formula, const struct call *call, int k, double low, double high,
                               double range[2])
{
    const char *text = call->text[k], *dots = strstr(text, "..");
    char first[160];
    snprintf(first, sizeof first, "%.*s", (int)(dots ? (size_t)(dots - text) : strlen(text)), text);
    bool good = *first && csv_number(first, &range[0]) && csv_number(dots ? dots + 2 : first, &range[1]);
    return good && range[0] >= low && range[1] <= high && range[0] <= range[1]
               ? STATUS_OK
               : formula_error(formula, call->at[k],
                               "'%s' is not accepted; a number from %g to %g, or FIRST..LAST of "
                               "such numbers, is",
                               text, low, high);
}

/* Counted from 1: one of them, or the first and the last. */
static enum status targets_check(const struct formula *formula, struct call *call, int k, struct values *values)
{
    double range[2] = {1, 1};
    const enum status status = range_check(formula, call, k, 1, TARGETS_MAX, range);
    if (status != STATUS_OK)
        return status;
    if (range[0] != floor(range[0]) || range[1] != floor(range[1]))
        return formula_error(formula, call->at[k], "targets are counted by whole numbers");
    call->first = (int)range[0] - 1;
    values->count = (int)(range[1] - range[0]) + 1;
    for (int n = 0; n < values->count; n++)
        values->at[n] = 1;
    return STATUS_OK;
}

/* All of a call's texts; values become as many as it stands for, each of them 1. */
static enum status texts_check(struct formula *formula, const struct lookup *lookup, struct call *call,
                               struct values *values)
{
    int words = 0, ranges = 0;
    enum status status = STATUS_OK;
    *values = (struct values){.count = 1, .at = {1}};
    call->first = -1;
    for (int k = 0; lookup->kinds[k] && status == STATUS_OK; k++) {
        switch (lookup->kinds[k]) {
        case 's': status = scene_check(formula, call, k); break;
        case 'p': status = spec_check(formula, call, k); break;
        case 'w': status = word_check(formula, call, k, lookup->words[words++]); break;
        case 'r': status = range_check(formula, call, k, 0, lookup->most[ranges], call->range[ranges]); break;
        case 't': status = targets_check(formula, call, k, values); break;
        default: break;
        }
        ranges += lookup->kinds[k] == 'r';
    }
    return status;
}

/* ---- the functions, whose texts are checked; without measurements their numbers are 1 ---- */

static void used(struct formula *formula, enum use use, const char *text)
{
    if (formula->use)
        formula->use(formula->to, use, text);
}

/* Collect scene and SPEC, the first texts of a call. A number worked out without an image needs them for the evidence
   alone. */
static void needed(struct formula *formula, const struct call *call, bool measured)
{
    formula->measures = true;
    if (formula->need && (measured || formula->measured))
        formula->need(formula->to, call->text[0], call->text[1]);
}

static bool for_times(const struct call *call)
{
    return strncmp(call->text[0], "bp22/full", 9) == 0 || strncmp(call->text[0], "lbf21/real_size", 15) == 0;
}

static enum status image_metric(struct formula *formula, struct call *call, struct values *values)
{
    struct measured *measured = formula->measured;
    const char *scene = call->text[0], *spec = call->text[1], *name = call->metric->name;
    formula->times |= for_times(call);
    if (strncmp(name, "flops", 5) == 0) { /* from the plan */
        used(formula, USE_SCENE, scene);
        used(formula, USE_SETTING, spec);
        if (measured)
            values->at[0] = measured_flops(measured, scene, spec, strcmp(name, "flops_published") == 0);
        return STATUS_OK;
    }
    needed(formula, call, true);
    if (strcmp(name, "pslr_db") == 0 || strcmp(name, "islr_db") == 0)
        used(formula, USE_SLICE, "null"); /* an image's are medians of these */
    values->timed = strcmp(call->metric->unit, "s") == 0;
    if (measured)
        values->at[0] = measured_value(measured, scene, spec, call->metric->offset, name);
    return STATUS_OK;
}

static enum status target_metric(struct formula *formula, struct call *call, struct values *values)
{
    formula->times |= for_times(call);
    needed(formula, call, true);
    used(formula, USE_SLICE, call->text[2]);
    for (int k = 0; formula->measured && k < values->count; k++)
        values->at[k] = measured_target(formula->measured, call->text[0], call->text[1], call->first + k, call->text[2],
                                        call->metric->offset, call->metric->name);
    return STATUS_OK;
}

/* A number of a plan, or, of each target, what a filter keeps or changes. */
static enum status unimaged(struct formula *formula, struct call *call, struct values *values)
{
    const enum scene_quantity first = call->first < 0 ? QUANTITY_SIZE_FACTOR : QUANTITY_KEPT_DB;
    needed(formula, call, false);
    for (int k = 0; formula->measured && k < values->count; k++)
        values->at[k] = unimaged_value(formula->measured, call->text[0], call->text[1],
                                       call->first < 0 ? -1 : call->first + k, first + (enum scene_quantity)call->word);
    return STATUS_OK;
}

static enum status stage(struct formula *formula, struct call *call, struct values *values)
{
    formula->times |= for_times(call);
    needed(formula, call, true);
    values->timed = true;
    if (!*call->text[2])
        return formula_error(formula, call->at[2], "the name of a stage, as in measurements.csv, is needed here");
    if (formula->measured)
        values->at[0] = measured_stage(formula->measured, call->text[0], call->text[1], call->text[2]);
    return STATUS_OK;
}

static enum status table_time(struct formula *formula, struct call *call, struct values *values)
{
    char accepted[600];
    const char *table = call->text[0], *method = call->text[1], *definition = call->text[2];
    const int wrong = table_seconds_check(table, method, definition, accepted, sizeof accepted);
    if (wrong >= 0)
        return formula_error(formula, call->at[wrong], "there is no time of '%s'; accepted: %s", call->text[wrong],
                             accepted);
    values->timed = formula->measures = formula->times = true;
    const struct source *source = table_time_source(formula->scheme, table, method, definition);
    if (source) {
        formula->by_scheme |= source->by_scheme;
        if (formula->need)
            formula->need(formula->to, source->scene, source->spec);
    }
    if (formula->measured)
        values->at[0] = table_seconds(formula->measured, formula->scheme, table, method, definition);
    return STATUS_OK;
}

static enum status time_noise(struct formula *formula, struct call *call, struct values *values)
{
    const char *base = NULL;
    char accepted[600];
    for (const struct paper_table *table = paper_tables; table->id; table++)
        if (strcmp(table->id, call->text[0]) == 0)
            base = table->base;
    const int wrong = table_seconds_check(call->text[0], base ? base : "", call->text[1], accepted, sizeof accepted);
    if (wrong >= 0)
        return formula_error(formula, call->at[wrong > 0], "there is no time of '%s'; accepted: %s",
                             call->text[wrong > 0], accepted);
    values->at[0] = formula->measured ? table_noise(formula->measured, call->text[0], call->text[1]) : 0.1;
    return STATUS_OK;
}

static enum status published(struct formula *formula, struct call *call, struct values *values)
{
    values->count = published_values(formula->published, call->text[0], call->text[1], call->text[2], call->text[3],
                                     values->at, VALUES_MAX);
    used(formula, USE_TABLE, call->text[0]);
    return values->count ? STATUS_OK
                         : formula_error(formula, call->at[0],
                                         "published.csv has no such number; table, target (or "
                                         "FIRST..LAST), method and quantity of a row with a number are accepted");
}

static enum status phase(struct formula *formula, struct call *call, struct values *values)
{
    const char *formulas[16] = {NULL}, *meant;
    char setting[160];
    for (int k = 0; k < 15 && phase_formula(k); k++)
        formulas[k] = phase_formula(k);
    formula->by_scheme |= scheme_formula(formula->scheme, call->text[2], &meant);
    formula->measures = formula->phases = true;
    memmove(call->text[2], meant, strlen(meant) + 1); /* may be the same text */
    const enum status status = word_check(formula, call, 2, formulas);
    if (status != STATUS_OK)
        return status;
    const struct phase_part part = {strcmp(call->text[0], "long") == 0 ? PHASE_LONG : PHASE_SHORT,
                                    strcmp(call->text[1], "last") == 0,
                                    call->text[2],
                                    call->range[0][0],
                                    call->range[0][1],
                                    call->range[1][1]};
    snprintf(setting, sizeof setting, "%.40s at %.40s m within %.40s of the Doppler band", call->text[2], call->text[3],
             call->text[4]);
    used(formula, USE_SCENE, phase_setups[part.setup]);
    used(formula, USE_SETTING, setting);
    if (formula->measured)
        values->at[0] = measured_phase(formula->measured, &part);
    return STATUS_OK;
}

/* A rule for the upsampling rate on scenes from seeds. */
static enum status rule(struct formula *formula, struct call *call, struct values *values)
{
    char setting[260];
    formula->measures = formula->rules = true;
    snprintf(setting, sizeof setting, "%s on scenes from seeds", call->text[0]);
    used(formula, USE_SETTING, setting);
    if (formula->measured)
        values->at[0] = rule_value(formula->measured, call->text[0], call->text[1], call->range[0][0]);
    return STATUS_OK;
}

static enum status scene_number(struct formula *formula, struct call *call, struct values *values)
{
    struct scene scene;
    formula->scenes = true;
    used(formula, USE_SCENE, call->text[0]);
    if (!formula->measured)
        return STATUS_OK;
    const enum status status = assumed_scene_load(call->text[0], &scene);
    if (status != STATUS_OK)
        return status;
    values->at[0] = scene_number_value(call->word, &scene.acquisition);
    scene_free(&scene);
    return STATUS_OK;
}

/* ---- calls ---- */

static const char *const setups[] = {"short", "long", NULL}, *const receivers[] = {"first", "last", NULL};
static const char *const slices[] = {"null", "3db", "pixel", "range", NULL};
static const struct lookup lookups[] = {
    {"stage", "scene, SPEC, stage", "sp-", 1, stage, {NULL}, {0}},
    {"time", "table, method, definition", "---", 1, table_time, {NULL}, {0}},
    {"time_noise", "table, definition", "--", 0, time_noise, {NULL}, {0}},
    {"published", "table, target, method, quantity", "----", 2, published, {NULL}, {0}},
    {"phase",
     "set-up, receiver, formula, ranges, share of the Doppler band",
     "ww-rr",
     0,
     phase,
     {setups, receivers},
     {1e6, 1}},
    {"scene", "scene, number", "sw", 0, scene_number, {scene_number_names}, {0}},
    {"planned", "scene, SPEC, number", "spw", 1, unimaged, {planned_names}, {0}},
    {"filtered", "scene, SPEC, quantity, targets", "spwt", 1, unimaged, {energy_names}, {0}},
    {"rule", "rule, quantity, number", "wwr", 0, rule, {rule_names, rule_quantities}, {1}},
};
static const struct lookup image_lookup = {"", "scene, SPEC", "sp", 1, image_metric, {NULL}, {0}};
static const struct lookup target_lookup = {"", "scene, SPEC, definition, targets", "spwt", 1, target_metric, {slices},
                                            {0}};

static const struct lookup *lookup_find(const char *name, const struct column **metric)
{
    static const char target[] = "target_";
    for (size_t k = 0; k < sizeof lookups / sizeof *lookups; k++)
        if (strcmp(lookups[k].name, name) == 0)
            return &lookups[k];
    for (*metric = metric_first(measurement_columns); *metric; *metric = metric_first(*metric + 1))
        if (strcmp((*metric)->name, name) == 0)
            return &image_lookup;
    for (*metric = metric_first(target_columns); *metric; *metric = metric_first(*metric + 1))
        if (strncmp(name, target, sizeof target - 1) == 0 && strcmp((*metric)->name, name + sizeof target - 1) == 0)
            return &target_lookup;
    return NULL;
}

bool lookup_exists(const char *name)
{
    const struct column *metric;
    return lookup_find(name, &metric);
}

/* A text up to ',' or ')', or between quotes, into call->text[k]. */
static enum status text_read(struct formula *formula, struct call *call, int k)
{
    bool quoted = formula_take(formula, '\'');
    const char *at = call->at[k] = formula->at;
    size_t length = strcspn(at, quoted ? "'" : ",()';");
    if (length >= sizeof call->text[k] || (quoted && !at[length]))
        return formula_error(formula, at, "a text that never ends; up to %zu characters%s are accepted",
                             sizeof call->text[k] - 1, quoted ? " and a second quote" : "");
    formula->at += length + quoted;
    while (!quoted && length && at[length - 1] == ' ')
        length--;
    snprintf(call->text[k], sizeof call->text[k], "%.*s", (int)length, at);
    return STATUS_OK;
}

static enum status one_read(struct formula *formula, const struct lookup *lookup, struct call *call,
                            struct values *values)
{
    const enum status status = texts_check(formula, lookup, call, values);
    return status == STATUS_OK ? lookup->read(formula, call, values) : status;
}

/* The difference of a call's two methods, "A - B", or the number of its only one. */
static enum status difference_read(struct formula *formula, const struct lookup *lookup, struct call *call,
                                   struct values *values)
{
    char *minus = lookup->method ? strstr(call->text[lookup->method], " - ") : NULL;
    if (!minus)
        return one_read(formula, lookup, call, values);
    struct call second = *call;
    struct values other = {.timed = false};
    snprintf(second.text[lookup->method], sizeof second.text[0], "%s", minus + 3);
    second.at[lookup->method] += minus + 3 - call->text[lookup->method];
    *minus = '\0';
    enum status status = one_read(formula, lookup, call, values);
    status = status == STATUS_OK ? one_read(formula, lookup, &second, &other) : status;
    if (status == STATUS_OK && values->count != other.count)
        return formula_error(formula, call->at[lookup->method], "lists of %d and %d numbers; lists of one length are",
                             values->count, other.count);
    for (int k = 0; k < values->count && status == STATUS_OK; k++)
        values->at[k] -= other.at[k];
    return status;
}

/* Of a call with a text "A | B", or "A | B - C", those for A and for B as one list. */
static enum status call_read(struct formula *formula, const struct lookup *lookup, const struct call *call,
                             struct values *values)
{
    int k = 0;
    while (lookup->kinds[k] && !strstr(call->text[k], " | "))
        k++;
    struct call one = *call;
    if (!lookup->kinds[k])
        return difference_read(formula, lookup, &one, values);
    const char *tail = strstr(call->text[k], " - ");
    *values = (struct values){.count = 0};
    for (const char *at = call->text[k], *next; at; at = next) {
        struct values more = {.timed = false};
        next = strstr(at, " | ");
        const char *end = next ? next : tail ? tail : at + strlen(at);
        snprintf(one.text[k], sizeof one.text[k], "%.*s%s", (int)(end - at), at, tail ? tail : "");
        one.at[k] = call->at[k] + (at - call->text[k]);
        next = next ? next + 3 : NULL;
        enum status status = call_read(formula, lookup, &one, &more);
        if (status == STATUS_OK)
            status = values_join(formula, one.at[k], values, &more);
        if (status != STATUS_OK)
            return status;
    }
    return STATUS_OK;
}

enum status lookup_read(struct formula *formula, const char *at, const char *name, const char *accepted,
                        struct values *values)
{
    struct call call = {.metric = NULL};
    const struct lookup *lookup = lookup_find(name, &call.metric);
    char names[600];
    snprintf(names, sizeof names, "%s", accepted);
    if (!lookup) {
        for (size_t k = 0; k < sizeof lookups / sizeof *lookups; k++)
            text_append(names, sizeof names, "%s, ", lookups[k].name);
        return formula_error(formula, at,
                             "there is no function '%s'; %sa metric of measurements.csv, or one of "
                             "targets.csv with target_ ahead of it, are accepted",
                             name, names);
    }
    enum status status = STATUS_OK;
    for (int k = 0; lookup->kinds[k] && status == STATUS_OK; k++) {
        status = text_read(formula, &call, k);
        if (status == STATUS_OK && !formula_take(formula, lookup->kinds[k + 1] ? ',' : ')'))
            status = formula_error(formula, formula->at, "%s(%s) is needed", name, lookup->texts);
    }
    return status == STATUS_OK ? call_read(formula, lookup, &call, values) : status;
}
