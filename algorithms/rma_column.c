/* Range migration at one azimuth wavenumber: receivers' spectra in, focused rows out (rma.h: bulk to focus).
   Compiled once for each precision and instruction set (BP_ISA names it).

   The corrections of a group of receivers are quadratic in the receiver's number, so that a cell costs two complex
   products a receiver and three sines and cosines a group; frequencies lie side by side in vectors. */
#include <string.h>

#include "rma_engine.h"
#include "turn.h"

#if defined __AVX512F__
enum { VECTOR_BYTES = 64 };
#elif defined __AVX__
enum { VECTOR_BYTES = 32 };
#else
enum { VECTOR_BYTES = 16 };         /* wider ones would live in memory */
#endif
typedef real vec __attribute__((vector_size(VECTOR_BYTES), may_alias));
enum { LANES = RMA_ALIGNMENT / sizeof(real), VECTOR = VECTOR_BYTES / sizeof(real), PAIR = LANES > VECTOR ? 2 : 1,
       SPAN = RMA_SPAN,
       RUN = 64 };                  /* samples that a block takes or leaves together: places rise or fall along them */

/* What one thread works on. */
struct work_place {
    const struct rma *rma;
    char *scratch;
    double *seconds, mark;
    struct rma_line line;
    int q;
};

static void *buffer(const struct work_place *w, enum rma_buffer which)
{
    return w->scratch + w->rma->scratch_at[which];
}

static void stage_end(struct work_place *w, enum rma_stage stage)
{
    double now = seconds_now();
    w->seconds[stage] += now - w->mark;
    w->mark = now;
}

/* exp(j 2 pi poly(y)) of n bins, |y| <= 1. Polynomials below an eighth of a turn need neither double nor whole turns
   taken off. */
static void rotors(const double *poly, const double *restrict y, int n, real *restrict re, real *restrict im)
{
    const double p0 = poly[0], p1 = poly[1], p2 = poly[2], p3 = poly[3], p4 = poly[4], p5 = poly[5];
    if (fabs(p0) + fabs(p1) + fabs(p2) + fabs(p3) + fabs(p4) + fabs(p5) <= 0.125) {
        const real a = (real)(2 * M_PI), q0 = a * (real)p0, q1 = a * (real)p1, q2 = a * (real)p2, q3 = a * (real)p3,
                   q4 = a * (real)p4, q5 = a * (real)p5;
#pragma omp simd
        for (int k = 0; k < n; k++) {
            real u = (real)y[k];
            turn_eighth(q0 + u * (q1 + u * (q2 + u * (q3 + u * (q4 + u * q5)))), &re[k], &im[k]);
        }
        return;
    }
#pragma omp simd
    for (int k = 0; k < n; k++) {
        double f = p0 + y[k] * (p1 + y[k] * (p2 + y[k] * (p3 + y[k] * (p4 + y[k] * p5))));
        turn(f - floor(f + 0.5), &re[k], &im[k]);
    }
}

/* Rows of vectors, `row` reals from one receiver's to the next. */
struct rows {
    real *values;
    size_t row;
};

/* The group's receivers times their corrections at n bins: added up into one row, or stored row by row. */
static inline __attribute__((always_inline)) void group_apply(struct rows in, int count, int n,
    real rotor[restrict 6][SPAN], bool add, struct rows out)
{
    for (int b = 0; b < n; b += PAIR * VECTOR) {
        const int at = 2 * (b / LANES * LANES) + b % LANES;
        const real *x = in.values + at;
        real *z = out.values + at;
        vec wr[PAIR], wi[PAIR], sr[PAIR], si[PAIR], sum_r[PAIR], sum_i[PAIR];
        for (int v = 0; v < PAIR; v++) {
            wr[v] = *(vec *)&rotor[0][b + v * VECTOR];
            wi[v] = *(vec *)&rotor[1][b + v * VECTOR];
            sr[v] = *(vec *)&rotor[2][b + v * VECTOR];
            si[v] = *(vec *)&rotor[3][b + v * VECTOR];
            sum_r[v] = *(vec *)(z + v * VECTOR);
            sum_i[v] = *(vec *)(z + LANES + v * VECTOR);
        }
        for (int i = 0; i < count; i++, x += in.row)
            for (int v = 0; v < PAIR; v++) {
                const vec kr = *(vec *)&rotor[4][b + v * VECTOR], ki = *(vec *)&rotor[5][b + v * VECTOR];
                vec xr = *(const vec *)(x + v * VECTOR), xi = *(const vec *)(x + LANES + v * VECTOR), t;
                vec pr = xr * wr[v] - xi * wi[v], pi = xr * wi[v] + xi * wr[v];
                if (add) {
                    sum_r[v] += pr;
                    sum_i[v] += pi;
                } else {
                    *(vec *)(z + (size_t)i * out.row + v * VECTOR) = pr;
                    *(vec *)(z + (size_t)i * out.row + LANES + v * VECTOR) = pi;
                }
                t = wr[v] * sr[v] - wi[v] * si[v];
                wi[v] = wr[v] * si[v] + wi[v] * sr[v];
                wr[v] = t;
                t = sr[v] * kr - si[v] * ki;
                si[v] = sr[v] * ki + si[v] * kr;
                sr[v] = t;
            }
        for (int v = 0; add && v < PAIR; v++) {
            *(vec *)(z + v * VECTOR) = sum_r[v];
            *(vec *)(z + LANES + v * VECTOR) = sum_i[v];
        }
    }
}

/* All receivers at bins [k, k + n) by recurrence. */
static void apply_recurrence(const struct work_place *w, const struct rma_ramp *ramps, int k, int n, struct rows in,
                             bool add, struct rows out)
{
    const double *y = (const double *)buffer(w, RMA_ABSCISSAS) + k;
    real rotor[6][SPAN] __attribute__((aligned(RMA_ALIGNMENT)));
    for (const struct rma_ramp *g = ramps; g < ramps + w->rma->groups; g++) {
        rotors(g->first, y, n, rotor[0], rotor[1]);
        rotors(g->step, y, n, rotor[2], rotor[3]);
        if (g == ramps || memcmp(g->curve, g[-1].curve, sizeof g->curve) != 0)
            rotors(g->curve, y, n, rotor[4], rotor[5]);
        struct rows from = {in.values + (size_t)g->begin * in.row, in.row};
        struct rows to = {out.values + (size_t)g->begin * out.row, out.row};
        if (add && g->count == RMA_GROUP)
            group_apply(from, RMA_GROUP, n, rotor, true, out);
        else if (add)
            group_apply(from, g->count, n, rotor, true, out);
        else
            group_apply(from, g->count, n, rotor, false, to);
    }
}

/* The same by the formula and libm for each cell: for uneven arrays, and to check the recurrence. */
static void apply_libm(const struct work_place *w, double r, double less, int k, int n, struct rows in, bool add,
                       struct rows out)
{
    const struct rma *rma = w->rma;
    for (int m = 0; m < rma->receivers; m++)
        for (int i = 0; i < n; i++) {
            if (k + i < w->line.begin || k + i >= rma->band)
                continue;
            double frequency = rma_frequency(rma, k + i), cycles = rma_correction(rma, m, r, frequency, w->line.nu);
            if (less > 0)
                cycles -= rma_correction(rma, m, less, frequency, w->line.nu);
            double angle = 2 * M_PI * (cycles - floor(cycles + 0.5));
            real wr = (real)cos(angle), wi = (real)sin(angle);
            size_t at = 2 * (size_t)(i / LANES * LANES) + (size_t)(i % LANES);
            const real *x = in.values + (size_t)m * in.row + at;
            real *z = out.values + (add ? 0 : (size_t)m * out.row) + at;
            z[0] = (add ? z[0] : 0) + x[0] * wr - x[LANES] * wi;
            z[LANES] = (add ? z[LANES] : 0) + x[0] * wi + x[LANES] * wr;
        }
}

/* Receivers at bins [k, k + n) times exp(j 2 pi (correction at r less the one at `less`)); `ramps` are those
   phases. */
static void apply(const struct work_place *w, const struct rma_ramp *ramps, double r, double less, int k, int n,
                  struct rows in, bool add, struct rows out)
{
    for (int m = 0; m < (add ? 1 : w->rma->receivers); m++)
        memset(out.values + (size_t)m * out.row, 0, 2 * (size_t)n * sizeof *out.values);
    if (w->rma->recurs)
        apply_recurrence(w, ramps, k, n, in, add, out);
    else
        apply_libm(w, r, less, k, n, in, add, out);
}

/* Bins that are evanescent, and those that only fill the last vector, read zero. */
static void mask(const struct work_place *w, real *row)
{
    const int begin = w->line.begin, band = w->rma->band, end = w->rma->row;
    for (int k = begin > 0 ? 0 : band; k < end; k = k + 1 == begin ? band : k + 1)
        row[2 * (k / LANES * LANES) + k % LANES] = row[2 * (k / LANES * LANES) + k % LANES + LANES] = 0;
}

/* Where the samples from `centre` on lie: the block's number at its centre, fractions between, ends held. */
static void places(const struct work_place *w, real *restrict place)
{
    const struct rma *rma = w->rma;
    const int length = rma->length, last = rma->block_count - 1;
    const double from = rma->block_from, scale = rma->cuts ? 1 / rma->block_width : 0, slowness = w->line.slowness;
    const bool inverse = rma->options.spacing == RMA_INVERSE;
#pragma omp simd
    for (int j = 0; j < length; j++) {
        int n = rma->centre + (j < length - length / 2 ? j : j - length);
        double delay = fmax(rma->t0 + n / rma->fs, 1e-9), range = delay / slowness;
        double b = ((inverse ? 1 / range : range) - from) * scale;
        place[j] = (real)(b > 0 ? b < last ? b : last : 0);
    }
}

/* Samples that belong to a block, by their places: all of it, or fading to nothing at the neighbours' centres. */
static void add_weighted(const real *restrict x, const real *restrict place, int n, real block, bool blend,
                         real *restrict cut)
{
    for (int j = 0; j < n; j++) {
        real away = place[j] - block, weight = away < 0 ? 1 + away : 1 - away;
        if (!blend)
            weight = away >= (real)-0.5 && away < (real)0.5;
        weight = weight > 0 ? weight : 0;
        cut[2 * j] += weight * x[2 * j];
        cut[2 * j + 1] += weight * x[2 * j + 1];
    }
}

/* Range IFFT of a row of spectra, and what belongs to the block added to the cut. */
static void add_block(const struct work_place *w, const real *row, int block, const real *place, real *cut)
{
    const struct rma *rma = w->rma;
    const int length = rma->length;
    real *wave = buffer(w, RMA_WAVE);
    memset(wave, 0, 2 * (size_t)length * sizeof *wave);
    int bin = rma->band_first < 0 ? rma->band_first + length : rma->band_first;
    for (int k = 0, n; k < rma->band; k += n, bin = bin + n == length ? 0 : bin + n) {
        int lane = k % LANES, left = length - bin;      /* up to the vector's, the band's or the transform's end */
        const real *from = row + 2 * (k - lane) + lane;
        n = LANES - lane < rma->band - k ? LANES - lane : rma->band - k;
        n = n < left ? n : left;
        for (int i = 0; i < n; i++) {
            wave[2 * (bin + i)] = from[i];
            wave[2 * (bin + i) + 1] = from[LANES + i];
        }
    }
    FFTW(execute_dft)(rma->range_inverse, (complex_real *)wave, (complex_real *)wave);
    int from = (rma->centre % length + length) % length;
    for (int half = 0; half < 2; half++) {          /* sample (centre + j) mod length, without the division */
        int begin = half ? length - from : 0, end = half ? length : length - from;
        const real *x = wave + 2 * (half ? -begin : from);
        for (int j0 = begin; j0 < end; j0 += RUN) {
            int n = end - j0 < RUN ? end - j0 : RUN;
            real ends = place[j0] < place[j0 + n - 1] ? place[j0] : place[j0 + n - 1];
            if (ends < (real)(block + 1) && place[j0] + place[j0 + n - 1] - ends > (real)(block - 1))
                add_weighted(x + 2 * j0, place + j0, n, (real)block, rma->options.blend, cut + 2 * j0);
        }
    }
}

/* The cut's spectrum in rising frequency, RMA_GUARD bins of the next period at either end: all real parts, then all
   imaginary ones. Its samples count from `centre`. */
static void spectrum(const struct work_place *w, real *cut, real *re)
{
    const struct rma *rma = w->rma;
    const size_t length = (size_t)rma->length, low = length / 2;     /* low: bins below fc */
    const real *scale = rma->apodization;
    real *im = re + length + 2 * RMA_GUARD;
    for (size_t j = 0; j < length; j++) {
        cut[2 * j] *= scale[j];
        cut[2 * j + 1] *= scale[j];
    }
    FFTW(execute_dft)(rma->range_forward, (complex_real *)cut, (complex_real *)cut);
    const struct {
        size_t from, to, count;
    } pieces[] = {{length - low, RMA_GUARD, low}, {0, RMA_GUARD + low, length - low}};
    for (int piece = 0; piece < 2; piece++) {
        const real *from = cut + 2 * pieces[piece].from;
        real *to_re = re + pieces[piece].to, *to_im = im + pieces[piece].to;
        for (size_t k = 0; k < pieces[piece].count; k++) {
            to_re[k] = from[2 * k];
            to_im[k] = from[2 * k + 1];
        }
    }
    for (size_t k = 0; k < RMA_GUARD; k++) {
        re[k] = re[length + k];
        im[k] = im[length + k];
        re[RMA_GUARD + length + k] = re[RMA_GUARD + k];
        im[RMA_GUARD + length + k] = im[RMA_GUARD + k];
    }
}

/* Values of the spectrum between its bins; position counts from the first guard bin. `taps` is a constant where
   this is inlined. */
static inline __attribute__((always_inline)) void interpolate(const struct rma *rma, const real *restrict spectrum,
    int taps, int n, const double *restrict position, real *restrict re, real *restrict im)
{
    const real *kernel = rma->kernel, *imaginary = spectrum + rma->length + 2 * RMA_GUARD;
    for (int j = 0; j < n; j++) {
        int bin = (int)position[j], first = bin + 1 - taps / 2;
        double interval = (position[j] - bin) * RMA_INTERVALS;
        const real *a = kernel + (size_t)(int)interval * (size_t)taps, *b = a + taps;
        real u = (real)(interval - (int)interval), vr = 0, vi = 0;
#pragma omp simd reduction(+ : vr, vi)
        for (int k = 0; k < taps; k++) {
            real weight = a[k] + u * (b[k] - a[k]);
            vr += weight * spectrum[first + k];
            vi += weight * imaginary[first + k];
        }
        re[j] = vr;
        im[j] = vi;
    }
}

/* Rows of a patch from K = j 2 pi/(length step): interpolation (LBF21 Eq. (16) for the exact K), bulk focusing at the
   first row, weight, IFFT. */
static void focus_interpolated(struct work_place *w, const struct rma_patch *patch, const real *z, real *stored)
{
    const struct rma *rma = w->rma;
    const double c = rma->setting.sound_speed, fc = rma->setting.fc, beta = rma->setting.speed / c;
    const double b1 = (1 - beta) * (1 + beta), half = c * w->line.nu / 2, bin = rma->fs / rma->length;
    /* The band, and some bins beside it for what the interpolation and the blocks' edges spread. */
    const int half_length = rma->length / 2, beside = RMA_GUARD, end = rma->band_first + rma->band - 1 + beside;
    const double low = fmax(fc + (rma->band_first - beside < -half_length ? -half_length
                                  : rma->band_first - beside) * bin, w->line.lowest);
    const double high = fc + (end < half_length - 1 ? end : half_length - 1) * bin;
    const double k_step = 2 * M_PI / (patch->length * patch->step), r = patch->grid.r_first;
    const double t_centre = rma->t0 + rma->centre / rma->fs, to_fc = rma->length / 2 + RMA_GUARD;
    const long long first = (long long)ceil(spectrum_monostatic(&rma->setting, low, w->line.nu) / k_step);
    const long long last = (long long)floor(spectrum_monostatic(&rma->setting, high, w->line.nu) / k_step);
    real *wave = buffer(w, RMA_WAVE);
    memset(wave, 0, 2 * (size_t)patch->length * sizeof *wave);
    double position[SPAN], cycles[SPAN];
    real weight[SPAN], re[SPAN], im[SPAN], wr[SPAN], wi[SPAN];
    for (long long j0 = first; j0 <= last; j0 += SPAN) {
        int n = last - j0 + 1 < SPAN ? (int)(last - j0 + 1) : SPAN;
#pragma omp simd
        for (int i = 0; i < n; i++) {
            double k = (double)(j0 + i) * k_step, kappa = c / (4 * M_PI) * k;
            double root = sqrt(half * half + b1 * kappa * kappa), frequency = beta * half + root;
            double s = sqrt((frequency - half) * (frequency + half)), offset = frequency - fc;
            position[i] = offset / bin + to_fc;
            double slope = b1 * kappa * c / (4 * M_PI) / root;      /* dF/dK */
            weight[i] = (real)(frequency * sqrt(c / (2 * s)) / s * slope * k_step / rma->fs);
            double f = k * r / (2 * M_PI) - offset * t_centre + 0.125;
            cycles[i] = f - floor(f + 0.5);
        }
        switch (rma->taps) {
        case 4: interpolate(rma, z, 4, n, position, re, im); break;
        case 8: interpolate(rma, z, 8, n, position, re, im); break;
        default: interpolate(rma, z, rma->taps, n, position, re, im); break;
        }
        stage_end(w, RMA_STOLT);
#pragma omp simd
        for (int i = 0; i < n; i++) {
            turn(cycles[i], &wr[i], &wi[i]);
            wr[i] *= weight[i];
            wi[i] *= weight[i];
        }
        int at = (int)(j0 % patch->length);
        for (int i = 0; i < n; i++) {
            wave[2 * at] += re[i] * wr[i] - im[i] * wi[i];
            wave[2 * at + 1] += re[i] * wi[i] + im[i] * wr[i];
            if (++at == patch->length)
                at = 0;
        }
        stage_end(w, RMA_FOCUS);
    }
    FFTW(execute_dft)(patch->focus_plan, (complex_real *)wave, (complex_real *)wave);
    for (int i = 0; i < patch->grid.r_count; i++) {
        stored[2 * RMA_TILE * i] = wave[2 * i];
        stored[2 * RMA_TILE * i + 1] = wave[2 * i + 1];
    }
    stage_end(w, RMA_FOCUS);
}

/* The same without interpolation: every bin of the band at every row. `z` are vectors of the band's bins whose
   samples count from time `origin`. */
static void focus_direct(struct work_place *w, const struct rma_patch *patch, const real *z, double origin,
                         real *stored)
{
    const struct rma *rma = w->rma;
    const double c = rma->setting.sound_speed, half = c * w->line.nu / 2;
    const int rows = patch->grid.r_count;
    real *parts = buffer(w, RMA_PARTS);
    memset(parts, 0, (size_t)rows * 2 * LANES * sizeof *parts);
    for (int k = w->line.begin / LANES * LANES; k < rma->band; k += LANES) {
        double k_cycles[LANES], origin_cycles[LANES], weight[LANES];
        real zr[LANES], zi[LANES], wr[LANES], wi[LANES], sr[LANES], si[LANES];
        for (int l = 0; l < LANES; l++) {
            bool exists = k + l >= w->line.begin && k + l < rma->band;
            double frequency = rma_frequency(rma, exists ? k + l : rma->band - 1);
            double s = sqrt((frequency - half) * (frequency + half));
            k_cycles[l] = spectrum_monostatic(&rma->setting, frequency, w->line.nu) / (2 * M_PI);
            origin_cycles[l] = 0.125 - (frequency - rma->setting.fc) * origin;
            weight[l] = exists ? frequency * sqrt(c / (2 * s)) / s / rma->length : 0;
            double step = k_cycles[l] * patch->grid.r_step;
            turn(step - floor(step + 0.5), &sr[l], &si[l]);
        }
        for (int i0 = 0; i0 < rows; i0 += RMA_STEPS) {
            int n = rows - i0 < RMA_STEPS ? rows - i0 : RMA_STEPS;
            for (int l = 0; l < LANES; l++) {
                double f = k_cycles[l] * (patch->grid.r_first + i0 * patch->grid.r_step) + origin_cycles[l];
                turn(f - floor(f + 0.5), &wr[l], &wi[l]);
                zr[l] = z[2 * k + l] * (real)weight[l];
                zi[l] = z[2 * k + LANES + l] * (real)weight[l];
            }
            for (int i = 0; i < n; i++) {
                real *part = parts + (size_t)(i0 + i) * 2 * LANES;
#pragma omp simd
                for (int l = 0; l < LANES; l++) {
                    part[l] += zr[l] * wr[l] - zi[l] * wi[l];
                    part[LANES + l] += zr[l] * wi[l] + zi[l] * wr[l];
                    real t = wr[l] * sr[l] - wi[l] * si[l];
                    wi[l] = wr[l] * si[l] + wi[l] * sr[l];
                    wr[l] = t;
                }
            }
        }
    }
    for (int i = 0; i < rows; i++) {
        real re = 0, im = 0;
        for (int l = 0; l < LANES; l++) {
            re += parts[(size_t)i * 2 * LANES + (size_t)l];
            im += parts[(size_t)i * 2 * LANES + LANES + (size_t)l];
        }
        stored[2 * RMA_TILE * i] = re;
        stored[2 * RMA_TILE * i + 1] = im;
    }
    stage_end(w, RMA_FOCUS);
}

/* The receivers' spectra at this wavenumber, corrected for each block and added up (or not yet): `sums` holds
   [needed][1 or receivers] rows. */
static void convert(struct work_place *w, real *sums)
{
    const struct rma *rma = w->rma;
    const size_t row = 2 * (size_t)rma->row;
    const int turns = w->q - rma->wavenumbers / 2, period = rma->period;
    const int column = ((rma->spacing < 0 ? -turns : turns) % period + period) % period;
    const bool add = rma->options.sum == RMA_SUM_BEFORE;
    const size_t block = (add ? 1 : (size_t)rma->receivers) * row;
    real *data = (real *)rma->data + (size_t)column * (size_t)rma->receivers * row;
    if (!rma->converts) {
        memcpy(sums, data, row * sizeof *sums);
        return;
    }
    double *y = buffer(w, RMA_ABSCISSAS);
    const double y_first = (rma_frequency(rma, 0) - w->line.middle) / w->line.half;
    const double y_step = rma->fs / rma->length / w->line.half;
    for (int k = 0; k < rma->row; k++) {
        double at = y_first + k * y_step;
        y[k] = at < -1 ? -1 : at > 1 ? 1 : at;
    }
    struct rma_ramp *bulk = buffer(w, RMA_RAMPS), *ramps = bulk + rma->groups;
    if (rma->recurs)
        rma_ramps(rma, &w->line, rma->reference, 0, bulk);
    stage_end(w, RMA_BULK);
    for (int n = 0; rma->cuts && rma->recurs && n < rma->needed; n++)
        rma_ramps(rma, &w->line, rma_block_range(rma, rma->blocks[n]), rma->reference, ramps + n * rma->groups);
    stage_end(w, RMA_DIFFERENTIAL);
    const struct rows converted = {buffer(w, RMA_CONVERTED), 2 * SPAN};
    for (int k = w->line.begin / LANES * LANES; k < rma->row; k += SPAN) {
        int n = rma->row - k < SPAN ? rma->row - k : SPAN;
        struct rows in = {data + 2 * k, row}, out = {sums + 2 * k, row};
        apply(w, bulk, rma->reference, 0, k, n, in, add && !rma->cuts, rma->cuts ? converted : out);
        stage_end(w, RMA_BULK);
        for (int b = 0; rma->cuts && b < rma->needed; b++, out.values += block) {
            double r = rma_block_range(rma, rma->blocks[b]);
            apply(w, ramps + b * rma->groups, r, rma->reference, k, n, converted, add, out);
        }
        stage_end(w, RMA_DIFFERENTIAL);
    }
}

/* The blocks' spectra as one signal of samples from `centre` on. */
static void reconstruct(struct work_place *w, real *sums, real *cut)
{
    const struct rma *rma = w->rma;
    const int summed = rma->options.sum == RMA_SUM_BEFORE ? 1 : rma->receivers;
    real *place = buffer(w, RMA_PLACES);
    memset(cut, 0, 2 * (size_t)rma->length * sizeof *cut);
    places(w, place);
    for (int n = 0; n < rma->needed; n++)
        for (int m = 0; m < summed; m++, sums += 2 * rma->row) {
            mask(w, sums);
            add_block(w, sums, rma->blocks[n], place, cut);
        }
}

static void column(struct work_place *w, real *stored)
{
    const struct rma *rma = w->rma;
    real *sums = buffer(w, RMA_SUMS), *cut = buffer(w, RMA_CUT), *z = buffer(w, RMA_SPECTRUM);
    const bool direct = rma->taps == 0, from_sums = direct && !rma->cuts && rma->options.sum == RMA_SUM_BEFORE;
    convert(w, sums);
    if (!from_sums) {
        reconstruct(w, sums, cut);
        spectrum(w, cut, z);
    }
    if (direct && !from_sums) {
        int first = rma->band_first + rma->length / 2 + RMA_GUARD;
        for (int k = 0; k < rma->band; k++)
            for (int part = 0; part < 2; part++)
                sums[2 * (k / LANES * LANES) + k % LANES + part * LANES] =
                    z[part * (rma->length + 2 * RMA_GUARD) + first + k];
    }
    if (direct)
        mask(w, sums);
    stage_end(w, RMA_RECONSTRUCT);
    for (int p = 0; p < rma->patch_count; p++) {
        const struct rma_patch *patch = &rma->patches[p];
        real *out = stored + 2 * RMA_TILE * patch->row;
        if (direct)
            focus_direct(w, patch, sums, rma->t0 + (from_sums ? 0 : rma->centre) / rma->fs, out);
        else
            focus_interpolated(w, patch, z, out);
    }
}

void REAL_ISA_NAME(rma_column)(const struct rma *rma, int thread, int q, double seconds[RMA_STAGES])
{
    struct work_place w = {.rma = rma, .scratch = (char *)rma->scratch + (size_t)thread * rma->scratch_bytes,
                           .seconds = seconds, .mark = seconds_now()};
    real *stored = buffer(&w, RMA_STORED), *focused = rma->focused;
    memset(stored, 0, 2 * RMA_TILE * rma->rows * sizeof *stored);
    for (int n = 0; n < RMA_TILE && q + n < rma->wavenumbers; n++) {
        w.q = q + n;
        w.line = rma_line(rma, q + n);
        if (w.line.begin < rma->band)
            column(&w, stored + 2 * n);
    }
    for (size_t i = 0; i < rma->rows; i++, stored += 2 * RMA_TILE)
        memcpy(focused + 2 * (i * rma->columns + (size_t)q), stored, 2 * RMA_TILE * sizeof *stored);
    stage_end(&w, RMA_FOCUS);
}
