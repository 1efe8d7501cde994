/* Which pixels read which subaperture's image (tree.h). */
#include <math.h>

#include "backprojection/factorised/tree.h"

/* Reduce a span to pixels between two real numbers. */
static struct pair_span whole_pixels(double first, double last, int count)
{
    const bool some = first <= last; /* and both are numbers */
    first = ceil(fmax(first, 0));
    last = floor(fmin(last, count - 1.0));
    return some && first <= last ? (struct pair_span){(int)first, (int)last + 1} : (struct pair_span){0, 0};
}

/* Leave distances rho from `near` to `far` that have slope rho <= value. */
static void leave_distances(double slope, double value, double *near, double *far)
{
    if (slope > 0)
        *far = fmin(*far, value / slope);
    else if (slope < 0)
        *near = fmax(*near, value / slope);
    else if (!(value >= 0)) /* 0, of either sign */
        *far = -INFINITY;
}

/* Pixels of a line along the axis that lie inside a grid: their distance changes monotonically on either side, and
   low <= across/rho <= high. */
static struct pair_span inside_grid(const struct tree *tree, const struct subaperture *part, int view,
                                    const struct pixel_line *line)
{
    const struct polar *polar = &part->polars[view];
    const struct polar_axes axes = polar_axes(tree, view);
    double along, across, near = polar->near, far = polar->far;
    if (polar->lines == 0)
        return (struct pair_span){0, 0};
    polar_turn(axes, line->x_first - part->x, line->r_first - part->y, &along, &across);
    leave_distances(polar->low, across, &near, &far);
    leave_distances(-polar->high, -across, &near, &far);
    const double away = fabs(across);
    if (!(near <= far && far > away))
        return (struct pair_span){0, 0};
    const double low = sqrt(fmax(0, near * near - away * away)), high = sqrt(far * far - away * away);
    const double step = axes.sign * (line->x_step + line->r_step);
    const double first = (low - along) / step, last = (high - along) / step;
    return whole_pixels(fmin(first, last), fmax(first, last), line->count);
}

/* Pixels inside the aperture limit of all its pings: inside the mean ping's cone, narrowed by the deviations of
   transmitters and normals. */
static int inside_limit(const struct tree *tree, const struct subaperture *part, int view,
                        const struct pixel_line *line, struct pair_span spans[2])
{
    const struct acquisition *a = tree->problem.acquisition;
    if (!(a->aperture_limit < 1)) {
        spans[0] = (struct pair_span){0, line->count};
        return 1;
    }
    const double away = hypot(part->tx.x - part->x, part->tx.y - part->y);
    const double least = part->polars[view].near - away;
    if (!(least > part->tx_radius))
        return 0;
    const double narrowed = asin(a->aperture_limit) - asin(part->tx_radius / least) - part->normal_radius;
    if (!(narrowed > 0))
        return 0;
    struct vector tx = part->tx;
    const struct acquisition mean = {.tx = &tx, .aperture_limit = sin(narrowed)};
    return pair_spans(&mean, 0, part->normal, line, spans);
}

/* The same cone widened: outside of it no pair counts. Reduces a span to its part inside. */
static void leave_limit(const struct tree *tree, const struct subaperture *part, const struct pixel_line *line,
                        struct pair_span span, struct spans *left)
{
    const struct acquisition *a = tree->problem.acquisition;
    const struct vector p = line_pixel(line, span.begin), q = line_pixel(line, span.end - 1);
    const double dx = fmax(0, fmax(fmin(p.x, q.x) - part->tx.x, part->tx.x - fmax(p.x, q.x)));
    const double dy = fmax(0, fmax(fmin(p.y, q.y) - part->tx.y, part->tx.y - fmax(p.y, q.y)));
    const double away = hypot(dx, dy);
    const double wide = a->aperture_limit < 1 && away > part->tx_radius
                            ? asin(a->aperture_limit) + asin(part->tx_radius / away) + part->normal_radius
                            : M_PI;
    struct pair_span limit[2] = {span};
    struct vector tx = part->tx;
    const struct acquisition mean = {.tx = &tx, .aperture_limit = sin(wide)};
    const int count = wide < M_PI / 2 ? pair_spans(&mean, 0, part->normal, line, limit) : 1;
    for (int k = 0; k < count; k++) {
        const int begin = limit[k].begin > span.begin ? limit[k].begin : span.begin;
        const int end = limit[k].end < span.end ? limit[k].end : span.end;
        if (begin < end)
            left->span[left->count++] = (struct pair_span){begin, end};
    }
}

/* Pixels that may be read from an image. */
static void readable(const struct tree *tree, const struct subaperture *part, int view, const struct pixel_line *line,
                     struct spans *spans)
{
    struct pair_span limit[2];
    const struct pair_span grid = inside_grid(tree, part, view, line);
    spans->count = 0;
    if (grid.begin >= grid.end)
        return;
    const int count = inside_limit(tree, part, view, line, limit);
    for (int k = 0; k < count; k++) {
        const int begin = limit[k].begin > grid.begin ? limit[k].begin : grid.begin;
        const int end = limit[k].end < grid.end ? limit[k].end : grid.end;
        if (begin < end)
            spans->span[spans->count++] = (struct pair_span){begin, end};
    }
}

/* Take `off` out of `spans`. Both are in rising order. */
static void take_off(struct spans *spans, const struct spans *off)
{
    for (int n = 0; n < off->count; n++) {
        struct spans left = {0};
        for (int k = 0; k < spans->count; k++) {
            const struct pair_span span = spans->span[k], hole = off->span[n];
            if (span.begin < hole.begin && span.begin < span.end)
                left.span[left.count++] = (struct pair_span){span.begin, span.end < hole.begin ? span.end : hole.begin};
            if (span.end > hole.end && span.begin < span.end)
                left.span[left.count++] = (struct pair_span){span.begin > hole.end ? span.begin : hole.end, span.end};
        }
        *spans = left;
    }
}

/* Remove pixels that read larger subapertures' images, of either side, from `from` on. */
static void take_off_larger(const struct tree *tree, int from, int patch, const struct pixel_line *line,
                            struct spans *spans)
{
    for (int n = from; n >= 0 && spans->count > 0; n = tree->subapertures[n].parent)
        for (int side = 0; side < 2; side++) {
            struct spans off;
            readable(tree, &tree->subapertures[n], 2 * patch + side, line, &off);
            take_off(spans, &off);
        }
}

void tree_pixels(const struct tree *tree, int subaperture, int view, const struct pixel_line *line, struct spans *spans)
{
    const struct subaperture *part = &tree->subapertures[subaperture];
    readable(tree, part, view, line, spans);
    take_off_larger(tree, part->parent, view / 2, line, spans);
}

void tree_direct(const struct tree *tree, int subaperture, int patch, const struct pixel_line *line,
                 struct spans *spans)
{
    spans->count = 1;
    spans->span[0] = (struct pair_span){0, line->count};
    take_off_larger(tree, subaperture, patch, line, spans);
    struct spans left = {0};
    for (int k = 0; k < spans->count; k++)
        leave_limit(tree, &tree->subapertures[subaperture], line, spans->span[k], &left);
    *spans = left;
}
