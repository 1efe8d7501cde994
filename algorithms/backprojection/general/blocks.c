/* Blocks of pixels and the error of their quintics (general/blocks.h).

   Along a line, the two-way path L = c tau of a resting sonar is a sum of two distances sqrt(d^2 + s^2), whose sixth
   derivatives stay below 45/rho^5 each, rho the least distance (Gegenbauer: 6!/16). The receivers' motion, B = V/c,
   makes the second leg a norm of an argument that is itself curved; Faa di Bruno's formula with the bounds of the
   norm's derivatives gives at most 90 F/rho^5 together, F = ((1 + B)/(1 - B))^4. Interpolation at the six Chebyshev
   points of a block of half length h errs by at most max|L^(6)| h^6/(6! 2^5) = F h^6/(256 rho^5), and the phase by 2 pi
   fc/c times that: h = (256 rho^5 limit c/(2 pi fc F))^(1/6) keeps it below `limit`, and the error falls as h^6. */
#include "backprojection/general/blocks.h"

#include <math.h>

enum { EXACT = 64 }; /* pixels that are evaluated one by one before a block is tried again */

/* Comparisons, as fmin and fmax are calls. */
static double lesser(double a, double b)
{
    return a < b ? a : b;
}

static double greater(double a, double b)
{
    return a > b ? a : b;
}

/* Distance between two intervals. */
static double gap(double low_a, double high_a, double low_b, double high_b)
{
    return greater(0, greater(low_b - high_a, low_a - high_b));
}

/* Largest distance between a point and an interval. */
static double span(double low, double high, double point)
{
    return greater(fabs(point - low), fabs(point - high));
}

static double length(double x, double y, double z)
{
    return sqrt(x * x + y * y + z * z);
}

double ping_box_clearance(const struct ping_box *box, const struct pixel_line *line, int begin, int end)
{
    struct vector a = line_pixel(line, begin), b = line_pixel(line, end - 1);
    return length(gap(box->low.x, box->high.x, a.x, b.x), gap(box->low.y, box->high.y, a.y, b.y),
                  gap(box->low.z, box->high.z, 0, 0));
}

static double extent(const struct ping_box *box, struct vector p)
{
    return length(span(box->low.x, box->high.x, p.x), span(box->low.y, box->high.y, p.y),
                  span(box->low.z, box->high.z, 0));
}

double ping_box_extent(const struct ping_box *box, const struct pixel_line *line, int begin, int end)
{
    return greater(extent(box, line_pixel(line, begin)), extent(box, line_pixel(line, end - 1)));
}

static void include(struct ping_box *box, struct vector p)
{
    box->low = (struct vector){lesser(box->low.x, p.x), lesser(box->low.y, p.y), lesser(box->low.z, p.z)};
    box->high = (struct vector){greater(box->high.x, p.x), greater(box->high.y, p.y), greater(box->high.z, p.z)};
}

struct ping_box ping_box_make(const struct acquisition *a, int ping, int patch_count, const struct grid *patches,
                              double phase_limit)
{
    const double c = a->sound_speed;
    struct vector v = a->velocity[ping];
    const struct vector *rx = a->rx + (size_t)ping * (size_t)a->receivers;
    struct ping_box box = {a->tx[ping], a->tx[ping], 0, 0};
    for (int m = 0; m < a->receivers; m++)
        include(&box, rx[m]);
    double furthest = 0, mach = length(v.x, v.y, v.z) / c;
    for (int k = 0; k < patch_count; k++)
        for (int i = 0; i<patches[k].r_count; i += patches[k].r_count> 1 ? patches[k].r_count - 1 : 1) {
            struct pixel_line row = grid_line(&patches[k], true, i);
            furthest = fmax(furthest, ping_box_extent(&box, &row, 0, row.count));
        }
    double longest = 2 * furthest / (c * (1 - mach)); /* s: no delay is longer */
    for (int m = 0; m < a->receivers; m++)
        include(&box, (struct vector){rx[m].x + v.x * longest, rx[m].y + v.y * longest, rx[m].z + v.z * longest});
    box.reach = pow(256 * phase_limit * c / (2 * M_PI * a->fc) * pow((1 - mach) / (1 + mach), 4), 1.0 / 6);
    box.longest = 0x1p18 * (1 - mach) * c / a->fc;
    return box;
}

struct ping_box ping_box_join(const struct ping_box *a, const struct ping_box *b)
{
    struct ping_box box = {a->low, a->high, lesser(a->reach, b->reach), lesser(a->longest, b->longest)};
    include(&box, b->low);
    include(&box, b->high);
    return box;
}

/* The longest block from `begin` on, in pixels: usually all of them. Else by the distance at its beginning, then by the
   least distance of its pixels, which is valid for any part of it. */
static int block_longest(const struct ping_box *box, const struct pixel_line *line, int begin, int end)
{
    double step = line->x_step > 0 ? line->x_step : line->r_step, whole = (end - begin - 1) * step;
    double half = whole / (2 * box->reach), rho = ping_box_clearance(box, line, begin, end);
    if (whole <= box->longest && half * half * half * half * half * half <= rho * rho * rho * rho * rho)
        return end - begin;
    for (int n = 0; n < 2; n++) {
        rho = ping_box_clearance(box, line, begin, n == 0 ? begin + 1 : end);
        double pixels = 1 + floor(fmin(2 * box->reach * pow(rho, 5.0 / 6), box->longest) / step);
        if (pixels < end - begin)
            end = begin + (int)pixels;
    }
    return end - begin;
}

double blocks_slope(const struct acquisition *a, int ping, const struct pixel_line *line, struct pair_span span)
{
    const struct vector tx = a->tx[ping], p = line_pixel(line, span.begin), q = line_pixel(line, span.end - 1);
    const double near = hypot(hypot(p.x - tx.x, p.y - tx.y), tx.z), far = hypot(hypot(q.x - tx.x, q.y - tx.y), tx.z);
    return 2 * fabs(far - near) / a->sound_speed / fmax(1, span.end - span.begin - 1);
}

int blocks_make(const struct ping_box *box, const struct pixel_line *line, struct pair_span *left,
                struct bp_block blocks[BP_BLOCKS])
{
    int count = 0;
    while (count < BP_BLOCKS && left->begin < left->end) {
        int rest = left->end - left->begin,
            most = box->reach > 0 ? block_longest(box, line, left->begin, left->end) : 0;
        bool exact = most < BP_BLOCK_LEAST;
        int parts = exact ? 1 : (rest + most - 1) / most;
        int pixels = !exact ? (rest + parts - 1) / parts : box->reach > 0 && rest > EXACT ? EXACT : rest;
        blocks[count++] =
            (struct bp_block){left->begin, left->begin + pixels, exact, {left->begin, left->begin + pixels}};
        left->begin += pixels;
    }
    return count;
}
