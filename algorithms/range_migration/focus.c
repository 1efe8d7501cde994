/* Range migration at one azimuth wavenumber after the conversion: blocks put together, Stolt interpolation, bulk
   focusing (reconstruct to focus of rma.h). Compiled once for each precision and instruction set (BP_ISA names it). */
#include <string.h>

#include "common/clock.h"
#include "common/stream.h"
#include "range_migration/column.h"

enum { RUN = 64 }; /* samples that a block uses or skips together: places rise or fall along them */

/* Bins that are evanescent, and those that only fill the last vector, read zero. */
static void mask(const struct workspace *w, real *row)
{
    const int begin = w->line.begin, band = w->swath->band, end = w->swath->row;
    for (int k = begin > 0 ? 0 : band; k < end; k = k + 1 == begin ? band : k + 1)
        row[2 * (k / LANES * LANES) + k % LANES] = row[2 * (k / LANES * LANES) + k % LANES + LANES] = 0;
}

/* Places of the samples from `centre` on: the block's number at its centre, fractions between; beyond the swath's
   blocks, the nearest. */
static void places(const struct workspace *w, real *restrict place)
{
    const struct rma *rma = w->rma;
    const struct rma_swath *swath = w->swath;
    const int length = swath->length;
    const double first = swath->blocks[0], last = swath->blocks[swath->needed - 1];
    const double from = rma->block_from, scale = 1 / rma->block_width, slowness = w->line.slowness;
    const double fs = rma->fs;
    const bool inverse = rma->options.spacing == RMA_INVERSE;
#pragma omp simd
    for (int j = 0; j < length; j++) {
        int n = swath->centre + (j < length - length / 2 ? j : j - length);
        double delay = swath->t_first + n / fs, range = (delay > 1e-9 ? delay : 1e-9) / slowness;
        double b = ((inverse ? 1 / range : range) - from) * scale;
        b = b < last ? b : last;
        place[j] = (real)(b > first ? b : first);
    }
}

/* A block's extent, by place, and its weight: a polynomial in the distance from its centre, lowest power first. */
struct piece {
    real from, to, weight[RMA_NODES];
};

/* Blocks that blend: Lagrange's cubic through the nearest four, two to either side except at the ends of the swath. */
static int block_pieces(const struct rma *rma, int block, struct piece *pieces)
{
    int count = 0;
    if (!rma->options.blend) {
        pieces[count++] = (struct piece){(real)(block - 0.5), (real)(block + 0.5), {1}};
        return count;
    }
    const int nodes = rma_nodes_blended(rma), last = rma->block_count - nodes;
    for (int first = block - nodes + 1; first <= block; first++) { /* the nearest: first to first + nodes - 1 */
        if (first < 0 || first > last)
            continue;
        struct piece *piece = &pieces[count++];
        *piece =
            (struct piece){first > 0 ? (real)(first + 1) : -INFINITY, first < last ? (real)(first + 2) : INFINITY, {1}};
        for (int node = first, degree = 1; node < first + nodes; node++)
            if (node != block) {
                real way = (real)(node - block);
                for (int k = degree; k > 0; k--)
                    piece->weight[k] = piece->weight[k] - piece->weight[k - 1] / way;
                degree++;
            }
    }
    return count;
}

static void add_weighted(const real *restrict x, const real *restrict place, int n, real block,
                         const struct piece *piece, real *restrict cut)
{
    const real from = piece->from, to = piece->to, w0 = piece->weight[0], w1 = piece->weight[1], w2 = piece->weight[2],
               w3 = piece->weight[3];
    for (int j = 0; j < n; j++) {
        real away = place[j] - block, weight = w0 + away * (w1 + away * (w2 + away * w3));
        weight = place[j] >= from && place[j] < to ? weight : 0;
        cut[2 * j] += weight * x[2 * j];
        cut[2 * j + 1] += weight * x[2 * j + 1];
    }
}

/* Bins [begin, end) of a row of vectors as complex numbers. */
static void interleave(const real *restrict row, int begin, int end, real *restrict out)
{
    for (int k = begin, n; k < end; k += n, out += 2 * n) {
        const int lane = k % LANES;
        const real *from = row + 2 * (k - lane) + lane;
        n = LANES - lane < end - k ? LANES - lane : end - k;
        if (n == LANES) /* the usual case, of constant length */
            for (int i = 0; i < LANES; i++) {
                out[2 * i] = from[i];
                out[2 * i + 1] = from[LANES + i];
            }
        else
            for (int i = 0; i < n; i++) {
                out[2 * i] = from[i];
                out[2 * i + 1] = from[LANES + i];
            }
    }
}

/* Range IFFT of a row of spectra, added to the cut with the block's weight; without places all of it. */
static void add_block(const struct workspace *w, const real *row, int block, const real *place, real *cut)
{
    const struct rma_swath *swath = w->swath;
    const int length = swath->length, below = -swath->band_first;
    real *wave = buffer(w, RMA_WAVE), *samples = buffer(w, RMA_TRANSFORMED);
    interleave(row, 0, below, wave + 2 * (length - below));
    interleave(row, below, swath->band, wave);
    memset(wave + 2 * (swath->band - below), 0, 2 * (size_t)(length - swath->band) * sizeof *wave);
    FFTW(execute_dft)(swath->range_inverse, (complex_real *)wave, (complex_real *)samples);
    struct piece pieces[RMA_NODES];
    const int count = place ? block_pieces(w->rma, block, pieces) : 0;
    /* Samples from `centre` on, then those before it at the cut's end. */
    for (int j = 0, n; j < length; j += n) {
        const int at = (swath->centre + j) % length, ahead = length - length / 2,
                  left = (j < ahead ? ahead : length) - j;
        n = left < RUN ? left : RUN;
        n = n < length - at ? n : length - at;
        real *to = cut + 2 * (j < ahead ? j : j + swath->stolt_length - length), *x = samples + 2 * at;
        if (!place) {
            memcpy(to, x, 2 * (size_t)n * sizeof *to);
            continue;
        }
        real low = place[j] < place[j + n - 1] ? place[j] : place[j + n - 1], high = place[j] + place[j + n - 1] - low;
        for (int k = 0; k < count; k++)
            if (low < pieces[k].to && high >= pieces[k].from)
                add_weighted(x, place + j, n, (real)block, &pieces[k], to);
    }
}

/* `count` samples times their apodization. */
static void apodize(const real *restrict samples, const real *restrict scale, size_t count, real *restrict out)
{
    for (size_t j = 0; j < count; j++) {
        out[2 * j] = samples[2 * j] * scale[j];
        out[2 * j + 1] = samples[2 * j + 1] * scale[j];
    }
}

/* The spectrum of a cut (delay compensation: a row of samples) in rising frequency, RMA_GUARD bins of the next period
   at either end: all real parts, then all imaginary ones. Its samples count from `centre`. */
static void spectrum(const struct workspace *w, const real *cut, real *re)
{
    const struct rma_swath *swath = w->swath;
    const size_t length = (size_t)swath->stolt_length, low = length / 2; /* low: bins below fc */
    const real *scale = swath->apodization;
    real *wave = buffer(w, RMA_WAVE), *bins = buffer(w, RMA_TRANSFORMED), *im = re + length + 2 * RMA_GUARD;
    if (w->rma->delay) {
        const size_t before = (size_t)swath->centre, behind = (size_t)(swath->held - swath->centre);
        apodize(cut + 2 * before, scale, behind, wave);
        memset(wave + 2 * behind, 0, 2 * (length - behind - before) * sizeof *wave);
        apodize(cut, scale + length - before, before, wave + 2 * (length - before));
    } else
        apodize(cut, scale, length, wave);
    FFTW(execute_dft)(swath->stolt_forward, (complex_real *)wave, (complex_real *)bins);
    const struct {
        size_t from, to, count;
    } pieces[] = {{length - low, RMA_GUARD, low}, {0, RMA_GUARD + low, length - low}};
    for (int piece = 0; piece < 2; piece++) {
        const real *from = bins + 2 * pieces[piece].from;
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

/* The blocks' spectra as one signal of samples from `centre` on. */
static void reconstruct(struct workspace *w, real *sums, real *cut)
{
    const struct rma_swath *swath = w->swath;
    const int summed = w->rma->options.sum == RMA_SUM_BEFORE ? 1 : w->rma->receivers;
    const bool whole = swath->needed * summed == 1;
    real *place = buffer(w, RMA_PLACES);
    memset(cut, 0, 2 * (size_t)swath->stolt_length * sizeof *cut);
    if (!whole)
        places(w, place);
    for (int n = 0; n < swath->needed; n++)
        for (int m = 0; m < summed; m++, sums += 2 * swath->row) {
            mask(w, sums);
            add_block(w, sums, swath->blocks[n], whole ? NULL : place, cut);
        }
}

/* `samples`: delay compensation's. */
static void column(struct workspace *w, const real *samples, real *stored)
{
    const struct rma_swath *swath = w->swath;
    real *sums = buffer(w, RMA_SUMS), *cut = buffer(w, RMA_CUT), *z = buffer(w, RMA_SPECTRUM);
    if (!w->rma->delay) {
        REAL_ISA_NAME(rma_convert)(w, sums);
        reconstruct(w, sums, cut);
    }
    spectrum(w, w->rma->delay ? samples : cut, z);
    stage_end(w, RMA_RECONSTRUCT);
    for (int p = 0; p < swath->patch_count; p++)
        (w->rma->method.chirps ? REAL_ISA_NAME(rma_chirp_rows) : REAL_ISA_NAME(rma_stolt))(
            w, &swath->patches[p], z, stored + 2 * swath->patches[p].row);
}

/* Rows of `count` wavenumbers, `stride` reals apart, side by side in `focused`. */
static void tile_store(const struct workspace *w, const real *stored, size_t stride, int turn, size_t count)
{
    const struct rma_swath *swath = w->swath;
    real *out = (real *)w->rma->focused + 2 * (size_t)turn;
    const bool streams =
        count == RMA_TILE && stream_pays((double)swath->rows * (double)swath->columns * 2 * sizeof(real));
    for (size_t i = 0; i < swath->rows; i++, out += 2 * swath->columns) {
        const real *from = stored + 2 * i;
        if (streams && REAL_DOUBLE)
            for (size_t n = 0; n < RMA_TILE; n++)
                stream_halves(out + 2 * n, from + n * stride, from + n * stride + 1);
        else if (streams)
            for (size_t n = 0; n < RMA_TILE; n += 2)
                stream_halves(out + 2 * n, from + n * stride, from + (n + 1) * stride);
        else if (count == RMA_TILE)               /* the usual case, of constant length */
            for (size_t n = 0; n < RMA_TILE; n++) /* moved as one: else the compiler splits real and imaginary parts */
                memcpy(out + 2 * n, from + n * stride, 2 * sizeof *out);
        else
            for (size_t n = 0; n < count; n++)
                memcpy(out + 2 * n, from + n * stride, 2 * sizeof *out);
    }
    if (streams)
        stream_end();
}

/* Wavenumbers of one tile; `samples` of the first, where delays are compensated. */
static void tile(struct workspace *w, int turn, int count, const real *samples)
{
    const struct rma *rma = w->rma;
    const struct rma_swath *swath = w->swath;
    real *stored = buffer(w, RMA_STORED);
    const size_t stride = 2 * (swath->rows + RMA_TILE); /* or rows a power of two apart would share sets of the cache */
    for (int n = 0; n < count; n++, samples += rma->delay ? 2 * swath->row : 0) {
        real *rows = stored + (size_t)n * stride;
        w->line.begin = swath->band;
        if (turn + n < swath->wavenumbers) {
            w->q = rma_wavenumber(rma, swath, turn + n);
            w->line = rma_line(rma, swath, w->q);
        }
        if (w->line.begin < swath->band)
            column(w, samples, rows);
        else
            memset(rows, 0, 2 * swath->rows * sizeof *rows);
    }
    tile_store(w, stored, stride, turn, (size_t)count);
    stage_end(w, RMA_FOCUS);
}

void REAL_ISA_NAME(rma_column)(const struct rma *rma, const struct rma_swath *swath, int thread, int turn,
                               double seconds[RMA_STAGES])
{
    struct workspace w = {.rma = rma,
                          .swath = swath,
                          .seconds = seconds,
                          .mark = clock_monotonic(),
                          .scratch = (char *)rma->scratch + (size_t)thread * rma->scratch_bytes};
    const size_t row = 2 * (size_t)swath->row;
    real *samples = buffer(&w, RMA_CUT);
    int end = turn + rma_turns(rma) < swath->wavenumbers ? turn + rma_turns(rma) : swath->wavenumbers;
    for (int at = turn; rma->delay && at < end; at += rma->receivers)
        REAL_ISA_NAME(rma_receivers)(&w, at / rma->receivers, samples + (size_t)(at - turn) * row);
    if (end == swath->wavenumbers)
        end = (int)swath->columns;
    for (int at = turn, count; at < end; at += count, samples += rma->delay ? (size_t)count * row : 0) {
        count = RMA_TILE - at % RMA_TILE;
        count = count < end - at ? count : end - at;
        tile(&w, at, count, samples);
    }
}
