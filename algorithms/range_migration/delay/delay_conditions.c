/* What delay compensation needs beyond the conditions of all range migrations (delay_compensation.h). */
#include <math.h>

#include "range_migration/delay_compensation.h"

static const double TERMS_LIMIT = 0.05, TAPS_LIMIT = 0.05; /* relative L2: half of what the predicted error may be */

int delay_conditions(const struct rma_view *view, struct condition *list, int count)
{
    const double error = view->converts ? delay_taps_error(view->problem->acquisition, view->method->taps) : 0;
    list[count++] = (struct condition){"delay_terms",
                                       delay_terms_left(view, view->method->terms),
                                       TERMS_LIMIT,
                                       false,
                                       SEVERITY_REFUSE,
                                       "the phase error that the terms over the receivers leave (relative L2)",
                                       "more terms, rows farther away, a shorter array or a narrower beam"};
    list[count++] = (struct condition){"delay_taps",
                                       error,
                                       TAPS_LIMIT,
                                       false,
                                       SEVERITY_REFUSE,
                                       "the error of a delay by half a sample (relative L2 of the pulse)",
                                       "more taps, or a higher sampling rate"};
    return count;
}
