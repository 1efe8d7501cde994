/* An echo's phase is exp(-j 2 pi fc tau). Conjugated samples follow +j 2 pi fc tau: summed unchanged, the strongest
   echo of a record focuses on none of the pixels that share its delay; with the other sign it focuses on one of them.
   Raw echoes may also be compressed to a spike by the conjugate of their pulse alone.

   A short aperture sees the mirror image of a conjugated target as sharply. Pixels are therefore compared with their
   mirror images, so that such apertures decide nothing. An echo of a target beside the image focuses on no pixel
   with either sign, and with the wrong one on a part of its aperture: most of the sum must focus. */
#include "scene/conjugated.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

#include "backprojection/traces.h"
#include "contract/delay.h"

enum {
    UPSAMPLE = 2,
    LOOKED = 32,   /* records that are searched for the strongest echoes */
    SEEDS = 4,     /* of these echoes */
    SUMMED = 128,  /* records that a seed's focus sums */
    WINDOWS = 4,   /* parts of the track that may see it, without a given beam */
    NODES = 9,     /* places on a line of pixels; between two of them delays may pass the seed's once */
    POINTS = 4096, /* pixels that share a seed's delay */
    BYTES_MOST = 1 << 26
};
static const double SHARPER = 2;                   /* a larger factor of amplitudes is beyond chance */
static const double SPIKE = 1.5;                   /* of a record's largest samples by either pulse */
static const double COHERENT = 0.6, BY_CHANCE = 4; /* of a sum over the sum of amplitudes; over sqrt(records) */

/* What is conjugated. */
enum fault { NOTHING, ALL, SAMPLES, PULSE, FAULTS };

/* Records compressed unchanged, or their conjugates compressed by the same pulse. */
struct view {
    const struct acquisition *acquisition;
    const struct problem *problem;
    const double complex *recorded;
    struct traces *traces;
    struct traces_shape shape;
    double complex *record; /* [samples] scratch */
    double complex *rows;   /* [summed][shape.length] */
    int summed;             /* at most SUMMED, of long records fewer */
    bool conjugated;
};

/* The strongest echo of a record between the delays of the image. */
struct seed {
    size_t record;
    double delay, magnitude;
};

/* The largest sum, and the least sum of a target. */
struct focus {
    double peak, least;
};

static void row_fill(const struct view *view, size_t record, double complex *row)
{
    const struct acquisition *a = view->acquisition;
    const double complex *values = view->recorded + record * (size_t)a->samples;
    for (int n = 0; n < a->samples; n++)
        view->record[n] = view->conjugated ? conj(values[n]) : values[n];
    traces_double.fill(view->traces, 0, view->record, row);
}

static double delay_at(const struct acquisition *a, size_t record, struct vector place)
{
    const size_t ping = record / (size_t)a->receivers;
    return delay_exact(a->tx[ping], a->rx[record], a->velocity[ping], place, a->sound_speed);
}

static struct vector line_place(const struct grid *g, bool along_x, int line, double place)
{
    return along_x ? grid_point(g, line, place) : grid_point(g, place, line);
}

/* Delays of a record between which the image lies, from some of its places. */
static void delays_find(const struct view *view, size_t record, double *least, double *most)
{
    *least = INFINITY;
    *most = 0;
    for (int n = 0; n < view->problem->patch_count * NODES * NODES; n++) {
        const struct grid *g = &view->problem->patches[n / NODES / NODES];
        const double u = n % NODES / (NODES - 1.0), w = n / NODES % NODES / (NODES - 1.0);
        const struct vector place = grid_point(g, w * (g->r_count - 1), u * (g->x_count - 1));
        *least = fmin(*least, delay_at(view->acquisition, record, place));
        *most = fmax(*most, delay_at(view->acquisition, record, place));
    }
}

/* The strongest echoes of the image, each in a record of its own, by falling magnitude. Returns the largest sample
   of all searched records. */
static double seeds_find(const struct view *view, struct seed seeds[SEEDS])
{
    const struct acquisition *a = view->acquisition;
    const size_t records = (size_t)a->pings * (size_t)a->receivers, step = (records + LOOKED - 1) / LOOKED;
    double largest = 0;
    for (int k = 0; k < SEEDS; k++)
        seeds[k] = (struct seed){0, 0, 0};
    for (size_t record = step / 2; record < records; record += step) {
        struct seed seed = {.record = record};
        double least, most;
        delays_find(view, record, &least, &most);
        row_fill(view, record, view->rows);
        for (int n = 0; n < view->shape.length; n++) {
            const double delay = a->t0[record / (size_t)a->receivers] + n / (a->fs * UPSAMPLE);
            const double magnitude = cabs(view->rows[n]);
            largest = fmax(largest, magnitude);
            if (delay >= least && delay <= most && magnitude > seed.magnitude)
                seed = (struct seed){record, delay, magnitude};
        }
        for (int k = 0; k < SEEDS; k++)
            if (seed.magnitude > seeds[k].magnitude) {
                const struct seed weaker = seeds[k];
                seeds[k] = seed;
                seed = weaker;
            }
    }
    return largest;
}

/* Places on a line of pixels that share a seed's delay and that its ping sees. */
static void line_search(const struct view *view, const struct seed *seed, const struct grid *g, bool along_x, int line,
                        struct vector *points, int *count)
{
    const struct acquisition *a = view->acquisition;
    const double length = (along_x ? g->x_count : g->r_count) - 1.0;
    double before = delay_at(a, seed->record, line_place(g, along_x, line, 0)) - seed->delay;
    for (int n = 1; n < NODES && *count < POINTS; n++) {
        const double behind = delay_at(a, seed->record, line_place(g, along_x, line, n * length / (NODES - 1)));
        double low = (n - 1) * length / (NODES - 1), high = n * length / (NODES - 1);
        const bool rises = before < 0, crosses = rises != (behind - seed->delay < 0);
        before = behind - seed->delay;
        for (int k = 0; k < 30 && crosses; k++) {
            const double middle = (low + high) / 2;
            const bool below = delay_at(a, seed->record, line_place(g, along_x, line, middle)) < seed->delay;
            *(below == rises ? &low : &high) = middle;
        }
        const struct vector place = line_place(g, along_x, line, low);
        if (crosses && condition_sees(a, condition_beam_sine(a), (int)(seed->record / (size_t)a->receivers), place))
            points[(*count)++] = place;
    }
}

static int points_find(const struct view *view, const struct seed *seed, struct vector *points)
{
    double lines = 0;
    int count = 0;
    for (int k = 0; k < view->problem->patch_count; k++)
        lines += (double)view->problem->patches[k].x_count + view->problem->patches[k].r_count;
    const int step = (int)fmin(ceil(lines / POINTS), INT_MAX / 2);
    for (int k = 0; k < 2 * view->problem->patch_count; k++) {
        const struct grid *g = &view->problem->patches[k / 2];
        for (int line = step / 2; line < (k % 2 ? g->r_count : g->x_count); line += step)
            line_search(view, seed, g, k % 2, line, points, &count);
    }
    return count;
}

/* Records of some pings about the seed's that may see its target. */
struct summed {
    size_t records[SUMMED];
    int count;
    struct vector middle; /* of their phase centres */
};

static struct summed summed_choose(const struct view *view, size_t seed, int pings)
{
    const struct acquisition *a = view->acquisition;
    const int ping = (int)(seed / (size_t)a->receivers);
    const int first = ping - pings / 2 < 0 ? 0 : ping - pings / 2,
              end = a->pings - first < pings ? a->pings : first + pings;
    const double records = (double)(end - first) * a->receivers;
    struct summed summed = {.count = (int)fmin(records, view->summed)};
    for (int k = 0; k < summed.count; k++) {
        const size_t record = (size_t)first * (size_t)a->receivers + (size_t)((k + 0.5) * records / summed.count);
        const struct vector tx = a->tx[record / (size_t)a->receivers], rx = a->rx[record];
        summed.records[k] = record;
        summed.middle.x += (tx.x + rx.x) / 2 / summed.count;
        summed.middle.y += (tx.y + rx.y) / 2 / summed.count;
    }
    return summed;
}

/* Sums at a place, with the image's sign of the phase and with the other one. */
struct sums {
    double complex plain, turned;
    double magnitudes, squares;
};

static struct sums sums_at(const struct view *view, const struct summed *summed, struct vector place)
{
    const struct acquisition *a = view->acquisition;
    struct sums sums = {0, 0, 0, 0};
    for (int k = 0; k < summed->count; k++) {
        const int ping = (int)(summed->records[k] / (size_t)a->receivers);
        const double delay = delay_at(a, summed->records[k], place), turns = a->fc * delay;
        const double index = round((delay - a->t0[ping]) * a->fs * UPSAMPLE);
        if (!(index >= 0 && index < view->shape.length))
            continue;
        const double complex value = view->rows[(size_t)k * (size_t)view->shape.length + (size_t)index];
        const double complex phase = cexp(2 * M_PI * I * (turns - floor(turns)));
        sums.plain += value * phase;
        sums.turned += value * conj(phase);
        sums.magnitudes += cabs(value);
        sums.squares += creal(value * conj(value));
    }
    return sums;
}

static void focus_add(const struct sums *sums, double complex sum, struct focus *focus)
{
    if (!(cabs(sum) > focus->peak))
        return;
    focus->peak = cabs(sum);
    focus->least = fmax(COHERENT * sums->magnitudes, BY_CHANCE * sqrt(sums->squares)); /* sum/sqrt(n) of n equal ones */
}

/* One seed by some pings about it: [0] with the samples unchanged, [1] with the other sign. */
static void seed_focus(const struct view *view, const struct summed *summed, const struct vector *points, int count,
                       struct focus focus[2])
{
    for (int k = 0; k < count; k++) {
        const struct vector p = points[k], m = summed->middle;
        const struct sums sums = sums_at(view, summed, p);
        focus_add(&sums, sums.plain, &focus[0]);
        focus_add(&sums, sums.turned, &focus[1]);
        const struct vector images[] = {
            {2 * m.x - p.x, p.y, 0}, {p.x, 2 * m.y - p.y, 0}, {2 * m.x - p.x, 2 * m.y - p.y, 0}};
        for (int n = 0; n < 3; n++) {
            const struct sums mirrored = sums_at(view, summed, images[n]);
            focus_add(&mirrored, mirrored.plain, &focus[0]);
        }
    }
}

/* The number of pings about a seed's that may see its target, by the beam; without a given beam the n-th part that
   is tried. */
static int window_pings(const struct acquisition *a, const struct seed *seed, int n)
{
    const int ping = (int)(seed->record / (size_t)a->receivers);
    const double sine = condition_beam_sine(a), range = a->sound_speed * seed->delay / 2;
    int seeing = 0;
    if (!(sine < 1))
        return n < WINDOWS ? a->pings >> 2 * n : 0;
    for (int p = 0; p < a->pings; p++) {
        const struct vector t = a->tx[p], s = a->tx[ping];
        seeing += hypot(hypot(t.x - s.x, t.y - s.y), t.z - s.z) <= 2 * range * sine / sqrt((1 - sine) * (1 + sine));
    }
    return n == 0 ? seeing : 0;
}

static void seeds_focus(const struct view *view, const struct seed seeds[SEEDS], struct vector *points,
                        struct focus focus[2])
{
    for (int k = 0; k < SEEDS && seeds[k].magnitude > 0; k++) {
        const int count = points_find(view, &seeds[k], points);
        for (int n = 0, pings; count > 0 && (pings = window_pings(view->acquisition, &seeds[k], n)) > 0; n++) {
            const struct summed summed = summed_choose(view, seeds[k].record, pings);
            for (int m = 0; m < summed.count; m++)
                row_fill(view, summed.records[m], view->rows + (size_t)m * (size_t)view->shape.length);
            seed_focus(view, &summed, points, count, focus);
        }
    }
}

/* Focus the records unchanged; where their conjugates compress to higher spikes, focus these as well. */
static void faults_focus(struct view *view, struct vector *points, struct focus focus[FAULTS])
{
    struct seed seeds[2][SEEDS];
    double largest[2] = {0, 0};
    for (int k = 0; k < 2 - view->acquisition->compressed; k++) {
        view->conjugated = k == 1;
        largest[k] = seeds_find(view, seeds[k]);
    }
    view->conjugated = false;
    seeds_focus(view, seeds[0], points, &focus[NOTHING]); /* and ALL */
    if (!(largest[1] > SPIKE * largest[0]))
        return;
    view->conjugated = true;
    focus[ALL] = (struct focus){0, 0};
    seeds_focus(view, seeds[1], points, &focus[SAMPLES]); /* and PULSE */
}

static bool view_open(struct view *view)
{
    const struct acquisition *a = view->acquisition;
    const struct traces_form form = {.upsample = UPSAMPLE};
    if (traces_double.plan(a, &form, 1, &view->shape, &view->traces) != STATUS_OK)
        return false;
    view->summed = (int)fmin(fmax(floor(BYTES_MOST / sizeof *view->rows / (double)view->shape.length), 1), SUMMED);
    view->record = malloc((size_t)a->samples * sizeof *view->record);
    view->rows = malloc((size_t)view->summed * (size_t)view->shape.length * sizeof *view->rows);
    return view->record && view->rows;
}

struct condition conjugated_condition(const struct scene *scene)
{
    static const char *const cures[FAULTS] = {"conj(samples)", "conj(samples), conj(pulse)", "conj(samples)",
                                              "conj(pulse)"};
    const struct acquisition *a = &scene->acquisition;
    const struct problem problem = scene_problem(scene, PRECISION_DOUBLE);
    struct view view = {.acquisition = a, .problem = &problem, .recorded = scene->recorded};
    struct vector *points = malloc(POINTS * sizeof *points);
    struct focus focus[FAULTS] = {{0, 0}};
    double value = 0;
    enum fault fault = NOTHING;
    const bool open = view_open(&view) && points;
    if (open)
        faults_focus(&view, points, focus);
    for (int k = ALL; k < FAULTS; k++) {
        const double least = fmax(focus[NOTHING].peak, focus[k].least / SHARPER);
        if (least > 0 && focus[k].peak / least > value) {
            value = focus[k].peak / least;
            fault = k;
        }
    }
    free(points);
    free(view.record);
    free(view.rows);
    traces_double.destroy(view.traces);
    struct condition condition = {"conjugated",
                                  open ? value : NAN,
                                  SHARPER,
                                  false,
                                  SEVERITY_WARN,
                                  "how many times stronger the echoes focus with conjugated samples or pulse",
                                  ""};
    condition_cure_add(&condition, "%s: an echo's phase is exp(-j 2 pi fc tau), docs/echo_files.md",
                       a->compressed ? cures[SAMPLES] : cures[fault]);
    return condition;
}
