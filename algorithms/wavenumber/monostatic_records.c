/* Tables and loops of the conversion (monostatic_plan.h). Compiled once for each precision. */
#include "wavenumber/monostatic_plan.h"

#include <omp.h>

#include "backprojection/traces.h"
#include "common/fft.h"
#include "range_migration/delay_compensation.h"

static void weights_fill(struct monostatic *m)
{
    struct delay_taps *taps = store_take(&m->store, 1, sizeof *taps, 1);
    m->weights = store_take(&m->store, (size_t)(MONOSTATIC_NODES + 1) * (size_t)m->taps, sizeof(real), 1);
    m->store.failed = m->store.failed || delay_taps_make(m->acquisition, m->taps, taps) != STATUS_OK;
    for (int i = 0; i <= MONOSTATIC_NODES && !m->store.failed; i++) {
        double weights[DELAY_TAPS], slopes[DELAY_TAPS];
        delay_taps_weights(taps, (double)i / MONOSTATIC_NODES, weights, slopes);
        for (int k = 0; k < m->taps; k++)
            ((real *)m->weights)[i * m->taps + k] = (real)weights[k];
    }
}

static void delays_fill(struct monostatic *m, int receiver)
{
    const struct acquisition *a = m->acquisition;
    const size_t row = (size_t)receiver * (size_t)a->samples;
    for (int n = 0; n < a->samples; n++) {
        const double t = a->t0[0] + n / a->fs, tau = monostatic_delay(m, &m->centres[receiver], t);
        const double at = (tau - a->t0[0]) * a->fs;
        if (!(at > -1 && at < a->samples)) /* nothing is recorded there */
            continue;
        const double node = nearbyint((at - floor(at)) * MONOSTATIC_NODES);
        m->begins[row + (size_t)n] = (int)floor(at) + 1 - m->taps / 2 + m->taps;
        m->nodes[row + (size_t)n] = (unsigned short)node;
        ((complex_real *)m->turns)[row + (size_t)n] = rotor(a->fc * (tau - t));
    }
}

void REAL_NAME(monostatic_fill)(struct monostatic *m)
{
    const struct acquisition *a = m->acquisition;
    const size_t all = (size_t)a->receivers * (size_t)a->samples;
    const struct traces_form form = {.upsample = 1, .guard = m->taps};
    struct traces_shape shape;
    m->begins = store_take(&m->store, all, sizeof *m->begins, 1);
    m->nodes = store_take(&m->store, all, sizeof *m->nodes, 1);
    m->turns = store_take(&m->store, all, sizeof(complex_real), 1);
    m->scratch = store_take(&m->store, (size_t)m->threads, (size_t)m->length * sizeof(complex_real), 1.0 / m->threads);
    weights_fill(m);
    if (!m->store.failed && REAL_NAME(traces).plan(a, &form, m->threads, &shape, &m->traces) == STATUS_OK)
        store_keep(&m->store, m->traces, REAL_NAME(traces).destroy);
    m->store.failed = m->store.failed || !m->traces;
    if (m->store.failed)
        return;
    for (int receiver = 0; receiver < a->receivers; receiver++)
        delays_fill(m, receiver);
    m->work.flops = (double)a->pings * a->receivers * (shape.flops + a->samples * (4.0 * m->taps + 6));
    m->work.bytes = m->store.bytes + shape.bytes;
}

/* Guards are zero, and the taps reach into them. */
static void record_convert(const struct monostatic *m, int receiver, const real *record, real *restrict to)
{
    const int samples = m->acquisition->samples, taps = m->taps;
    const size_t row = (size_t)receiver * (size_t)samples;
    const real *turns = (const real *)m->turns + 2 * row;
    for (int n = 0; n < samples; n++) {
        const real *from = record + 2 * (size_t)m->begins[row + (size_t)n];
        const real *weights = (const real *)m->weights + (size_t)m->nodes[row + (size_t)n] * (size_t)taps;
        const real c = turns[2 * n], s = turns[2 * n + 1];
        real re = 0, im = 0;
#pragma omp simd reduction(+ : re, im)
        for (int k = 0; k < taps; k++) {
            re += weights[k] * from[2 * k];
            im += weights[k] * from[2 * k + 1];
        }
        to[2 * n] = re * c - im * s;
        to[2 * n + 1] = re * s + im * c;
    }
}

void REAL_NAME(monostatic_convert)(const struct monostatic *m, const void *samples, void *converted)
{
    const struct acquisition *a = m->acquisition;
    const size_t count = (size_t)a->samples, receivers = (size_t)a->receivers;
#pragma omp parallel for schedule(static) num_threads(m->threads)
    for (int n = 0; n < a->pings * a->receivers; n++) {
        const size_t ping = (size_t)n / receivers, receiver = (size_t)n % receivers;
        complex_real *record = (complex_real *)m->scratch + (size_t)omp_get_thread_num() * (size_t)m->length;
        const size_t to = (ping * receivers + (size_t)m->centres[receiver].place) * count;
        REAL_NAME(traces).fill(m->traces, omp_get_thread_num(), (const complex_real *)samples + (size_t)n * count,
                               record);
        record_convert(m, (int)receiver, (const real *)record, (real *)((complex_real *)converted + to));
    }
}
