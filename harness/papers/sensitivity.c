/* Which verdicts depend on what the papers do not print (sensitivity.h). */
#include "papers/sensitivity.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "data/text_file.h"
#include "papers/assumptions.h"

enum { NEEDS_MAX = 256, SETS_MAX = 12, CLAIMS_MAX = 400 };

/* Measured, and on none of the full-size scenes, which are for times. */
static bool takes_part(const struct claim *claim)
{
    bool part = claim->need_count > 0 && judge_decides(claim->judge);
    for (int k = 0; k < claim->need_count; k++)
        part = part && strncmp(claim->needs[k].scene, "bp22/full", 9) != 0
               && strncmp(claim->needs[k].scene, "lbf21/real_size", 15) != 0;
    return part;
}

struct verdicts {
    enum claim_verdict of[SETS_MAX][CLAIMS_MAX][SCHEMES];
};

static enum status set_judge(const char *directory, const struct claims *claims,
                             enum claim_verdict verdicts[CLAIMS_MAX][SCHEMES])
{
    struct measured measured;
    enum status status = measured_read(directory, &measured);
    for (int k = 0; k < claims->count && status == STATUS_OK; k++)
        for (enum scheme scheme = 0; scheme < SCHEMES && takes_part(&claims->claims[k]); scheme++)
            verdicts[k][scheme] = claim_judge(claims, &claims->claims[k], scheme, &measured).verdict;
    measured_free(&measured);
    return status;
}

static void row_write(FILE *stream, const struct claim *claim, enum scheme scheme, const struct verdicts *verdicts,
                      int k)
{
    bool flips = false;
    for (int n = 1; assumption_sets[n].name; n++)
        flips |= verdicts->of[n][k][scheme] != verdicts->of[0][k][scheme];
    fprintf(stream, "| %s%s%s |", flips ? "**" : "", claim->id, flips ? "**" : "");
    if (claim->by_scheme)
        fprintf(stream, " %s |", scheme_names[scheme]);
    else
        fputs(" |", stream);
    for (int n = 0; assumption_sets[n].name; n++) {
        bool same = n && verdicts->of[n][k][scheme] == verdicts->of[0][k][scheme];
        fprintf(stream, " %s |", same ? "same" : claim_verdict_names[verdicts->of[n][k][scheme]]);
    }
    fputc('\n', stream);
}

static enum status table_write(const char *directory, const struct claims *claims, const struct verdicts *verdicts)
{
    char path[4200];
    struct text_file file;
    snprintf(path, sizeof path, "%s/sensitivity.md", directory);
    enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    fputs("| claim | scheme |", file.stream);
    for (int n = 0; assumption_sets[n].name; n++)
        fprintf(file.stream, " %s |", assumption_sets[n].title);
    fputs("\n|---|---|", file.stream);
    for (int n = 0; assumption_sets[n].name; n++)
        fputs("---|", file.stream);
    fputc('\n', file.stream);
    for (int k = 0; k < claims->count; k++)
        for (enum scheme scheme = 0; scheme < (claims->claims[k].by_scheme ? SCHEMES : 1); scheme++)
            if (takes_part(&claims->claims[k]))
                row_write(file.stream, &claims->claims[k], scheme, verdicts, k);
    return text_file_close(&file, STATUS_OK);
}

enum status sensitivity_study(const char *directory, const struct claims *claims,
                              enum status (*measure)(const char *directory, struct need *needs, int count))
{
    static struct verdicts verdicts;
    enum status status = STATUS_OK;
    for (int n = 0; assumption_sets[n].name && status == STATUS_OK; n++) {
        char folder[4200];
        struct need needs[NEEDS_MAX];
        int count = 0;
        for (int k = 0; k < claims->count; k++)
            for (int need = 0; need < claims->claims[k].need_count && takes_part(&claims->claims[k]); need++)
                count = need_add(needs, count, NEEDS_MAX, claims->claims[k].needs[need]);
        snprintf(folder, sizeof folder, "%s/sensitivity-%s", directory, assumption_sets[n].name);
        assumptions_choose(&assumption_sets[n]);
        printf("\n%s\n", assumption_sets[n].title);
        status = measure(folder, needs, count);
        if (status == STATUS_OK)
            status = set_judge(folder, claims, verdicts.of[n]);
    }
    assumptions_choose(assumption_sets);
    if (status == STATUS_OK)
        status = table_write(directory, claims, &verdicts);
    if (status == STATUS_OK)
        printf("\nResults: %s/sensitivity.md.\n", directory);
    return status;
}
