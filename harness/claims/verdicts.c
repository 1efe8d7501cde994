/* How many claims have each verdict (verdicts.h). */
#include "claims/verdicts.h"

#include <stdio.h>
#include <string.h>

#include "files/text_file.h"

void verdicts_add(struct verdicts *verdicts, int claim, const struct evaluation evaluations[SCHEMES])
{
    verdicts->evaluated[claim] = true;
    for (enum scheme scheme = 0; scheme < SCHEMES; scheme++)
        verdicts->of[claim][scheme] = evaluations[scheme].verdict;
    verdicts->noisy[claim] =
        evaluations[0].verdict == CLAIM_UNDECIDED && strstr(evaluations[0].evidence, ": within the noise");
}

/* Of one paper (NULL: all) by one scheme; the corrected one counts only claims that name a scheme. Returns how many
   there are. */
static int count(const struct verdicts *verdicts, const char *paper, enum scheme scheme, int counts[CLAIM_VERDICTS])
{
    int total = 0;
    memset(counts, 0, CLAIM_VERDICTS * sizeof *counts);
    for (int k = 0; k < verdicts->claims->count; k++) {
        const struct claim *claim = &verdicts->claims->claims[k];
        if (!verdicts->evaluated[k] || (paper && strcmp(claim->paper, paper) != 0) || (scheme && !claim->by_scheme))
            continue;
        counts[verdicts->of[k][scheme]]++;
        total++;
    }
    return total;
}

/* "N of those that do not hold by ... alone; N of those that cannot be decided are times within the noise of their
   run." */
static void reasons_write(FILE *stream, const struct verdicts *verdicts)
{
    int by_formula = 0, noisy = 0;
    for (int k = 0; k < verdicts->claims->count; k++) {
        by_formula +=
            verdicts->evaluated[k] && !verdicts->claims->claims[k].measures && verdicts->of[k][0] == CLAIM_FAILS;
        noisy += verdicts->evaluated[k] && verdicts->noisy[k];
    }
    fprintf(stream,
            "As printed %d of those that do not hold fail by the papers' formulas and numbers alone;\n%d of those that "
            "cannot be decided are times, or rest on them, that lie within the noise of their run.\n",
            by_formula, noisy);
}

void verdicts_print(FILE *stream, const struct verdicts *verdicts)
{
    int counts[CLAIM_VERDICTS];
    fputs("\nVerdicts\n", stream);
    for (enum scheme scheme = 0; scheme < SCHEMES; scheme++) {
        int total = count(verdicts, NULL, scheme, counts);
        fprintf(stream, "  %-10s", scheme_names[scheme]);
        for (int k = 0; k < CLAIM_VERDICTS; k++)
            fprintf(stream, "%s %d %s", k ? "," : "", counts[k], claim_verdict_names[k]);
        fprintf(stream, scheme ? " (of the %d that depend on LBF21's scheme).\n" : " (of %d).\n", total);
    }
    reasons_write(stream, verdicts);
}

static void row_write(FILE *stream, const char *title, const struct verdicts *verdicts, const char *paper,
                      enum scheme scheme)
{
    int counts[CLAIM_VERDICTS], total = count(verdicts, paper, scheme, counts);
    fprintf(stream, "| %s | %d |", title, total);
    for (int k = 0; k < CLAIM_VERDICTS; k++)
        fprintf(stream, " %d |", counts[k]);
    fputc('\n', stream);
}

/* Is it the first claim of its paper? */
static bool paper_begins(const struct claims *claims, int k)
{
    return k == 0 || strcmp(claims->claims[k].paper, claims->claims[k - 1].paper) != 0;
}

enum status verdicts_write(const char *path, const char *head, const struct verdicts *verdicts)
{
    const struct claims *claims = verdicts->claims;
    struct text_file file;
    enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    fprintf(file.stream, "# Verdicts\n\nWritten by `./sasbench reproduce`: %s\n\n| | claims |", head);
    for (int k = 0; k < CLAIM_VERDICTS; k++)
        fprintf(file.stream, " %s |", claim_verdict_names[k]);
    fputs("\n|---|---|---|---|---|---|---|\n", file.stream);
    row_write(file.stream, "all, as printed", verdicts, NULL, SCHEME_PRINTED);
    for (int k = 0; k < claims->count; k++)
        if (paper_begins(claims, k))
            row_write(file.stream, claims->claims[k].paper, verdicts, claims->claims[k].paper, SCHEME_PRINTED);
    row_write(file.stream, "those that depend on LBF21's scheme, corrected", verdicts, NULL, SCHEME_CORRECTED);
    fputc('\n', file.stream);
    reasons_write(file.stream, verdicts);
    fputs("\n| claim | statement | as printed | corrected |\n|---|---|---|---|\n", file.stream);
    for (int k = 0; k < claims->count; k++)
        if (verdicts->evaluated[k])
            fprintf(file.stream, "| `%s` | %s | %s%s | %s |\n", claims->claims[k].id, claims->claims[k].claim,
                    claim_verdict_names[verdicts->of[k][0]], verdicts->noisy[k] ? " (within the noise)" : "",
                    claims->claims[k].by_scheme ? claim_verdict_names[verdicts->of[k][SCHEME_CORRECTED]] : "");
    return text_file_close(&file, STATUS_OK);
}
