/* The pixels of a line that are in pairs with a pulse (pairs.h). */
#include "backprojection/pairs/pairs.h"

#include <math.h>

#include "contract/delay.h"

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
   of large terms. True if pixels between them are the inside ones. */
static bool cone_roots(const struct cone *cone, const struct pixel_line *line, double root[2])
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
    return qa >= 0;
}

/* Append pixels [begin, end), behind the others. Only rounding can make a third span: it joins the second. */
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

/* Pixels, far more than the error of a root: from a pixel, or from the other root, where the error is largest. */
static const double NEAR_PIXEL = 0.125, APART = 8;

/* Pixels beside a root that is near one of them, or near the other root, are tested one by one, so that none is lost
   where the cone meets it exactly. Pixels between are all inside or all outside. */
int pair_spans(const struct acquisition *a, int ping, struct vector h, const struct pixel_line *line,
               struct pair_span spans[2])
{
    const int n = line->count;
    const struct cone cone = {a->tx[ping], h, a->aperture_limit};
    double root[2];
    int count = 0, next = 0; /* the first undecided pixel */
    if (!(cone.limit < 1)) {
        spans[0] = (struct pair_span){0, n};
        return 1;
    }
    const bool between = cone_roots(&cone, line, root), none = isnan(root[0]);
    for (int k = 0; k < 3; k++) {
        const bool met = k < 2 && root[k] > -2 && root[k] < n + 1.0;
        if (k < 2 && !met)
            continue;
        const double at = met ? root[k] : n, whole = floor(at), rest = at - whole;
        const bool clear = rest > NEAR_PIXEL && rest < 1 - NEAR_PIXEL && root[1] - root[0] > APART;
        const int begin = met ? pixel_between(clear ? whole + 1 : whole - 1, next, n) : n;
        const int end = met ? pixel_between(clear ? whole + 1 : whole + 3, begin, n) : n;
        const int middle = next + (begin - next) / 2;
        if (next < begin
            && (none ? inside_cone(&cone, line, middle) : between == ((root[0] < middle) != (root[1] < middle))))
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
   pixels beside the root in closed form are tested first, before a search. */
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
