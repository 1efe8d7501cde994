/* A description of an echo file (inspect.h). */
#include "command/inspect.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "contract/algorithm.h"
#include "contract/condition.h"
#include "echoes/echo_data.h"
#include "echoes/matfile.h"
#include "show/table.h"
#include "advise/check.h"

enum { PIXELS_MOST = 1000 };

/* Ranges whose whole echoes lie in every record, by the monostatic delay. False where there are none. */
static bool ranges_find(const struct acquisition *a, double *nearest, double *farthest)
{
    *nearest = 0;
    *farthest = INFINITY;
    for (int p = 0; p < a->pings; p++) {
        const double last = a->t0[p] + (a->samples - 1 - a->pulse_length) / a->fs;
        *nearest = fmax(*nearest, a->sound_speed * a->t0[p] / 2);
        *farthest = fmin(*farthest, a->sound_speed * last / 2);
    }
    return *farthest > *nearest;
}

/* A step, rounded down to two digits. */
static double rounded(double value)
{
    const double unit = pow(10, floor(log10(value)) - 1);
    return floor(value / unit) * unit;
}

/* The step, or up to a third less: a whole part of the ping spacing, on which back projection is fastest. It must print
   exactly. */
static double part_of(double spacing, double step)
{
    char text[32];
    const double most = fmin(1.5 * spacing / step, PIXELS_MOST);
    for (double parts = fmax(ceil(spacing / step), 1); parts <= most; parts++) {
        snprintf(text, sizeof text, "%.5g", spacing / parts);
        const double printed = strtod(text, NULL);
        if (fabs(printed * parts - spacing) <= 1e-9 * spacing)
            return printed;
    }
    return step;
}

/* `spacing` of pings along it; 0: none. */
static void axis_make(double low, double high, double resolution, double spacing, double *first, double *step,
                      int *count, bool *cut)
{
    *step = part_of(spacing, rounded(resolution / 2));
    double pixels = floor((high - low) / *step) + 1;
    *cut |= pixels > PIXELS_MOST;
    *count = (int)fmin(fmax(pixels, 1), PIXELS_MOST);
    const double middle = (low + high) / 2;
    *first = round((middle - (*count - 1) / 2.0 * *step) / *step) * *step;
}

/* Azimuth resolution at a range: that of half the element, or of the aperture, which the track or the beam limits. */
static double azimuth_resolution(const struct acquisition *a, double range)
{
    const double wavelength = a->sound_speed / a->fc;
    double length = 0, sine = condition_beam_sine(a);
    for (int p = 0; p < a->pings; p++)
        length = fmax(length, vector_norm(vector_difference(a->tx[p], a->tx[0])));
    for (int m = 0; m < a->receivers; m++)
        length = fmax(length, vector_norm(vector_difference(a->rx[m], a->tx[0])) / 2);
    const double half_angle = fmin(atan2(length / 2, range), asin(fmin(sine, 1)));
    return half_angle > 0 ? fmax(wavelength / 4, wavelength / (4 * sin(half_angle))) : wavelength;
}

/* Lower resolutions to those of the conditions at a grid's places, whose values are steps over resolutions. */
static void resolutions_lower(const struct acquisition *a, const struct grid *grid, double *x, double *r)
{
    struct condition list[CONDITIONS_SCENE];
    const struct problem problem = problem_make(a, 1, grid, PRECISION_DOUBLE);
    const int count = conditions_scene(&problem, list);
    for (int k = 0; k < count; k++)
        if (strcmp(list[k].name, "pixel_x") == 0)
            *x = fmin(*x, 2 * grid->x_step / list[k].value);
        else if (strcmp(list[k].name, "pixel_r") == 0)
            *r = fmin(*r, 2 * grid->r_step / list[k].value);
}

/* Propose a grid that shows the recording: on a straight track from its first to its last ping and over the ranges of
   the records; else around the place that the records have in common. Steps of half the resolution, at most 1000 pixels
   an axis, about the middle. *cut: that bound shortened it. False where no grid suits the geometry. */
static bool inspect_grid(const struct acquisition *a, struct grid *grid, bool *cut)
{
    struct straight_track track;
    double nearest, farthest, x_low, x_high, r_low, r_high, spacing = 0;
    const double range_resolution = a->sound_speed / (2 * a->bandwidth);
    *cut = false;
    *grid = (struct grid){0};
    if (!ranges_find(a, &nearest, &farthest))
        return false;
    const double middle = (nearest + farthest) / 2, ahead = middle * tan(a->echo_squint);
    double resolution_x = azimuth_resolution(a, middle), resolution_r = range_resolution;
    bool around_origin = true; /* every ping sees it, and looks down at it from afar */
    for (int p = 0; p < a->pings; p++) {
        const double range = vector_norm(a->tx[p]);
        around_origin &= range > nearest && range < farthest && hypot(a->tx[p].y, a->tx[p].z) > 0.1 * range;
    }
    if (acquisition_is_straight(a, &track)) {
        const double last = track.x_first + (a->pings - 1) * track.spacing;
        spacing = fabs(track.spacing);
        x_low = fmin(track.x_first, last) + condition_offset(a, 0) / 2 + ahead;
        x_high = fmax(track.x_first, last) + condition_offset(a, 2) / 2 + ahead;
        r_low = fmax(nearest, range_resolution);
        r_high = farthest;
    } else if (around_origin) {
        const double half = (farthest - nearest) / 4;
        x_low = r_low = -half;
        x_high = r_high = half;
        resolution_x = resolution_r = fmax(resolution_x, range_resolution);
    } else {
        x_low = INFINITY;
        x_high = -INFINITY;
        for (int p = 0; p < a->pings; p++) {
            x_low = fmin(x_low, a->tx[p].x);
            x_high = fmax(x_high, a->tx[p].x);
        }
        r_low = fmax(nearest, range_resolution);
        r_high = farthest;
    }
    for (int round = 0; round < 2; round++) {
        *cut = false;
        axis_make(x_low, x_high, resolution_x, spacing, &grid->x_first, &grid->x_step, &grid->x_count, cut);
        axis_make(r_low, r_high, resolution_r, 0, &grid->r_first, &grid->r_step, &grid->r_count, cut);
        if (grid_check(grid, "grid") != STATUS_OK || grid_meets_records(a, 1, grid, "grid") != STATUS_OK)
            return false;
        if (round == 0)
            resolutions_lower(a, grid, &resolution_x, &resolution_r);
    }
    return true;
}

static void samples_print(const struct acquisition *a, const double complex *samples)
{
    const size_t count = (size_t)a->samples * (size_t)a->receivers * (size_t)a->pings;
    double largest = 0, energy = 0;
    size_t silent = 0;
    for (size_t n = 0; n < count; n++)
        largest = fmax(largest, cabs(samples[n]));
    for (size_t n = 0; n < count && largest > 0; n++) {
        const double share = cabs(samples[n]) / largest;
        energy += share * share;
        silent += share == 0;
    }
    printf("samples      %d (fast time) x %d (receivers) x %d (pings), largest %.4g, rms %.4g", a->samples,
           a->receivers, a->pings, largest, largest * sqrt(energy / (double)count));
    if (silent > 0)
        printf(", %.3g %% are zero", 100.0 * (double)silent / (double)count);
    printf("\n");
    if (a->noise > 0.5e-4)
        printf("noise        %.2g %% of the compressed echoes' energy, estimated from the samples outside the band\n",
               100 * a->noise);
}

static void vector_print(const struct vector *v, double step)
{
    printf("(%s, %s, %s)", cell_place(v->x, step).text, cell_place(v->y, step).text, cell_place(v->z, step).text);
}

static void track_print(const struct acquisition *a)
{
    struct straight_track track;
    const struct vector *first = &a->tx[0], *last = &a->tx[a->pings - 1], *v = &a->velocity[0];
    const bool straight = acquisition_is_straight(a, &track);
    const double wavelength = a->sound_speed / a->fc;
    printf("track        from ");
    vector_print(first, wavelength);
    printf(" to ");
    vector_print(last, wavelength);
    printf(" m; ");
    if (straight && a->pings > 1)
        printf("uniform and straight, %g m from ping to ping\n", track.spacing);
    else
        printf("%s\n", straight ? "one ping"
                                : "no uniform straight track with receivers at constant offsets: back projection only");
    if (v->x == 0 && v->y == 0 && v->z == 0)
        printf("velocity     0: stop-and-hop\n");
    else {
        printf("velocity     ");
        vector_print(v, 1);
        printf(" m/s\n");
    }
    if (a->pri > 0)
        printf("pri          %g s\n", a->pri);
    printf("receivers    %s to %s m ahead of the transmitter (first ping)\n",
           cell_place(condition_offset(a, 0), wavelength).text, cell_place(condition_offset(a, 2), wavelength).text);
}

static void beam_print(const struct acquisition *a)
{
    printf("beam        ");
    if (a->tx_length > 0)
        printf(" transmitter %g m long", a->tx_length);
    if (a->rx_length > 0)
        printf("%s receivers %g m long", a->tx_length > 0 ? "," : "", a->rx_length);
    if (!(a->tx_length > 0) && !(a->rx_length > 0))
        printf(" element lengths are not given");
    if (a->echo_squint != 0)
        printf(", squint %g degrees", a->echo_squint * 180 / M_PI);
    if (isfinite(a->aperture_limit))
        printf(", aperture limit %g", a->aperture_limit);
    printf("\n");
}

static void notes_print(const struct echo_notes *notes)
{
    for (int k = 0; k < notes->patch_count; k++) {
        const struct grid *g = &notes->patches[k];
        printf("%s %d x %d pixels from (%s, %s) m%s\n", k ? "            " : "image grid  ", g->x_count, g->r_count,
               cell_place(g->x_first, g->x_step).text, cell_place(g->r_first, g->r_step).text,
               k ? "" : "; taken where there is no --grid");
    }
    if (notes->target_count > 0)
        printf("targets      %d points, the first at (%g, %g) m\n", notes->target_count, notes->targets[0].x,
               notes->targets[0].r);
}

/* False where there is none. */
static bool grid_print(const struct acquisition *a, struct grid *grid)
{
    bool cut;
    if (!inspect_grid(a, grid, &cut)) {
        printf("grid         none found: no pixel (x, r, 0) beside the track is at a range that all records hold. "
               "Check t0 (s)\n"
               "             and the positions (m): of a map projection, take off an origin near the track\n");
        return false;
    }
    printf("grid to try  --grid=%s:%g:%d,%s:%g:%d\n", cell_place(grid->x_first, grid->x_step).text, grid->x_step,
           grid->x_count, cell_place(grid->r_first, grid->r_step).text, grid->r_step, grid->r_count);
    if (cut)
        printf("             (the middle of what was recorded: at most %d pixels along each axis)\n", PIXELS_MOST);
    return true;
}

enum status inspect_echoes(const char *path)
{
    struct acquisition a;
    struct echoes echoes;
    struct grid grid;
    struct echo_notes notes;
    enum status status = echo_notes_read(path, &notes);
    if (status != STATUS_OK)
        return status;
    status = echo_file_read(path, &a, &echoes);
    if (status != STATUS_OK) {
        echo_notes_free(&notes);
        return status;
    }
    const double end = a.t0[0] + (a.samples - 1) / a.fs;
    printf("%s: echoes, %s\n", path, a.compressed ? "range compressed" : "raw");
    samples_print(&a, echoes.samples);
    printf("sonar        fc %g Hz, bandwidth %g Hz, fs %g Hz, sound speed %g m/s\n", a.fc, a.bandwidth, a.fs,
           a.sound_speed);
    printf("             wavelength %.4g m, range resolution c/2B %.4g m\n", a.sound_speed / a.fc,
           a.sound_speed / (2 * a.bandwidth));
    if (!a.compressed)
        printf("pulse        %d samples, %.4g s\n", a.pulse_length, a.pulse_length / a.fs);
    printf("record       %.6g to %.6g s after emission: ranges of %.6g to %.6g m\n", a.t0[0], end,
           a.sound_speed * a.t0[0] / 2, a.sound_speed * end / 2);
    track_print(&a);
    beam_print(&a);
    notes_print(&notes);
    const bool found = grid_print(&a, &grid);
    const struct scene scene = {
        .acquisition = a, .recorded = (double complex *)echoes.samples, .patch_count = found, .patches = &grid};
    check_warnings(stdout, &scene, true);
    echo_notes_free(&notes);
    echoes_free(&echoes);
    acquisition_free(&a);
    return STATUS_OK;
}
