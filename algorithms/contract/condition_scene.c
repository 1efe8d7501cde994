/* Conditions of a scene by itself, whichever algorithm images it (condition.h): units, pixels, records. Places are the
   nodes of a lattice over each patch, pings that see them are taken with three receivers. */
#include <math.h>

#include "contract/algorithm.h"
#include "contract/delay.h"

enum {
    NODES_MOST = 17,   /* of the lattice along each axis */
    PLACES_MOST = 1000 /* of all patches, as far as three nodes along each axis allow */
};

/* Limits of the shortest element, pitch or pixel, and of the widest band: values beyond were typed in kHz. */
static const double WAVELENGTH_MOST = 10, CARRIER_MOST = 2000;
/* Wavelengths: sound of 100 kHz is absorbed by 500 dB each way, of 1 kHz by 100 dB. m/s: sound is slower. */
static const double AWAY_MOST = 1e6, SOUND_MOST = 1e4;
static const double SPACING_MOST = 0.01;  /* of the way from ping to ping */
static const double CUT_PIXELS_MOST = 20; /* %: a swath may end with the records, or with the track */
static const double CUT_MOST = 0.05;      /* of a place's echoes, before it counts as cut */

struct survey {
    double places, unmet; /* pixels, by the lattice */
    double unseen;        /* pixels outside of the beam of every ping, where it is given */
    double cut;           /* pixels met whose echoes from inside the beam are partly outside the records */
    int patches_unmet;
    struct steps {
        double worst; /* the step over the resolution at the place where that is largest */
        double most;  /* m: the step that would be as large as the resolution there */
    } x, r;
    double nearest, farthest; /* m: the ranges within the records */
};

/* Spread of the wavenumbers F dtau/dx' and F dtau/dr' (1/m) of the echoes of one place, x' and r' the image's axes. */
struct spread {
    double least[2], greatest[2];
};

static double axis_component(struct vector slope, const struct grid *g, int axis)
{
    return axis == 0 ? slope.x * cos(g->angle_rad) - slope.y * sin(g->angle_rad)
                     : slope.x * sin(g->angle_rad) + slope.y * cos(g->angle_rad);
}

/* Unit vector from a to b, added to `sum`. */
static void direction_add(struct vector a, struct vector b, struct vector *sum)
{
    const double length = vector_norm(vector_difference(b, a));
    if (!(length > 0))
        return;
    sum->x += (b.x - a.x) / length;
    sum->y += (b.y - a.y) / length;
}

static void spread_add(const struct acquisition *a, const struct grid *g, struct vector tx, struct vector rx,
                       struct vector place, struct spread *spread)
{
    struct vector slope = {0, 0, 0}; /* c dtau/dp, as if nothing moved */
    direction_add(tx, place, &slope);
    direction_add(rx, place, &slope);
    for (int axis = 0; axis < 2; axis++)
        for (int edge = -1; edge <= 1; edge += 2) {
            const double f = a->fc + edge * a->bandwidth / 2;
            const double turns = f * axis_component(slope, g, axis) / a->sound_speed;
            spread->least[axis] = fmin(spread->least[axis], turns);
            spread->greatest[axis] = fmax(spread->greatest[axis], turns);
        }
}

/* Places of a patch. */
struct counts {
    int places, met, unseen, cut;
};

static void steps_add(double step, int count, double least, double greatest, struct steps *steps)
{
    if (count > 1 && step * (greatest - least) > steps->worst)
        *steps = (struct steps){step * (greatest - least), 1 / (greatest - least)};
}

/* One place: is it met, and how finely do the pings that see it resolve it? */
static void place_survey(const struct acquisition *a, const struct grid *g, struct vector place, struct counts *counts,
                         struct survey *survey)
{
    const double sine = condition_beam_sine(a);
    const bool beam_known = isfinite(sine);
    struct spread spread = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
    double seen = 0, cut = 0;
    bool met = false;
    for (int p = 0; p < a->pings; p++) {
        const bool sees = condition_sees(a, sine, p, place);
        for (int n = 0; n < 3 && (n == 0 || a->receivers > 1); n++) {
            const struct vector rx =
                a->rx[(size_t)p * (size_t)a->receivers + (size_t)(n * (double)(a->receivers - 1) / 2)];
            const double delay = delay_exact(a->tx[p], rx, a->velocity[p], place, a->sound_speed);
            const double first = (delay - a->t0[p]) * a->fs;
            const bool inside = first >= 0 && first <= a->samples - 1;
            met = met || inside;
            if (!sees)
                continue;
            seen++;
            cut += !(first >= 0 && first + fmax(a->pulse_length - 1, 0) <= a->samples - 1);
            if (inside)
                spread_add(a, g, a->tx[p], rx, place, &spread);
        }
    }
    counts->places++;
    counts->met += met;
    counts->unseen += beam_known && seen == 0;
    counts->cut += met && beam_known && cut > CUT_MOST * seen;
    steps_add(g->x_step, g->x_count, spread.least[0], spread.greatest[0], &survey->x);
    steps_add(g->r_step, g->r_count, spread.least[1], spread.greatest[1], &survey->r);
}

/* The row or column in the middle of the n-th of `nodes` equal parts: a pixel where there are as many. */
static double node(int n, int nodes, int count)
{
    return (n + 0.5) * count / nodes - 0.5;
}

static int nodes_of(int count, int most)
{
    return count < most ? count : most;
}

static struct survey survey_make(const struct problem *problem)
{
    const struct acquisition *a = problem->acquisition;
    struct survey survey = {.nearest = INFINITY};
    int most = NODES_MOST;
    for (int p = 0; p < a->pings; p++) {
        survey.nearest = fmin(survey.nearest, fmax(a->t0[p], 0) * a->sound_speed / 2);
        survey.farthest = fmax(survey.farthest, (a->t0[p] + (a->samples - 1) / a->fs) * a->sound_speed / 2);
    }
    while (most > 3 && (double)most * most * problem->patch_count > PLACES_MOST)
        most--;
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *g = &problem->patches[k];
        const int rows = nodes_of(g->r_count, most), columns = nodes_of(g->x_count, most);
        struct counts counts = {0, 0, 0, 0};
        for (int n = 0; n < rows * columns; n++)
            place_survey(a, g,
                         grid_point(g, node(n / columns, rows, g->r_count), node(n % columns, columns, g->x_count)),
                         &counts, &survey);
        const double pixels = (double)grid_pixels(g);
        survey.places += pixels;
        survey.unmet += pixels * (counts.places - counts.met) / counts.places;
        survey.unseen += pixels * counts.unseen / counts.places;
        survey.cut += pixels * counts.cut / counts.places;
        if (counts.met == 0) {
            for (int n = 0; n < 4; n++)
                place_survey(a, g, grid_point(g, n / 2 * (g->r_count - 1), n % 2 * (g->x_count - 1)), &counts, &survey);
            survey.patches_unmet += counts.met == 0;
        }
    }
    return survey;
}

/* m: the longest of element, pitch, ping spacing and pixel: none of them is a small part of a wavelength. */
static double longest_step(const struct problem *problem)
{
    const struct acquisition *a = problem->acquisition;
    double longest = fmax(a->tx_length, a->rx_length);
    if (a->receivers > 1)
        longest = fmax(longest, vector_norm(vector_difference(a->rx[1], a->rx[0])));
    if (a->pings > 1)
        longest = fmax(longest, vector_norm(vector_difference(a->tx[1], a->tx[0])));
    for (int k = 0; k < problem->patch_count; k++)
        longest = fmax(longest, fmax(problem->patches[k].x_step, problem->patches[k].r_step));
    return longest;
}

/* The difference of the ways by speed and pri from those between the pings: both are given, but for stop-and-hop. */
struct motion {
    double off;         /* of the whole track, over its length; 0 where nothing moves or no pri is given */
    double told, found; /* m: the mean way from ping to ping */
};

static struct motion motion_of(const struct acquisition *a)
{
    struct motion motion = {0, 0, 0};
    struct vector way = {0, 0, 0}; /* by trapezoids: exact for speeds from differences of places */
    if (a->pings < 2 || !(a->pri > 0))
        return motion;
    for (int p = 0; p + 1 < a->pings; p++) {
        const struct vector *v = a->velocity + p;
        const struct vector step = {(v[0].x + v[1].x) / 2 * a->pri, (v[0].y + v[1].y) / 2 * a->pri,
                                    (v[0].z + v[1].z) / 2 * a->pri};
        way = (struct vector){way.x + step.x, way.y + step.y, way.z + step.z};
        motion.told += vector_norm(step) / (a->pings - 1);
        motion.found += vector_norm(vector_difference(a->tx[p + 1], a->tx[p])) / (a->pings - 1);
    }
    const struct vector *first = a->tx, *last = a->tx + a->pings - 1;
    if (motion.told > 0 && motion.found > 0)
        motion.off =
            vector_norm(vector_difference(way, vector_difference(*last, *first))) / (motion.found * (a->pings - 1));
    return motion;
}

/* Wavelengths to the end of the records, of sound alone. */
static double wavelengths_away(const struct acquisition *a)
{
    double end = 0;
    for (int p = 0; p < a->pings; p++)
        end = fmax(end, a->t0[p] + (a->samples - 1) / a->fs);
    return a->sound_speed < SOUND_MOST ? end * a->fc / 2 : 0;
}

enum {
    WAVELENGTH,
    NARROW_BAND,
    FAR_AWAY,
    PING_SPACING,
    PIXEL_X,
    PIXEL_R,
    PIXELS_MET,
    PATCHES_MET,
    PIXELS_SEEN,
    BEAM_IN_RECORD
};

int conditions_scene(const struct problem *problem, struct condition list[CONDITIONS_SCENE])
{
    const struct acquisition *a = problem->acquisition;
    const struct survey survey = survey_make(problem);
    const struct motion motion = motion_of(a);
    struct condition all[CONDITIONS_SCENE] = {
        [WAVELENGTH] = {"wavelength", a->sound_speed / a->fc / longest_step(problem), WAVELENGTH_MOST, false,
                        SEVERITY_WARN, "the wavelength over the longest of element, pitch, ping spacing and pixel",
                        "fc in Hz, not kHz"},
        [NARROW_BAND] = {"narrow_band", a->fc / a->bandwidth, CARRIER_MOST, false, SEVERITY_WARN,
                         "the carrier over the bandwidth", "bandwidth and fs in Hz, not kHz"},
        [FAR_AWAY] = {"far_away", wavelengths_away(a), AWAY_MOST, false, SEVERITY_WARN,
                      "wavelengths from the sonar to the end of its records, on which sound is absorbed",
                      "t0 in s, not ms; fs in Hz, not kHz"},
        [PING_SPACING] = {"ping_spacing", motion.off, SPACING_MOST, false, SEVERITY_WARN,
                          "the difference between speed times pri and the ping spacing, over the spacing", ""},
        [PIXEL_X] = {"pixel_x", survey.x.worst, 1, false, SEVERITY_WARN,
                     "the pixels' step along x over the resolution there",
                     "a smaller step, or targets may fall between the pixels"},
        [PIXEL_R] = {"pixel_r", survey.r.worst, 1, false, SEVERITY_WARN,
                     "the pixels' step along r over the resolution there",
                     "a smaller step, or targets may fall between the pixels"},
        [PIXELS_MET] = {"pixels_met", 100 * survey.unmet / survey.places, 0, false, SEVERITY_WARN,
                        "pixels that no record meets, which are zero (%)", "a grid within the records"},
        [PATCHES_MET] = {"patches_met", survey.patches_unmet, 0, false, SEVERITY_WARN,
                         "the number of patches that no record meets", "patches within the records"},
        [PIXELS_SEEN] = {"pixels_seen", 100 * survey.unseen / survey.places, CUT_PIXELS_MOST, false, SEVERITY_WARN,
                         "pixels outside the beam of every ping, which show side lobes at most (%)",
                         "a grid beside the track"},
        [BEAM_IN_RECORD] = {"beam_in_record", 100 * survey.cut / survey.places, CUT_PIXELS_MOST, false, SEVERITY_WARN,
                            "pixels that lose echoes of the beam at the ends of the records (%)",
                            "longer records, or a grid farther from their ends"},
    };
    condition_cure_add(
        &all[PING_SPACING],
        "speed times pri is %.5g m, the pings lie %.5g m apart: correct speed, pri or spacing; speed 0 is stop-and-hop",
        motion.told, motion.found);
    for (int k = PIXEL_X; k <= PIXEL_R; k++)
        if (!condition_holds(&all[k]))
            condition_cure_add(&all[k], ": at most %.3g m",
                               condition_at_most(k == PIXEL_X ? survey.x.most : survey.r.most));
    for (int k = PIXELS_MET; k <= PATCHES_MET; k++)
        condition_cure_add(&all[k], ", which hold ranges of %.4g to %.4g m", survey.nearest, survey.farthest);
    condition_cure_add(&all[PIXELS_SEEN], ", which runs from x = %.9g to %.9g m%s", a->tx[0].x, a->tx[a->pings - 1].x,
                       a->echo_squint != 0 ? ", the beam squinted" : "");
    const int count = problem->patch_count > 0 ? CONDITIONS_SCENE : PIXEL_X;
    for (int k = 0; k < count; k++)
        list[k] = all[k];
    return count;
}
