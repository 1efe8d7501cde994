/* The tree of subapertures of factorised back projection, and the polar grids of their images.

   A subaperture is a stretch of pings with all their receivers. The image of its pairs lies on a polar grid about its
   centre C: places C + rho (s b + sqrt(1 - s^2) a), rho m from C and s the sine off the axis a. a is the direction of
   the patch's lines (or against it: the other side), b across. The grid stores

       f(rho, s) = image exp(-j 4 pi fc rho/c),

   where a pair's part is band limited in both coordinates. At the delay tau of a pair and d = tau - 2 rho/c its
   frequencies are at most B/c + fc |dd/drho| cycles a metre and (fc + B/2) |dd/ds| cycles. Both are measured from exact
   delays of the subaperture's pairs, on any track, at the grid's ends and between them. Steps follow from the
   frequencies and the taps' oversampling (taps.h). Where dd/drho takes more than RESIDUAL_MOST of the signal's band
   B/c, a place is too near. Its pixels read the images of the subaperture's parts instead.

   An image of level 0 is summed from the records, one of a higher level from the images of its parts, a line of equal s
   at a time. Pixels are summed line by line from the largest subapertures that may be read there. A pixel does not read
   an image if some of its pairs do not count there (records' ends, aperture limit). What no image gives is summed from
   the records: only the interpolations approximate. */
#ifndef SASBENCH_BACKPROJECTION_FACTORISED_TREE_H
#define SASBENCH_BACKPROJECTION_FACTORISED_TREE_H

#include <math.h>

#include "contract/algorithm.h"
#include "backprojection/factorised/taps.h"
#include "backprojection/pairs/pairs.h"

enum { STAGES_MOST = 6 }; /* levels of images */

/* The polar grid of one subaperture, one patch and one side of its lines. */
struct polar {
    int line_first, lines;   /* line n lies at s = (line_first + n) step; lines 0: no image */
    int place_first, places; /* place j at rho = (place_first + j) step */
    double near, far;        /* m: rho at which it may be read */
    double low, high;        /* s at which it may be read */
    size_t offset;           /* of its values in the subaperture's, real */
};

/* Values of a line's real parts, and of its imaginary ones behind them: whole vectors, and one more. */
static inline size_t polar_pitch(const struct polar *polar)
{
    return ((size_t)polar->places + 15) / 16 * 16 + 16;
}

struct subaperture {
    int ping, pings;      /* first one, count */
    int level;            /* 0: of records */
    int parent;           /* -1: none */
    int child, children;  /* its parts */
    double x, y, radius;  /* m: centre; greatest distance of its elements */
    struct vector tx;     /* m: the transmitters' mean */
    double tx_radius;     /* m: their greatest distance from it */
    struct vector normal; /* the mean of acquisition_normal */
    double normal_radius; /* rad: their greatest angle to it */
    size_t values;        /* of its images, real */
    struct polar *polars; /* [views] in the tree's */
};

/* Shared by all grids of a level, one patch and one side. */
struct polar_step {
    double rho, sine;       /* m, 1 */
    int place_first, count; /* places of any subaperture */
    double tangent;         /* of the greatest angle between a ray and a line it reads */
};

struct tree_settings {
    double error;             /* relative L2 error of the image by the interpolations */
    int base, factor, stages; /* pings of the smallest subapertures, parts of the larger ones; levels of images */
};

/* The error of one interpolation. An image's squared error is the sum of the records' and of two for each level of
   images. A sixth is left for echoes that crowd at a band's edge, as the law is of a flat band. */
static inline double tree_error_each(const struct tree_settings *settings)
{
    return 0.85 * settings->error / sqrt(2 * settings->stages + 1);
}

/* rad: the phase error of quintics, in proportion to the error asked for. */
double tree_phase_limit(const struct tree_settings *settings, const struct acquisition *acquisition);

struct tree {
    struct problem problem;
    struct tree_settings settings;
    struct polar_taps range, angle;
    double band;                /* Hz: of the compressed echoes; the energy outside is within the error */
    int degree;                 /* of the records' polynomials, which share the error with the images' taps */
    int views;                  /* two a patch: patch 2 + side */
    bool *along_x;              /* [patch_count] the lines' direction */
    int first[STAGES_MOST + 1]; /* of a level's subapertures; behind the last level, their number */
    struct subaperture *subapertures;
    struct polar *polars;     /* [subapertures][views] */
    struct polar_step *steps; /* [stages][views] */
    double bytes;
};

/* Errors: STATUS_FAILED without memory, STATUS_UNSUPPORTED for an error that is not attainable. Free *tree with
   tree_free in any case; tree_free accepts a zeroed struct. */
enum status tree_make(const struct problem *problem, const struct tree_settings *settings, struct tree *tree);
void tree_free(struct tree *tree);

/* (along, across) of a vector in the axes a, b of a view. */
struct polar_axes {
    bool along_x;
    double sign;
};
static inline struct polar_axes polar_axes(const struct tree *tree, int view)
{
    return (struct polar_axes){tree->along_x[view / 2], view % 2 ? -1 : 1};
}
static inline void polar_turn(struct polar_axes axes, double x, double y, double *along, double *across)
{
    *along = axes.sign * (axes.along_x ? x : y);
    *across = axes.along_x ? y : x;
}
static inline void polar_turn_back(struct polar_axes axes, double along, double across, double *x, double *y)
{
    *x = axes.along_x ? axes.sign * along : across;
    *y = axes.along_x ? across : axes.sign * along;
}
static inline struct polar_step *polar_step(const struct tree *tree, int level, int view)
{
    return &tree->steps[level * tree->views + view];
}

/* Stretches of a line of pixels, apart and in rising order. */
enum { SPANS_MOST = 8 * (STAGES_MOST + 2) };
struct spans {
    int count;
    struct pair_span span[SPANS_MOST];
};

/* Pixels of a line that read a subaperture's image of one view: where no image of a larger subaperture may be read. */
void tree_pixels(const struct tree *tree, int subaperture, int view, const struct pixel_line *line,
                 struct spans *spans);
/* Pixels of a line of a patch that sum the records of a subaperture of level 0, without those outside the aperture
   limit of all its pings. */
void tree_direct(const struct tree *tree, int subaperture, int patch, const struct pixel_line *line,
                 struct spans *spans);

/* Samples of the records that images of level 0 and pixels read. */
struct sample_span tree_samples(const struct tree *tree);

#endif
