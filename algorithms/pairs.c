/* Which pixel-pulse pairs an image sums (pairs.h). */
#include "pairs.h"

#include <math.h>

#include "delay.h"

int grid_line_count(const struct grid *grid, bool along_x)
{
    return along_x ? grid->r_count : grid->x_count;
}

struct pixel_line grid_line(const struct grid *grid, bool along_x, int number)
{
    if (along_x)
        return (struct pixel_line){grid->x_first, grid->r_first + number * grid->r_step, grid->x_step, 0, grid->x_count};
    return (struct pixel_line){grid->x_first + number * grid->x_step, grid->r_first, 0, grid->r_step, grid->r_count};
}

struct vector line_pixel(const struct pixel_line *line, int i)
{
    return (struct vector){line->x_first + i * line->x_step, line->r_first + i * line->r_step, 0};
}

/* |sin theta_t| <= limit, from the transmitter at emission to the pixel. */
static bool inside_aperture(struct vector tx, struct vector heading, double limit, struct vector p)
{
    double dx = p.x - tx.x, dy = p.y - tx.y, dz = p.z - tx.z;
    double along = dx * heading.x + dy * heading.y + dz * heading.z;
    return fabs(along) <= limit * sqrt(dx * dx + dy * dy + dz * dz);
}

/* The limit is a double cone about the heading, so its edge meets the line where a quadratic in the way s from the first
   pixel vanishes; the predicate decides the pixels beside each root. */
int pair_spans(const struct acquisition *a, int ping, struct vector h, const struct pixel_line *line,
               struct pair_span spans[2])
{
    int n = line->count;
    double limit = a->aperture_limit;
    if (!(limit < 1)) {
        spans[0] = (struct pair_span){0, n};
        return 1;
    }
    struct vector tx = a->tx[ping];
    bool along_x = line->x_step > 0;
    double step = along_x ? line->x_step : line->r_step, dx = line->x_first - tx.x, dy = line->r_first - tx.y;
    double along = dx * h.x + dy * h.y - tx.z * h.z, slope = along_x ? h.x : h.y, s2 = limit * limit;
    double qa = slope * slope - s2, qb = 2 * (along * slope - s2 * (along_x ? dx : dy));
    double qc = along * along - s2 * (dx * dx + dy * dy + tx.z * tx.z);
    double discriminant = qb * qb - 4 * qa * qc, root[2] = {NAN, NAN};
    if (fabs(qa) <= 1e-12) {
        root[0] = root[1] = -qc / qb;
    } else if (discriminant > 0) {
        double q = -0.5 * (qb + copysign(sqrt(discriminant), qb)), s1 = q / qa, s2_ = q != 0 ? qc / q : s1;
        root[0] = fmin(s1, s2_);
        root[1] = fmax(s1, s2_);
    }
    int edge[4] = {0, 0, 0, n};     /* the predicate is constant between edges */
    for (int k = 0; k < 2; k++) {
        double pixel = ceil(root[k] / step);
        edge[k + 1] = !(pixel > 0) ? 0 : pixel > n ? n : (int)pixel;
    }
#define INSIDE(i) inside_aperture(tx, h, limit, line_pixel(line, i))
    int count = 0;
    for (int k = 0; k < 3; k++) {
        int begin = edge[k], end = edge[k + 1];
        if (begin >= end || !INSIDE(begin + (end - begin) / 2))
            continue;
        while (begin < end && !INSIDE(begin))
            begin++;
        while (end > begin && !INSIDE(end - 1))
            end--;
        while (begin > (count ? spans[count - 1].end : 0) && INSIDE(begin - 1))
            begin--;
        while (end < n && INSIDE(end))
            end++;
        if (count && begin <= spans[count - 1].end)
            spans[count - 1].end = end;
        else
            spans[count++] = (struct pair_span){begin, end};
    }
#undef INSIDE
    return count;
}

/* The sample coordinate of one pair along a line, as a function of the pixel. It is convex: the delay is a norm of an
   affine map of (place, T), rising with T = |tx - p|/c, itself convex in the place. */
struct profile {
    const struct acquisition *acquisition;
    const struct pixel_line *line;
    int ping, receiver;
};

static double profile_q(const struct profile *profile, int i)
{
    const struct acquisition *a = profile->acquisition;
    double tau = delay_exact(a->tx[profile->ping], a->rx[(size_t)profile->ping * a->receivers + profile->receiver],
                             a->velocity[profile->ping], line_pixel(profile->line, i), a->sound_speed);
    return (tau - a->t0[profile->ping]) * a->fs;
}

/* The first pixel of [begin, end) with q > bound (rising) or q < bound (falling side: q <= bound is wanted there). */
static int profile_cross(const struct profile *profile, int begin, int end, bool rising, double bound, bool inclusive)
{
    while (begin < end) {
        int middle = begin + (end - begin) / 2;
        double q = profile_q(profile, middle);
        bool above = inclusive ? q >= bound : q > bound;
        if (above == rising)
            end = middle;
        else
            begin = middle + 1;
    }
    return begin;
}

int record_spans(const struct acquisition *a, int ping, int receiver, const struct pixel_line *line,
                 struct pair_span within, struct pair_span spans[2])
{
    const struct profile profile = {a, line, ping, receiver};
    const double last = a->samples - 1;
    int begin = within.begin, end = within.end, count = 0;
    int low = begin, high = end - 1;    /* the lowest q: where the slope turns */
    if (begin >= end)
        return 0;
    if (end - begin > 1 && profile_q(&profile, begin + 1) >= profile_q(&profile, begin))
        high = begin;
    else if (end - begin > 1 && profile_q(&profile, end - 2) >= profile_q(&profile, end - 1))
        low = end - 1;
    while (low < high) {
        int middle = low + (high - low) / 2;
        if (profile_q(&profile, middle + 1) >= profile_q(&profile, middle))
            high = middle;
        else
            low = middle + 1;
    }
    struct pair_span falling = {begin, low}, rising = {low, end};
    if (low > begin && !(profile_q(&profile, low - 1) >= 0 && profile_q(&profile, begin) <= last))
        falling = (struct pair_span){profile_cross(&profile, begin, low, false, last, false),
                                     profile_cross(&profile, begin, low, false, 0, true)};
    if (!(profile_q(&profile, low) >= 0 && profile_q(&profile, end - 1) <= last))
        rising = (struct pair_span){profile_cross(&profile, low, end, true, 0, true),
                                    profile_cross(&profile, low, end, true, last, false)};
    if (falling.end > falling.begin)
        spans[count++] = falling;
    if (rising.end > rising.begin) {
        if (count && falling.end == rising.begin)
            spans[0].end = rising.end;
        else
            spans[count++] = rising;
    }
    return count;
}

double pairs_count(const struct problem *problem)
{
    const struct acquisition *a = problem->acquisition;
    double pairs = 0;
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *grid = &problem->patches[k];
        const bool along_x = grid->x_count > grid->r_count;    /* few long lines: a search costs the same on any */
#pragma omp parallel for schedule(dynamic) reduction(+ : pairs)
        for (int n = 0; n < grid_line_count(grid, along_x); n++) {
            struct pixel_line line = grid_line(grid, along_x, n);
            for (int p = 0; p < a->pings; p++) {
                struct pair_span aperture[2], record[2];
                int count = pair_spans(a, p, acquisition_heading(a, p), &line, aperture);
                for (int m = 0; m < a->receivers; m++)
                    for (int s = 0; s < count; s++) {
                        int parts = record_spans(a, p, m, &line, aperture[s], record);
                        for (int i = 0; i < parts; i++)     /* whole numbers below 2^53: the order does not matter */
                            pairs += record[i].end - record[i].begin;
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
