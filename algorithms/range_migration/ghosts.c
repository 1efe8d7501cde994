/* Grating lobes (rma_conditions.h). The ghost of a target at (x_t, r_t) in pixel (x, r) is

       sum over receivers and pings of  a sinc(B dtau) exp(j 2 pi fc dtau),

   dtau the difference of the delays of pixel and target, a the beam's amplitude at the target. The pings are those that
   see the target, and that a transform images at the target (else the condition doppler is not met) but not at the
   pixel, where their wavenumber lies beyond the sampled band |fc dtau/du - centroid| <= M/(2 spacing) or beyond the
   element's first null; or the reverse: those that the aperture limit excludes from back projection alone. In range a
   ghost is as narrow as the pulse: on some columns of a patch, the rows are found where a ping's delay is the target's,
   and the ghost's energy is summed over these. The target's own energy is that of a response as wide as 1/band in
   azimuth and c/2B in range. */
#include "range_migration/rma_conditions.h"

#include <complex.h>
#include <math.h>

enum {
    PATCHES = 8,   /* of an image, at most */
    TARGETS = 3,   /* of a patch, on its diagonal */
    COLUMNS = 17,  /* of a patch */
    ROWS = 9,      /* of a ghost on a column */
    ITERATIONS = 4 /* of Newton's method for the row of a delay */
};
static const double LIMIT = 0.1; /* as that of the predicted error */
static const double BESIDE = 2;  /* range cells beside a ghost's rows with the rest of its pulse */

struct ghosts {
    const struct problem *problem;
    const struct acquisition *acquisition;
    struct spectrum_setting setting;
    double middle;            /* m: offset of the middle of the array */
    double centroid, sampled; /* cycles/m: the middle of the sampled wavenumbers, and half of their band */
    double widest;            /* sine off the beam's axis: beyond, transforms follow no echoes */
    double cell;              /* m: c/2B */
};

/* Place u (m) of ping p ahead of a point. */
static double ahead(const struct ghosts *ghosts, int p, struct vector point)
{
    return ghosts->acquisition->tx[p].x - point.x;
}

/* |sin theta_t| of a point off the beam's axis, seen from ping p. */
static double sine_at(const struct ghosts *ghosts, int p, struct vector point)
{
    double u = ahead(ghosts, p, point), squint = ghosts->acquisition->echo_squint;
    return fabs(u * cos(squint) + point.y * sin(squint)) / hypot(u, point.y);
}

/* Is the wavenumber of a point, seen from ping p, one that transforms image? */
static bool is_imaged(const struct ghosts *ghosts, int p, struct vector point)
{
    double slope = spectrum_slope(&ghosts->setting, ghosts->middle, point.y, ahead(ghosts, p, point));
    return fabs(ghosts->acquisition->fc * slope - ghosts->centroid) <= ghosts->sampled
           && sine_at(ghosts, p, point) <= ghosts->widest;
}

/* A pair that only one of back projection and transform leaves out of a pixel. */
static bool makes_ghosts(const struct ghosts *ghosts, int p, struct vector target, struct vector pixel)
{
    const bool summed = sine_at(ghosts, p, pixel) <= ghosts->acquisition->aperture_limit;
    return is_imaged(ghosts, p, pixel) != summed && is_imaged(ghosts, p, target);
}

static double delay(const struct ghosts *ghosts, int p, int receiver, struct vector point)
{
    double d = receiver < 0 ? ghosts->middle : ghosts->acquisition->rx[receiver].x - ghosts->acquisition->tx[0].x;
    return spectrum_delay(&ghosts->setting, d, point.y, ahead(ghosts, p, point));
}

/* The n-th of TARGETS on the patch's diagonal. */
static struct vector target_of(const struct grid *patch, int n)
{
    double part = n / (TARGETS - 1.0);
    return grid_point(patch, part * (patch->r_count - 1), part * (patch->x_count - 1));
}

/* The pings that see a target, [*first, *last]; false if there are none. */
static bool pings_of(const struct ghosts *ghosts, struct vector target, int *first, int *last)
{
    *first = -1;
    for (int p = 0; p < ghosts->acquisition->pings; p++)
        if (condition_amplitude(ghosts->acquisition, target.y, ahead(ghosts, p, target)) != 0) {
            *first = *first < 0 ? p : *first;
            *last = p;
        }
    return *first >= 0;
}

/* Could pings first ... last make ghosts anywhere in the patch? Wavenumbers are monotone in the ping and over the
   patch. */
static bool reaches(const struct ghosts *ghosts, int first, int last, const struct grid *patch)
{
    const double limit = ghosts->acquisition->aperture_limit;
    for (int corner = 0; corner < 8; corner++) {
        struct vector point =
            grid_point(patch, corner / 2 % 2 * (patch->r_count - 1), corner % 2 * (patch->x_count - 1));
        int p = corner < 4 ? first : last;
        if (!is_imaged(ghosts, p, point) || sine_at(ghosts, p, point) > limit)
            return true;
    }
    return false;
}

/* The row of column j where ping p's delay is `wanted`, which may lie outside the patch; NAN where there is none. */
static double row_of(const struct ghosts *ghosts, int p, const struct grid *patch, double j, double wanted)
{
    double row = 0.5 * (patch->r_count - 1);
    for (int n = 0; n < ITERATIONS; n++) {
        struct vector here = grid_point(patch, row, j), next = grid_point(patch, row + 1, j);
        double step = delay(ghosts, p, -1, next) - delay(ghosts, p, -1, here);
        if (!(here.y > 0) || !(fabs(step) > 0))
            return NAN;
        row += (wanted - delay(ghosts, p, -1, here)) / step;
    }
    return row;
}

/* A target, and the pings [first, last] that see it. */
struct source {
    struct vector place;
    int first, last;
};

static double pixel_energy(const struct ghosts *ghosts, const struct source *source, struct vector pixel)
{
    const struct acquisition *a = ghosts->acquisition;
    double complex sum = 0;
    for (int p = source->first; p <= source->last; p++) {
        if (!makes_ghosts(ghosts, p, source->place, pixel))
            continue;
        double seen = condition_amplitude(a, source->place.y, ahead(ghosts, p, source->place));
        for (int m = 0; m < a->receivers; m++) {
            double late = delay(ghosts, p, m, pixel) - delay(ghosts, p, m, source->place), cycles = a->fc * late;
            sum += seen * condition_sinc(a->bandwidth * late) * cexp(2 * I * M_PI * (cycles - floor(cycles)));
        }
    }
    return creal(sum * conj(sum));
}

/* Integral of the ghost's energy over column j, per metre of azimuth. */
static double column_energy(const struct ghosts *ghosts, const struct source *source, const struct grid *patch,
                            double j)
{
    const double beside = BESIDE * ghosts->cell / patch->r_step;
    double low = INFINITY, high = -INFINITY, energy = 0;
    for (int p = source->first; p <= source->last; p++) {
        double row = row_of(ghosts, p, patch, j, delay(ghosts, p, -1, source->place));
        if (!(row >= -beside && row <= patch->r_count - 1 + beside)
            || !makes_ghosts(ghosts, p, source->place, grid_point(patch, fmin(fmax(row, 0), patch->r_count - 1), j)))
            continue;
        low = fmin(low, row);
        high = fmax(high, row);
    }
    low = fmax(low - beside, -0.5);
    high = fmin(high + beside, patch->r_count - 0.5);
    if (!(low < high))
        return 0;
    for (int n = 0; n < ROWS; n++)
        energy += pixel_energy(ghosts, source, grid_point(patch, low + (n + 0.5) / ROWS * (high - low), j)) / ROWS;
    return energy * (high - low) * patch->r_step;
}

static double ghost_energy(const struct ghosts *ghosts, const struct source *source, const struct grid *patch)
{
    double energy = 0;
    for (int k = 0; k < COLUMNS; k++) {
        double j = (k + 0.5) / COLUMNS * patch->x_count - 0.5;
        energy += column_energy(ghosts, source, patch, j) / COLUMNS * patch->x_count * patch->x_step;
    }
    return energy;
}

static double own_energy(const struct ghosts *ghosts, const struct source *source, const struct grid *patch)
{
    const struct acquisition *a = ghosts->acquisition;
    double peak = 0, band = a->fc
                            * fabs(spectrum_slope(&ghosts->setting, ghosts->middle, source->place.y,
                                                  ahead(ghosts, source->last, source->place))
                                   - spectrum_slope(&ghosts->setting, ghosts->middle, source->place.y,
                                                    ahead(ghosts, source->first, source->place)));
    for (int p = source->first; p <= source->last; p++)
        peak += a->receivers * condition_amplitude(a, source->place.y, ahead(ghosts, p, source->place));
    const double width = patch->x_count * patch->x_step;
    return peak * peak * (band * width > 1 ? 1 / band : width) * fmin(ghosts->cell, patch->r_count * patch->r_step);
}

/* Energies of ghosts over those of own images. */
struct shares {
    double own, others; /* ghosts of targets in the same patch, and in the others */
};

/* Of the k-th of `count` patches that represent all; zero where no ping sees its targets. */
static struct shares patch_ghosts(const struct ghosts *ghosts, int k, int count)
{
    const struct problem *problem = ghosts->problem;
    const struct grid *patch = &problem->patches[(long long)k * problem->patch_count / count];
    struct shares shares = {0, 0};
    double images = 0;
    for (int other = 0; other < count; other++) {
        const struct grid *from = &problem->patches[(long long)other * problem->patch_count / count];
        for (int n = 0; n < TARGETS; n++) {
            struct source source = {.place = target_of(from, n)};
            if (!pings_of(ghosts, source.place, &source.first, &source.last))
                continue;
            if (other == k)
                images += own_energy(ghosts, &source, patch);
            if (reaches(ghosts, source.first, source.last, patch))
                *(other == k ? &shares.own : &shares.others) += ghost_energy(ghosts, &source, patch);
        }
    }
    return images > 0 ? (struct shares){shares.own / images, shares.others / images} : (struct shares){0, 0};
}

struct condition ghosts_condition(const struct problem *problem, const struct straight_track *track)
{
    const struct acquisition *a = problem->acquisition;
    struct ghosts ghosts = {
        .problem = problem,
        .acquisition = a,
        .setting = {a->sound_speed, track->speed, a->fc, 0},
        .middle = condition_offset(a, 1),
        .sampled = a->receivers / (2 * fabs(track->spacing)),
        .widest = rma_widest_sine(a),
        .cell = a->sound_speed / (2 * a->bandwidth),
    };
    double worst = 0, refusing = 0;
    int count = problem->patch_count < PATCHES ? problem->patch_count : PATCHES;
    if (a->echo_squint != 0)
        ghosts.centroid = a->fc * spectrum_slope(&ghosts.setting, 0, 1, -tan(a->echo_squint));
    for (int k = 0; k < count; k++) {
        struct shares shares = patch_ghosts(&ghosts, k, count);
        worst = fmax(worst, shares.own + shares.others);
        refusing = fmax(refusing, shares.others);
    }
    return condition_most(
        refusing > LIMIT * LIMIT || a->aperture_limit < 1 ? SEVERITY_REFUSE : SEVERITY_WARN, "grating_lobes",
        sqrt(worst), LIMIT,
        "ghosts of point targets, from pings that back projection sums and a transform leaves out (relative L2)",
        "an aperture_limit at the edge of the sampled wavenumbers or of the element's first null; pings closer "
        "together");
}
