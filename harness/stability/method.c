/* The methods' promises (method.h). */
#include "stability/method.h"

#include <math.h>
#include <string.h>

#include "backprojection/farrow.h"
#include "contract/param.h"

/* An option by name; `missing` where the algorithm has none. */
static double option_value(const struct spec *spec, const char *name, double missing)
{
    for (const struct param *param = spec->algorithm->params; param && param->name; param++)
        if (strcmp(param->name, name) == 0)
            return param_load(param, spec->options);
    return missing;
}

/* Of range migration. */
static const double ERROR_MOST = 0.12, ERROR_KAISER = 0.005;
/* Range migration cuts swath and band at whole cells. Rounding may choose the next cell, which changes the image by
   at most 2e-6. */
static const double CHOICES = 1e-7;

/* General engine, backprojection/general/sum.h: the limit L, lowered where a step between positions is long; 2.5e-6 rad
   of short polynomials in float, 1e-9 of fixed-point phases in double; positions to 2^-17 and 2^-19 of a sample. */
static void interpolated_delays(const struct spec *spec, const struct acquisition *a, struct method *method)
{
    const struct exact_reading *reading = &method->reading;
    const double finest = a->fs * reading->upsample * fmax(1, reading->phases);
    const double limit = fmin(option_value(spec, "phase_limit", 0), 1.57 * a->fc / finest);
    const bool is_float = spec->precision == PRECISION_FLOAT;
    method->phase_rad = limit + (is_float ? 2.5e-6 : 1e-9);
    method->reading.slack_s = limit / (2 * M_PI * a->fc);
    method->reading.slack_point = is_float ? 0x1p-17 : 0x1p-19;
}

struct method method_of(const struct spec *spec, const char *engine, const struct problem *problem)
{
    const struct acquisition *acquisition = problem->acquisition;
    struct method method = {.has_reading = spec->algorithm->reading != READING_NONE,
                            .error_most = spec->algorithm->extreme_error,
                            .weight = CHOICES,
                            .reading = {.kind = spec->algorithm->reading, .upsample = 1}};
    if (!method.has_reading) /* the error setting, if there is one, with room */
        method.error_most = fmin(1.5 * option_value(spec, "error", ERROR_MOST), ERROR_MOST);
    if (option_value(spec, "preemphasis", 0) != 0)
        method.has_reading = false; /* extended precision has no such filter */
    if (!method.has_reading)
        return method;
    method.weight = 0;
    if (method.reading.kind == READING_BAND && !(acquisition->bandwidth < acquisition->fs))
        method.error_most += 1.0 / acquisition->samples; /* one bin stands for both ends of the band */
    if (method.reading.kind == READING_NEAREST || method.reading.kind == READING_LINEAR)
        method.reading.phases = (int)option_value(spec, "beta", 0) + 1;
    method.reading.upsample = (int)option_value(spec, "factor", 1);
    if (method.reading.kind == READING_FITTED) {
        method.reading.upsample = 1 << method.reading.upsample; /* the choice's index */
        method.reading.taps = (int)option_value(spec, "taps", 8);
        method.reading.band = acquisition->bandwidth / (acquisition->fs * method.reading.upsample);
    }
    if (method.reading.kind == READING_POLYNOMIAL) {
        const int choice = (int)option_value(spec, "degree", 0);
        method.reading.phases = 1;
        method.reading.degree =
            choice > 0 ? FARROW_LEAST + choice - 1
                       : farrow_degree_choose(option_value(spec, "error", 0), problem, method.reading.upsample);
    }
    if (method.reading.kind == READING_SINC) {
        method.reading.taps = (int)option_value(spec, "taps", 8);
        const int window = (int)option_value(spec, "window", 0);
        const double left = 1 - acquisition->bandwidth / acquisition->fs;
        if (window > 0) {
            method.reading.kaiser = window == 1 ? 5 : 0.5 * M_PI * method.reading.taps * left;
            method.error_most = ERROR_KAISER;
        }
    }
    /* Cubics through a kernel at 4 of 1024 places a sample; the reference's kernel over four times as many samples. */
    if (method.reading.kind == READING_SINC || method.reading.kind == READING_FITTED
        || method.reading.kind == READING_BAND)
        method.weight = 2e-10;
    if (strcmp(engine, "general") == 0)
        interpolated_delays(spec, acquisition, &method);
    return method;
}
