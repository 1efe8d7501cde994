/* Omega-k imaging of monostatic echoes, broadside or squinted (SQ18), with or without the polar-format filter ahead
   (PF05).

   The echo of a point at (x, r), seen from X, has the range spectrum exp(-j K_R R(X)), K_R = 4 pi F/c, and along the
   track the spectrum exp(-j (Kx x + Ky r)): an image is the inverse transform over (Kx, Ky), onto which the spectrum
   over (Kx, K_R) is interpolated (Stolt). A beam that looks at an angle theta off broadside has its wavenumbers about
   K_R sin theta, which the pings alias. Two ways to put them in their place:

       unfolded   Kx is laid out as far as the beam's wavenumbers reach, and the alias that belongs to a cell is the one
                  nearest to K_R sin theta; axes are the track's. wk_classic.
       rotated    the centroid is removed, S(K_R, X) exp(-j K_R sin theta X), so that wavenumbers lie about zero; axes
                  are turned by theta (SQ18 Eqs. (6) to (9)):
                      Kx0 = Kx cos theta - Ky sin theta,  Ky0 = Kx sin theta + Ky cos theta,  K_R^2 = Kx0^2 + Ky0^2.
                  Interpolated along azimuth first, from Kx - K_R sin theta to Kx0 (SQ18 Eq. (12)), and then along
                  range. wk_squint.

   SQ18 prints exp(+j K_R R) in Eq. (2), with which Eq. (3) would double the centroid; the phase is -K_R R.
   Both are exact for a platform that moves while the pulse travels: at the speed v, b = v^2/c^2, it is
       F = v Kx/(4 pi) + sqrt((c Kx/(4 pi))^2 + (1 - b) (c Ky/(4 pi))^2)
   (spectrum_monostatic solved for F), in any axes. Scale and phase are those of back projection: each cell has the
   weight of range_migration/rma.h. Stages:

       compress   matched filter; wk_polar: the filter
       range      FFT of each record, the centroid removed
       azimuth    FFT over the pings
       rotate     azimuth interpolation (rotated axes only)
       stolt      range interpolation onto Ky, phases and weights
       focus      range IFFT onto the rows
       inverse    azimuth IFFT onto the columns
       resample   two-dimensional interpolation, for a grid that lies in other axes */
#ifndef SASBENCH_WAVENUMBER_WK_H
#define SASBENCH_WAVENUMBER_WK_H

#include "contract/algorithm.h"

enum wk_unfold { WK_STUFF, WK_BASEBAND, WK_SUPPORT };

struct wk_options {
    int unfold;       /* enum wk_unfold */
    int taps;         /* index into wk_taps_names: of all interpolations */
    double pad;       /* rotated axes: length of the azimuth transform over the pings */
    int subapertures; /* of the filter; 0: as many as need no upsampling */
    int curvature;    /* 1: the filter removes the wavefronts' curvature */
    int band;         /* 1: the filter maps the wide band */
    int window;       /* of the interpolations: 0 Kaiser; 1 none, a truncated sinc */
    int weighting;    /* of the azimuth spectrum: 0 none; 1 Hamming, an image of another main lobe */
};

extern const char *const wk_taps_names[], *const wk_unfold_names[];

#define WK_TAPS_PARAM                                                                                                  \
    {                                                                                                                  \
        PARAM_NAMED(struct wk_options, taps, wk_taps_names), .summary = "Kaiser taps of the Stolt interpolation",      \
                                                             .initial = 2, .max = 4, .sweep = "4 6 8 12 16"            \
    }

struct wk_method {
    const char *name;
    bool rotates; /* works in axes turned by the squint; unfold is then WK_SUPPORT */
    bool filters; /* the polar-format filter comes first; unfold is then WK_SUPPORT, pad 1 */
};

/* The callbacks of struct algorithm, whose `method` is a struct wk_method, and whose options a struct wk_options. */
#define WK_CALLBACKS                                                                                                   \
    .conditions = wk_conditions, .plan = wk_plan, .execute = wk_execute, .reads = wk_reads, .work = wk_work,           \
    .destroy = wk_destroy
enum status wk_plan(const struct problem *problem, const void *method, const void *options, void **plan);
/* A method that rotates needs a slower platform; one that filters has a condition on the loss of its own targets. */
int wk_conditions(const struct problem *problem, const void *method, const void *options, struct condition *list,
                  int room);
/* Counts, and errors of the interpolations: INFINITY with a filter, without a window or with weights, and with turned
   axes if the azimuth transform is padded less than 1.25 times. Errors: as wk_plan. */
enum status wk_cost(const struct problem *problem, const void *method, const void *options, struct forecast *forecast);
/* That of the spectrum. */
enum status wk_errors(const struct problem *problem, const void *method, const void *options,
                      struct forecast *forecast);
enum status wk_execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages);
void wk_reads(const void *plan, bool *read);
struct work wk_work(const void *plan);
void wk_destroy(void *plan);

/* Azimuth samples of the transform, over those recorded: SQ18's zeros. Unfolded: wavenumbers over the pings' own band;
   rotated: the padding. */
double wk_size_factor(const void *plan);

#endif
