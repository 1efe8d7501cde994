/* The plan of an omega-k imager (wk.h). wk_layout.c lays it out, wk_transform.c transforms along range and azimuth (for
   each precision), wk_record.c, wk_line.c and wk_row.c work on one record, one azimuth wavenumber and one image row
   (for each precision and instruction set), wk.c puts them in order. Pointers without a type hold values of the plan's
   precision; all are complex unless stated otherwise, the last dimension is contiguous.

   Positions of an image are taken in the plan's own axes, turned by `angle` (0 where they are the track's) about the
   track's middle ping at x = x_middle, r = 0:  x' = (x - x_middle) cos - r sin,  r' = (x - x_middle) sin + r cos.

       range     [pings][samples] -> [pings][band], the middle sample and the middle ping being the origins
       azimuth   [pings][band] -> [azimuth_length][band], in place
       line      one wavenumber of `lines`: band values, read or interpolated, -> Ky bins of a patch -> its rows
                 -> [rows][line_stride], `focused`
       inverse   [rows][line_stride] -> [r_count][x_count] */
#ifndef SASBENCH_WAVENUMBER_WK_ENGINE_H
#define SASBENCH_WAVENUMBER_WK_ENGINE_H

#include <math.h>

#include "common/isa.h"
#include "common/fit.h"
#include "common/memory.h"
#include "range_migration/rma_conditions.h"
#include "range_migration/stretch.h"
#include "wavenumber/wk.h"

struct polar_filter;
struct traces;

enum {
    WK_ALIGNMENT = 64,   /* bytes */
    WK_GUARD = 16,       /* zeros beside the band: the longest kernel */
    WK_INTERVALS = 1024, /* of the range kernel's table, linear inside each */
    WK_POWERS = 10,      /* of the azimuth kernel's polynomials: within 1e-6 of it */
    WK_SPAN = 256,       /* bins that go through the interpolations together, in the cache */
    WK_TILE = 8          /* neighbouring lines whose rows are stored together */
};
#define WK_WIDEST_SINE 0.98 /* of the angles that are imaged: nearer to the track nothing is resolved in range */
/* Oversampling of an image that is resampled, and of the record by the range transform. With 8 taps the lesser one is
   enough. Fewer taps interpolate worse there; with more, the error by the missing bins beyond the band's edges grows
   with the weights of the record's ends. */
#define WK_OVERSAMPLING       1.5
#define WK_OVERSAMPLING_LEAST 1.25

/* A kernel. Range: its weights for each fraction of a bin, each of them twice, for real and imaginary parts, zeros
   behind them: real [WK_INTERVALS + 2][wk_kernel_width]. Azimuth: those of the first half of the taps as polynomials in
   u - 1/2, lowest power first: real [taps/2][WK_POWERS]. */
struct wk_kernel {
    int taps;
    double shape; /* of the Kaiser window; 0: a truncated sinc, without weights */
    void *values;
};

static inline int wk_kernel_width(int taps)
{
    return 2 * ((taps + 7) / 8 * 8);
}

struct wk_patch {
    struct grid grid; /* as wanted */
    struct grid own;  /* focused, in the plan's own axes: the same pixels, or a finer grid to resample */
    bool resampled;
    double kx_carrier; /* rad/m: removed before resampling, else 0 */
    long long bin_carrier;
    int length; /* of the range IFFT: Ky = bin 2 pi/(length own.r_step) */
    size_t row; /* of its first row in `focused` */
    bool folds; /* columns divide the lines' period evenly: one transform; else a convolution with a chirp */
    int columns;
    void *before, *kernel, *after; /* [lines], [columns] (chirp only), [own.x_count] */
    void *wide;                    /* [own.r_count][own.x_count]: resampled only */
    void *taper;                   /* real [length]: weights of the wave's bins; resampled only */
    void *focus_plan, *azimuth_forward, *azimuth_inverse;
};

enum wk_stage { WK_ROTATE, WK_STOLT, WK_FOCUS, WK_STAGES };

struct wk;

/* ---- the loops of each instruction set ---- */
/* wk_record.c: the spectrum of ping n's record, weighted, the centroid removed, into its row of `data`. `wave`:
   [range_length], aligned as for FFTW's plan. */
typedef void wk_record_function(const struct wk *wk, int n, const void *record, void *wave);
/* wk_line.c: lines from `first` to first + WK_TILE - 1, all rows, into `focused`; seconds of each stage are added. */
typedef void wk_line_function(const struct wk *wk, int thread, int first, double seconds[WK_STAGES]);
/* wk_row.c: row i of a patch, from `focused` onto its columns. `wave`: [columns], aligned as for FFTW's plan. */
typedef void wk_row_function(const struct wk *wk, const struct wk_patch *patch, int i, void *wave, void *pixels);
ISA_DECLARE(wk_record_function, wk_record);
ISA_DECLARE(wk_line_function, wk_line);
ISA_DECLARE(wk_row_function, wk_row);

struct wk {
    struct stretch stretch;
    struct problem problem; /* the stretch's */
    struct wk_method method;
    struct wk_options options;
    struct work work;

    /* track: ping n of the transform is at x_middle + (n - middle) spacing */
    double sound_speed, speed, fc, fs, t0, spacing, x_middle;
    int pings, samples, middle;
    bool reversed;            /* the track runs towards -x: its last ping comes first */
    double squint, slope;     /* rad; the centroid is at Kx = slope K_R */
    double angle;             /* rad: of the own axes */
    double sine[2], x_end[2]; /* of the angles off broadside with echoes; m from x_middle: the track's ends */

    /* range: bin k of the band is at fc + (band_first + k) fs/range_length; the sample `centre` is the origin */
    int range_length, centre;
    int band_first, band, row; /* row: bins of a stored row */
    double oversampling;       /* of the records, with the shift by centroids, by the range transform */
    double record_pad;         /* samples by which turned axes shift a record to either side */
    double drift;              /* of it: half the way over X, positive where echoes come earlier */

    /* azimuth: the transform's bins are 2 pi/(azimuth_length spacing/stuffed) apart, pings every `stuffed` */
    int stuffed, azimuth_length;
    /* lines: line i is at kx_first + i kx_step (rad/m); unfolded: bin line_first + i of the transform */
    int lines, line_first;
    size_t line_stride;                /* lines rounded up to WK_TILE */
    double kx_first, kx_step, kx_base; /* kx_base: rad/m, removed before the azimuth transform */
    bool skips;                        /* cells beyond the support are not worked on */

    int taps;
    struct wk_kernel range_kernel, azimuth_kernel;
    void *range_weights;   /* real [samples + 2 weights_beside + 1]: 1/transform of the kernel, around `centre` */
    int weights_beside;    /* record_pad, and one */
    void *azimuth_weights; /* real [pings] */
    struct fit_nodes fit;

    int patch_count;
    struct wk_patch *patches;
    size_t rows; /* of all patches */

    wk_record_function *record_loop;
    wk_line_function *line_loop;
    wk_row_function *row_loop;

    struct polar_filter *filter;
    struct traces *traces;
    void *compressed; /* [pings][samples]: with the filter only */

    int threads;
    size_t scratch_bytes;
    void *scratch; /* [threads] */
    void *data;    /* [azimuth_length][row] */
    void *focused; /* [rows][line_stride] */
    void *range_forward, *azimuth_forward;
    struct store store;
};

/* Ky0 of frequency F at Kx0, both in the own axes; NAN where evanescent. */
static inline double wk_ky(const struct wk *wk, double frequency, double kx0)
{
    double c = wk->sound_speed, beta = wk->speed / c, b1 = (1 - beta) * (1 + beta), scale = 4 * M_PI / c;
    double f = frequency * scale, cosine = cos(wk->angle), sine = sin(wk->angle);
    double root = f * f * (beta * beta * sine * sine + b1) - b1 * kx0 * (2 * f * beta * cosine + b1 * kx0);
    return root > 0 ? (sqrt(root) - f * beta * sine) / b1 : NAN;
}

/* ---- wk_conditions.c ---- */
/* Kx/K_R of the beam's axis. Motion while the pulse travels moves it by about v/c. This is ignored where it is a small
   part of the pings' band, so that a beam at broadside needs no unfolding. */
double wk_centroid_slope(const struct acquisition *acquisition, const struct straight_track *track);

/* A lone receiver at the transmitter, in range migration's terms. */
struct rma_view wk_view_of(const struct problem *problem, const struct straight_track *track);
/* STATUS_UNSUPPORTED as conditions_check, STATUS_FAILED without memory; the requirements are the cheap conditions. */
enum status wk_conditions_check(const struct problem *problem, const struct wk_method *method);
enum status wk_requirements_check(const struct problem *problem, const struct wk_method *method);

/* ---- wk_layout.c ---- */
enum status wk_layout(struct wk *wk);
/* Pings and zeros that cover all pixels and echoes in the track's own axes, before rounding up to a transform's length.
   Errors: STATUS_FAILED without memory. */
enum status wk_period(const struct wk *wk, double *period);

/* ---- wk.c ---- */
/* A plan with its layout only, freed by wk_destroy; *wk is NULL on error. The conditions must be met. */
enum status wk_lay_out(const struct problem *problem, const void *method, const void *options, struct wk **made);
/* Ky bins that are interpolated for a patch, of all lines. */
double wk_stolt_cells(const struct wk *wk, const struct wk_patch *patch);
/* Add the work behind the compression. */
void wk_count(struct wk *wk);

/* ---- wk_transform.c ---- */
struct wk_transform {
    enum status (*plan)(struct wk *wk);
    void (*compress)(const struct wk *wk, const void *samples); /* filter only */
    void (*range)(const struct wk *wk, const void *samples);
    void (*azimuth)(const struct wk *wk);
    void (*inverse)(const struct wk *wk, const struct wk_patch *patch, void *pixels);
    void (*resample)(const struct wk *wk, const struct wk_patch *patch, void *pixels);
};
extern const struct wk_transform wk_transform_float, wk_transform_double;

#endif
