/* The records of a range migration (rma_engine.h): the rate that they are compressed to, and the samples that swaths
   use. */
#include <math.h>

#include "common/fft_length.h"
#include "common/pulse_band.h"
#include "range_migration/rma_engine.h"

static const double TAPER_PERIODS = 8; /* of fs - B, or of B, in a cut's taper: its smear stays beside the band */
static const double BAND_ROOM = 1.1;   /* of the compressed pulse's band in the sampling rate */
static const double TAPS_ERROR = 5e-4; /* relative L2, of a delay by half a sample: at a lower rate than the echoes' */

int rma_taper(const struct acquisition *a)
{
    /* For a narrow band at most an eighth of the record; the whole record at fs = B. */
    const double band = fmax(a->bandwidth / a->fs, 8 * TAPER_PERIODS / a->samples);
    const double share = fmax(fmin(1 - a->bandwidth / a->fs, band), TAPER_PERIODS / a->samples);
    return (int)fmin(ceil(TAPER_PERIODS / share), a->samples);
}

double rma_share(const struct acquisition *a, const struct rma_method *method, double half_hz)
{
    int parts = (int)fmin(fmax(ceil(BAND_ROOM * 2 * half_hz / a->fs * RMA_RATES), 1), RMA_RATES);
    while (parts < RMA_RATES
           && (fft_length(parts) != parts
               || (method->terms > 0
                   && !(delay_taps_error(a, (double)parts / RMA_RATES, method->taps, half_hz / a->fs) <= TAPS_ERROR))))
        parts++;
    return (double)parts / RMA_RATES;
}

enum status rma_band_lay(struct rma *rma)
{
    const struct acquisition *a = rma->problem.acquisition;
    struct pulse_band pulse;
    rma->record_length = a->compressed ? 0 : fft_length_fast((long long)a->samples + a->pulse_length - 1);
    enum status status = pulse_band_find(a, rma->record_length, &pulse);
    if (status != STATUS_OK)
        return status;
    rma->half_band = pulse.half_hz;
    rma->loss = pulse.loss;
    const double share = a->compressed ? 1 : rma_share(a, &rma->method, pulse.half_hz);
    rma->rate_up = (int)(share * RMA_RATES);
    rma->rate_down = RMA_RATES;
    for (; rma->rate_up % 2 == 0 && rma->rate_down > 1; rma->rate_up /= 2)
        rma->rate_down /= 2;
    rma->fs = share * a->fs;
    rma->taper = (int)ceil(rma_taper(a) * share);
    /* At a lower rate the cut where the echoes begin would alias: records begin earlier, with the flanks of pulses. */
    const double nearest = 2 * DELAY_NEAREST * rma->nearest / a->sound_speed,
                 early = fmin(2 * rma->taper, (a->t0[0] - nearest) * rma->fs);
    if (share < 1 && early >= rma->taper + rma->rate_up) /* or the taper would reach the echoes */
        rma->early = (int)early / rma->rate_up * rma->rate_up;
    rma->t0 = a->t0[0] - rma->early / rma->fs;
    rma->samples = (int)((a->samples - 1) * share) + 1 + rma->early;
    return STATUS_OK;
}

/* Samples that the map reads before and behind a swath's own: by delays of all receivers, which are smooth in range,
   the taps and whole runs. */
static void map_reach(const struct rma *rma, const struct rma_swath *swath, double *before, double *behind)
{
    enum { RANGES = 9 };
    const double c = rma->setting.sound_speed, beta = rma->setting.speed / c;
    const double to_range = c / 2 * sqrt((1 - beta) * (1 + beta)), slack = 2;
    double least = 0, most = 0;
    for (int m = 0; m < rma->receivers; m++)
        for (int k = 0; k < RANGES; k++) {
            const double tau = swath->t_first + (double)k / (RANGES - 1) * (swath->held + RMA_RUN) / rma->fs;
            const double r = fmax(tau * to_range, DELAY_NEAREST * swath->nearest);
            const double shift = spectrum_abeam(&rma->setting, rma->offset[m], r) * rma->fs;
            least = fmin(least, shift);
            most = fmax(most, shift);
        }
    *before = slack - least + rma->delay->taps.taps;
    *behind = slack + most + rma->delay->taps.taps + RMA_RUN;
}

enum status rma_records_lay(struct rma *rma)
{
    const int pulse = rma->record_length > 0 ? rma->problem.acquisition->pulse_length : 1;
    double from = rma->samples, to = 0, before = 0, behind = 0;
    for (const struct rma_swath *s = rma->swaths; s < rma->swaths + rma->swath_count; s++) {
        if (s->end <= s->begin)
            continue;
        if (rma->delay)
            map_reach(rma, s, &before, &behind);
        from = fmin(from, floor(s->begin - before));
        to = fmax(to, ceil(s->end + behind));
    }
    const int up = rma->rate_up, down = rma->rate_down;
    rma->from = from < to ? (int)fmax(0, from) / up * up : 0; /* where both rates have a sample */
    rma->held = from < to ? (int)fmin(to, rma->samples) - rma->from : 1;
    rma->ahead = (int)fmax(rma->early - rma->from, 0);
    rma->read_from = (rma->from + rma->ahead - rma->early) / up * down;
    const double echoes = ceil(fmax(rma->held - rma->ahead, 0) * down / up), early = rma->ahead / up * down;
    rma->read = (int)fmin(echoes + pulse - 1, rma->problem.acquisition->samples - (double)rma->read_from);
    if (rma->record_length > 0)
        rma->record_length = down * fft_length_fast((long long)ceil((early + echoes + pulse - 1) / down));
    rma->inverse_length = rma->record_length / down * up;
    return STATUS_OK;
}

double rma_compression_flops(const struct rma *rma)
{
    const double forward = rma->record_length, back = rma->inverse_length;
    if (!(forward > 0))
        return 0;
    return (double)rma->receivers * rma->pings * (fft_flops(forward) + fft_flops(back) + 6 * back);
}
