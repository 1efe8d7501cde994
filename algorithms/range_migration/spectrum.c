/* Two-dimensional spectra of one transmitter and receiver (spectrum.h). */
#include "range_migration/spectrum.h"

#include <math.h>
#include <stdbool.h>

/* Evanescent cells raise no exception, as they are no error. */
static double root_of(double square)
{
    return square > 0 ? sqrt(square) : NAN;
}

/* The exact delay (LBF21 Eq. (1)) and its first two derivatives, for the transmitter u metres ahead of the target: the
   way out, and the way back to a receiver that is b metres ahead of the target when the wave is there. Nothing cancels,
   at any speed. */
struct history {
    double delay, slope, curvature; /* s, s/m, s/m^2 */
};

static struct history history_at(const struct spectrum_setting *setting, double d, double r, double u)
{
    double c = setting->sound_speed, v = setting->speed, e = (c - v) * (c + v);
    double range = sqrt(u * u + r * r), out1 = u / (range * c), out2 = r / range * (r / range) / (range * c);
    double b = u + d + v * range / c, b1 = 1 + v * out1, b2 = v * out2;
    double root = sqrt(c * b * c * b + e * r * r), along = v * b;
    double back = along >= 0 ? (along + root) / e : (b * b + r * r) / (root - along);
    double back1 = (v + c * b / root * c) / e, back2 = c * r / root * (c * r / root) / root;
    return (struct history){range / c + back, out1 + back1 * b1, out2 + back2 * b1 * b1 + back1 * b2};
}

double spectrum_delay(const struct spectrum_setting *setting, double d, double r, double u)
{
    return history_at(setting, d, r, u).delay;
}

double spectrum_slope(const struct spectrum_setting *setting, double d, double r, double u)
{
    return history_at(setting, d, r, u).slope;
}

double spectrum_exact(const struct spectrum_setting *setting, double d, double r, double frequency, double nu)
{
    const double c = setting->sound_speed, beta = setting->speed / c, b1 = (1 - beta) * (1 + beta);
    const double f = frequency / b1, along = c * nu / 2 + f * beta, square = (f - along) * (f + along);
    if (!(r > 0 && square > 0))
        return NAN;
    const double s = sqrt(square);
    /* In units of the geometry, so that no square under- or overflows; a range below 1e-100 of the offset counts as
       0. */
    const double unit = fmax(r, fabs(d)), offset = d / unit, range = fmax(r / unit, 1e-100), cycles = frequency * unit;
    /* The delay is convex: its slope rises through -nu/F once. Newton's method from the closed form of d = 0, kept
       inside the bracket found so far; without one, within a reach that doubles. */
    double low = -INFINITY, high = INFINITY, reach = 1, u = -range * along / s - offset / 2;
    for (int step = 0; step < 400; step++) {
        const struct history h = history_at(setting, offset, range, u);
        const double excess = h.slope + nu / frequency, newton = u - excess / h.curvature;
        const double rounding = 1e-15 * (1 + cycles * h.delay); /* cycles: below rounding */
        *(excess > 0 ? &high : &low) = u;
        const double left = cycles * excess * excess / h.curvature / 2; /* upper bound of the next step's change */
        if (left <= rounding || cycles * fabs(excess) * (high - low) <= rounding)
            return -2 * M_PI * (cycles * (h.delay + nu / frequency * u) - (left <= rounding ? left : 0));
        const double farthest = excess > 0 ? fmax(low, u - reach) : fmin(high, u + reach);
        const bool within = excess > 0 ? newton >= farthest && newton < high : newton <= farthest && newton > low;
        reach *= 2;
        if (within)
            u = newton;
        else
            u = isfinite(low) && isfinite(high) ? low + (high - low) / 2 : farthest;
    }
    return NAN;
}

/* LBF21 Eqs. (3) to (5) for a given cos theta; `cubed` stands for S^3/F^2. */
static double lbf(const struct spectrum_setting *setting, double d, double r, double nu, double s, double cosine,
                  double cubed)
{
    double c = setting->sound_speed, v = setting->speed, delta = d + 2 * r * v / (c * cosine);
    double psi = -2 * M_PI * v * nu * r / (c * cosine) + 4 * M_PI / c * r * s;
    double psi_i = -2 * M_PI * nu * d + M_PI / c * delta * delta * cubed / r;
    return -(psi + psi_i / 2);
}

static double root(const struct spectrum_setting *setting, double frequency, double nu)
{
    double half = setting->sound_speed * nu / 2;
    return root_of((frequency - half) * (frequency + half));
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
    return pca + M_PI * nu * (d - d0) - 2 * M_PI * frequency * (delay - reference);
}

double spectrum_monostatic(const struct spectrum_setting *setting, double frequency, double nu)
{
    double c = setting->sound_speed, beta = setting->speed / c, f = frequency / ((1 - beta) * (1 + beta));
    double along = c * nu / 2 + f * beta;
    return 4 * M_PI / c * root_of((f - along) * (f + along));
}

/* 2 pi F beta: the exact spectrum minus that of d = 0 and the way of the phase centre. */
static double bistatic(const struct spectrum_setting *setting, double d, double r, double frequency, double nu)
{
    double monostatic = r * spectrum_monostatic(setting, frequency, nu);
    return -spectrum_exact(setting, d, r, frequency, nu) - monostatic + M_PI * nu * d;
}

double spectrum_abeam(const struct spectrum_setting *setting, double d, double r)
{
    return bistatic(setting, d, r, setting->fc, 0) / (2 * M_PI * setting->fc);
}

double spectrum_slowness(const struct spectrum_setting *setting, double frequency, double nu)
{
    double c = setting->sound_speed, beta = setting->speed / c, b1 = (1 - beta) * (1 + beta), f = frequency / b1;
    double along = c * nu / 2 + f * beta;
    return 2 / c * (f - along * beta) / b1 / root_of((f - along) * (f + along));
}

double spectrum_walk(const struct spectrum_setting *setting, double nu)
{
    return spectrum_slowness(setting, setting->fc, nu) / spectrum_slowness(setting, setting->fc, 0);
}

double spectrum_residual(const struct spectrum_setting *setting, double d, double r, double nu)
{
    const double walk = spectrum_walk(setting, nu);
    if (isnan(walk))
        return NAN;
    double abeam = spectrum_abeam(setting, d, r * walk);
    return bistatic(setting, d, r, setting->fc, nu) - 2 * M_PI * setting->fc * abeam;
}

double spectrum_compensated(const struct spectrum_setting *setting, double d, double r, double frequency, double nu)
{
    const double walk = spectrum_walk(setting, nu);
    if (isnan(walk))
        return NAN;
    /* The delay at this frequency and spectrum_residual, which subtracts it at the carrier. */
    double late = 2 * M_PI * (frequency - setting->fc) * spectrum_abeam(setting, d, r * walk);
    return -(r * spectrum_monostatic(setting, frequency, nu) - M_PI * nu * d + late
             + bistatic(setting, d, r, setting->fc, nu));
}

double spectrum_wavenumber(const struct spectrum_setting *setting, double angle)
{
    double c = setting->sound_speed, beta = setting->speed / c, f = setting->fc / ((1 - beta) * (1 + beta));
    return (sin(angle) - beta) * f * 2 / c;
}

double spectrum_angle(const struct spectrum_setting *setting, double nu)
{
    double c = setting->sound_speed, beta = setting->speed / c, f = setting->fc / ((1 - beta) * (1 + beta));
    return asin(fmin(fmax(c * nu / 2 / f + beta, -1), 1));
}
