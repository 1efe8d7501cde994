/* The inner sums of the general engine over one line of pixels: exact delays, of each pixel or at the Chebyshev points
   of blocks, whose runs are made in runs.c. Short loops over arrays in the first-level cache keep many pixels in flight
   at once. This file is compiled once for each precision and instruction set (BP_ISA names it). */
#include "backprojection/general/sum.h"

#include <math.h>

#include "backprojection/general/run.h"
#include "contract/delay.h"

#define BP_SUM REAL_ISA_NAME(bp_sum)

enum { DELAYS = NODES * BP_BLOCKS }; /* that are evaluated together, to each receiver of a group */

/* Places (x, r, 0) on a line seen from a ping: seconds from the transmitter, and the vector to each from the array's
   origin at that time. */
struct places {
    int count;
    double x[RUN_PIXELS], r[RUN_PIXELS];
    double leg[RUN_PIXELS], bx[RUN_PIXELS], by[RUN_PIXELS], bz[RUN_PIXELS];
};

static void legs_out(const struct bp_medium *medium, const struct bp_ping *ping, struct places *places)
{
    const struct vector tx = ping->tx, v = ping->velocity;
    const double one_c = 1 / medium->sound_speed;
#pragma omp simd
    for (int i = 0; i < places->count; i++) {
        double ax = tx.x - places->x[i], ay = tx.y - places->r[i], leg = sqrt(ax * ax + ay * ay + tx.z * tx.z) * one_c;
        places->leg[i] = leg;
        places->bx[i] = v.x * leg - places->x[i];
        places->by[i] = v.y * leg - places->r[i];
        places->bz[i] = v.z * leg;
    }
}

/* A ping's velocity; c^2 - |v|^2 and its inverse; `slow`: the delay's root may be taken in one form. */
struct motion {
    struct vector v;
    double e, one_e;
    bool slow;
};

static struct motion motion_make(const struct bp_medium *medium, struct vector v)
{
    const double c = medium->sound_speed, e = delay_margin(v, c);
    return (struct motion){v, e, 1 / e, v.x * v.x + v.y * v.y + v.z * v.z <= BP_SLOW * c * (BP_SLOW * c)};
}

/* The delay (delay.h), in seconds, to the receiver that is (x, y, z) from the place when the echo leaves it, after
   `leg`. */
INLINE double leg_back(bool slow, const struct motion *motion, double leg, double x, double y, double z)
{
    double p = x * motion->v.x + y * motion->v.y + z * motion->v.z, n = x * x + y * y + z * z;
    double s = sqrt(p * p + motion->e * n);
    return leg + (slow || p >= 0 ? (p + s) * motion->one_e : n / (s - p));
}

/* The delays of all places to one receiver; `slow` is a constant where this is inlined. */
INLINE void legs_back(bool slow, const struct motion *motion, const struct places *places, struct vector rx,
                      double *tau)
{
#pragma omp simd
    for (int i = 0; i < places->count; i++)
        tau[i] =
            leg_back(slow, motion, places->leg[i], rx.x + places->bx[i], rx.y + places->by[i], rx.z + places->bz[i]);
}

/* The same to a group of receivers. */
INLINE void group_back(bool slow, const struct motion *motion, const struct places *places, const double *x,
                       const double *y, const double *z, double (*tau)[GROUP_RECEIVERS])
{
    for (int i = 0; i < places->count; i++) {
        const double leg = places->leg[i], bx = places->bx[i], by = places->by[i], bz = places->bz[i];
#pragma omp simd
        for (int g = 0; g < GROUP_RECEIVERS; g++)
            tau[i][g] = leg_back(slow, motion, leg, x[g] + bx, y[g] + by, z[g] + bz);
    }
}

/* The receivers of one ping over a line of pixels. */
struct line_sum {
    const struct bp_medium *medium;
    const struct bp_table *table;
    const struct pixel_line *line;
    const struct scale *scale;
    real *re, *im; /* of the line's pixel 0 */
};

/* Evaluate every delay of pixels [begin, end), at least of those shown. */
static void sum_exact(const struct line_sum *sum, const struct bp_ping *ping, int begin, int end,
                      struct pair_span shown)
{
    const struct bp_medium *medium = sum->medium;
    const struct bp_table *table = sum->table;
    const struct scale *scale = sum->scale;
    struct places places;
    struct run run;
    double tau[RUN_PIXELS];
    const struct motion motion = motion_make(medium, ping->velocity);
    const bool cubics = table->reading == BP_CUBICS, branches = table->reading == BP_BRANCHES;
    const double one = cubics ? BP_INTERVALS : table->steps;
    const double least = medium->first * table->upsample, last = medium->last * table->upsample;
    run.base = 0;
    for (int first = begin; first < end; first += RUN_PIXELS) {
        const int count = end - first < RUN_PIXELS ? end - first : RUN_PIXELS;
        if (first >= shown.end || first + count <= shown.begin)
            continue;
        places.count = count;
        for (int i = 0; i < count; i++) {
            struct vector p = line_pixel(sum->line, first + i);
            places.x[i] = p.x;
            places.r[i] = p.y;
        }
        legs_out(medium, ping, &places);
        for (int m = 0; m < ping->receivers; m++) {
            const struct vector rx = ping->rx[m];
            if (motion.slow)
                legs_back(true, &motion, &places, rx, tau);
            else
                legs_back(false, &motion, &places, rx, tau);
#pragma omp simd
            for (int i = 0; i < count; i++) {
                double q = (tau[i] - scale->t0) * scale->fs * table->upsample;
                q = q > least ? q : least; /* inside the rows, but for rounding; nothing else becomes an index */
                q = q < last ? q : last;
                double point = floor(q * one + scale->shift * one), cycles = medium->fc * tau[i];
                double sample = floor((point + 0.5) / one);
                run.sample[i] = (int)sample;
                run.step[i] = (int)(point - sample * one);
                const double within = q * one - point; /* enough for rounding to the nearest step */
                run.rest[i] = (real)(cubics ? within : branches ? within + scale->shift - 0.5 : run.step[i] / one);
                run.cycles[i] = (real)(cycles - floor(cycles + 0.5));
            }
            const struct receiver_group one_receiver = {.table = table,
                                                        .receivers = 1,
                                                        .row =
                                                            (const real *)ping->rows + (size_t)m * ping->layout.record,
                                                        .layout = ping->layout,
                                                        .re = sum->re,
                                                        .im = sum->im};
            BP_GATHER(&one_receiver, EXACT, first, count, &run);
        }
    }
}

/* Evaluate every delay of a block, of each ping for its own pixels. */
static void sum_block_exact(const struct line_sum *sum, const struct bp_pings *pings, const struct bp_block *block)
{
    for (int p = 0; p < pings->count; p++) {
        const struct pair_span within = pings->ping[p].within;
        sum_exact(sum, &pings->ping[p], block->begin > within.begin ? block->begin : within.begin,
                  block->end < within.end ? block->end : within.end, block->shown);
    }
}

/* Prefetch a group's samples `low` to `high` of each record. Not of blocks, whose parts lie side by side: the processor
   prefetches these itself. */
INLINE void prefetch(const struct receiver_group *group, const double *low, const double *high)
{
    enum {
        NEAR = 64 / sizeof(real),
        MOST = 16
    }; /* values of a cache line; cache lines of a part, else it does not pay */
    const size_t apart = group->layout.apart;
    const int origin = group->table->origin, parts = group->layout.blocks > 1 ? 0 : 2 * group->table->branches;
    for (int g = 0; g < group->receivers; g++) {
        const int first = ((int)low[g] + origin) / NEAR, last = ((int)high[g] + origin) / NEAR + 2;
        const real *row = group->row + (size_t)g * group->layout.record;
        for (int p = 0; last - first < MOST && p < parts; p++, row += apart)
            for (int i = first; i < last; i++)
                __builtin_prefetch(row + i * NEAR);
    }
}

/* A line reads a short part of each record, and the next line reads it much later. False where a delay is outside the
   rows, `first` to `last`: then no quintic through it may become an index. */
INLINE bool reads_inside(const struct receiver_group *group, double (*tau)[GROUP_RECEIVERS], double first, double last)
{
    const struct scale *scale = group->scale;
    const int upsample = group->table->upsample;
    double low[GROUP_RECEIVERS], high[GROUP_RECEIVERS];
#pragma omp simd
    for (int g = 0; g < GROUP_RECEIVERS; g++) {
        double least = tau[0][g], most = tau[0][g];
        for (int k = 1; k < NODES; k++) {
            least = tau[k][g] < least ? tau[k][g] : least;
            most = tau[k][g] > most ? tau[k][g] : most;
        }
        low[g] = (least - scale->t0) * scale->fs * upsample - 1;
        high[g] = (most - scale->t0) * scale->fs * upsample + 1;
    }
    for (int g = 0; g < group->receivers; g++)
        if (!(low[g] >= first - 2 && high[g] <= last + 2))
            return false;
    prefetch(group, low, high);
    return true;
}

/* The Chebyshev points of some blocks. */
static void nodes_place(const struct pixel_line *line, int block_count, const struct bp_block *blocks,
                        struct places *places)
{
    places->count = NODES * block_count;
    for (int b = 0; b < block_count; b++) {
        const double half = 0.5 * (blocks[b].end - 1 - blocks[b].begin), middle = blocks[b].begin + half;
        for (int k = 0; k < NODES; k++) {
            places->x[b * NODES + k] = line->x_first + (middle + half * node[k]) * line->x_step;
            places->r[b * NODES + k] = line->r_first + (middle + half * node[k]) * line->r_step;
        }
    }
}

/* Delays to the receivers of a group; missing receivers repeat the last one. */
INLINE void group_delays(const struct motion *motion, const struct places *places, const struct vector *rx,
                         int receivers, double (*tau)[GROUP_RECEIVERS])
{
    double x[GROUP_RECEIVERS], y[GROUP_RECEIVERS], z[GROUP_RECEIVERS];
    for (int g = 0; g < GROUP_RECEIVERS; g++) {
        const struct vector at = rx[g < receivers ? g : receivers - 1];
        x[g] = at.x;
        y[g] = at.y;
        z[g] = at.z;
    }
    if (motion->slow)
        group_back(true, motion, places, x, y, z, tau);
    else
        group_back(false, motion, places, x, y, z, tau);
}

static struct scale scale_make(const struct bp_medium *medium, const struct bp_table *table, double t0)
{
    const bool cubics = table->reading == BP_CUBICS;
    const int steps = table->steps > 1 ? table->steps : 1; /* cubics have 0: compilers divide before they choose */
    const double fine = table->upsample * (cubics ? BP_INTERVALS : 1), cycles = medium->fc * t0;
    return (struct scale){.t0 = t0,
                          .fs = medium->fs,
                          .fine = fine,
                          .shift = table->reading == BP_BRANCHES ? table->shift
                                   : cubics                      ? 0
                                                                 : 0.5 / steps,
                          .ratio = medium->fc / (medium->fs * fine),
                          .base = cycles - floor(cycles)};
}

/* Transmitters, receivers and motion of the records of several pings; missing records repeat the last one. */
struct together {
    double tx[3][GROUP_RECEIVERS], rx[3][GROUP_RECEIVERS], v[3][GROUP_RECEIVERS];
    double e[GROUP_RECEIVERS], one_e[GROUP_RECEIVERS];
    struct pair_span within[GROUP_RECEIVERS];
    int records;
    bool slow; /* all of them */
};

static void together_set(struct together *all, int g, const struct motion *motion, struct vector tx, struct vector rx)
{
    const struct vector vectors[] = {tx, rx, motion->v};
    double(*const to[])[GROUP_RECEIVERS] = {all->tx, all->rx, all->v};
    for (int k = 0; k < 3; k++) {
        to[k][0][g] = vectors[k].x;
        to[k][1][g] = vectors[k].y;
        to[k][2][g] = vectors[k].z;
    }
    all->e[g] = motion->e;
    all->one_e[g] = motion->one_e;
    all->slow = all->slow && motion->slow;
}

static void together_make(const struct bp_medium *medium, const struct bp_pings *pings, struct together *all)
{
    all->records = 0;
    all->slow = true;
    for (const struct bp_ping *ping = pings->ping; ping < pings->ping + pings->count; ping++) {
        const struct motion motion = motion_make(medium, ping->velocity);
        const bool last = ping == pings->ping + pings->count - 1;
        for (int m = 0; m < ping->receivers; m++) {
            all->within[all->records] = ping->within;
            together_set(all, all->records++, &motion, ping->tx, ping->rx[m]);
        }
        for (int g = all->records; last && g < GROUP_RECEIVERS; g++)
            together_set(all, g, &motion, ping->tx, ping->rx[ping->receivers - 1]);
    }
}

/* Delays of their records from and to all places; `slow` is a constant where this is inlined. */
INLINE void together_delays(bool slow, double one_c, const struct together *all, const struct places *places,
                            double (*tau)[GROUP_RECEIVERS])
{
    for (int i = 0; i < places->count; i++) {
        const double x = places->x[i], r = places->r[i];
#pragma omp simd
        for (int g = 0; g < GROUP_RECEIVERS; g++) {
            const struct motion motion = {{all->v[0][g], all->v[1][g], all->v[2][g]}, all->e[g], all->one_e[g], slow};
            const double ax = all->tx[0][g] - x, ay = all->tx[1][g] - r, az = all->tx[2][g];
            const double leg = sqrt(ax * ax + ay * ay + az * az) * one_c;
            tau[i][g] = leg_back(slow, &motion, leg, all->rx[0][g] + (motion.v.x * leg - x),
                                 all->rx[1][g] + (motion.v.y * leg - r), all->rx[2][g] + motion.v.z * leg);
        }
    }
}

/* Add the records of some pings to blocks, by their delays at the blocks' Chebyshev points. */
static void sum_blocks(const struct line_sum *sum, const struct bp_pings *pings, struct receiver_group group,
                       double (*tau)[GROUP_RECEIVERS], int block_count, const struct bp_block *blocks)
{
    const int upsample = sum->table->upsample;
    const double first = sum->medium->first * upsample, last = sum->medium->last * upsample;
    bool readable[BP_BLOCKS];
    group.table = sum->table;
    group.scale = sum->scale;
    group.phase_limit = sum->medium->phase_limit;
    group.row = pings->ping->rows;
    group.layout = pings->ping->layout;
    group.re = sum->re;
    group.im = sum->im;
    for (int b = 0; b < block_count; b++)
        readable[b] = !blocks[b].exact && reads_inside(&group, tau + b * NODES, first, last);
    for (int b = 0; b < block_count; b++)
        if (readable[b])
            BP_RUNS(&group, &blocks[b], tau + b * NODES);
        else if (!blocks[b].exact)
            sum_block_exact(sum, pings, &blocks[b]);
}

void BP_SUM(const struct bp_medium *medium, const struct bp_table *table, const struct bp_pings *pings,
            const struct pixel_line *line, int block_count, const struct bp_block *blocks, void *re, void *im)
{
    struct places places; /* not cleared: it is large */
    _Alignas(64) double tau[DELAYS][GROUP_RECEIVERS];
    const struct bp_ping *ping = pings->ping;
    const struct scale scale = scale_make(medium, table, ping->t0);
    const struct line_sum sum = {medium, table, line, &scale, re, im};
    nodes_place(line, block_count, blocks, &places);
    if (pings->count > 1) {
        struct together all;
        together_make(medium, pings, &all);
        if (all.slow)
            together_delays(true, 1 / medium->sound_speed, &all, &places, tau);
        else
            together_delays(false, 1 / medium->sound_speed, &all, &places, tau);
        const struct receiver_group group = {.receivers = all.records, .within = all.within};
        sum_blocks(&sum, pings, group, tau, block_count, blocks);
    } else {
        const struct motion motion = motion_make(medium, ping->velocity);
        legs_out(medium, ping, &places);
        for (int m = 0; m < ping->receivers; m += GROUP_RECEIVERS) {
            struct bp_ping some = *ping;
            some.receivers = ping->receivers - m < GROUP_RECEIVERS ? ping->receivers - m : GROUP_RECEIVERS;
            some.rx += m;
            some.rows = (const real *)ping->rows + (size_t)m * ping->layout.record;
            group_delays(&motion, &places, some.rx, some.receivers, tau);
            sum_blocks(&sum, &(struct bp_pings){1, &some}, (struct receiver_group){.receivers = some.receivers}, tau,
                       block_count, blocks);
        }
    }
    for (int b = 0; b < block_count; b++)
        if (blocks[b].exact)
            sum_block_exact(&sum, pings, &blocks[b]);
}
