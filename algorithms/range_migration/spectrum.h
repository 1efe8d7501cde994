/* The phase of one pair's two-dimensional echo spectrum: range frequency by azimuth wavenumber (LBF21 section III).

   Units: offset d of the receiver ahead of the transmitter (m), the target's range r (m, > 0), F = fc + f_tau the
   absolute frequency (Hz, > 0), azimuth wavenumber nu in cycles a metre of track. The papers' Doppler frequency is
   f = v nu; in nu nothing divides by the speed, so that a platform that stops and hops (v = 0) is no special case.
   Result: radians, of a unit target at azimuth 0; a target at x adds -2 pi nu x.

       sin theta = c nu/(2F),   S = sqrt(F^2 - (c nu/2)^2) = F cos theta,   Delta = d + 2 r v/(c cos theta)

   Cells with S^2 <= 0 are evanescent and give NAN (the exact spectra have their own bounds, below), without raising
   FE_INVALID. */
#ifndef SASBENCH_RANGE_MIGRATION_SPECTRUM_H
#define SASBENCH_RANGE_MIGRATION_SPECTRUM_H

struct spectrum_setting {
    double sound_speed, speed; /* c, v: m/s */
    double fc;                 /* Hz, for the formulas that take theta at the carrier */
    double reference_offset;   /* m: d of the receiver that spectrum_wu refers to */
};

typedef double spectrum_function(const struct spectrum_setting *setting, double d, double r, double frequency,
                                 double nu);

/* Stationary phase on the exact delay (LBF21 Eqs. (8), (9)), the stationary point found to rounding for any speed below
   sound and any r > 0. Its spectrum lies where  -1/(1 - v/c) < sin theta < 1/(1 + v/c);  NAN elsewhere, and for r <=
   0. */
spectrum_function spectrum_exact;
/* Loffeld's formula, -(psi + psi_i/2), LBF21 Eqs. (3) to (5). `printed` takes theta at fc, as the paper does: the whole
   error that it reports for its first receiver. `corrected` takes theta at F. */
spectrum_function spectrum_lbf_printed, spectrum_lbf_corrected;
/* LBF21 Eq. (7): Eq. (5) with S^3/F^2 replaced by F, theta at fc, as in its Figs 3 and 8. */
spectrum_function spectrum_lbf7;
/* Phase-centre approximation, LBF21 Eq. (6). */
spectrum_function spectrum_pca;
/* Reference range history. Wu's own paper was not available; this is a working definition: the PCA phase of a
   reference receiver, plus each receiver's exact broadside delay less the reference receiver's. */
spectrum_function spectrum_wu;

/* Delay compensation (delay_compensation.h): of the exact spectrum, -phi = r K - pi nu d + 2 pi F beta(nu/F, r), it
   takes beta at broadside, at the range where the target's echo arrives, and the rest at the carrier:

       -phi = r K - pi nu d + 2 pi F abeam(d, r walk(nu)) + residual(d, r, nu). */
spectrum_function spectrum_compensated;
/* beta at nu = 0: delay (s) of the echo of a receiver at offset d after that of d = 0, r > 0. */
double spectrum_abeam(const struct spectrum_setting *setting, double d, double r);
/* dK/dF at fc, relative to nu = 0: the factor of ranges by the walk. NAN where evanescent. */
double spectrum_walk(const struct spectrum_setting *setting, double nu);
/* Radians at fc. */
double spectrum_residual(const struct spectrum_setting *setting, double d, double r, double nu);

/* Exact for d = 0: the phase is -r times this (rad/m), b = v^2/c^2:
   (4 pi/c) sqrt((F/(1-b))^2 - (c nu/2 + F v/(c (1-b)))^2). NAN where evanescent. */
double spectrum_monostatic(const struct spectrum_setting *setting, double frequency, double nu);
/* (1/2 pi) dK/dF, K the factor of -r: delay over range (s/m). NAN where evanescent. */
double spectrum_slowness(const struct spectrum_setting *setting, double frequency, double nu);

/* nu at fc of echoes that come from `angle` (rad) ahead of broadside to d = 0 at emission; and back, within +-pi/2. */
double spectrum_wavenumber(const struct spectrum_setting *setting, double angle);
double spectrum_angle(const struct spectrum_setting *setting, double nu);

/* The exact delay (s) of a target at range r, the transmitter u metres ahead of it, and its slope over u (s/m). */
double spectrum_delay(const struct spectrum_setting *setting, double d, double r, double u);
double spectrum_slope(const struct spectrum_setting *setting, double d, double r, double u);

#endif
