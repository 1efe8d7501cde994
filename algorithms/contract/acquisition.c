/* The recording geometry: its memory, its checks, and the shape of the track. */
#include "contract/acquisition.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#define FC_LEAST         1e-6 /* of fs: turns and samples then stay within a float's range of each other */
#define SOUND_SPEED_MOST 1e9  /* m/s, as in scene files: above the speed of light; its square must be finite */

enum status acquisition_allocate(struct acquisition *acquisition)
{
    size_t pings = (size_t)acquisition->pings, receivers = (size_t)acquisition->receivers;
    size_t pulse_length = (size_t)acquisition->pulse_length;
    acquisition->t0 = calloc(pings, sizeof *acquisition->t0);
    acquisition->tx = calloc(pings, sizeof *acquisition->tx);
    acquisition->rx = calloc(pings * receivers, sizeof *acquisition->rx);
    acquisition->velocity = calloc(pings, sizeof *acquisition->velocity);
    acquisition->pulse = pulse_length > 0 ? calloc(pulse_length, sizeof *acquisition->pulse) : NULL;
    if (acquisition->t0 && acquisition->tx && acquisition->rx && acquisition->velocity
        && (acquisition->pulse || pulse_length == 0)) {
        return STATUS_OK;
    }
    acquisition_free(acquisition);
    return status_set(STATUS_FAILED, "out of memory for the geometry of %zu pings and %zu receivers", pings, receivers);
}

void acquisition_free(struct acquisition *acquisition)
{
    free(acquisition->t0);
    free(acquisition->tx);
    free(acquisition->rx);
    free(acquisition->velocity);
    free(acquisition->pulse);
    *acquisition = (struct acquisition){0};
}

static struct vector vector_turn(struct vector v, double cosine, double sine)
{
    return (struct vector){v.x * cosine - v.y * sine, v.x * sine + v.y * cosine, v.z};
}

enum status acquisition_turn(const struct acquisition *acquisition, double angle, struct acquisition *out)
{
    const double cosine = cos(angle), sine = sin(angle);
    *out = *acquisition;
    enum status status = acquisition_allocate(out);
    if (status != STATUS_OK)
        return status;
    for (int p = 0; p < out->pings; p++) {
        out->t0[p] = acquisition->t0[p];
        out->tx[p] = vector_turn(acquisition->tx[p], cosine, sine);
        out->velocity[p] = vector_turn(acquisition->velocity[p], cosine, sine);
        for (int m = 0; m < out->receivers; m++) {
            size_t k = (size_t)p * (size_t)out->receivers + (size_t)m;
            out->rx[k] = vector_turn(acquisition->rx[k], cosine, sine);
        }
    }
    for (int k = 0; k < out->pulse_length; k++)
        out->pulse[k] = acquisition->pulse[k];
    return STATUS_OK;
}

struct acquisition acquisition_part(const struct acquisition *acquisition, int first, int pings)
{
    struct acquisition part = *acquisition;
    part.pings = pings;
    part.t0 += first;
    part.tx += first;
    part.rx += (size_t)first * (size_t)part.receivers;
    part.velocity += first;
    return part;
}

static bool vector_is_finite(struct vector v)
{
    return isfinite(v.x) && isfinite(v.y) && isfinite(v.z);
}

static double vector_length(struct vector v)
{
    return hypot(hypot(v.x, v.y), v.z);
}

static enum status check_scalars(const struct acquisition *a, const char *place)
{
    const struct {
        const char *name, *unit;
        double value;
        bool may_be_zero;
    } scalars[] = {
        {"sound_speed", " m/s", a->sound_speed, false},
        {"fc", " Hz", a->fc, false},
        {"fs", " Hz", a->fs, false},
        {"bandwidth", " Hz", a->bandwidth, false},
        {"wavelength (sound_speed/fc)", " m", a->sound_speed / a->fc, false},
        {"pri", " s", a->pri, true},
        {"tx_length", " m", a->tx_length, true},
        {"rx_length", " m", a->rx_length, true},
    };
    for (size_t i = 0; i < sizeof scalars / sizeof *scalars; i++) {
        double value = scalars[i].value;
        if (!isfinite(value) || !(value > 0 || (scalars[i].may_be_zero && value == 0)))
            return status_set(STATUS_INVALID, "%s: %s is %g%s; a finite number %s 0 is needed", place, scalars[i].name,
                              value, scalars[i].unit, scalars[i].may_be_zero ? ">=" : ">");
    }
    if (!(a->sound_speed <= SOUND_SPEED_MOST))
        return status_set(STATUS_INVALID, "%s: sound_speed is %g m/s; at most %g m/s is accepted", place,
                          a->sound_speed, SOUND_SPEED_MOST);
    if (!(a->fs >= a->bandwidth))
        return status_set(STATUS_INVALID, "%s: bandwidth is %.15g Hz; at most fs = %.15g Hz is accepted", place,
                          a->bandwidth, a->fs);
    if (!(a->fc >= FC_LEAST * a->fs))
        return status_set(STATUS_INVALID, "%s: fc is %.15g Hz; at least %.15g Hz, a millionth of fs, is needed", place,
                          a->fc, FC_LEAST * a->fs);
    if (!(fabs(a->echo_squint) < M_PI / 2))
        return status_set(STATUS_INVALID, "%s: the beam's squint is %g degrees; within +-90 is needed", place,
                          a->echo_squint * 180 / M_PI);
    const struct target_area *area = &a->area;
    bool none = area->half_x == 0 && area->half_r == 0;
    if (!none && !(area->half_x > 0 && area->half_r > 0 && isfinite(area->x + area->r + area->half_x + area->half_r)))
        return status_set(
            STATUS_INVALID,
            "%s: target area about (%g, %g) m, %g and %g m to either side; finite numbers are needed, and "
            "sizes > 0",
            place, area->x, area->r, area->half_x, area->half_r);
    if (!(a->aperture_limit > 0))
        return status_set(STATUS_INVALID, "%s: aperture limit is %g; a sine > 0 is needed", place, a->aperture_limit);
    return STATUS_OK;
}

static enum status check_counts(const struct acquisition *a, const char *place)
{
    const struct {
        const char *name;
        int value, min;
    } counts[] = {{"samples", a->samples, 2}, {"receivers", a->receivers, 1}, {"pings", a->pings, 1}};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        if (counts[i].value < counts[i].min)
            return status_set(STATUS_INVALID, "%s: number of %s is %d; at least %d is needed", place, counts[i].name,
                              counts[i].value, counts[i].min);
    }
    size_t records = (size_t)a->receivers * (size_t)a->pings;
    if (records > PTRDIFF_MAX / sizeof(double complex) / (size_t)a->samples)
        return status_set(STATUS_INVALID, "%s: %d samples x %d receivers x %d pings do not fit the address space",
                          place, a->samples, a->receivers, a->pings);
    return STATUS_OK;
}

static enum status check_pulse(const struct acquisition *a, const char *place)
{
    if (a->compressed) {
        if (a->pulse_length != 0 || a->pulse)
            return status_set(STATUS_INVALID, "%s: pulse has %d samples; compressed echoes have none", place,
                              a->pulse_length);
        return STATUS_OK;
    }
    if (a->pulse_length < 1 || !a->pulse)
        return status_set(STATUS_INVALID, "%s: pulse has %d samples; raw echoes need at least 1", place,
                          a->pulse_length);
    double energy = 0;
    for (int k = 0; k < a->pulse_length; k++)
        energy += creal(a->pulse[k]) * creal(a->pulse[k]) + cimag(a->pulse[k]) * cimag(a->pulse[k]);
    if (!isfinite(energy) || !(energy > 0)) { /* one sample that is not finite makes the sum so */
        return status_set(STATUS_INVALID, "%s: energy of pulse is %g; a finite number > 0 is needed", place, energy);
    }
    return STATUS_OK;
}

/* The end of ping p's record with the greater magnitude: a bound of the delays that can be imaged. */
static double largest_delay(const struct acquisition *a, int p)
{
    return fmax(fabs(a->t0[p]), fabs(a->t0[p] + (a->samples - 1) / a->fs));
}

static enum status check_ping(const struct acquisition *a, int p, const char *place)
{
    if (!isfinite(a->t0[p]))
        return status_set(STATUS_INVALID, "%s: t0 of ping %d is %g s; a finite number is needed", place, p + 1,
                          a->t0[p]);
    double phase_error = 8 * M_PI * a->fc * largest_delay(a, p) * DBL_EPSILON;
    if (!(phase_error <= 1e-3))
        return status_set(STATUS_INVALID,
                          "%s: delays of up to %g s at fc = %g Hz (ping %d) leave a phase error of %g rad in double "
                          "precision; at most 0.001 is accepted",
                          place, largest_delay(a, p), a->fc, p + 1, phase_error);
    if (!vector_is_finite(a->tx[p]))
        return status_set(STATUS_INVALID, "%s: tx of ping %d is (%g, %g, %g) m; finite numbers are needed", place,
                          p + 1, a->tx[p].x, a->tx[p].y, a->tx[p].z);
    for (int m = 0; m < a->receivers; m++) {
        struct vector rx = a->rx[(size_t)p * (size_t)a->receivers + (size_t)m];
        if (!vector_is_finite(rx))
            return status_set(STATUS_INVALID, "%s: rx %d of ping %d is (%g, %g, %g) m; finite numbers are needed",
                              place, m + 1, p + 1, rx.x, rx.y, rx.z);
    }
    struct vector v = a->velocity[p];
    if (!(vector_length(v) < a->sound_speed))
        return status_set(STATUS_INVALID,
                          "%s: velocity of ping %d is (%g, %g, %g) m/s; a speed below sound_speed = %g m/s is needed",
                          place, p + 1, v.x, v.y, v.z, a->sound_speed);
    return STATUS_OK;
}

enum status acquisition_check(const struct acquisition *acquisition, const char *place)
{
    enum status status = check_scalars(acquisition, place);
    if (status == STATUS_OK)
        status = check_counts(acquisition, place);
    if (status == STATUS_OK)
        status = check_pulse(acquisition, place);
    for (int p = 0; status == STATUS_OK && p < acquisition->pings; p++)
        status = check_ping(acquisition, p, place);
    return status;
}

struct vector acquisition_heading(const struct acquisition *acquisition, int ping)
{
    int before = ping > 0 ? ping - 1 : ping;
    int after = ping < acquisition->pings - 1 ? ping + 1 : ping;
    struct vector heading = vector_difference(acquisition->tx[after], acquisition->tx[before]);
    if (!(vector_length(heading) > 0))
        heading = acquisition->velocity[ping];
    double length = vector_length(heading);
    if (!(length > 0))
        return (struct vector){1, 0, 0};
    return (struct vector){heading.x / length, heading.y / length, heading.z / length};
}

struct vector acquisition_normal(const struct acquisition *acquisition, int ping)
{
    const struct vector heading = acquisition_heading(acquisition, ping);
    const double squint = acquisition->echo_squint;
    if (squint == 0)
        return heading;
    const double way = heading.x < 0 ? -1 : 1;
    return vector_turn((struct vector){way * heading.x, way * heading.y, way * heading.z}, cos(squint), -sin(squint));
}

/* The evenly spaced points nearest to the transmitters in x: the line through both ends, plus the least-squares line
   of what is left, so that an exactly even track keeps its full precision. */
static struct straight_track fit_even_spacing(const struct acquisition *a)
{
    struct straight_track track = {.x_first = a->tx[0].x, .speed = a->velocity[0].x};
    if (a->pings == 1)
        return track;
    int last = a->pings - 1;
    track.spacing = (a->tx[last].x - a->tx[0].x) / last;
    double sum = 0, moment = 0, inertia = 0;
    for (int p = 0; p < a->pings; p++) {
        double left = a->tx[p].x - (track.x_first + p * track.spacing), arm = p - 0.5 * last;
        sum += left;
        moment += arm * left;
        inertia += arm * arm;
    }
    double correction = moment / inertia;
    track.x_first += sum / a->pings - 0.5 * last * correction;
    track.spacing += correction;
    return track;
}

static double largest_component(struct vector v)
{
    return fmax(fabs(v.x), fmax(fabs(v.y), fabs(v.z)));
}

double acquisition_unevenness(const struct acquisition *acquisition, struct straight_track *track)
{
    const struct acquisition *a = acquisition;
    const struct straight_track fit = *track = fit_even_spacing(a);
    double off = 0;
    if (a->pings > 1 && !(fabs(fit.spacing) * (a->pings - 1) > a->sound_speed / a->fc * ACQUISITION_UNEVEN_MOST)) {
        return INFINITY; /* standing still: the spacing is nothing but rounding */
    }
    for (int p = 0; p < a->pings; p++) {
        struct vector place = {fit.x_first + p * fit.spacing, 0, 0};
        struct vector drift = vector_difference(a->velocity[p], (struct vector){fit.speed, 0, 0});
        off = fmax(off, largest_component(vector_difference(a->tx[p], place)));
        off = fmax(off, largest_component(drift) * largest_delay(a, p));
        off = fmax(off, fabs(a->t0[p] - a->t0[0]) * a->sound_speed);
        const struct vector *rx = a->rx + (size_t)p * (size_t)a->receivers;
        for (int m = 0; m < a->receivers; m++) {
            struct vector receiver = {place.x + (a->rx[m].x - a->tx[0].x), 0, 0};
            off = fmax(off, largest_component(vector_difference(rx[m], receiver)));
        }
    }
    return off;
}

bool acquisition_is_straight(const struct acquisition *acquisition, struct straight_track *track)
{
    struct straight_track fit;
    if (!(acquisition_unevenness(acquisition, &fit)
          <= acquisition->sound_speed / acquisition->fc * ACQUISITION_UNEVEN_MOST)) {
        return false;
    }
    if (track)
        *track = fit;
    return true;
}
