/* Which measurement corresponds to a printed number (sources.h). */
#include "papers/sources.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>

const char *const scheme_names[SCHEMES] = {[SCHEME_PRINTED] = "as printed", [SCHEME_CORRECTED] = "corrected"};

bool scheme_spec(enum scheme scheme, const char *text, char *spec, size_t size)
{
    static const char word[] = "LBF:";
    const bool is_lbf = strncmp(text, word, sizeof word - 1) == 0;
    const bool printed = is_lbf && scheme == SCHEME_PRINTED;
    snprintf(spec, size, "%s%s%s%s%s", is_lbf ? "rma_lbf:" : "", printed ? "variant=printed," : "",
             printed && !strstr(text, "spacing=") ? "spacing=uniform," : "", printed ? "blend=off," : "",
             text + (is_lbf ? sizeof word - 1 : 0));
    return is_lbf;
}

bool scheme_formula(enum scheme scheme, const char *name, const char **formula)
{
    bool eq_5 = strcmp(name, "LBF") == 0, eq_7 = strcmp(name, "LBF7") == 0;
    *formula = name;
    if (eq_5 || eq_7)
        *formula = scheme == SCHEME_CORRECTED ? "lbf_F" : eq_5 ? "lbf_fc" : "lbf7_fc";
    return eq_5 || eq_7;
}

static const struct place {
    const char *table, *target, *scene;
    int index;
} places[] = {
    {"bp22_t3", "T1", "bp22/table3", 0},         {"bp22_t3", "T2", "bp22/table3", 1},
    {"bp22_t3", "T3", "bp22/table3", 2},         {"bp22_t3", "T4", "bp22/table3", 3},
    {"bp22_t3", "T5", "bp22/table3", 4},         {"bp22_t3", "T6", "bp22/table3", 5},
    {"lbf21_t3", "PT1", "lbf21/table3_near", 0}, {"lbf21_t3", "PT2", "lbf21/table3_near", 1},
    {"lbf21_t3", "PT3", "lbf21/table3_far", 0},  {"lbf21_t3", "PT4", "lbf21/table3_far", 1},
    {"lbf21_t3", "PT5", "lbf21/table3_far", 2},  {"lbf21_t3", "PT6", "lbf21/table3_far", 3},
    {"lbf21_t4", "PT7", "lbf21/table4_near", 0}, {"lbf21_t4", "PT8", "lbf21/table4_near", 1},
    {"lbf21_t4", "PT9", "lbf21/table4_far", 0},  {"lbf21_t4", "PT10", "lbf21/table4_far", 1},
    {"pf05_t1", "S1", "pf05/nine", 0},           {"pf05_t1", "S2", "pf05/nine", 1},
    {"pf05_t1", "S3", "pf05/nine", 2},           {"pf05_t1", "S4", "pf05/nine", 3},
    {"pf05_f5", "S1", "pf05/nine", 0},           {"pf05_f5", "S2", "pf05/nine", 1},
    {"pf05_f5", "S3", "pf05/nine", 2},           {"pf05_f5", "S4", "pf05/nine", 3},
    {"sq18_f3a", "T1", "sq18/squint_20", 0},     {"sq18_f3a", "T2", "sq18/squint_20", 1},
    {"sq18_f3a", "T3", "sq18/squint_20", 2},     {"sq18_f3a", "T4", "sq18/squint_20", 3},
    {"sq18_f3a", "T5", "sq18/squint_20", 4},     {"sq18_f3b", "T1", "sq18/squint_20", 0},
};

/* Plain engines are timed on a part of the task, and each stage is scaled to all of it. Back projection uses some
   columns: its sums grow with them, the compression does not. Range migration uses a sixth of the receivers: its
   conversion grows with their square (receivers and wavenumbers), all else in proportion. */
static const struct scaling bp22_columns = {48, "focus", 1}, lbf21_columns = {40, "focus", 1};
static const struct scaling lbf21_part = {36, "bulk differential reconstruct", 6};

/* The papers' name of a method, in the tables named. `kind` distinguishes methods of a table that are measured in
   different ways: back projection by zero padding (b) or sinc (s), range migration by LBF (l) or a formula (r),
   omega-k (w). */
static const struct method {
    const char *tables, *name;
    char kind;
    const char *scene; /* NULL: the way's */
    const char *spec;
} methods[] = {
    {"bp22_t1 bp22_t3 bp22_t4", "nearest", 'b', NULL, NEAREST},
    {"bp22_t1 bp22_t3 bp22_t4", "linear, beta 2", 'b', NULL, LINEAR_2},
    {"bp22_t1 bp22_t3 bp22_t4", "linear, beta 8", 'b', NULL, LINEAR_8},
    {"bp22_t1 bp22_t3 bp22_t4", "sinc", 'b', NULL, SINC_8},
    {"bp22_eq20", "linear", 'b', NULL, SINC_8},
    {"zp15_f3 zp15_f4", "nearest", 'b', NULL, NEAREST},
    {"zp15_f3 zp15_f4", "truncated sinc", 'b', NULL, SINC_8},
    {"zp15_f3 zp15_f4", "zero padding", 'b', NULL, ZEROPAD_8},
    {"lbf21_t2", "LBF, 30.0 m", 'l', "lbf21/blocks_30_0", LBF_BLOCK},
    {"lbf21_t2", "LBF, 18.0 m", 'l', "lbf21/blocks_18_0", LBF_BLOCK},
    {"lbf21_t2", "LBF, 12.0 m", 'l', "lbf21/blocks_12_0", LBF_BLOCK},
    {"lbf21_t2", "LBF, 11.4 m", 'l', "lbf21/blocks_11_4", LBF_BLOCK},
    {"lbf21_t2", "LBF, 9.6 m", 'l', "lbf21/blocks_9_6", LBF_BLOCK},
    {"lbf21_t2", "LBF, 2.7 m", 'l', "lbf21/blocks_2_7", LBF_BLOCK},
    {"lbf21_t2", "PCA", 'r', NULL, PCA_1},
    {"lbf21_t3 lbf21_t4 lbf21_flops", "LBF", 'l', NULL, LBF_16},
    {"lbf21_t3 lbf21_t4 lbf21_flops", "PCA", 'r', NULL, PCA_16},
    {"lbf21_t4 lbf21_flops", "Wu", 'r', NULL, WU_16},
    {"lbf21_t2 lbf21_t3 lbf21_t4", "BP", 'b', NULL, "reference"},
    {"lbf21_t5", "LBF, 8 blocks", 'l', NULL, LBF_8},
    {"lbf21_t5", "LBF, 16 blocks", 'l', NULL, LBF_16},
    {"lbf21_t5", "PCA", 'r', NULL, PCA_16},
    {"lbf21_t5", "Wu", 'r', NULL, WU_16},
    {"lbf21_t5 lbf21_flops", "BP", 'b', NULL, ZEROPAD_8},
    {"lbf21_t5", "BP", 's', NULL, SINC_8},
    {"pf05_t1", "omega-k", 'w', "pf05/inside", IDEAL},
    {"pf05_f5", "no outside targets", 'w', "pf05/inside", IDEAL},
    {"pf05_f5", "4 sub-apertures", 'w', NULL, POLAR_4},
    {"pf05_f5", "2 sub-apertures", 'w', NULL, POLAR_2},
    {"sq18_f3a sq18_f3b", "improved omega-k", 'w', NULL, TURNED},
};

/* How the methods of a table are measured. */
static const struct way {
    const char *table, *kinds, *definition, *scene, *options;
    const struct scaling *scaling;
    bool planned;
} ways[] = {
    {.table = "bp22_t1", .definition = "Eq. (11) by the plan", .scene = "bp22/full", .planned = true},
    {.table = "bp22_t3"},
    {.table = "bp22_t4",
     .definition = PLAIN_TIMES,
     .scene = "bp22/full_columns",
     .options = PLAIN_BP,
     .scaling = &bp22_columns},
    {.table = "bp22_t4", .definition = FAST_TIMES, .scene = "bp22/full"},
    {.table = "bp22_t4", .definition = FAST_LIMITED, .scene = "bp22/full_limited"},
    {.table = "bp22_eq20", .scene = "bp22/table3"},
    {.table = "zp15_f3", .scene = "zp15/target"},
    {.table = "zp15_f4", .scene = "zp15/target"},
    {.table = "lbf21_t2", .scene = "lbf21/blocks"},
    {.table = "lbf21_t3"},
    {.table = "lbf21_t4"},
    {"lbf21_t5", "l", PLAIN_TIMES, "lbf21/real_size_part", PLAIN_RMA, &lbf21_part, false},
    {"lbf21_t5", "r", PLAIN_TIMES, "lbf21/real_size_part", "spacing=uniform,blend=off," PLAIN_RMA, &lbf21_part, false},
    {"lbf21_t5", "b", PLAIN_TIMES, "lbf21/real_size_columns", PLAIN_BP, &lbf21_columns, false},
    {"lbf21_t5", "s", PLAIN_SINC, "lbf21/real_size_columns", PLAIN_BP, &lbf21_columns, false},
    {"lbf21_t5", "lrb", FAST_TIMES, "lbf21/real_size", NULL, NULL, false},
    {"lbf21_t5", "s", FAST_SINC, "lbf21/real_size", NULL, NULL, false},
    {"lbf21_flops", "lrb", "by the plan", "lbf21/real_size", NULL, NULL, true},
    {.table = "pf05_t1"},
    {.table = "pf05_f5"},
    {.table = "sq18_f3a"},
    {.table = "sq18_f3b"},
};
enum { PLACES = sizeof places / sizeof *places, METHODS = sizeof methods / sizeof *methods };
enum { WAYS = sizeof ways / sizeof *ways };

/* Is the table one of the method's? No id is part of another. */
static bool goes_with(const struct way *way, const struct method *method)
{
    return strstr(method->tables, way->table) && (!way->kinds || strchr(way->kinds, method->kind));
}

static void source_make(const struct way *way, const struct method *method, enum scheme scheme, struct source *source)
{
    char text[160];
    *source = (struct source){.table = way->table,
                              .method = method->name,
                              .definition = way->definition,
                              .scene = method->scene ? method->scene : way->scene,
                              .scaling = way->scaling,
                              .scheme = scheme,
                              .planned = way->planned};
    snprintf(text, sizeof text, "%s%s%s", method->spec,
             !way->options               ? ""
             : strchr(method->spec, ':') ? ","
                                         : ":",
             way->options ? way->options : "");
    source->by_scheme = scheme_spec(scheme, text, source->spec, sizeof source->spec);
}

static pthread_once_t once = PTHREAD_ONCE_INIT;
static struct source sources[WAYS * METHODS * SCHEMES];
static int source_count;

static void sources_make(void)
{
    for (int w = 0; w < WAYS; w++)
        for (int m = 0; m < METHODS; m++)
            for (enum scheme scheme = 0; scheme < SCHEMES && goes_with(&ways[w], &methods[m]); scheme++) {
                source_make(&ways[w], &methods[m], scheme, &sources[source_count]);
                source_count += scheme == 0 || sources[source_count].by_scheme;
            }
}

const struct source *source_at(int k)
{
    pthread_once(&once, sources_make);
    return k < source_count ? &sources[k] : NULL;
}

const char *source_place(const char *table, const char *target, int *index)
{
    for (int p = 0; p < PLACES; p++)
        if (strcmp(places[p].table, table) == 0 && strcmp(places[p].target, target) == 0) {
            *index = places[p].index;
            return places[p].scene;
        }
    return NULL;
}

/* ---- needs ---- */

int need_add(struct need *needs, int count, int room, struct need need)
{
    for (int k = 0; k < count; k++)
        if (strcmp(needs[k].scene, need.scene) == 0 && strcmp(needs[k].spec, need.spec) == 0)
            return count;
    if (count == room)
        return count;
    needs[count] = need;
    return count + 1;
}

int table_needs(const char *id, struct need *needs, int count, int room)
{
    const struct source *source;
    for (int k = 0; (source = source_at(k)); k++) {
        if (source->planned || strcmp(id, source->table) != 0)
            continue;
        if (source->scene)
            count = need_add(needs, count, room, (struct need){source->scene, source->spec});
        for (int p = 0; p < PLACES && !source->scene; p++)
            if (strcmp(places[p].table, source->table) == 0)
                count = need_add(needs, count, room, (struct need){places[p].scene, source->spec});
    }
    return count;
}

/* ---- times ---- */

static double source_seconds(struct measured *measured, const struct source *source)
{
    const struct scaling *scaling = source->scaling;
    double seconds = MEASURED(measured, source->scene, source->spec, run_s);
    if (!scaling)
        return seconds;
    double scaled = 0;
    char stages[64], *rest = stages;
    snprintf(stages, sizeof stages, "%s", scaling->stages);
    for (char *stage; (stage = strsep(&rest, " "));)
        scaled += measured_stage(measured, source->scene, source->spec, stage);
    return scaling->factor * scaled + scaling->rest * (seconds - scaled);
}

/* The definition for all methods but back projection: theirs are the same when back projection is by sinc. */
static const char *definition_of_others(const char *definition)
{
    return strcmp(definition, PLAIN_SINC) == 0  ? PLAIN_TIMES
           : strcmp(definition, FAST_SINC) == 0 ? FAST_TIMES
                                                : definition;
}

const struct source *table_time_source(enum scheme scheme, const char *id, const char *method, const char *definition)
{
    const char *const wanted[] = {definition, definition_of_others(definition)};
    const struct source *source;
    for (int n = 0; n < 2; n++)
        for (int k = 0; (source = source_at(k)); k++)
            if (strcmp(source->table, id) == 0 && strcmp(source->method, method) == 0 && source->definition
                && strcmp(source->definition, wanted[n]) == 0 && (!source->by_scheme || source->scheme == scheme))
                return source;
    return NULL;
}

double table_seconds(struct measured *measured, enum scheme scheme, const char *id, const char *method,
                     const char *definition)
{
    const struct source *source = table_time_source(scheme, id, method, definition);
    return source ? source_seconds(measured, source)
                  : measured_missing(measured, "%s has no times of %s by %s", id, method, definition);
}

double table_noise(const struct measured *measured, const char *id, const char *definition)
{
    const struct source *source;
    double noise = 0.1, least = INFINITY, most = 0;
    char scene[80] = "";
    for (int k = 0; (source = source_at(k)); k++) {
        if (strcmp(source->table, id) != 0 || !source->definition
            || (strcmp(source->definition, definition) != 0
                && strcmp(source->definition, definition_of_others(definition)) != 0))
            continue;
        const struct measurement *row = measured_row(measured, source->scene, source->spec);
        if (!row)
            continue;
        noise = fmax(noise, row->run_s / row->run_min_s - 1);
        if (strcmp(scene, source->scene) != 0) {
            snprintf(scene, sizeof scene, "%s", source->scene);
            least = INFINITY;
            most = 0;
        }
        least = fmin(least, row->control_s);
        most = fmax(most, row->control_s);
        noise = fmax(noise, most / least - 1);
    }
    return noise;
}

/* A table has times if it divides them by those of `base`. */
static bool table_has_times(const char *id)
{
    for (const struct paper_table *table = paper_tables; table->id; table++)
        if (strcmp(table->id, id) == 0)
            return table->base;
    return false;
}

/* Append 'TEXT' unless it is there. */
static void accept(char *accepted, size_t size, const char *text)
{
    char quoted[100];
    size_t used = strlen(accepted);
    snprintf(quoted, sizeof quoted, "'%s'", text);
    if (!strstr(accepted, quoted))
        snprintf(accepted + used, size - used, "%s%s", used ? ", " : "", quoted);
}

int table_seconds_check(const char *id, const char *method, const char *definition, char *accepted, size_t size)
{
    const char *const wanted[] = {id, method, definition};
    const struct source *source;
    for (int text = 0; text < 3; text++) {
        bool found = false;
        *accepted = '\0';
        for (int k = 0; (source = source_at(k)); k++) {
            const char *const texts[] = {source->table, source->method, source->definition};
            bool fits = table_has_times(source->table);
            for (int n = 0; n < text; n++)
                fits = fits && strcmp(texts[n], n == 2 ? definition_of_others(wanted[n]) : wanted[n]) == 0;
            if (!fits)
                continue;
            accept(accepted, size, texts[text]);
            found |= strcmp(texts[text], wanted[text]) == 0
                     || (text == 2 && strcmp(texts[text], definition_of_others(wanted[text])) == 0);
        }
        if (!found)
            return text;
    }
    return -1;
}
