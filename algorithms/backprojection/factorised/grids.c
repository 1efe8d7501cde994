/* Polar grids of subapertures: the extent needed, their frequencies, the extent available (grids.h). */
#include "backprojection/factorised/grids.h"

#include <math.h>

#include "contract/delay.h"

static const double RESIDUAL_MOST = 1; /* frequencies of d along rho and along a line that is read, over B/c */
static const double SINE_MOST = 0.9;   /* off the axis */
static const double RADII_LEAST = 3;   /* rho over the subaperture's radius */
enum { PINGS_MOST = 64, BISECTIONS = 12, EDGE = 9, CLIPS = 8 };
/* Of a grid, and of one summed from records, whose every line is checked: larger grids are not made. */
enum { PLACES_MOST = 1 << 28, LINES_MOST = 1 << 20, RECORD_LINES_MOST = 1 << 13 };

static struct sector sector_none(void)
{
    return (struct sector){INFINITY, -INFINITY, INFINITY, -INFINITY};
}

static bool sector_is_empty(struct sector s)
{
    return !(s.rho_low <= s.rho_high && s.low <= s.high);
}

/* The place rho m away at s. */
static struct vector place_at(const struct tree *tree, const struct subaperture *part, int view, double rho, double s)
{
    double x, y;
    polar_turn_back(polar_axes(tree, view), rho * sqrt(fmax(0, 1 - s * s)), rho * s, &x, &y);
    return (struct vector){part->x + x, part->y + y, 0};
}

static double delay_of(const struct acquisition *a, int ping, int receiver, struct vector place)
{
    return delay_exact(a->tx[ping], a->rx[(size_t)ping * (size_t)a->receivers + (size_t)receiver], a->velocity[ping],
                       place, a->sound_speed);
}

/* s/m: greatest |dd/drho| and |dd/dt|, t across the ray, of a subaperture's pairs at a place. Only the outermost
   receivers of a ping along x and y count. */
static void slopes(const struct tree *tree, const struct subaperture *part, struct vector place, double *along,
                   double *across)
{
    const struct acquisition *a = tree->problem.acquisition;
    const double c = a->sound_speed, dx = place.x - part->x, dy = place.y - part->y, rho = hypot(dx, dy);
    const double step = 1e-4 * rho, ex = dx / rho * step, ey = dy / rho * step;
    const int pings = part->pings < PINGS_MOST ? part->pings : PINGS_MOST;
    *along = *across = rho > 0 ? 0 : INFINITY; /* no ray leads to the centre: fmax would drop its NaN */
    for (int n = 0; n < pings && rho > 0; n++) {
        const int p = part->ping + (pings > 1 ? (int)((long long)n * (part->pings - 1) / (pings - 1)) : 0);
        const struct vector *rx = a->rx + (size_t)p * (size_t)a->receivers;
        int ends[4] = {0};
        for (int m = 1; m < a->receivers; m++) {
            ends[0] = rx[m].x < rx[ends[0]].x ? m : ends[0];
            ends[1] = rx[m].x > rx[ends[1]].x ? m : ends[1];
            ends[2] = rx[m].y < rx[ends[2]].y ? m : ends[2];
            ends[3] = rx[m].y > rx[ends[3]].y ? m : ends[3];
        }
        for (int k = 0; k < 4; k++) {
            if (k > 0 && ends[k] == ends[k - 1])
                continue;
            const double out = delay_of(a, p, ends[k], (struct vector){place.x + ex, place.y + ey, 0});
            const double in = delay_of(a, p, ends[k], (struct vector){place.x - ex, place.y - ey, 0});
            const double left = delay_of(a, p, ends[k], (struct vector){place.x - ey, place.y + ex, 0});
            const double right = delay_of(a, p, ends[k], (struct vector){place.x + ey, place.y - ex, 0});
            *along = fmax(*along, fabs((out - in) / (2 * step) - 2 / c));
            *across = fmax(*across, fabs(left - right) / (2 * step));
        }
    }
}

/* Tangent of the angle between the ray and the lines that pixels lie on. */
static double tangent_of_pixels(double s)
{
    return fabs(s) / sqrt(fmax(1e-3, 1 - s * s));
}

/* The same for the lines of the next larger subaperture's image, rays from its centre. */
static double tangent_of_whole(const struct tree *tree, const struct subaperture *part, int view, double rho)
{
    const struct subaperture *whole = part->parent < 0 ? NULL : &tree->subapertures[part->parent];
    if (!whole || whole->polars[view].lines == 0)
        return 0;
    const double near = whole->polars[view].place_first * polar_step(tree, whole->level, view)->rho;
    return whole->radius / fmax(whole->radius, fmax(rho, near - whole->radius));
}

/* Cycles a metre of rho besides the signal's own, along a line of pixels. */
static double residual(const struct tree *tree, const struct subaperture *part, int view, double rho, double s)
{
    double along, across;
    slopes(tree, part, place_at(tree, part, view, rho, s), &along, &across);
    return tree->problem.acquisition->fc * (along + across * tangent_of_pixels(s));
}

static double residual_ends(const struct tree *tree, const struct subaperture *part, int view, double rho,
                            const struct sector *sector)
{
    const double middle = 0.5 * (sector->low + sector->high);
    return fmax(residual(tree, part, view, rho, middle),
                fmax(residual(tree, part, view, rho, sector->low), residual(tree, part, view, rho, sector->high)));
}

static double band(const struct tree *tree)
{
    return tree->band / tree->problem.acquisition->sound_speed;
}

/* Leave only directions inside the aperture limit: |m sin(theta + phi)| <= limit in the plane. */
static void limit_sector(const struct tree *tree, const struct subaperture *part, int view, struct sector *sector)
{
    const double limit = tree->problem.acquisition->aperture_limit;
    double along, across;
    polar_turn(polar_axes(tree, view), part->normal.x, part->normal.y, &along, &across);
    const double m = hypot(along, across), sign = across < 0 ? -1 : 1;
    if (!(limit < m))
        return;
    const double phi = atan2(sign * along, sign * across), widest = asin(limit / m);
    sector->low = fmax(sector->low, sin(fmax(-M_PI / 2, -widest - phi)));
    sector->high = fmin(sector->high, sin(fmin(M_PI / 2, widest - phi)));
}

/* The patch's rectangle in a view's axes about a centre. */
static struct sector sector_of_patch(const struct tree *tree, const struct subaperture *part, int view)
{
    const struct grid *grid = &tree->problem.patches[view / 2];
    const struct polar_axes axes = polar_axes(tree, view);
    double a[2], b[2];
    polar_turn(axes, grid->x_first - part->x, grid->r_first - part->y, &a[0], &b[0]);
    polar_turn(axes, grid->x_first + (grid->x_count - 1) * grid->x_step - part->x,
               grid->r_first + (grid->r_count - 1) * grid->r_step - part->y, &a[1], &b[1]);
    const double near = fmax(0, fmin(a[0], a[1])), far = fmax(a[0], a[1]), low = fmin(b[0], b[1]);
    const double high = fmax(b[0], b[1]);
    if (!(far > 0))
        return sector_none();
    struct sector sector = {hypot(near, fmax(0, fmax(low, -high))), hypot(far, fmax(fabs(low), fabs(high))), 0, 0};
    sector.low = low == 0 ? 0 : low / hypot(low < 0 ? near : far, low);
    sector.high = high == 0 ? 0 : high / hypot(high < 0 ? far : near, high);
    sector.low = fmax(sector.low, -SINE_MOST);
    sector.high = fmin(sector.high, SINE_MOST);
    return sector;
}

struct sector sector_of_pixels(const struct tree *tree, const struct subaperture *part, int view)
{
    struct sector sector = sector_of_patch(tree, part, view);
    if (sector_is_empty(sector))
        return sector;
    limit_sector(tree, part, view, &sector);
    sector.rho_low = fmax(sector.rho_low, RADII_LEAST * part->radius);
    if (sector_is_empty(sector) || !(sector.rho_low > 0))
        return sector_none();
    const double most = RESIDUAL_MOST * band(tree);
    if (residual_ends(tree, part, view, sector.rho_low, &sector) <= most)
        return sector;
    if (!(residual_ends(tree, part, view, sector.rho_high, &sector) <= most))
        return sector_none();
    double low = sector.rho_low, high = sector.rho_high;
    for (int n = 0; n < BISECTIONS; n++) {
        const double middle = sqrt(low * high);
        if (residual_ends(tree, part, view, middle, &sector) <= most)
            high = middle;
        else
            low = middle;
    }
    sector.rho_low = high;
    return sector;
}

struct sector sector_join(struct sector a, struct sector b)
{
    if (sector_is_empty(a) || sector_is_empty(b))
        return sector_is_empty(a) ? b : a;
    return (struct sector){fmin(a.rho_low, b.rho_low), fmax(a.rho_high, b.rho_high), fmin(a.low, b.low),
                           fmax(a.high, b.high)};
}

struct sector sector_of_grid(const struct tree *tree, const struct subaperture *part, const struct subaperture *whole,
                             int view)
{
    const struct polar *polar = &whole->polars[view];
    const struct polar_step *step = polar_step(tree, whole->level, view);
    const double near = polar->place_first * step->rho, low = polar->line_first * step->sine;
    const double deep = (polar->places - 1) * step->rho, wide = (polar->lines - 1) * step->sine;
    struct sector sector = sector_none();
    double dx, dy;
    if (polar->lines == 0)
        return sector;
    polar_turn(polar_axes(tree, view), whole->x - part->x, whole->y - part->y, &dx, &dy);
    for (int k = 0; k < 4 * EDGE; k++) { /* along the edges: a near one, a far one, both sides */
        const double t = (double)(k / 4) / (EDGE - 1), rho = near + deep * (k % 4 < 2 ? k % 2 : t);
        const double s = low + wide * (k % 4 < 2 ? t : k % 2);
        const double along = dx + rho * sqrt(fmax(0, 1 - s * s)), across = dy + rho * s, there = hypot(along, across);
        sector = sector_join(sector, (struct sector){there, there, across / there, across / there});
    }
    return sector;
}

void sector_rates(const struct tree *tree, const struct subaperture *part, int view, struct sector sector,
                  struct polar_step *step)
{
    enum { PLACES = 5 };
    const struct acquisition *a = tree->problem.acquisition;
    /* The law is of a flat band: the outermost pairs represent stretches of the aperture, not its ends. */
    const double pairs = (double)part->pings * a->receivers, cells = pairs > 1 ? pairs / (pairs - 1) : 1;
    for (int k = 0; k < PLACES * PLACES; k++) {
        const double rho = sector.rho_low * pow(sector.rho_high / sector.rho_low, (double)(k / PLACES) / (PLACES - 1));
        const double s = sector.low + (sector.high - sector.low) * (k % PLACES) / (PLACES - 1);
        const double tangent = fmax(tangent_of_pixels(s), tangent_of_whole(tree, part, view, rho));
        const double cosine = sqrt(fmax(1e-2, 1 - s * s));
        double along, across;
        slopes(tree, part, place_at(tree, part, view, rho, s), &along, &across);
        const double highest = a->fc + 0.5 * tree->band, rho_most = band(tree) + highest * (along + across * tangent);
        const double sine_most = highest * across * rho / cosine;
        step->rho = fmax(step->rho, 2 * rho_most * tree->range.oversampling);
        step->sine = fmax(step->sine, 2 * sine_most * cells * tree->angle.oversampling);
        step->tangent = fmax(step->tangent, tangent);
    }
}

/* Places that the taps need beyond those that are read, and one for rounding either way. */
static int margin_places(const struct tree *tree)
{
    return tree->range.taps / 2 + 3;
}

/* Lines: at the margin's places, a line that is read lies at other s. */
static int margin_lines(const struct tree *tree, const struct polar_step *step, double rho)
{
    const double turned = ceil(margin_places(tree) * step->rho * step->tangent / rho / step->sine);
    return tree->angle.taps / 2 + 1 + (int)fmin(turned, LINES_MOST);
}

/* The part of a grid that may be read: without its margins, which the taps need. */
static void grid_margins(const struct tree *tree, const struct polar_step *step, struct polar *polar)
{
    const int places = margin_places(tree);
    polar->near = (polar->place_first + places) * step->rho;
    polar->far = (polar->place_first + polar->places - 1 - places) * step->rho;
    const int lines = polar->near > 0 ? margin_lines(tree, step, polar->near) : 0;
    polar->low = (polar->line_first + lines) * step->sine;
    polar->high = (polar->line_first + polar->lines - 1 - lines) * step->sine;
    if (!(polar->near > 0 && polar->near < polar->far && polar->low <= polar->high))
        *polar = (struct polar){.lines = 0};
}

void grid_cover(const struct tree *tree, const struct polar_step *step, struct sector sector, struct polar *polar)
{
    *polar = (struct polar){.lines = 0};
    if (sector_is_empty(sector) || !(sector.rho_high < PLACES_MOST * step->rho && 1 < LINES_MOST * step->sine))
        return;
    /* One more than is read: rounding then does not decide on the sector's edges. */
    const int places = margin_places(tree) + 1, lines = margin_lines(tree, step, sector.rho_low) + 1;
    polar->place_first = (int)floor(sector.rho_low / step->rho) - places;
    polar->places = (int)ceil(sector.rho_high / step->rho) + places - polar->place_first + 1;
    polar->line_first = (int)floor(sector.low / step->sine) - lines;
    polar->lines = (int)ceil(sector.high / step->sine) + lines - polar->line_first + 1;
    if (polar->place_first < 1) {
        polar->places -= 1 - polar->place_first;
        polar->place_first = 1;
    }
    const int widest = (int)floor(SINE_WIDEST / step->sine);
    if (polar->line_first + polar->lines - 1 > widest)
        polar->lines = widest - polar->line_first + 1;
    if (polar->line_first < -widest) {
        polar->lines -= -widest - polar->line_first;
        polar->line_first = -widest;
    }
    grid_margins(tree, step, polar);
}

/* Leave places from `near` to `far`. */
static void grid_clip(const struct tree *tree, const struct polar_step *step, double near, double far,
                      struct polar *polar)
{
    const double last = fmin(polar->place_first + polar->places - 1, floor(far / step->rho));
    const double first = fmax(polar->place_first, ceil(near / step->rho));
    if (!(first < last)) {
        *polar = (struct polar){.lines = 0};
        return;
    }
    polar->place_first = (int)first;
    polar->places = (int)(last - first) + 1;
    grid_margins(tree, step, polar);
}

/* Delays rise along a ray: its ends decide. */
void grid_clip_records(const struct tree *tree, const struct subaperture *part, int view, struct polar *polar)
{
    const struct acquisition *a = tree->problem.acquisition;
    const struct polar_step *step = polar_step(tree, part->level, view);
    const double length = (a->samples - 1) / a->fs, slack = 1e-6 / a->fs;
    for (int n = 0; n < CLIPS && polar->lines > 0 && polar->lines <= RECORD_LINES_MOST; n++) {
        const double near = polar->place_first * step->rho, far = near + (polar->places - 1) * step->rho;
        double before = 0, behind = 0; /* s: greatest distance of delays outside of the records */
        for (int k = 0; k < polar->lines; k++) {
            const double s = (polar->line_first + k) * step->sine;
            const struct vector first = place_at(tree, part, view, near, s), last = place_at(tree, part, view, far, s);
            for (int p = part->ping; p < part->ping + part->pings; p++) {
                double least = INFINITY, most = 0;
                for (int m = 0; m < a->receivers; m++) {
                    const double early = delay_of(a, p, m, first), late = delay_of(a, p, m, last);
                    least = early < least ? early : least;
                    most = late > most ? late : most;
                }
                before = fmax(before, a->t0[p] + slack - least);
                behind = fmax(behind, most - (a->t0[p] + length - slack));
            }
        }
        if (before == 0 && behind == 0)
            return;
        const double most = 0.55 * a->sound_speed; /* a little more than the delays' slope */
        grid_clip(tree, step, near + most * before, far - most * behind, polar);
    }
    *polar = (struct polar){.lines = 0};
}

void grid_clip_parts(const struct tree *tree, const struct subaperture *part, int view, struct polar *polar)
{
    const struct polar_step *step = polar_step(tree, part->level, view);
    double near = polar->place_first * step->rho, far = near + (polar->places - 1) * step->rho;
    bool whole = true;
    for (int n = part->child; n < part->child + part->children && whole && polar->lines > 0; n++) {
        const struct subaperture *child = &tree->subapertures[n];
        const struct polar *from = &child->polars[view];
        double dx, dy;
        polar_turn(polar_axes(tree, view), part->x - child->x, part->y - child->y, &dx, &dy);
        for (int k = 0; k < polar->lines && whole; k++) {
            const double s = (polar->line_first + k) * step->sine, w = sqrt(fmax(0, 1 - s * s));
            const double along = dx * w + dy * s, across = dy * w - dx * s;
            near = fmax(near, -along + sqrt(fmax(0, from->near * from->near - across * across)));
            far = fmin(far, -along + sqrt(fmax(0, from->far * from->far - across * across)));
            for (int end = 0; end < 2; end++) {
                const double rho = end ? far : near, at = dy + rho * s, there = hypot(dx + rho * w, at);
                whole = whole && at >= from->low * there && at <= from->high * there;
            }
            whole = whole && from->lines > 0 && near < far;
        }
    }
    if (!whole)
        *polar = (struct polar){.lines = 0};
    else if (polar->lines > 0)
        grid_clip(tree, step, near, far, polar);
}
