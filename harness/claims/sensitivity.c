/* Which verdicts depend on what the papers do not print (reproduce.h). */
#include "claims/reproduce.h"

#include <stdio.h>
#include <string.h>

#include "files/text_file.h"
#include "papers/assumptions.h"
#include "papers/phase.h"

enum { NEEDS_MAX = 256, SETS_MAX = 12 };

/* Is it of a scene? Full-size scenes are out, as they are for times, and scenes from seeds, which the sets do not
   change. */
static bool takes_part(const struct claim *claim)
{
    bool scenes = claim->need_count > 0 || claim->phases || claim->scenes;
    return comparison_decides(claim->comparison) && scenes && !claim->rules && !claim->times;
}

struct set_verdicts {
    enum claim_verdict of[SETS_MAX][CLAIMS_MAX][SCHEMES];
};

/* What the set changes of all needs of the claims. */
static int needs_collect(const struct claims *claims, const struct assumptions *set, struct need needs[NEEDS_MAX])
{
    int count = 0;
    for (int k = 0; k < claims->count; k++)
        for (int n = 0; n < claims->claims[k].need_count && takes_part(&claims->claims[k]); n++) {
            const struct need *need = &claims->claims[k].needs[n];
            const char *spec = assumed_text(need->spec);
            if (set == assumption_sets || strcmp(assumed_scene_name(need->scene), need->scene) != 0
                || spec != need->spec)
                count = need_add(needs, count, NEEDS_MAX, (struct need){need->scene, spec});
        }
    return count;
}

static enum status phases_write(const char *directory)
{
    enum status status = STATUS_OK;
    for (int k = 0; k < PHASE_SETUPS && status == STATUS_OK; k++) {
        struct scene scene;
        status = assumed_scene_load(phase_setups[k], &scene);
        if (status == STATUS_OK) {
            status = phase_curves_write(&scene, directory);
            scene_free(&scene);
        }
    }
    return status;
}

static enum status set_evaluate(const char *directory, const struct claims *claims,
                                enum claim_verdict verdicts[CLAIMS_MAX][SCHEMES])
{
    struct measured measured;
    enum status status = measured_read(directory, &measured);
    for (int k = 0; k < claims->count && status == STATUS_OK; k++)
        for (enum scheme scheme = 0; scheme < SCHEMES && takes_part(&claims->claims[k]); scheme++)
            verdicts[k][scheme] = claim_evaluate(claims, &claims->claims[k], scheme, &measured).verdict;
    measured_free(&measured);
    return status;
}

static bool flips(const struct set_verdicts *verdicts, int k, enum scheme scheme)
{
    bool flipped = false;
    for (int n = 1; assumption_sets[n].name; n++)
        flipped |= verdicts->of[n][k][scheme] != verdicts->of[0][k][scheme];
    return flipped;
}

static enum status verdicts_write(const char *directory, const struct claims *claims,
                                  const struct set_verdicts *verdicts, const struct measured *measured)
{
    char path[4200];
    struct text_file file;
    int part = 0, flipped = 0;
    snprintf(path, sizeof path, "%s/sensitivity.csv", directory);
    enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    reproduced_head(file.stream, "sensitivity", measured);
    fputs("claim,scheme,assumption,verdict\n", file.stream);
    for (int k = 0; k < claims->count; k++)
        for (enum scheme scheme = 0; scheme < (claims->claims[k].by_scheme ? SCHEMES : 1); scheme++) {
            if (!takes_part(&claims->claims[k]))
                continue;
            part++;
            flipped += flips(verdicts, k, scheme);
            for (int n = 0; assumption_sets[n].name; n++)
                csv_write_fields(file.stream,
                                 (const char *const[]){claims->claims[k].id, scheme_names[scheme],
                                                       assumption_sets[n].title,
                                                       claim_verdict_names[verdicts->of[n][k][scheme]], NULL},
                                 NULL, 0, true);
        }
    status = text_file_close(&file, STATUS_OK);
    if (status == STATUS_OK)
        printf("\n%d verdicts, %d of them change. Results: %s.\n", part, flipped, path);
    return status;
}

enum status sensitivity_study(const char *directory, const char *untimed, const struct claims *claims,
                              enum status (*measure)(const char *directory, struct need *needs, int count))
{
    static struct set_verdicts verdicts;
    struct measured measured;
    enum status status = STATUS_OK;
    for (int n = 0; assumption_sets[n].name && status == STATUS_OK; n++) {
        struct need needs[NEEDS_MAX];
        assumptions_choose(&assumption_sets[n]);
        printf("\n%s\n", assumption_sets[n].title);
        status = measure(untimed, needs, needs_collect(claims, &assumption_sets[n], needs));
        if (status == STATUS_OK)
            status = phases_write(untimed);
        if (status == STATUS_OK)
            status = set_evaluate(untimed, claims, verdicts.of[n]);
    }
    assumptions_choose(assumption_sets);
    if (status != STATUS_OK)
        return status;
    status = measured_read(untimed, &measured);
    if (status == STATUS_OK)
        status = verdicts_write(directory, claims, &verdicts, &measured);
    measured_free(&measured);
    return status;
}
