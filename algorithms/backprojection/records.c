/* The samples of the records that an image's pairs read, and their rows (traces.h). */
#include <math.h>
#include <omp.h>
#include <stdio.h>

#include "backprojection/bp_engine.h"
#include "backprojection/pairs/pairs.h"

/* Noise up to this share of the echoes' energy is rounding: it lies beyond the band, where a part of a record errs by a
   tenth of it. */
static const double BEYOND = 1e-12;

struct sample_span bp_samples_read(const struct bp *bp)
{
    return pairs_samples(&bp->problem, bp->met, bp->engine->beside ? bp->engine->beside(bp) : 0);
}

/* Rows have the samples at the delays, those that the taps reach, and one more for rounding to the nearest. */
struct traces_form bp_records_form(struct bp *bp, struct sample_span read)
{
    const struct bp_table *table = &bp->table;
    const int end = bp->problem.acquisition->samples - 1, taps = table->branches > 1 ? 1 : table->taps;
    bp->medium.first = floor(read.first);
    bp->medium.last = ceil(read.last);
    const int first = (int)fmax(0, bp->medium.first + table->first - 1);
    const int last = (int)fmin(end, bp->medium.last + table->first + taps + 1);
    const struct acquisition *a = bp->problem.acquisition;
    /* The plain path takes whole records. */
    const bool limited = a->compressed && !a->filtered && !(a->noise > BEYOND) && bp->medium.phase_limit > 0;
    return (struct traces_form){.upsample = table->upsample,
                                .degree = table->branches - 1,
                                .guard = table->guard,
                                .preemphasis = table->preemphasis,
                                .first = first,
                                .count = last - first + 1,
                                .band = limited ? a->bandwidth / a->fs : 0};
}

/* With AVX-512, too, 32 bytes at a time: values lie anywhere, and each store of 64 bytes would touch two cache
   lines. */
static const struct planes *const planes[][2] = {
    [ISA_BASELINE] = {&planes_float_baseline, &planes_double_baseline},
#ifdef SASBENCH_X86_64
    [ISA_V3] = {&planes_float_v3, &planes_double_v3},
    [ISA_V4] = {&planes_float_v3, &planes_double_v3},
#endif
};

const struct planes *planes_choose(enum precision precision)
{
    return planes[isa_choose()][precision];
}

enum status bp_plan_traces(struct bp *bp, struct sample_span read)
{
    const struct acquisition *a = bp->problem.acquisition;
    const struct traces_form form = bp_records_form(bp, read);
    const enum status status =
        traces_of(bp->problem.precision)->plan(a, &form, omp_get_max_threads(), &bp->shape, &bp->traces);
    if (status != STATUS_OK)
        return status;
    bp->engines.bytes += bp->shape.bytes;
    store_keep(&bp->engines, bp->traces, traces_of(bp->problem.precision)->destroy);
    bp->planes = planes_choose(bp->problem.precision);
    bp->table.origin = bp->table.guard - bp->shape.first * bp->table.upsample;
    return STATUS_OK;
}

void bp_records_skipped(const struct bp *bp, char *text, size_t room, const char *join)
{
    const int all = bp->problem.acquisition->samples, from = bp->shape.from, end = from + bp->shape.read;
    const int first = end > all ? end - all : 0, last = from < 0 ? all + from - 1 : all - 1; /* of those not around */
    char before[40] = "", behind[40] = "";
    if (from > first)
        snprintf(before, sizeof before, "%d-%d", first, from - 1);
    if (end <= last)
        snprintf(behind, sizeof behind, "%d-%d", end, last);
    if (*before || *behind)
        snprintf(text, room, "%ssamples %s%s%s of %d, which no pixel reads", join, before,
                 *before && *behind ? " and " : "", behind, all);
}
