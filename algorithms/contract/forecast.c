#include "contract/forecast.h"

#include <math.h>

const char *const cause_names[CAUSES] = {[CAUSE_INTERPOLATION] = "interpolation",
                                         [CAUSE_DELAYS] = "delays",
                                         [CAUSE_SPECTRUM] = "spectrum",
                                         [CAUSE_BLOCKS] = "blocks",
                                         [CAUSE_STOLT] = "stolt",
                                         [CAUSE_APERTURE] = "aperture",
                                         [CAUSE_FLOAT] = "float"};

double forecast_error(const struct forecast *forecast)
{
    double sum = 0;
    for (int k = 0; k < CAUSES; k++)
        sum += forecast->error[k] * forecast->error[k];
    return sqrt(sum);
}

enum cause forecast_cause(const struct forecast *forecast)
{
    int most = 0;
    for (int k = 1; k < CAUSES; k++)
        if (forecast->error[k] > forecast->error[most])
            most = k;
    return (enum cause)most;
}
