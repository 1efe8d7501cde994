/* Delay compensation: multi-receiver echoes become monostatic ones without range blocks.

   At broadside, a receiver at offset d differs from a monostatic sonar by a delay that depends on range alone. The
   delay is undone exactly, in time: record x of receiver i becomes

       y(tau) = x(tau + abeam_i(tau)) exp(j 2 pi fc abeam_i(tau))

   by taps of least squares. After the FFT along azimuth, the remaining phase depends weakly on wavenumber nu and range
   r = tau/slowness(nu): rho_i(nu, r), spectrum_residual. Its phasor is very nearly of rank two over the receivers,
   exp(j rho_i) = sum over q of V_qi U_q(nu, r),  so that

       z(nu, tau) = sum over q of U_q(nu, tau/slowness) sum over i of V_qi exp(-j pi nu d_i) y_i(nu, tau)

   is a monostatic echo, which the engine focuses like any other (rma.h). The V are the first principal vectors of the
   phasors within the beam, U their coefficients, tabulated over the angle and 1/r.

   The second sum goes in two steps where receivers are evenly spaced and `periods` = 2 |spacing|/pitch is whole: from a
   wavenumber to that of the same spectra periods/fold times 1/spacing beyond it, receiver i is turned by exp(-j 2 pi
   i/fold), as is i + fold. Sums over i modulo fold serve a class of wavenumbers, each of which adds up fold of them.

   Cost: 2 (taps + 3) multiply-adds a sample, then 2 + terms complex ones a receiver, class and sample, and fold/2 more
   a term, wavenumber and sample.
   Error: spectrum_compensated for the phase, `left` for the rank, the taps' own for the delays. */
#ifndef SASBENCH_RANGE_MIGRATION_DELAY_COMPENSATION_H
#define SASBENCH_RANGE_MIGRATION_DELAY_COMPENSATION_H

#include <complex.h>

#include "range_migration/rma_conditions.h"

enum {
    DELAY_TERMS = 3, /* at most */
    DELAY_TAPS = 24, /* at most */
    DELAY_INTERVALS = 256
};
#define DELAY_NEAREST 0.5 /* of the nearest row: the least range with a delay */

/* V and U, in double. */
struct delay_terms {
    int terms, receivers, angles, ranges;
    double angle_first, angle_step;     /* rad off broadside, of the monostatic spectrum at fc */
    double inverse_first, inverse_step; /* 1/m */
    double *basis;                      /* [terms][receivers], orthonormal; an unneeded term is zero */
    double complex *coefficients;       /* [angles][terms][ranges]: U */
    double left;                        /* relative L2 error of the phasors within the beam by the terms */
    double bytes;
};

/* `left` of `count` terms for the rows and the beam of a view; NAN without memory. */
double delay_terms_left(const struct rma_view *view, int count);
/* The terms themselves. False without memory; call delay_terms_free in any case. */
bool delay_terms_make(const struct rma_view *view, int count, struct delay_terms *terms);
void delay_terms_free(struct delay_terms *terms);
/* The first of four angles of the table about nu (cycles/m), and their weights: U is their weighted sum. */
int delay_terms_place(const struct delay_terms *terms, const struct spectrum_setting *setting, double nu,
                      double weights[4]);
/* nu at an angle of the table. */
double delay_terms_wavenumber(const struct delay_terms *terms, const struct spectrum_setting *setting, int angle);
/* U_q at an angle of the table and range r; constant beyond the table. */
double complex delay_terms_value(const struct delay_terms *terms, int angle, int q, double r);

/* Taps of least squares over the compressed pulse's energy spectrum, by the fraction of a sample: tap k weights sample
   k + 1 - taps/2. The samples come at `share` of the echoes' sampling rate. */
struct delay_taps {
    int taps;
    double weights[DELAY_INTERVALS + 1][DELAY_TAPS], slopes[DELAY_INTERVALS + 1][DELAY_TAPS];
};

/* STATUS_FAILED without memory. */
enum status delay_taps_make(const struct acquisition *acquisition, double share, int taps, struct delay_taps *made);
/* The taps' error half-way between two samples, relative L2 of the pulse, at frequencies up to `half` of the echoes'
   sampling rate; NAN without memory. */
double delay_taps_error(const struct acquisition *acquisition, double share, int taps, double half);
/* The taps' error in an image, relative L2, for its receivers' delays and these frequencies; it
   grows as sin(pi fraction). NAN without memory. */
double delay_taps_expected(const struct rma_view *view, double share, int taps, double half);
/* Weights for the signal `fraction` samples (0 to 1) after tap taps/2 - 1, and their slopes over it. */
void delay_taps_weights(const struct delay_taps *taps, double fraction, double *weights, double *slopes);

#endif
