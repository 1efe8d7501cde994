/* How a claim is judged (claims.h). */
#include "papers/claims.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "measure/timing.h"

const char *const claim_verdict_names[CLAIM_VERDICTS] = {[CLAIM_HOLDS] = "holds",
                                             [CLAIM_ASSUMED] = "holds under stated assumption",
                                             [CLAIM_FAILS] = "does not hold",
                                             [CLAIM_UNDECIDED] = "cannot be decided"};

const struct claim *const claim_tables[] = {claims_bp22, claims_zp15, claims_lbf21_phase, claims_lbf21, NULL};

struct finding finding(bool strict, bool assumed, const char *format, ...)
{
    struct finding finding = {.verdict = strict ? CLAIM_HOLDS : assumed ? CLAIM_ASSUMED : CLAIM_FAILS};
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(finding.evidence, sizeof finding.evidence, format, arguments);
    va_end(arguments);
    return finding;
}

struct finding finding_undecided(const char *format, ...)
{
    struct finding finding = {.verdict = CLAIM_UNDECIDED};
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(finding.evidence, sizeof finding.evidence, format, arguments);
    va_end(arguments);
    return finding;
}

struct finding claim_judge(const struct claim *claim, struct measured *measured)
{
    *measured->missing = '\0';
    struct finding found = claim->judge(measured);
    return *measured->missing ? finding_undecided("%s", measured->missing) : found;
}

struct spread spread_of(struct measured *measured, const char *scene, const char *spec, const char *other,
                        const char *definition, size_t offset, const char *name, int first, int count)
{
    struct spread spread = {NAN, NAN, NAN};
    double values[64];
    if (count > (int)(sizeof values / sizeof *values))
        count = sizeof values / sizeof *values;
    for (int k = 0; k < count; k++) {
        values[k] = measured_target(measured, scene, spec, first + k, definition, offset, name);
        if (other)
            values[k] -= measured_target(measured, scene, other, first + k, definition, offset, name);
        if (!isfinite(values[k]))
            return spread;
        spread.least = fmin(spread.least, values[k]);
        spread.largest = fmax(spread.largest, values[k]);
    }
    spread.median = median(values, count);
    return spread;
}

double spread_magnitude(struct spread spread)
{
    return fmax(fabs(spread.least), fabs(spread.largest));
}

struct spread spread_join(struct spread a, struct spread b)
{
    return (struct spread){fmin(a.least, b.least), (a.median + b.median) / 2, fmax(a.largest, b.largest)};
}
