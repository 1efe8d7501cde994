/* The plan of the translation-invariant engine: the conditions for a geometry that repeats from ping to ping, the sizes
   of slab and tables, and their memory. */
#include "backprojection/invariant/invariant_plan.h"

#include <limits.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>

#include "backprojection/budget.h"

enum {
    SLAB_BYTES = 64 << 20, /* receivers are taken together up to this: the image is read and written for each slab */
    READ_BYTES = 4 << 20,  /* and as long as the samples that one image row reads stay in the shared cache */
    SLAB_MOST = 128 << 20, /* one receiver's upsampled traces: beyond it their fine steps are taken in passes */
    ENTRIES_LEAST = 1024   /* entries of the tables that are made at once, where a group has fewer */
};

static int round_up(int value, int multiple)
{
    return (value + multiple - 1) / multiple * multiple;
}

/* Cycles of the carrier, or samples where these are shorter: the largest difference between ideal and real delays. It
   bounds the phase error by 1e-6 rad. */
static const double DRIFT_MOST = 1e-7;

/* The patch on the track's raster. */
static enum status raster_make(const struct bp *bp, const struct straight_track *track, const struct grid *grid,
                               struct bp_raster *raster)
{
    const struct acquisition *a = bp->problem.acquisition;
    double spacing = fabs(track->spacing), steps = spacing / grid->x_step;
    double ratio = floor(steps + 0.5);
    if (a->pings == 1) /* every column is a residue of its own */
        ratio = grid->x_count;
    if (!(grid->x_count + ratio + a->pings < INT_MAX / 2))
        return status_set(STATUS_UNSUPPORTED, "%d columns, of which %.0f are a ping spacing, are too many to index",
                          grid->x_count, ratio);
    *raster = (struct bp_raster){.x_first = track->spacing < 0 ? a->tx[a->pings - 1].x : a->tx[0].x,
                                 .spacing = a->pings == 1 ? grid->x_step * grid->x_count : spacing,
                                 .pings = a->pings,
                                 .speed = track->speed,
                                 .t0 = a->t0[0],
                                 .ratio = (int)ratio,
                                 .grid_first = grid->x_first,
                                 .grid_step = grid->x_step,
                                 .columns = grid->x_count,
                                 .residue_columns = (grid->x_count + (int)ratio - 1) / (int)ratio,
                                 .limit = a->aperture_limit};
    return STATUS_OK;
}

/* m: the distance of a ping from the ideal ping of the tables, or of its echoes from the ideal ones. */
static double ping_beside(const struct acquisition *a, const struct straight_track *track, int p)
{
    const double c = a->sound_speed, longest = fmax(fabs(a->t0[p]), fabs(a->t0[p] + (a->samples - 1) / a->fs));
    const struct vector v = a->velocity[p];
    double off = fmax(fmax(fabs(a->tx[p].y), fabs(a->tx[p].z)), fabs(a->tx[p].x - a->tx[0].x - p * track->spacing));
    off = fmax(off, c * fabs(a->t0[p] - a->t0[0]));
    off = fmax(off, longest * fmax(fabs(v.x - track->speed), fmax(fabs(v.y), fabs(v.z))));
    for (int m = 0; m < a->receivers; m++) {
        struct vector rx = a->rx[(size_t)p * (size_t)a->receivers + (size_t)m];
        off = fmax(off, fmax(fabs(rx.y), fabs(rx.z)));
        off = fmax(off, fabs(rx.x - a->tx[p].x - (a->rx[m].x - a->tx[0].x)));
    }
    return off;
}

/* m: the deviation of a grid's columns from the raster of the pings over the whole track. */
static double columns_beside(const struct acquisition *a, const struct straight_track *track, const struct grid *grid)
{
    double spacing = fabs(track->spacing), ratio = floor(spacing / grid->x_step + 0.5);
    if (a->pings == 1)
        return 0;
    if (!(ratio >= 1 && ratio <= INT_MAX) || grid->angle_rad != 0)
        return INFINITY;
    return fabs(spacing - ratio * grid->x_step) * (a->pings + grid->x_count / ratio);
}

struct condition invariant_condition(const struct problem *problem, enum severity severity)
{
    const struct acquisition *a = problem->acquisition;
    struct straight_track track;
    double off = INFINITY, step = 0; /* of the columns that deviate most, 0 where pings deviate more */
    if (acquisition_is_straight(a, &track)) {
        off = 0;
        for (int p = 0; p < a->pings; p++)
            off = fmax(off, ping_beside(a, &track, p));
        for (int k = 0; k < problem->patch_count; k++) {
            const double beside = columns_beside(a, &track, &problem->patches[k]);
            step = beside > off ? problem->patches[k].x_step : step;
            off = fmax(off, beside);
        }
    }
    struct condition condition =
        condition_most(severity, "invariance", off * fmax(a->fc, a->fs) / a->sound_speed, DRIFT_MOST,
                       "drift between columns and pings over the track (cycles of the carrier, or samples); "
                       "the general engine takes any, but is slower",
                       "a uniform straight track whose ping spacing is a whole number of azimuth steps");
    if (step > 0 && isfinite(off)) {
        const double spacing = fabs(track.spacing), ratio = round(spacing / step);
        condition_cure_add(&condition, ": steps of %.12g m in place of %.12g m, or pings %.12g m apart",
                           spacing / ratio, step, ratio * step);
    }
    return condition;
}

enum status invariant_applicable(const struct bp *bp)
{
    const struct acquisition *a = bp->problem.acquisition;
    const struct condition condition = invariant_condition(&bp->problem, SEVERITY_REFUSE);
    struct straight_track track;
    struct bp_raster raster;
    char text[400];
    if (bp->table.reading != BP_CUBICS && bp->table.taps > 1 && bp->table.upsample > 1 && bp->table.branches == 1)
        return status_set(STATUS_UNSUPPORTED, "steps between upsampled samples have no tables");
    if (a->aperture_limit < 1 && a->echo_squint != 0)
        return status_set(
            STATUS_UNSUPPORTED,
            "condition invariance: the aperture limit counts from a beam squinted by %g degrees; 0 is needed "
            "(cure: engine=general)",
            a->echo_squint * 180 / M_PI);
    if (!condition_holds(&condition) || !acquisition_is_straight(a, &track)) {
        condition_message(&condition, text, sizeof text);
        return status_set(STATUS_UNSUPPORTED, "%s", text);
    }
    for (int k = 0; k < bp->problem.patch_count; k++) {
        enum status status = raster_make(bp, &track, &bp->problem.patches[k], &raster);
        if (status != STATUS_OK)
            return status;
    }
    return STATUS_OK;
}

/* The largest distance along the track between a ping and a pixel at r that are a pair. */
static double reach(const struct bp_raster *raster, const struct grid *grid, double r)
{
    const double last_ping = raster->x_first + (raster->pings - 1) * raster->spacing, limit = raster->limit;
    const double last_column = grid->x_first + (grid->x_count - 1) * grid->x_step;
    const double most = fabs(fmax(last_ping - grid->x_first, last_column - raster->x_first));
    return limit < 1 ? fmin(most, r * limit / sqrt((1 - limit) * (1 + limit))) : most;
}

/* Of each residue, the shifts that bring a ping inside the aperture to any of its columns. */
void invariant_units(const struct bp *bp, struct forecast *forecast)
{
    forecast->units = forecast->residues = INFINITY;
    struct straight_track track;
    struct bp_raster raster = {0};
    double units = 0;
    if (!acquisition_is_straight(bp->problem.acquisition, &track))
        return;
    for (int k = 0; k < bp->problem.patch_count; k++) {
        const struct grid *grid = &bp->problem.patches[k];
        const double r = fabs(grid->r_first + (grid->r_count - 1) * grid->r_step / 2);
        if (raster_make(bp, &track, grid, &raster) != STATUS_OK)
            return;
        const double shifts =
            fmin(raster.pings + raster.residue_columns - 1, 2 * reach(&raster, grid, r) / raster.spacing + 1);
        units += (double)grid->r_count * raster_residues(&raster) * shifts;
        forecast->residues = fmin(forecast->residues, bp_whole(&bp->table) ? raster_residues(&raster) : 1);
    }
    forecast->units = units * bp->problem.acquisition->receivers;
}

/* The least and the largest distance between a row of the grid and the track, on either side. */
static void row_ranges(const struct grid *grid, double r[2])
{
    const double first = grid->r_first, last = first + (grid->r_count - 1) * grid->r_step;
    r[0] = first < 0 && last > 0 ? 0 : fmin(fabs(first), fabs(last));
    r[1] = fmax(fabs(first), fabs(last));
}

/* The most samples of a record that one row of a patch reads: those between its nearest and its furthest pixel. */
static double samples_read(const struct bp *bp, const struct bp_raster *raster, const struct grid *grid)
{
    double samples = 0, r[2];
    row_ranges(grid, r);
    for (int end = 0; end < 2; end++) {
        double x = reach(raster, grid, r[end]);
        samples = fmax(samples, 2 * (sqrt(r[end] * r[end] + x * x) - r[end]) / bp->medium.sound_speed * bp->medium.fs);
    }
    return bp->table.branches > 1 ? (samples + 1) * bp->table.branches : samples + bp->table.taps;
}

/* The most samples by which the delay changes over one azimuth step, of any pair inside the aperture or one ping
   spacing outside it: those of the row nearest to the track. */
static double steepness(const struct bp *bp, const struct bp_raster *raster, const struct grid *grid)
{
    const struct invariant *in = bp->state;
    const double c = bp->medium.sound_speed, v = fabs(raster->speed), e = (c - v) * (c + v);
    double offset = 0, ranges[2];
    for (int m = 0; m < bp->problem.acquisition->receivers; m++)
        offset = fmax(offset, fabs(in->offsets[m]));
    row_ranges(grid, ranges);
    const double r = ranges[0], x = reach(raster, grid, r) + raster->spacing, leg = sqrt(x * x + r * r);
    const double b = x + offset + v * leg / c, sine = x / leg, back = b / sqrt(b * b + e / (c * c) * r * r);
    return (sine / c + (v + c * back) / e * (1 + v / c * sine)) * grid->x_step * bp->medium.fs;
}

/* Neighbouring residues that are summed together. Of up to two taps, two where they mostly read the same samples; of
   more taps, as many as keep their samples within BP_SPREAD, rounding included; of branches, any. */
static int residues_together(const struct bp *bp, double steepness)
{
    steepness *= bp->table.upsample;
    if (bp->table.branches > 1)
        return BP_TOGETHER_BRANCHES;
    if (!bp_whole(&bp->table))
        return 1;
    if (bp->table.taps < 3)
        return steepness <= 0.5 ? 2 : 1;
    return (int)fmin(BP_TOGETHER, 1 + floor((BP_SPREAD - 1) / steepness));
}

/* Rows and receivers of the slab, and the passes that keep it small for any upsampling. A row of the image reads `read`
   samples at most. */
static void plan_slab(struct bp *bp, double read)
{
    struct invariant *in = bp->state;
    /* Vectors of columns with a ping are read, and so up to their width less one before the first ping and behind the
       last. Room is made for the widest vectors, so that a plan needs the same memory on every machine; rows are whole
       ones, so that a tile of pings fills whole cache lines. */
    const int lead = BP_LANES_MOST * (int)sizeof(float) / (int)real_size(bp->problem.precision);
    const int ping_stride = round_up(bp->problem.acquisition->pings + 2 * lead, lead);
    int upsample = bp->table.upsample, samples = bp->shape.samples;
    size_t row_bytes = (size_t)ping_stride * 2 * real_size(bp->problem.precision);
    int width = upsample;
    if (!bp_whole(&bp->table))
        width = (int)fmin(upsample, fmax(1, floor((double)SLAB_MOST / ((double)samples * (double)row_bytes))));
    in->passes = (upsample + width - 1) / width;
    in->slab_rows =
        bp_whole(&bp->table) ? (size_t)bp->table.branches * (size_t)bp->shape.length : (size_t)samples * (size_t)width;
    in->slab = (struct bp_slab){.receiver_stride = in->slab_rows * (size_t)ping_stride,
                                .ping_stride = ping_stride,
                                .lead = lead,
                                .step_count = width,
                                .step_rows = samples};
    double fitting = fmin((double)SLAB_BYTES / (double)(in->slab_rows * row_bytes),
                          (double)READ_BYTES / (read * width * (double)row_bytes));
    in->receivers = (int)fmin(bp->problem.acquisition->receivers, fmax(1, floor(fitting)));
}

struct arena {
    char *base; /* NULL while the size is computed */
    size_t used;
};

static void *take(struct arena *arena, size_t count, size_t size)
{
    void *part = arena->base ? arena->base + arena->used : NULL;
    arena->used += (count * size + 63) / 64 * 64;
    return part;
}

/* The longest tables of any patch. */
struct lengths {
    size_t residues, row; /* of a row: residues, and entries of all of them */
    size_t entries;       /* of a chunk */
    size_t taps, spread;
    double samples; /* of a record that a row reads */
};

/* One row's scratch, from the arena. */
static struct bp_row_scratch scratch_take(struct arena *arena, const struct lengths *lengths, size_t real_bytes)
{
    const size_t row = lengths->row, entries = lengths->entries, taps = lengths->taps;
    const size_t nodes = (size_t)PIECES_MOST * PIECE_POWERS;
    const size_t few = taps < 3 ? taps : 1, many = taps < 3 ? 0 : lengths->spread;
    return (struct bp_row_scratch){.groups = take(arena, lengths->residues + 1, sizeof(struct bp_row_group)),
                                   .leg = take(arena, row, sizeof(double)),
                                   .ahead = take(arena, row, sizeof(double)),
                                   .piece = take(arena, row, sizeof(int)),
                                   .pieces = take(arena, PIECES_MOST, sizeof(struct bp_piece)),
                                   .polynomials = take(arena, PIECES_MOST, sizeof(struct bp_polynomial)),
                                   .node_leg = take(arena, nodes, sizeof(double)),
                                   .node_ahead = take(arena, nodes, sizeof(double)),
                                   .node_q = take(arena, nodes, sizeof(double)),
                                   .shift = take(arena, row, sizeof(int)),
                                   .gate = take(arena, row, real_bytes),
                                   .capacity = (int)entries,
                                   .q = take(arena, entries, sizeof(double)),
                                   .kept = take(arena, entries, sizeof(int)),
                                   .row = take(arena, entries, sizeof(int)),
                                   .offset = take(arena, entries, sizeof(int)),
                                   .step = take(arena, entries, sizeof(int)),
                                   .rows = take(arena, entries, sizeof(int)),
                                   .wr = take(arena, entries * few, real_bytes),
                                   .wi = take(arena, entries * few, real_bytes),
                                   .weights = take(arena, entries * many, real_bytes)};
}

/* The parts for the track and for the count of patches. */
static enum status plan_track(struct bp *bp, const struct straight_track *track)
{
    const struct problem *problem = &bp->problem;
    const struct acquisition *a = problem->acquisition;
    struct invariant *in = bp->state;
    struct store *store = &bp->engines;
    in->row = ISA_CHOOSE(bp_row, problem->precision);
    in->scatter = ISA_CHOOSE(bp_scatter, problem->precision);
    piece_fit_make(&in->fit);
    in->reversed = track->spacing < 0;
    in->patch_count = problem->patch_count;
    in->rasters = store_room(store, (size_t)problem->patch_count, sizeof *in->rasters, 1);
    in->strides = store_room(store, (size_t)problem->patch_count, sizeof *in->strides, 1);
    in->sums = store_keep(store, malloc((size_t)problem->patch_count * sizeof *in->sums), free);
    in->offsets = store_room(store, (size_t)a->receivers, sizeof *in->offsets, 1);
    if (store->failed)
        return status_set(STATUS_FAILED, "no memory for the plan");
    for (int m = 0; m < a->receivers; m++)
        in->offsets[m] = a->rx[m].x - a->tx[0].x;
    return STATUS_OK;
}

/* The greatest length of pieces; a phase counts from a piece's middle, whose cycles fit 18 bits. */
static void pieces_plan(const struct bp *bp, struct bp_raster *raster)
{
    const struct bp_medium *medium = &bp->medium;
    const double c = medium->sound_speed, mach = fabs(raster->speed) / c, frequency = fmax(medium->fc, medium->fs);
    const double limit = budget_pieces(medium->phase_limit, bp->problem.precision);
    raster->fit = &((const struct invariant *)bp->state)->fit;
    raster->longest = 0x1p17 * (1 - mach) * c / frequency;
    raster->reach = limit > 0 && mach <= BP_SLOW ? piece_reach(mach, limit * c / (2 * M_PI * frequency)) : 0;
}

/* The wanted columns, and those that a vector may sum beside them. Returns the number of those with sums. */
static int columns_plan(struct bp_raster *raster, const struct pixel_window *w)
{
    enum { BESIDE = BP_LANES_MOST };
    const int first = w->column / raster->ratio, end = (w->column + w->columns - 1) / raster->ratio + 1;
    raster->shown = (struct pair_span){first, end};
    raster->stored = first > BESIDE ? (first - BESIDE) / BP_LANES_MOST * BP_LANES_MOST : 0;
    return (end < raster->residue_columns - BESIDE ? end + BESIDE : raster->residue_columns) - raster->stored;
}

/* Raster and sums of patch k; adds its needs to the lengths. */
static enum status plan_patch(struct bp *bp, const struct straight_track *track, int k, struct lengths *lengths)
{
    const struct grid *grid = &bp->problem.patches[k];
    struct invariant *in = bp->state;
    struct bp_raster *raster = &in->rasters[k];
    raster_make(bp, track, grid, raster);
    raster->together = residues_together(bp, steepness(bp, raster, grid));
    raster->rows = bp->table.branches > 1 ? BP_ROWS_MOST / raster_residues(raster) : 1;
    raster->rows = raster->rows > 1 ? raster->rows : 1;
    in->rows = raster->rows > in->rows ? raster->rows : in->rows;
    pieces_plan(bp, raster);
    const struct pixel_window w = problem_window(&bp->problem, k);
    /* Sums of branches are read and written for each shift: no vector of them crosses a cache line. */
    const int columns = columns_plan(raster, &w);
    in->strides[k] = round_up(columns + BP_LANES_MOST, bp->table.branches > 1 ? BP_LANES_MOST : 8);
    const size_t residues = (size_t)raster_residues(raster), size = real_size(bp->problem.precision);
    in->sums[k] = store_room(&bp->engines, 2 * (size_t)w.rows * residues * (size_t)in->strides[k], size, 1);
    if (!in->sums[k])
        return status_set(STATUS_FAILED, "no memory for the sums of %d x %d pixels", w.columns, w.rows);
    const size_t shifts = (size_t)BP_ENTRIES(raster->pings + raster->residue_columns);
    lengths->residues = residues > lengths->residues ? residues : lengths->residues;
    lengths->row = residues * shifts > lengths->row ? residues * shifts : lengths->row;
    const size_t group = (bp->table.branches > 1 ? BP_TOGETHER_BRANCHES : BP_TOGETHER) * shifts;
    lengths->entries = group > lengths->entries ? group : lengths->entries;
    lengths->samples = fmax(lengths->samples, samples_read(bp, raster, grid));
    return STATUS_OK;
}

/* The memory of slab and tables. */
static enum status plan_memory(struct bp *bp, const struct lengths *lengths)
{
    struct invariant *in = bp->state;
    const size_t size = real_size(bp->problem.precision), threads = (size_t)omp_get_max_threads();
    const size_t values = (size_t)in->receivers * in->slab.receiver_stride;
    const size_t tile =
        (bp_whole(&bp->table) ? (size_t)bp->shape.branches * (size_t)bp->shape.length : 2 * bp->shape.pitch) * TILE * 2
        * size;
    struct store *store = &bp->engines;
    if (!((double)lengths->entries * (double)lengths->spread < INT_MAX))
        return status_set(STATUS_UNSUPPORTED, "tables of %zu entries are too long to index", lengths->entries);
    if (!(in->slab.receiver_stride < INT_MAX))
        return status_set(STATUS_UNSUPPORTED, "records of %zu values a receiver are too long to index",
                          in->slab.receiver_stride);
    struct arena arena = {NULL, 0};
    scratch_take(&arena, lengths, size);
    const size_t per_scratch = arena.used, scratches = threads * (size_t)in->rows;
    const size_t rows = (size_t)in->receivers * in->slab_rows;
    const size_t run = bp->problem.window ? (size_t)(bp_pings_wanted(bp) + 2 * in->slab.lead) * size : 0;
    in->slab_re = bp_part_allocate(bp, values * size, rows, run);
    in->slab_im = bp_part_allocate(bp, values * size, rows, run);
    in->tile_bytes = (tile + 63) / 64 * 64;
    in->tiles = store_room(store, threads, in->tile_bytes, 1.0 / (double)threads);
    in->tables = store_room(store, scratches, per_scratch, 1.0 / (double)threads);
    in->scratch = store_room(store, scratches, sizeof *in->scratch, 1.0 / (double)threads);
    if (store->failed)
        return status_set(STATUS_FAILED, "no memory for records of %d receivers", in->receivers);
    arena = (struct arena){in->tables, 0};
    for (size_t t = 0; t < scratches; t++)
        in->scratch[t] = scratch_take(&arena, lengths, size);
    return STATUS_OK;
}

enum status invariant_plan(struct bp *bp)
{
    struct straight_track track;
    struct lengths lengths = {.entries = ENTRIES_LEAST,
                              .taps = (size_t)bp->table.taps,
                              .spread = bp->table.branches > 1 ? 1 : (size_t)bp->table.taps + BP_SPREAD};
    bp->state = store_keep(&bp->engines, calloc(1, sizeof(struct invariant)), free);
    if (!bp->state)
        return status_set(STATUS_FAILED, "no memory for the plan");
    enum status status = bp_plan_traces(bp, bp_samples_read(bp));
    acquisition_is_straight(bp->problem.acquisition, &track);
    if (status == STATUS_OK)
        status = plan_track(bp, &track);
    for (int k = 0; k < bp->problem.patch_count && status == STATUS_OK; k++)
        status = plan_patch(bp, &track, k, &lengths);
    if (status != STATUS_OK)
        return status;
    plan_slab(bp, lengths.samples);
    return plan_memory(bp, &lengths);
}
