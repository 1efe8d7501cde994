/* How both engines read records: the interpolator with its weights tabulated, and the medium. */
#ifndef SASBENCH_BACKPROJECTION_READING_H
#define SASBENCH_BACKPROJECTION_READING_H

#include <stdbool.h>

/* Receivers' speed over the speed of sound. Below it cancellation in the delay's root (q + s)/e costs less than a bit
   (delay.h), and the division of the other form is avoided. */
#define BP_SLOW 0.125

/* How a value between samples is read. */
enum bp_reading {
    BP_NEAREST, /* the nearest value: one tap */
    BP_LINE,    /* two weights, 1 - f and f of the fraction f rounded to a step: no table is read */
    BP_STEPS,   /* weights [steps][taps] of the fraction rounded to a step */
    BP_CUBICS,  /* weights that are cubics in the fraction's position inside each of BP_INTERVALS intervals,
                   [BP_INTERVALS][4][taps], lowest power first */
    BP_BRANCHES /* the nearest place's `taps` values, one of each Farrow branch (farrow.h): coefficients of a polynomial
                   in the distance from there, lowest power first */
};
enum { BP_INTERVAL_BITS = 8, BP_INTERVALS = 1 << BP_INTERVAL_BITS };
enum { BP_BRANCHES_GUARD = 16 }; /* values around a record: as many as a vector loads at once */
enum { BP_STEPS_MOST = 4096 };   /* between two samples: times 19 bits of fraction, they fit 31 bits (general/run.h) */

/* struct interpolator with its weights tabulated. */
struct bp_table {
    enum bp_reading reading;
    int upsample, steps, taps, first, guard;
    int origin;          /* place of the record's sample 0 in a row: guard, less the samples that the row leaves out
                            before */
    int branches;        /* values of each place of a record: `taps` if BP_BRANCHES, else 1 */
    double shift;        /* branches: they are read at floor(place + shift), u = place + shift - 1/2 from there */
    bool preemphasis;    /* of the records (struct traces_form) */
    const void *weights; /* of the plan's precision; NULL if BP_NEAREST */
};

struct bp_medium {
    double sound_speed, fc, fs;
    double first, last; /* samples of a record between which every pair's delay lies, both included */
    double phase_limit; /* rad: L of the error budget (backprojection/budget.h); 0: every delay is evaluated */
};

#endif
