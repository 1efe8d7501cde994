/* Omega-k behind the polar-format spatial filter (PF05): echoes from outside the scene's target area are removed first
   (wavenumber/polar_filter.h). A scene without a target area is imaged unfiltered.

   Error against the image of all echoes: the energy that the filter removes inside and keeps outside. PF05's scene, by
   sub-apertures 1/2/4/8: outside energy down by 7.5/10.6/19.6/19.5 dB, kept -1.5/-.35/-.15/-.11 dB; with curvature=on
   one sub-aperture gives 21 dB. */
#include "wavenumber/wk.h"

static const char *const curvature_names[] = {"off", "on", NULL}, *const band_names[] = {"narrow", "wide", NULL};

static const struct param params[] = {
    {PARAM(struct wk_options, subapertures), .summary = "of the filter; 0: as few as need no upsampling", .initial = 4,
     .min = 0, .max = 4096, .sweep = "1 2 4 8 0"},
    {PARAM_NAMED(struct wk_options, curvature, curvature_names),
     .summary = "remove the wavefronts' curvature ahead of the mask", .initial = 0, .max = 1, .sweep = "off on"},
    {PARAM_NAMED(struct wk_options, band, band_names),
     .summary = "of the filter's mapping: the carrier's, or each frequency's own", .max = 1, .terse = true},
    WK_TAPS_PARAM,
    {.name = NULL},
};

static const struct wk_method method = {.name = "wk_polar", .filters = true};

static const char *const gated[] = {"subapertures=1", "subapertures=1,curvature=on,precision=double", NULL};

const struct algorithm wk_polar = {
    .name = "wk_polar",
    .summary = "omega-k behind the polar-format spatial filter of a target area",
    .reference = "PF05 Eqs. (5) to (16), corrected",
    .traits = TRAIT_AREA,
    .options_size = sizeof(struct wk_options),
    .params = params,
    .gated = gated,
    .method = &method,
    WK_CALLBACKS,
};
