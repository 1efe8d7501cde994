#include "backprojection/law_spectrum.h"

#include <math.h>
#include <stdlib.h>

#include "common/fft_length.h"
#include "common/pulse_band.h"

enum { GAUSS = 8, BINS = LAW_NODES, FINER = 16 };
/* The positive half of Gauss and Legendre's 16 points. */
static const double node[GAUSS] = {0.0950125098376374, 0.2816035507792589, 0.4580167776572274, 0.6178762444026438,
                                   0.7554044083550030, 0.8656312023878318, 0.9445750230732326, 0.9894009349916499};
static const double weight[GAUSS] = {0.1894506104550685, 0.1826034150449236, 0.1691565193950025, 0.1495959888165767,
                                     0.1246289712555339, 0.0951585116824928, 0.0622535239386479, 0.0271524594117541};

/* The share of the flanks in the energy of pulses of some cycles: with more outside, the band lies elsewhere. */
static const double FLANKS = 0.01;

/* The replica's own, in bins whose nodes are their middles of energy: an interpolator's error grows steeply at the
   band's edges. False without memory. */
static bool replica_spectrum(const struct acquisition *a, double cells, struct law_spectrum *spectrum)
{
    const int length = fft_length_fast((long long)fmax(2.0 * a->pulse_length, FINER * BINS));
    double *energy = pulse_energy(a, length), shown = 0, amplitudes = 0, places[BINS][2] = {{0}};
    if (!energy)
        return false;
    *spectrum = (struct law_spectrum){.count = BINS, .reach = BINS / 3.0};
    for (int k = 0; k < length; k++) {
        const double nu = fmin(k, length - k) / (double)length, amplitude = sqrt(energy[k]);
        const double seen = energy[k] * image_gain(a, cells, pulse_bin_frequency(a, k, length));
        const int n = (int)fmin(2 * BINS * nu, BINS - 1);
        shown += seen;
        amplitudes += amplitude;
        places[n][0] += nu * seen;
        places[n][1] += nu * amplitude;
        spectrum->weight[n] += seen;
        spectrum->scattered[n] += energy[k];
        spectrum->amplitude[n][2 * k > length] += amplitude;
    }
    free(energy);
    /* The energy of compressed white noise is in proportion to the echoes' amplitude. */
    const double echo = (1 - a->noise) / shown, noise = a->noise / amplitudes;
    for (int n = 0; n < BINS; n++) {
        const double beside = noise * (spectrum->amplitude[n][0] + spectrum->amplitude[n][1]);
        const double all = echo * spectrum->weight[n] + beside;
        const double place = echo * places[n][0] + noise * places[n][1];
        spectrum->weight[n] = all;
        spectrum->nu[n] = all > 0 ? place / all : (n + 0.5) / (2 * BINS);
        spectrum->scattered[n] = echo * spectrum->scattered[n] + beside;
        for (int side = 0; side < 2; side++)
            spectrum->amplitude[n][side] /= amplitudes;
    }
    return true;
}

bool law_spectrum(const struct acquisition *a, double cells, struct law_spectrum *spectrum)
{
    const double band = fmin(a->bandwidth / a->fs, 1);
    if (!a->compressed)
        return replica_spectrum(a, cells, spectrum);
    *spectrum = (struct law_spectrum){.count = GAUSS, .reach = GAUSS / 2 / band};
    const double beside = a->noise * (1 - band);
    double gain[GAUSS], shown = 0;
    for (int n = 0; n < GAUSS; n++) {
        const double frequency = node[n] * band / 2 * a->fs;
        gain[n] = (image_gain(a, cells, frequency) + image_gain(a, cells, -frequency)) / 2;
        shown += weight[n] * gain[n];
    }
    for (int n = 0; n < GAUSS; n++) {
        spectrum->nu[n] = node[n] * band / 2;
        spectrum->scattered[n] = weight[n] / shown * (1 - beside);
        spectrum->weight[n] = spectrum->scattered[n] * gain[n];
        spectrum->amplitude[n][0] = spectrum->amplitude[n][1] = weight[n] / 2;
    }
    for (int n = 0; n < 2 * GAUSS && beside > 0; n++) { /* from the band's edge to half the sampling rate */
        const int m = spectrum->count++;
        const double place = n < GAUSS ? -node[GAUSS - 1 - n] : node[n - GAUSS];
        spectrum->nu[m] = (1 + band + place * (1 - band)) / 4;
        spectrum->weight[m] = spectrum->scattered[m] = weight[n < GAUSS ? GAUSS - 1 - n : n - GAUSS] / 2 * beside;
    }
    return true;
}

double law_band(const struct law_spectrum *spectrum, const struct acquisition *a, double outside)
{
    double sum = 0;
    for (int n = spectrum->count - 1; n > 0; n--) {
        sum += spectrum->weight[n];
        if (sum > outside)
            return fmax(a->bandwidth, a->fs * (spectrum->nu[n] + spectrum->nu[n - 1]));
    }
    return a->bandwidth;
}

double law_band_fitted(const struct acquisition *a)
{
    struct acquisition echoes = *a;
    struct law_spectrum spectrum;
    if (a->compressed)
        return a->bandwidth;
    echoes.noise = 0;
    return law_spectrum(&echoes, 0, &spectrum) ? law_band(&spectrum, a, FLANKS) : NAN;
}
