/* Numbers of a scene (scene_numbers.h). */
#include "papers/scene_numbers.h"

#include <math.h>
#include <stddef.h>

static double recording_s(const struct acquisition *a)
{
    struct straight_track track;
    return acquisition_is_straight(a, &track) ? a->pings * track.spacing / track.speed : NAN;
}

static double bin_m(const struct acquisition *a)
{
    return a->sound_speed / (2 * a->fs);
}

static double wavelength_m(const struct acquisition *a)
{
    return a->sound_speed / a->fc;
}

static double speed_m_s(const struct acquisition *a)
{
    struct straight_track track;
    return acquisition_is_straight(a, &track) ? track.speed : NAN;
}

static double sound_speed_m_s(const struct acquisition *a)
{
    return a->sound_speed;
}

/* What the nearest sample misses at most, half a sample, at the edge of the band. */
static double edge_phase_rad(const struct acquisition *a)
{
    return acos(-1) * a->bandwidth / (2 * a->fs);
}

/* What linear upsampling by beta leaves at the edge of the band: the nearest of its points lies up to 1/(beta + 1)
   of the way off that a nearest sample does, and a point's own phase, atan(t tan(edge)), is not the line's, t edge. */
static double linear_bound_rad(const struct acquisition *a, int beta)
{
    const double edge = edge_phase_rad(a);
    double bent = 0;
    for (int k = 1 - beta; k < beta; k += 2) {
        const double t = (double)k / (beta + 1);
        bent = fmax(bent, fabs(atan(t * tan(edge)) - t * edge));
    }
    return edge / (beta + 1) + bent;
}

static double linear_2_bound_rad(const struct acquisition *a)
{
    return linear_bound_rad(a, 2);
}

static double linear_8_bound_rad(const struct acquisition *a)
{
    return linear_bound_rad(a, 8);
}

static double tx_length_m(const struct acquisition *a)
{
    return a->tx_length;
}

const char *const scene_number_names[] = {
    "bin_m",           "wavelength_m",   "tx_length_m",        "recording_s",        "speed_m_s",
    "sound_speed_m_s", "edge_phase_rad", "linear_2_bound_rad", "linear_8_bound_rad", NULL};

double scene_number_value(int place, const struct acquisition *acquisition)
{
    static double (*const numbers[])(const struct acquisition *) = {
        bin_m,           wavelength_m,   tx_length_m,        recording_s,       speed_m_s,
        sound_speed_m_s, edge_phase_rad, linear_2_bound_rad, linear_8_bound_rad};
    return numbers[place](acquisition);
}
