/* Taps fitted by least squares: at every fraction of a sample, the kernel of its length with the least error over a
   flat band |nu| <= band/2 (cycles a sample). With the taps at p_k = k - (taps-1)/2 and u = fraction - 1/2, both in
   samples from the middle of the two nearest samples,

       R w = s,    R_kl = sinc(band (k - l)) + 1e-12 [k = l],    s_k = sinc(band (p_k - u))

   The term 1e-12 keeps R positive where the band is so narrow that fewer taps would do. It adds at most 1e-6 to the
   error where weights are as large as 1. s is a series of Legendre polynomials,

       s_k = sum over n of (2n+1) (+-) P_n(2u) <j_n(pi nu) {cos, sin}(2 pi nu p_k)>

   (< > the mean over the band; cosines with n even, sines with n odd; Abramowitz and Stegun Eq. 10.1.47), so that the
   weights are a smooth function of the fraction even where R is nearly singular. */
#ifndef SASBENCH_BACKPROJECTION_FITTED_H
#define SASBENCH_BACKPROJECTION_FITTED_H

enum { FITTED_TAPS_MOST = 16, FITTED_TERMS = 18 };

struct fitted {
    int taps;
    double terms[FITTED_TERMS][FITTED_TAPS_MOST]; /* [n][k]: of P_n(2u) in the weight of tap k */
};

/* taps even, 2 to FITTED_TAPS_MOST; 0 <= band <= 1. */
void fitted_make(int taps, double band, struct fitted *fitted);

/* Fill w[taps] for a fraction in [0, 1): weights of samples floor(q) + 1 - taps/2 and on. */
void fitted_weights(const struct fitted *fitted, double fraction, double *w);

#endif
