/* Range migration's conversion at one azimuth wavenumber: receivers' spectra in, monostatic ones of each block out
   (bulk and differential of rma.h). Compiled once for each precision and instruction set (BP_ISA names it).

   The corrections of a group of receivers are quadratic in the receiver's number, so that a cell costs two complex
   products a receiver and three sines and cosines a group; frequencies lie side by side in vectors. */
#include <string.h>

#include "range_migration/column.h"

enum { PAIR = 2, SPAN = RMA_SPAN };

/* exp(j 2 pi poly(y)) of n bins, |y| <= 1. Polynomials below an eighth of a turn need neither double nor the removal of
   whole turns. */
static void rotors(const double *poly, const double *restrict y, int n, real *restrict re, real *restrict im)
{
    const double p0 = poly[0], p1 = poly[1], p2 = poly[2], p3 = poly[3], p4 = poly[4], p5 = poly[5];
    if (fabs(p0) + fabs(p1) + fabs(p2) + fabs(p3) + fabs(p4) + fabs(p5) <= 0.125) {
        const real a = (real)(2 * M_PI), q0 = a * (real)p0, q1 = a * (real)p1, q2 = a * (real)p2, q3 = a * (real)p3,
                   q4 = a * (real)p4, q5 = a * (real)p5;
#pragma omp simd
        for (int k = 0; k < n; k++) {
            real u = (real)y[k];
            phasor_eighth(q0 + u * (q1 + u * (q2 + u * (q3 + u * (q4 + u * q5)))), &re[k], &im[k]);
        }
        return;
    }
#pragma omp simd
    for (int k = 0; k < n; k++) {
        double f = p0 + y[k] * (p1 + y[k] * (p2 + y[k] * (p3 + y[k] * (p4 + y[k] * p5))));
        phasor(f - floor(f + 0.5), &re[k], &im[k]);
    }
}

/* Rows of vectors, `row` reals from one receiver's to the next. */
struct rows {
    real *values;
    size_t row;
};

/* The group's receivers times their corrections at bins [b, b + pair VECTOR): stored row by row, or added up into one
   row, or both (NULL: left out). `pair` is a constant where this is inlined: recurrences side by side hide each other's
   latency. */
static inline __attribute__((always_inline)) void vectors_apply(struct rows in, int count, int b, int pair,
                                                                real rotor[restrict 6][SPAN], struct rows stored,
                                                                real *sum)
{
    vec wr[PAIR], wi[PAIR], sr[PAIR], si[PAIR], sum_r[PAIR], sum_i[PAIR];
    size_t at[PAIR];
    for (int v = 0; v < pair; v++) {
        const int bin = b + v * VECTOR;
        at[v] = 2 * (size_t)(bin / LANES * LANES) + (size_t)(bin % LANES);
        wr[v] = *(vec *)&rotor[0][bin];
        wi[v] = *(vec *)&rotor[1][bin];
        sr[v] = *(vec *)&rotor[2][bin];
        si[v] = *(vec *)&rotor[3][bin];
        sum_r[v] = sum ? *(vec *)(sum + at[v]) : (vec){0};
        sum_i[v] = sum ? *(vec *)(sum + at[v] + LANES) : (vec){0};
    }
    const real *x = in.values;
    for (int i = 0; i < count; i++, x += in.row)
        for (int v = 0; v < pair; v++) {
            const vec kr = *(vec *)&rotor[4][b + v * VECTOR], ki = *(vec *)&rotor[5][b + v * VECTOR];
            const vec xr = *(const vec *)(x + at[v]), xi = *(const vec *)(x + at[v] + LANES);
            if (stored.values) {
                const vec pr = xr * wr[v] - xi * wi[v], pi = xr * wi[v] + xi * wr[v];
                real *z = stored.values + (size_t)i * stored.row + at[v];
                *(vec *)z = pr;
                *(vec *)(z + LANES) = pi;
                if (sum) {
                    sum_r[v] += pr;
                    sum_i[v] += pi;
                }
            } else { /* four multiply-adds, where the product by itself takes six operations */
                sum_r[v] = sum_r[v] + xr * wr[v];
                sum_i[v] = sum_i[v] + xr * wi[v];
                sum_r[v] = sum_r[v] - xi * wi[v];
                sum_i[v] = sum_i[v] + xi * wr[v];
            }
            vec t = wr[v] * sr[v] - wi[v] * si[v];
            wi[v] = wr[v] * si[v] + wi[v] * sr[v];
            wr[v] = t;
            t = sr[v] * kr - si[v] * ki;
            si[v] = sr[v] * ki + si[v] * kr;
            sr[v] = t;
        }
    for (int v = 0; sum && v < pair; v++) {
        *(vec *)(sum + at[v]) = sum_r[v];
        *(vec *)(sum + at[v] + LANES) = sum_i[v];
    }
}

static inline __attribute__((always_inline)) void group_apply(struct rows in, int count, int n,
                                                              real rotor[restrict 6][SPAN], struct rows stored,
                                                              real *sum)
{
    int b = 0;
    for (; b + PAIR * VECTOR <= n; b += PAIR * VECTOR)
        vectors_apply(in, count, b, PAIR, rotor, stored, sum);
    for (; b < n; b += VECTOR)
        vectors_apply(in, count, b, 1, rotor, stored, sum);
}

/* All receivers at bins [k, k + n) by recurrence. */
static void apply_recurrence(const struct workspace *w, const struct rma_ramp *ramps, int k, int n, struct rows in,
                             struct rows stored, real *sum)
{
    const double *y = (const double *)buffer(w, RMA_ABSCISSAS) + k;
    const struct rows none = {NULL, 0};
    real rotor[6][SPAN] __attribute__((aligned(RMA_ALIGNMENT)));
    for (const struct rma_ramp *g = ramps; g < ramps + w->rma->groups; g++) {
        rotors(g->first, y, n, rotor[0], rotor[1]);
        rotors(g->step, y, n, rotor[2], rotor[3]);
        if (g == ramps || memcmp(g->curve, g[-1].curve, sizeof g->curve) != 0)
            rotors(g->curve, y, n, rotor[4], rotor[5]);
        struct rows from = {in.values + (size_t)g->begin * in.row, in.row}, to = stored;
        if (!stored.values) {
            group_apply(from, g->count, n, rotor, none, sum);
            continue;
        }
        to.values += (size_t)g->begin * stored.row;
        if (sum)
            group_apply(from, g->count, n, rotor, to, sum);
        else
            group_apply(from, g->count, n, rotor, to, NULL);
    }
}

/* The same by the formula and libm for each cell: for uneven arrays, and to check the recurrence. */
static void apply_libm(const struct workspace *w, double r, double less, int k, int n, struct rows in,
                       struct rows stored, real *sum)
{
    const struct rma *rma = w->rma;
    for (int m = 0; m < rma->receivers; m++)
        for (int i = 0; i < n; i++) {
            double cycles = 0;
            if (k + i >= w->line.begin && k + i < w->swath->band) {
                double frequency = rma_frequency(rma, w->swath, k + i);
                cycles = rma_correction(rma, m, r, frequency, w->line.nu);
                cycles -= less > 0 ? rma_correction(rma, m, less, frequency, w->line.nu) : 0;
            }
            double angle = 2 * M_PI * (cycles - floor(cycles + 0.5));
            real wr = (real)cos(angle), wi = (real)sin(angle);
            size_t at = 2 * (size_t)(i / LANES * LANES) + (size_t)(i % LANES);
            const real *x = in.values + (size_t)m * in.row + at;
            real re = x[0] * wr - x[LANES] * wi, im = x[0] * wi + x[LANES] * wr;
            if (stored.values) {
                real *z = stored.values + (size_t)m * stored.row + at;
                z[0] = re;
                z[LANES] = im;
            }
            if (sum) {
                sum[at] += re;
                sum[at + LANES] += im;
            }
        }
}

/* Phasors of the receivers of a group: each times 1 + `step` is the next one, and 1 + `step` times 1 + `curve` the next
   1 + `step`. Without their 1 small steps keep their digits: with it float would lose 1e-6 over a group, for each
   block. */
enum { FIRST_RE, FIRST_IM, STEP_RE, STEP_IM, CURVE_RE, CURVE_IM, PHASORS };

/* exp(j 2 pi poly(y)) - 1, from half the angle. */
static void small_rotors(const double *poly, const double *restrict y, int n, real *restrict re, real *restrict im)
{
    double half[FIT_DEGREE + 1];
    for (int power = 0; power <= FIT_DEGREE; power++)
        half[power] = poly[power] / 2;
    rotors(half, y, n, re, im);
#pragma omp simd
    for (int k = 0; k < n; k++) {
        const real sine = 2 * im[k];
        im[k] = sine * re[k];
        re[k] = -sine * sine / 2;
    }
}

static void phasors_fill(const struct rma_ramp *ramp, bool same_curve, const double *y, int n,
                         real phasors[restrict PHASORS][SPAN])
{
    rotors(ramp->first, y, n, phasors[FIRST_RE], phasors[FIRST_IM]);
    small_rotors(ramp->step, y, n, phasors[STEP_RE], phasors[STEP_IM]);
    if (!same_curve)
        small_rotors(ramp->curve, y, n, phasors[CURVE_RE], phasors[CURVE_IM]);
}

/* A vector of complex numbers. */
struct vec_complex {
    vec re, im;
};

static inline __attribute__((always_inline)) struct vec_complex times(struct vec_complex a, struct vec_complex b)
{
    return (struct vec_complex){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

static inline __attribute__((always_inline)) struct vec_complex plus_times(struct vec_complex sum, struct vec_complex a,
                                                                           struct vec_complex b)
{
    return (struct vec_complex){sum.re + a.re * b.re - a.im * b.im, sum.im + a.re * b.im + a.im * b.re};
}

static inline __attribute__((always_inline)) void add_to(real *at, vec re, vec im)
{
    *(vec *)at += re;
    *(vec *)(at + LANES) += im;
}

/* The group's receivers at n bins, added to the sums of `blocks` neighbouring blocks, a constant where this is inlined:
   times their corrections amid the blocks, and from there by the angle `beyond` for each block, to both sides. Blocks
   on both sides share a receiver's products with the angle's cosine and sine, of twice, three times ... the angle by
   Chebyshev's recurrence. Of an even number of blocks `beyond` is half the angle. */
static inline __attribute__((always_inline)) void blocks_add(struct rows in, int count, int n, int blocks,
                                                             real amid[restrict PHASORS][SPAN],
                                                             real beyond[restrict PHASORS][SPAN], struct rows sums)
{
    const vec zero = {0};
    const int sides = blocks / 2;
    const bool odd = blocks % 2 != 0;
    for (int b = 0; b < n; b += VECTOR) {
        const size_t at = 2 * (size_t)(b / LANES * LANES) + (size_t)(b % LANES);
        struct vec_complex middle = {zero, zero}, by_cosine[RMA_BLOCKS / 2], by_sine[RMA_BLOCKS / 2], turn[2], step[2],
                           curve[2];
        for (int k = 0; k < 2; k++) {
            real(*from)[SPAN] = k ? beyond : amid;
            turn[k] = (struct vec_complex){*(vec *)&from[FIRST_RE][b], *(vec *)&from[FIRST_IM][b]};
            step[k] = (struct vec_complex){*(vec *)&from[STEP_RE][b], *(vec *)&from[STEP_IM][b]};
            curve[k] = (struct vec_complex){*(vec *)&from[CURVE_RE][b], *(vec *)&from[CURVE_IM][b]};
        }
        for (int k = 0; k < sides; k++)
            by_cosine[k] = by_sine[k] = middle;
        const real *x = in.values + at;
        for (int i = 0; i < count; i++, x += in.row) {
            const struct vec_complex value =
                times((struct vec_complex){*(const vec *)x, *(const vec *)(x + LANES)}, turn[0]);
            const vec twice = odd ? 2 * turn[1].re : 2 - 4 * turn[1].im * turn[1].im; /* the whole angle's cosine */
            vec cosine = turn[1].re, sine = turn[1].im;
            vec cosine_before = cosine, sine_before = -sine;
            if (odd) {
                middle = (struct vec_complex){middle.re + value.re, middle.im + value.im};
                cosine_before = zero + 1;
                sine_before = zero;
            }
            for (int k = 0; k < sides; k++) {
                by_cosine[k].re += value.re * cosine;
                by_cosine[k].im += value.im * cosine;
                by_sine[k].re += value.re * sine;
                by_sine[k].im += value.im * sine;
                const vec next[2] = {twice * cosine - cosine_before, twice * sine - sine_before};
                cosine_before = cosine;
                sine_before = sine;
                cosine = next[0];
                sine = next[1];
            }
            for (int k = 0; k < 2; k++) {
                turn[k] = plus_times(turn[k], turn[k], step[k]);
                step[k] = plus_times((struct vec_complex){step[k].re + curve[k].re, step[k].im + curve[k].im}, step[k],
                                     curve[k]);
            }
        }
        if (odd)
            add_to(sums.values + (size_t)sides * sums.row + at, middle.re, middle.im);
        for (int k = 0; k < sides; k++) {
            real *below = sums.values + (size_t)(sides - 1 - k) * sums.row + at,
                 *above = sums.values + (size_t)(sides + odd + k) * sums.row + at;
            add_to(below, by_cosine[k].re + by_sine[k].im, by_cosine[k].im - by_sine[k].re);
            add_to(above, by_cosine[k].re - by_sine[k].im, by_cosine[k].im + by_sine[k].re);
        }
    }
}

/* All receivers at bins [k, k + n), added up for each of some blocks: 3 to RMA_BLOCKS. */
static void add_blocks(const struct workspace *w, const struct rma_ramp *amid, const struct rma_ramp *beyond, int k,
                       int n, int blocks, struct rows in, struct rows sums)
{
    const double *y = (const double *)buffer(w, RMA_ABSCISSAS) + k;
    real phasors[2][PHASORS][SPAN] __attribute__((aligned(RMA_ALIGNMENT)));
    for (int b = 0; b < blocks; b++)
        memset(sums.values + (size_t)b * sums.row, 0, 2 * (size_t)n * sizeof *sums.values);
    for (int g = 0; g < w->rma->groups; g++) {
        for (int which = 0; which < 2; which++) {
            const struct rma_ramp *ramp = (which ? beyond : amid) + g;
            phasors_fill(ramp, g > 0 && memcmp(ramp->curve, ramp[-1].curve, sizeof ramp->curve) == 0, y, n,
                         phasors[which]);
        }
        const struct rows from = {in.values + (size_t)amid[g].begin * in.row, in.row};
        switch (blocks) {
        case 3: blocks_add(from, amid[g].count, n, 3, phasors[0], phasors[1], sums); break;
        case 4: blocks_add(from, amid[g].count, n, 4, phasors[0], phasors[1], sums); break;
        case 5: blocks_add(from, amid[g].count, n, 5, phasors[0], phasors[1], sums); break;
        case 6: blocks_add(from, amid[g].count, n, 6, phasors[0], phasors[1], sums); break;
        case 7: blocks_add(from, amid[g].count, n, 7, phasors[0], phasors[1], sums); break;
        default: blocks_add(from, amid[g].count, n, RMA_BLOCKS, phasors[0], phasors[1], sums); break;
        }
    }
}

/* A block's bins times exp(j 2 pi poly(y)). */
static void turn_block(const struct workspace *w, const double *poly, real *sums)
{
    const double *y = buffer(w, RMA_ABSCISSAS);
    real re[SPAN] __attribute__((aligned(RMA_ALIGNMENT))), im[SPAN] __attribute__((aligned(RMA_ALIGNMENT)));
    for (int k = w->line.begin / LANES * LANES, n; k < w->swath->row; k += n) {
        n = w->swath->row - k < SPAN ? w->swath->row - k : SPAN;
        rotors(poly, y + k, n, re, im);
        for (int b = 0; b < n; b += VECTOR) {
            real *at = sums + 2 * (size_t)((k + b) / LANES * LANES) + (size_t)((k + b) % LANES);
            const struct vec_complex turned = times((struct vec_complex){*(vec *)at, *(vec *)(at + LANES)},
                                                    (struct vec_complex){*(vec *)&re[b], *(vec *)&im[b]});
            *(vec *)at = turned.re;
            *(vec *)(at + LANES) = turned.im;
        }
    }
}

static void ramp_add(struct rma_ramp *to, const struct rma_ramp *ramp, double factor)
{
    for (int power = 0; power <= FIT_DEGREE; power++) {
        to->first[power] += factor * ramp->first[power];
        to->step[power] += factor * ramp->step[power];
        to->curve[power] += factor * ramp->curve[power];
    }
}

/* Blocks from `block` on, `count` of them, whose corrections differ by as much from each to the next, `beyond`, but for
   what all receivers share. */
static void convert_even(struct workspace *w, const real *data, int block, int count, real *sums)
{
    const struct rma *rma = w->rma;
    const struct rma_swath *swath = w->swath;
    const size_t row = 2 * (size_t)swath->row;
    struct rma_ramp *amid = buffer(w, RMA_RAMPS), *beyond = amid + rma->groups;
    double first[FIT_DEGREE + 1], each[FIT_DEGREE + 1], own[FIT_DEGREE + 1];
    rma_ramps(rma, &w->line, rma_block_range(rma, swath->blocks[block]), 0, amid);
    rma_ramps(rma, &w->line, rma_block_range(rma, swath->blocks[block + 1]), 0, beyond);
    memcpy(first, amid->first, sizeof first);
    for (int g = 0; g < rma->groups; g++) {
        ramp_add(&beyond[g], &amid[g], -1);
        ramp_add(&amid[g], &beyond[g], 0.5 * (count - 1));
    }
    memcpy(each, beyond->first, sizeof each);
    for (int g = 0; g < rma->groups && count % 2 == 0; g++)
        ramp_add(&beyond[g], &beyond[g], -0.5);
    for (int k = w->line.begin / LANES * LANES; k < swath->row; k += SPAN)
        add_blocks(w, amid, beyond, k, swath->row - k < SPAN ? swath->row - k : SPAN, count,
                   (struct rows){(real *)data + 2 * k, swath->apart}, (struct rows){sums + 2 * k, row});
    for (int n = 2; n < count; n++) {
        rma_polynomial(rma, &w->line, 0, rma_block_range(rma, swath->blocks[block + n]), own);
        for (int power = 0; power <= FIT_DEGREE; power++)
            own[power] -= first[power] + n * each[power];
        turn_block(w, own, sums + (size_t)n * row);
    }
}

/* Corrections at range r minus those at `less` (0: none is subtracted); `ramps` are their phases. */
struct correction {
    const struct rma_ramp *ramps;
    double r, less; /* m */
};

/* Receivers at bins [k, k + n) times exp(j 2 pi correction). */
static void apply(const struct workspace *w, const struct correction *correction, int k, int n, struct rows in,
                  struct rows stored, real *sum)
{
    if (sum)
        memset(sum, 0, 2 * (size_t)n * sizeof *sum);
    if (w->rma->recurs)
        apply_recurrence(w, correction->ramps, k, n, in, stored, sum);
    else
        apply_libm(w, correction->r, correction->less, k, n, in, stored, sum);
}

void REAL_ISA_NAME(rma_convert)(struct workspace *w, real *sums)
{
    const struct rma *rma = w->rma;
    const struct rma_swath *swath = w->swath;
    const size_t row = 2 * (size_t)swath->row;
    const int turns = w->q - swath->wavenumbers / 2, period = swath->period, reference = swath->reference;
    const int column = ((rma->spacing < 0 ? -turns : turns) % period + period) % period;
    const bool add = rma->options.sum == RMA_SUM_BEFORE;
    const size_t block = (add ? 1 : (size_t)rma->receivers) * row;
    real *data = (real *)swath->data + rma_row(swath, 0, column);
    if (!rma->converts) {
        memcpy(sums, data, row * sizeof *sums);
        return;
    }
    double *y = buffer(w, RMA_ABSCISSAS);
    const double y_first = (rma_frequency(rma, swath, 0) - w->line.middle) / w->line.half;
    const double y_step = rma->fs / swath->length / w->line.half;
    for (int k = 0; k < swath->row; k++) {
        double at = y_first + k * y_step;
        y[k] = at < -1 ? -1 : at > 1 ? 1 : at;
    }
    if (add && swath->even) {
        for (int b = 0, count; b < swath->needed; b += count) {
            count = rma_blocks_together(swath->needed - b);
            convert_even(w, data, b, count, sums + (size_t)b * row);
        }
        stage_end(w, RMA_DIFFERENTIAL);
        return;
    }
    const double centre = rma_block_range(rma, swath->blocks[reference]);
    struct rma_ramp *bulk = buffer(w, RMA_RAMPS), *ramps = bulk + rma->groups;
    if (rma->recurs)
        rma_ramps(rma, &w->line, centre, 0, bulk);
    stage_end(w, RMA_BULK);
    for (int b = 0; rma->recurs && b < swath->needed; b++)
        if (b != reference)
            rma_ramps(rma, &w->line, rma_block_range(rma, swath->blocks[b]), centre, ramps + b * rma->groups);
    stage_end(w, RMA_DIFFERENTIAL);
    for (int k = w->line.begin / LANES * LANES; k < swath->row; k += SPAN) {
        const int n = swath->row - k < SPAN ? swath->row - k : SPAN;
        const struct rows in = {data + 2 * k, swath->apart}, none = {NULL, 0};
        real *out = sums + 2 * k, *own = out + (size_t)reference * block;
        /* The reference block has no differential: its sum, or its rows, come with the bulk. */
        struct rows converted = {buffer(w, RMA_CONVERTED), 2 * SPAN};
        if (!add)
            converted = (struct rows){own, row};
        const struct correction whole = {bulk, centre, 0};
        apply(w, &whole, k, n, in, add && swath->needed == 1 ? none : converted, add ? own : NULL);
        stage_end(w, RMA_BULK);
        for (int b = 0; b < swath->needed; b++, out += block) {
            const struct correction rest = {ramps + b * rma->groups, rma_block_range(rma, swath->blocks[b]), centre};
            if (b != reference)
                apply(w, &rest, k, n, converted, add ? none : (struct rows){out, row}, add ? out : NULL);
        }
        stage_end(w, RMA_DIFFERENTIAL);
    }
}
