/* Omega-k in the track's axes, with squint handled as the classic way does: azimuth wavenumbers extend as far as the
   beam's, and each cell (Kx, K_R) takes the alias nearest to the centroid K_R sin theta. SQ18 improves upon this.

   unfold sets their extent, which changes the cost and not the image:
       stuff      zeros between the pings, until the band about Kx = 0 contains all: 7 times the pings at 20 degrees
       baseband   the carrier's centroid removed first, then zeros: twice
       support    only the wavenumbers in which the beam has cells: 1.4 times

   Error: that of the method of stationary phase, and of the Stolt interpolation, 2e-4 with 8 taps. */
#include "range_migration/rma.h"
#include "wavenumber/wk.h"

static const struct param params[] = {
    {PARAM_NAMED(struct wk_options, unfold, wk_unfold_names),
     .summary = "zeros between pings for all wavenumbers, the same after basebanding, or the support only",
     .initial = WK_SUPPORT, .max = WK_SUPPORT, .sweep = "stuff baseband support"},
    WK_TAPS_PARAM,
    {PARAM(struct wk_options, pad), .summary = "least length of the azimuth transform over the pings", .initial = 1,
     .min = 1, .max = 4, .terse = true},
    {.name = NULL},
};

static const struct wk_method method = {.name = "wk_classic"};

static const char *const gated[] = {"unfold=stuff", "unfold=baseband", "taps=16,precision=double", NULL};

const struct algorithm wk_classic = {
    .name = "wk_classic",
    .summary = "omega-k, squint unfolded along the track's own azimuth",
    .reference = "SQ18 section 1, [3], [4]",
    .traits = TRAIT_WINDOW,
    .options_size = sizeof(struct wk_options),
    .params = params,
    .gated = gated,
    .method = &method,
    .promise = rma_promise,
    .cost = wk_cost,
    .errors = wk_errors,
    WK_CALLBACKS,
};
