/* All pairs of a problem: their number, and the pings and samples that they read (pairs.h). */
#include "backprojection/pairs/pairs.h"

#include <math.h>

#include "backprojection/pairs/turned.h"
#include "common/fft_length.h"

static const double GOLDEN = 0.618; /* section */

/* m: the largest distance of a ping's receivers from its transmitter. */
static double receivers_apart(const struct acquisition *a, int ping)
{
    const struct vector tx = a->tx[ping], *rx = a->rx + (size_t)ping * (size_t)a->receivers;
    double most = 0;
    for (int m = 0; m < a->receivers; m++) {
        const double x = rx[m].x - tx.x, y = rx[m].y - tx.y, z = rx[m].z - tx.z;
        most = fmax(most, sqrt(x * x + y * y + z * z));
    }
    return most;
}

/* Bounds of the delays between a box of pixels, (x, r) to (x + width, r + depth), at least `least` m away, and a ping,
   by the nearest and the furthest place: a path is twice the transmitter's distance, up to the receiver's distance from
   the transmitter: `apart` m, and its motion since emission. */
struct delay_bounds {
    double least, most; /* s */
};

static struct delay_bounds box_delays(const struct acquisition *a, int ping, double apart, struct vector first,
                                      double width, double depth, double least)
{
    const struct vector tx = a->tx[ping], v = a->velocity[ping];
    const double x = first.x - tx.x, r = first.y - tx.y, end_x = x + width, end_r = r + depth;
    const double near_x = x > 0 ? x : fmin(end_x, 0), near_r = r > 0 ? r : fmin(end_r, 0);
    const double far_x = fmax(fabs(x), fabs(end_x)), far_r = fmax(fabs(r), fabs(end_r));
    const double near = fmax(least, sqrt(near_x * near_x + near_r * near_r + tx.z * tx.z));
    const double far = sqrt(far_x * far_x + far_r * far_r + tx.z * tx.z),
                 speed = sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
    return (struct delay_bounds){(2 * near - apart) / (a->sound_speed + speed),
                                 speed < a->sound_speed ? (2 * far + apart) / (a->sound_speed - speed) : INFINITY};
}

static struct delay_bounds line_delays(const struct acquisition *a, int ping, double apart,
                                       const struct pixel_line *line)
{
    const double length = line->count - 1.0;
    return box_delays(a, ping, apart, line_pixel(line, 0), length * line->x_step, length * line->r_step, 0);
}

/* May any delay lie inside a ping's records? */
static bool record_reached(const struct acquisition *a, int ping, struct delay_bounds delays)
{
    const double first = a->t0[ping], last = first + (a->samples - 1) / a->fs, slack = 1e-6 / a->fs;
    return !(delays.least > last + slack || delays.most < first - slack);
}

/* Do all certainly lie inside? */
static bool record_holds(const struct acquisition *a, int ping, struct delay_bounds delays)
{
    const double first = a->t0[ping], last = first + (a->samples - 1) / a->fs;
    const double slack = 1e-3 / a->fs + 1e-9 * fabs(last);
    return delays.least > first + slack && delays.most < last - slack;
}

/* A step through `count` lines, by the golden section, that visits each line once, and soon comes near any. */
static int stride_of(int count)
{
    int stride = (int)(GOLDEN * count) + 1;
    while (common_divisor(stride, count) > 1)
        stride++;
    return stride;
}

/* The extent of a grid's pixels seen from a ping: along its normal, and beside it. */
struct seen {
    double nearest, along, beside; /* m; the least along the normal, on either side, and the most */
};

/* Distances along the normal are linear, those beside it convex: the corners bound both. */
static struct seen grid_seen(const struct grid *grid, struct vector tx, struct vector normal)
{
    struct seen seen = {0, 0, 0};
    double ahead = INFINITY, behind = INFINITY;
    for (int k = 0; k < 4; k++) {
        const double x = grid->x_first + (k % 2 ? (grid->x_count - 1) * grid->x_step : 0) - tx.x;
        const double r = grid->r_first + (k / 2 ? (grid->r_count - 1) * grid->r_step : 0) - tx.y;
        const double along = x * normal.x + r * normal.y - tx.z * normal.z;
        ahead = fmin(ahead, along);
        behind = fmin(behind, -along);
        seen.along = fmax(seen.along, fabs(along));
        seen.beside = fmax(seen.beside, sqrt(fmax(0, x * x + r * r + tx.z * tx.z - along * along)));
    }
    seen.nearest = fmax(0, fmax(ahead, behind));
    return seen;
}

/* m: the most along the normal inside an aperture, of pixels up to `beside` m off it. */
static double aperture_edge(const struct acquisition *a, double beside)
{
    const double limit = a->aperture_limit;
    return limit < 1 ? beside * limit / sqrt((1 - limit) * (1 + limit)) : INFINITY;
}

/* May any pixel lie inside a ping's aperture and records? Inside the aperture a pixel is at least the distance along
   the normal over the limit away. */
static bool grid_reached(const struct acquisition *a, int ping, double apart, const struct grid *grid)
{
    const struct seen seen = grid_seen(grid, a->tx[ping], acquisition_normal(a, ping));
    const double near = seen.nearest > 0 ? seen.nearest / fmin(a->aperture_limit, 1) : 0;
    const struct delay_bounds delays =
        box_delays(a, ping, apart, (struct vector){grid->x_first, grid->r_first, 0}, (grid->x_count - 1) * grid->x_step,
                   (grid->r_count - 1) * grid->r_step, near);
    return !(seen.nearest > (1 + 1e-6) * aperture_edge(a, seen.beside) + 1e-9 * seen.along)
           && record_reached(a, ping, delays);
}

/* Each line once, the last one first: along x the aperture widens with the range, along r a ping sees only some
   lines. */
static bool ping_met(const struct problem *problem, int ping)
{
    const struct acquisition *a = problem->acquisition;
    const struct vector normal = acquisition_normal(a, ping);
    const double apart = receivers_apart(a, ping);
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *grid = &problem->patches[k];
        if (!grid_reached(a, ping, apart, grid))
            continue;
        const bool along_x = grid->x_count > grid->r_count;
        const int lines = grid_line_count(grid, along_x), stride = stride_of(lines);
        for (int left = lines, n = lines - 1; left > 0; left--, n = (int)(((long long)n + stride) % lines)) {
            const struct pixel_line line = grid_line(grid, along_x, n);
            struct pair_span spans[2];
            if (record_reached(a, ping, line_delays(a, ping, apart, &line))
                && pair_spans(a, ping, normal, &line, spans) > 0)
                return true;
        }
    }
    return false;
}

/* A ping beside one that is met also counts as met: engines round apertures in different ways. */
int pings_met(const struct problem *problem, bool *met)
{
    const int pings = problem->acquisition->pings;
    int count = 0;
#pragma omp parallel for schedule(dynamic, 16)
    for (int p = 0; p < pings; p++)
        met[p] = ping_met(problem, p);
    for (int p = 0, before = 0; p < pings; p++) {
        const bool now = met[p];
        met[p] = now || before || (p + 1 < pings && met[p + 1]);
        before = now;
        count += met[p];
    }
    return count;
}

/* m: the least distance of a grid, with pixels up to `beside` m off, from `at`, which may be displaced by `away` along
   each axis. */
static double grid_nearest(const struct grid *grid, struct vector at, struct vector away, double beside)
{
    const double last_x = grid->x_first + (grid->x_count - 1) * grid->x_step;
    const double last_r = grid->r_first + (grid->r_count - 1) * grid->r_step;
    const double x = fmax(0, fmax(grid->x_first - at.x, at.x - last_x) - fabs(away.x) - beside);
    const double r = fmax(0, fmax(grid->r_first - at.y, at.y - last_r) - fabs(away.y));
    const double z = fmax(0, fabs(at.z) - fabs(away.z));
    return sqrt(x * x + r * r + z * z);
}

/* Bounds of the delays inside a ping's records: ways out and back to where each receiver is at any time until the
   records end. Inside the aperture pixels are no further along the normal than beside it times the limit's tangent. */
static struct delay_bounds ping_delays(const struct acquisition *a, int ping, const struct grid *grid, double beside)
{
    const struct vector tx = a->tx[ping], v = a->velocity[ping], n = acquisition_normal(a, ping);
    const double longest = fmax(0, a->t0[ping] + (a->samples - 1) / a->fs);
    const struct vector way = {v.x * longest, v.y * longest, v.z * longest}, still = {0, 0, 0};
    const struct seen seen = grid_seen(grid, tx, n);
    const double along = fmin(seen.along, aperture_edge(a, seen.beside)) + beside;
    const double out = grid_nearest(grid, tx, still, beside);
    double least = INFINITY, most = 0;
    for (int m = 0; m < a->receivers; m++) {
        const struct vector rx = a->rx[(size_t)ping * (size_t)a->receivers + (size_t)m];
        const double x = rx.x - tx.x, y = rx.y - tx.y, z = rx.z - tx.z, ahead = x * n.x + y * n.y + z * n.z;
        const double aside = sqrt(fmax(0, x * x + y * y + z * z - ahead * ahead));
        const double moved = fabs(way.x * n.x + way.y * n.y + way.z * n.z);
        const double drift = sqrt(fmax(0, way.x * way.x + way.y * way.y + way.z * way.z - moved * moved));
        least = fmin(least, out + grid_nearest(grid, rx, way, beside));
        const double far_along = along + fabs(ahead) + moved, far_beside = seen.beside + aside + drift;
        most = fmax(most, sqrt(far_along * far_along + far_beside * far_beside));
    }
    most += sqrt(along * along + seen.beside * seen.beside);
    return (struct delay_bounds){least / a->sound_speed, most / a->sound_speed};
}

struct sample_span pairs_samples(const struct problem *problem, const bool *met, double beside)
{
    const struct acquisition *a = problem->acquisition;
    const double end = a->samples - 1;
    double first = INFINITY, last = -INFINITY;
    for (int p = 0; p < a->pings; p++)
        for (int k = 0; k < problem->patch_count && (!met || met[p]); k++) {
            const struct delay_bounds delays = ping_delays(a, p, &problem->patches[k], beside);
            if (!record_reached(a, p, delays))
                continue;
            const double slack = 1 + 1e-9 * fabs(a->t0[p]) * a->fs; /* samples: far more than rounding */
            first = fmin(first, (delays.least - a->t0[p]) * a->fs * (1 - 1e-9) - slack);
            last = fmax(last, (delays.most - a->t0[p]) * a->fs * (1 + 1e-9) + slack);
        }
    if (!(first <= last))
        return (struct sample_span){0, 0};
    return (struct sample_span){first > 0 ? fmin(first, end) : 0, last < end ? fmax(last, 0) : end};
}

/* Pixels of one span of an aperture. */
static struct pixel_line part_of(const struct pixel_line *line, struct pair_span span)
{
    const struct vector first = line_pixel(line, span.begin);
    return (struct pixel_line){first.x, first.y, line->x_step, line->r_step, span.end - span.begin};
}

/* Pairs of a ping along a line. Most apertures lie inside the records as a whole: then receivers need no test. */
static double line_pairs(const struct acquisition *a, int ping, double apart, const struct pixel_line *line)
{
    struct pair_span aperture[2], record[2];
    const int count = pair_spans(a, ping, acquisition_normal(a, ping), line, aperture);
    double pairs = 0;
    for (int s = 0; s < count; s++) {
        const struct pixel_line part = part_of(line, aperture[s]);
        const struct delay_bounds delays = line_delays(a, ping, apart, &part);
        if (!record_reached(a, ping, delays))
            continue;
        const bool held = record_holds(a, ping, delays);
        if (held)
            pairs += (double)a->receivers * (aperture[s].end - aperture[s].begin);
        for (int m = 0; m < a->receivers && !held; m++) {
            const int parts = record_spans(a, ping, m, line, aperture[s], record);
            for (int i = 0; i < parts; i++)
                pairs += record[i].end - record[i].begin;
        }
    }
    return pairs;
}

/* The time to count pairs line by line, in units of a line's aperture. Delays change little along rows, so that rarely
   one passes an end of the records; but there may be fewer columns. */
static double count_time(const struct acquisition *a, const struct grid *grid, bool along_x)
{
    enum { TRIED = 32 };
    static const double search = 8; /* for the ends of one record */
    const int ping = a->pings / 2, lines = grid_line_count(grid, along_x), tried = lines < TRIED ? lines : TRIED;
    const struct vector normal = acquisition_normal(a, ping);
    const double apart = receivers_apart(a, ping);
    int searched = 0;
    for (int k = 0; k < tried; k++) {
        const struct pixel_line line = grid_line(grid, along_x, (int)((long long)lines * k / tried));
        struct pair_span aperture[2];
        const int count = pair_spans(a, ping, normal, &line, aperture);
        for (int s = 0; s < count; s++) {
            const struct pixel_line part = part_of(&line, aperture[s]);
            searched += !record_holds(a, ping, line_delays(a, ping, apart, &part));
        }
    }
    return lines * (1 + search * a->receivers * searched / tried);
}

/* Pairs of a grid along x and r, in about the time of `most` lines' apertures: from all lines, or with each ping from
   some, which change from ping to ping. */
static double grid_pairs(const struct acquisition *a, const struct grid *grid, double most)
{
    const double rows = count_time(a, grid, true), columns = count_time(a, grid, false);
    const bool along_x = rows <= columns;
    const int lines = grid_line_count(grid, along_x);
    const int step = (int)fmax(1, fmin(lines, ceil(a->pings * fmin(rows, columns) / most)));
    double pairs = 0;
#pragma omp parallel for schedule(dynamic) reduction(+ : pairs)
    for (int p = 0; p < a->pings; p++) {
        const double apart = receivers_apart(a, p);
        if (!grid_reached(a, p, apart, grid))
            continue;
        const int first = (int)(fmod(GOLDEN * p, 1) * step), visited = (lines - first + step - 1) / step;
        double counted = 0;
        for (int n = first; n < lines; n += step) {
            const struct pixel_line line = grid_line(grid, along_x, n);
            counted += line_pairs(a, p, apart, &line);
        }
        pairs += rint(counted / visited * lines); /* whole numbers below 2^53: the order does not matter */
    }
    return pairs;
}

static double patches_pairs(const struct problem *problem, double most)
{
    double pairs = 0;
    for (int k = 0; k < problem->patch_count; k++) {
        struct problem patch = *problem;
        struct turned_problem turned;
        patch.patch_count = 1;
        patch.patches = &problem->patches[k];
        const bool fits = problem_turn_back(&patch, &turned, NULL) == STATUS_OK;
        pairs += fits ? grid_pairs(patch.acquisition, patch.patches, most) : NAN;
        turned_free(&turned);
    }
    return pairs;
}

double pairs_count(const struct problem *problem)
{
    return problem->estimate ? pairs_estimate(problem) : patches_pairs(problem, INFINITY);
}

double pairs_estimate(const struct problem *problem)
{
    static const double most = 1e6; /* lines' apertures: a fraction of a second */
    return patches_pairs(problem, most / problem->patch_count);
}

double problem_pixels(const struct problem *problem)
{
    double pixels = 0;
    for (int k = 0; k < problem->patch_count; k++)
        pixels += (double)grid_pixels(&problem->patches[k]);
    return pixels;
}
