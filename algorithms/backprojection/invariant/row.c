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

void BP_ROW(const struct bp_row *rows, int count)
{
    const struct bp_slab *slab = rows->slab;
    struct row_tables tables[BP_ROWS_MOST];
    struct chunk chunks[BP_ROWS_MOST];
    for (int k = 0; k < count; k++)
        tables[k] = TABLES_BEGIN(&rows[k]);
    for (int m = 0; m < rows->receivers; m++) {
        const size_t receiver = (size_t)m * slab->receiver_stride + (size_t)slab->lead;
        for (int k = 0; k < count; k++) {
            const struct bp_row *row = &rows[k];
            chunks[k] = (struct chunk){.medium = row->medium,
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
            DELAYS_RECEIVER(row, &tables[k], row->offsets[m]);
        }
        for (int begin = 0, end; begin < tables->group_count; begin = end) {
            end = tables->group_count;
            for (int k = 0; k < count; k++) {
                const int own = chunk_end(rows[k].scratch, begin, tables->group_count);
                end = own < end ? own : end;
            }
            for (int k = 0; k < count; k++) {
                chunks[k].begin = begin;
                chunks[k].end = end;
                TABLES_MAKE(&tables[k], rows->offsets[m], &chunks[k]);
            }
            SUMS_ADD(chunks, count);
        }
    }
}
