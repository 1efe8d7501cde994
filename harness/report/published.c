/* The papers' tables, figures and printed numbers (published.h). */
#include "report/published.h"
#include "files/paths.h"

#include <math.h>
#include <string.h>

const struct paper_table paper_tables[] = {
    {"bp22_t1", "BP22 Table 1, Eq. (11): FLOPs at N_a = 2880, N_r = 4800",
     "an FFT of N counts 5 N log2 N; counted: what our plans do, which read two taps where BP22 upsamples first", NULL},
    {"bp22_t3", "BP22 Table 3: PSLR and ISLR of six targets",
     "the text prints no target positions: six targets on range bins, 40 to 225 m; sound speed 1500 m/s and rect beam "
     "cut at sin theta = .405 lambda/D_tx, neither of them printed, f_s = 2B, pings every 0.8 m on the pixels' raster; "
     "the scatter among the printed targets does not reproduce",
     NULL},
    {"bp22_t4", "BP22 Table 4: times as ratios to nearest neighbour",
     "simulated echoes of the real data's size (2880 x 4800 pixels from 2880 records); sinc of 8 taps; machine and "
     "language are others",
     "nearest"},
    {"bp22_eq20", "BP22 Eq. (20): smallest upsampling rate",
     "grid factor beta + 1, bin c/(2 f_s) with f_s = 2B, strict inequality", NULL},
    {"bp22_f8", "BP22 Fig. 8: images of six targets by four methods", "targets as in bp22_t3", NULL},
    {"bp22_f9", "BP22 Fig. 9: azimuth slices of the six targets", "targets as in bp22_t3", NULL},
    {"bp22_f10", "BP22 Fig. 10: the slices near their peaks", "targets as in bp22_t3", NULL},
    {"zp15_f3", "ZP15 Fig. 3: images of one target by three methods",
     "no numbers are printed; 8 taps, zero padding by 8 (from the lambda/8 rule), f_s = 2B, PRI 0.2 s", NULL},
    {"zp15_f4", "ZP15 Fig. 4: azimuth slices of one target by three methods",
     "no numbers are printed; 8 taps, zero padding by 8 (from the lambda/8 rule), f_s = 2B, PRI 0.2 s", NULL},
    {"zp15_f4_close", "ZP15 Fig. 4b: the slice near its peak", "as zp15_f4", NULL},
    {"lbf21_t2", "LBF21 Table II: width of the sub-blocks, target at the edge of one",
     "rect beam cut at sin theta = .405 lambda/D_tx, which no paper prints: it brings the `pixel` metrics near the "
     "printed ones; sound speed 1500 m/s, not printed either; ping phase unknown; BP is the exact image; corrected: "
     "theta at F",
     NULL},
    {"lbf21_t3", "LBF21 Table III: six targets, short integration time",
     "the text prints no target positions: azimuths of Fig. 13, ranges 50, 90, 135, 180, 225, 270 m; imaged in two "
     "parts, near (50 to 90 m) and far (135 to 270 m), with 16 blocks each, 2.5 and 8.4 m wide, where section V-A "
     "prefers 10 m; beam and sound speed as in Table II; BP is the exact image; corrected: theta at F, blocks in 1/r "
     "that blend",
     NULL},
    {"lbf21_t4", "LBF21 Table IV: four targets, long integration time",
     "the text prints no target positions: ranges 50, 80, 225, 260 m; near and far part with 16 blocks each, 2.8 m "
     "wide; pixels of 0.01 m, half those of the short array; Wu's method is a working definition",
     NULL},
    {"lbf21_t5", "LBF21 Table V: times as ratios to LBF with 16 blocks",
     "simulated echoes of the real data's size (48 receivers, 80 pings, 4096 samples into 3200 x 4096 pixels); PCA and "
     "Wu with 16 blocks share LBF's engine, so that their ratios mean nothing; Wu's method is a working definition; "
     "plain range migration calls libm for each phase, plain back projection is vectorised; machine and language are "
     "others",
     "LBF, 16 blocks"},
    {"lbf21_flops", "LBF21 Eqs. (20) to (23): FLOPs of range migration and back projection",
     "N_interp = 8; N_a is 3200 in the paper and 48 x 80 = 3840 in our plans; Eq. (20) counts one sub-block", NULL},
    {"lbf21_f2", "LBF21 Fig. 2: phase error of LBF, first receiver, short", "d_1 = 0, |f| up to v/D_tx", NULL},
    {"lbf21_f3", "LBF21 Fig. 3: phase error of LBF, last receiver, short", "d_1 = 0, |f| up to v/D_tx", NULL},
    {"lbf21_f4", "LBF21 Fig. 4: phase error of PCA, first receiver, short", "d_1 = 0, |f| up to v/D_tx", NULL},
    {"lbf21_f5", "LBF21 Fig. 5: phase error of PCA, last receiver, short", "d_1 = 0, |f| up to v/D_tx", NULL},
    {"lbf21_f6", "LBF21 Fig. 6: phase error of LBF, first receiver, long", "d_1 = 0, |f| up to v/D_tx", NULL},
    {"lbf21_f7", "LBF21 Fig. 7: phase error of PCA, first receiver, long", "d_1 = 0, |f| up to v/D_tx", NULL},
    {"lbf21_f8", "LBF21 Fig. 8: phase error of LBF, last receiver, long", "d_1 = 0, |f| up to v/D_tx", NULL},
    {"lbf21_f9", "LBF21 Fig. 9: phase error of PCA, last receiver, long", "d_1 = 0, |f| up to v/D_tx", NULL},
    {"lbf21_f11", "LBF21 Fig. 11: azimuth slices by the width of the sub-blocks", "as lbf21_t2", NULL},
    {"lbf21_f12", "LBF21 Fig. 12: those slices near their peaks", "as lbf21_t2", NULL},
    {"lbf21_f13", "LBF21 Fig. 13: places of the six targets",
     "the text prints no target positions but for some azimuths; as lbf21_t3", NULL},
    {"lbf21_f14", "LBF21 Fig. 14: images of six targets", "as lbf21_t3", NULL},
    {"lbf21_f15", "LBF21 Fig. 15: azimuth slices of the six targets", "as lbf21_t3", NULL},
    {"lbf21_f16", "LBF21 Fig. 16: places of the four targets", "the text prints no target positions; as lbf21_t4",
     NULL},
    {"lbf21_f17", "LBF21 Fig. 17: images of four targets, long integration time", "as lbf21_t4", NULL},
    {"lbf21_f18", "LBF21 Fig. 18: azimuth slices of the four targets", "as lbf21_t4", NULL},
    {"pf05_t1", "PF05 Table 1: azimuth resolution",
     "the printed 5 kHz is half the bandwidth (0.075 m needs 10 kHz); rect beam cut at lambda/(2D) off its axis; pings "
     "0.04 m apart; places of nine scatterers are ours, four of them in the target area",
     NULL},
    {"pf05_f5", "PF05 Fig. 5: images behind the filter by 4 and 2 sub-apertures, and without outside targets",
     "as pf05_t1; no numbers are printed", NULL},
    {"pf05_f5_echoes", "PF05 Figs 5A to 5C: echoes as recorded, range compressed, filtered", "as pf05_t1", NULL},
    {"sq18_f3a", "SQ18 Fig. 3(a): image of five targets, squint 20 degrees",
     "places of the targets are ours: beam centres pass them from (0, 45), (+-3, 41), (+-3, 49) m; rect beam cut at "
     "lambda/(2D) off its axis; offsets are from the places turned by 20 degrees; no numbers are printed",
     NULL},
    {"sq18_f3b", "SQ18 Fig. 3(b): near the targets, at 20 degrees and at broadside", "as sq18_f3a", NULL},
    {"claims", "the papers' claims in words", "", NULL},
    {.id = NULL},
};

static const char *const columns[] = {"table", "target", "method", "quantity", "unit", "paper", "source", "note", NULL};

enum status published_read(struct csv *csv)
{
    enum status status = csv_read(data_path(DATA_PUBLISHED), CSV_TAIL_KEEP, csv);
    return status == STATUS_OK ? csv_columns(csv, columns, NULL) : status;
}

static bool cell_is(const struct csv *csv, int row, enum published_column column, const char *text, size_t length)
{
    const char *cell = csv_cell(csv, row, column);
    return strlen(cell) == length && strncmp(cell, text, length) == 0;
}

int published_values(const struct csv *csv, const char *table, const char *targets, const char *method,
                     const char *quantity, double *values, int room)
{
    const char *dots = strstr(targets, ".."), *last = dots ? dots + 2 : targets;
    size_t first_length = dots ? (size_t)(dots - targets) : strlen(targets);
    int from = csv->row_count, to = -1, count = 0;
    for (int row = csv->row_count - 1; row >= 0; row--)
        if (cell_is(csv, row, PUBLISHED_TABLE, table, strlen(table))) {
            from = cell_is(csv, row, PUBLISHED_TARGET, targets, first_length) ? row : from;
            to = to < 0 && cell_is(csv, row, PUBLISHED_TARGET, last, strlen(last)) ? row : to;
        }
    for (int row = from; row <= to; row++) {
        double number = NAN;
        bool wanted = cell_is(csv, row, PUBLISHED_TABLE, table, strlen(table))
                      && cell_is(csv, row, PUBLISHED_METHOD, method, strlen(method))
                      && cell_is(csv, row, PUBLISHED_QUANTITY, quantity, strlen(quantity))
                      && (dots || cell_is(csv, row, PUBLISHED_TARGET, targets, strlen(targets)));
        if (wanted && csv_number(csv_cell(csv, row, PUBLISHED_PAPER), &number) && isfinite(number) && count < room)
            values[count++] = number;
    }
    return count;
}

const char *const claim_verdict_names[CLAIM_VERDICTS] = {[CLAIM_HOLDS] = "holds",
                                                         [CLAIM_ASSUMED] = "holds under stated assumption",
                                                         [CLAIM_IDENTITY] = "identity",
                                                         [CLAIM_FAILS] = "does not hold",
                                                         [CLAIM_UNDECIDED] = "cannot be decided"};
