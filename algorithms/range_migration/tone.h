/* A target at one frequency: range migration's azimuth carried out for it.

   The echo of a target at (x', r) at the frequency F is  s_pm = a exp(-j 2 pi F tau_m(x_p - x')),  a the beam's
   amplitude. Range migration transforms it over the pings, adds the receivers up and transforms back (rma.h):

       image(x) = sum over nu of  w(F, nu) exp(+j 2 pi nu x) sum over m of  exp(-j phi_m(F, nu)) X_m(nu),

   X_m(nu) periodic in nu as the pings sample it. Omega-k does so with a lone receiver and wavenumbers about a beam's
   centroid. This is done as it stands, for it costs little at one frequency. What
   goes wrong in azimuth is all in it: wavenumbers that the receivers do not sample, what is seen and not focused, the
   ripple where the track ends, what stationary phase drops, the formula's own phase. */
#ifndef SASBENCH_RANGE_MIGRATION_TONE_H
#define SASBENCH_RANGE_MIGRATION_TONE_H

#include <complex.h>
#include <fftw3.h>
#include <math.h>

#include "common/turns.h"
#include "range_migration/rma_conditions.h"

enum { AZIMUTH_ANGLES = 33 }; /* at which the formula's phase is computed, cubics between */

struct tone {
    bool known; /* where it is; else it stands for all of a patch's rows */
    double r, x, frequency;
    double weight; /* its share of the image */
};

/* What a patch's targets share. */
struct azimuth {
    const struct rma_view *view;
    double nearest;                   /* m: of the rows; range migration alone */
    int period;                       /* pings and zeros after them; 0: too many */
    int wavenumbers;                  /* period x receivers: number q is q/(period spacing) */
    double complex *echoes, *spectra; /* [period][receivers] of one target, and their transform over the pings */
    double complex *wave;             /* [wavenumbers], then columns spacing/receivers apart from the first ping on */
    double angle_step;                /* rad: of AZIMUTH_ANGLES about broadside, as far as the transforms follow */
    double complex *phasors;          /* [AZIMUTH_ANGLES][receivers] */
    double complex *turns; /* [2][receivers]: exp(-j pi nu d) of one wavenumber, and of the step to the next */
    fftw_plan over_pings, to_columns;
};

/* False without memory; azimuth_free in any case. `period` is 0 where receivers times wavenumbers are too many to be
   worth it. */
bool azimuth_make(const struct rma_view *view, const struct grid *patch, struct azimuth *azimuth);
void azimuth_free(struct azimuth *azimuth);
/* Fill `echoes` and range migration's or omega-k's image of them, `wave`. */
void azimuth_form(const struct azimuth *azimuth, const struct tone *target);

/* Of receiver m, m ahead of the transmitter. */
double azimuth_offset(const struct azimuth *azimuth, int m);

/* The row that an echo of a target at range r belongs to, from a ping u ahead of the target, at a column that the ping
   is `at` ahead of: the range there of the same delay. 0: none. */
static inline double tone_row(double r, double u, double at)
{
    return sqrt(fmax(r * r + u * u - at * at, 0));
}

#endif
