/* Image quality: main-lobe measures of point targets and errors against the reference image. */
#ifndef SASBENCH_METRICS_METRICS_H
#define SASBENCH_METRICS_METRICS_H

#include "scene/scene.h"

enum axis { AXIS_AZIMUTH, AXIS_RANGE };
/* The main-lobe definitions. null: first minimum to first minimum on the fine slice (primary). 3db: the -3 dB width
   (ISLR only), as in BP22 and LBF21 Eqs. (18)-(19). pixel: the slice sampled at the image's own pixels from the
   target's position on, main lobe = peak +-2 pixels, plain sums (azimuth only; as in the papers' tables). */
enum definition { DEFINITION_NULL, DEFINITION_3DB, DEFINITION_PIXEL };

/* Undefined values are NAN here and empty fields in every output. */
struct slice_metrics {
    double extent_m;               /* the slice reaches this far to either side of the target */
    double position_error_m;       /* peak minus true position along the axis */
    double width_m;                /* -3 dB width: linear interpolation of power at half peak */
    double pslr_db[3], islr_db[3]; /* by enum definition */
    char reason[160];              /* why something is undefined; else empty */
};

/* The azimuth or range slice through a point target, interpolated band-limitedly (the range carrier is removed by
   exp(-j 4 pi fc r/c) first), from the patch that contains it, 3 m to either side or to the patch's edge. Samples
   beyond a patch count as zero, so a target off the raster needs 24 samples around it. Never fails: an undefined
   value is NAN with a reason (no patch contains the target, no main lobe that ends inside the slice, steps too
   coarse to interpolate, all zero). */
struct slice_metrics metrics_slice(const struct image *image, const struct acquisition *acquisition,
                                   const struct target *target, enum axis axis);

/* The same slice for plotting: positions (m, relative to the target) and power in dB relative to the peak, malloc'ed
   arrays of *count values each, caller frees. count 0 if there is none. */
void metrics_slice_samples(const struct image *image, const struct acquisition *acquisition,
                           const struct target *target, enum axis axis, double **position_m, double **power_db,
                           int *count);

/* The difference of the complex slices of two images of the same patches, at the same places, in dB over the second
   one's peak: malloc'ed [count], count as above. NULL where there is none, or no memory. */
double *metrics_slice_difference(const struct image *image, const struct image *reference,
                                 const struct acquisition *acquisition, const struct target *target, enum axis axis,
                                 int count);

/* The complex value at a position, interpolated the same way; NAN outside every patch. */
double complex metrics_value(const struct image *image, const struct acquisition *acquisition, double x, double r);

/* Measures of a finished slice of power samples at uniform steps, position 0 = the target: the part of metrics_slice
   that does not interpolate, for tests. pixel_step: the image's own step for DEFINITION_PIXEL (<= 0: undefined). */
struct slice_metrics metrics_of_power(const double *power, int count, double first, double step, double pixel_step);

struct error_metrics {
    double error;         /* complex relative L2 */
    double error_gain;    /* after one best complex gain (over all pixels) */
    double phase_rms_rad; /* over pixels with abs(reference) >= 0.1 max, weighted by its square */
    double peak_ratio;    /* max |image - reference| / max |reference| */
    double complex gain;  /* the gain that brings the image nearest to the reference; 0 where the image is zero */
    const char *reason;   /* why something is undefined, a static text; else empty */
};

/* Over all pixels of all patches of `reference` (double), looked up in `image` at the same places: image patches
   equal or contain the reference patches on the same raster. All NAN, with the reason, when they do not, when the
   reference is all zero or when a pixel of the image is not finite. The phase is NAN when a strong pixel of the
   image is zero. */
struct error_metrics metrics_error(const struct image *image, const struct image *reference);

/* Does the image contain all pixels of the patches, as metrics_error looks them up? Errors: STATUS_INVALID, naming
   where the pixels lie and where they are needed. */
enum status metrics_cover(const struct image *image, int count, const struct grid *patches);

/* The shift of the image's first patch against the reference's first patch, of equal shape, along its axes: the peak
   of their cross-correlation, by a parabola through its three samples. NAN where one is zero or not finite, or
   without memory. */
struct shift {
    double x_m, r_m;
};
struct shift metrics_shift(const struct image *image, const struct image *reference);

/* How sharp an image is, over all of its pixels, whatever it shows. I is a pixel's power. NAN where the image is
   zero or not finite, peak_over_median also where more than half of the pixels are zero. */
struct sharpness {
    double entropy;          /* -sum q ln q, q = I/sum I: 0 for one bright pixel, ln of their number for even ones */
    double contrast;         /* standard deviation of I over its mean */
    double peak_over_median; /* of the magnitudes */
    double peak;             /* magnitude of the brightest pixel that is finite; 0 without one */
    double x, r;             /* m, its place in the track's axes */
};
struct sharpness metrics_sharpness(const struct image *image);

#endif
