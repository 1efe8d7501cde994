/* Traces through polar images (trace.h): across lines of equal s first, at each place rho by the angle's taps, then
   along rho, where the range's taps become Farrow branches (backprojection/kernel.h). Places and fractions are double;
   all else is `real`. */
#include "backprojection/factorised/trace.h"

#include <math.h>
#include <string.h>

#include "backprojection/reading.h"
#include "common/lanes.h"

#define POLAR_TRACE REAL_ISA_NAME(polar_trace)
#define INLINE      static inline __attribute__((always_inline))

typedef int vector_int __attribute__((vector_size(LANES * sizeof(int)), aligned(sizeof(int)), may_alias));
#if REAL_DOUBLE
typedef long long vector_mask __attribute__((vector_size(VECTOR_BYTES)));
#else
typedef int vector_mask __attribute__((vector_size(VECTOR_BYTES)));
#endif

/* Where places of a run lie between an image's lines. */
struct crossings {
    _Alignas(64) int line[TRACE_PLACES];  /* the one below */
    _Alignas(64) real rest[TRACE_PLACES]; /* -1/2 to 1/2 from there to the next */
    int beside[TRACE_PLACES];             /* 1: beyond the image's lines, not to be read */
};

INLINE vector_real load(const real *values)
{
    return *(const vector_real *)values;
}

/* `yes` where the mask's bits are set, else `no`. */
INLINE vector_real select_from(vector_mask mask, vector_real yes, vector_real no)
{
    return (vector_real)(((vector_mask)yes & mask) | ((vector_mask)no & ~mask));
}

/* Lines and fractions at places [place, place + count), and the last ones again up to a whole vector. Returns how many
   lie beside the lines. */
static int cross(const struct polar_image *image, const struct polar_crossing *line, int place, int count,
                 struct crossings *at)
{
    const double square = line->offset * line->offset, across = line->offset * line->cosine, one = 1 / image->sine;
    const double least = image->angle->taps / 2 - 1, most = image->lines - 1 - image->angle->taps / 2;
    const double step = image->rho, sine = line->sine, first = image->line_first;
    int outside = 0;
#pragma omp simd reduction(+ : outside)
    for (int i = 0; i < count; i++) {
        const double rho = (place + i) * step, left = rho * rho - square;
        double n = (sqrt(left > 0 ? left : 0) * sine + across) / rho * one - first;
        at->beside[i] = !(n >= least && n <= most);
        outside += at->beside[i];
        n = n > least ? n : least; /* nor does NaN become a line */
        n = n < most ? n : most;
        const double whole = floor(n);
        at->line[i] = (int)whole;
        at->rest[i] = (real)(n - whole - 0.5);
    }
    for (int i = count; i % LANES != 0; i++) {
        at->line[i] = at->line[count - 1];
        at->rest[i] = at->rest[count - 1];
    }
    return outside;
}

/* The coefficients of some taps in the file's precision. */
struct coefficients {
    int branches;
    real values[KERNEL_BRANCHES_MOST * FITTED_TAPS_MOST]; /* [branches][taps] */
};

INLINE void convert(const struct polar_taps *from, struct coefficients *to)
{
    to->branches = from->branches;
    for (int k = 0; k < from->branches * from->taps; k++)
        to->values[k] = (real)from->coefficients[k];
}

/* The weights of `taps` taps, a constant where this is inlined. */
INLINE void weigh(int taps, const struct coefficients *from, vector_real rest, vector_real *w)
{
    for (int t = 0; t < taps; t++)
        w[t] = rest * 0;
    for (int m = from->branches - 1; m >= 0; m--)
        for (int t = 0; t < taps; t++)
            w[t] = w[t] * rest + from->values[m * taps + t];
}

/* One vector of places; lane i lies behind line[i]. */
INLINE void interpolate(int taps, const struct polar_image *image, const struct coefficients *weights,
                        const struct crossings *at, int i, size_t place, vector_real *re, vector_real *im)
{
    vector_real w[FITTED_TAPS_MOST];
    int low = at->line[i], high = low;
    for (int k = 1; k < LANES; k++) {
        low = at->line[i + k] < low ? at->line[i + k] : low;
        high = at->line[i + k] > high ? at->line[i + k] : high;
    }
    weigh(taps, weights, load(at->rest + i), w);
    *re = *im = w[0] * 0;
    for (int n = low; n <= high; n++) {
        const real *values = (const real *)image->values + (size_t)(n + 1 - taps / 2) * 2 * image->pitch + place;
        vector_real x = w[0] * load(values), y = w[0] * load(values + image->pitch);
        for (int t = 1; t < taps; t++) {
            values += 2 * image->pitch;
            x += w[t] * load(values);
            y += w[t] * load(values + image->pitch);
        }
        if (low == high) {
            *re = x;
            *im = y;
        } else {
            const vector_mask here =
                __builtin_convertvector(*(const vector_int *)(at->line + i), vector_mask) == (vector_mask){0} + n;
            *re = select_from(here, x, *re);
            *im = select_from(here, y, *im);
        }
    }
}

/* Values along the line at places [first, first + count), with whole vectors behind them. Returns how many are
   read as zero. */
INLINE int follow(int taps, const struct polar_image *image, const struct polar_crossing *line, int first, int count,
                  real *re, real *im)
{
    struct crossings at;
    struct coefficients weights;
    int outside = 0;
    convert(image->angle, &weights);
    for (int begin = 0; begin < count; begin += TRACE_PLACES) {
        const int run = count - begin < TRACE_PLACES ? count - begin : TRACE_PLACES;
        const int beside = cross(image, line, first + begin, run, &at);
        for (int i = 0; i < run; i += LANES)
            interpolate(taps, image, &weights, &at, i, (size_t)(first + begin + i - image->place_first),
                        (vector_real *)(re + begin + i), (vector_real *)(im + begin + i));
        for (int i = 0; beside > 0 && i < run; i++)
            if (at.beside[i])
                re[begin + i] = im[begin + i] = 0;
        outside += beside;
    }
    return outside;
}

/* LANES samples of a part of a branch. Where the row is cut into blocks, which begin half a vector apart, they are one
   block and halves of both its neighbours; `step`: values from block to block. */
INLINE void put(vector_real values, bool blocks, size_t step, real *to)
{
    const size_t half = sizeof values / 2;
    *(vector_real *)to = values;
    if (blocks) {
        memcpy(to - step + LANES / 2, &values, half);
        memcpy(to + step, (const char *)&values + half, half);
    }
}

/* Branches of `count` samples, whose first tap is value 0 of the trace. */
INLINE void filter(int taps, const struct polar_taps *range, const real *re, const real *im, int count,
                   const struct bp_layout *layout, real *row)
{
    const size_t branches = (size_t)range->branches, apart = layout->apart;
    struct coefficients weights;
    convert(range, &weights);
    const bool blocks = layout->blocks > 1;
    const size_t step = 2 * branches * apart;
    for (int i = 0; i < count; i += LANES) {
        const size_t at = BP_BRANCHES_GUARD + (size_t)i;
        real *to = row + (blocks ? at / (apart / 2) * step : at);
        for (size_t m = 0; m < branches; m++, to += 2 * apart) {
            const real *c = weights.values + m * (size_t)taps;
            vector_real x = c[0] * load(re + i), y = c[0] * load(im + i);
            for (int t = 1; t < taps; t++) {
                x += c[t] * load(re + i + t);
                y += c[t] * load(im + i + t);
            }
            put(x, blocks, step, to);
            put(y, blocks, step, to + apart);
        }
    }
}

int POLAR_TRACE(const struct polar_image *image, const struct polar_crossing *line, int first, int count, void *trace,
                size_t trace_pitch, const struct bp_layout *layout, void *row)
{
    const int before = image->range->taps / 2 - 1, all = count + image->range->taps - 1;
    real *re = trace, *im = re + trace_pitch;
    int outside;
    switch (image->angle->taps) { /* constants, so that weights stay in registers */
    case 2: outside = follow(2, image, line, first - before, all, re, im); break;
    case 4: outside = follow(4, image, line, first - before, all, re, im); break;
    case 6: outside = follow(6, image, line, first - before, all, re, im); break;
    case 8: outside = follow(8, image, line, first - before, all, re, im); break;
    case 10: outside = follow(10, image, line, first - before, all, re, im); break;
    default: outside = follow(12, image, line, first - before, all, re, im); break;
    }
    switch (image->range->taps) {
    case 2: filter(2, image->range, re, im, count, layout, row); break;
    case 4: filter(4, image->range, re, im, count, layout, row); break;
    case 6: filter(6, image->range, re, im, count, layout, row); break;
    case 8: filter(8, image->range, re, im, count, layout, row); break;
    case 10: filter(10, image->range, re, im, count, layout, row); break;
    default: filter(12, image->range, re, im, count, layout, row); break;
    }
    return outside;
}
