/* Stratified sampling with a ratio estimator (Cochran, Sampling Techniques, 1977, sections 5A.11, 6.4 and 8.11):
   energies of the error and of the exact image are added up over the segments, each with the number of segments that
   it stands for. The brightest stand for themselves alone, so that an image of lone targets is measured as well as a
   field. The variance of the rest follows from the differences of neighbours in order of brightness. */
#include "imaging/probe.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/pairs/pairs.h"
#include "common/turns.h"
#include "echoes/echo_data.h"
#include "scene/random.h"
#include "imaging/imaging.h"
#include "metrics/metrics.h"

enum { LENGTH = 8, COUNT = PROBE_PIXELS / LENGTH, BRIGHT = 32, DRAWN = COUNT - BRIGHT, WHOLE = 2 * PROBE_PIXELS };
static const double DEVIATIONS = 2; /* of Student's distribution with some thirty degrees of freedom, at 95 % */

struct segment {
    double energy; /* LEFT_OUT where it does not count */
    size_t number; /* in order of the image: patches, rows, segments of a row */
};
static const double LEFT_OUT = -1;

static int segments_of_row(const struct grid *grid)
{
    return (grid->x_count + LENGTH - 1) / LENGTH;
}

/* First column of the k-th segment of a row; behind the last segment, the number of columns. */
static int segment_first(const struct grid *grid, int k)
{
    return (int)((long long)k * grid->x_count / segments_of_row(grid));
}

/* Does a segment meet the region, which may be narrower than it? */
static bool counts(const struct region *region, const struct grid *grid, int row, int first, int end)
{
    const struct vector middle = grid_point(grid, row, (first + end - 1) / 2.0);
    for (int k = 0; k < region->count; k++) {
        const struct grid *g = &region->grids[k];
        const struct vector place = grid_coordinates(g, middle.x, middle.y);
        const double width = (g->x_count - 1) * g->x_step, depth = (g->r_count - 1) * g->r_step;
        const double beside = ((end - first) * grid->x_step + g->x_step) / 2;
        if (fabs(place.x - g->x_first - width / 2) <= width / 2 + beside
            && fabs(place.y - g->r_first - depth / 2) <= (depth + g->r_step) / 2)
            return true;
    }
    return region->count == 0;
}

/* The segments of a row, the first of which has this number. */
static void row_fill(const struct image *pilot, int patch, int row, const struct region *region, size_t number,
                     struct segment *list)
{
    const struct grid *grid = &pilot->patches[patch];
    for (int k = 0; k < segments_of_row(grid); k++) {
        const int first = segment_first(grid, k), end = segment_first(grid, k + 1);
        double energy = counts(region, grid, row, first, end) ? 0 : LEFT_OUT;
        for (int j = first; j < end && energy >= 0; j++)
            energy += square(image_pixel(pilot, patch, row, j));
        list[k] = (struct segment){energy, number + (size_t)k};
    }
}

static struct probe_place place_of(const struct image *pilot, size_t number)
{
    int patch = 0;
    size_t each = (size_t)segments_of_row(&pilot->patches[0]);
    while (number >= each * (size_t)pilot->patches[patch].r_count) {
        number -= each * (size_t)pilot->patches[patch++].r_count;
        each = (size_t)segments_of_row(&pilot->patches[patch]);
    }
    return (struct probe_place){patch, (int)(number / each),
                                segment_first(&pilot->patches[patch], (int)(number % each)), 1};
}

/* Of equal ones, the first of the image. */
static bool brighter(const struct segment *one, const struct segment *other)
{
    return one->energy > other->energy || (one->energy == other->energy && one->number < other->number);
}

static void swap(struct segment *a, struct segment *b)
{
    const struct segment kept = *a;
    *a = *b;
    *b = kept;
}

/* Bring to their places, in order of brightness, those of the list whose ranks are wanted: ascending, counted from the
   whole list's begin. (Hoare's selection, of many ranks at once.) */
static void segments_select(struct segment *list, size_t begin, size_t end, const size_t *ranks, int wanted)
{
    while (wanted > 0 && end - begin > 1) {
        const struct segment middle = list[begin + (end - begin - 1) / 2];
        size_t low = begin, high = end - 1;
        for (;;) {
            while (brighter(&list[low], &middle))
                low++;
            while (brighter(&middle, &list[high]))
                high--;
            if (low >= high)
                break;
            swap(&list[low++], &list[high--]);
        }
        int lower = 0;
        while (lower < wanted && ranks[lower] <= high)
            lower++;
        if (lower == wanted) {
            end = high + 1;
            continue;
        }
        segments_select(list, begin, high + 1, ranks, lower);
        begin = high + 1;
        ranks += lower;
        wanted -= lower;
    }
}

/* The segments of an image that count: malloc'ed; NULL without memory. */
static struct segment *segments_make(const struct image *pilot, const struct region *region, size_t *count)
{
    size_t all = 0, begin = 0;
    for (int k = 0; k < pilot->patch_count; k++)
        all += (size_t)segments_of_row(&pilot->patches[k]) * (size_t)pilot->patches[k].r_count;
    struct segment *list = malloc(all * sizeof *list);
    *count = 0;
    for (int k = 0; k < pilot->patch_count && list; k++) {
        const size_t each = (size_t)segments_of_row(&pilot->patches[k]);
#pragma omp parallel for
        for (int i = 0; i < pilot->patches[k].r_count; i++) {
            const size_t first = begin + (size_t)i * each;
            row_fill(pilot, k, i, region, first, list + first);
        }
        begin += each * (size_t)pilot->patches[k].r_count;
    }
    for (size_t k = 0; k < all && list; k++)
        if (list[k].energy >= 0)
            list[(*count)++] = list[k];
    return list;
}

/* How many are drawn up to a rank in order of brightness: half of them evenly over the ranks, since errors lie also
   where the pilot is dark, half evenly over their logarithm, since brightness falls by powers of the rank. */
static double drawn_until(double rank, double count)
{
    return DRAWN / 2.0 * (log(rank / BRIGHT) / log(count / BRIGHT) + (rank - BRIGHT) / (count - BRIGHT));
}

/* The rank up to which so many are drawn. */
static double rank_at(int drawn, double count)
{
    double low = BRIGHT, high = count;
    for (int k = 0; k < 60 && drawn < DRAWN; k++) {
        const double middle = (low + high) / 2;
        *(drawn_until(middle, count) < drawn ? &low : &high) = middle;
    }
    return high;
}

/* The brightest, and of each stretch of the rest one at random, which stands for as many as the stretch is long. */
static void places_choose(const struct image *pilot, struct segment *list, size_t count, struct probe *probe)
{
    struct random random = random_seed(1, 0);
    size_t ranks[COUNT] = {0};
    probe->count = count <= COUNT ? (int)count : COUNT;
    const int bright = count <= COUNT ? (int)count : BRIGHT;
    for (int k = 0; k < bright; k++) {
        ranks[k] = (size_t)k;
        probe->places[k].stands_for = 1;
    }
    for (int k = bright; k < probe->count; k++) {
        const double low = rank_at(k - BRIGHT, (double)count), high = rank_at(k - BRIGHT + 1, (double)count);
        const size_t at = (size_t)(low + random_uniform(&random) * (high - low));
        ranks[k] = at < count ? at : count - 1;
        probe->places[k].stands_for = high - low;
    }
    segments_select(list, 0, count, ranks, probe->count);
    for (int k = 0; k < probe->count; k++) {
        const double stands_for = probe->places[k].stands_for;
        probe->places[k] = place_of(pilot, list[ranks[k]].number);
        probe->places[k].stands_for = stands_for;
    }
}

static struct grid grid_of(const struct grid *patch, const struct probe_place *place)
{
    struct grid grid = *patch;
    int k = 0;
    while (segment_first(patch, k) < place->column)
        k++;
    grid.x_first += place->column * grid.x_step;
    grid.x_count = segment_first(patch, k + 1) - place->column;
    grid.r_first += place->row * grid.r_step;
    grid.r_count = 1;
    return grid;
}

struct problem probe_problem(const struct probe *probe, const struct problem *problem)
{
    return problem_make(problem->acquisition, probe->count, probe->grids, problem->precision);
}

enum status probe_exact(const struct spec *exact, const struct problem *problem, const struct echoes *echoes,
                        struct probe *probe)
{
    struct problem part = probe_problem(probe, problem);
    struct image image;
    part.precision = exact->precision;
    const enum status status = imaging_form(exact, &part, echoes, &image, NULL);
    if (status == STATUS_OK) {
        image_free(&probe->exact);
        probe->exact = image;
    }
    return status;
}

static enum status segments_fill(const struct problem *problem, const struct image *pilot, const struct region *region,
                                 struct probe *probe)
{
    size_t count;
    struct segment *list = segments_make(pilot, region, &count);
    if (list && count == 0) { /* the image shows nothing of the region */
        free(list);
        list = segments_make(pilot, &(struct region){0, NULL}, &count);
    }
    *probe =
        (struct probe){.places = malloc(COUNT * sizeof *probe->places), .grids = malloc(COUNT * sizeof *probe->grids)};
    const bool made = list && probe->places && probe->grids;
    if (made)
        places_choose(pilot, list, count, probe);
    for (int k = 0; k < probe->count && made; k++)
        probe->grids[k] = grid_of(&problem->patches[probe->places[k].patch], &probe->places[k]);
    free(list);
    return made ? STATUS_OK : status_set(STATUS_FAILED, "no memory for the pixels that an error is measured on");
}

static enum status patches_take(const struct problem *problem, struct probe *probe)
{
    const size_t size = (size_t)problem->patch_count * sizeof *probe->grids;
    *probe = (struct probe){.whole = true, .count = problem->patch_count, .grids = malloc(size)};
    if (!probe->grids)
        return status_set(STATUS_FAILED, "no memory for %d patches", problem->patch_count);
    memcpy(probe->grids, problem->patches, size);
    return STATUS_OK;
}

enum status probe_make(const struct spec *exact, const struct problem *problem, const struct echoes *echoes,
                       const struct image *pilot, const struct region *region, struct probe *probe)
{
    const bool whole = problem_pixels(problem) <= WHOLE && region->count == 0;
    enum status status = whole ? patches_take(problem, probe) : segments_fill(problem, pilot, region, probe);
    if (status == STATUS_OK)
        status = probe_exact(exact, problem, echoes, probe);
    if (status != STATUS_OK)
        probe_free(probe);
    return status;
}

enum status probe_join(struct probe *all, struct probe *part, const struct pixel_window *window)
{
    const size_t had = (size_t)all->count, more = (size_t)part->count, count = had + more;
    struct probe_place *places = realloc(all->places, count * sizeof *places);
    all->places = places ? places : all->places;
    struct grid *grids = realloc(all->grids, count * sizeof *grids);
    all->exact.patches = all->grids = grids ? grids : all->grids;
    void **pixels = realloc(all->exact.pixels, count * sizeof *pixels);
    all->exact.pixels = pixels ? pixels : all->exact.pixels;
    if (!places || !grids || !pixels)
        return status_set(STATUS_FAILED, "no memory for the pixels that an error is measured on");
    for (size_t k = 0; k < more; k++) {
        places[had + k] = part->places[k];
        places[had + k].row += window->row;
        places[had + k].column += window->column;
        grids[had + k] = part->grids[k];
        pixels[had + k] = part->exact.pixels[k];
    }
    all->count = all->exact.patch_count = (int)count;
    all->exact.precision = part->exact.precision;
    part->exact.patch_count = 0; /* its pixels are the joined probe's */
    probe_free(part);
    return STATUS_OK;
}

void probe_free(struct probe *probe)
{
    image_free(&probe->exact);
    free(probe->places);
    free(probe->grids);
    *probe = (struct probe){0};
}

/* The compared images: of the whole, or of the segments alone. */
struct compared {
    const struct probe *probe;
    const struct image *image;
    bool segments;
};

static double complex compared_pixel(const struct compared *c, int k, int column)
{
    const struct probe_place *p = &c->probe->places[k];
    return c->segments ? image_pixel(c->image, k, 0, column)
                       : image_pixel(c->image, p->patch, p->row, p->column + column);
}

/* Energies of one segment: of the exact image, and of its difference to a gain times the image. */
struct energies {
    double exact, error;
};

static struct energies segment_energies(const struct compared *c, int k, double complex gain)
{
    struct energies sum = {0};
    for (int j = 0; j < c->probe->grids[k].x_count; j++) {
        const double complex exact = image_pixel(&c->probe->exact, k, 0, j);
        sum.exact += square(exact);
        sum.error += square(gain * compared_pixel(c, k, j) - exact);
    }
    return sum;
}

/* The gain that brings the image nearest to the exact one. */
static double complex best_gain(const struct compared *c)
{
    const struct probe *probe = c->probe;
    double complex cross = 0;
    double energy = 0;
    for (int k = 0; k < probe->count; k++) {
        const struct probe_place *p = &probe->places[k];
        for (int j = 0; j < probe->grids[k].x_count; j++) {
            const double complex value = compared_pixel(c, k, j);
            cross += p->stands_for * image_pixel(&probe->exact, k, 0, j) * conj(value);
            energy += p->stands_for * square(value);
        }
    }
    return energy > 0 ? cross / energy : 0;
}

static struct energies energies_sum(const struct compared *c, double complex gain)
{
    const struct probe *probe = c->probe;
    struct energies sum = {0};
    for (int k = 0; k < probe->count; k++) {
        const struct energies one = segment_energies(c, k, gain);
        sum.exact += probe->places[k].stands_for * one.exact;
        sum.error += probe->places[k].stands_for * one.error;
    }
    return sum;
}

/* The standard deviation of ln(error/exact), by the differences of neighbours among those that were drawn. */
static double deviation(const struct compared *c, double complex gain, const struct energies *sum)
{
    const struct probe *probe = c->probe;
    const double ratio = sum->error / sum->exact;
    double last = NAN, variance = 0;
    for (int k = 0; k < probe->count; k++) {
        const double all = probe->places[k].stands_for;
        if (all <= 1) /* one of the brightest, which stands for itself */
            continue;
        const struct energies one = segment_energies(c, k, gain);
        const double residue = sqrt(all * (all - 1)) * (one.error - ratio * one.exact);
        if (!isnan(last))
            variance += (residue - last) * (residue - last) / 2;
        last = residue;
    }
    return sqrt(variance) / sum->error;
}

static struct probe_error measure(const struct compared *c)
{
    const struct probe *probe = c->probe;
    struct probe_error measured = {NAN, NAN, NAN, NAN, 0};
    for (int k = 0; k < probe->count; k++)
        measured.pixels += probe->grids[k].x_count * probe->grids[k].r_count;
    if (probe->whole) {
        const struct error_metrics whole = metrics_error(c->image, &probe->exact);
        measured.error = whole.error;
        measured.error_gain = measured.low = measured.high = whole.error_gain;
        return measured;
    }
    const double complex gain = best_gain(c);
    const struct energies plain = energies_sum(c, 1), best = energies_sum(c, gain);
    if (!(plain.exact > 0 && isfinite(plain.exact) && isfinite(plain.error)))
        return measured;
    measured.error = sqrt(plain.error / plain.exact);
    measured.error_gain = sqrt(best.error / best.exact);
    const double wide = best.error > 0 ? exp(DEVIATIONS / 2 * deviation(c, gain, &best)) : 1;
    measured.low = measured.error_gain / wide;
    measured.high = measured.error_gain * wide;
    return measured;
}

struct probe_error probe_measure(const struct probe *probe, const struct image *image)
{
    return measure(&(struct compared){probe, image, false});
}

struct probe_error probe_measure_pixels(const struct probe *probe, const struct image *pixels)
{
    return measure(&(struct compared){probe, pixels, true});
}
