/* The claims of results/claims.csv: read, checked and evaluated (claims.h). */
#include "claims/claims.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "files/paths.h"
#include "text/text_append.h"
#include "measure/timing.h"
#include "papers/assumptions.h"

enum { ID, PAPER, SECTION, CLAIM, CRITERION, COMPARISON, ARGUMENTS, CHANGED, COLUMNS };
static const char *const columns[] = {"id",         "paper",     "section", "claim", "criterion",
                                      "comparison", "arguments", "changed", NULL};
static const char *const number_columns[] = {"of", "name", "definition", NULL};

/* ---- reading ---- */

static enum status row_read(const struct csv *csv, int row, struct claim *claim)
{
    const char *cells[COLUMNS];
    for (int k = 0; k < COLUMNS; k++) {
        cells[k] = csv_cell(csv, row, k);
        if (!*cells[k] && k < ARGUMENTS)
            return status_set(STATUS_INVALID, "%s: line %d: column %s is empty; a text is needed", csv->path,
                              csv->lines[row], columns[k]);
    }
    *claim = (struct claim){.id = cells[ID],
                            .paper = cells[PAPER],
                            .section = cells[SECTION],
                            .claim = cells[CLAIM],
                            .criterion = cells[CRITERION],
                            .comparison = cells[COMPARISON],
                            .arguments = cells[ARGUMENTS],
                            .changed = cells[CHANGED],
                            .line = csv->lines[row]};
    for (int other = 0; other < row; other++)
        if (strcmp(csv_cell(csv, other, 0), claim->id) == 0)
            return status_set(STATUS_INVALID,
                              "%s: line %d: column id is '%s', as in line %d; an id of its own is "
                              "needed",
                              csv->path, csv->lines[row], claim->id, csv->lines[other]);
    return STATUS_OK;
}

static struct formula formula_of(const struct claims *claims, const struct claim *claim, enum scheme scheme,
                                 const struct csv *published)
{
    return (struct formula){.published = published,
                            .numbers = &claims->numbers,
                            .rows = claims->numbers.row_count,
                            .id = claim->id,
                            .paper = claim->paper,
                            .scheme = scheme,
                            .path = claims->csv.path,
                            .line = claim->line};
}

/* The list grows by one; without memory it stays, and the count is one less than requested. */
struct needs_list {
    struct claim *claim;
    bool failed;
};

static void need_keep(void *to, const char *scene, const char *spec)
{
    struct needs_list *list = to;
    struct claim *claim = list->claim;
    for (int k = 0; k < claim->need_count; k++)
        if (strcmp(claim->needs[k].scene, scene) == 0 && strcmp(claim->needs[k].spec, spec) == 0)
            return;
    struct need *needs = realloc(claim->needs, (size_t)(claim->need_count + 1) * sizeof *needs);
    claim->needs = needs ? needs : claim->needs;
    const char *texts[] = {strdup(scene), strdup(spec)};
    list->failed |= !needs || !texts[0] || !texts[1];
    if (list->failed) {
        free((char *)texts[0]);
        free((char *)texts[1]);
        return;
    }
    claim->needs[claim->need_count++] = (struct need){texts[0], texts[1]};
}

/* Check a claim's cells to their ends in both schemes, and collect their needs. */
static enum status cells_check(const struct claims *claims, const struct csv *published, struct claim *claim)
{
    const struct csv *csv = &claims->csv;
    struct needs_list list = {.claim = claim};
    enum status status = STATUS_OK;
    for (enum scheme scheme = 0; scheme < SCHEMES && status == STATUS_OK; scheme++) {
        struct formula formula = formula_of(claims, claim, scheme, published);
        formula.need = need_keep;
        formula.to = &list;
        struct evaluation evaluation = {.evidence = ""};
        status = quantities_read(&formula, "arguments", claim->arguments);
        if (status == STATUS_OK)
            status = comparisons_read(&formula, "comparison", claim->comparison, &evaluation);
        claim->by_scheme = formula.by_scheme;
        claim->measures = formula.measures;
        claim->phases = formula.phases;
        claim->rules = formula.rules;
        claim->scenes = formula.scenes;
        claim->times = formula.times;
    }
    if (status == STATUS_OK && list.failed)
        status = status_set(STATUS_FAILED, "%s: line %d: no memory for %d measurements", csv->path, claim->line,
                            claim->need_count + 1);
    bool phases_alone = claim->phases && claim->need_count == 0; /* formulas against the exact spectrum */
    if (status == STATUS_OK && comparison_decides(claim->comparison) && !phases_alone
        && claim->measures == comparison_identity(claim->comparison))
        status = status_set(STATUS_INVALID, "%s: line %d: column comparison: %s", csv->path, claim->line,
                            claim->measures ? "'identity' is for claims without measurements"
                                            : "the claim has no measurement; 'identity COMPARISON(...)' is needed");
    return status;
}

static enum status rows_read(struct claims *claims, const struct csv *published)
{
    struct csv *csv = &claims->csv;
    enum status status = STATUS_OK;
    claims->claims = calloc((size_t)csv->row_count + 1, sizeof *claims->claims);
    if (!claims->claims)
        return status_set(STATUS_FAILED, "%s: no memory for %d claims", csv->path, csv->row_count);
    for (int row = 0; row < csv->row_count && status == STATUS_OK; row++) {
        struct claim *claim = &claims->claims[claims->count++];
        status = row_read(csv, row, claim);
        if (status == STATUS_OK)
            status = cells_check(claims, published, claim);
    }
    return status;
}

enum status claims_read(const char *path, struct claims *claims)
{
    struct csv published = {0};
    *claims = (struct claims){0};
    enum status status = csv_read(path, CSV_TAIL_KEEP, &claims->csv);
    if (status == STATUS_OK)
        status = csv_columns(&claims->csv, columns, NULL);
    if (status == STATUS_OK)
        status = csv_read(data_path(DATA_NUMBERS), CSV_TAIL_KEEP, &claims->numbers);
    if (status == STATUS_OK)
        status = csv_columns(&claims->numbers, number_columns, NULL);
    if (status == STATUS_OK)
        status = published_read(&published);
    if (status == STATUS_OK)
        status = rows_read(claims, &published);
    csv_free(&published);
    if (status != STATUS_OK)
        claims_free(claims);
    return status;
}

void claims_free(struct claims *claims)
{
    for (int n = 0; n < claims->count; n++) {
        for (int k = 0; k < claims->claims[n].need_count; k++) {
            free((char *)claims->claims[n].needs[k].scene);
            free((char *)claims->claims[n].needs[k].spec);
        }
        free(claims->claims[n].needs);
    }
    free(claims->claims);
    csv_free(&claims->numbers);
    csv_free(&claims->csv);
    *claims = (struct claims){0};
}

/* ---- evaluating ---- */

/* "NAME = 0.452, NAME = 0.01 to 0.45 (median 0.2); criterion: ..." */
static void evidence_begin(struct evaluation *evaluation, const struct formula *formula, const struct claim *claim)
{
    size_t size = sizeof evaluation->evidence;
    for (int k = 0; k < formula->count; k++) {
        struct values values = formula->named[k].values;
        text_append(evaluation->evidence, size, "%s%s = ", k ? ", " : "", formula->named[k].name);
        values_append(evaluation->evidence, size, &values);
        if (values.count > 1)
            text_append(evaluation->evidence, size, " (median %.4g)", median(values.at, values.count));
    }
    text_append(evaluation->evidence, size, "; %s: %s",
                comparison_decides(claim->comparison) ? "criterion" : "no criterion", claim->criterion);
    if (*claim->changed)
        text_append(evaluation->evidence, size, "; criterion changed %s", claim->changed);
}

/* What a verdict rests on: settings, scenes and printed tables, each named once. */
struct basis {
    char settings[900], scenes[1200], slices[40], tables[200];
};

/* A SPEC may go on behind a comma; a blank follows a complete one. */
static bool named(const char *list, const char *text)
{
    size_t length = strlen(text);
    for (const char *at = list; (at = strstr(at, text)); at += length)
        if ((at == list || at[-1] == ' ')
            && (!at[length] || strncmp(at + length, ", ", 2) == 0 || strncmp(at + length, " (", 2) == 0))
            return true;
    return false;
}

/* "bp22/table3 (c 1500 m/s, beam rect cut by the middle angle at 0.405)": what the scene assumes and papers do not
   print. */
static void scene_describe(const char *name, char *text, size_t size)
{
    struct scene scene;
    snprintf(text, size, "%s", name);
    if (assumed_scene_load(name, &scene) != STATUS_OK)
        return;
    text_append(text, size, " (c %g m/s, beam %s", scene.acquisition.sound_speed,
                scene.beam.kind == BEAM_RECT ? "rect" : "of both elements");
    if (scene.beam.truncation == TRUNCATION_NONE)
        text_append(text, size, ", not cut");
    else
        text_append(text, size, " cut by %s at %g",
                    scene.beam.truncation == TRUNCATION_TX     ? "theta_t"
                    : scene.beam.truncation == TRUNCATION_MID  ? "the middle angle"
                    : scene.beam.truncation == TRUNCATION_SINE ? "sine"
                                                               : "Doppler",
                    scene.beam.limit);
    text_append(text, size, ")");
    scene_free(&scene);
}

/* The description of a scene is kept: many claims rest on the same one. */
static const char *scene_described(const char *name)
{
    static char names[32][80], texts[32][200];
    int k = 0;
    while (k < 31 && *names[k] && strcmp(names[k], assumed_scene_name(name)) != 0)
        k++;
    if (strcmp(names[k], assumed_scene_name(name)) != 0) {
        snprintf(names[k], sizeof names[k], "%s", assumed_scene_name(name));
        scene_describe(name, texts[k], sizeof texts[k]);
    }
    return texts[k];
}

static void text_add(char *list, size_t size, const char *name, const char *text)
{
    if (!named(list, name))
        text_append(list, size, "%s%s", *list ? ", " : "", text);
}

static void basis_use(void *to, enum use use, const char *text)
{
    struct basis *basis = to;
    switch (use) {
    case USE_SCENE: text_add(basis->scenes, sizeof basis->scenes, text, scene_described(text)); break;
    case USE_SETTING: text_add(basis->settings, sizeof basis->settings, text, text); break;
    case USE_SLICE: text_add(basis->slices, sizeof basis->slices, text, text); break;
    case USE_TABLE: text_add(basis->tables, sizeof basis->tables, text, text); break;
    }
}

static void basis_add(void *to, const char *scene, const char *spec)
{
    basis_use(to, USE_SCENE, scene);
    basis_use(to, USE_SETTING, spec);
}

/* "; settings: ...; scenes: ...; slices: ...; printed numbers: ..." */
static void basis_append(char *evidence, size_t size, const struct basis *basis)
{
    const struct {
        const char *title, *list;
    } parts[] = {{"settings", basis->settings},
                 {"scenes", basis->scenes},
                 {"slices", basis->slices},
                 {"printed numbers", basis->tables}};
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++)
        if (*parts[k].list)
            text_append(evidence, size, "; %s: %s", parts[k].title, parts[k].list);
}

struct evaluation claim_evaluate(const struct claims *claims, const struct claim *claim, enum scheme scheme,
                                 struct measured *measured)
{
    struct basis basis = {.settings = ""};
    struct formula formula = formula_of(claims, claim, scheme, &measured->published);
    formula.measured = measured;
    formula.need = basis_add;
    formula.use = basis_use;
    formula.to = &basis;
    struct evaluation evaluation = {.evidence = ""}, answers = {.evidence = ""};
    *measured->missing = '\0';
    enum status status = quantities_read(&formula, "arguments", claim->arguments);
    if (status == STATUS_OK)
        status = comparisons_read(&formula, "comparison", claim->comparison, &answers);
    if (status != STATUS_OK || *measured->missing) {
        evaluation.verdict = CLAIM_UNDECIDED;
        snprintf(evaluation.evidence, sizeof evaluation.evidence, "%s; criterion: %s",
                 status == STATUS_OK ? measured->missing : status_message(), claim->criterion);
    } else {
        evaluation.verdict = answers.verdict;
        evidence_begin(&evaluation, &formula, claim); /* now that all names are known */
        text_append(evaluation.evidence, sizeof evaluation.evidence, "%s", answers.evidence);
    }
    basis_append(evaluation.evidence, sizeof evaluation.evidence, &basis);
    return evaluation;
}
