#include "scene/random_scene.h"

#include <math.h>
#include <stdbool.h>

#include "scene/random.h"

enum { PINGS_MOST = 90, SAMPLES_MOST = 1500, COLUMNS = 40, ROWS = 24, SPARE = 24, PULSE_MOST = 300 };

static const double FASTEST = 0.005; /* of the speed of sound */

/* Drawn values, and those that follow from them. */
struct draw {
    double c, fc, bandwidth, fs, r; /* m/s, Hz, m */
    double element, pitch, spacing; /* m: the transmitter's length */
    int receivers, pings, first, samples, pulse;
    double x_first;        /* m: the transmitter of the first ping */
    double x_step, r_step; /* m */
};

static double between(struct random *random, double least, double most)
{
    return least + (most - least) * random_uniform(random);
}

/* Uniform in the logarithm. */
static double scale(struct random *random, double least, double most)
{
    return least * pow(most / least, random_uniform(random));
}

/* Rounded to six digits, so that the text is exact. */
static double rounded(double value)
{
    const double unit = pow(10, floor(log10(value)) - 5);
    return round(value / unit) * unit;
}

static struct draw draw_sonar(struct random *random)
{
    struct draw d = {0};
    const bool air = random_uniform(random) < 0.25;
    d.c = air ? 343 : 1500;
    d.fc = rounded(air ? scale(random, 10e3, 60e3) : scale(random, 20e3, 300e3));
    d.bandwidth = rounded(d.fc * scale(random, 0.02, 0.6));
    d.fs = rounded(d.bandwidth * between(random, 1.05, 4));
    d.r = rounded(scale(random, 5, air ? 40 : 400));
    d.receivers = (int)scale(random, 1, 81);
    d.element = rounded(d.c / d.fc * scale(random, 3, 16));
    d.pitch = rounded(d.element * (random_uniform(random) < 0.5 ? 0.5 : 1));
    return d;
}

/* Pings half the array apart see a target through the main lobe, as many of them as allowed. The record contains
   their echoes of the patch. */
static void draw_track(struct random *random, struct draw *d)
{
    const double sine = d->c / d->fc / d->element, tangent = sine / sqrt(1 - sine * sine);
    d->spacing = rounded(d->receivers * d->pitch / 2);
    const bool raster = random_uniform(random) < 0.5;
    const double fine = d->element / scale(random, 4, 8);
    d->x_step = raster ? d->spacing / ceil(d->spacing / fine) : rounded(fine);
    d->r_step = rounded(d->c / (2 * d->fs) * between(random, 0.3, 1));
    const double half = COLUMNS / 2 * d->x_step, seen = 2 * (d->r * tangent + half) / d->spacing;
    d->pings = (int)fmin(PINGS_MOST, ceil(seen) + 2);
    d->x_first = -((d->pings - 1) * d->spacing + d->receivers * d->pitch / 2) / 2;
    /* A ping must see the patch: where pings are so far apart that it lies between beams, one is placed abreast of
       it. */
    const double nearest = remainder(d->x_first, d->spacing);
    if (fabs(nearest) > d->r * tangent + half)
        d->x_first -= nearest;
    const double aside = fmin(d->r * tangent + half, (d->pings + 1) * d->spacing / 2 + half) + d->receivers * d->pitch;
    const double far = d->r + ROWS * d->r_step, late = 2 * (hypot(far, aside) - d->r) / d->c;
    d->pulse = random_uniform(random) < 0.5 ? 0 : (int)scale(random, 40, PULSE_MOST);
    d->first = (int)floor(2 * d->r / d->c * d->fs) - SPARE;
    d->samples = (int)fmin(SAMPLES_MOST, ceil(late * d->fs) + 2 * SPARE + d->pulse);
}

/* Nine digits; whole numbers get a decimal point, since the numbers of a list must all have one type. */
static void range_write(FILE *stream, double first, double last)
{
    fprintf(stream, first == round(first) ? "[%.1f, " : "[%.9g, ", first);
    fprintf(stream, last == round(last) ? "%.1f]" : "%.9g]", last);
}

void random_scene_write(FILE *stream, uint64_t seed)
{
    struct random random = random_seed(seed, 0);
    struct draw d = draw_sonar(&random);
    draw_track(&random, &d);
    const double whole = 2 * d.r / d.c + d.samples / d.fs, pri = fmax(1.5 * whole, d.spacing / (FASTEST * d.c));
    fprintf(stream, "# sasbench scenes random --seed %llu\n", (unsigned long long)seed);
    fprintf(stream, "description = \"random: %.4g kHz, %.4g kHz wide, %.4g m, %d receivers\";\n", d.fc / 1e3,
            d.bandwidth / 1e3, d.r, d.receivers);
    fprintf(stream, "sonar = { sound_speed = %.1f; fc = %.1f; bandwidth = %.3f; fs = %.3f; };\n", d.c, d.fc,
            d.bandwidth, d.fs);
    if (d.pulse > 0)
        fprintf(stream, "pulse = { kind = \"lfm\"; duration = %.9g; };\n", (d.pulse + 0.5) / d.fs);
    else
        fprintf(stream, "pulse = { kind = \"flat\"; };\n");
    fprintf(stream,
            "array = { tx_length = %.9g; rx_length = %.9g; receivers = %d; first_offset = %.9g; pitch = %.9g; };\n",
            d.element, d.pitch, d.receivers, d.pitch, d.pitch);
    fprintf(stream, "track = { speed = %.9g; pri = %.9g; spacing = %.9g; pings = %d; x_first = %.9g; };\n",
            d.spacing / pri, pri, d.spacing, d.pings, d.x_first);
    fprintf(stream, "record = { first_sample = %d; samples = %d; };\n", d.first > 0 ? d.first : 0, d.samples);
    fprintf(stream, "beam = { kind = \"txrx\"; truncation = \"tx\"; limit = 1.0; };\n");
    const double half_x = COLUMNS / 2 * d.x_step, depth = ROWS * d.r_step;
    fprintf(stream, "targets = { fields = ( { x = ");
    range_write(stream, -half_x, half_x);
    fprintf(stream, "; r = ");
    range_write(stream, d.r, d.r + depth);
    fprintf(stream, "; count = 30; seed = %llu; } ); };\n", (unsigned long long)seed);
    fprintf(stream,
            "image = { x = { first = %.9g; step = %.12g; count = %d; }; r = { first = %.9g; step = %.9g; count = %d; "
            "}; };\n",
            -half_x, d.x_step, COLUMNS, d.r, d.r_step, ROWS);
}
