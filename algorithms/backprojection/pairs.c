/* Which pixel-pulse pairs an image sums (pairs.h). */
#include "backprojection/pairs.h"

#include <math.h>

#include "common/delay.h"

int grid_line_count(const struct grid *grid, bool along_x)
{
    return along_x ? grid->r_count : grid->x_count;
}

struct pixel_line grid_line(const struct grid *grid, bool along_x, int number)
{
    if (along_x)
        return (struct pixel_line){grid->x_first, grid->r_first + number * grid->r_step, grid->x_step, 0,
                                   grid->x_count};
    return (struct pixel_line){grid->x_first + number * grid->x_step, grid->r_first, 0, grid->r_step, grid->r_count};
}

struct vector line_pixel(const struct pixel_line *line, int i)
{
    return (struct vector){line->x_first + i * line->x_step, line->r_first + i * line->r_step, 0};
}

/* The double cone |sin theta_t| <= limit about a normal, its apex the transmitter at emission. */
struct cone {
    struct vector tx, normal;
    double limit;
};

static bool inside_cone(const struct cone *cone, const struct pixel_line *line, int i)
{
    const struct vector p = line_pixel(line, i), tx = cone->tx, h = cone->normal;
    double dx = p.x - tx.x, dy = p.y - tx.y, dz = p.z - tx.z;
    double distance = sqrt(dx * dx + dy * dy + dz * dz);
    return fabs(dx * h.x + dy * h.y + dz * h.z) <= cone->limit * distance
           || distance <= apex_slack(fabs(p.x) + fabs(p.y), fabs(tx.x) + fabs(tx.y) + fabs(tx.z));
}

/* Where the line meets the cone, in pixels, the lesser first; NaN where it does not. Counted from the point nearest to
   the apex, where |along + slope s| = limit sqrt(s^2 + across^2) is a quadratic whose discriminant needs no difference
   of large terms. */
static void cone_roots(const struct cone *cone, const struct pixel_line *line, double root[2])
{
    const bool along_x = line->x_step > 0;
    const struct vector tx = cone->tx, h = cone->normal;
    const double dx = line->x_first - tx.x, dy = line->r_first - tx.y, across = along_x ? dy : dx;
    const double slope = along_x ? h.x : h.y, along = across * (along_x ? h.y : h.x) - tx.z * h.z;
    const double step = along_x ? line->x_step : line->r_step, foot = -(along_x ? dx : dy) / step;
    const double s2 = cone->limit * cone->limit, qa = slope * slope - s2, half = along * slope;
    const double across2 = across * across + tx.z * tx.z, qc = along * along - s2 * across2;
    double discriminant = s2 * (along * along + across2 * qa);
    if (discriminant < 0 && discriminant > -1e-12 * s2 * along * along)
        discriminant = 0; /* a tangent, but for rounding */
    const double q = -(half + copysign(sqrt(discriminant), half)), first = q / qa, second = q != 0 ? qc / q : first;
    root[0] = foot + fmin(first, second) / step;
    root[1] = foot + fmax(first, second) / step;
}

/* Add pixels [begin, end), which lie behind those there are. Only rounding can make a third span: it joins the
   second. */
static int span_add(struct pair_span spans[2], int count, int begin, int end)
{
    if (count == 2 || (count == 1 && spans[0].end == begin)) {
        spans[count - 1].end = end;
        return count;
    }
    spans[count] = (struct pair_span){begin, end};
    return count + 1;
}

/* `value`, a whole number, as a pixel of [least, most]. */
static int pixel_between(double value, int least, int most)
{
    return !(value > least) ? least : value < most ? (int)value : most;
}

/* In pixels, far more than a root errs by: from a pixel, or from the other root, where it errs most. */
static const double NEAR_PIXEL = 0.125, APART = 8;

/* Pixels beside a root that is near one of them, or near the other root, are asked one by one, so that none is lost
   where the cone meets it exactly; what lies between is all inside or all outside. */
int pair_spans(const struct acquisition *a, int ping, struct vector h, const struct pixel_line *line,
               struct pair_span spans[2])
{
    const int n = line->count;
    const struct cone cone = {a->tx[ping], h, a->aperture_limit};
    double root[2];
    int count = 0, next = 0; /* the first pixel that is not decided yet */
    if (!(cone.limit < 1)) {
        spans[0] = (struct pair_span){0, n};
        return 1;
    }
    cone_roots(&cone, line, root);
    for (int k = 0; k < 3; k++) {
        const bool met = k < 2 && root[k] > -2 && root[k] < n + 1.0;
        if (k < 2 && !met)
            continue;
        const double at = met ? root[k] : n, whole = floor(at), rest = at - whole;
        const bool clear = rest > NEAR_PIXEL && rest < 1 - NEAR_PIXEL && root[1] - root[0] > APART;
        const int begin = met ? pixel_between(clear ? whole + 1 : whole - 1, next, n) : n;
        const int end = met ? pixel_between(clear ? whole + 1 : whole + 3, begin, n) : n;
        if (next < begin && inside_cone(&cone, line, next + (begin - next) / 2))
            count = span_add(spans, count, next, begin);
        for (next = begin; next < end; next++)
            if (inside_cone(&cone, line, next))
                count = span_add(spans, count, next, next + 1);
    }
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

/* Where q passes `bound`, in pixels, on the rising or the falling side: a delay of D/c is an ellipsoid about
   transmitter and receiver at reception, |A| + |B| = D. A line meets it where 4 D^2 |B|^2 = (D^2 - (|A|^2 - |B|^2))^2,
   a quadratic as |A|^2 - |B|^2 is linear along the line. Negative where it does not. */
static double profile_root(const struct profile *profile, bool rising, double bound)
{
    const struct acquisition *a = profile->acquisition;
    const struct vector tx = a->tx[profile->ping], v = a->velocity[profile->ping];
    const struct vector rx = a->rx[(size_t)profile->ping * a->receivers + profile->receiver];
    const struct pixel_line *line = profile->line;
    const bool along_x = line->x_step > 0;
    const double step = along_x ? line->x_step : line->r_step, tau = a->t0[profile->ping] + bound / a->fs;
    const double d = a->sound_speed * tau, ax = line->x_first - tx.x, ar = line->r_first - tx.y, az = -tx.z;
    const double bx = line->x_first - (rx.x + v.x * tau), br = line->r_first - (rx.y + v.y * tau);
    const double bz = -(rx.z + v.z * tau), a0 = along_x ? ax : ar, b0 = along_x ? bx : br;
    /* With s metres along the line: |B|^2 = s^2 + 2 b0 s + bb, D^2 - (|A|^2 - |B|^2) = p + 2 g s. */
    const double bb = bx * bx + br * br + bz * bz, g = b0 - a0;
    const double p = d * d - (ax * ax + ar * ar + az * az) + bb;
    const double qa = d * d - g * g, half = b0 * d * d - 0.5 * p * g, qc = d * d * bb - 0.25 * p * p;
    const double square = half * half - qa * qc;
    if (!(qa > 1e-9 * d * d && square >= 0))
        return -2;
    return (rising ? -half + sqrt(square) : -half - sqrt(square)) / (qa * step);
}

/* The first pixel of [begin, end) with q > bound (rising) or q < bound (falling side: q <= bound is wanted there). The
   pixels beside the root in closed form are asked before it is searched for. */
static int profile_cross(const struct profile *profile, int begin, int end, bool rising, double bound, bool inclusive)
{
    const double root = begin < end ? floor(profile_root(profile, rising, bound)) : -2;
    for (int n = 0; begin < end; n++) {
        int middle = begin + (end - begin) / 2;
        if (n < 2 && root + n >= begin && root + n < end)
            middle = (int)root + n;
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
    int low = begin, high = end - 1; /* the lowest q: where the slope turns */
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

/* Bounds of the delays between `line` and a ping, by the nearest and the furthest pixel: a path is twice the
   transmitter's distance, but for what the receiver is away from the transmitter, `apart` m and the way since. */
struct delay_bounds {
    double least, most; /* s */
};

static struct delay_bounds line_delays(const struct acquisition *a, int ping, double apart,
                                       const struct pixel_line *line)
{
    const struct vector tx = a->tx[ping], v = a->velocity[ping];
    const double length = line->count - 1.0, x = line->x_first - tx.x, r = line->r_first - tx.y;
    const double end_x = x + length * line->x_step, end_r = r + length * line->r_step;
    const double near_x = x > 0 ? x : fmin(end_x, 0), near_r = r > 0 ? r : fmin(end_r, 0);
    const double far_x = fmax(fabs(x), fabs(end_x)), far_r = fmax(fabs(r), fabs(end_r));
    const double near = sqrt(near_x * near_x + near_r * near_r + tx.z * tx.z);
    const double far = sqrt(far_x * far_x + far_r * far_r + tx.z * tx.z),
                 speed = sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
    return (struct delay_bounds){(2 * near - apart) / (a->sound_speed + speed),
                                 speed < a->sound_speed ? (2 * far + apart) / (a->sound_speed - speed) : INFINITY};
}

/* May any delay lie inside a ping's records? */
static bool record_reached(const struct acquisition *a, int ping, struct delay_bounds delays)
{
    const double first = a->t0[ping], last = first + (a->samples - 1) / a->fs, slack = 1e-6 / a->fs;
    return !(delays.least > last + slack || delays.most < first - slack);
}

/* Do all lie inside, for sure? */
static bool record_holds(const struct acquisition *a, int ping, struct delay_bounds delays)
{
    const double first = a->t0[ping], last = first + (a->samples - 1) / a->fs;
    const double slack = 1e-3 / a->fs + 1e-9 * fabs(last);
    return delays.least > first + slack && delays.most < last - slack;
}

static int common_divisor(int a, int b)
{
    while (b > 0) {
        const int rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

/* A step through `count` lines, in golden section, that comes to each of them once, and soon near any. */
static int stride_of(int count)
{
    int stride = (int)(0.618 * count) + 1;
    while (common_divisor(stride, count) > 1)
        stride++;
    return stride;
}

/* Each line once, the last one first: along x the aperture widens with the range, along r pings see few of them. */
static bool ping_met(const struct problem *problem, int ping)
{
    const struct acquisition *a = problem->acquisition;
    const struct vector normal = acquisition_normal(a, ping);
    const double apart = receivers_apart(a, ping);
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *grid = &problem->patches[k];
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

/* A ping beside one that is met counts as met: engines round apertures in different ways. */
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

/* Where a grid's pixels are, seen from a ping: as far as they are along its normal, and beside it. */
struct seen {
    double along, beside; /* m, the most */
};

static struct seen grid_seen(const struct grid *grid, struct vector tx, struct vector normal)
{
    struct seen seen = {0, 0};
    for (int k = 0; k < 4; k++) {
        const double x = grid->x_first + (k % 2 ? (grid->x_count - 1) * grid->x_step : 0) - tx.x;
        const double r = grid->r_first + (k / 2 ? (grid->r_count - 1) * grid->r_step : 0) - tx.y;
        const double along = x * normal.x + r * normal.y - tx.z * normal.z;
        seen.along = fmax(seen.along, fabs(along));
        seen.beside = fmax(seen.beside, sqrt(fmax(0, x * x + r * r + tx.z * tx.z - along * along)));
    }
    return seen;
}

/* m: the least distance of a grid from `at`, which may be `away` from there along each axis, pixels `beside` m off
   among them. */
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
    const double longest = fmax(0, a->t0[ping] + (a->samples - 1) / a->fs), limit = a->aperture_limit;
    const struct vector way = {v.x * longest, v.y * longest, v.z * longest}, still = {0, 0, 0};
    const struct seen seen = grid_seen(grid, tx, n);
    const double edge = limit < 1 ? seen.beside * limit / sqrt((1 - limit) * (1 + limit)) : INFINITY;
    const double along = fmin(seen.along, edge) + beside, out = grid_nearest(grid, tx, still, beside);
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
            const double slack = 1 + 1e-9 * fabs(a->t0[p]) * a->fs; /* samples: far more than anything rounds */
            first = fmin(first, (delays.least - a->t0[p]) * a->fs * (1 - 1e-9) - slack);
            last = fmax(last, (delays.most - a->t0[p]) * a->fs * (1 + 1e-9) + slack);
        }
    if (!(first <= last))
        return (struct sample_span){0, 0};
    return (struct sample_span){first > 0 ? fmin(first, end) : 0, last < end ? fmax(last, 0) : end};
}

/* Pairs of a ping along a line. Most lines lie inside the records as a whole, which spares the receivers. */
static double line_pairs(const struct acquisition *a, int ping, double apart, const struct pixel_line *line)
{
    struct pair_span aperture[2], record[2];
    const int count = pair_spans(a, ping, acquisition_normal(a, ping), line, aperture);
    const bool held = record_holds(a, ping, line_delays(a, ping, apart, line));
    double pairs = 0;
    for (int s = 0; s < count; s++) {
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

double pairs_count(const struct problem *problem)
{
    const struct acquisition *a = problem->acquisition;
    double pairs = 0;
#pragma omp parallel for schedule(dynamic) reduction(+ : pairs)
    for (int p = 0; p < a->pings; p++) {
        const double apart = receivers_apart(a, p);
        for (int k = 0; k < problem->patch_count; k++) {
            const struct grid *grid = &problem->patches[k];
            const bool along_x = grid->x_count > grid->r_count; /* few long lines: a search costs the same on any */
            for (int n = grid_line_count(grid, along_x) - 1; n >= 0; n--) {
                const struct pixel_line line = grid_line(grid, along_x, n);
                pairs += line_pairs(a, p, apart, &line); /* whole numbers below 2^53: the order does not matter */
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
