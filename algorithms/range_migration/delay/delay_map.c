/* The map of one record onto monostatic delays (delay_compensation.h). Compiled once for each precision and instruction
   set (BP_ISA names it). */
#include <limits.h>
#include <string.h>

#include "range_migration/column.h"

enum { VECTORS = 2 * RMA_RUN / VECTOR, TOGETHER = 2 /* vectors that share a tap's weights */ };

/* One run: taps at its middle, and their slope along it. `taps` is a constant where this is inlined. */
static inline __attribute__((always_inline)) void run_taps(int taps, const real *x, const real *weights,
                                                           const real *slopes, real *values)
{
    for (int v = 0; v < VECTORS; v += TOGETHER) {
        vec sum[TOGETHER] = {{0}}, slope[TOGETHER] = {{0}};
        for (int k = 0; k < taps; k++)
            for (int i = 0; i < TOGETHER; i++) {
                const vec s = *(const vec_unaligned *)(x + 2 * k + (v + i) * VECTOR);
                sum[i] += weights[k] * s;
                slope[i] += slopes[k] * s;
            }
        for (int i = 0; i < TOGETHER; i++) {
            real along[VECTOR];
            for (int l = 0; l < VECTOR; l++)
                along[l] = (real)(((v + i) * VECTOR + l) / 2) - (real)(RMA_RUN - 1) / 2;
            *(vec_unaligned *)(values + (v + i) * VECTOR) = sum[i] + *(const vec_unaligned *)along * slope[i];
        }
    }
}

void REAL_ISA_NAME(rma_map)(const struct rma *rma, const struct rma_swath *swath, int receiver, const void *padded,
                            void *row)
{
    const struct rma_map *map = &swath->map;
    const size_t taps = (size_t)rma->delay->taps.taps, from = (size_t)receiver * (size_t)map->runs;
    const real *weights = (const real *)map->weights + from * taps, *slopes = (const real *)map->slopes + from * taps;
    const real *phases = (const real *)map->phases + from * 2 * RMA_RUN;
    real *out = row;
    for (int b = 0; b < map->runs;
         b++, weights += taps, slopes += taps, phases += 2 * RMA_RUN, out += 2 * (size_t)RMA_RUN) {
        const int first = map->first[from + (size_t)b];
        if (first == INT_MIN) {
            memset(out, 0, 2 * RMA_RUN * sizeof *out);
            continue;
        }
        const real *x = (const real *)padded + 2 * (size_t)first;
        real values[2 * RMA_RUN];
        switch (taps) {
        case 8: run_taps(8, x, weights, slopes, values); break;
        case 12: run_taps(12, x, weights, slopes, values); break;
        case 16: run_taps(16, x, weights, slopes, values); break;
        default: run_taps((int)taps, x, weights, slopes, values); break;
        }
#pragma omp simd
        for (int n = 0; n < RMA_RUN; n++) {
            out[2 * n] = values[2 * n] * phases[2 * n] - values[2 * n + 1] * phases[2 * n + 1];
            out[2 * n + 1] = values[2 * n] * phases[2 * n + 1] + values[2 * n + 1] * phases[2 * n];
        }
    }
}
