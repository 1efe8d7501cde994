/* What delay compensation needs beyond the conditions of all range migrations (delay.h). */
#include <math.h>

#include "range_migration/delay.h"

static const double TERMS_LIMIT = 0.05, TAPS_LIMIT = 0.05; /* relative L2: half of what the predicted error may be */

int delay_conditions(const struct rma_view *view, struct condition *list, int count)
{
    struct delay_terms terms;
    struct delay_taps taps;
    double left = delay_terms_make(view, view->method->terms, &terms) ? terms.left : NAN;
    delay_terms_free(&terms);
    if (delay_taps_make(view->problem->acquisition, view->method->taps, &taps) != STATUS_OK)
        left = NAN;
    list[count++] = (struct condition){"delay_terms",
                                       left,
                                       TERMS_LIMIT,
                                       false,
                                       SEVERITY_REFUSE,
                                       "what the terms over the receivers leave of their phases (relative L2)",
                                       "more terms, rows farther away, a shorter array or a narrower beam"};
    list[count++] = (struct condition){"delay_taps",
                                       view->converts ? taps.error : 0,
                                       TAPS_LIMIT,
                                       false,
                                       SEVERITY_REFUSE,
                                       "the error of a delay by half a sample (relative L2 of the pulse)",
                                       "more taps, or a higher sampling rate"};
    return count;
}
