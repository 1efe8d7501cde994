/* The polar-format filter: its requirements, its sub-apertures, and its loss of targets inside the area
   (polar_filter.h). */
#include "wavenumber/polar_filter.h"

#include <math.h>

enum status polar_filter_check(const struct acquisition *a, const char *place)
{
    const struct target_area *area = &a->area;
    if (!(area->half_x > 0 && area->half_r > 0))
        return status_set(STATUS_UNSUPPORTED,
                          "%s: condition target_area: no target area is given (cure: a scene with area, or a file "
                          "with area)",
                          place);
    if (a->receivers > 1 || fabs(a->rx[0].x - a->tx[0].x) > a->sound_speed / a->fc / 1000)
        return status_set(STATUS_UNSUPPORTED,
                          "%s: condition one_receiver: %d receivers, the first %g m ahead of the transmitter; the "
                          "polar-format filter needs one "
                          "receiver at the transmitter",
                          place, a->receivers, a->rx[0].x - a->tx[0].x);
    if (!acquisition_is_straight(a, NULL) || a->pings < 2)
        return status_set(STATUS_UNSUPPORTED,
                          "%s: condition uniform_track: %d pings on a track; the polar-format filter needs two or more "
                          "on a uniform straight one "
                          "along x, y = z = 0",
                          place, a->pings);
    if (!(area->r - area->half_r > 0))
        return status_set(STATUS_UNSUPPORTED,
                          "%s: condition in_front: the target area begins at r = %g m; more than 0 is needed", place,
                          area->r - area->half_r);
    double first = a->t0[0] * a->sound_speed / 2, last = first + (a->samples - 1) / a->fs * a->sound_speed / 2;
    double low = fmin(a->tx[0].x, a->tx[a->pings - 1].x), high = fmax(a->tx[0].x, a->tx[a->pings - 1].x);
    double aside = fmax(0, fmax(area->x - area->half_x - high, low - area->x - area->half_x));
    double farther = fmax(high - area->x + area->half_x, area->x + area->half_x - low);
    double nearest = hypot(area->r - area->half_r, aside), farthest = hypot(area->r + area->half_r, farther);
    if (!(nearest < last && farthest > first))
        return status_set(
            STATUS_UNSUPPORTED,
            "%s: condition area_in_record: the target area lies %g to %g m from the track, outside the record's "
            "%g to %g m (cure: an area that the records hold)",
            place, nearest, farthest, first, last);
    return STATUS_OK;
}

double polar_filter_sine(const struct acquisition *a, double x)
{
    return (a->area.x - x) / hypot(a->area.x - x, a->area.r);
}

/* m, signed: from ping to ping of a uniform track. */
static double spacing_of(const struct acquisition *a)
{
    return (a->tx[a->pings - 1].x - a->tx[0].x) / (a->pings - 1);
}

int polar_filter_begin(const struct acquisition *a, int count, int s)
{
    return (int)round((double)s * a->pings / count);
}

double polar_filter_upsampling(const struct acquisition *a, int count)
{
    const double spacing = spacing_of(a);
    double beam = 2 * (a->echo_sine > 0 && a->echo_sine < 1 ? a->echo_sine : 0), widest = 0;
    if (beam == 0)
        beam = a->tx_length > 0 ? fmin(2, a->sound_speed / a->fc / a->tx_length) : 2;
    beam = fmin(beam, a->sound_speed / a->fc / (2 * fabs(spacing)));
    for (int s = 0; s < count; s++) {
        const double x0 = a->tx[0].x + polar_filter_begin(a, count, s) * spacing;
        const double x1 = a->tx[0].x + (polar_filter_begin(a, count, s + 1) - 1) * spacing;
        widest = fmax(widest, fabs(polar_filter_sine(a, x0) - polar_filter_sine(a, x1)));
    }
    double factor = 1, needed = 2 * a->fc / a->sound_speed * (beam + widest) * fabs(spacing);
    while (factor < needed)
        factor *= 2;
    return factor;
}

int polar_filter_most(const struct acquisition *a)
{
    return a->pings / 2 > 1 ? a->pings / 2 : 1;
}

int polar_filter_subapertures(const struct acquisition *a, int asked)
{
    const int most = polar_filter_most(a);
    int count = asked > 0 ? asked : 1;
    while (asked == 0 && count < most && polar_filter_upsampling(a, count) != 1)
        count++;
    return count;
}

/* ---- energy kept ---- */

enum { PINGS_MOST = 500, CELLS = 4, PARTS = 16 };
static const double PLACE = 0.8;   /* of the area's halves, where targets count as inside */
static const double LEAKS = 0.01;  /* side lobes, of the energy outside */
static const double LOSS_MOST = 3; /* dB: half of the energy */

/* The share of a sinc's energy, its null at 1, that lies within (low, high): in the samples of the mask, at `from` and
   every `step` beside it, of which a thin area holds one or none. */
static double share_within(double low, double high, double from, double step)
{
    double within = 0, all = 0;
    while (step < 1.0 / PARTS) /* fine enough */
        step *= 2;
    for (double z = from - step * floor((from + CELLS) / step); z <= CELLS; z += step) {
        const double energy = pow(condition_sinc(z), 2);
        within += low < z && z < high ? energy : 0;
        all += energy;
    }
    return within / all;
}

/* Energy of a target, ahead of the filter and behind it. */
struct energy {
    double all, kept;
};

/* Add pings [first, end) of a sub-aperture. For a ping u off its middle, without the centre's delay, the target is at
   the range and the angle

       R = rho + R_t(u) - R_c(u),    sin psi = sin alpha + sin theta_t(u) - sin theta_c(u),

   blurred by the pulse and by the pings that see it. Its part inside the mask is kept: a target beside the centre walks
   in range, out of a thin area. */
static void aperture_add(const struct acquisition *a, bool curvature, int first, int end, struct vector place,
                         struct energy *energy)
{
    const struct target_area *area = &a->area;
    const double spacing = spacing_of(a), cell_r = a->sound_speed / (2 * a->bandwidth);
    const double middle = a->tx[0].x + (first + end - 1) / 2.0 * spacing, alpha = polar_filter_sine(a, middle);
    const double rho = hypot(area->x - middle, area->r);
    int seen = 0;
    for (int p = first; p < end; p++)
        seen += condition_amplitude(a, place.y, a->tx[p].x - place.x) != 0;
    const double cell_sine = a->sound_speed / a->fc / (2 * fabs(spacing) * seen);
    for (int p = first; p < end && seen > 0; p += 1 + a->pings / PINGS_MOST) {
        const double x = a->tx[p].x, u = x - middle, distance = hypot(place.x - x, place.y);
        const double weight = pow(condition_amplitude(a, place.y, x - place.x), 2);
        const double r = rho + distance - hypot(area->x - x, area->r);
        const double sine =
            alpha + (place.x - x) / distance - polar_filter_sine(a, x) + (curvature ? u * (1 / r - 1 / rho) : 0);
        const double off_r = r * sqrt(fmax(1 - sine * sine, 0)) - area->r;
        const double off_x = middle + r * sine - area->x, cell_x = cell_sine * r;
        energy->all += weight;
        energy->kept += weight
                        * share_within((-area->half_r - off_r) / cell_r, (area->half_r - off_r) / cell_r,
                                       (rho - r) / cell_r, a->bandwidth / a->fs)
                        * share_within((-area->half_x - off_x) / cell_x, (area->half_x - off_x) / cell_x, 0, 0.25);
    }
}

/* Energy of a target that is kept, in dB; 0 where no ping sees it. */
static double kept_db(const struct acquisition *a, const struct polar_setting *setting, int count, struct vector place)
{
    struct energy energy = {0, 0};
    for (int s = 0; s < count; s++)
        aperture_add(a, setting->curvature, polar_filter_begin(a, count, s), polar_filter_begin(a, count, s + 1), place,
                     &energy);
    return energy.all > 0 ? 10 * log10(fmax(energy.kept / energy.all, LEAKS)) : 0;
}

/* dB >= 0: the worst of the places inside the area. */
static double loss_db(const struct acquisition *a, const struct polar_setting *setting, int count)
{
    double loss = 0;
    for (int n = 0; n < 9; n++) {
        const struct vector place = {a->area.x + PLACE * (n % 3 - 1) * a->area.half_x,
                                     a->area.r + PLACE * (n / 3 - 1) * a->area.half_r, 0};
        const double kept = kept_db(a, setting, count, place);
        loss = -kept > loss ? -kept : loss;
    }
    return loss;
}

struct condition polar_filter_kept(const struct acquisition *a, const struct polar_setting *setting)
{
    const int count = polar_filter_subapertures(a, setting->subapertures), most = polar_filter_most(a);
    struct condition kept =
        condition_most(SEVERITY_WARN, "area_kept", loss_db(a, setting, count), LOSS_MOST,
                       "the filter's loss on targets inside its own area, out to 0.8 of it (dB)", "a larger area");
    int better = count;
    while (better <= most && !condition_holds(&kept) && loss_db(a, setting, better) > LOSS_MOST)
        better *= 2;
    if (better > count && better <= most)
        condition_cure_add(&kept, ", or subapertures=%d in place of %d", better, count);
    return kept;
}
