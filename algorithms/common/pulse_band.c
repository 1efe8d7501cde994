#include "common/pulse_band.h"

#include <fftw3.h>
#include <math.h>
#include <string.h>

#define BAND_LOSS 4e-6 /* of the compressed pulse's energy may lie outside the band */

enum status pulse_band_find(const struct acquisition *a, int length, struct pulse_band *band)
{
    *band = (struct pulse_band){fmin(a->fs / 2, fmax(a->bandwidth, 32 * a->fs / a->samples)), 0};
    if (a->compressed)
        return STATUS_OK;
    double complex *work = length > 0 ? fftw_malloc((size_t)length * sizeof *work) : NULL;
    if (!work)
        return status_set(STATUS_FAILED, "no memory for the replica's spectrum");
    memset(work, 0, (size_t)length * sizeof *work);
    memcpy(work, a->pulse, (size_t)a->pulse_length * sizeof *work);
    fftw_plan forward = fftw_plan_dft_1d(length, work, work, FFTW_FORWARD, FFTW_ESTIMATE);
    fftw_execute(forward);
    fftw_destroy_plan(forward);
    double total = 0, outside = 0;
    for (int k = 0; k < length; k++)
        total += pow(cabs(work[k]), 4);
    int half = (length - 1) / 2;
    for (; half > a->bandwidth / 2 / a->fs * length; half--) {
        double edge = pow(cabs(work[half]), 4) + pow(cabs(work[length - half]), 4);
        if (outside + edge > BAND_LOSS * total)
            break;
        outside += edge;
    }
    fftw_free(work);
    *band = (struct pulse_band){half * a->fs / length, outside / total};
    return STATUS_OK;
}
