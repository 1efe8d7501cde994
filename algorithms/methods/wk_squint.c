/* Omega-k in axes turned by the squint (SQ18): the Doppler centroid is removed in (range wavenumber, azimuth), Eq. (3),
   the axes are rotated, Eqs. (6) to (9), and the spectrum is interpolated along azimuth, Eq. (12), and then along
   range, Eq. (13). No zeros between the pings are needed; those after them (pad) are for the azimuth interpolation.

   Error: that of the method of stationary phase, and of the interpolations: 1e-4 with 8 taps and pad = 1.5 or more; 6
   to 18 % near the record's ends with pad = 1. The weights for the range interpolation are those at t + 2 X sin
   theta/c, and the beam's half width psi moves echoes by 2 X sin theta (1/cos psi - 1)/c: 3e-4 of the window in SQ18's
   scene. */
#include <math.h>

#include "range_migration/rma.h"
#include "wavenumber/wk.h"

static const char *const windows[] = {"kaiser", "none", NULL}, *const weightings[] = {"none", "hamming", NULL};

static const struct param params[] = {
    WK_TAPS_PARAM,
    {PARAM(struct wk_options, pad), .summary = "length of the azimuth transform over the pings", .initial = 1.5,
     .min = 1, .max = 4, .sweep = "1 1.25 1.5 2"},
    {PARAM_NAMED(struct wk_options, window, windows), .summary = "of the interpolations' taps; none: a truncated sinc",
     .max = 1, .terse = true},
    {PARAM_NAMED(struct wk_options, weighting, weightings),
     .summary = "of the azimuth spectrum: lower side lobes, and another image than the others'", .max = 1,
     .terse = true},
    {.name = NULL},
};

static const struct wk_method method = {.name = "wk_squint", .rotates = true};

/* Truncated sincs and weighted spectra are SQ18's, and no image of the reference. */
static double promise(const void *options)
{
    const struct wk_options *o = options;
    return o->window || o->weighting ? NAN : rma_promise(options);
}

static const struct candidate_family candidates[] = {
    {"", "taps", "4 6 8"},
    {.fixed = NULL},
};

static const char *const gated[] = {"taps=16,pad=2,precision=double", "pad=1", NULL};

const struct algorithm wk_squint = {
    .name = "wk_squint",
    .summary = "omega-k in axes turned by the squint",
    .reference = "SQ18 Eqs. (3) to (13), corrected",
    .traits = TRAIT_WINDOW,
    .options_size = sizeof(struct wk_options),
    .params = params,
    .gated = gated,
    .candidates = candidates,
    .method = &method,
    .promise = promise,
    .cost = wk_cost,
    .errors = wk_errors,
    WK_CALLBACKS,
};
