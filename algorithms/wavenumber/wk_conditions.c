/* The conditions of omega-k (docs/conditions.md). */
#include <math.h>

#include "range_migration/rma_conditions.h"
#include "range_migration/spectrum.h"
#include "wavenumber/wk_engine.h"
#include "wavenumber/polar_filter.h"

static const double SLOWEST = 0.1;          /* of 1 - |v|/c, as in range migration */
static const double SLOWEST_ROTATED = 0.78; /* beyond, axes turned by the angle at rest err by 7 % and more */

double wk_centroid_slope(const struct acquisition *a, const struct straight_track *track)
{
    const struct spectrum_setting setting = {a->sound_speed, track->speed, a->fc, 0};
    double still = sin(a->echo_squint),
           moving = -spectrum_slope(&setting, 0, 1, -tan(a->echo_squint)) * a->sound_speed / 2;
    return fabs(moving - still) * 4 * fabs(track->spacing) * a->fc / a->sound_speed > 0.1 ? moving : still;
}

/* The patches as seen from the pings. */
struct view {
    const struct acquisition *acquisition;
    double spacing, slope;
    double x_end[2]; /* m: of the track */
    double sine[2];  /* of the angles off broadside between which the beam sees */
};

static struct view view_of(const struct acquisition *a, const struct straight_track *track)
{
    const double last = track->x_first + (a->pings - 1) * track->spacing;
    const double half = condition_cut_sine(a);
    const double b = half < 1 ? asin(half) : M_PI, low = a->echo_squint - b, high = a->echo_squint + b;
    return (struct view){.acquisition = a,
                         .spacing = fabs(track->spacing),
                         .slope = wk_centroid_slope(a, track),
                         .x_end = {fmin(track->x_first, last), fmax(track->x_first, last)},
                         .sine = {fmax(-WK_WIDEST_SINE, low > -M_PI / 2 ? sin(low) : -1),
                                  fmin(WK_WIDEST_SINE, high < M_PI / 2 ? sin(high) : 1)}};
}

/* Sines of the angles under which pings see a place: false if none does. */
static bool place_seen(const struct view *view, struct vector p, double seen[2])
{
    for (int k = 0; k < 2; k++)
        seen[k] = (p.x - view->x_end[1 - k]) / hypot(p.x - view->x_end[1 - k], p.y);
    seen[0] = fmax(seen[0], view->sine[0]);
    seen[1] = fmin(seen[1], view->sine[1]);
    return seen[0] <= seen[1];
}

/* Worst over the corners and the middle of each patch, as far as they are seen. */
struct worst {
    double doppler, stationary;
    int unseen; /* patches of which no ping sees any of these places */
};

static struct worst patches_see(const struct view *view, const struct problem *problem)
{
    const struct acquisition *a = view->acquisition;
    const double wavelength = a->sound_speed / (a->fc - a->bandwidth / 2);
    struct worst worst = {0, 0, 0};
    for (int n = 0; n < problem->patch_count; n++) {
        const struct grid *g = &problem->patches[n];
        bool any = false;
        for (int k = 0; k < 5; k++) {
            double u = k == 4 ? 0.5 : k % 2, w = k == 4 ? 0.5 : k / 2, seen[2];
            struct vector p = grid_point(g, w * (g->r_count - 1), u * (g->x_count - 1));
            if (!place_seen(view, p, seen))
                continue;
            any = true;
            double steepest = fmax(fabs(seen[0] - view->slope), fabs(seen[1] - view->slope));
            double cosine = sqrt(1 - fmax(seen[0] * seen[0], seen[1] * seen[1]));
            worst.doppler = condition_worse(worst.doppler,
                                            (a->fc + a->bandwidth / 2) / a->sound_speed * 4 * view->spacing * steepest);
            worst.stationary = condition_worse(worst.stationary, wavelength / (32 * M_PI * p.y * cosine));
        }
        worst.unseen += !any;
    }
    return worst;
}

/* Conditions of beam and patches. A beam that looks too far along the track has the first one only. */
static void beam_conditions(const struct problem *problem, const struct straight_track *track, struct condition *all,
                            int *count)
{
    const struct view view = view_of(problem->acquisition, track);
    all[(*count)++] = condition_most(
        SEVERITY_REFUSE, "squint", asin(fmin(fabs(view.slope), 1)) * 180 / M_PI, asin(WK_WIDEST_SINE) * 180 / M_PI,
        "the angle of the beam's axis off broadside (degrees)", "back projection, or a beam nearer to broadside");
    if (!condition_holds(&all[*count - 1]))
        return;
    const struct worst worst = patches_see(&view, problem);
    all[(*count)++] = condition_most(SEVERITY_REFUSE, "in_beam", worst.unseen, 0, "patches that lie in no ping's beam",
                                     "patches where the beam looks, in axes turned as it is");
    all[(*count)++] = condition_most(
        SEVERITY_REFUSE, "doppler", worst.doppler, 1.05,
        "the largest azimuth wavenumber of the beam, off its centroid, over that which pings sample, 1/(2 spacing)",
        "pings closer together, or a narrower beam");
    condition_beam_named(problem->acquisition, &all[*count - 1]);
    all[(*count)++] = condition_most(SEVERITY_REFUSE, "stationary", worst.stationary, 0.01,
                                     "the first term that stationary phase drops, lambda/(32 pi r cos theta)",
                                     "rows farther away, or a higher frequency");
}

struct rma_view wk_view_of(const struct problem *problem, const struct straight_track *track)
{
    static const struct rma_method monostatic = {0};
    struct rma_view view = rma_view_of(problem, &monostatic, track);
    view.converts = false;
    view.bounds = (struct rma_bounds){.sine = rma_widest_sine(problem->acquisition), .way = INFINITY};
    return view;
}

/* The cheap conditions; fills the track where all of them are met. */
static int requirements(const struct problem *problem, struct condition all[CONDITIONS_MAX],
                        struct straight_track *track)
{
    const struct acquisition *a = problem->acquisition;
    int count = conditions_general(problem, all, CONDITIONS_MAX);
    all[0].limit = SLOWEST; /* subsonic */
    double aside = fmax(fabs(condition_offset(a, 0)), fabs(condition_offset(a, 2)));
    all[count++] = condition_most(SEVERITY_REFUSE, "one_receiver", a->receivers, 1, "the number of receivers",
                                  "back projection, range migration (rma_*), or the filter 'monostatic |' ahead of it");
    all[count++] = condition_most(SEVERITY_REFUSE, "monostatic", aside * a->fc / a->sound_speed, 1e-3,
                                  "how far the receiver is from the transmitter along the track (wavelengths)",
                                  "back projection, range migration (rma_*), or the filter 'monostatic |' ahead of it");
    if (azimuth_requirements(problem, all, &count, track) && conditions_accept(all, count))
        beam_conditions(problem, track, all, &count);
    return count;
}

/* The conditions that may refuse. */
static int refusals(const struct problem *problem, const struct wk_method *method, struct condition *list, int room)
{
    struct straight_track track;
    struct condition all[CONDITIONS_MAX];
    int count = requirements(problem, all, &track);
    if (conditions_accept(all, count)) {
        const struct rma_view view = wk_view_of(problem, &track);
        all[count++] = rma_predicted_error(&view);
    }
    if (conditions_accept(all, count)) {
        all[count] = ghosts_condition(problem, &track);
        all[count++].severity = SEVERITY_REFUSE; /* nothing else here predicts what lies within a patch */
    }
    if (method->rotates)
        all[0].limit = SLOWEST_ROTATED;
    for (int k = 0; k < count && k < room; k++)
        list[k] = all[k];
    return count < room ? count : room;
}

int wk_conditions(const struct problem *problem, const void *method, const void *options, struct condition *list,
                  int room)
{
    const struct wk_method *m = method;
    const struct wk_options *given = options;
    const struct acquisition *a = problem->acquisition;
    int count = refusals(problem, m, list, room);
    if (m->filters && count < room && a->area.half_x > 0 && polar_filter_check(a, m->name) == STATUS_OK)
        list[count++] =
            polar_filter_kept(a, &(struct polar_setting){given->subapertures, given->curvature, given->band});
    return count;
}

enum status wk_conditions_check(const struct problem *problem, const struct wk_method *method)
{
    struct condition all[CONDITIONS_MAX];
    const int count = refusals(problem, method, all, CONDITIONS_MAX);
    return rma_conditions_check(method->name, all, count);
}

enum status wk_requirements_check(const struct problem *problem, const struct wk_method *method)
{
    struct straight_track track;
    struct condition all[CONDITIONS_MAX];
    const int count = requirements(problem, all, &track);
    if (method->rotates)
        all[0].limit = SLOWEST_ROTATED;
    return conditions_check(method->name, all, count);
}
