/* Exact images of some dozen pixels: direct sums over all pings and receivers in extended precision, without the
   engines and the simulator.

   Two questions, two sums. Is the image right? exact_ideal evaluates closed-form echoes at exact delays. Is a method
   computed with care? exact_method does the method's own interpolation of the recorded samples in long double, so
   that it differs from the program's image by rounding alone. */
#ifndef SASBENCH_STABILITY_EXACT_IMAGE_H
#define SASBENCH_STABILITY_EXACT_IMAGE_H

#include "scene/scene.h"

/* One pixel of a direct sum. */
struct exact_sum {
    long double re, im;
    long double size; /* sum of |weight sample| over pairs and taps: rounding is relative to it */
    long double ties; /* possible change of the pixel by ties: at rounded positions or the record's end */
    int pairs;        /* summed */
};

enum { EXACT_TAPS_MOST = 16 };

/* How a method reads a record between its samples: rows as in struct interpolator (backprojection/bp.h). */
struct exact_reading {
    enum record_reading kind;
    int upsample;       /* nearest, fitted, polynomial: by zero padding; else 1 */
    int phases;         /* > 0: positions are rounded to 1/phases of an upsampled sample */
    int degree;         /* polynomial */
    int taps;           /* sinc, fitted: at most EXACT_TAPS_MOST then */
    double kaiser;      /* sinc: the window's parameter, 0 for none */
    double band;        /* fitted: bandwidth over upsampled rate */
    double slack_s;     /* uncertainty of delays in the method under test (s) */
    double slack_point; /* and of positions, in upsampled samples */
};

/* Pixels of all patches of a problem or scene, patch after patch, row by row. */
size_t exact_pixels(int patch_count, const struct grid *patches);

/* NULL where the closed form covers the scene, else what it does not cover. It covers flat pulses without noise or
   frequency-dependent beams. */
const char *exact_ideal_excludes(const struct scene *scene);

/* The image of the scene's closed-form echoes: each is its band's inverse transform over the record's period,
   sin(pi K x/N)/(K tan(pi x/N)) or /(K sin(pi x/N)), which tends to sinc(B t) for long records (exact_echo). Fills
   sums[exact_pixels]. Errors: STATUS_FAILED without memory. */
enum status exact_ideal(const struct scene *scene, struct exact_sum *sums);
/* The echo at t seconds from its middle. */
long double exact_echo(const struct acquisition *acquisition, long double t);

/* The image of range-compressed double samples by a method's own reading. Errors: STATUS_FAILED without memory. */
enum status exact_method(const struct problem *problem, const double complex *samples,
                         const struct exact_reading *reading, struct exact_sum *sums);

#endif
