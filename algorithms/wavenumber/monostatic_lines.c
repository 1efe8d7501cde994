/* Loops of the conversion (monostatic_plan.h). Compiled once for each precision and instruction set (BP_ISA names
   it). */
#include "common/cubic.h"
#include "common/phasor.h"
#include "common/real.h"
#include "wavenumber/monostatic_plan.h"

enum { LANES = 8 }; /* real and imaginary parts of LANES/2 values: taps come by fours */
typedef real vec __attribute__((vector_size(LANES * sizeof(real)), aligned(sizeof(real))));

void REAL_ISA_NAME(monostatic_delays)(const struct monostatic *m, int row_number)
{
    enum { SPAN = 64 };
    const struct acquisition *a = m->acquisition;
    const struct centre centre = m->centres[row_number];
    const double t0 = a->t0[m->straight ? 0 : row_number / a->receivers];
    const size_t row = (size_t)row_number * (size_t)a->samples;
    int *begins = m->begins + row;
    unsigned short *nodes = m->nodes + row;
    real *turns = (real *)m->turns + 2 * row;
    for (int first = 0; first < a->samples; first += SPAN) {
        const int count = a->samples - first < SPAN ? a->samples - first : SPAN;
        double at[SPAN];
        real cycles[SPAN], c[SPAN], s[SPAN];
        for (int i = 0; i < count; i++) {
            const double t = a->t0[0] + (first + i) / a->fs, tau = monostatic_delay(m, &centre, t);
            const double turned = a->fc * (tau - t);
            at[i] = (tau - t0) * a->fs;
            cycles[i] = (real)(turned - floor(turned + 0.5));
        }
#pragma omp simd
        for (int i = 0; i < count; i++)
            phasor(cycles[i], &c[i], &s[i]);
        for (int i = 0; i < count; i++) {
            if (!(at[i] > -1 && at[i] < a->samples)) /* nothing is recorded there */
                continue;
            const double whole = floor(at[i]);
            begins[first + i] = (int)whole + 1 - m->taps / 2 + m->taps;
            nodes[first + i] = (unsigned short)floor((at[i] - whole) * MONOSTATIC_NODES + 0.5);
            turns[2 * (first + i)] = c[i];
            turns[2 * (first + i) + 1] = s[i];
        }
    }
}

/* Guards are zero, and the taps reach into them. */
void REAL_ISA_NAME(monostatic_record)(const struct monostatic *m, int row_number, const void *record, void *converted)
{
    const int samples = m->acquisition->samples, taps = m->taps;
    const size_t row = (size_t)row_number * (size_t)samples;
    const real *turns = (const real *)m->turns + 2 * row;
    real *restrict to = converted;
    for (int n = 0; n < samples; n++) {
        const real *from = (const real *)record + 2 * (size_t)m->begins[row + (size_t)n];
        const real *weights = (const real *)m->weights + 2 * (size_t)m->nodes[row + (size_t)n] * (size_t)taps;
        vec sum = {0};
        for (int k = 0; k < 2 * taps; k += LANES)
            sum += *(const vec *)(weights + k) * *(const vec *)(from + k);
        const real c = turns[2 * n], s = turns[2 * n + 1];
        const real re = (sum[0] + sum[4]) + (sum[2] + sum[6]), im = (sum[1] + sum[5]) + (sum[3] + sum[7]);
        to[2 * n] = re * c - im * s;
        to[2 * n + 1] = re * s + im * c;
    }
}

/* V of the strip's values, ping by ping. */
void REAL_ISA_NAME(monostatic_vector)(const struct monostatic *m, int term, const void *held, void *turned)
{
    const size_t pings = (size_t)m->acquisition->pings * (size_t)m->acquisition->receivers;
    const real *v = (const real *)m->vectors + 2 * (size_t)term * pings;
    for (size_t n = 0; n < pings; n++) {
        const real *from = (const real *)held + 2 * n * MONOSTATIC_STRIP, re = v[2 * n], im = v[2 * n + 1];
        real *restrict to = (real *)turned + 2 * n * MONOSTATIC_STRIP;
#pragma omp simd
        for (int w = 0; w < MONOSTATIC_STRIP; w++) {
            to[2 * w] = re * from[2 * w] - im * from[2 * w + 1];
            to[2 * w + 1] = re * from[2 * w + 1] + im * from[2 * w];
        }
    }
}

/* sum += U times the strip's transforms, U by the ranges of its samples between those of the table: `weights` of four
   of them from `from` on, 0 at samples that lie between others. */
static void products_add(const struct monostatic *m, int term, int from, real weights[4][MONOSTATIC_STRIP],
                         const real *transforms, real *restrict sum)
{
    const size_t length = (size_t)m->wavenumbers;
    const real *u = (const real *)m->products + 2 * (size_t)(term * MONOSTATIC_RANGES + from) * length;
    for (size_t k = 0; k < length; k++) {
        const real *t = transforms + 2 * k * MONOSTATIC_STRIP;
        real *to = sum + 2 * k * MONOSTATIC_STRIP;
        real ur[4], ui[4];
        for (int i = 0; i < 4; i++) {
            ur[i] = u[2 * ((size_t)i * length + k)];
            ui[i] = u[2 * ((size_t)i * length + k) + 1];
        }
#pragma omp simd
        for (int w = 0; w < MONOSTATIC_STRIP; w++) {
            const real re =
                weights[0][w] * ur[0] + weights[1][w] * ur[1] + weights[2][w] * ur[2] + weights[3][w] * ur[3];
            const real im =
                weights[0][w] * ui[0] + weights[1][w] * ui[1] + weights[2][w] * ui[2] + weights[3][w] * ui[3];
            to[2 * w] += re * t[2 * w] - im * t[2 * w + 1];
            to[2 * w + 1] += re * t[2 * w + 1] + im * t[2 * w];
        }
    }
}

void REAL_ISA_NAME(monostatic_product)(const struct monostatic *m, int term, int first, const void *transforms,
                                       void *sum)
{
    const struct acquisition *a = m->acquisition;
    for (int w = 0; w < MONOSTATIC_STRIP;) {
        real weights[4][MONOSTATIC_STRIP] = {0};
        int between = -1;
        for (; w < MONOSTATIC_STRIP; w++) {
            double own[4];
            const double range = monostatic_range(m, m->squint, a->t0[0] + (first + w) / a->fs);
            const double place = range > 0 ? (1 / range - m->inverse_first) / m->inverse_step : INFINITY;
            const int from = cubic_weights(place, MONOSTATIC_RANGES, own);
            if (between >= 0 && from != between)
                break;
            between = from;
            for (int i = 0; i < 4; i++)
                weights[i][w] = (real)own[i];
        }
        products_add(m, term, between, weights, transforms, sum);
    }
}
