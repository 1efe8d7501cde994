/* What the polar-format filter needs of its echoes (filter.h). */
#include "wavenumber/filter.h"

#include <math.h>

enum status polar_filter_check(const struct acquisition *a, const char *place)
{
    const struct target_area *area = &a->area;
    if (!(area->half_x > 0 && area->half_r > 0))
        return status_set(
            STATUS_UNSUPPORTED,
            "%s: condition target_area: the echoes name no target area (cure: a scene with area, or a file "
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
