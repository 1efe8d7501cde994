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

static double tx_length_m(const struct acquisition *a)
{
    return a->tx_length;
}

const char *const scene_number_names[] = {"bin_m",     "wavelength_m",    "tx_length_m",    "recording_s",
                                          "speed_m_s", "sound_speed_m_s", "edge_phase_rad", NULL};

double scene_number_value(int place, const struct acquisition *acquisition)
{
    static double (*const numbers[])(const struct acquisition *) = {
        bin_m, wavelength_m, tx_length_m, recording_s, speed_m_s, sound_speed_m_s, edge_phase_rad};
    return numbers[place](acquisition);
}
