#include "common/kaiser.h"

#include <math.h>

#include "common/bessel.h"

double kaiser_shape(int taps, double oversampling)
{
    double support = taps * (1 - 0.5 / oversampling);
    return M_PI * sqrt(fmax(support * support - 0.8, 1));
}

double kaiser_value(int taps, double shape, double distance)
{
    double z = 2 * distance / taps, inside = sqrt(fmax(1 - z * z, 0));
    return fabs(z) <= 1 ? bessel_i0_scaled(shape * inside) * exp(shape * (inside - 1)) : 0;
}

double kaiser_transform(int taps, double shape, double place)
{
    double x = sqrt(fmax(shape * shape - M_PI * M_PI * taps * taps * place * place, 1e-12));
    return taps * exp(-shape) * sinh(x) / x;
}

double kaiser_error(int taps, double oversampling)
{
    return exp(-M_PI * taps * sqrt(1 - 1 / oversampling));
}
