/* One image row of the translation-invariant engine (row.h): receivers, and chunks of groups whose tables fit the
   scratch. This file is compiled once for each precision and instruction set (BP_ISA names it). */
#include "backprojection/invariant/chunk.h"

#define BP_ROW REAL_ISA_NAME(bp_row)

/* The end of the longest chunk from group `begin` on: groups of as many residues, as many as scratch has room for. */
static int chunk_end(const struct bp_row_scratch *scratch, int begin, int group_count)
{
    const struct bp_row_group *groups = scratch->groups;
    int end = begin + 1;
    while (end < group_count && groups[end].residues == groups[begin].residues
           && groups[end + 1].first - groups[begin].first <= scratch->capacity)
        end++;
    return end;
}

void BP_ROW(const struct bp_row *row)
{
    const struct bp_slab *slab = row->slab;
    const struct row_tables tables = TABLES_BEGIN(row);
    for (int m = 0; m < row->receivers; m++) {
        const size_t receiver = (size_t)m * slab->receiver_stride + (size_t)slab->lead;
        struct chunk chunk = {.medium = row->medium,
                              .raster = row->raster,
                              .table = row->table,
                              .slab = slab,
                              .scratch = row->scratch,
                              .sparse = slab->step_count < row->table->upsample,
                              .sr = (const real *)slab->re + receiver,
                              .si = (const real *)slab->im + receiver,
                              .re = row->re,
                              .im = row->im,
                              .stride = (size_t)row->stride};
        DELAYS_RECEIVER(row, &tables, row->offsets[m]);
        for (; chunk.begin < tables.group_count; chunk.begin = chunk.end) {
            chunk.end = chunk_end(row->scratch, chunk.begin, tables.group_count);
            TABLES_MAKE(&tables, row->offsets[m], &chunk);
            SUMS_ADD(&chunk);
        }
    }
}
