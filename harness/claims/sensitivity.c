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

/* ---- the table ---- */

static bool flips(const struct set_verdicts *verdicts, int k, enum scheme scheme)
{
    bool flipped = false;
    for (int n = 1; assumption_sets[n].name; n++)
        flipped |= verdicts->of[n][k][scheme] != verdicts->of[0][k][scheme];
    return flipped;
}

static void row_write(FILE *stream, const struct claim *claim, enum scheme scheme, const struct set_verdicts *verdicts,
                      int k)
{
    fprintf(stream, "| `%s`%s%s: %s | %s |", claim->id, claim->by_scheme ? ", " : "",
            claim->by_scheme ? scheme_names[scheme] : "", claim->claim,
            claim_verdict_names[verdicts->of[0][k][scheme]]);
    for (int n = 1; assumption_sets[n].name; n++) {
        bool same = verdicts->of[n][k][scheme] == verdicts->of[0][k][scheme];
        const char *name = claim_verdict_names[verdicts->of[n][k][scheme]];
        fprintf(stream, same ? " same |" : " **%s** |", name);
    }
    fputc('\n', stream);
}

static void steady_write(FILE *stream, const struct claims *claims, const struct set_verdicts *verdicts)
{
    for (enum claim_verdict verdict = 0; verdict < CLAIM_VERDICTS; verdict++) {
        int count = 0;
        for (int k = 0; k < claims->count; k++)
            for (enum scheme scheme = 0; scheme < (claims->claims[k].by_scheme ? SCHEMES : 1); scheme++) {
                if (!takes_part(&claims->claims[k]) || flips(verdicts, k, scheme)
                    || verdicts->of[0][k][scheme] != verdict)
                    continue;
                if (count++ == 0)
                    fprintf(stream, "\nThe same under all: %s\n", claim_verdict_names[verdict]);
                fprintf(stream, "%s`%s`%s%s", count > 1 ? ", " : "\n", claims->claims[k].id,
                        claims->claims[k].by_scheme ? " " : "",
                        claims->claims[k].by_scheme ? scheme_names[scheme] : "");
            }
        fputs(count ? "\n" : "", stream);
    }
}

/* How many verdicts take part, and how many of them flip. */
static void flips_count(const struct claims *claims, const struct set_verdicts *verdicts, int *part, int *flipped)
{
    *part = *flipped = 0;
    for (int k = 0; k < claims->count; k++)
        for (enum scheme scheme = 0; scheme < (claims->claims[k].by_scheme ? SCHEMES : 1); scheme++)
            if (takes_part(&claims->claims[k])) {
                ++*part;
                *flipped += flips(verdicts, k, scheme);
            }
}

static enum status table_write(const char *directory, const struct claims *claims, const struct set_verdicts *verdicts)
{
    char path[4200];
    struct text_file file;
    int part, flipped;
    snprintf(path, sizeof path, "%s/sensitivity.md", directory);
    enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    flips_count(claims, verdicts, &part, &flipped);
    fprintf(
        file.stream,
        "# Verdicts under other assumptions\n\nWritten by `./sasbench reproduce sensitivity`. Of %d verdicts on image "
        "quality and phase %d change under one of the\nassumptions at least:\n\n| claim | %s |",
        part, flipped, assumption_sets[0].title);
    for (int n = 1; assumption_sets[n].name; n++)
        fprintf(file.stream, " %s |", assumption_sets[n].title);
    fputs("\n|---|", file.stream);
    for (int n = 0; assumption_sets[n].name; n++)
        fputs("---|", file.stream);
    fputc('\n', file.stream);
    for (int k = 0; k < claims->count; k++)
        for (enum scheme scheme = 0; scheme < (claims->claims[k].by_scheme ? SCHEMES : 1); scheme++)
            if (takes_part(&claims->claims[k]) && flips(verdicts, k, scheme))
                row_write(file.stream, &claims->claims[k], scheme, verdicts, k);
    steady_write(file.stream, claims, verdicts);
    status = text_file_close(&file, STATUS_OK);
    if (status == STATUS_OK)
        printf("\n%d verdicts, %d of them change. Results: %s.\n", part, flipped, path);
    return status;
}

enum status sensitivity_study(const char *directory, const struct claims *claims,
                              enum status (*measure)(const char *directory, struct need *needs, int count))
{
    static struct set_verdicts verdicts;
    enum status status = STATUS_OK;
    char folder[4200];
    snprintf(folder, sizeof folder, "%s/sensitivity", directory);
    for (int n = 0; assumption_sets[n].name && status == STATUS_OK; n++) {
        struct need needs[NEEDS_MAX];
        assumptions_choose(&assumption_sets[n]);
        printf("\n%s\n", assumption_sets[n].title);
        status = measure(folder, needs, needs_collect(claims, &assumption_sets[n], needs));
        if (status == STATUS_OK)
            status = phases_write(folder);
        if (status == STATUS_OK)
            status = set_evaluate(folder, claims, verdicts.of[n]);
    }
    assumptions_choose(assumption_sets);
    return status == STATUS_OK ? table_write(directory, claims, &verdicts) : status;
}
