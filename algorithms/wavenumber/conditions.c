/* The conditions of omega-k (docs/conditions.md). */
#include <math.h>

#include "range_migration/conditions.h"
#include "range_migration/ghosts.h"
#include "wavenumber/wk.h"

static const double SLOWEST = 0.1; /* of 1 - |v|/c, as in range migration */

int wk_conditions(const struct problem *problem, const void *options, struct condition *list, int room)
{
    (void)options;
    const struct acquisition *a = problem->acquisition;
    struct straight_track track;
    struct condition all[CONDITIONS_MAX];
    int count = conditions_general(problem, all, CONDITIONS_MAX);
    all[0].limit = SLOWEST; /* subsonic */
    double aside = fmax(fabs(condition_offset(a, 0)), fabs(condition_offset(a, 2)));
    all[count++] = (struct condition){"one_receiver",
                                      a->receivers,
                                      1,
                                      false,
                                      SEVERITY_REFUSE,
                                      "the number of receivers",
                                      "range migration (rma_*), which takes several receivers"};
    all[count++] = (struct condition){"monostatic",
                                      aside * a->fc / a->sound_speed,
                                      1e-3,
                                      false,
                                      SEVERITY_REFUSE,
                                      "how far the receiver is from the transmitter along the track (wavelengths)",
                                      "range migration (rma_*), which takes that into account"};
    if (azimuth_requirements(problem, all, &count, &track) && conditions_accept(all, count))
        all[count++] = ghosts_condition(problem, &track);
    for (int k = 0; k < count && k < room; k++)
        list[k] = all[k];
    return count < room ? count : room;
}
