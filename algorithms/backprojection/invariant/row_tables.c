/* The tables of the translation-invariant engine (row.h): which shifts of which residues an image row sums, where they
   read the slab, and their weights; in whole vectors. This file is compiled once for each precision and instruction set
   (BP_ISA names it). */
#include <assert.h>
#include <math.h>

#include "backprojection/invariant/chunk.h"

/* `value`, a whole number, inside [least, most]: fmin and fmax are calls. */
static int clamp(double value, int least, int most)
{
    return !(value > least) ? least : value < most ? (int)value : most;
}

/* As pairs.c defines it, for a ping that is u ahead of the pixel. */
static bool inside_limit(const struct bp_raster *raster, double u, double r)
{
    const double distance = sqrt(u * u + r * r),
                 grid_last = raster->grid_first + (raster->columns - 1) * raster->grid_step;
    const double track_last = raster->x_first + (raster->pings - 1) * raster->spacing;
    return fabs(u) <= raster->limit * distance
           || distance <= apex_slack(fmax(fabs(raster->grid_first), fabs(grid_last)),
                                     fmax(fabs(raster->x_first), fabs(track_last)));
}

/* Shifts [begin, end) of one residue inside the aperture: |u| <= limit sqrt(u^2 + r^2), that is, |u| <= edge, u = x + s
   spacing. */
static void shift_bounds(const struct bp_raster *raster, double edge, double x, double r, int *begin, int *end)
{
    const double one_spacing = 1 / raster->spacing;
    const double first = (-edge - x) * one_spacing, last = (edge - x) * one_spacing;
    int low = clamp(ceil(first), *begin, *end), high = clamp(floor(last) + 1, *begin, *end);
    if (fabs(first - floor(first + 0.5)) < 1e-6 || fabs(last - floor(last + 0.5)) < 1e-6) {
        /* so near a shift that rounding decides: by the definition */
#define INSIDE(s) inside_limit(raster, x + (s)*raster->spacing, r)
        while (low < high && !INSIDE(low))
            low++;
        while (low > *begin && INSIDE(low - 1))
            low--;
        while (high > low && !INSIDE(high - 1))
            high--;
        while (high < *end && INSIDE(high))
            high++;
#undef INSIDE
    }
    *begin = low;
    *end = high;
}

/* The shifts [begin, end) of each residue of a group inside the aperture. */
struct shifts {
    int begin[BP_TOGETHER_BRANCHES], end[BP_TOGETHER_BRANCHES];
};

/* A group's entries, by shift and then residue, padded to whole vectors by the last: how far the ping lies ahead of the
   column. Those outside their residue's aperture have gate 0, all others 1. */
INLINE void group_places(int residues, const struct bp_row *row, const struct bp_row_group *group,
                         const struct shifts *inside)
{
    const struct bp_raster *raster = row->raster;
    const struct bp_row_scratch *scratch = row->scratch;
    double *restrict ahead = scratch->ahead + group->first;
    int *restrict shift = scratch->shift + group->first;
    real *restrict gate = (real *)scratch->gate + group->first;
    const int n = (group->end - group->begin) * residues, whole = whole_vectors(n);
    const double spacing = raster->spacing;
    double x[BP_TOGETHER_BRANCHES];
    for (int k = 0; k < residues; k++)
        x[k] = raster->x_first - (raster->grid_first + (group->residue + k) * raster->grid_step);
    for (int s = group->begin, i = 0; s < group->end; s++, i += residues) {
        const double along = s * spacing;
#pragma omp simd
        for (int k = 0; k < residues; k++) {
            ahead[i + k] = x[k] + along;
            shift[i + k] = s;
            gate[i + k] = (real)((s >= inside->begin[k]) & (s < inside->end[k]));
        }
    }
    for (int i = n; i < whole; i++) {
        ahead[i] = ahead[n - 1];
        shift[i] = shift[n - 1];
        gate[i] = 0;
    }
}

static struct delay_terms delay_terms_make(const struct bp_row *row)
{
    const double c = row->medium->sound_speed, v = row->raster->speed, r = row->r, e = (c - v) * (c + v);
    return (struct delay_terms){v, c * c, r * r, e * r * r, 1 / e, fabs(v) <= BP_SLOW * c};
}

/* The least and the largest distance along the track between a ping and a pixel that are summed. */
struct distances {
    double least, most; /* m */
};

/* Are all delays of a row among the samples that pairs read, by bounds of the least and the longest delay? `offset`:
   the largest distance along the track between transmitter and receiver. */
static bool inside_record(const struct bp_row *row, const struct delay_terms *terms, double offset,
                          struct distances distances)
{
    const struct bp_medium *medium = row->medium;
    const double r = row->r, t0 = row->raster->t0, c = medium->sound_speed, v = fabs(terms->v);
    const double first = t0 + medium->first / medium->fs, last = t0 + medium->last / medium->fs;
    const double leg = sqrt(distances.most * distances.most + r * r) / c, b = distances.most + offset + v * leg;
    /* Bounds by both ways together, or, as they end with the record, by each of its own. */
    const double ahead = distances.least, behind = fmax(0, ahead - offset - v * fmax(0, last));
    const double least = fmax(fabs(r) / c + (sqrt(terms->er2) - v * b) * terms->one_e,
                              (sqrt(ahead * ahead + r * r) + sqrt(behind * behind + r * r)) / c);
    const double most = leg + (v * b + sqrt(terms->c2 * b * b + terms->er2)) * terms->one_e;
    const double slack = 1e-8 / medium->fs;
    return least >= first + slack && most <= last - slack;
}

/* One group from `first` on; its distances along the track are among *distances then. */
static void group_make(const struct bp_row *row, int first, int count, struct bp_row_group *group,
                       struct distances *distances)
{
    const struct bp_raster *raster = row->raster;
    const double limit = raster->limit;
    const double edge = limit < 1 ? fabs(row->r) * limit / sqrt((1 - limit) * (1 + limit)) : INFINITY;
    struct shifts inside;
    group->residue = first;
    group->residues = count;
    for (int k = 0; k < count; k++) {
        const int p = first + k;
        double x = raster->x_first - (raster->grid_first + p * raster->grid_step);
        int begin = 1 - (raster->columns - p + raster->ratio - 1) / raster->ratio, end = raster->pings;
        if (limit < 1)
            shift_bounds(raster, edge, x, row->r, &begin, &end);
        inside.begin[k] = begin;
        inside.end[k] = end;
        if (begin == end)
            continue;
        bool empty = group->begin == group->end;
        group->begin = empty || begin < group->begin ? begin : group->begin;
        group->end = empty || end > group->end ? end : group->end;
        const double low = x + begin * raster->spacing, high = x + (end - 1) * raster->spacing;
        distances->most = fmax(distances->most, fmax(-low, high));
        distances->least = fmin(distances->least, fmax(0, fmax(low, -high)));
    }
    group->to = group->end - group->begin;
    if (group->to > 0)
        count == 2 ? group_places(2, row, group, &inside) : group_places(count, row, group, &inside);
}

struct row_tables TABLES_BEGIN(const struct bp_row *row) {
    const struct bp_raster *raster = row->raster;
    struct bp_row_group *groups = row->scratch->groups;
    const int residues = raster_residues(raster);
    const int group_count = (residues + raster->together - 1) / raster->together;
    const int size = residues / group_count, larger = residues % group_count; /* the first ones have one residue more */
    struct distances distances = {INFINITY, 0};
    double offset = 0;
    int total = 0;
    for (int g = 0; g < group_count; g++) {
        groups[g] = (struct bp_row_group){.first = total};
        group_make(row, g * size + (g < larger ? g : larger), size + (g < larger), &groups[g], &distances);
        total += whole_vectors(groups[g].to * groups[g].residues);
    }
    groups[group_count].first = total;
    /* A group has entries outside the aperture of some of its residues. */
    distances.least = fmax(0, distances.least - raster->spacing);
    distances.most += raster->spacing;
    for (int m = 0; m < row->receivers; m++)
        offset = fmax(offset, fabs(row->offsets[m]));
    const struct delay_terms terms = delay_terms_make(row);
    const bool inside = inside_record(row, &terms, offset, distances);
    return (struct row_tables){group_count, DELAYS_PLAN(row, &terms, inside ? offset : INFINITY, total), terms, inside};
}

/* The sample at or before q and the nearest of `steps` steps from there on to the next. */
INLINE void
nearest_step(double q, int steps, int *sample, int *step)
{
    int whole = (int)q, near = (int)((q - whole) * steps + 0.5), next = near == steps; /* q >= 0: the cast is floor */
    *sample = whole + next;
    *step = next ? 0 : near;
}

/* A group's entries, from `first` of the chunk on: those outside the record get weight 0 and read its nearest sample.
   Shifts before the first and after the last with an entry inside are left out. */
static void confine(const struct chunk *chunk, struct bp_row_group *group, int first)
{
    double *restrict q = chunk->scratch->q + first;
    real *restrict wr = (real *)chunk->scratch->wr + first, *restrict wi = (real *)chunk->scratch->wi + first;
    const double first_sample = chunk->medium->first, last = chunk->medium->last;
    const int residues = group->residues, n = (group->end - group->begin) * residues, whole = whole_vectors(n);
    int from = n, to = 0;
    for (int i = 0; i < whole; i++) {
        if (q[i] >= first_sample && q[i] <= last) {
            from = i < from ? i : from;
            to = i + 1;
            continue;
        }
        wr[i] = wi[i] = 0;
        q[i] = q[i] < first_sample ? first_sample : last;
    }
    to = to < n ? to : n;
    group->from = from < to ? from / residues : 0;
    group->to = from < to ? (to + residues - 1) / residues : 0;
}

/* Of the entries of one residue, from `first` of the chunk on, keep those inside the record whose fine sample is in the
   slab. */
static void keep(const struct chunk *chunk, struct bp_row_group *group, int first)
{
    const struct bp_slab *slab = chunk->slab;
    double *q = chunk->scratch->q + first;
    real *wr = (real *)chunk->scratch->wr + first, *wi = (real *)chunk->scratch->wi + first;
    int *kept = chunk->scratch->kept + first;
    int count = 0, n = group->end - group->begin;
    for (int i = 0; i < n; i++) {
        if (!(q[i] >= chunk->medium->first && q[i] <= chunk->medium->last))
            continue;
        int sample, step;
        nearest_step(q[i], chunk->table->upsample, &sample, &step);
        if (step < slab->step_first || step >= slab->step_first + slab->step_count)
            continue;
        q[count] = q[i];
        wr[count] = wr[i];
        wi[count] = wi[i];
        kept[count++] = group->begin + i;
    }
    group->to = count;
    for (int i = count; i < whole_vectors(n); i++) {
        q[i] = chunk->medium->first;
        kept[i] = group->begin;
    }
}

/* Where a chunk's entries read the slab: the first tap's row, and its value for ping `shift`. Input of their weights:
   the fine step from the sample to the next one, or the interval, and with cubics the position inside it, in place of
   q. With branches the sum needs only the distance from the sample. */
INLINE void tabulate(const struct chunk *chunk)
{
    const struct bp_table *table = chunk->table;
    const struct bp_slab *slab = chunk->slab;
    const struct bp_row_scratch *scratch = chunk->scratch;
    const int n = chunk->entries, *restrict shift = chunk->shift;
    double *restrict q = scratch->q;
    int *restrict row = scratch->row, *restrict offset = scratch->offset, *restrict step = scratch->step;
    const int upsample = table->upsample; /* the loops below vectorise where they read nothing through `table` */
    const int first = bp_whole(table) ? table->origin + table->first : (table->origin - table->guard) / upsample;
    const int stride = slab->ping_stride;
    if (table->reading == BP_CUBICS) {
#pragma omp simd
        for (int i = 0; i < n; i++) {
            const double place = q[i] * upsample;
            const int sample = (int)place;
            const double interval = (place - sample) * BP_INTERVALS;
            const int whole = (int)interval;
            row[i] = sample + first;
            offset[i] = (sample + first) * stride + shift[i];
            step[i] = whole;
            q[i] = interval - whole;
        }
        return;
    }
    if (table->reading == BP_BRANCHES) {
        real *restrict weights = scratch->weights;
        const int pitch = table->branches * stride, origin = table->origin;
#pragma omp simd
        for (int i = 0; i < n; i++) {
            const double place = q[i] * upsample;
            const int sample = (int)(place + 0.5);
            offset[i] = (sample + origin) * pitch + shift[i];
            weights[i] = (real)(place - sample);
        }
        return;
    }
    if (table->taps == 1 && upsample == 1) {
#pragma omp simd
        for (int i = 0; i < n; i++) {
            row[i] = (int)(q[i] + 0.5) + first;
            offset[i] = row[i] * stride + shift[i];
        }
        return;
    }
    const bool fine = upsample > 1;
    const int steps = fine ? upsample : table->steps, rows = fine ? slab->step_rows : 0, step_first = slab->step_first;
#pragma omp simd
    for (int i = 0; i < n; i++) {
        int sample, near;
        nearest_step(q[i], steps, &sample, &near);
        const int at = sample + (near - step_first) * rows + first;
        row[i] = at;
        offset[i] = at * stride + shift[i];
        step[i] = near;
    }
}

/* The weights of one entry's taps, from its step and, with cubics, its position u. */
INLINE void weigh(bool cubics, int taps, const real *values, int step, real u, real *restrict weights)
{
    if (cubics) {
        const real *w = values + step * 4 * taps;
#pragma omp simd
        for (int t = 0; t < taps; t++)
            weights[t] = w[t] + u * (w[taps + t] + u * (w[2 * taps + t] + u * w[3 * taps + t]));
    } else {
        for (int t = 0; t < taps; t++)
            weights[t] = values[step * taps + t];
    }
}

/* Two taps: the weights times the taps' own. */
INLINE void join_two(const struct chunk *chunk)
{
    const struct bp_row_scratch *scratch = chunk->scratch;
    const bool cubics = chunk->table->reading == BP_CUBICS;
    real *wr = scratch->wr, *wi = scratch->wi;
    for (int e = chunk->entries - 1; e >= 0; e--) {
        real weights[2], cosine = wr[e], sine = wi[e];
        weigh(cubics, 2, chunk->table->weights, scratch->step[e], (real)scratch->q[e], weights);
        for (int t = 0; t < 2; t++) {
            wr[2 * e + t] = cosine * weights[t];
            wi[2 * e + t] = sine * weights[t];
        }
    }
}

/* Many taps: the samples for all residues of a group, and the weights of each residue for them. */
INLINE void join_many(bool cubics, int taps, const struct chunk *chunk, const struct bp_row_group *group, int first)
{
    const struct bp_row_scratch *scratch = chunk->scratch;
    const int residues = group->residues, n = group->end - group->begin, stride = chunk->slab->ping_stride;
    const int *row = scratch->row + first, *step = scratch->step + first, *shift = chunk->shift + first;
    const real *values = chunk->table->weights;
    const double *u = scratch->q + first;
    int *offset = scratch->offset + first, *rows = scratch->rows + first;
    real *weights = (real *)scratch->weights + (size_t)first * (size_t)(taps + BP_SPREAD);
    for (int i = 0; i < n; i++) {
        int least = *row, most = least;
        for (int p = 1; p < residues; p++) {
            least = row[p] < least ? row[p] : least;
            most = row[p] > most ? row[p] : most;
        }
        assert(most - least <= BP_SPREAD);
        for (int p = 0; p < residues; p++) {
            for (int t = 0; t < taps + BP_SPREAD; t++)
                weights[t] = 0;
            weigh(cubics, taps, values, step[p], (real)u[p], weights + (row[p] - least));
            weights += taps + BP_SPREAD;
        }
        rows[i] = taps + most - least;
        offset[i] = least * stride + *shift; /* i <= the first of these residues' entries, which is read before */
        row += residues;
        step += residues;
        shift += residues;
        u += residues;
    }
}

/* The shipped kernels unroll, any other length works as well. */
static void join_group(const struct chunk *chunk, const struct bp_row_group *group, int first)
{
    const int taps = chunk->table->taps;
    const bool cubics = chunk->table->reading == BP_CUBICS;
#define JOIN(taps) cubics ? join_many(true, taps, chunk, group, first) : join_many(false, taps, chunk, group, first)
    if (taps == 4)
        JOIN(4);
    else if (taps == 6)
        JOIN(6);
    else if (taps == 8)
        JOIN(8);
    else
        JOIN(taps);
}

void TABLES_MAKE(const struct row_tables *tables, double offset, struct chunk *chunk)
{
    const struct bp_row_scratch *scratch = chunk->scratch;
    const struct bp_table *table = chunk->table;
    struct bp_row_group *groups = scratch->groups;
    const int first = groups[chunk->begin].first;
    chunk->entries = groups[chunk->end].first - first;
    DELAYS_MAKE(tables, offset, chunk);
    for (int g = chunk->begin; g < chunk->end; g++)
        if (chunk->sparse)
            keep(chunk, &groups[g], groups[g].first - first);
        else if (!tables->inside_record)
            confine(chunk, &groups[g], groups[g].first - first);
    chunk->shift = chunk->sparse ? scratch->kept : scratch->shift + first;
    tabulate(chunk);
    if (table->taps == 2)
        join_two(chunk);
    for (int g = chunk->begin; table->taps > 2 && table->reading != BP_BRANCHES && g < chunk->end; g++)
        join_group(chunk, &groups[g], groups[g].first - first);
}
