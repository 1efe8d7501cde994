/* Which pixel-pulse pairs an image sums (pairs.h). */
#include "pairs.h"

#include <math.h>

#include "delay.h"

static double row_r(const struct grid *grid, int i)
{
    return grid->r_first + i * grid->r_step;
}

/* |sin theta_t| <= limit, from the transmitter at emission to the pixel. */
static bool inside_aperture(struct vector tx, struct vector heading, double limit, double x, double r)
{
    double dx = x - tx.x, dy = r - tx.y, dz = -tx.z;
    double along = dx * heading.x + dy * heading.y + dz * heading.z;
    return fabs(along) <= limit * sqrt(dx * dx + dy * dy + dz * dz);
}

/* Rows of a column inside the aperture, at most two spans. The limit is a double cone about the heading, so its edge
   meets the column where a quadratic in r vanishes; the predicate decides the rows beside each root. */
int pair_spans(const struct acquisition *a, int ping, struct vector h, const struct grid *grid, double x,
                          struct pair_span spans[2])
{
    int n = grid->r_count;
    double limit = a->aperture_limit;
    if (!(limit < 1)) {
        spans[0] = (struct pair_span){0, n};
        return 1;
    }
    struct vector tx = a->tx[ping];
    double dx = x - tx.x, along = dx * h.x - tx.z * h.z - tx.y * h.y, s2 = limit * limit;
    double qa = h.y * h.y - s2, qb = 2 * (along * h.y + s2 * tx.y);
    double qc = along * along - s2 * (dx * dx + tx.y * tx.y + tx.z * tx.z);
    double discriminant = qb * qb - 4 * qa * qc, root[2] = {NAN, NAN};
    if (fabs(qa) <= 1e-12) {
        root[0] = root[1] = -qc / qb;
    } else if (discriminant > 0) {
        double q = -0.5 * (qb + copysign(sqrt(discriminant), qb)), r1 = q / qa, r2 = q != 0 ? qc / q : r1;
        root[0] = fmin(r1, r2);
        root[1] = fmax(r1, r2);
    }
    int edge[4] = {0, 0, 0, n};     /* the predicate is constant between edges */
    for (int k = 0; k < 2; k++) {
        double row = ceil((root[k] - grid->r_first) / grid->r_step);
        edge[k + 1] = !(row > 0) ? 0 : row > n ? n : (int)row;
    }
    int count = 0;
    for (int k = 0; k < 3; k++) {
        int begin = edge[k], end = edge[k + 1];
        if (begin >= end || !inside_aperture(tx, h, limit, x, row_r(grid, begin + (end - begin) / 2)))
            continue;
        while (begin < end && !inside_aperture(tx, h, limit, x, row_r(grid, begin)))
            begin++;
        while (end > begin && !inside_aperture(tx, h, limit, x, row_r(grid, end - 1)))
            end--;
        while (begin > (count ? spans[count - 1].end : 0) && inside_aperture(tx, h, limit, x, row_r(grid, begin - 1)))
            begin--;
        while (end < n && inside_aperture(tx, h, limit, x, row_r(grid, end)))
            end++;
        if (count && begin <= spans[count - 1].end)
            spans[count - 1].end = end;
        else
            spans[count++] = (struct pair_span){begin, end};
    }
    return count;
}

/* The sample coordinate of one pair along a column, as a function of the row. It is convex: the delay is a norm of an
   affine map of (r, T), rising with T = |tx - p|/c, itself convex in r. */
struct column {
    const struct acquisition *acquisition;
    const struct grid *grid;
    int ping, receiver;
    double x;
};

static double column_q(const struct column *column, int i)
{
    const struct acquisition *a = column->acquisition;
    struct vector p = {column->x, row_r(column->grid, i), 0};
    double tau = delay_exact(a->tx[column->ping], a->rx[(size_t)column->ping * a->receivers + column->receiver],
                             a->velocity[column->ping], p, a->sound_speed);
    return (tau - a->t0[column->ping]) * a->fs;
}

/* The first row of [begin, end) with q > bound (rising) or q < bound (falling side: q <= bound is wanted there). */
static int column_cross(const struct column *column, int begin, int end, bool rising, double bound, bool inclusive)
{
    while (begin < end) {
        int middle = begin + (end - begin) / 2;
        double q = column_q(column, middle);
        bool above = inclusive ? q >= bound : q > bound;
        if (above == rising)
            end = middle;
        else
            begin = middle + 1;
    }
    return begin;
}

/* How many rows of [begin, end) have their delay inside the record. */
static int rows_in_record(const struct column *column, int begin, int end)
{
    double last = column->acquisition->samples - 1;
    int low = begin, high = end - 1;    /* the lowest q: where the slope turns */
    if (end - begin > 1 && column_q(column, begin + 1) >= column_q(column, begin))
        high = begin;
    else if (end - begin > 1 && column_q(column, end - 2) >= column_q(column, end - 1))
        low = end - 1;
    while (low < high) {
        int middle = low + (high - low) / 2;
        if (column_q(column, middle + 1) >= column_q(column, middle))
            high = middle;
        else
            low = middle + 1;
    }
    int count = 0;
    if (low < end) {                    /* rising side [low, end) */
        bool whole = column_q(column, low) >= 0 && column_q(column, end - 1) <= last;
        count += whole ? end - low
                       : column_cross(column, low, end, true, last, false) - column_cross(column, low, end, true, 0, true);
    }
    if (low > begin) {                  /* falling side [begin, low) */
        bool whole = column_q(column, low - 1) >= 0 && column_q(column, begin) <= last;
        count += whole ? low - begin : column_cross(column, begin, low, false, 0, true)
                                       - column_cross(column, begin, low, false, last, false);
    }
    return count;
}

double pairs_count(const struct problem *problem)
{
    const struct acquisition *a = problem->acquisition;
    double pairs = 0;
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *grid = &problem->patches[k];
#pragma omp parallel for schedule(dynamic) reduction(+ : pairs)
        for (int j = 0; j < grid->x_count; j++) {
            double x = grid->x_first + j * grid->x_step;
            for (int p = 0; p < a->pings; p++) {
                struct pair_span spans[2];
                int count = pair_spans(a, p, acquisition_heading(a, p), grid, x, spans);
                for (int m = 0; m < a->receivers; m++) {
                    struct column column = {a, grid, p, m, x};
                    for (int s = 0; s < count; s++)     /* whole numbers below 2^53: the order does not matter */
                        pairs += rows_in_record(&column, spans[s].begin, spans[s].end);
                }
            }
        }
    }
    return pairs;
}

double problem_pixels(const struct problem *problem)
{
    double pixels = 0;
    for (int k = 0; k < problem->patch_count; k++)
        pixels += (double)problem->patches[k].x_count * problem->patches[k].r_count;
    return pixels;
}
