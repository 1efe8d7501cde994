/* The delays of an image row (row.h): each by its roots, or by polynomials of the distance along the track (pieces.h).
   This file is compiled once for each precision and instruction set (BP_ISA names it). */
#include <math.h>

#include "backprojection/invariant/chunk.h"
#include "common/phasor.h"

/* For places `ahead` metres along the track: replace `ahead` by the transmitter's place when its echo leaves them, and
   set `leg` to the seconds until then. */
static void legs_out(const struct bp_row *row, int count, double *restrict ahead, double *restrict leg)
{
    const double one_c = 1 / row->medium->sound_speed, v = row->raster->speed, r2 = row->r * row->r;
#pragma omp simd
    for (int i = 0; i < count; i++) {
        double u = ahead[i], seconds = sqrt(u * u + r2) * one_c;
        leg[i] = seconds;
        ahead[i] = u + v * seconds;
    }
}

/* Two roots in one vector take less time than two polynomials of separate products and sums. */
enum { PIECES_PAY = VECTOR_BYTES > 16 };

/* Where a row's entries lie along the track: all, and those of one vector at the most. */
struct extent {
    double low, high, vector;
};

/* The least and the largest of a vector of places. */
INLINE void vector_extent(const double *ahead, double *low, double *high)
{
    double least = ahead[0], most = ahead[0];
#pragma omp simd reduction(min : least) reduction(max : most)
    for (int k = 0; k < LANES; k++) {
        least = ahead[k] < least ? ahead[k] : least;
        most = ahead[k] > most ? ahead[k] : most;
    }
    *low = least;
    *high = most;
}

static struct extent extent_of(const double *ahead, int entries)
{
    struct extent extent = {INFINITY, -INFINITY, 0};
    for (int i = 0; i < entries; i += LANES) {
        double low, high;
        vector_extent(ahead + i, &low, &high);
        extent.low = low < extent.low ? low : extent.low;
        extent.high = high > extent.high ? high : extent.high;
        extent.vector = high - low > extent.vector ? high - low : extent.vector;
    }
    return extent;
}

/* Pieces that cover a row's entries, from broadside outwards: as long as their distance from the pings allows, and
   overlapping by the extent of a vector, so that each vector is inside one. `beside`: how much nearer along the track a
   receiver may be than the transmitter. Returns their number; 0 where they do not pay. */
static int pieces_cover(const struct bp_row *row, const struct extent *extent, double beside, int entries,
                        struct bp_piece *pieces)
{
    const double reach = row->raster->reach, longest = row->raster->longest, r = fabs(row->r);
    const double middle = fmin(fmax(0, extent->low), extent->high), overlap = 1.001 * extent->vector;
    double half = fmin(longest, piece_half(reach, r)), edge[2];
    int count = 1;
    for (int side = 0; side < 2; side++)
        edge[side] = side ? fmin(extent->high, middle + half) : fmax(extent->low, middle - half);
    pieces[0] = (struct bp_piece){edge[0], edge[1]};
    for (int side = 0; side < 2; side++)
        while (side ? edge[1] < extent->high : edge[0] > extent->low) {
            const double begin = side ? edge[1] - overlap : edge[0] + overlap;
            const double near = fmax(0, (side ? begin : -begin) - beside);
            half = fmin(longest, piece_half(reach, sqrt(near * near + r * r)));
            if (!(half > overlap) || count == PIECES_MOST)
                return 0;
            edge[side] = side ? fmin(extent->high, begin + 2 * half) : fmax(extent->low, begin - 2 * half);
            pieces[count++] = side ? (struct bp_piece){begin, edge[1]} : (struct bp_piece){edge[0], begin};
        }
    return 2 * PIECE_POWERS * count <= entries ? count : 0;
}

/* Assign each vector of entries to a piece, and replace the distance ahead by the place in the piece, -1 to 1. */
static void pieces_place(const struct bp_row *row, int count, int entries)
{
    const struct bp_row_scratch *scratch = row->scratch;
    const double *node = row->raster->fit->node;
    for (int i = 0; i < entries; i += LANES) {
        double *restrict ahead = scratch->ahead + i, low, high;
        int n = 0;
        vector_extent(ahead, &low, &high);
        while (n < count - 1 && !(low >= scratch->pieces[n].begin && high <= scratch->pieces[n].end))
            n++;
        const struct bp_piece *piece = &scratch->pieces[n];
        const double middle = 0.5 * (piece->begin + piece->end), one = 2 / (piece->end - piece->begin);
        for (int k = 0; k < LANES; k++)
            ahead[k] = (ahead[k] - middle) * one;
        scratch->piece[i / LANES] = n;
    }
    for (int n = 0; n < count; n++) {
        const double begin = scratch->pieces[n].begin, half = 0.5 * (scratch->pieces[n].end - begin);
        for (int k = 0; k < PIECE_POWERS; k++)
            scratch->node_ahead[n * PIECE_POWERS + k] = begin + half * (1 + node[k]);
    }
    legs_out(row, count * PIECE_POWERS, scratch->node_ahead, scratch->node_leg);
}

int DELAYS_PLAN(const struct bp_row *row, const struct delay_terms *terms, double offset, int entries)
{
    const struct bp_row_scratch *scratch = row->scratch;
    int count = 0;
    if (PIECES_PAY && row->raster->reach > 0 && isfinite(offset) && entries > 0) {
        const struct extent extent = extent_of(scratch->ahead, entries);
        const double furthest = fmax(fabs(extent.low), fabs(extent.high)) + fabs(row->r);
        const double beside = offset + fabs(terms->v) / row->medium->sound_speed * furthest;
        if (extent.high > extent.low)
            count = pieces_cover(row, &extent, beside, entries, scratch->pieces);
    }
    if (count > 0)
        pieces_place(row, count, entries);
    else
        legs_out(row, entries, scratch->ahead, scratch->leg);
    return count;
}

/* The delay to a receiver that is b m ahead of the place when the echo leaves it. `slow` is a constant where this is
   inlined. */
INLINE double delay(bool slow, const struct delay_terms *terms, double leg, double b)
{
    const double p = b * terms->v, s = sqrt(terms->c2 * (b * b) + terms->er2);
    return leg + (slow || p >= 0 ? (p + s) * terms->one_e : (b * b + terms->r2) / (s - p));
}

void DELAYS_RECEIVER(const struct bp_row *row, const struct row_tables *tables, double offset)
{
    const struct bp_row_scratch *scratch = row->scratch;
    const struct piece_fit *fit = row->raster->fit;
    const struct delay_terms terms = tables->terms;
    const double fs = row->medium->fs, t0 = row->raster->t0, ratio = row->medium->fc / fs;
    const double cycles = row->medium->fc * t0, first = cycles - floor(cycles);
    const int count = tables->pieces * PIECE_POWERS;
    const double *restrict leg = scratch->node_leg, *restrict ahead = scratch->node_ahead;
    double *restrict q = scratch->node_q;
#pragma omp simd
    for (int i = 0; i < count; i++)
        q[i] = (delay(true, &terms, leg[i], ahead[i] + offset) - t0) * fs;
    for (int n = 0; n < tables->pieces; n++, q += PIECE_POWERS) {
        struct bp_polynomial *p = &scratch->polynomials[n];
        double c[PIECE_POWERS] = {0};
        const double middle = q[PIECE_POWERS / 2]; /* the sums round only the differences from it */
        for (int k = 0; k < PIECE_POWERS; k++)
            for (int m = 0; m < PIECE_POWERS; m++)
                c[m] += (q[k] - middle) * fit->power[k][m];
        for (int m = 0; m < PIECE_POWERS; m++)
            p->c[m] = c[m];
        p->c[0] += middle;
        p->cycles = first - floor(p->c[0] * ratio + first);
    }
}

/* The phase without whole cycles, -1/2 to 1/2. */
INLINE real fraction(double cycles)
{
    return (real)(cycles - floor(cycles + 0.5));
}

/* Sample coordinate and phase in cycles, in `wr`, of a chunk's entries. */
INLINE void delays(bool slow, const struct chunk *chunk, const struct delay_terms *terms, double offset)
{
    const struct bp_row_scratch *scratch = chunk->scratch;
    const int n = chunk->entries, first = scratch->groups[chunk->begin].first;
    const double *restrict leg = scratch->leg + first, *restrict ahead = scratch->ahead + first;
    double *restrict q = scratch->q;
    real *restrict wr = scratch->wr;
    const struct delay_terms own = *terms;
    const double fc = chunk->medium->fc, fs = chunk->medium->fs, t0 = chunk->raster->t0;
#pragma omp simd
    for (int i = 0; i < n; i++) {
        const double tau = delay(slow, &own, leg[i], ahead[i] + offset);
        q[i] = (tau - t0) * fs;
        wr[i] = fraction(fc * tau);
    }
}

/* The same from the receiver's polynomials, a vector of entries from each. */
INLINE void delays_of_pieces(const struct chunk *chunk)
{
    const struct bp_row_scratch *scratch = chunk->scratch;
    const int n = chunk->entries, first = scratch->groups[chunk->begin].first;
    const int *piece = scratch->piece + first / LANES;
    const double *restrict place = scratch->ahead + first;
    double *restrict q = scratch->q;
    real *restrict wr = scratch->wr;
    const double ratio = chunk->medium->fc / chunk->medium->fs;
    for (int i = 0; i < n; i += LANES) {
        const struct bp_polynomial *restrict p = &scratch->polynomials[*piece++];
#pragma omp simd
        for (int k = 0; k < LANES; k++) {
            double u = place[i + k], value = p->c[PIECE_POWERS - 1];
            for (int m = PIECE_POWERS - 2; m >= 0; m--)
                value = value * u + p->c[m];
            q[i + k] = value;
            wr[i + k] = fraction(value * ratio + p->cycles);
        }
    }
}

/* Weights exp(j 2 pi fc tau) of a chunk's entries from their phases; 0 where the gate is. A loop of its own, so that
   chains of several entries run at once. */
INLINE void phasors(const struct chunk *chunk)
{
    const struct bp_row_scratch *scratch = chunk->scratch;
    const int n = chunk->entries, first = scratch->groups[chunk->begin].first;
    const real *restrict gate = (const real *)scratch->gate + first;
    real *restrict wr = scratch->wr, *restrict wi = scratch->wi;
#pragma omp simd
    for (int i = 0; i < n; i++) {
        real cosine, sine;
        phasor(wr[i], &cosine, &sine);
        wr[i] = cosine * gate[i];
        wi[i] = sine * gate[i];
    }
}

void DELAYS_MAKE(const struct row_tables *tables, double offset, const struct chunk *chunk)
{
    if (tables->pieces > 0)
        delays_of_pieces(chunk);
    else if (tables->terms.slow)
        delays(true, chunk, &tables->terms, offset);
    else
        delays(false, chunk, &tables->terms, offset);
    phasors(chunk);
}
