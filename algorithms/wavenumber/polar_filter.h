/* The polar-format spatial filter (PF05): range-compressed echoes of a monostatic sonar, without those from outside a
   target area. A coarse polar-format image of each sub-aperture is masked, and turned back into echoes:

       e_p(x', F) = e(x', F) exp(+j 2 pi F tau_c(x'))      the delay of the area's centre removed (PF05 Eq. (6))
       FFT over u = x' - x_s, IFFT over F                  at (k, t): sin psi = k/(2 k_c) + sin alpha, R = rho + c t/2,
                                                           alpha, rho: of the centre seen from x_s (Eqs. (14), (15))
       kept where |R cos psi - R_c| < R_a, |x_s + R sin psi - X_c| < X_a     (Eq. (16))
       and all steps back.

   PF05 prints Eqs. (7), (11) and (15) with errors: everything of (7) stands in the exponent, alpha is atan((X_c -
   x_s)/R_c), and psi is counted from broadside. The plane wave misplaces a target: its azimuth is stretched by R/R_c
   about x_s. With curvature=on the quadratic term is removed for each range, exp(+j k_c u^2 (1/R - 1/rho)) in (u, t),
   and restored after the mask: one sub-aperture then replaces the paper's four.

   PF05's k/(2 k_c) is that of the carrier, and a target's place moves with the frequency, by x B/fc over the band. The
   wide band's mapping (PF05 section 5) takes k/(2 k) at each frequency: a chirp transform along the track, in place of
   the FFT, onto wavenumbers that grow with it. That is the interpolation which
   the paper asks for; without a mask it changes echoes by 5e-3 (relative L2).

   Removing the centre's delay widens the azimuth band. So echoes are upsampled along the track (1, 2, 4, ... times): k
   spans 2 k_c (beam + the centre's own sines over a sub-aperture). */
#ifndef SASBENCH_WAVENUMBER_POLAR_FILTER_H
#define SASBENCH_WAVENUMBER_POLAR_FILTER_H

#include "contract/algorithm.h"

struct polar_filter; /* the plan */

struct polar_setting {
    int subapertures; /* 0: as few as need no upsampling */
    bool curvature;
    bool wide; /* the wide band's mapping */
};

struct polar_shape {
    int subapertures, upsampling;
    double flops, bytes; /* of one filtering; of the plan with one thread */
};

/* STATUS_OK when the echoes can be filtered: a uniform straight track, one receiver at the transmitter, two pings, a
   target area at r > 0 that lies in the records. Errors: STATUS_UNSUPPORTED; `place` begins the message. */
enum status polar_filter_check(const struct acquisition *acquisition, const char *place);

/* For echoes that pass the check: the greatest number of sub-apertures; the number chosen where `asked` is 0, else
   `asked`; the first ping of the s-th of `count`; and the factor of upsampling, 1, 2, 4, ..., of `count`. */
int polar_filter_most(const struct acquisition *acquisition);
int polar_filter_subapertures(const struct acquisition *acquisition, int asked);
int polar_filter_begin(const struct acquisition *acquisition, int count, int s);
double polar_filter_upsampling(const struct acquisition *acquisition, int count);
/* Sine of the angle off broadside of the area's centre, seen from x (m). */
double polar_filter_sine(const struct acquisition *acquisition, double x);

/* "area_kept", a warning where a target inside the area loses more than half of its energy: predicted dB, the worst of
   nine places out to 0.8 of the area. */
struct condition polar_filter_kept(const struct acquisition *acquisition, const struct polar_setting *setting);

/* Errors: those of the check, STATUS_FAILED without memory; *filter is NULL then. */
enum status polar_filter_plan_float(const struct acquisition *acquisition, const struct polar_setting *setting,
                                    int threads, struct polar_shape *shape, struct polar_filter **filter);
enum status polar_filter_plan_double(const struct acquisition *acquisition, const struct polar_setting *setting,
                                     int threads, struct polar_shape *shape, struct polar_filter **filter);
/* In place: compressed records, complex [pings][samples]. Allocates nothing; the same bits for any number of
   threads. */
void polar_filter_apply_float(const struct polar_filter *filter, float complex *records);
void polar_filter_apply_double(const struct polar_filter *filter, double complex *records);
void polar_filter_destroy_float(void *filter);
void polar_filter_destroy_double(void *filter);

#endif
