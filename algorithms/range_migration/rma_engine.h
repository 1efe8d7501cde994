/* A range migration's plan. rma_layout.c lays it out (track, swaths and their transforms), rma_records.c the records,
   rma_blocks.c the blocks of the conversion, rma_phase.c has the corrections' phases, rma_transform.c transforms along
   range and azimuth (for each precision), convert.c and focus.c work on one azimuth wavenumber (for each precision and
   instruction set), rma.c puts them in order. Pointers without a type hold values of the plan's precision.

   THE STAGES, with the shape of the array before and after each (rma.h has the equations). All values are complex, the
   last dimension is contiguous. M receivers; P = period, the pings and zeros after them; Q = M P wavenumbers; `row`
   bins contain the band of a swath and fill whole vectors; N = needed, the blocks that a swath's rows use.

   compress      [pings][M][samples] -> [M][pings][row] for each swath, in swath->data
                 each record through the matched filter, by a transform of record_length and one back of
                 inverse_length, to the rate that the band needs (unless the echoes come compressed); its stretch for
                 the swath, ends tapered, through an FFT of `length`; the band is kept
   spread        [M][pings][row] -> [M][P][row], in place
                 an FFT over the pings for each receiver and bin; from here on re and im take turns by vectors

   From here to focus, a thread works on RMA_TILE wavenumbers in turn, in the order of rma_wavenumber. Wavenumber q
   reads [M][row]: entry q - Q/2 modulo P of the P above, or Q/2 - q where the track runs towards -x. M of them share
   an entry.

   bulk          [M][row] -> [M][RMA_SPAN], for RMA_SPAN bins at a time
                 each receiver's correction at the range of the reference block, whose own sum is then complete
   differential  [M][RMA_SPAN] -> [N][row], or [N][M][row] with sum=after; takes turns with bulk until all bins are done
                 the rest of the correction for each other block, summed over the receivers
                 where corrections differ by as much from each block to the next but for what all receivers share
                 (LBF's in 1/r), bulk and differential are one: receivers are turned on from block to block and added
                 up, and each block is turned by the rest at last
   reconstruct   [N][row] -> [length] samples in range -> [RMA_GUARD + stolt_length + RMA_GUARD] bins
                 an IFFT of `length` for each block; each sample is its block's, or blends the nearest four; samples
                 count from `centre`; zeros up to stolt_length; an FFT, its bins in rising frequency
   stolt         [stolt_length] bins of F -> bins of K, RMA_SPAN at a time, for each patch
   focus         bins of K -> [length of the patch] -> [r_count] rows of the patch
                 phase at the first row and column, and weight; bins beyond the transform fold onto it; an IFFT. Rows of
                 all patches of RMA_TILE wavenumbers, [RMA_TILE][rows], go to `focused`, [rows][columns]. `columns` of
                 the swath is Q rounded up to RMA_TILE

   inverse       [r_count][columns] -> [r_count][x_count], the pixels of each patch
                 an IFFT over the wavenumbers of a row, onto the grid's columns: one transform, or a convolution with a
                 chirp; times sqrt(r)

   Delay compensation (delay_compensation.h) has other stages up to there, and rows of samples in place of bins:

   compress      [pings][M][samples] -> [M][pings][row]
                 each record through the matched filter, between zeros
   map           mapped onto the swath's samples by taps
   spread        as above, for each sample
   receivers     [M][row] -> M x [row], for all wavenumbers that read the same spectra
                 turned by each receiver's offset, added up with the weights of each term, times the term's coefficient;
                 in two steps where receivers are even (rma_fold)
   stolt         begins with the zeros and the FFT of reconstruct

   Chirp transforms (rma_chirp) have no stage `stolt`:

   focus         [stolt_length] bins of F -> [r_count] rows of each patch, by `piece` rows
                 K is a straight line over the bins, and x/r of what it leaves: of the line the rows are a chirp z
                 transform of `length`; exp(j x) is a sum of terms of powers, the bins' times the rows', and each term
                 is one such transform. Each wavenumber has as many terms as it needs. Few rows are sums instead

   Shortcuts: a single receiver at the transmitter needs no bulk and no differential. */
#ifndef SASBENCH_RANGE_MIGRATION_RMA_ENGINE_H
#define SASBENCH_RANGE_MIGRATION_RMA_ENGINE_H

#include <complex.h>
#include <math.h>
#include <stdbool.h>

#include "common/isa.h"
#include "common/fit.h"
#include "common/memory.h"
#include "range_migration/delay_compensation.h"
#include "range_migration/rma.h"
#include "range_migration/stretch.h"

enum {
    RMA_ALIGNMENT = 64,   /* bytes: a vector, and a line of the cache */
    RMA_SPAN = 256,       /* bins that go through all corrections together, in the cache */
    RMA_GROUP = 24,       /* receivers of one recurrence: float loses some 1e-6 over it */
    RMA_BLOCKS = 8,       /* that share their receivers' phases, at most */
    RMA_TILE = 8,         /* neighbouring wavenumbers whose rows are stored together */
    RMA_CLASSES = 8,      /* of wavenumbers whose receivers are added up together */
    RMA_FOLD = 16,        /* sums of receivers that a class shares, at most */
    RMA_NODES = 4,        /* blocks that blend at one range: a cubic */
    RMA_GUARD = 16,       /* bins repeated beyond a spectrum's ends: the longest kernel */
    RMA_INTERVALS = 1024, /* of the Stolt kernel's table, linear inside each */
    RMA_RATES = 16,       /* parts of the echoes' sampling rate, of which compressed records need some */
    RMA_RUN = 16,         /* samples of a record that share the taps of their delay */
    CHIRP_ROWS = 16,      /* that are turned one by one from an exact phase */
    CHIRP_TERMS = 12      /* of a chirp transform, at most: more cost float its digits */
};

/* Scratch of a thread; all but the first two hold values of the plan's precision. The largest swath counts. */
enum rma_buffer {
    RMA_RAMPS,       /* struct rma_ramp [1 + needed][groups]: bulk, then each block's */
    RMA_ABSCISSAS,   /* double [row]: y of each bin */
    RMA_CONVERTED,   /* [receivers][RMA_SPAN]: some bins after the bulk correction */
    RMA_SUMS,        /* [needed][1 or receivers][row]: spectra of each block */
    RMA_WAVE,        /* complex [longest transform of a swath] */
    RMA_TRANSFORMED, /* complex [longest transform]: the transform of RMA_WAVE */
    RMA_CUT,         /* complex [stolt_length]: the blocks put together, from sample `centre` on; delay
                        compensation's [rma_turns][row]: samples */
    RMA_PLACES,      /* real [length]: position of those samples in blocks */
    RMA_SPECTRUM,    /* complex [RMA_GUARD + stolt_length + RMA_GUARD] in rising frequency */
    RMA_STORED,      /* complex [RMA_TILE][rows + RMA_TILE] */
    RMA_RECORD,      /* complex [record_length] */
    RMA_PADDED,      /* complex [inverse_length, or held, + 2 map guards]: delay compensation's records */
    RMA_TURNS,       /* real [RMA_CLASSES][receivers][2]: phasors of the receivers' offsets */
    RMA_EDGES,       /* complex [receivers][terms][row/LANES + 1]: U at the edges of vectors */
    RMA_MEMBERS,     /* struct rma_member [receivers] */
    RMA_CHIRP,       /* complex [longest chirp transform, stolt_length]: the chirp, or the bins' step from row to row */
    RMA_KERNEL,      /* complex [longest chirp transform]: its conjugate's transform */
    RMA_LINE,        /* complex [stolt_length]: a term's bins */
    RMA_SHARES,      /* real [stolt_length], e_n of struct chirp; [longest chirp transform], a power of y_i */
    RMA_BUFFERS
};

/* Phases of a group of receivers in cycles: receiver i of it has  first + i step + i(i-1)/2 curve. Each is a
   polynomial in y = (F - middle)/half, lowest power first. */
struct rma_ramp {
    int begin, count; /* receivers */
    double first[FIT_DEGREE + 1], step[FIT_DEGREE + 1], curve[FIT_DEGREE + 1];
};

/* Delay compensation: a wavenumber that shares the sums of its class, `number` (modulo fold) strides beyond the
   class's first. */
struct rma_member {
    int number;
    const void *edges; /* complex [terms][row/LANES + 1]: U, with the phase of the first receiver */
    void *cut;         /* complex [row] */
};

/* One wavenumber: the bins of its band that exist, and the delay of ranges. */
struct rma_line {
    double nu;           /* cycles/m */
    double lowest;       /* Hz: the least F that is used; below it lies the evanescent part */
    int begin;           /* first bin of the band from there on; `band` if there is none */
    double middle, half; /* Hz: the polynomials' interval */
    double slowness;     /* s/m: delay over range, amid the bins: spectrum_slowness */
};

/* Oversampling of a swath by the transform that the Stolt interpolation reads (chirp transforms: none). */
#define RMA_OVERSAMPLING 1.5

struct rma_patch {
    struct grid grid;
    int index;   /* among the problem's patches */
    int length;  /* of the range IFFT onto the grid's rows: K = j 2 pi/(length step); of the chirp transform */
    int piece;   /* rows of a chirp transform */
    bool sums;   /* rows of a piece one by one, without transforms */
    double step; /* m: the grid's r_step; a range bin for a single row */
    size_t row;  /* of its first row among all rows of the swath */
    /* azimuth: columns that divide the track's period evenly are bins of one transform (wavenumbers fold onto it);
       any other ones are a convolution with a chirp */
    bool folds;
    int columns;          /* length of the transform */
    double shift, square; /* cycles: wavenumber q is turned by (q - Q/2) shift + q^2 square */
    int *bins;            /* [columns of the swath] of the transform, by turn; `columns`: of none */
    void *kernel, *after; /* complex [columns] (chirp only), [x_count]: factors behind the focused rows */
    void *chirp_plan;     /* forward, as long as focus_plan, of chirp transforms */
    void *focus_plan, *azimuth_forward, *azimuth_inverse; /* forward: chirp only */
};

/* Delay compensation of a swath: the record's samples for each of its own, by receiver and run of RMA_RUN. */
struct rma_map {
    int runs;
    int *first; /* [receivers][runs]: the first tap's, for the run's first sample; INT_MIN: outside the record */
    void *weights, *slopes; /* real [receivers][runs][taps]: at the run's middle, and over one sample */
    void *phases;           /* complex [receivers][runs RMA_RUN]: carrier, and the cut's taper */
    void *edges;            /* complex [angles][terms][row/LANES + 1]: U at the edges of vectors */
};

/* Patches whose echoes lie in one stretch of the records, migrated together and apart from all others. */
struct rma_swath {
    double nearest, farthest; /* m: its rows */
    int patch_count;
    struct rma_patch *patches; /* part of the plan's */
    size_t rows;               /* of all its patches */

    /* cut: sample i of the swath is sample `first` + i of a record (negative and beyond it: zero); of them
       [begin, end) are taken, an end inside the record fading in or out */
    int first, begin, end;
    double t_first; /* s: time of sample 0 after emission */
    int centre;     /* the middle sample */

    /* azimuth: wavenumber q is (q - wavenumbers/2)/(period |spacing|) */
    int period;      /* pings and zeros after them */
    int wavenumbers; /* receivers x period: the full rate */
    size_t columns;  /* wavenumbers rounded up to RMA_TILE */

    /* range: bin k is at (band_first + k) fs/length from fc */
    int length;                /* of the range transforms */
    int band_first, band, row; /* bins, and bins of a stored row (a multiple of the vector) */
    int stolt_length;          /* of the transform that is interpolated: the samples fill 2/3 of it, or all */
    int held;                  /* delay compensation: samples of a row, from `begin` on */

    int needed, *blocks; /* [needed] the blocks that are computed; part of the plan's */
    int reference;       /* index into `blocks`: the bulk correction is this block's */
    bool even;           /* three and more, whose corrections differ by as much from each to the next (bulk) */

    void *data; /* [receivers][period][row]: spectra, vectors of re and im in turn (rma_row) */
    /* Reals from a receiver's to the next one's: an odd number of vectors, or receivers a power of two apart would
       share sets of the cache. */
    size_t apart;
    struct rma_map map;
    void *apodization; /* real [stolt_length]: 1/transform of the Stolt kernel, 1/length included */
    void *range_forward, *range_inverse, *stolt_forward, *azimuth_forward;
};

/* Delay compensation of a plan. */
struct rma_delay {
    struct delay_terms terms;
    struct delay_taps taps;
    int guard;   /* zeros beside a record */
    void *basis; /* real [terms][receivers]: V */
    /* The phasors of receivers m and m + fold differ, from a wavenumber to that `stride` times `period` beyond it, by
       the same factor: the sums over m modulo `fold` serve a whole class of such wavenumbers. fold = 1: none. */
    int fold, stride;
    double turn, step; /* cycles a stride: of the first receiver, and from a receiver to the next (1/fold) */
};

struct rma {
    struct stretch stretch;
    struct problem problem; /* the stretch's */
    struct rma_method method;
    struct rma_options options;
    struct spectrum_setting setting;
    /* The monostatic phase r K of focusing: `setting`, exact; for rma_lbf:variant=printed without the speed, LBF21
       Eqs. (15), (16), and rows are turned by Eq. (17) afterwards. */
    struct spectrum_setting monostatic;
    bool turns_rows;
    struct work work;

    /* track: ping k is emitted at x_first + k spacing, receiver m is offset[m] ahead */
    double x_first, spacing, t0;
    int receivers, pings;
    double *offset;           /* [receivers] m */
    int extremes[2];          /* the receivers of least and greatest offset */
    double nearest, farthest; /* m: of all wanted rows */
    struct rma_bounds bounds;
    int groups;    /* of receivers */
    bool recurs;   /* by recurrence: receivers are evenly spaced, and phases=libm is not set */
    bool converts; /* false: one receiver, at the transmitter */

    /* pulse compression, to rate_up/rate_down of the echoes' sampling rate: `fs`, `samples` and all samples count at
       that rate, but for `read` */
    double fs;   /* Hz */
    int samples; /* of a record, `early` of them before the echoes' first */
    int early, rate_up, rate_down;
    int from, held;      /* the compressed samples that swaths use: [from, from + held) of a record */
    int read_from, read; /* the echoes' samples that these take: [read_from, read_from + read) */
    int ahead;           /* samples of [from, from + held) before the echo's sample read_from */
    int record_length;   /* of its transform; 0: the echoes come compressed */
    int inverse_length;  /* of the transform back: record_length rate_up/rate_down */
    double half_band;    /* Hz: half of the compressed pulse's band */
    double loss;         /* energy of the compressed pulse outside it, relative */
    int taper;           /* samples over which a cut tapers, and as many between the taper and the rows */
    void *filter;        /* complex [inverse_length]: conj(replica)/energy */
    void *tapers;        /* real [taper], rising */
    void *record_forward, *record_inverse;

    /* blocks: centre n of block_count at `block_from + n block_width` in r or 1/r */
    int block_count;
    double block_from, block_width;
    int *block_list; /* the swaths' blocks */

    struct rma_delay *delay; /* NULL: by blocks */

    /* rad: the largest |x| for which `terms` terms of exp(j x) err by the setting `limit` */
    double chirp_phases[CHIRP_TERMS + 1];

    int taps;     /* of the Stolt interpolation */
    double shape; /* the Kaiser kernel's parameter */
    void *kernel; /* real [RMA_INTERVALS + 2][taps] */

    int patch_count, swath_count;
    struct rma_patch *patches; /* [patch_count] by range */
    struct rma_swath *swaths;  /* [swath_count] */

    struct fit_nodes fit; /* of the phases' polynomials in frequency */

    int threads;
    size_t scratch_at[RMA_BUFFERS]; /* bytes: where each buffer of a thread begins */
    size_t scratch_bytes;           /* of a thread */
    void *scratch;                  /* [threads] */
    void *focused;                  /* complex [rows][columns] of the swath at work, wavenumbers in their turns */
    struct store store;
};

/* ---- rma_layout.c ---- */

/* Fills everything but the tables of delay compensation and the pointers that rma_transform's plan fills. The
   requirements of rma_requirements_check must be met. */
enum status rma_layout(struct rma *rma);
/* The tables of delay compensation. */
enum status rma_delay_tables(struct rma *rma);
static inline double rma_last_row(const struct grid *grid)
{
    return grid->r_first + (grid->r_count - 1) * grid->r_step;
}

/* ---- rma_records.c ---- */

/* The bins of the compressed pulse, or, of echoes that come compressed, of twice the band; the rate of the records.
   Errors: STATUS_FAILED without memory. */
enum status rma_band_lay(struct rma *rma);
/* The samples of a record that the swaths use. Only these are compressed: a stretch's correlation is exact, but for
   what lies beyond the band of a lower rate. */
enum status rma_records_lay(struct rma *rma);
/* Samples, at the echoes' sampling rate, over which a cut of the records tapers. */
int rma_taper(const struct acquisition *acquisition);
/* The share of their sampling rate at which raw echoes are compressed, in RMA_RATES parts: for the compressed pulse's
   band, |f| <= half_hz, and the taps of the receivers' delays. */
double rma_share(const struct acquisition *acquisition, const struct rma_method *method, double half_hz);

/* FLOPs of the compression of all records. */
double rma_compression_flops(const struct rma *rma);

/* ---- rma.c ---- */
/* A plan of counted work, without memory for echoes or transforms; rma_destroy releases it. Errors: as rma_layout, and
   STATUS_UNSUPPORTED where work or memory would be too large; *rma is then NULL. */
enum status rma_count(const struct problem *problem, const struct rma_method *method, const struct rma_options *options,
                      struct rma **rma);

/* ---- rma_blocks.c ---- */

/* The blocks: as many as in the options, or as keep the error at their ends below the limit. */
enum status rma_blocks_lay(struct rma *rma);
/* The blocks of a swath's rows, into `list`. */
void rma_blocks_choose(const struct rma *rma, struct rma_swath *swath, int *list);

/* Of `left` blocks of a swath that is `even`, three and more, those that share their receivers' phases. */
static inline int rma_blocks_together(int left)
{
    const int turns = (left + RMA_BLOCKS - 1) / RMA_BLOCKS;
    return (left + turns - 1) / turns;
}

/* Blocks that blend at one range. */
static inline int rma_nodes_blended(const struct rma *rma)
{
    return rma->block_count < RMA_NODES ? rma->block_count : RMA_NODES;
}

/* The order in which wavenumbers are worked on: those that read the same spectra, q mod period, in a row. */
static inline int rma_wavenumber(const struct rma *rma, const struct rma_swath *swath, int turn)
{
    return turn / rma->receivers + turn % rma->receivers * swath->period;
}

/* The phase of wavenumber q that takes its rows to a patch's columns, in cycles. */
static inline double rma_shift(const struct rma_swath *swath, const struct rma_patch *patch, int q)
{
    const double cycles = (q - swath->wavenumbers / 2) * patch->shift + patch->square * q * q;
    return cycles - floor(cycles + 0.5);
}

/* Where a receiver's row of ping or azimuth FFT's bin k begins in `data`, in reals. */
static inline size_t rma_row(const struct rma_swath *swath, int receiver, int k)
{
    return (size_t)receiver * swath->apart + 2 * (size_t)k * (size_t)swath->row;
}

/* The turns that a thread takes at once: with delay compensation, those that read the same spectra. */
static inline int rma_turns(const struct rma *rma)
{
    return rma->delay ? (4 * RMA_TILE + rma->receivers - 1) / rma->receivers * rma->receivers : RMA_TILE;
}

/* ---- rma_phase.c ---- */

double rma_frequency(const struct rma *rma, const struct rma_swath *swath, int bin); /* F, Hz */
/* Cycles a metre of range by which rows are turned, LBF21 Eq. (17) with theta at fc; 0 where K is exact. */
double rma_offset(const struct rma *rma, double nu);
/* Correction of receiver m at range r, in cycles: -(phi + r K)/2 pi, less what rows are turned by. */
double rma_correction(const struct rma *rma, int receiver, double r, double frequency, double nu);
struct rma_line rma_line(const struct rma *rma, const struct rma_swath *swath, int q);
/* Fit the correction of a receiver at range r: a polynomial [FIT_DEGREE + 1] in y of struct rma_ramp. */
void rma_polynomial(const struct rma *rma, const struct rma_line *line, int receiver, double r, double *polynomial);
/* Fit the correction at `r` minus the one at `less` (0: none is subtracted) for all groups. */
void rma_ramps(const struct rma *rma, const struct rma_line *line, double r, double less, struct rma_ramp *ramps);
/* Range of a block's centre, m. */
double rma_block_range(const struct rma *rma, int block);

/* ---- chirp_plan.c ---- */

/* Focusing at one wavenumber: bins first + n at fc + (first + n) bin Hz, n < count, where
   K = start + n slope + extreme e_n, |e_n| <= 1. */
struct chirp {
    int first, count;
    double bin;
    double start, slope, extreme; /* rad/m */
    double reach;                 /* m: from a piece's first row to the one that its phases count from */
    int terms;                    /* exp(j extreme reach e_n y_i) = sum of factors[t] (e_n y_i)^t, |y_i| <= 1 */
    double complex factors[CHIRP_TERMS];
};

/* Fills rma->chirp_phases. */
void chirp_phases(struct rma *rma);
/* How a patch's rows are made, by the fewest FLOPs. */
void chirp_lay(const struct rma *rma, const struct rma_swath *swath, struct rma_patch *patch);
/* False if the wavenumber has no bins. */
bool chirp_find(const struct rma *rma, const struct rma_swath *swath, const struct rma_patch *patch,
                const struct rma_line *line, struct chirp *chirp);
/* FLOPs of a wavenumber, the mean of some. */
double chirp_flops(const struct rma *rma, const struct rma_swath *swath, const struct rma_patch *patch);

/* ---- delay_fold.c ---- */

/* The cheapest fold that the receivers' places allow. */
void rma_fold(struct rma *rma);
/* FLOPs of a sample, of all wavenumbers that read the same spectra. */
double rma_fold_flops(const struct rma *rma);

/* ---- delay_plan.c ---- */

/* The tables of swath->map. */
void rma_map_plan_float(struct rma *rma, struct rma_swath *swath);
void rma_map_plan_double(struct rma *rma, struct rma_swath *swath);

/* ---- delay_map.c ---- */

/* A swath's row, complex [runs RMA_RUN], from a compressed record with its guards. */
typedef void rma_map_function(const struct rma *rma, const struct rma_swath *swath, int receiver, const void *padded,
                              void *row);
ISA_DECLARE(rma_map_function, rma_map);

/* ---- rma_transform.c ---- */
enum rma_first_stage { RMA_COMPRESS, RMA_MAP, RMA_SPREAD, RMA_SPREADS };
struct rma_transform {
    enum status (*plan)(struct rma *rma); /* memory, tables and FFT plans */
    /* The stages up to `spread`, of all swaths; `map` is only called where the plan compensates delays. The threads'
       seconds are added. */
    void (*receive)(const struct rma *rma, rma_map_function *map, const void *samples, double seconds[RMA_SPREADS]);
    void (*inverse)(const struct rma *rma, const struct rma_swath *swath, const struct rma_patch *patch, void *pixels);
};
extern const struct rma_transform rma_transform_float, rma_transform_double;

/* ---- focus.c ---- */
enum rma_stage { RMA_RECEIVERS, RMA_BULK, RMA_DIFFERENTIAL, RMA_RECONSTRUCT, RMA_STOLT, RMA_FOCUS, RMA_STAGES };
/* The rma_turns wavenumbers from `turn` on, all rows, into `focused`; adds the seconds of each stage. */
typedef void rma_column_function(const struct rma *rma, const struct rma_swath *swath, int thread, int turn,
                                 double seconds[RMA_STAGES]);
ISA_DECLARE(rma_column_function, rma_column);

#endif
