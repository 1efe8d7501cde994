/* What a scene must fulfil for range migration to image it rightly (condition.h). */
#ifndef SASBENCH_RANGE_MIGRATION_RMA_CONDITIONS_H
#define SASBENCH_RANGE_MIGRATION_RMA_CONDITIONS_H

#include <stdbool.h>

#include "contract/condition.h"
#include "range_migration/rma.h"

/* What the conditions look at: a uniform straight track along x, and the rows and columns wanted. */
struct rma_view {
    const struct problem *problem;
    const struct rma_method *method;
    struct spectrum_setting setting;
    double x_low, x_high, spacing; /* m: the track's ends; ping to ping, > 0 */
    bool converts;                 /* not a single receiver at the transmitter, which needs no formula */
    struct rma_bounds bounds;
    double beam_sine; /* of the echoes' beam at the transmitter; INFINITY: everything is seen */
    /* Omega-k alone, which keeps all wavenumbers that the pings hold: */
    double slope;  /* the middle of them, Kx over K_R */
    double period; /* pings and zeros; 0: range migration */
};

struct rma_view rma_view_of(const struct problem *problem, const struct rma_method *method,
                            const struct straight_track *track);

/* |sin theta_t|, off the beam's axis, up to which azimuth transforms follow echoes: the transmitter's first null at the
   lowest frequency, or the stated end of echoes that do not taper. */
double rma_widest_sine(const struct acquisition *acquisition);

/* The transmitter's places that echo a row at range r of a patch, from its columns: [*low, *high] m ahead of the pixel.
   False where there are none. */
bool rma_view_aperture(const struct rma_view *view, const struct grid *patch, double r, double *low, double *high);

/* Append to list what every image by azimuth transforms takes for granted (above_dc, uniform_track, pings,
   whole_aperture, in_front), and fill *track. False where one of them does not hold. */
bool azimuth_requirements(const struct problem *problem, struct condition *list, int *count,
                          struct straight_track *track);

/* The conditions of range migration by a method, conditions_general among them. What may cause a large error
   (doppler, the formula's law) refuses only where the predicted error is too large, and then stands for it; without
   such a cause predicted_error itself refuses. spa_amplitude always refuses: the prediction takes the beam of a pair
   for that of its transmitter. Its value is NAN without memory. */
int rma_conditions(const struct problem *problem, const struct rma_method *method, struct condition *list, int room);

/* The last of them, which refuses beyond the method's error_limit. */
struct condition rma_predicted_error(const struct rma_view *view);

/* STATUS_UNSUPPORTED as conditions_check, STATUS_FAILED where a value is NAN without memory. */
enum status rma_conditions_check(const struct rma_method *method, const struct condition *list, int count);

/* STATUS_UNSUPPORTED where track, axes or rows alone refuse; far cheaper than rma_conditions. */
enum status rma_requirements_check(const struct problem *problem, const struct rma_method *method);

/* What an image loses at the ends of the band, energy, relative: beyond what it keeps or up to `edge` (cycles a sample)
   inside of that, or at half the sampling rate. Errors: STATUS_FAILED without memory. */
enum status rma_band_lost(const struct rma_view *view, double edge, double *lost);
/* The forecast by a method, its errors alone. Errors: as rma_conditions_check. */
enum status rma_forecast(const struct problem *problem, const struct rma_method *method,
                         const struct rma_options *options, struct forecast *forecast);
/* Its counts alone. Errors: STATUS_UNSUPPORTED as rma_requirements_check, and where transforms, work or memory are too
   large; STATUS_FAILED without memory. */
enum status rma_cost(const struct problem *problem, const struct rma_method *method, const struct rma_options *options,
                     struct forecast *forecast);

#endif
