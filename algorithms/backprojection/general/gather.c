/* Runs of pixels read records (nearest sample, linear, polynomials of Farrow branches, or a kernel of many taps) and
   add the values times phase factors to the sums. Copies of samples are the limit: those of neighbouring pixels are
   loaded together where they lie near each other. This file is compiled once for each precision and instruction set
   (BP_ISA names it). */
#include "backprojection/general/run.h"
#include "common/phasor.h"

/* Each one instruction. PICK: each four floats of a vector permuted by the low two bits of an index. REPEAT: four
   floats from memory as each four of a vector. SECONDS: the second of each four. QUADS: fours side by side. */
#if WINDOWS
#include <immintrin.h>
#if VECTOR_BYTES == 64
#define PICK(values, index) (vector_real) _mm512_permutevar_ps((__m512)(values), (__m512i)(index))
#define REPEAT(from)        (vector_real) _mm512_broadcast_f32x4(_mm_loadu_ps(from))
#define SECONDS             1, 1, 1, 1, 5, 5, 5, 5, 9, 9, 9, 9, 13, 13, 13, 13
#define JOIN(a, b)          __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7)
#define QUADS(v)                                                                                                       \
    __builtin_shufflevector(JOIN(v(0), v(1)), JOIN(v(2), v(3)), 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)
#else
#define PICK(values, index) (vector_real) _mm256_permutevar_ps((__m256)(values), (__m256i)(index))
#define REPEAT(from)        (vector_real) _mm256_broadcast_ps((const __m128 *)(from))
#define SECONDS             1, 1, 1, 1, 5, 5, 5, 5
#define QUADS(v)            __builtin_shufflevector(v(0), v(1), 0, 1, 2, 3, 4, 5, 6, 7)
#endif
#endif

#if PERMUTES
#include <immintrin.h>
/* Values of a window by an index of each pixel's, of which the lowest bits count; PERMUTE_TWO: of a window of two
   vectors, `next` behind `values`. */
#if BLOCKS && REAL_DOUBLE
typedef long long vector_index __attribute__((vector_size(VECTOR_BYTES)));
#define PERMUTE(values, index) (vector_real) _mm512_permutexvar_pd((__m512i)(index), (__m512d)(values))
#define PERMUTE_TWO(values, next, index)                                                                               \
    (vector_real) _mm512_permutex2var_pd((__m512d)(values), (__m512i)(index), (__m512d)(next))
#elif BLOCKS
typedef vector_int vector_index;
#define PERMUTE(values, index) (vector_real) _mm512_permutexvar_ps((__m512i)(index), (__m512)(values))
#define PERMUTE_TWO(values, next, index)                                                                               \
    (vector_real) _mm512_permutex2var_ps((__m512)(values), (__m512i)(index), (__m512)(next))
#elif REAL_DOUBLE
typedef long long vector_index __attribute__((vector_size(VECTOR_BYTES))); /* AVX2 permutes floats alone, by halves */
#define PERMUTE(values, index)                                                                                         \
    (vector_real) _mm256_permutevar8x32_ps((__m256)(values), (__m256i)(2 * (index) + (2 * (index) + 1) * (1LL << 32)))
#else
typedef vector_int vector_index;
#define PERMUTE(values, index) (vector_real) _mm256_permutevar8x32_ps((__m256)(values), (__m256i)(index))
#endif
#if !BLOCKS
#define PERMUTE_TWO(values, next, index) ((void)(next), PERMUTE(values, index)) /* not used */
#endif
#endif

typedef double two_floats __attribute__((may_alias, aligned(sizeof(real)))); /* moved at once */
typedef float bits __attribute__((may_alias));
typedef float quad __attribute__((vector_size(16), aligned(sizeof(float)), may_alias));

PHASOR(phasor_full, vector_real, PHASOR_SINE, PHASOR_COSINE)
PHASOR(phasor_short, vector_real, PHASOR_SHORT_SINE, PHASOR_SHORT_COSINE)

/* LANES values: copies, which are faster than gather instructions. */
INLINE vector_real gather_one(const real *from, const int *index)
{
#define FROM(n) from[index[n]]
    return (vector_real)ALL(FROM);
}

/* Values and those behind them. */
INLINE void gather_two(const real *from, const int *index, vector_real *value, vector_real *next)
{
#if REAL_DOUBLE
    *value = gather_one(from, index);
    *next = gather_one(from + 1, index);
#else
#define BOTH(n) *(const two_floats *)(from + index[n])
    vector_real low = (vector_real)(vector_double)PART(BOTH, 0), high = (vector_real)(vector_double)PART(BOTH, 2);
    *value = __builtin_shufflevector(low, high, EVEN);
    *next = __builtin_shufflevector(low, high, ODD);
#endif
}

#if WINDOWS
/* Pixels' values by their places in windows of four; on a line, between two. */
INLINE vector_real pick(bool line, vector_real windows, vector_int place, const real *rest)
{
    vector_real value = PICK(windows, place);
    if (line)
        value += *at(rest) * (PICK(windows, place + 1) - value);
    return value;
}

/* The same out of windows that are loaded whole: from the predecessor of a middle pixel's sample on, where the others
   read that sample or a neighbour of it. The last value is used only with linear interpolation; otherwise it may lie
   one past the row's end. */
INLINE void take_windows(bool line, enum loading loading, const real *row, size_t row_length, const struct run *run,
                         int i, vector_real *x, vector_real *y)
{
    const int *index = run->sample + i;
    vector_int place = *(const vector_int *)index;
    vector_real re, im;
    if (loading == TOGETHER) {
        const int *middle = index + LANES / 2 - 1;
        const real *from = row + *middle - 1;
#define MIDDLE(n) (*(const bits *)middle) /* an int would come from its register, by two instructions for one */
        place = place + 1 - (vector_int)(vector_bits)ALL(MIDDLE);
        re = REPEAT(from);
        im = REPEAT(from + row_length);
    } else {
#define WINDOW(n) (*(const quad *)(row + index[4 * (n) + 1] - 1))
        place = place + 1 - __builtin_shufflevector(place, place, SECONDS);
        re = QUADS(WINDOW);
        row += row_length;
        im = QUADS(WINDOW);
    }
    *x = pick(line, re, place, run->rest + i);
    *y = pick(line, im, place, run->rest + i);
}
#endif

/* The same pixel by pixel. */
INLINE vector_real take_apart(bool line, const real *row, const struct run *run, int i)
{
    vector_real value, next;
    if (!line)
        return gather_one(row, run->sample + i);
    gather_two(row, run->sample + i, &value, &next);
    return value + *at(run->rest + i) * (next - value);
}

/* Where a record's branches are read: its first value, and the place there of the run's sample 0. */
struct record {
    const real *values;
    int place;
};

#if PERMUTES
/* Polynomials of a record's branches at the pixels' samples, by Horner's rule, out of windows that hold the samples
   of all (run.h, ITS GATHER). */
INLINE void take_branches_together(int branches, enum loading loading, struct record record, size_t apart,
                                   const struct run *run, int i, vector_real *re, vector_real *im)
{
    const bool two = BLOCKS && loading == FOURS;
    const int *index = run->sample + i;
    const int middle = index[MIDDLE_LANE] + record.place;
    const vector_real u = *at(run->rest + i);
    const int before = two ? LANES / 2 : LANES / 4; /* the window's least samples before the middle one */
    const int first = BLOCKS ? (middle - before) & -BLOCK_ADVANCE : middle - MIDDLE_LANE;
    const vector_index place =
        __builtin_convertvector(*(const vector_int *)index + (record.place - first), vector_index);
    const size_t part = BLOCKS ? LANES : apart, block = 2 * (size_t)branches * LANES;
    const real *from = record.values + (BLOCKS ? (size_t)first / BLOCK_ADVANCE * block : (size_t)first);
    const int next = LANES / BLOCK_ADVANCE;
#define PART_OF(n, k) *at(from + (n)*part + (size_t)(k)*block)
#define WINDOW_OF(n)  (two ? PERMUTE_TWO(PART_OF(n, 0), PART_OF(n, next), place) : PERMUTE(PART_OF(n, 0), place))
    vector_real x = WINDOW_OF(2 * (size_t)branches - 2), y = WINDOW_OF(2 * (size_t)branches - 1);
    for (int m = branches - 2; m >= 0; m--) {
        x = x * u + WINDOW_OF(2 * (size_t)m);
        y = y * u + WINDOW_OF(2 * (size_t)m + 1);
    }
    *re = x;
    *im = y;
}
#endif

/* The same pixel by pixel. */
INLINE void take_branches_apart(int branches, struct record record, size_t apart, const struct run *run, int i,
                                vector_real *re, vector_real *im)
{
    const vector_real u = *at(run->rest + i);
    const size_t part = BLOCKS ? LANES : apart;
    int index[LANES];
    vector_real x = {0}, y = {0};
    for (int k = 0; k < LANES; k++) {
        const int place = run->sample[i + k] + record.place;
        index[k] = BLOCKS ? place / BLOCK_ADVANCE * (2 * branches * LANES) + place % BLOCK_ADVANCE : place;
    }
    for (int m = branches - 1; m >= 0; m--) {
        x = x * u + gather_one(record.values + 2 * (size_t)m * part, index);
        y = y * u + gather_one(record.values + (2 * (size_t)m + 1) * part, index);
    }
    *re = x;
    *im = y;
}

/* How a value is read: nearest, linear, or from `branches` > 1. Constants where inlined. `edges`: the loading of
   vectors with pixels that are not a record's own, where slopes may be steeper. */
struct taking {
    bool line;
    int branches;
    enum loading loading, edges;
};

/* Add a record's values to LANES pixels from i on. */
INLINE void take(struct taking taking, struct record record, size_t apart, const struct run *run, int i,
                 vector_real *re, vector_real *im)
{
    const real *row = record.values;
    vector_real c, s, x, y;
    const bool each = taking.loading == APART || taking.loading == EXACT;
    if (taking.loading == EXACT || (each && !REAL_DOUBLE)) /* copies are what takes float's time there */
        phasor_full(*at(run->cycles + i), &c, &s);
    else
        phasor_short(*at(run->cycles + i), &c, &s);
#if PERMUTES
    if (taking.branches > 1 && !each)
        take_branches_together(taking.branches, taking.loading, record, apart, run, i, &x, &y);
    else
#endif
        if (taking.branches > 1)
        take_branches_apart(taking.branches, record, apart, run, i, &x, &y);
#if WINDOWS
    else if (!each)
        take_windows(taking.line, taking.loading, row, apart, run, i, &x, &y);
#endif
    else {
        x = take_apart(taking.line, row, run, i);
        y = take_apart(taking.line, row + apart, run, i);
    }
    *re = *re + x * c - y * s;
    *im = *im + x * s + y * c;
}

/* The pixels that record g of a group is added to, of a run's `count` from pixel `first` of the line on. */
INLINE struct pair_span own_pixels(const struct receiver_group *group, int g, int first, int count)
{
    if (!group->within)
        return (struct pair_span){0, count};
    const int begin = group->within[g].begin - first, end = group->within[g].end - first;
    return (struct pair_span){begin < 0 ? 0 : begin, end < count ? end : count};
}

/* One run of each of a group's records, by the places that they read. */
struct taken {
    struct run *runs;
    struct record from[GROUP_RECEIVERS];
    struct pair_span own[GROUP_RECEIVERS], common; /* pixels of each, and of all */
    int count;                                     /* pixels */
    real *re, *im;
};

typedef __typeof__((vector_real){0} < (vector_real){0}) vector_mask;

/* `added` where the mask is set. */
INLINE vector_real masked(vector_mask mask, vector_real added, vector_real other)
{
    return (vector_real)(((vector_mask)added & mask) | ((vector_mask)other & ~mask));
}

/* Add to LANES pixels from i on that are not pixels of all records, or fewer at the run's end; as a whole vector, so
   that a pixel's bits do not depend on where runs begin and end. */
INLINE void add_edge(struct taking taking, const struct receiver_group *group, const struct taken *taken, int i)
{
    const int rest = taken->count - i, left = rest < LANES ? rest : LANES;
    const vector_real lane = ALL(LANE);
    vector_real x = {0}, y = {0};
    if (left == LANES) {
        x = *at(taken->re + i);
        y = *at(taken->im + i);
    }
    for (int k = 0; left < LANES && k < left; k++) {
        x[k] = taken->re[i + k];
        y[k] = taken->im[i + k];
    }
    taking.loading = taking.edges;
    for (int g = 0; g < group->receivers; g++) {
        struct run *run = &taken->runs[g];
        const int begin = taken->own[g].begin - i, end = taken->own[g].end - i;
        vector_real re = x, im = y;
        if (begin >= left || end <= 0 || begin >= end)
            continue;
        for (int k = left; k < LANES; k++) { /* the last vector's other pixels read valid places */
            run->sample[i + k] = run->sample[i + left - 1];
            run->rest[i + k] = run->cycles[i + k] = 0;
        }
        take(taking, taken->from[g], group->layout.apart, run, i, &re, &im);
        const vector_mask mask = (lane >= (real)begin) & (lane < (real)end);
        x = masked(mask, re, x);
        y = masked(mask, im, y);
    }
    if (left == LANES) {
        *at(taken->re + i) = x;
        *at(taken->im + i) = y;
    }
    for (int k = 0; left < LANES && k < left; k++) {
        taken->re[i + k] = x[k];
        taken->im[i + k] = y[k];
    }
}

INLINE void add_taken(struct taking taking, const struct receiver_group *group, int first, int count, struct run *runs)
{
    struct taken taken = {runs, .common = {0, count}, .count = count, .re = group->re + first, .im = group->im + first};
    const int receivers = group->receivers;
    const size_t apart = group->layout.apart;
    for (int g = 0; g < receivers; g++) {
        const int place = group->table->origin + group->table->first + runs[g].base;
        const bool whole = taking.branches > 1;
        taken.from[g].values = group->row + (size_t)g * group->layout.record + (whole ? 0 : place);
        taken.from[g].place = whole ? place : 0;
        OPAQUE(taken.from[g].values);
        const struct pair_span own = taken.own[g] = own_pixels(group, g, first, count);
        taken.common.begin = own.begin > taken.common.begin ? own.begin : taken.common.begin;
        taken.common.end = own.end < taken.common.end ? own.end : taken.common.end;
    }
    const struct pair_span common = taken.common;
    real *const sum_re = taken.re, *const sum_im = taken.im;
    for (int i = 0; i < count; i += LANES) {
        for (; i >= common.begin && i + LANES <= common.end; i += LANES) {
            vector_real x = *at(sum_re + i), y = *at(sum_im + i);
            for (int g = 0; g < receivers; g++)
                take(taking, taken.from[g], apart, &runs[g], i, &x, &y);
            *at(sum_re + i) = x;
            *at(sum_im + i) = y;
        }
        if (i < count)
            add_edge(taking, group, &taken, i);
    }
}

/* Ways of taking as functions of their own: where several are inlined into one function, the compiler's choice of
   registers for each depends on the others. It leaves out those that no table names. */
typedef void adding(const struct receiver_group *group, int first, int count, struct run *runs);
#define ADDING(name, line, branches, loading, edges)                                                                   \
    static __attribute__((noinline)) void name(const struct receiver_group *group, int first, int count,               \
                                               struct run *runs)                                                       \
    {                                                                                                                  \
        add_taken((struct taking){line, branches, loading, edges}, group, first, count, runs);                         \
    }
#define WAYS(name, line, branches)                                                                                     \
    ADDING(name##_apart, line, branches, APART, APART)                                                                 \
    ADDING(name##_fours, line, branches, FOURS, FOURS)                                                                 \
    ADDING(name##_together, line, branches, TOGETHER, (branches) > 1 && !BLOCKS ? TOGETHER : FOURS)                    \
    ADDING(name##_exact, line, branches, EXACT, EXACT)
WAYS(nearest, false, 1)
WAYS(line, true, 1)
WAYS(three, false, 3)
WAYS(four, false, 4)
WAYS(five, false, 5)
WAYS(six, false, 6)
WAYS(any, false, group->table->branches)

/* By how samples are loaded (enum loading), of what loading_choose takes. */
typedef adding *const ways[4];
#define WAYS_OF(name, fours, together)                                                                                 \
    {                                                                                                                  \
        name##_apart, (fours) ? name##_fours : NULL, (together) ? name##_together : NULL,                              \
            REAL_DOUBLE ? name##_exact : name##_apart                                                                  \
    }
#define WAYS_OF_BRANCHES(name) WAYS_OF(name, BLOCKS, PERMUTES)
static const ways ways_nearest = WAYS_OF(nearest, WINDOWS, WINDOWS), ways_line = WAYS_OF(line, WINDOWS, WINDOWS);
/* The usual numbers of branches unroll, any other one works as well. */
enum { USUAL_LEAST = 3, USUAL_MOST = 6 };
static const ways ways_any = WAYS_OF_BRANCHES(any), ways_usual[] = {WAYS_OF_BRANCHES(three), WAYS_OF_BRANCHES(four),
                                                                    WAYS_OF_BRANCHES(five), WAYS_OF_BRANCHES(six)};

static adding *const *ways_choose(const struct bp_table *table)
{
    const int branches = table->branches;
    if (table->reading != BP_BRANCHES)
        return table->reading == BP_LINE ? ways_line : ways_nearest;
    return branches < USUAL_LEAST || branches > USUAL_MOST ? ways_any : ways_usual[branches - USUAL_LEAST];
}

/* Many weights, from a table of steps or from cubics in the fraction; the record's parts lie apart. `taps` is a
   constant where this is inlined, so that the loops over it unroll. */
INLINE void add_taps(const struct bp_table *table, int taps, const real *row_re, const real *row_im,
                     struct pair_span pixels, const struct run *run, real *re, real *im)
{
    const real *weights = table->weights;
    real wr[RUN_PIXELS], wi[RUN_PIXELS];
#pragma omp simd
    for (int i = pixels.begin; i < pixels.end; i++)
        phasor(run->cycles[i], &wr[i], &wi[i]);
    for (int i = pixels.begin; i < pixels.end; i++) {
        const real *x = row_re + run->sample[i], *y = row_im + run->sample[i];
        real vr = 0, vi = 0;
        if (table->steps > 0) {
            const real *w = weights + (size_t)run->step[i] * (size_t)taps;
#pragma omp simd reduction(+ : vr, vi)
            for (int k = 0; k < taps; k++) {
                vr += w[k] * x[k];
                vi += w[k] * y[k];
            }
        } else {
            const real *w = weights + 4 * (size_t)run->step[i] * (size_t)taps, u = run->rest[i];
#pragma omp simd reduction(+ : vr, vi)
            for (int k = 0; k < taps; k++) {
                real weight = w[k] + u * (w[taps + k] + u * (w[2 * taps + k] + u * w[3 * taps + k]));
                vr += weight * x[k];
                vi += weight * y[k];
            }
        }
        re[i] += vr * wr[i] - vi * wi[i];
        im[i] += vr * wi[i] + vi * wr[i];
    }
}

void BP_GATHER(const struct receiver_group *group, enum loading loading, int first, int count, struct run *runs)
{
    const struct bp_table *table = group->table;
    if (table->reading == BP_NEAREST || table->reading == BP_LINE || table->reading == BP_BRANCHES) {
        ways_choose(table)[loading](group, first, count, runs);
        return;
    }
    const size_t length = group->layout.apart;
    const real *row = group->row + table->origin + table->first;
    real *re = group->re + first, *im = group->im + first;
    for (int g = 0; g < group->receivers; g++, row += group->layout.record) {
        const real *from = row + runs[g].base;
        const struct pair_span own = own_pixels(group, g, first, count);
        switch (table->taps) { /* the shipped kernels unroll, any other length works as well */
        case 8: add_taps(table, 8, from, from + length, own, &runs[g], re, im); break;
        case 16: add_taps(table, 16, from, from + length, own, &runs[g], re, im); break;
        case 20: add_taps(table, 20, from, from + length, own, &runs[g], re, im); break;
        default: add_taps(table, table->taps, from, from + length, own, &runs[g], re, im); break;
        }
    }
}
