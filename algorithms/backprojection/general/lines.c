/* Lines of pixels and batches of records (general/lines.h). */
#include "backprojection/general/lines.h"

#include <omp.h>
#include <string.h>

size_t bp_branch_length(const struct bp *bp)
{
    return (size_t)(bp->shape.length + 2 * (bp->table.guard - bp->shape.guard));
}

size_t bp_record_values(const struct bp *bp)
{
    const size_t trace = (size_t)bp->shape.branches * (size_t)bp->shape.length;
    return trace + (bp->table.branches > bp->shape.branches ? bp_branch_length(bp) : 0);
}

/* Two blocks more than a record has: windows are two. Rounded up, so that a plan needs the same memory everywhere. */
struct bp_layout bp_layout_make(enum precision precision, size_t length, int branches, bool in_blocks)
{
    const size_t parts = 2 * (size_t)branches, vector = 64 / real_size(precision), advance = vector / 2;
    const size_t blocks = (length + advance - 1) / advance + 2;
    struct bp_layout layout = {.apart = in_blocks ? blocks * vector : length, .blocks = 1};
#ifdef SASBENCH_X86_64
    if (in_blocks && isa_choose() == ISA_V4)
        layout = (struct bp_layout){.apart = vector, .blocks = (int)blocks};
#endif
    layout.record = (size_t)layout.blocks * parts * layout.apart;
    return layout;
}

/* Add pings to a line's pixels `within`, which contain those of each ping. */
static void sum_span(const struct bp_lines *lines, const struct ping_box *box, const struct bp_pings *pings,
                     const struct pixel_line *line, struct pair_span within, void *re, void *im)
{
    const struct pair_span shown = lines->shown;
    struct bp_block blocks[BP_BLOCKS];
    for (int count; (count = blocks_make(box, line, &within, blocks)) > 0;) {
        int kept = shown.end > 0 ? 0 : count;
        for (int b = 0; b < count && shown.end > 0; b++)
            if (blocks[b].begin < shown.end && blocks[b].end > shown.begin) {
                blocks[kept] = blocks[b];
                blocks[kept++].shown = shown;
            }
        if (kept > 0)
            lines->sum(&lines->bp->medium, &lines->bp->table, pings, line, kept, blocks, re, im);
    }
}

/* Is the delay of every pixel of `within` inside every receiver's record from t0 on, by the shortest and the longest
   path? */
static bool inside_record(const struct bp_lines *lines, const struct ping_box *box, double t0,
                          const struct pixel_line *line, struct pair_span within)
{
    const struct acquisition *a = lines->acquisition;
    double c = a->sound_speed, last = t0 + (a->samples - 1) / a->fs, slack = 1e-9 / a->fs;
    double least = 2 * ping_box_clearance(box, line, within.begin, within.end) / c;
    double most = 2 * ping_box_extent(box, line, within.begin, within.end) / c;
    return least >= t0 + slack && most <= last - slack;
}

/* The place of a line's sums. */
struct line_sums {
    const struct pixel_line *line;
    void *re, *im;
};

/* Add ping p, or some of its receivers, to the pixels of ping->within. */
static void add_alone(const struct bp_lines *lines, const struct line_sums *to, int p, const struct bp_ping *ping)
{
    const struct acquisition *a = lines->acquisition;
    const struct ping_box *box = &lines->boxes[p];
    const struct pixel_line *line = to->line;
    if (inside_record(lines, box, ping->t0, line, ping->within)) {
        sum_span(lines, box, &(struct bp_pings){1, ping}, line, ping->within, to->re, to->im);
        return;
    }
    const size_t row_bytes = lines->layout.record * real_size(lines->bp->problem.precision);
    struct bp_ping one = *ping;
    one.receivers = 1;
    for (int n = 0; n < ping->receivers; n++) {
        struct pair_span record[2];
        const int m = (int)(ping->rx - a->rx) + n - p * a->receivers;
        const int parts = record_spans(a, p, m, line, ping->within, record);
        one.rx = ping->rx + n;
        one.rows = (const char *)ping->rows + (size_t)n * row_bytes;
        for (int i = 0; i < parts; i++) {
            one.within = record[i];
            sum_span(lines, box, &(struct bp_pings){1, &one}, line, record[i], to->re, to->im);
        }
    }
}

/* Neighbouring pings that wait to be summed together; p is the first. */
struct waiting {
    int p, count;
    struct bp_ping ping[BP_RECORDS];
};

static struct pair_span span_of_both(struct pair_span a, struct pair_span b)
{
    return (struct pair_span){a.begin < b.begin ? a.begin : b.begin, a.end > b.end ? a.end : b.end};
}

static void waiting_add(const struct bp_lines *lines, const struct line_sums *to, struct waiting *waiting)
{
    const int count = waiting->count;
    struct ping_box box = lines->boxes[waiting->p];
    struct pair_span all = waiting->ping[0].within;
    for (int n = 1; n < count; n++) {
        box = ping_box_join(&box, &lines->boxes[waiting->p + n]);
        all = span_of_both(all, waiting->ping[n].within);
    }
    waiting->count = 0;
    if (count > 1 && inside_record(lines, &box, waiting->ping[0].t0, to->line, all)) {
        sum_span(lines, &box, &(struct bp_pings){count, waiting->ping}, to->line, all, to->re, to->im);
        return;
    }
    for (int n = 0; n < count; n++)
        add_alone(lines, to, waiting->p + n, &waiting->ping[n]);
}

int bp_pings_joined(const struct acquisition *acquisition)
{
    return acquisition->receivers < BP_RECORDS ? BP_RECORDS / acquisition->receivers : 1;
}

/* Can a ping's records be summed with those that wait? They share blocks of pixels, which pays where most pixels belong
   to all pings; without interpolated delays there are no blocks. Only pings of the same fixed group join, so that bits
   do not depend on where a batch begins. */
static bool joins(const struct bp_lines *lines, const struct waiting *waiting, int p, const struct bp_ping *ping)
{
    const struct bp_ping *first = &waiting->ping[0];
    const struct pair_span all = span_of_both(first->within, ping->within);
    const int pixels = ping->within.end - ping->within.begin, firsts = first->within.end - first->within.begin;
    const int joined = bp_pings_joined(lines->acquisition);
    return p == waiting->p + waiting->count && p / joined == waiting->p / joined && ping->t0 == first->t0
           && lines->boxes[p].reach > 0 && 2 * (all.end - all.begin) <= 3 * (pixels < firsts ? pixels : firsts);
}

void bp_lines_add(const struct bp_lines *lines, const struct pixel_line *line, size_t first, int count, void *re,
                  void *im)
{
    const struct acquisition *a = lines->acquisition;
    const struct line_sums to = {line, re, im};
    size_t row_bytes = lines->layout.record * real_size(lines->bp->problem.precision), end = first + (size_t)count;
    struct waiting waiting = {.count = 0};
    for (size_t index = first; index < end;) {
        int p = (int)(index / (size_t)a->receivers), m = (int)(index % (size_t)a->receivers);
        struct bp_ping ping = {.tx = a->tx[p],
                               .velocity = a->velocity[p],
                               .t0 = a->t0[p],
                               .receivers = a->receivers - m,
                               .rx = a->rx + index,
                               .rows = (const char *)lines->rows + (index - first) * row_bytes,
                               .layout = lines->layout};
        if (end - index < (size_t)ping.receivers)
            ping.receivers = (int)(end - index);
        struct pair_span aperture[2];
        const int spans = pair_spans(a, p, lines->normal[p], line, aperture);
        for (int s = 0; s < spans; s++) {
            ping.within = aperture[s];
            if (waiting.count > 0 && !(spans == 1 && joins(lines, &waiting, p, &ping)))
                waiting_add(lines, &to, &waiting);
            if (waiting.count == 0)
                waiting.p = p;
            waiting.ping[waiting.count++] = ping;
        }
        index += (size_t)ping.receivers;
    }
    if (waiting.count > 0)
        waiting_add(lines, &to, &waiting);
}

void bp_lines_store(enum precision precision, const struct grid *grid, bool along_x, const void *sums,
                    const struct pixel_window *window, void *pixels)
{
    size_t nx = (size_t)grid->x_count, nr = (size_t)grid->r_count, count = nx * nr;
    size_t first_row = (size_t)window->row, first_column = (size_t)window->column, columns = (size_t)window->columns;
    size_t row = along_x ? nx : 1, column = along_x ? 1 : nr;
    bool is_double = precision == PRECISION_DOUBLE;
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < (size_t)window->rows; i++)
        for (size_t j = 0; j < columns; j++) {
            size_t from = (first_row + i) * row + (first_column + j) * column, to = 2 * (i * columns + j);
            if (is_double) {
                ((double *)pixels)[to] = ((const double *)sums)[from];
                ((double *)pixels)[to + 1] = ((const double *)sums)[count + from];
            } else {
                ((float *)pixels)[to] = ((const float *)sums)[from];
                ((float *)pixels)[to + 1] = ((const float *)sums)[count + from];
            }
        }
}

/* A kernel's branch m of a trace, complex [length]; 0 beyond the record's ends. */
static void filter(const struct bp *bp, const char *trace, size_t m, char *branch)
{
    const struct bp_kernel *kernel = &bp->kernel;
    const size_t length = bp_branch_length(bp), guard = (size_t)bp->table.guard, taps = (size_t)kernel->taps;
    const size_t bytes = 2 * real_size(bp->problem.precision);
    const char *from = trace + (size_t)(bp->shape.guard + kernel->first) * bytes;
    memset(branch, 0, guard * bytes);
    bp->planes->convolve(from, kernel->coefficients + m * taps, kernel->taps, length - 2 * guard, false,
                         branch + guard * bytes);
    memset(branch + (length - guard) * bytes, 0, guard * bytes);
}

void bp_record_fill(const struct bp *bp, const struct bp_layout *layout, const struct echoes *echoes, size_t index,
                    void *scratch, void *row)
{
    const size_t branches = (size_t)bp->table.branches, length = bp_branch_length(bp), blocks = (size_t)layout->blocks;
    const size_t block = layout->apart, size = real_size(bp->problem.precision);
    const bool filtered = bp->table.branches > bp->shape.branches;
    char *trace = scratch, *one = trace + 2 * (size_t)bp->shape.length * size, *to = row;
    traces_of(bp->problem.precision)->fill(bp->traces, omp_get_thread_num(), bp_record(bp, echoes, index), trace);
    for (size_t m = 0; m < branches; m++) {
        const char *branch = filtered ? one : trace + m * 2 * length * size;
        char *parts = to + m * 2 * block * size;
        if (filtered)
            filter(bp, trace, m, one);
        if (blocks > 1)
            bp->planes->part_blocks(branch, length, blocks, block, 2 * branches * block, parts);
        else
            bp->planes->part(branch, length, block, parts);
    }
}
