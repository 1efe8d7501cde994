/* Numbers that claims.csv asks for by name (lookup.h). */
#include "claims/lookup.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "files/paths.h"
#include "text/text_append.h"
#include "measure/spec.h"
#include "papers/tables.h"
#include "papers/assumptions.h"
#include "papers/filtered.h"
#include "papers/rules.h"
#include "papers/scene_numbers.h"
#include "papers/phase.h"

/* A call: its texts, where each stands, and the metric that the function's name means. */
enum { TEXTS_MAX = 5 };
struct call {
    char text[TEXTS_MAX][200];
    const char *at[TEXTS_MAX];
    const struct column *metric;
};

/* ---- checks of a call's texts ---- */

static enum status scene_check(const struct formula *formula, const struct call *call, int k)
{
    char path[4200];
    snprintf(path, sizeof path, "%s/%s.cfg", SCENE_DIRECTORY, call->text[k]);
    return *call->text[k] && access(path, R_OK) == 0
               ? STATUS_OK
               : formula_error(formula, call->at[k], "there is no scene '%s'; a name below scenes/ is accepted",
                               call->text[k]);
}

static enum status spec_check(const struct formula *formula, const struct call *call, int k)
{
    struct spec spec;
    char message[400];
    if (spec_parse(call->text[k], &spec) == STATUS_OK) {
        spec_free(&spec);
        return STATUS_OK;
    }
    snprintf(message, sizeof message, "%s", status_message());
    return formula_error(formula, call->at[k], "%s", message);
}

/* Is the text one of the words, which NULL ends? */
static enum status word_check(const struct formula *formula, const struct call *call, int k, const char *const *words)
{
    char known[300] = "";
    for (int n = 0; words[n]; n++) {
        if (strcmp(words[n], call->text[k]) == 0)
            return STATUS_OK;
        text_append(known, sizeof known, "%s%s", n ? ", " : "", words[n]);
    }
    return formula_error(formula, call->at[k], "'%s' is not accepted; %s are", call->text[k], known);
}

/* "A" or "A..B", A <= B, within [low, high]. */
static enum status range_check(const struct formula *formula, const struct call *call, int k, double low, double high,
                               double range[2])
{
    const char *text = call->text[k], *dots = strstr(text, "..");
    char first[160];
    snprintf(first, sizeof first, "%.*s", dots ? (int)(dots - text) : (int)strlen(text), text);
    bool good = *first && csv_number(first, &range[0]) && csv_number(dots ? dots + 2 : first, &range[1]);
    return good && range[0] >= low && range[1] <= high && range[0] <= range[1]
               ? STATUS_OK
               : formula_error(formula, call->at[k],
                               "'%s' is not accepted; a number from %g to %g, or FIRST..LAST of "
                               "such numbers, is",
                               text, low, high);
}

/* Scene and SPEC are a call's first texts; the latter becomes that of the scheme. */
static enum status measurement_check(struct formula *formula, struct call *call)
{
    char spec[sizeof call->text[1]];
    enum status status = scene_check(formula, call, 0);
    formula->by_scheme |= scheme_spec(formula->scheme, call->text[1], spec, sizeof spec);
    strcpy(call->text[1], spec);
    if (status == STATUS_OK)
        status = spec_check(formula, call, 1);
    return status;
}

/* The same for a number that has to be measured. */
static enum status measurement_need(struct formula *formula, struct call *call)
{
    enum status status = measurement_check(formula, call);
    formula->measures = true;
    if (status == STATUS_OK && formula->need)
        formula->need(formula->to, call->text[0], call->text[1]);
    return status;
}

static void used(struct formula *formula, enum use use, const char *text)
{
    if (formula->use)
        formula->use(formula->to, use, text);
}

/* ---- the functions; without measurements their numbers are 1 ---- */

/* FLOPs come from the plan. */
static enum status flops_metric(struct formula *formula, struct call *call, struct values *values)
{
    bool by_formula = call->metric->offset == offsetof(struct measurement, flops_published);
    enum status status = measurement_check(formula, call);
    *values = (struct values){.count = 1, .at = {1}};
    used(formula, USE_SCENE, call->text[0]);
    used(formula, USE_SETTING, call->text[1]);
    if (status == STATUS_OK && formula->measured)
        values->at[0] = measured_flops(formula->measured, call->text[0], call->text[1], by_formula);
    return status;
}

static enum status image_metric(struct formula *formula, struct call *call, struct values *values)
{
    if (strncmp(call->metric->name, "flops", 5) == 0)
        return flops_metric(formula, call, values);
    enum status status = measurement_need(formula, call);
    if (strcmp(call->metric->name, "pslr_db") == 0 || strcmp(call->metric->name, "islr_db") == 0)
        used(formula, USE_SLICE, "null"); /* an image's are medians of these */
    *values = (struct values){.count = 1, .at = {1}, .timed = strcmp(call->metric->unit, "s") == 0};
    if (status == STATUS_OK && formula->measured)
        values->at[0] =
            measured_value(formula->measured, call->text[0], call->text[1], call->metric->offset, call->metric->name);
    return status;
}

/* A call's last two texts: one of `words`, and targets counted from 1, one of them or the first and the last. Fills the
   count of values, each of them 1, and the first target's index. */
static enum status targets_read(const struct formula *formula, const struct call *call, const char *const *words,
                                struct values *values, int *first)
{
    double range[2] = {1, 1};
    enum status status = word_check(formula, call, 2, words);
    if (status == STATUS_OK)
        status = range_check(formula, call, 3, 1, VALUES_MAX, range);
    if (status == STATUS_OK && (range[0] != floor(range[0]) || range[1] != floor(range[1])))
        status = formula_error(formula, call->at[3], "targets are counted by whole numbers");
    *first = (int)range[0] - 1;
    values->count = status == STATUS_OK ? (int)(range[1] - range[0]) + 1 : 0;
    for (int k = 0; k < values->count; k++)
        values->at[k] = 1;
    return status;
}

static enum status target_metric(struct formula *formula, struct call *call, struct values *values)
{
    static const char *const definitions[] = {"null", "3db", "pixel", NULL};
    int first;
    enum status status = measurement_need(formula, call);
    values->count = 0;
    if (status == STATUS_OK)
        status = targets_read(formula, call, definitions, values, &first);
    used(formula, USE_SLICE, call->text[2]);
    for (int k = 0; formula->measured && k < values->count; k++)
        values->at[k] = measured_target(formula->measured, call->text[0], call->text[1], first + k, call->text[2],
                                        call->metric->offset, call->metric->name);
    return status;
}

/* A number that no image is needed for: named in the evidence, and nothing is measured for it. */
static enum status unmeasured_check(struct formula *formula, struct call *call)
{
    enum status status = measurement_check(formula, call);
    formula->measures = true;
    if (status == STATUS_OK && formula->measured && formula->need)
        formula->need(formula->to, call->text[0], call->text[1]);
    return status;
}

static enum status planned(struct formula *formula, struct call *call, struct values *values)
{
    int number = 0;
    enum status status = unmeasured_check(formula, call);
    *values = (struct values){.count = 1, .at = {1}};
    if (status == STATUS_OK)
        status = word_check(formula, call, 2, planned_names);
    if (status != STATUS_OK || !formula->measured)
        return status;
    while (strcmp(planned_names[number], call->text[2]) != 0)
        number++;
    values->at[0] = planned_value(formula->measured, call->text[0], call->text[1], (enum scene_quantity)number);
    return STATUS_OK;
}

static enum status filtered(struct formula *formula, struct call *call, struct values *values)
{
    static const char *const quantities[] = {"kept_db", "changed_db", NULL};
    int first;
    enum status status = unmeasured_check(formula, call);
    values->count = 0;
    if (status == STATUS_OK)
        status = targets_read(formula, call, quantities, values, &first);
    for (int k = 0; formula->measured && k < values->count; k++)
        values->at[k] = filtered_value(formula->measured, call->text[0], call->text[1], first + k,
                                       call->text[2][0] == 'c' ? QUANTITY_CHANGED_DB : QUANTITY_KEPT_DB);
    return status;
}

static enum status stage(struct formula *formula, struct call *call, struct values *values)
{
    enum status status = measurement_need(formula, call);
    *values = (struct values){.count = 1, .at = {1}, .timed = true};
    if (status == STATUS_OK && !*call->text[2])
        status = formula_error(formula, call->at[2], "the name of a stage, as in measurements.csv, is needed here");
    if (status == STATUS_OK && formula->measured)
        values->at[0] = measured_stage(formula->measured, call->text[0], call->text[1], call->text[2]);
    return status;
}

static enum status table_time(struct formula *formula, struct call *call, struct values *values)
{
    char accepted[600];
    *values = (struct values){.count = 1, .at = {1}, .timed = true};
    int unknown = table_seconds_check(call->text[0], call->text[1], call->text[2], accepted, sizeof accepted);
    if (unknown >= 0)
        return formula_error(formula, call->at[unknown], "there is no time of '%s'; accepted: %s", call->text[unknown],
                             accepted);
    struct source source;
    formula->measures = true;
    if (table_time_source(formula->scheme, call->text[0], call->text[1], call->text[2], &source)) {
        formula->by_scheme |= source.by_scheme;
        if (formula->need)
            formula->need(formula->to, source.scene, source.spec);
    }
    if (formula->measured)
        values->at[0] = table_seconds(formula->measured, formula->scheme, call->text[0], call->text[1], call->text[2]);
    return STATUS_OK;
}

static enum status time_noise(struct formula *formula, struct call *call, struct values *values)
{
    const char *base = NULL;
    char accepted[600];
    *values = (struct values){.count = 1, .at = {0.1}};
    for (const struct paper_table *table = paper_tables; table->id; table++)
        if (strcmp(table->id, call->text[0]) == 0)
            base = table->base;
    int unknown = table_seconds_check(call->text[0], base ? base : "", call->text[1], accepted, sizeof accepted);
    if (unknown >= 0)
        return formula_error(formula, call->at[unknown > 0], "there is no time of '%s'; accepted: %s",
                             call->text[unknown > 0], accepted);
    if (formula->measured)
        values->at[0] = table_noise(formula->measured, call->text[0], call->text[1]);
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
    static const char *const setups[] = {"short", "long", NULL}, *const receivers[] = {"first", "last", NULL};
    const char *formulas[16] = {NULL}, *meant;
    double range[2] = {0, 0}, share[2] = {0, 0};
    for (int k = 0; k < 15 && phase_formula(k); k++)
        formulas[k] = phase_formula(k);
    formula->by_scheme |= scheme_formula(formula->scheme, call->text[2], &meant);
    memmove(call->text[2], meant, strlen(meant) + 1); /* may be the same text */
    formula->measures = formula->phases = true;
    enum status status = word_check(formula, call, 0, setups);
    if (status == STATUS_OK)
        status = word_check(formula, call, 1, receivers);
    if (status == STATUS_OK)
        status = word_check(formula, call, 2, formulas);
    if (status == STATUS_OK)
        status = range_check(formula, call, 3, 0, 1e6, range);
    if (status == STATUS_OK)
        status = range_check(formula, call, 4, 0, 1, share);
    *values = (struct values){.count = 1, .at = {1}};
    const struct phase_part part = {strcmp(call->text[0], "long") == 0 ? PHASE_LONG : PHASE_SHORT,
                                    strcmp(call->text[1], "last") == 0,
                                    call->text[2],
                                    range[0],
                                    range[1],
                                    share[1]};
    char setting[160];
    snprintf(setting, sizeof setting, "%.40s at %.40s m within %.40s of the Doppler band", call->text[2], call->text[3],
             call->text[4]);
    used(formula, USE_SCENE, phase_setups[part.setup]);
    used(formula, USE_SETTING, setting);
    if (status == STATUS_OK && formula->measured)
        values->at[0] = measured_phase(formula->measured, &part);
    return status;
}

/* A rule for the upsampling rate on scenes from seeds. */
static enum status rule(struct formula *formula, struct call *call, struct values *values)
{
    double range[2] = {0, 0};
    char setting[260];
    enum status status = word_check(formula, call, 0, rule_names);
    *values = (struct values){.count = 1, .at = {1}};
    if (status == STATUS_OK)
        status = word_check(formula, call, 1, rule_quantities);
    if (status == STATUS_OK)
        status = range_check(formula, call, 2, 0, 1, range);
    formula->measures = formula->rules = true;
    snprintf(setting, sizeof setting, "%s on scenes from seeds", call->text[0]);
    used(formula, USE_SETTING, setting);
    if (status == STATUS_OK && formula->measured)
        values->at[0] = rule_value(formula->measured, call->text[0], call->text[1], range[0]);
    return status;
}

static enum status scene_number(struct formula *formula, struct call *call, struct values *values)
{
    struct scene scene;
    int k = 0;
    *values = (struct values){.count = 1, .at = {1}};
    enum status status = scene_check(formula, call, 0);
    if (status == STATUS_OK)
        status = word_check(formula, call, 1, scene_number_names);
    used(formula, USE_SCENE, call->text[0]);
    if (status != STATUS_OK || !formula->measured)
        return status;
    status = assumed_scene_load(call->text[0], &scene);
    if (status != STATUS_OK)
        return status;
    while (strcmp(scene_number_names[k], call->text[1]) != 0)
        k++;
    values->at[0] = scene_number_value(k, &scene.acquisition);
    scene_free(&scene);
    return STATUS_OK;
}

/* ---- calls ---- */

struct lookup {
    const char *name;
    int count; /* of texts */
    const char *texts;
    enum status (*read)(struct formula *formula, struct call *call, struct values *values);
};
static const struct lookup lookups[] = {
    {"stage", 3, "scene, SPEC, stage", stage},
    {"time", 3, "table, method, definition", table_time},
    {"time_noise", 2, "table, definition", time_noise},
    {"published", 4, "table, target, method, quantity", published},
    {"phase", 5, "set-up, receiver, formula, ranges, share of the Doppler band", phase},
    {"scene", 2, "scene, number", scene_number},
    {"planned", 3, "scene, SPEC, number", planned},
    {"filtered", 4, "scene, SPEC, quantity, targets", filtered},
    {"rule", 3, "rule, quantity, number", rule},
};
static const struct lookup image_lookup = {"", 2, "scene, SPEC", image_metric};
static const struct lookup target_lookup = {"", 4, "scene, SPEC, definition, targets", target_metric};

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

bool lookup_known(const char *name)
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

enum status lookup_read(struct formula *formula, const char *at, const char *name, const char *known,
                        struct values *values)
{
    struct call call = {.metric = NULL};
    const struct lookup *lookup = lookup_find(name, &call.metric);
    if (!lookup) {
        char names[600];
        snprintf(names, sizeof names, "%s", known);
        for (size_t k = 0; k < sizeof lookups / sizeof *lookups; k++)
            text_append(names, sizeof names, "%s, ", lookups[k].name);
        return formula_error(formula, at,
                             "there is no function '%s'; %sa metric of measurements.csv, or one of "
                             "targets.csv with target_ ahead of it, are accepted",
                             name, names);
    }
    enum status status = STATUS_OK;
    for (int k = 0; k < lookup->count && status == STATUS_OK; k++) {
        status = text_read(formula, &call, k);
        if (status == STATUS_OK && !formula_take(formula, k < lookup->count - 1 ? ',' : ')'))
            status = formula_error(formula, formula->at, "%s(%s) is needed", name, lookup->texts);
    }
    return status == STATUS_OK ? lookup->read(formula, &call, values) : status;
}
