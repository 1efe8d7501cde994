/* Tables and stages of the conversion (monostatic_plan.h). Compiled once for each precision. */
#include "wavenumber/monostatic_plan.h"

#include <omp.h>
#include <string.h>

#include "backprojection/traces.h"
#include "common/fft.h"
#include "common/fft_length.h"
#include "range_migration/delay_compensation.h"

static void weights_fill(struct monostatic *m)
{
    struct delay_taps *taps = store_take(&m->store, 1, sizeof *taps, 1);
    m->weights = store_take(&m->store, (size_t)(MONOSTATIC_NODES + 1) * (size_t)m->taps, 2 * sizeof(real), 1);
    m->store.failed = m->store.failed || delay_taps_make(m->acquisition, 1, m->taps, taps) != STATUS_OK;
    for (int i = 0; i <= MONOSTATIC_NODES && !m->store.failed; i++) {
        double weights[DELAY_TAPS], slopes[DELAY_TAPS];
        delay_taps_weights(taps, (double)i / MONOSTATIC_NODES, weights, slopes);
        for (int k = 0; k < 2 * m->taps; k++)
            ((real *)m->weights)[2 * i * m->taps + k] = (real)weights[k / 2];
    }
}

/* The terms along the raster and its wavenumbers, these unfolded about that of the beam's axis. */
static void terms_fill(struct monostatic *m)
{
    const struct acquisition *a = m->acquisition;
    const struct spectrum_setting setting = monostatic_setting(m);
    const size_t pings = (size_t)a->pings * (size_t)a->receivers, terms = (size_t)m->terms;
    m->wavenumbers = fft_length_quick((long long)pings + (long long)pings / 8 + 32); /* products spread a little */
    m->store.failed = m->store.failed || m->wavenumbers == 0;
    const size_t length = (size_t)m->wavenumbers;
    m->vectors = store_take(&m->store, terms * pings, sizeof(complex_real), 1);
    m->products = store_take(&m->store, terms * MONOSTATIC_RANGES * length, sizeof(complex_real), 1);
    m->strips = store_take(&m->store, (size_t)m->threads * MONOSTATIC_STRIPS * MONOSTATIC_STRIP * length,
                           sizeof(complex_real), 1.0 / m->threads);
    if (m->store.failed)
        return;
    m->forward = fft_strip(&m->store, m->wavenumbers, MONOSTATIC_STRIP, m->strips, m->strips, FFTW_FORWARD);
    m->inverse = fft_strip(&m->store, m->wavenumbers, MONOSTATIC_STRIP, m->strips, m->strips, FFTW_BACKWARD);
    for (int q = 0; q < m->terms; q++)
        for (size_t n = 0; n < pings; n++) {
            const int ping = (int)n / a->receivers, receiver = (int)n % a->receivers;
            const int row = monostatic_row(m, ping, receiver);
            const size_t to = (size_t)(ping * a->receivers + m->centres[row].place);
            ((complex_real *)m->vectors)[(size_t)q * pings + to] =
                (complex_real)m->basis[(size_t)q * (size_t)m->rows + (size_t)row];
        }
    const double centroid = spectrum_wavenumber(&setting, m->squint) * m->spacing;
    for (int n = 0; n < m->terms * MONOSTATIC_RANGES; n++)
        for (size_t k = 0; k < length; k++) {
            const double cycles = (double)k / (double)length;
            const double nu = (cycles + floor(centroid - cycles + 0.5)) / m->spacing;
            ((complex_real *)m->products)[(size_t)n * length + k] =
                (complex_real)(monostatic_value(m, n / MONOSTATIC_RANGES, n % MONOSTATIC_RANGES, nu) / (double)length);
        }
}

void REAL_NAME(monostatic_fill)(struct monostatic *m)
{
    const struct acquisition *a = m->acquisition;
    const size_t all = (size_t)m->rows * (size_t)a->samples;
    const struct traces_form form = {.upsample = 1, .guard = m->taps};
    const double records = (double)a->pings * a->receivers;
    struct traces_shape shape;
    m->begins = store_take(&m->store, all, sizeof *m->begins, 1);
    m->nodes = store_take(&m->store, all, sizeof *m->nodes, 1);
    m->turns = store_take(&m->store, all, sizeof(complex_real), 1);
    m->scratch = store_take(&m->store, (size_t)m->threads, (size_t)m->length * sizeof(complex_real), 1.0 / m->threads);
    weights_fill(m);
    if (!m->store.failed && REAL_NAME(traces).plan(a, &form, m->threads, &shape, &m->traces) == STATUS_OK)
        store_keep(&m->store, m->traces, REAL_NAME(traces).destroy);
    m->store.failed = m->store.failed || !m->traces;
    if (!m->store.failed && m->terms > 0)
        terms_fill(m);
    if (m->store.failed)
        return;
#pragma omp parallel for schedule(static) num_threads(m->threads)
    for (int row = 0; row < m->rows; row++)
        m->delays_loop(m, row);
    m->work.flops = records * (shape.flops + a->samples * (4.0 * m->taps + 6));
    if (m->terms > 0)
        m->work.flops += a->samples
                         * ((m->terms + 1) * fft_flops(m->wavenumbers)
                            + m->terms * (6 * records + (6 * 4 + 8) * (double)m->wavenumbers));
    m->work.bytes = m->store.bytes + shape.bytes;
}

/* Samples first to first + width of all pings of the raster. */
static void strip_turn(const struct monostatic *m, int first, int width, complex_real *converted, complex_real *strips)
{
    const size_t pings = (size_t)m->acquisition->pings * (size_t)m->acquisition->receivers;
    const size_t length = (size_t)m->wavenumbers, samples = (size_t)m->acquisition->samples;
    const size_t room = length * MONOSTATIC_STRIP;
    complex_real *held = strips, *term = held + room, *sum = term + room;
    memset(strips, 0, MONOSTATIC_STRIPS * room * sizeof *strips);
    for (size_t n = 0; n < pings; n++)
        memcpy(held + n * MONOSTATIC_STRIP, converted + n * samples + first, (size_t)width * sizeof *held);
    for (int q = 0; q < m->terms; q++) {
        m->vector_loop(m, q, held, term);
        memset(term + pings * MONOSTATIC_STRIP, 0, (length - pings) * MONOSTATIC_STRIP * sizeof *term);
        FFTW(execute_dft)(m->forward, term, term);
        m->product_loop(m, q, first, term, sum);
    }
    FFTW(execute_dft)(m->inverse, sum, sum);
    for (size_t n = 0; n < pings; n++)
        memcpy(converted + n * samples + first, sum + n * MONOSTATIC_STRIP, (size_t)width * sizeof *sum);
}

static void terms_apply(const struct monostatic *m, complex_real *converted)
{
    const int samples = m->acquisition->samples;
    const size_t room = MONOSTATIC_STRIPS * MONOSTATIC_STRIP * (size_t)m->wavenumbers;
#pragma omp parallel for schedule(static) num_threads(m->threads)
    for (int first = 0; first < samples; first += MONOSTATIC_STRIP) {
        const int width = samples - first < MONOSTATIC_STRIP ? samples - first : MONOSTATIC_STRIP;
        complex_real *strips = (complex_real *)m->strips + (size_t)omp_get_thread_num() * room;
        strip_turn(m, first, width, converted, strips);
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
        const int row = monostatic_row(m, (int)ping, (int)receiver);
        const size_t to = (ping * receivers + (size_t)m->centres[row].place) * count;
        REAL_NAME(traces).fill(m->traces, omp_get_thread_num(), (const complex_real *)samples + (size_t)n * count,
                               record);
        m->record_loop(m, row, record, (complex_real *)converted + to);
    }
    if (m->terms > 0)
        terms_apply(m, converted);
}
