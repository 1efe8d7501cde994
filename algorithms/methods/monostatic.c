/* The filter that turns multi-receiver echoes of any track into monostatic ones of a straight one
   (wavenumber/monostatic_plan.h): motion compensation, as "monostatic | rma_delay", and omega-k of multi-receiver
   scenes, as "monostatic | wk_squint".

   Cost: 4 taps + 6 FLOPs a sample, behind the compression; where terms are needed, a transform along the track for each
   and one back. Error: predicted by the phase that is left, over records, ranges, the band and the beam; above 0.05
   the problem is refused. */
#include <math.h>
#include <omp.h>
#include <stdlib.h>

#include "contract/condition.h"
#include "range_migration/rma.h"
#include "wavenumber/monostatic_plan.h"

static const double ERROR_MOST = 0.05; /* predicted errors above that may be measured twice as large */

struct options {
    int taps; /* index into rma_delay_taps_names */
};

static const struct param params[] = {
    {PARAM_NAMED(struct options, taps, rma_delay_taps_names), .summary = "taps of the receivers' delays", .initial = 2,
     .max = 3},
    {.name = NULL},
};

struct receiver {
    int number;
    double offset; /* m along the track */
};

static int by_offset(const void *one, const void *other)
{
    const double a = ((const struct receiver *)one)->offset, b = ((const struct receiver *)other)->offset;
    return (a > b) - (a < b);
}

static struct vector from_place(struct vector v, double x)
{
    return (struct vector){v.x - x, v.y, v.z};
}

/* Centres in the order of the track, and from the raster of equal spacing that is nearest to them. */
static void centres_place(struct monostatic *m, const struct straight_track *track)
{
    const struct acquisition *a = m->acquisition;
    const int count = a->receivers;
    struct receiver *sorted = store_take(&m->store, (size_t)count, sizeof *sorted, 1);
    m->centres = store_take(&m->store, (size_t)m->rows, sizeof *m->centres, 1);
    double mean = 0;
    if (m->store.failed)
        return;
    for (int k = 0; k < count; k++) {
        sorted[k] = (struct receiver){k, a->rx[k].x - a->tx[0].x};
        mean += sorted[k].offset / 2 / count;
    }
    qsort(sorted, (size_t)count, sizeof *sorted, by_offset);
    m->spacing = track->spacing / count;
    m->first = track->x_first + mean - (count - 1) / 2.0 * m->spacing;
    for (int k = 0; k < count; k++)
        for (int p = 0; p < (m->straight ? 1 : a->pings); p++) {
            const int place = m->spacing < 0 ? count - 1 - k : k, receiver = sorted[k].number;
            const double x = m->first + (p * count + place) * m->spacing;
            m->centres[monostatic_row(m, p, receiver)] =
                (struct centre){place, from_place(a->tx[p], x), from_place(a->rx[p * count + receiver], x),
                                m->straight ? (struct vector){m->speed, 0, 0} : a->velocity[p]};
        }
}

static enum status monostatic_check(const struct monostatic *m)
{
    const struct acquisition *a = m->acquisition;
    double along = 0, aside = 0;
    for (int k = 0; k < m->rows; k++) {
        const struct centre *at = &m->centres[k];
        along = fmax(along, fabs(at->tx.x + at->rx.x) / 2);
        aside = fmax(aside, fmax(hypot(at->tx.y, at->tx.z), hypot(at->rx.y, at->rx.z)));
    }
    if (m->left <= ERROR_MOST)
        return STATUS_OK;
    return status_set(STATUS_UNSUPPORTED,
                      "monostatic: condition conversion: relative error %.2g is left off the beam's axis; at most %g. "
                      "The track lies up to %.2g m (%.2g wavelengths) beside a straight one, the receivers' middles up "
                      "to %.2g m off an even spacing of %.3g m (cure: back projection, or a straighter track, a "
                      "narrower beam, a shorter array, rows farther away, a ping spacing of receivers times pitch/2)",
                      m->left, ERROR_MOST, aside, aside * a->fc / a->sound_speed, along, fabs(m->spacing));
}

static void monostatic_destroy(void *plan)
{
    struct monostatic *m = plan;
    if (!m)
        return;
    store_release(&m->store);
    free(m);
}

static enum status monostatic_plan(const struct problem *problem, const void *method, const void *options, void **plan)
{
    static const int taps[] = {8, 12, 16, 24};
    const struct acquisition *a = problem->acquisition;
    struct straight_track track;
    (void)method;
    *plan = NULL;
    if (a->pings < 2 || !isfinite(acquisition_unevenness(a, &track)))
        return status_set(STATUS_UNSUPPORTED, "monostatic: condition track: two pings and more at different places are "
                                              "needed (cure: back projection)");
    const bool straight = acquisition_is_straight(a, NULL);
    const int rows = straight ? a->receivers : a->pings * a->receivers;
    const size_t each = sizeof(int) + sizeof(short) + (problem->precision == PRECISION_DOUBLE ? 16 : 8);
    const enum status room = memory_check((double)rows * a->samples * (double)each, "monostatic's delays");
    if (room != STATUS_OK)
        return room;
    struct monostatic *m = calloc(1, sizeof *m);
    if (!m)
        return status_set(STATUS_FAILED, "monostatic: no memory for a plan");
    *m = (struct monostatic){.acquisition = a,
                             .precision = problem->precision,
                             .speed = track.speed,
                             .squint = a->echo_squint,
                             .straight = straight,
                             .rows = rows,
                             .threads = omp_get_max_threads(),
                             .delays_loop = ISA_CHOOSE(monostatic_delays, problem->precision),
                             .record_loop = ISA_CHOOSE(monostatic_record, problem->precision),
                             .vector_loop = ISA_CHOOSE(monostatic_vector, problem->precision),
                             .product_loop = ISA_CHOOSE(monostatic_product, problem->precision),
                             .taps = taps[((const struct options *)options)->taps]};
    m->length = a->samples + 2 * m->taps;
    centres_place(m, &track);
    enum status status = STATUS_OK;
    if (!m->store.failed)
        monostatic_terms(m, problem);
    if (!m->store.failed)
        status = monostatic_check(m);
    if (status == STATUS_OK && !m->store.failed)
        (m->precision == PRECISION_DOUBLE ? monostatic_fill_double : monostatic_fill_float)(m);
    if (status == STATUS_OK && m->store.failed)
        status = status_set(STATUS_FAILED, "monostatic: no memory for a plan");
    if (status == STATUS_OK)
        *plan = m;
    else
        monostatic_destroy(m);
    return status;
}

static enum status monostatic_filtered(const void *plan, struct acquisition *out)
{
    const struct monostatic *m = plan;
    const struct acquisition *a = m->acquisition;
    *out = *a;
    out->pings = a->pings * a->receivers;
    out->receivers = 1;
    if (!(a->pri > 0) && m->speed != 0) /* the real pings', as records overlap by these */
        out->pri = fabs(m->spacing * a->receivers / m->speed);
    out->compressed = true;
    out->pulse_length = 0;
    const enum status status = acquisition_allocate(out);
    for (int p = 0; p < out->pings && status == STATUS_OK; p++) {
        out->t0[p] = a->t0[0];
        out->tx[p] = out->rx[p] = (struct vector){m->first + p * m->spacing, 0, 0};
        out->velocity[p] = (struct vector){m->speed, 0, 0};
    }
    return status;
}

static enum status monostatic_filter(void *plan, const void *samples, void *filtered, struct stages *stages)
{
    const struct monostatic *m = plan;
    (void)stages; /* the chain's */
    (m->precision == PRECISION_DOUBLE ? monostatic_convert_double : monostatic_convert_float)(m, samples, filtered);
    return STATUS_OK;
}

static struct work monostatic_work(const void *plan)
{
    return ((const struct monostatic *)plan)->work;
}

static enum status monostatic_errors(const struct problem *problem, const void *method, const void *options,
                                     struct forecast *forecast)
{
    void *plan;
    const enum status status = monostatic_plan(problem, method, options, &plan);
    if (status != STATUS_OK)
        return status;
    forecast->error[CAUSE_DELAYS] = hypot(forecast->error[CAUSE_DELAYS], ((const struct monostatic *)plan)->left);
    monostatic_destroy(plan);
    return STATUS_OK;
}

const struct algorithm monostatic = {
    .name = "monostatic",
    .summary = "receivers become pings of a monostatic sonar on a straight track",
    .reference = "SQ18 section 1, [2]; this project's delays",
    .options_size = sizeof(struct options),
    .params = params,
    .errors = monostatic_errors,
    .plan = monostatic_plan,
    .filtered = monostatic_filtered,
    .filter = monostatic_filter,
    .work = monostatic_work,
    .destroy = monostatic_destroy,
};
