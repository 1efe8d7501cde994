/* A forecast for an algorithm's settings, before any plan: the errors of the image by cause, and the counts that decide
   its time. */
#ifndef SASBENCH_CONTRACT_FORECAST_H
#define SASBENCH_CONTRACT_FORECAST_H

#include <stdbool.h>

/* Why an image is not the exact one. Causes are independent: their squares add up. */
enum cause {
    CAUSE_INTERPOLATION, /* values between samples */
    CAUSE_DELAYS,        /* delays that are interpolated, by pixel or by record */
    CAUSE_SPECTRUM,      /* the two-dimensional spectrum: stationary phase, sampling in azimuth, the formula */
    CAUSE_BLOCKS,        /* ranges that share a conversion, and receivers that share its terms */
    CAUSE_STOLT,         /* the interpolation of the spectrum */
    CAUSE_APERTURE,      /* pairs that an aperture limit leaves out */
    CAUSE_FLOAT,         /* rounding */
    CAUSES
};
extern const char *const cause_names[CAUSES];

/* How a pair's value is read, which decides its time. */
enum reading_kind { READ_NEAREST, READ_LINE, READ_TAPS, READ_BRANCHES, READ_KINDS };

/* Parts of range migration's cost. */
enum migration {
    MIGRATION_RECORDS, /* FLOPs of the records' transforms and delays */
    MIGRATION_SPREAD,  /* values that are transformed over the pings and put where wavenumbers read them */
    MIGRATION_BLOCKS,  /* FLOPs that convert receivers: block by block, or by a filter */
    MIGRATION_TERMS,   /* FLOPs that add receivers up by terms */
    MIGRATION_FOCUS,   /* bins and rows that transforms and the Stolt interpolation make of all wavenumbers */
    MIGRATIONS
};

struct forecast {
    double error[CAUSES]; /* relative L2 of the complex image after one best complex gain, root mean square;
                             INFINITY: no law */
    bool sums_pairs;      /* back projection: the fields below count its pairs and records */
    bool tables;          /* by the invariant engine */
    enum reading_kind kind;
    int values;        /* that a pair reads */
    int finer;         /* values of a record per sample */
    double units;      /* made for the pairs: entries of tables, or blocks of pixels */
    double residues;   /* by tables: columns from ping to ping whose neighbours share loads */
    double pairs;      /* by the general engine: about how many there are; else 0 */
    double apart;      /* by the general engine: share of the pairs whose pixels share no loads, a sample apart */
    double pair_flops; /* of a pair */
    /* Of all records together: */
    double record_flops;  /* of the transforms of range compression */
    double slowness;      /* of their length: seconds a FLOP over those of lengths that FFTW is fast at */
    double kernel_flops;  /* of branches in place of a kernel's taps */
    double record_values; /* complex values stored for the pairs to read */
    /* Where images of subapertures replace pairs: their cost, and the pairs that are left, which `units` belong to;
       else 0. */
    double image_cost; /* in pairs */
    double image_flops;
    double image_pairs;
    /* Counts of range migration, by algorithm.h's `cost`: */
    double migration[MIGRATIONS];
    double migration_flops; /* that are counted, all of them */
};

/* The error by all causes: the root of the sum of squares. */
double forecast_error(const struct forecast *forecast);
/* The cause with the greatest error. */
enum cause forecast_cause(const struct forecast *forecast);

#endif
