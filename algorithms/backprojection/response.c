#include "backprojection/response.h"

#include <math.h>
#include <stdlib.h>

#include "common/turns.h"

/* H of Farrow branches with these gains (farrow_gains): their value for exp(j 2 pi nu u), |u| <= 1/2, over the exact
   one. */
static double complex branches_response(int degree, const double *gains, double nu, double u)
{
    static const double complex signs[] = {1, I};
    double power = 1;
    double complex sum = 0;
    for (int m = 0; m <= degree; m++, power *= u)
        sum += signs[m % 2] * gains[m] * power;
    return sum * cexp(-2 * I * M_PI * nu * u);
}

/* H of taps, the first of them `first` samples on. */
static double complex taps_response(const double *taps, int first, int count, double nu, double fraction)
{
    const double complex step = cexp(2 * I * M_PI * nu);
    double complex wave = cexp(2 * I * M_PI * nu * (first - fraction)), sum = 0;
    for (int k = 0; k < count; k++, wave *= step)
        sum += taps[k] * wave;
    return sum;
}

bool response_begin(const struct interpolator *in, const struct law_spectrum *spectrum, struct response *response)
{
    *response = (struct response){.in = in, .spectrum = spectrum};
    response->taps = malloc((size_t)in->taps * sizeof *response->taps);
    for (int n = 0; n < spectrum->count && in->degree > 0; n++)
        farrow_gains(in->degree, spectrum->nu[n] / in->upsample, response->gains[n]);
    return response->taps != NULL;
}

void response_at(struct response *response, double fraction, double complex *list)
{
    const struct interpolator *in = response->in;
    const int steps = in->steps;
    const double place = steps > 0 ? floor(fraction * steps + 0.5) / steps : fraction;
    const double u = fraction < 0.5 ? fraction : fraction - 1;
    const int whole = (int)floor(place);
    response->taps[0] = 1;
    if (in->weights)
        in->weights(in, place - whole, response->taps);
    for (int n = 0; n < response->spectrum->count; n++) {
        const double nu = response->spectrum->nu[n] / in->upsample;
        const double complex read = in->degree > 0
                                        ? branches_response(in->degree, response->gains[n], nu, u)
                                        : taps_response(response->taps, whole + in->first, in->taps, nu, fraction);
        const double lost = in->preemphasis && nu > 0 ? pow(sin(M_PI * nu) / (M_PI * nu), 2) : 1;
        list[n] = read / lost;
    }
}

void response_end(struct response *response)
{
    free(response->taps);
    response->taps = NULL;
}
