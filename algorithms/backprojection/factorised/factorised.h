/* Factorised back projection (bp_factorised.c): the plan of one tree, its images and its execution. */
#ifndef SASBENCH_BACKPROJECTION_FACTORISED_FACTORISED_H
#define SASBENCH_BACKPROJECTION_FACTORISED_FACTORISED_H

#include "backprojection/factorised/trace.h"
#include "backprojection/factorised/tree.h"
#include "backprojection/general/lines.h"

/* Scratch of one thread. */
struct factorised_scratch {
    void *interleaved;            /* complex [bp_record_values] */
    struct vector *tx, *velocity; /* [base] pings of a subaperture in the axes of a ray */
    struct vector *rx;            /* [base][receivers] */
    struct ping_box *boxes;       /* [base] */
    void *trace, *row;            /* trace.h */
    long long outside;            /* of an execution: reads outside of images, which give zero */
};

struct factorised {
    struct tree tree;
    struct bp bp; /* problem, records and their reading; no engine */
    bp_sum_function *sum;
    polar_trace_function *trace;
    struct bp_layout layout, polar_layout; /* of records, of traces */
    struct bp_table polar_table;
    size_t trace_pitch;
    double reach, longest;     /* of a trace's ping_box */
    struct vector *normal;     /* [pings] acquisition_normal */
    struct ping_box *boxes;    /* [pings] */
    void *rows;                /* real [base receivers][layout.record]; one value more may be read */
    void *images[STAGES_MOST]; /* real [slots][slot] of a level: the parts of one subaperture, or one image */
    size_t slot[STAGES_MOST];
    void **phasors;                     /* [stages][views] real [cosines, sines][count]: exp(-j 4 pi fc rho/c) */
    void **sums;                        /* [patch_count]: re then im, real [lines][pixels of a line] */
    bool *needed;                       /* [subapertures][patch_count]: do pixels read its image or sum its records? */
    bool *used;                         /* [subapertures]: do they, or does its parent's image, which is used? */
    struct factorised_scratch *scratch; /* [threads] */
    int threads;
    double flops;  /* without pixels summed from records */
    double direct; /* pixels times records of these, if all pairs count */
};

/* The cost of settings without the records' transforms, counted on some of the lines of pixels. */
struct factorised_cost {
    double records; /* pairs of a record and a pixel or a place of an image */
    double blocks;  /* lines of these sums, one a record */
    double images;  /* all else, in pairs of the general engine */
    double flops;   /* of all but the pairs */
    int degree;     /* of the records' polynomials */
};

/* The sum, in pairs of the general engine. It decides the number of levels. */
double factorised_pairs(const struct factorised_cost *cost);

/* The cost of settings, and for comparison, in pairs, that of back projection with the given forecast. Errors: as
   tree_make; STATUS_UNSUPPORTED where patches are turned by different angles. */
enum status factorised_cost(const struct problem *problem, const struct tree_settings *settings,
                            struct factorised_cost *cost);
enum status factorised_cost_direct(const struct problem *problem, const struct forecast *forecast, double *pairs);
/* A lower bound of the cost of images of subapertures in place of `pairs`, in pairs: each pixel reads an image, and
   some lines of an image read each record. */
double factorised_least(const struct problem *problem, double pairs);
/* The forecast of settings with a given cost. Errors: STATUS_FAILED without memory. */
enum status factorised_forecast(const struct problem *problem, const struct tree_settings *settings,
                                const struct factorised_cost *cost, struct forecast *forecast);

/* stages >= 1. Errors: as factorised_cost, and STATUS_UNSUPPORTED for records that are too long. *out is NULL on
   error. */
enum status factorised_plan(const struct problem *problem, const struct tree_settings *settings,
                            struct factorised **out);
/* Fill needed, used, direct and add to flops, line by line. The images' part of factorised_plan. */
void factorised_count(struct factorised *plan);
/* Errors: STATUS_FAILED where images would be read outside of their grids, which is a fault of the tree. */
enum status factorised_execute(struct factorised *plan, const struct echoes *echoes, struct image *image,
                               struct stages *stages);
/* Set read[pings] where records are read. */
void factorised_reads(const struct factorised *plan, bool *read);
/* FLOPs; bytes; pairs are 0. */
struct work factorised_work(const struct factorised *plan);
void factorised_destroy(struct factorised *plan);

#endif
