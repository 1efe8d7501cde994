/* The azimuth of some targets at single frequencies (tone.h) against back projection's,  sum over p and m of
   s_pm exp(+j 2 pi F tau_m(x_p - x)).

   Columns and rows are the track's, also of turned patches. Rows need not be looked at: to a column, a row is a delay,
   and by Parseval's theorem the energies of all rows are those of all frequencies. Targets, rows and frequencies are
   taken in turn; their energies are summed as those of the image. */
#include "range_migration/azimuth.h"

#include <math.h>

#include "common/turns.h"
#include "range_migration/aliases.h"
#include "range_migration/tone.h"

enum {
    TARGETS = 4, /* of an image, on several rows of several patches where it has them */
    KNOWN = 6,   /* of those that are known, at most */
    TONES = 12,  /* frequencies of known targets, all together, two of each or more */
    COLUMNS = 13 /* evenly over the patch, and as many near the target */
};
/* Targets may have more than those that stand for them; a few columns and frequencies of all that are known may have
   less than all have. */
static const double FEW_TARGETS = 1.4, KNOWN_TARGETS = 1.2;
/* Beside those that stand for all there may be others, which squinted patches see more of: measured. */
static const double SQUINTED_TARGETS = 2;
static const double FREQUENCY = 0.57735; /* of half the band, to either side: Gauss and Legendre's two */
static const double NEAR = 4, DEEP = 0.05, APART = 1.4;

struct energies {
    double image, formed; /* of the exact image, and of range migration's */
    double complex product;
};

/* ---- the targets ---- */

/* In a grid's own axes: its middle and its sizes, a step about each pixel. */
struct extent {
    double x, r, width, depth; /* m */
};

static struct extent extent_of(const struct grid *g)
{
    return (struct extent){g->x_first + (g->x_count - 1) * g->x_step / 2, g->r_first + (g->r_count - 1) * g->r_step / 2,
                           g->x_count * g->x_step, g->r_count * g->r_step};
}

/* Of a place on the track's axes. */
static bool has_row(const struct grid *patch, double x, double r)
{
    const struct extent extent = extent_of(patch);
    return fabs(grid_coordinates(patch, x, r).y - extent.r) <= extent.depth / 2;
}

static bool has_column(const struct grid *patch, double x, double r)
{
    const struct extent extent = extent_of(patch);
    return fabs(grid_coordinates(patch, x, r).x - extent.x) <= extent.width / 2;
}

static int rows_of(const struct grid *patch)
{
    const double near = patch->r_first, far = near + (patch->r_count - 1) * patch->r_step;
    return far - near > DEEP * near ? (int)fmin(2 + log(far / near) / log(APART), TARGETS) : 1;
}

/* Those that stand for the k-th of `patches`, evenly over its columns, on rows that each stand for a part of its depth;
   as many at one frequency as at the other. */
static int patch_tones(const struct rma_view *view, const struct grid *patch, int k, int patches,
                       struct tone list[TARGETS])
{
    const struct acquisition *a = view->problem->acquisition;
    const double near = patch->r_first - patch->r_step / 2, far = near + patch->r_count * patch->r_step;
    const double from = fmax(near, 0.5 * patch->r_first), width = patch->x_count * patch->x_step;
    const int rows = (int)fmin(rows_of(patch), TARGETS / patches), count = TARGETS / patches / rows * rows;
    for (int n = 0; n < count; n++) {
        const int row = n % rows, turn = patches > 1 ? k : n;
        const double low = from * pow(far / from, (double)row / rows);
        const double high = from * pow(far / from, (row + 1.0) / rows);
        const double place = fmod(0.125 + turn * 0.618, 1); /* of the width: as even as any number of them may be */
        const struct vector at =
            grid_point(patch, ((low + high) / 2 - patch->r_first) / patch->r_step, place * patch->x_count - 0.5);
        list[n] = (struct tone){.r = at.y,
                                .x = at.x,
                                .frequency = a->fc + (turn / 2 + turn) % 2 * FREQUENCY * a->bandwidth
                                             - FREQUENCY * a->bandwidth / 2,
                                .weight = (high - low) * width};
    }
    return count;
}

/* Known targets on the patch's rows, each at frequencies evenly over the band. */
static int known_tones(const struct rma_view *view, const struct grid *patch, struct tone list[TONES])
{
    const struct problem *problem = view->problem;
    const struct acquisition *a = problem->acquisition;
    const int targets = problem->target_count < KNOWN ? problem->target_count : KNOWN, tones = TONES / targets;
    const double most = problem_amplitude_most(problem);
    int count = 0;
    for (int n = 0; n < targets * tones && most > 0; n++) {
        const struct target *target = &problem->targets[(long long)(n / tones) * problem->target_count / targets];
        if (has_row(patch, target->x, target->r))
            list[count++] = (struct tone){.known = true,
                                          .r = target->r,
                                          .x = target->x,
                                          .frequency = a->fc + ((n % tones + 0.5) / tones - 0.5) * a->bandwidth,
                                          .weight = pow(cabs(target->amplitude) / most, 2)};
    }
    return count;
}

/* The share of the targets on the rows of `part`, or of the one known target, whose echoes at column x belong to a row
   of it as well, r of the track's for `target`. */
static double on_rows(const struct acquisition *a, const struct tone *target, const struct grid *part, double x,
                      double r)
{
    const struct extent extent = extent_of(part);
    const double deep = extent.depth + a->sound_speed / 2 / a->bandwidth; /* m */
    const double row = grid_coordinates(part, x, r).y;
    if (part->angle_rad != 0 && !has_column(part, x, r))
        return 0;
    if (target->known)
        return fabs(row - extent.r) <= deep / 2;
    return fmax(1 - fabs(row - grid_coordinates(part, target->x, target->r).y) / deep, 0);
}

/* Back projection at column x, and the share of its energy that lies on the rows of `part`. */
static double complex back_projection(const struct azimuth *azimuth, const struct tone *target, const struct grid *part,
                                      double x, double *share)
{
    const struct rma_view *view = azimuth->view;
    const struct acquisition *a = view->problem->acquisition;
    double complex sum = 0;
    double all = 0, inside = 0;
    for (int p = 0; p < a->pings; p++) {
        const double at = view->x_low + p * view->spacing - x, u = at + x - target->x;
        const double seen = condition_amplitude(a, target->r, u);
        if (seen == 0)
            continue;
        const double row = tone_row(target->r, u, at);
        all += seen * seen;
        inside += seen * seen * on_rows(a, target, part, x, row);
        if (fabs(at * cos(a->echo_squint) + row * sin(a->echo_squint)) > a->aperture_limit * hypot(at, row))
            continue;
        for (int m = 0; m < a->receivers; m++) {
            const double d = azimuth_offset(azimuth, m);
            sum += product(azimuth->echoes[p * a->receivers + m],
                           turns(target->frequency * spectrum_delay(&view->setting, d, target->r, at)));
        }
    }
    *share = all > 0 ? inside / all : 0;
    return sum;
}

static void column_add(const struct azimuth *azimuth, const struct tone *target, const struct grid *part, double x,
                       double weight, struct energies *energies)
{
    const struct rma_view *view = azimuth->view;
    const double step = view->spacing / view->problem->acquisition->receivers;
    const double n = floor((x - view->x_low) / step + 0.5), wraps = floor(n / azimuth->wavenumbers);
    double share;
    const double complex exact = back_projection(azimuth, target, part, view->x_low + n * step, &share);
    weight *= share;
    const double complex formed = azimuth->wave[(int)(n - wraps * azimuth->wavenumbers)];
    energies->image += weight * creal(exact * conj(exact));
    energies->formed += weight * creal(formed * conj(formed));
    energies->product += weight * formed * conj(exact);
}

/* Evenly over the columns of `part`, and more of them about the target. */
static void part_add(const struct azimuth *azimuth, const struct tone *target, const struct grid *part,
                     struct energies *energies)
{
    const struct rma_view *view = azimuth->view;
    const struct acquisition *a = view->problem->acquisition;
    double first, last;
    grid_columns(part, &first, &last);
    const double width = last - first, wavelength = a->sound_speed / a->fc;
    const double resolution = fmax(wavelength / (4 * fmin(condition_seen_sine(a), 1)),
                                   wavelength * target->r / 2 / (view->x_high - view->x_low + view->spacing));
    const double near = fmin(NEAR * resolution, width), step = 2 * near / COLUMNS, beside = width / COLUMNS;
    for (int k = 0; k < COLUMNS; k++) {
        const double close = target->x + (k - COLUMNS / 2) * step, column = first + (k + 0.5) * beside;
        if (close >= first && close <= first + width)
            column_add(azimuth, target, part, close, target->weight * step, energies);
        if (fabs(column - target->x) > near)
            column_add(azimuth, target, part, column, target->weight * beside, energies);
    }
}

/* ---- all of them ---- */

/* Is the part one of the patch? */
static bool lies_in(const struct grid *part, const struct grid *patch)
{
    const struct vector middle = grid_point(part, (part->r_count - 1) / 2.0, (part->x_count - 1) / 2.0);
    return grid_holds(patch, middle.x, middle.y);
}

/* Where errors count in a patch. */
static void target_add(const struct azimuth *azimuth, const struct tone *target, const struct grid *patch,
                       struct energies *energies)
{
    const struct problem *problem = azimuth->view->problem;
    azimuth_form(azimuth, target);
    for (int k = 0; k < problem->judged_count && target->known; k++)
        if (lies_in(&problem->judged[k], patch) && has_row(&problem->judged[k], target->x, target->r))
            part_add(azimuth, target, &problem->judged[k], energies);
    if (!target->known || problem->judged_count == 0)
        part_add(azimuth, target, patch, energies);
}

/* False without memory. */
static bool tones_add(const struct rma_view *view, const struct grid *patch, const struct tone *list, int count,
                      struct energies *energies)
{
    struct azimuth azimuth;
    if (count == 0)
        return true;
    const bool made = azimuth_make(view, patch, &azimuth);
    for (int n = 0; n < count && made && azimuth.period > 0; n++)
        target_add(&azimuth, &list[n], patch, energies);
    azimuth_free(&azimuth);
    return made;
}

/* INFINITY where nothing is seen, NAN without memory. */
static double energies_error(const struct energies *sum, bool made)
{
    if (!made)
        return NAN;
    if (!(sum->image > 0 && sum->formed > 0))
        return INFINITY;
    return unlike(sum->product, sum->image * sum->formed);
}

/* Of known targets. */
static double known_error(const struct rma_view *view)
{
    struct energies sum = {0, 0, 0};
    bool made = true;
    for (int k = 0; k < view->problem->patch_count && view->problem->target_count > 0 && made; k++) {
        const struct grid *patch = &view->problem->patches[k];
        struct tone list[TONES];
        made = tones_add(view, patch, list, known_tones(view, patch, list), &sum);
    }
    return energies_error(&sum, made);
}

/* Of targets evenly over all patches, of which some stand for all. */
static double even_error(const struct rma_view *view)
{
    const int patches = view->problem->patch_count < TARGETS ? view->problem->patch_count : TARGETS;
    struct energies sum = {0, 0, 0};
    bool made = true;
    for (int k = 0; k < patches && made; k++) {
        const struct grid *patch = &view->problem->patches[(long long)k * view->problem->patch_count / patches];
        struct tone list[TARGETS];
        made = tones_add(view, patch, list, patch_tones(view, patch, k, patches, list), &sum);
    }
    return energies_error(&sum, made);
}

double azimuth_error(const struct rma_view *view)
{
    const double known = known_error(view), aliases = view->period > 0 ? aliases_error(view) : 0;
    const double even = view->problem->acquisition->echo_squint != 0 ? SQUINTED_TARGETS : FEW_TARGETS;
    if (isinf(known))
        return condition_worse(even * even_error(view), aliases);
    return condition_worse((view->problem->target_count > KNOWN ? FEW_TARGETS : KNOWN_TARGETS) * known, aliases);
}
