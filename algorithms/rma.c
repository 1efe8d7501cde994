/* Range migration of multi-receiver echoes (rma.h): what a scene needs, in which blocks and transforms, and the
   order of work. Each azimuth wavenumber is worked on by one thread, receivers in order, so that the bits do not
   depend on the number of threads. */
#include "rma.h"

#include <fftw3.h>
#include <limits.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fft_length.h"
#include "isa.h"
#include "pairs.h"
#include "rma_engine.h"

static const double pi = 3.14159265358979323846;

static const double BAND_LOSS = 4e-6;       /* of the compressed pulse's energy may lie outside the band */
static const double GRAZING = 1.005;        /* cells this near to evanescence (cos theta < 0.1) are left out too */
static const double ABEAM_LIMIT = 0.2;      /* rad: a formula further off abeam breaks the absolute phase */
static const double SAME_CURVE = 1e-10;     /* cycles: rounding, not another curvature */
static const double WIDEST_SINE = 0.95;     /* of the aperture where neither sampling nor element length bounds it */

const char *const rma_spacing_names[] = {"uniform", "inverse", NULL};
const char *const rma_blend_names[] = {"off", "on", NULL};
const char *const rma_stolt_names[] = {"direct", "4", "6", "8", "12", "16", NULL};
const char *const rma_sum_names[] = {"before", "after", NULL};
const char *const rma_phases_names[] = {"recurrence", "libm", NULL};
static const int stolt_taps[] = {0, 4, 6, 8, 12, 16};
static const char *const stage_names[RMA_STAGES] = {"bulk", "differential", "reconstruct", "stolt", "focus"};

static rma_column_function *const column_functions[][2] = {
    [ISA_BASELINE] = {rma_column_float_baseline, rma_column_double_baseline},
#ifdef SASBENCH_X86_64
    [ISA_V3] = {rma_column_float_v3, rma_column_double_v3},
    [ISA_V4] = {rma_column_float_v4, rma_column_double_v4},
#endif
};

static const struct rma_transform *transform(const struct rma *rma)
{
    return rma->problem.precision == PRECISION_DOUBLE ? &rma_transform_double : &rma_transform_float;
}

double rma_correction(const struct rma *rma, int receiver, double r, double frequency, double nu)
{
    double phase = rma->method.spectrum(&rma->setting, rma->offset[receiver], r, frequency, nu);
    return -(phase + r * spectrum_monostatic(&rma->setting, frequency, nu)) / (2 * pi);
}

struct rma_line rma_line(const struct rma *rma, int q)
{
    const struct spectrum_setting *s = &rma->setting;
    double c = s->sound_speed, beta = s->speed / c, b1 = (1 - beta) * (1 + beta);
    double period_m = rma->period * fabs(rma->spacing);
    struct rma_line line = {.nu = (q - rma->wavenumbers / 2) / period_m, .begin = rma->band};
    line.lowest = fmax(GRAZING * (1 + fabs(beta)) * c * fabs(line.nu) / 2, 0.01 * s->fc);
    double first = rma_frequency(rma, 0), last = rma_frequency(rma, rma->band - 1);
    if (!(line.lowest < s->fc && line.lowest < last))
        return line;                /* `printed` takes theta at fc, which must exist */
    line.begin = (int)fmax(0, ceil((line.lowest - first) / (rma->fs / rma->length)));
    line.middle = (fmax(first, line.lowest) + last) / 2;
    line.half = fmax(last - line.middle, rma->fs / rma->length);
    double f = line.middle / b1, along = c * line.nu / 2 + f * beta;
    line.slowness = 2 / c * (f - along * beta) / b1 / sqrt((f - along) * (f + along));
    return line;
}

double rma_block_range(const struct rma *rma, int block)
{
    double centre = rma->block_from + block * rma->block_width;
    return rma->options.spacing == RMA_INVERSE ? 1 / centre : centre;
}

/* The quadratic through the first, the middle and the last receiver of a group, at each node in frequency. The
   formulas of LBF and PCA are quadratic in d; the exact one differs by less than 1e-6 rad over a group. */
void rma_ramps(const struct rma *rma, const struct rma_line *line, double r, double less, struct rma_ramp *ramps)
{
    for (int begin = 0; begin < rma->receivers; begin += RMA_GROUP, ramps++) {
        int count = rma->receivers - begin < RMA_GROUP ? rma->receivers - begin : RMA_GROUP;
        double values[3][RMA_DEGREE + 1];
        for (int n = 0; n <= RMA_DEGREE; n++) {
            double frequency = line->middle + line->half * rma->chebyshev[n], at[3] = {0, 0, 0};
            int end = count - 1, middle = end / 2, points[3] = {0, end, middle};
            for (int k = 0; k < count && k < 3; k++) {
                at[k] = rma_correction(rma, begin + points[k], r, frequency, line->nu);
                if (less > 0)
                    at[k] -= rma_correction(rma, begin + points[k], less, frequency, line->nu);
            }
            double slope = count > 1 ? (at[1] - at[0]) / end : 0;
            double bend = count > 2 ? (slope - (at[2] - at[0]) / middle) / (end - middle) : 0;
            values[0][n] = at[0];
            values[1][n] = slope - bend * (end - 1);        /* D(1) - D(0) of a i + bend i^2, a = slope - bend end */
            values[2][n] = 2 * bend;
        }
        double *const polynomials[3] = {ramps->first, ramps->step, ramps->curve};
        bool same = begin > 0;
        ramps->begin = begin;
        ramps->count = count;
        for (int k = 0; k < 3; k++)
            for (int power = 0; power <= RMA_DEGREE; power++) {
                polynomials[k][power] = 0;
                for (int n = 0; n <= RMA_DEGREE; n++)
                    polynomials[k][power] += rma->powers[power][n] * values[k][n];
                same = same && (k < 2 || fabs(ramps->curve[power] - ramps[-1].curve[power]) < SAME_CURVE);
            }
        if (same || count < 3)      /* one or two receivers have none of their own */
            memcpy(ramps->curve, begin > 0 ? ramps[-1].curve : ramps->curve, sizeof ramps->curve);
    }
}

/* Nodes, and the inverse of their Vandermonde matrix: coefficients of Lagrange's polynomials. */
static void nodes_fill(struct rma *rma)
{
    enum { NODES = RMA_DEGREE + 1 };
    for (int n = 0; n < NODES; n++)
        rma->chebyshev[n] = cos(pi * (2 * n + 1) / (2 * NODES));
    for (int n = 0; n < NODES; n++) {
        double c[NODES] = {1}, scale = 1;
        int degree = 0;
        for (int k = 0; k < NODES; k++) {
            if (k == n)
                continue;
            scale *= rma->chebyshev[n] - rma->chebyshev[k];
            degree++;
            for (int power = degree; power >= 0; power--)
                c[power] = (power > 0 ? c[power - 1] : 0) - rma->chebyshev[k] * (power < degree ? c[power] : 0);
        }
        for (int power = 0; power < NODES; power++)
            rma->powers[power][n] = c[power] / scale;
    }
}

/* ---- planning ---- */

static enum status unsupported(const struct rma *rma, const char *reason)
{
    return status_set(STATUS_UNSUPPORTED, "%s: %s", rma->method.name, reason);
}

/* Rows that are asked for: nearest and farthest range. */
static void rows_hull(const struct problem *problem, double *nearest, double *farthest)
{
    *nearest = INFINITY;
    *farthest = -INFINITY;
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *grid = &problem->patches[k];
        *nearest = fmin(*nearest, grid->r_first);
        *farthest = fmax(*farthest, grid->r_first + (grid->r_count - 1) * grid->r_step);
    }
}

/* Near the array and at high speed a formula's phase is off even abeam. What it misses elsewhere is the method's own
   error, which `phase` shows. */
static enum status check_formula(const struct rma *rma)
{
    double ends[2];
    rows_hull(&rma->problem, &ends[0], &ends[1]);
    if (!(ends[0] > 0))
        return status_set(STATUS_UNSUPPORTED, "%s: image rows begin at r = %g m; range migration needs r > 0",
                          rma->method.name, ends[0]);
    double fc = rma->setting.fc, beta = rma->setting.speed / rma->setting.sound_speed;
    double abeam = -2 * fc * beta / (rma->setting.sound_speed * (1 - beta) * (1 + beta));
    for (int k = 0; k < 4; k++) {
        double d = rma->offset[k % 2 ? rma->receivers - 1 : 0], r = ends[k / 2];
        double error = fabs(rma->method.spectrum(&rma->setting, d, r, fc, abeam)
                            - spectrum_exact(&rma->setting, d, r, fc, abeam));
        if (!(error <= ABEAM_LIMIT))
            return status_set(STATUS_UNSUPPORTED, "%s: its phase abeam is off by %.2g rad for the receiver at %g m "
                              "and r = %g m, more than %g (rma_numeric has no such error)", rma->method.name, error,
                              d, r, ABEAM_LIMIT);
    }
    return STATUS_OK;
}

static enum status plan_track(struct rma *rma)
{
    const struct acquisition *a = rma->problem.acquisition;
    struct straight_track track;
    if (!acquisition_is_straight(a, &track))
        return unsupported(rma, "the track is not straight and uniform (tx, rx within lambda/1000 of even points on "
                                "a line along x, y = z = 0, one velocity, one t0)");
    if (a->pings < 2)
        return unsupported(rma, "a single ping has no azimuth spectrum");
    if (a->aperture_limit < 1)
        return unsupported(rma, "the scene has an aperture limit, and range migration cannot choose pings pixel by "
                                "pixel");
    rma->x_first = track.x_first;
    rma->spacing = track.spacing;
    rma->t0 = a->t0[0];
    rma->fs = a->fs;
    rma->receivers = a->receivers;
    rma->pings = a->pings;
    rma->samples = a->samples;
    rma->setting = (struct spectrum_setting){a->sound_speed, track.speed, a->fc, 0};
    rma->offset = malloc((size_t)a->receivers * sizeof *rma->offset);
    if (!rma->offset)
        return status_set(STATUS_FAILED, "no memory for %d receivers", a->receivers);
    double tolerance = a->sound_speed / a->fc / 1000;
    rma->groups = (a->receivers + RMA_GROUP - 1) / RMA_GROUP;
    rma->recurs = rma->options.phases == RMA_RECURRENCE;
    for (int m = 0; m < a->receivers; m++)
        rma->offset[m] = a->rx[m].x - a->tx[0].x;
    for (int m = 0; m < a->receivers; m++) {
        double pitch = a->receivers > 1 ? (rma->offset[a->receivers - 1] - rma->offset[0]) / (a->receivers - 1) : 0;
        rma->recurs = rma->recurs && fabs(rma->offset[m] - rma->offset[0] - m * pitch) <= tolerance;
    }
    rma->converts = a->receivers > 1 || fabs(rma->offset[0]) > tolerance;
    rma->setting.reference_offset = rma->offset[a->receivers / 2];
    return check_formula(rma);
}

/* Azimuth: the full rate of M receivers (LBF21 Eq. (10)), with half the widest aperture's zeros after the pings:
   what lies beyond one end of the track and is imaged at the other has then been seen by the last pings only, by
   the beam's edge. Range: the record, the replica, and the delays of the widest angle. */
static enum status plan_lengths(struct rma *rma)
{
    const struct acquisition *a = rma->problem.acquisition;
    double c = a->sound_speed, nearest, farthest, spacing = fabs(rma->spacing);
    rows_hull(&rma->problem, &nearest, &farthest);
    double sine = fmin(WIDEST_SINE, c * rma->receivers / spacing / 4 / a->fc);
    if (a->tx_length > 0)
        sine = fmin(sine, c / a->fc / a->tx_length);
    double cosine = sqrt(1 - sine * sine), reach = farthest * sine / cosine;
    double x_low = fmin(rma->x_first, rma->x_first + (rma->pings - 1) * rma->spacing);
    double x_high = x_low + (rma->pings - 1) * spacing;
    for (int k = 0; k < rma->problem.patch_count; k++) {
        const struct grid *g = &rma->problem.patches[k];
        double last = g->x_first + (g->x_count - 1) * g->x_step;
        if (g->x_first < x_low - reach || last > x_high + reach)
            return status_set(STATUS_UNSUPPORTED, "%s: columns from %g to %g m leave what the wavenumbers of the "
                              "track cover, %g to %g m (squint too large)", rma->method.name, g->x_first, last,
                              x_low - reach, x_high + reach);
    }
    rma->period = fft_length((long long)fmin(1e9, rma->pings + ceil(reach / 2 / spacing)));
    double first = (2 * nearest / c - rma->t0) * rma->fs;
    double last = (2 * farthest / (c * cosine) * (1 + 2 * fabs(rma->setting.speed) / c) - rma->t0) * rma->fs;
    double before = ceil(fmax(0, -first)), after = ceil(fmax(0, last - (rma->samples - 1)));
    if (!(before + after <= 2.0 * rma->samples))
        return status_set(STATUS_UNSUPPORTED, "%s: rows from %g to %g m lie too far outside the record's %g to %g m",
                          rma->method.name, nearest, farthest, c * rma->t0 / 2,
                          c * (rma->t0 + (rma->samples - 1) / rma->fs) / 2);
    rma->length = fft_length((long long)rma->samples + (long long)(before + after)
                             + (a->pulse_length > 0 ? a->pulse_length - 1 : 0));
    if (rma->period == 0 || rma->length == 0 || (double)rma->period * rma->receivers > INT_MAX / 4
        || rma->length > INT_MAX / 64)
        return unsupported(rma, "the transforms are too long");
    rma->wavenumbers = rma->period * rma->receivers;
    rma->columns = (size_t)(rma->wavenumbers + RMA_TILE - 1) / RMA_TILE * RMA_TILE;
    rma->centre = (int)floor((first + last) / 2 + 0.5);
    double oversampling = fmin(2, fmax(1.1, rma->length / (last - first + 64)));
    rma->widest = 0.5 / oversampling;
    rma->taps = stolt_taps[rma->options.stolt];
    double support = rma->taps * (1 - 0.5 / oversampling);      /* the parameter of least error for this support */
    rma->shape = pi * sqrt(fmax(support * support - 0.8, 1));
    return STATUS_OK;
}

/* Blocks that fade into each other reach from the first row to the last with their centres, so that no row lies
   outside two of them; the others do so with their edges. */
static void blocks_place(struct rma *rma, int count, double nearest, double farthest)
{
    bool inverse = rma->options.spacing == RMA_INVERSE, fade = rma->options.blend && count > 1;
    double from = inverse ? 1 / nearest : nearest, to = inverse ? 1 / farthest : farthest;
    rma->block_count = count;
    rma->block_width = (to - from) / (fade ? count - 1 : count);
    rma->block_from = from + (fade ? 0 : rma->block_width / 2);
}

/* Is the error that the conversion at the blocks' centres leaves at their ends below the limit (LBF21 Eq. (13))? */
static bool blocks_suffice(struct rma *rma, int count, double nearest, double farthest)
{
    blocks_place(rma, count, nearest, farthest);
    const struct acquisition *a = rma->problem.acquisition;
    double nu = (rma->wavenumbers / 2) / (rma->period * fabs(rma->spacing)), largest = 0;
    nu = fmin(nu, 2 * WIDEST_SINE * (a->fc - a->bandwidth / 2) / a->sound_speed);
    if (a->tx_length > 0)
        nu = fmin(nu, 1 / a->tx_length);
    double low = INFINITY, high = -INFINITY;
    int receivers[2] = {0, 0};
    for (int m = 0; m < rma->receivers; m++) {
        if (rma->offset[m] < low) {
            low = rma->offset[m];
            receivers[0] = m;
        }
        if (rma->offset[m] > high) {
            high = rma->offset[m];
            receivers[1] = m;
        }
    }
    for (int n = 0; n < rma->block_count; n++)
        for (int end = -1; end <= 1; end += 2) {
            double edge = rma->block_from + (n + end * 0.5) * rma->block_width;
            double r0 = rma_block_range(rma, n), r1 = edge;
            if (rma->options.spacing == RMA_INVERSE)
                r1 = edge > 0 ? 1 / edge : farthest;
            r1 = fmin(fmax(r1, nearest), farthest);
            for (int k = 0; k < 18; k++) {      /* 2 receivers, 3 frequencies, 3 wavenumbers */
                double frequency = a->fc + (k / 2 % 3 - 1) * a->bandwidth / 2, at = (k / 6 - 1) * nu;
                double error = rma_correction(rma, receivers[k % 2], r1, frequency, at)
                               - rma_correction(rma, receivers[k % 2], r0, frequency, at);
                largest = fmax(largest, 2 * pi * fabs(error));
            }
        }
    return largest <= rma->options.limit;
}

static enum status plan_blocks(struct rma *rma)
{
    double nearest, farthest;
    int count = rma->options.blocks;
    rows_hull(&rma->problem, &nearest, &farthest);
    if (!(farthest > nearest) || !rma->converts)
        count = 1;
    if (count == 0) {
        int too_few = 0;
        for (count = 1; !blocks_suffice(rma, count, nearest, farthest); count *= 2) {
            too_few = count;
            if (count >= 4096)
                return status_set(STATUS_UNSUPPORTED, "%s: 4096 range blocks leave a phase error above limit = %g "
                                  "rad", rma->method.name, rma->options.limit);
        }
        while (count - too_few > 1) {
            int middle = (count + too_few) / 2;
            *(blocks_suffice(rma, middle, nearest, farthest) ? &count : &too_few) = middle;
        }
    }
    blocks_place(rma, count, nearest, farthest);
    rma->cuts = count > 1;
    rma->reference = rma_block_range(rma, count / 2);
    rma->blocks = malloc((size_t)count * sizeof *rma->blocks);
    if (!rma->blocks)
        return status_set(STATUS_FAILED, "no memory for %d blocks", count);
    double near = rma->options.blend ? 1 - 1e-9 : 0.5 + 1e-9;      /* a block fades to nothing, or ends, there */
    for (int n = 0; n < count; n++) {
        bool wanted = false;
        for (int k = 0; k < rma->problem.patch_count; k++) {
            const struct grid *g = &rma->problem.patches[k];
            double ends[2] = {g->r_first, g->r_first + (g->r_count - 1) * g->r_step};
            for (int e = 0; e < 2; e++) {
                double y = rma->options.spacing == RMA_INVERSE ? 1 / ends[e] : ends[e];
                ends[e] = count > 1 ? fmin(fmax((y - rma->block_from) / rma->block_width, 0), count - 1) : 0;
            }
            wanted = wanted || (ends[1] > n - near && ends[0] < n + near);
        }
        if (wanted)
            rma->blocks[rma->needed++] = n;
    }
    return STATUS_OK;
}

static enum status plan_patches(struct rma *rma)
{
    const struct problem *problem = &rma->problem;
    double extent = rma->length * rma->setting.sound_speed / (2 * rma->fs) * (1 + 2 * fabs(rma->setting.speed)
                                                                             / rma->setting.sound_speed);
    rma->patches = calloc((size_t)problem->patch_count, sizeof *rma->patches);
    if (!rma->patches)
        return status_set(STATUS_FAILED, "no memory for %d patches", problem->patch_count);
    rma->patch_count = problem->patch_count;
    for (int k = 0; k < problem->patch_count; k++) {
        struct rma_patch *patch = &rma->patches[k];
        patch->grid = problem->patches[k];
        patch->row = rma->rows;
        patch->step = patch->grid.r_count > 1 ? patch->grid.r_step : rma->setting.sound_speed / (2 * rma->fs);
        double rows = fmax(ceil(extent / patch->step), patch->grid.r_count);
        patch->length = rows < 1e8 ? fft_length((long long)rows) : 0;
        patch->chirp = fft_length((long long)rma->wavenumbers + patch->grid.x_count - 1);
        if (patch->length == 0 || patch->chirp == 0)
            return status_set(STATUS_UNSUPPORTED, "%s: rows %g m apart over %g m are too many to transform",
                              rma->method.name, patch->step, extent);
        rma->rows += (size_t)patch->grid.r_count;
    }
    return STATUS_OK;
}

/* The bins that hold the compressed pulse; all of them where the echoes come compressed already. */
static enum status plan_band(struct rma *rma)
{
    const struct acquisition *a = rma->problem.acquisition;
    int length = rma->length, lanes = RMA_ALIGNMENT / (rma->problem.precision == PRECISION_DOUBLE ? 8 : 4);
    rma->band_first = -(length / 2);
    rma->band = length;
    if (!a->compressed) {
        double complex *work = fftw_malloc((size_t)length * sizeof *work);
        if (!work)
            return status_set(STATUS_FAILED, "no memory for the replica's spectrum");
        memset(work, 0, (size_t)length * sizeof *work);
        memcpy(work, a->pulse, (size_t)a->pulse_length * sizeof *work);
        fftw_plan forward = fftw_plan_dft_1d(length, work, work, FFTW_FORWARD, FFTW_ESTIMATE);
        fftw_execute(forward);
        fftw_destroy_plan(forward);
        double total = 0, outside = 0;
        for (int k = 0; k < length; k++)
            total += pow(cabs(work[k]), 4);
        int widest = (length - 1) / 2, half = widest;
        for (; half > a->bandwidth / 2 / a->fs * length; half--) {
            double edge = pow(cabs(work[half]), 4) + pow(cabs(work[length - half]), 4);
            if (outside + edge > BAND_LOSS * total)
                break;
            outside += edge;
        }
        rma->loss = outside / total;
        fftw_free(work);
        if (half < widest) {
            rma->band_first = -half;
            rma->band = 2 * half + 1;
        }
    }
    rma->row = (rma->band + lanes - 1) / lanes * lanes;
    return STATUS_OK;
}

static void plan_scratch(struct rma *rma)
{
    size_t real_bytes = rma->problem.precision == PRECISION_DOUBLE ? sizeof(double) : sizeof(float);
    size_t receivers = (size_t)rma->receivers, row = 2 * (size_t)rma->row * real_bytes, longest = (size_t)rma->length;
    size_t most_rows = 0, length = (size_t)rma->length;
    for (int k = 0; k < rma->patch_count; k++) {
        size_t rows = (size_t)rma->patches[k].grid.r_count;
        longest = (size_t)rma->patches[k].length > longest ? (size_t)rma->patches[k].length : longest;
        most_rows = rows > most_rows ? rows : most_rows;
    }
    bool after = rma->options.sum == RMA_SUM_AFTER;
    const size_t bytes[RMA_BUFFERS] = {
        [RMA_RAMPS] = (1 + (size_t)rma->needed) * (size_t)rma->groups * sizeof(struct rma_ramp),
        [RMA_ABSCISSAS] = (size_t)rma->row * sizeof(double),
        [RMA_CONVERTED] = rma->cuts ? receivers * 2 * RMA_SPAN * real_bytes : 0,
        [RMA_SUMS] = (size_t)rma->needed * (after ? receivers : 1) * row,
        [RMA_WAVE] = 2 * longest * real_bytes,
        [RMA_CUT] = 2 * length * real_bytes,
        [RMA_PLACES] = length * real_bytes,
        [RMA_SPECTRUM] = 2 * (length + 2 * RMA_GUARD) * real_bytes,
        [RMA_PARTS] = rma->taps == 0 ? most_rows * 2 * RMA_ALIGNMENT : 0,
        [RMA_STORED] = 2 * RMA_TILE * rma->rows * real_bytes,
    };
    for (int k = 0; k < RMA_BUFFERS; k++) {
        rma->scratch_at[k] = rma->scratch_bytes;
        rma->scratch_bytes += (bytes[k] + RMA_ALIGNMENT - 1) / RMA_ALIGNMENT * RMA_ALIGNMENT;
    }
}

static void count_work(struct rma *rma)
{
    struct work *work = &rma->work;
    double receivers = rma->receivers, row = rma->band, q = rma->wavenumbers, length = rma->length;
    double applied = 20;                        /* a receiver's cell: product, sum, and two recurrences */
    double phases = 3 * (2.0 * RMA_DEGREE + 30) / RMA_GROUP;
    double sums = rma->options.sum == RMA_SUM_AFTER ? receivers : 1, corrections = 1 + (rma->cuts ? rma->needed : 0);
    work->flops = receivers * rma->pings * (fft_flops(length) + 6 * row)
                  + receivers * row * fft_flops(rma->period)
                  + q * receivers * row * (rma->converts ? applied + phases : 0) * corrections
                  + q * (sums * rma->needed * (fft_flops(length) + 4 * length) + fft_flops(length) + 2 * length);
    for (int k = 0; k < rma->patch_count; k++) {
        const struct rma_patch *patch = &rma->patches[k];
        double rows = patch->grid.r_count, points = patch->length * patch->step * 2 * rma->fs
                                                    / rma->setting.sound_speed;
        work->flops += q * (rma->taps ? points * (7.0 * rma->taps + 60) + fft_flops(patch->length) : rows * row * 14);
        work->flops += rows * (2 * fft_flops(patch->chirp) + 6 * (q + patch->chirp + patch->grid.x_count));
    }


    /* LBF21 Eqs. (20) to (22): N_a x N_r the full-rate data. Eq. (20) counts one sub-block, whatever their number:
       each one more costs its products and its range transforms. */
    const struct rma_method *method = &rma->method;
    double na = (double)rma->pings * receivers, nr = rma->samples, taps = rma->taps ? rma->taps : 8;
    double range = method->range[0] * receivers + method->range[1];
    double azimuth = method->azimuth[0] * receivers + method->azimuth[1];
    double products = method->products[0] * receivers + method->products[1];
    double paper = na * nr * (1.5 * range * log2(nr) + 1.5 * azimuth * log2(na) + products
                              + method->interpolations * (2 * taps - 1));
    work->published[0].source = method->source;
    work->published[0].flops = paper;
    work->published[1].source = "with each range block's products and transforms, which it leaves out";
    work->published[1].flops = paper + (rma->block_count - 1) * receivers * na * nr * (1.5 * log2(nr) + 1);

    snprintf(work->engine, sizeof work->engine, "%d of %d blocks", rma->needed, rma->block_count);
    int used = snprintf(work->skipped, sizeof work->skipped, "azimuth correction: the monostatic phase is exact");
    const struct {
        bool happens;
        const char *text;
    } notes[] = {
        {!rma->converts, "; conversion: one receiver at the transmitter"},
        {rma->converts && !rma->cuts, "; differential preprocessing: one block"},
        {rma->taps == 0, "; Stolt interpolation: direct sum"},
    };
    for (size_t k = 0; k < sizeof notes / sizeof *notes; k++)
        if (notes[k].happens)
            used += snprintf(work->skipped + used, sizeof work->skipped - (size_t)used, "%s", notes[k].text);
    if (rma->needed < rma->block_count)
        used += snprintf(work->skipped + used, sizeof work->skipped - (size_t)used, "; %d blocks without rows",
                         rma->block_count - rma->needed);
    if (rma->band < rma->length)
        snprintf(work->skipped + used, sizeof work->skipped - (size_t)used,
                 "; %.0f %% of the band: %.1g of the pulse's energy", 100 * (1 - (double)rma->band / rma->length),
                 rma->loss);
}

enum status rma_plan(const struct problem *problem, const struct rma_method *method,
                     const struct rma_options *options, void **plan)
{
    *plan = NULL;
    struct rma *rma = calloc(1, sizeof *rma);
    if (!rma)
        return status_set(STATUS_FAILED, "no memory for the plan");
    rma->problem = *problem;
    rma->method = *method;
    rma->options = *options;
    rma->threads = omp_get_max_threads();
    rma->work.bytes = sizeof *rma;
    nodes_fill(rma);
    static enum status (*const steps[])(struct rma *) = {plan_track, plan_lengths, plan_blocks, plan_patches,
                                                         plan_band};
    enum status status = STATUS_OK;
    for (size_t k = 0; status == STATUS_OK && k < sizeof steps / sizeof *steps; k++)
        status = steps[k](rma);
    if (status == STATUS_OK) {
        plan_scratch(rma);
        status = transform(rma)->plan(rma);
    }
    if (status != STATUS_OK) {
        rma_destroy(rma);
        return status;
    }
    count_work(rma);
    *plan = rma;
    return STATUS_OK;
}

enum status rma_execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    struct rma *rma = plan;
    rma_column_function *column = column_functions[isa_choose()][rma->problem.precision];
    transform(rma)->compress(rma, echoes->samples);
    stages_end(stages, "compress");
    transform(rma)->spread(rma);
    stages_end(stages, "spread");
    double seconds[RMA_STAGES] = {0}, sum = 0;
#pragma omp parallel num_threads(rma->threads) reduction(+ : seconds[:RMA_STAGES])
    {
#pragma omp for schedule(dynamic)
        for (int q = 0; q < rma->wavenumbers; q += RMA_TILE)
            column(rma, omp_get_thread_num(), q, seconds);
    }
    /* The threads' time in each stage, as shares of the time that passed. */
    for (int k = 0; k < RMA_STAGES; k++)
        sum += seconds[k];
    double passed = seconds_now() - stages->mark;
    for (int k = 0; k < RMA_STAGES; k++)
        if (seconds[k] > 0) {
            stages->mark = seconds_now() - passed * seconds[k] / sum;
            stages_end(stages, stage_names[k]);
        }
    for (int k = 0; k < rma->patch_count; k++)
        transform(rma)->inverse(rma, k, image->pixels[k]);
    stages_end(stages, "inverse");
    return STATUS_OK;
}

struct work rma_work(const void *plan)
{
    return ((const struct rma *)plan)->work;
}

void rma_destroy(void *plan)
{
    struct rma *rma = plan;
    if (!rma)
        return;
    transform(rma)->destroy(rma);
    free(rma->patches);
    free(rma->blocks);
    free(rma->offset);
    free(rma);
}
