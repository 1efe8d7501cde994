/* Image grids: parsing, checks, and whether a grid meets any record. */
#include <float.h>
#include <limits.h>
#include <math.h>

#include "contract/delay.h"
#include "text/number.h"
#include "scene/scene.h"

#define BYTES_MAX      0x1p40 /* of a patch in double */
#define ANGLE_MOST_DEG 89.9   /* as of a scene's image.angle */

/* One "first:step:count"; returns its end, NULL if it is not one. */
static const char *axis_parse(const char *text, double *first, double *step, int *count)
{
    long long number = 0;
    text = number_read(text, first);
    text = text && *text == ':' ? number_read(text + 1, step) : NULL;
    text = text && *text == ':' ? whole_read(text + 1, 1, INT_MAX, &number) : NULL;
    *count = (int)number;
    return text;
}

enum status grid_parse(const char *text, struct grid *grid)
{
    const char *rest = axis_parse(text, &grid->x_first, &grid->x_step, &grid->x_count);
    double degrees = 0;
    rest = rest && *rest == ',' ? axis_parse(rest + 1, &grid->r_first, &grid->r_step, &grid->r_count) : NULL;
    if (rest && *rest == ',') {
        rest = number_read(rest + 1, &degrees);
    }
    if (!rest || *rest || !(fabs(degrees) <= ANGLE_MOST_DEG)) {
        return status_set(STATUS_INVALID,
                          "grid '%.200s': must be xmin:xstep:xcount,rmin:rstep:rcount, lengths in m as "
                          "plain decimal numbers and counts from 1 to %d, and where axes are turned ,angle in degrees "
                          "up to %g",
                          text, INT_MAX, ANGLE_MOST_DEG);
    }
    grid->angle_rad = degrees * M_PI / 180;
    return grid_check(grid, "grid");
}

enum status grid_check(const struct grid *grid, const char *place)
{
    const struct {
        const char *name;
        double first, step;
        int count;
    } axes[] = {{"x", grid->x_first, grid->x_step, grid->x_count}, {"r", grid->r_first, grid->r_step, grid->r_count}};
    for (int i = 0; i < 2; i++) {
        const char *name = axes[i].name;
        double first = axes[i].first, step = axes[i].step, last = first + (axes[i].count - 1.0) * step;
        if (axes[i].count < 1) {
            return status_set(STATUS_INVALID, "%s: grid has %d pixels along %s, must be at least 1", place,
                              axes[i].count, name);
        }
        if (!(step > 0 && step <= COORDINATE_MAX_M)) {
            return status_set(STATUS_INVALID, "%s: grid step along %s is %g m, must be > 0 and <= %g m", place, name,
                              step, COORDINATE_MAX_M);
        }
        if (!(first >= -COORDINATE_MAX_M && last <= COORDINATE_MAX_M)) {
            return status_set(STATUS_INVALID, "%s: grid along %s spans %g to %g m, must stay within +-%g m", place,
                              name, first, last, COORDINATE_MAX_M);
        }
        if (!(fmax(fabs(first), fabs(last)) * 4 * DBL_EPSILON < step)) {
            return status_set(STATUS_INVALID,
                              "%s: grid step along %s is %g m, must be > %g m for pixels at %g m to "
                              "differ",
                              place, name, step, fmax(fabs(first), fabs(last)) * 4 * DBL_EPSILON, last);
        }
    }
    double pixels = (double)grid_pixels(grid), most = BYTES_MAX / sizeof(double complex);
    if (!(pixels <= most)) {
        return status_set(STATUS_INVALID, "%s: grid has %d x %d pixels, must be at most %.10g", place, grid->x_count,
                          grid->r_count, most);
    }
    return STATUS_OK;
}

enum { BLOCKS_MOST = 1 << 22 }; /* searched before a grid passes without proof: about a second */

/* The search in one pair and one patch; it keeps the delays met for the message. */
struct search {
    const struct acquisition *acquisition;
    const struct grid *grid;
    int ping;
    struct vector rx;
    double shortest_s, longest_s;
    int blocks; /* searched, of all pairs and patches */
};

/* The sample coordinate of the place in row i and column j, which may be fractional. */
static double sample_at(struct search *search, double i, double j)
{
    const struct acquisition *a = search->acquisition;
    const struct grid *grid = search->grid;
    struct vector p = grid_point(grid, i, j);
    double tau = delay_exact(a->tx[search->ping], search->rx, a->velocity[search->ping], p, a->sound_speed);
    search->shortest_s = fmin(search->shortest_s, tau);
    search->longest_s = fmax(search->longest_s, tau);
    return (tau - a->t0[search->ping]) * a->fs;
}

/* Does a pixel of rows i0..i1 and columns j0..j1 meet the record? A block is skipped only when no delay in it can.
   The delay is convex in the place (backprojection/pairs/pairs.c): none exceeds the longest at a corner, and none is
   below the middle's by more than that longest one is above it. That is true at any speed. */
static bool block_meets(struct search *search, int i0, int i1, int j0, int j1)
{
    const double last = search->acquisition->samples - 1;
    const double corner[] = {sample_at(search, i0, j0), sample_at(search, i0, j1), sample_at(search, i1, j0),
                             sample_at(search, i1, j1)};
    double most = -INFINITY;
    for (int k = 0; k < 4; k++) {
        if (corner[k] >= 0 && corner[k] <= last) {
            return true;
        }
        most = fmax(most, corner[k]);
    }
    if (i1 - i0 <= 1 && j1 - j0 <= 1) {
        return false;
    }
    double least = 2 * sample_at(search, 0.5 * ((double)i0 + i1), 0.5 * ((double)j0 + j1)) - most;
    double slack = 1e-6 + 1e-9 * fabs(most);
    if (!(most >= -slack && least <= last + slack)) {
        return false;
    }
    if (++search->blocks > BLOCKS_MOST) {
        return true;
    }
    int i = i0 + (i1 - i0) / 2, j = j0 + (j1 - j0) / 2;
    return (i1 - i0) * search->grid->r_step > (j1 - j0) * search->grid->x_step
               ? block_meets(search, i0, i, j0, j1) || block_meets(search, i + 1, i1, j0, j1)
               : block_meets(search, i0, i1, j0, j) || block_meets(search, i0, i1, j + 1, j1);
}

enum status grid_meets_records(const struct acquisition *acquisition, int patch_count, const struct grid *patches,
                               const char *place)
{
    const struct acquisition *a = acquisition;
    struct search search = {.acquisition = a, .shortest_s = INFINITY, .longest_s = -INFINITY};
    double first_s = INFINITY, last_s = -INFINITY;
    for (int p = 0; p < a->pings; p++) {
        first_s = fmin(first_s, a->t0[p]);
        last_s = fmax(last_s, a->t0[p] + (a->samples - 1) / a->fs);
        for (int m = 0; m < a->receivers; m++) {
            for (int k = 0; k < patch_count; k++) {
                search.grid = &patches[k];
                search.ping = p;
                search.rx = a->rx[(size_t)p * (size_t)a->receivers + (size_t)m];
                if (block_meets(&search, 0, patches[k].r_count - 1, 0, patches[k].x_count - 1)) {
                    return STATUS_OK;
                }
            }
        }
    }
    return status_set(STATUS_INVALID,
                      "%s: no pixel meets any record: delays of about %.6g to %.6g s, must lie in "
                      "the records' %.6g to %.6g s after emission (ranges in m, fs in Hz)",
                      place, search.shortest_s, search.longest_s, first_s, last_s);
}
