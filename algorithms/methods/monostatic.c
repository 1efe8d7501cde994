/* The filter that turns multi-receiver echoes into monostatic ones (wavenumber/monostatic_plan.h), as "monostatic |
   wk_squint": omega-k of squinted multi-receiver scenes. At broadside rma_delay corrects what this leaves off the
   beam's axis.

   Cost: 4 taps + 6 FLOPs a sample, behind the compression. Error: predicted by the phase that is left, over receivers,
   ranges and the beam; above 0.1 the problem is refused. */
#include <math.h>
#include <omp.h>
#include <stdlib.h>

#include "contract/condition.h"
#include "range_migration/rma.h"
#include "wavenumber/monostatic_plan.h"

static const double ERROR_MOST = 0.1; /* as rma_delay's */

struct options {
    int taps; /* index into rma_delay_taps_names */
};

static const struct param params[] = {
    {PARAM_NAMED(struct options, taps, rma_delay_taps_names), .summary = "taps of the receivers' delays", .initial = 2,
     .max = 3},
    {.name = NULL},
};

/* rad: the phase that is wrong in an echo from a range, `angle` off broadside. */
static double phase_left(const struct monostatic *m, const struct centre *centre, double range, double angle)
{
    const double c = m->acquisition->sound_speed;
    const struct vector place = {range * sin(angle), range * cos(angle), 0}, still = {0, 0, 0}, v = {m->speed, 0, 0};
    const double own = delay_exact(still, still, v, place, c);
    const double pair = delay_exact((struct vector){centre->tx, 0, 0}, (struct vector){centre->rx, 0, 0}, v, place, c);
    return 2 * M_PI * m->acquisition->fc * (pair - monostatic_delay(m, centre, own));
}

/* Root mean square over receivers, the beam, and the nearest and farthest rows, of which the worse counts. */
static double error_left(const struct monostatic *m, const struct problem *problem)
{
    enum { ANGLES = 5 };
    const struct acquisition *a = m->acquisition;
    const double half = asin(fmin(condition_cut_sine(a), 0.98));
    double worst = 0;
    for (int k = 0; k < 4 * problem->patch_count; k++) {
        const struct grid *g = &problem->patches[k / 4];
        const struct vector corner = grid_point(g, k & 1 ? g->r_count - 1 : 0, k & 2 ? g->x_count - 1 : 0);
        double sum = 0;
        for (int n = 0; n < a->receivers * ANGLES; n++) {
            const double angle = m->squint + half * (n % ANGLES - ANGLES / 2) / (ANGLES / 2);
            const double left = phase_left(m, &m->centres[n / ANGLES], fabs(corner.y) / fmax(cos(angle), 0.02), angle);
            sum += left * left;
        }
        worst = fmax(worst, corner.y != 0 ? sqrt(sum / (a->receivers * ANGLES)) : INFINITY);
    }
    return worst;
}

static int by_offset(const void *one, const void *other)
{
    const double a = ((const struct centre *)one)->rx, b = ((const struct centre *)other)->rx;
    return (a > b) - (a < b);
}

/* Centres in the order of the track, and from the raster of equal spacing that is nearest to them. */
static void centres_place(struct monostatic *m, const struct straight_track *track)
{
    const struct acquisition *a = m->acquisition;
    const int count = a->receivers;
    struct centre *sorted = store_take(&m->store, (size_t)count, sizeof *sorted, 1);
    double mean = 0;
    if (m->store.failed)
        return;
    for (int k = 0; k < count; k++) {
        sorted[k] = (struct centre){.place = k, .rx = a->rx[k].x - a->tx[0].x};
        mean += sorted[k].rx / 2 / count;
    }
    qsort(sorted, (size_t)count, sizeof *sorted, by_offset);
    m->spacing = track->spacing / count;
    m->first = track->x_first + mean - (count - 1) / 2.0 * m->spacing;
    for (int k = 0; k < count; k++) {
        const int place = m->spacing < 0 ? count - 1 - k : k;
        const double from = m->first + place * m->spacing - track->x_first;
        m->centres[sorted[k].place] = (struct centre){place, -from, sorted[k].rx - from};
    }
}

static enum status monostatic_check(const struct monostatic *m, const struct problem *problem)
{
    const struct acquisition *a = problem->acquisition;
    double uneven = 0;
    for (int k = 0; k < a->receivers; k++)
        uneven = fmax(uneven, fabs(m->centres[k].tx + m->centres[k].rx) / 2);
    if (m->left <= ERROR_MOST)
        return STATUS_OK;
    return status_set(STATUS_UNSUPPORTED,
                      "monostatic: condition conversion: relative error %.2g is left off the beam's axis; at most %g. "
                      "Receivers' middles lie up to %.2g m off an even spacing of %.3g m (cure: back projection, or a "
                      "shorter array, rows farther away, a ping spacing of receivers times pitch/2)",
                      m->left, ERROR_MOST, uneven, fabs(m->spacing));
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
    if (!acquisition_is_straight(a, &track) || a->pings < 2)
        return status_set(STATUS_UNSUPPORTED, "monostatic: condition uniform_track: two pings and more of a uniform "
                                              "straight track are needed (cure: back projection)");
    struct monostatic *m = calloc(1, sizeof *m);
    if (!m)
        return status_set(STATUS_FAILED, "monostatic: no memory for a plan");
    *m = (struct monostatic){.acquisition = a,
                             .precision = problem->precision,
                             .speed = track.speed,
                             .squint = a->echo_squint,
                             .threads = omp_get_max_threads(),
                             .taps = taps[((const struct options *)options)->taps]};
    m->length = a->samples + 2 * m->taps;
    m->centres = store_take(&m->store, (size_t)a->receivers, sizeof *m->centres, 1);
    centres_place(m, &track);
    enum status status = STATUS_OK;
    if (!m->store.failed) {
        m->left = error_left(m, problem);
        status = monostatic_check(m, problem);
    }
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

const struct algorithm monostatic = {
    .name = "monostatic",
    .summary = "receivers become pings of a monostatic sonar",
    .reference = "SQ18 section 1, [2]; this project's delays",
    .options_size = sizeof(struct options),
    .params = params,
    .plan = monostatic_plan,
    .filtered = monostatic_filtered,
    .filter = monostatic_filter,
    .work = monostatic_work,
    .destroy = monostatic_destroy,
};
