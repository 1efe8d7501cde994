/* Two-dimensional spectra of one transmitter and receiver (spectrum.h). */
#include "spectrum.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

/* The exact delay (LBF21 Eq. (1)) and its first two derivatives, for the transmitter u metres ahead of the target. */
struct history {
    double delay, slope, curvature;     /* s, s/m, s/m^2 */
};

static struct history history_at(const struct spectrum_setting *setting, double d, double r, double u)
{
    double c = setting->sound_speed, v = setting->speed, e = (c - v) * (c + v);
    double range = sqrt(u * u + r * r);
    double a = v * (u + d) + c * range, a1 = v + c * u / range, a2 = c * r * r / (range * range * range);
    double root = sqrt(a * a + e * (2 * u + d) * d);
    double root1 = (a * a1 + e * d) / root, root2 = (a1 * a1 + a * a2 - root1 * root1) / root;
    return (struct history){(a + root) / e, (a1 + root1) / e, (a2 + root2) / e};
}

double spectrum_exact(const struct spectrum_setting *setting, double d, double r, double frequency, double nu)
{
    double c = setting->sound_speed, sine = c * nu / (2 * frequency), cosine = sqrt((1 - sine) * (1 + sine));
    double u = -r * sine / cosine - d / 2 - r * setting->speed / (c * cosine);
    struct history h = history_at(setting, d, r, u);
    for (int step = 0; step < 2; step++) {  /* one leaves 8e-9 rad at 20 m, the second serves nearer targets */
        u -= (h.slope + nu / frequency) / h.curvature;
        h = history_at(setting, d, r, u);
    }
    return -2 * pi * (frequency * h.delay + nu * u);
}

/* LBF21 Eqs. (3) to (5) for a given cos theta; `cubed` stands for S^3/F^2. */
static double lbf(const struct spectrum_setting *setting, double d, double r, double nu, double s, double cosine,
                  double cubed)
{
    double c = setting->sound_speed, v = setting->speed, delta = d + 2 * r * v / (c * cosine);
    double psi = -2 * pi * v * nu * r / (c * cosine) + 4 * pi / c * r * s;
    double psi_i = -2 * pi * nu * d + pi / c * delta * delta * cubed / r;
    return -(psi + psi_i / 2);
}

static double root(const struct spectrum_setting *setting, double frequency, double nu)
{
    double half = setting->sound_speed * nu / 2;
    return sqrt((frequency - half) * (frequency + half));
}

double spectrum_lbf_printed(const struct spectrum_setting *setting, double d, double r, double frequency, double nu)
{
    double s = root(setting, frequency, nu), cosine = root(setting, setting->fc, nu) / setting->fc;
    return lbf(setting, d, r, nu, s, cosine, s * s * s / (frequency * frequency));
}

double spectrum_lbf_corrected(const struct spectrum_setting *setting, double d, double r, double frequency, double nu)
{
    double s = root(setting, frequency, nu);
    return lbf(setting, d, r, nu, s, s / frequency, s * s * s / (frequency * frequency));
}

double spectrum_lbf7(const struct spectrum_setting *setting, double d, double r, double frequency, double nu)
{
    double s = root(setting, frequency, nu);
    return lbf(setting, d, r, nu, s, root(setting, setting->fc, nu) / setting->fc, frequency);
}

double spectrum_pca(const struct spectrum_setting *setting, double d, double r, double frequency, double nu)
{
    return lbf(setting, d, r, nu, root(setting, frequency, nu), 1, frequency);
}

double spectrum_wu(const struct spectrum_setting *setting, double d, double r, double frequency, double nu)
{
    double d0 = setting->reference_offset, shift = r * setting->speed / setting->sound_speed;
    double delay = history_at(setting, d, r, -d / 2 - shift).delay;
    double reference = history_at(setting, d0, r, -d0 / 2 - shift).delay;
    double pca = spectrum_pca(setting, d0, r, frequency, nu);
    return pca + pi * nu * (d - d0) - 2 * pi * frequency * (delay - reference);
}

double spectrum_monostatic(const struct spectrum_setting *setting, double frequency, double nu)
{
    double c = setting->sound_speed, beta = setting->speed / c, f = frequency / ((1 - beta) * (1 + beta));
    double along = c * nu / 2 + f * beta;
    return 4 * pi / c * sqrt((f - along) * (f + along));
}
