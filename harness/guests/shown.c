/* Acquisitions and grids as others see them (shown.h). */
#include "guests/shown.h"

#include <string.h>

struct sas_acquisition acquisition_show(const struct acquisition *a)
{
    return (struct sas_acquisition){.size = sizeof(struct sas_acquisition),
                                    .pings = a->pings,
                                    .receivers = a->receivers,
                                    .samples = a->samples,
                                    .sound_speed_m_s = a->sound_speed,
                                    .carrier_hz = a->fc,
                                    .sampling_hz = a->fs,
                                    .bandwidth_hz = a->bandwidth,
                                    .t0_s = a->t0,
                                    .tx_m = &a->tx->x,
                                    .rx_m = &a->rx->x,
                                    .velocity_m_s = &a->velocity->x,
                                    .tx_length_m = a->tx_length,
                                    .rx_length_m = a->rx_length,
                                    .aperture_limit = a->aperture_limit,
                                    .pulse_length = a->compressed ? 0 : a->pulse_length,
                                    .pulse = (const double *)a->pulse};
}

struct sas_grid grid_show(const struct grid *g)
{
    return (struct sas_grid){
        sizeof(struct sas_grid), g->x_count, g->r_count, g->x_first, g->x_step, g->r_first, g->r_step, g->angle_rad};
}

enum status acquisition_take(const char *name, const struct sas_acquisition *s, struct acquisition *out)
{
    struct acquisition taken = *out;
    *out = (struct acquisition){0};
    if (s->pings < 1 || s->receivers < 1 || s->samples < 2 || s->pulse_length < 0 || !s->t0_s || !s->tx_m || !s->rx_m
        || !s->velocity_m_s || (s->pulse_length > 0 && !s->pulse))
        return status_set(
            STATUS_INVALID,
            "%s: the echoes have %d pings, %d receivers, %d samples and a replica of %d samples, must be at "
            "least 1, 1, 2 and 0, with an array each",
            name, s->pings, s->receivers, s->samples, s->pulse_length);
    taken.pings = s->pings;
    taken.receivers = s->receivers;
    taken.samples = s->samples;
    taken.sound_speed = s->sound_speed_m_s;
    taken.fc = s->carrier_hz;
    taken.fs = s->sampling_hz;
    taken.bandwidth = s->bandwidth_hz;
    taken.tx_length = s->tx_length_m;
    taken.rx_length = s->rx_length_m;
    taken.aperture_limit = s->aperture_limit;
    taken.pulse_length = s->pulse_length;
    taken.compressed = s->pulse_length == 0;
    enum status status = acquisition_allocate(&taken);
    if (status != STATUS_OK)
        return status;
    const size_t pings = (size_t)s->pings, records = pings * (size_t)s->receivers;
    memcpy(taken.t0, s->t0_s, pings * sizeof *taken.t0);
    memcpy(taken.tx, s->tx_m, pings * sizeof *taken.tx);
    memcpy(taken.rx, s->rx_m, records * sizeof *taken.rx);
    memcpy(taken.velocity, s->velocity_m_s, pings * sizeof *taken.velocity);
    if (s->pulse_length > 0)
        memcpy(taken.pulse, s->pulse, (size_t)s->pulse_length * sizeof *taken.pulse);
    status = acquisition_check(&taken, name);
    if (status == STATUS_OK)
        *out = taken;
    else
        acquisition_free(&taken);
    return status;
}
