/* Measure what the papers' tables and claims rest on, set their numbers beside ours, and decide the claims
   (reproduce.h). */
#include "claims/reproduce.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "files/folder.h"
#include "files/paths.h"
#include "text/suggestion.h"
#include "text/text_append.h"
#include "imaging/spec.h"
#include "papers/figures.h"
#include "papers/assumptions.h"
#include "papers/rules.h"
#include "scene/scene.h"
#include "show/plot.h"
#include "run/batch.h"
#include "papers/phase.h"
#include "advise/predicted.h"

enum { NEEDS_MAX = 256 };

/* As ids are written: "t3" for "table3", "f8" for "fig8" or "Figure 8". */
static void id_brief(const char *id, char *brief, size_t size)
{
    static const char *const words[] = {"table", "figure", "fig"};
    *brief = '\0';
    while (*id) {
        size_t length = 0;
        for (size_t k = 0; k < sizeof words / sizeof *words && length == 0; k++)
            if (strncasecmp(id, words[k], strlen(words[k])) == 0)
                length = strlen(words[k]) + strspn(id + strlen(words[k]), " ._");
        text_append(brief, size, "%c", *id);
        id += length > 0 ? length : 1;
    }
}

/* A table by its name, all claims, or one claim by its id. */
static enum status id_select(const char *id, struct selection *selection)
{
    char accepted[900] = "", brief[40], meant[SUGGESTION_TEXT];
    bool found = false;
    id_brief(id, brief, sizeof brief);
    struct suggestion suggestion = suggestion_begin(brief);
    for (int k = 0; paper_tables[k].id; k++) {
        bool same = strcmp(paper_tables[k].id, id) == 0;
        found |= same;
        selection->tables[k] |= same;
        text_append(accepted, sizeof accepted, "%s, ", paper_tables[k].id);
        suggestion_offer(&suggestion, paper_tables[k].id);
    }
    suggestion_offer(&suggestion, "claims");
    suggestion_offer(&suggestion, "sensitivity");
    for (int k = 0; k < selection->claims->count; k++) {
        bool same = strcmp(selection->claims->claims[k].id, id) == 0 || strcmp(id, "claims") == 0;
        found |= same;
        selection->asked[k] |= same;
        suggestion_offer(&suggestion, selection->claims->claims[k].id);
    }
    suggestion_text(&suggestion, meant);
    return found ? STATUS_OK
                 : status_set(STATUS_INVALID,
                              "reproduce: '%.100s' is not a table%s accepted: %sa claim as bp22-4.1-1, or sensitivity "
                              "alone",
                              id, meant, accepted);
}

/* Those of the request; quick, those without times, full-size scenes and scenes from seeds. */
static enum status select_all(const struct reproduction *request, struct selection *selection)
{
    const bool all = request->count == 0;
    enum status status = STATUS_OK;
    if (selection->claims->count > CLAIMS_MAX)
        return status_set(STATUS_INVALID, "%s: %d claims; up to %d are accepted", data_path(DATA_CLAIMS),
                          selection->claims->count, CLAIMS_MAX);
    for (int n = 0; n < request->count && status == STATUS_OK; n++)
        status = id_select(request->ids[n], selection);
    for (int k = 0; paper_tables[k].id; k++)
        selection->tables[k] =
            (selection->tables[k] || all) && !(request->quick && table_is_full_size(&paper_tables[k]));
    for (int k = 0; k < selection->claims->count; k++) {
        const struct claim *claim = &selection->claims->claims[k];
        selection->asked[k] = (selection->asked[k] || all) && !(request->quick && (claim->times || claim->rules));
    }
    return status;
}

typedef enum status each_scene(struct batch *batch, const struct scene *scene, int spec_count,
                               const struct spec *specs);

/* All needs of one scene; those of `needs` that are done lose their scene. */
static enum status scene_measure(struct batch *batch, struct need *needs, int count, each_scene *each)
{
    struct scene scene;
    struct spec specs[NEEDS_MAX];
    int spec_count = 0;
    const char *name = needs[0].scene;
    enum status status = assumed_scene_load(name, &scene);
    if (status != STATUS_OK)
        return status;
    for (int k = 0; k < count && status == STATUS_OK; k++)
        if (needs[k].scene && strcmp(needs[k].scene, name) == 0) {
            status = spec_own(needs[k].spec, &specs[spec_count]);
            spec_count += status == STATUS_OK;
            needs[k].scene = NULL;
        }
    if (status == STATUS_OK)
        status = each(batch, &scene, spec_count, specs);
    for (int k = 0; k < spec_count; k++)
        spec_free(&specs[k]);
    scene_free(&scene);
    return status;
}

/* Our files have the names of those that we read: the folder of the latter is refused. */
static enum status directory_check(const char *directory)
{
    char path[4200];
    struct stat ours, theirs;
    snprintf(path, sizeof path, "%s/claims.csv", directory);
    if (stat(path, &theirs) == 0 && stat(data_path(DATA_CLAIMS), &ours) == 0 && ours.st_dev == theirs.st_dev
        && ours.st_ino == theirs.st_ino)
        return status_set(STATUS_INVALID,
                          "reproduce: -o %s: its claims.csv is the list of claims; another folder is "
                          "accepted",
                          directory);
    return STATUS_OK;
}

/* All needs of the requested tables and claims. */
static int needs_collect(const struct selection *selection, struct need needs[NEEDS_MAX])
{
    int count = 0;
    for (int k = 0; paper_tables[k].id; k++)
        if (selection->tables[k])
            count = table_needs(paper_tables[k].id, needs, count, NEEDS_MAX);
    for (int k = 0; k < selection->claims->count; k++)
        for (int n = 0; n < selection->claims->claims[k].need_count && selection->asked[k]; n++)
            count = need_add(needs, count, NEEDS_MAX, selection->claims->claims[k].needs[n]);
    return count;
}

/* Is the phase study needed, by a figure of it, or by a claim about it? */
static bool phases_asked(const struct selection *selection)
{
    bool asked = false;
    for (int k = 0; paper_tables[k].id; k++)
        asked |= selection->tables[k] && table_has_phases(paper_tables[k].id);
    for (int k = 0; k < selection->claims->count; k++)
        asked |= selection->asked[k] && selection->claims->claims[k].phases;
    return asked;
}

static bool rules_asked(const struct selection *selection)
{
    bool asked = false;
    for (int k = 0; k < selection->claims->count; k++)
        asked |= selection->asked[k] && selection->claims->claims[k].rules;
    return asked;
}

/* Does it with each scene. */
static enum status scenes_measure(struct batch *batch, const struct need *needs, int count, each_scene *each)
{
    struct need left[NEEDS_MAX];
    enum status status = STATUS_OK;
    memcpy(left, needs, (size_t)count * sizeof *left);
    for (int k = 0; k < count && status == STATUS_OK; k++)
        if (left[k].scene)
            status = scene_measure(batch, left + k, count - k, each);
    return status;
}

/* Needs into a folder, which is made, without times. */
static enum status needs_measure(const char *directory, struct need *needs, int count)
{
    struct batch batch = {0};
    enum status status = batch_open(directory, count, false, &batch);
    batch.effort = EFFORT_NONE;
    if (status == STATUS_OK)
        status = scenes_measure(&batch, needs, count, batch_scene);
    return batch_close(&batch, status);
}

static bool figure_asked(const void *of, const char *id)
{
    const struct selection *selection = of;
    bool asked = false;
    for (int k = 0; paper_tables[k].id; k++)
        asked |= selection->tables[k] && strcmp(paper_tables[k].id, id) == 0;
    return asked;
}

/* What the folder's measurements say. */
static enum status selection_report(struct batch *batch, const struct selection *selection, bool measured)
{
    const char *directory = batch->directory;
    bool predicted = false;
    enum status status = STATUS_OK;
    if (phases_asked(selection))
        status = phase_study(directory, true);
    if (status == STATUS_OK && rules_asked(selection))
        status = rules_study(directory);
    if (status == STATUS_OK && batch->effort != EFFORT_NONE)
        status = figures_draw(directory, figure_asked, selection, &batch->undrawn);
    if (status == STATUS_OK)
        status = reproduced_report(directory, selection);
    if (status == STATUS_OK && measured)
        status = predicted_write(directory, NULL, 0, &predicted);
    if (predicted && status == STATUS_OK)
        undrawn_note(predicted_draw(directory), &batch->undrawn);
    return status;
}

static enum status selection_reproduce(const struct selection *selection, const struct shard *shard,
                                       const char *directory, enum effort effort)
{
    struct need needs[NEEDS_MAX];
    struct batch batch;
    const int count = needs_collect(selection, needs);
    enum status status = batch_open(directory, count, false, &batch);
    batch.shard = *shard;
    batch.effort = effort;
    if (status == STATUS_OK)
        status = scenes_measure(&batch, needs, count, batch_cells);
    if (status == STATUS_OK)
        status = batch_deal(&batch);
    if (status == STATUS_OK)
        status = scenes_measure(&batch, needs, count, batch_scene);
    bool whole = false;
    if (status == STATUS_OK)
        status = batch_join(&batch, &whole);
    if (status == STATUS_OK && whole)
        status = selection_report(&batch, selection, count > 0);
    return batch_close(&batch, status);
}

static enum status sensitivity_reproduce(const char *directory, const char *untimed, const struct claims *claims)
{
    int lock = -1;
    enum status status = directory_make(directory);
    if (status == STATUS_OK)
        status = folder_take(directory, &lock);
    if (status == STATUS_OK)
        status = sensitivity_study(directory, untimed, claims, needs_measure);
    folder_leave(lock);
    return status;
}

/* Times, and what is only measured together with them, have rows of their own: those without times are no part of a
   whole run. */
#define UNTIMED "untimed"

static enum status request_check(const struct reproduction *request, bool sensitivity)
{
    if (sensitivity && request->shard)
        return status_set(STATUS_INVALID, "reproduce: --shard %s: sensitivity is measured as a whole, without it",
                          request->shard);
    if (sensitivity && request->quick)
        return status_set(STATUS_INVALID, "reproduce: --quick: sensitivity has no times, and is measured as a whole");
    if (request->docs && (request->quick || request->shard || (request->count > 0 && !sensitivity)))
        return status_set(STATUS_INVALID,
                          "reproduce: --docs goes with all tables and claims, or with sensitivity; "
                          "not with %s",
                          request->quick   ? "--quick"
                          : request->shard ? "--shard"
                                           : request->ids[0]);
    if (request->docs && access(data_path(DATA_PAGES), W_OK) != 0)
        return status_set(STATUS_INVALID, "reproduce: --docs writes into %s, which cannot be written: use a clone",
                          data_path(DATA_PAGES));
    return directory_check(request->directory);
}

enum status papers_reproduce(const struct reproduction *request)
{
    struct claims claims = {0};
    struct selection selection = {.claims = &claims};
    struct shard shard;
    char untimed[4200];
    const bool sensitivity = request->count == 1 && strcmp(request->ids[0], "sensitivity") == 0;
    enum status status = shard_parse("reproduce", request->shard, &shard);
    if (status == STATUS_OK)
        status = request_check(request, sensitivity);
    if (status == STATUS_OK)
        status = claims_read(data_path(DATA_CLAIMS), &claims);
    snprintf(untimed, sizeof untimed, "%s/" UNTIMED, request->directory);
    if (status == STATUS_OK && sensitivity) {
        status = sensitivity_reproduce(request->directory, untimed, &claims);
    } else if (status == STATUS_OK) {
        status = select_all(request, &selection);
        if (status == STATUS_OK)
            status = selection_reproduce(&selection, &shard, request->quick ? untimed : request->directory,
                                         request->quick ? EFFORT_NONE : EFFORT_WHOLE);
    }
    if (status == STATUS_OK && request->docs)
        status = pages_write(request->directory, data_path(DATA_PAGES), &claims);
    claims_free(&claims);
    return status;
}
