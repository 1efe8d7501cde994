/* Conditions for range migration to image a scene correctly (condition.h). */
#ifndef SASBENCH_RANGE_MIGRATION_RMA_CONDITIONS_H
#define SASBENCH_RANGE_MIGRATION_RMA_CONDITIONS_H

#include <stdbool.h>

#include "contract/condition.h"
#include "range_migration/rma.h"

/* Input of the conditions: a uniform straight track along x, and the rows and columns wanted. */
struct rma_view {
    const struct problem *problem;
    const struct rma_method *method;
    struct spectrum_setting setting;
    double x_low, x_high, spacing; /* m: the track's ends; ping to ping, > 0 */
    bool converts;                 /* needs a formula: not a single receiver at the transmitter */
    struct rma_bounds bounds;
    double beam_sine; /* of the echoes' beam at the transmitter; INFINITY: no limit */
    /* Omega-k alone, which keeps all wavenumbers of the pings: */
    double slope;  /* the middle of them, Kx over K_R */
    double period; /* pings and zeros; 0: range migration */
};

/* A method as its options make it. */
struct rma_method rma_choose(const struct rma_method *method, const struct rma_options *options);

struct rma_view rma_view_of(const struct problem *problem, const struct rma_method *method,
                            const struct straight_track *track);

/* |sin theta_t|, off the beam's axis, up to which azimuth transforms follow echoes: the transmitter's first null at the
   lowest frequency, or the stated end of echoes that do not taper. */
double rma_widest_sine(const struct acquisition *acquisition);

/* Append to list the requirements of every image by azimuth transforms (above_dc, uniform_track, pings, whole_aperture,
   in_front), and fill *track. False where one of them is not met. */
bool azimuth_requirements(const struct problem *problem, struct condition *list, int *count,
                          struct straight_track *track);

/* ---- prediction.c: the error of an image before it is formed, of a point target in azimuth ---- */

/* Relative L2 error of azimuth slices through point targets on the wanted columns (1), the worst of every patch's first
   and last row and of some between them; INFINITY where no ping sees any of them, NAN without memory. */
double prediction_error(const struct rma_view *view);

/* ---- ghosts.c: grating lobes, where back projection and azimuth transforms differ by principle ---- */

/* The condition grating_lobes of a uniform straight track (acquisition_is_straight) and patches at r > 0, turned or
   not. At a pixel, back projection also sums pings from which its wavenumber is not sampled. Echoes of such a ping from
   elsewhere at the same delay are a ghost in back projection's image, not in that of a transform. With an aperture
   limit it may be the other way round. The value is the ghosts of point targets in the patches over the targets' own
   images (relative L2), the worst of the patches. It refuses where a patch has ghosts of the other patches' targets,
   and with an aperture limit. Without a limit, it warns where a patch is so wide that targets at its ends make ghosts
   within it: whether there are such targets is unknown (omega-k refuses there too, as it predicts no error). */
struct condition ghosts_condition(const struct problem *problem, const struct straight_track *track);

/* ---- rma_conditions.c ---- */

/* rma_conditions: conditions_general among them. A possible cause of a large error (doppler, the formula's law) refuses
   only where the predicted error is too large, and then in its place; without such a cause predicted_error itself
   refuses. spa_amplitude always refuses: the prediction assumes the transmitter's beam for each pair. Its value is NAN
   without memory. */

/* The last condition, which refuses beyond the method's error_limit. */
struct condition rma_predicted_error(const struct rma_view *view);

/* STATUS_UNSUPPORTED as conditions_check, STATUS_FAILED where a value is NAN without memory. */
enum status rma_conditions_check(const char *method, const struct condition *list, int count);

/* STATUS_UNSUPPORTED where track, axes or rows alone refuse; far cheaper than rma_conditions. */
enum status rma_requirements_check(const struct problem *problem, const char *method);

/* Relative energy that an image loses at the ends of the band: beyond the band that it keeps, up to `edge` (cycles a
   sample) inside of it, or at half the sampling rate. Errors: STATUS_FAILED without memory. */
enum status rma_band_lost(const struct rma_view *view, double edge, double *lost);
/* rma_cost's errors: STATUS_UNSUPPORTED as rma_requirements_check, and where transforms, work or memory are too large;
   STATUS_FAILED without memory. rma_errors's: as rma_conditions_check. */

#endif
