/* One line of the command `bench`: a SPEC on a scene, measured in several rounds by the machinery of `run`. */
#ifndef SASBENCH_BENCH_BENCH_LINE_H
#define SASBENCH_BENCH_BENCH_LINE_H

#include "measure/session.h"
#include "measure/timing.h"

/* FFTW's time, s, best of five. Which is faster depends on the machine's caches. */
struct fft_seconds {
    double plan;   /* by one two-dimensional plan */
    double strips; /* rows by themselves, columns by strips that are copied to and fro */
    double best;   /* the smaller of both */
};

struct bench_line {
    const char *name, *scene; /* borrowed; no name: none is printed */
    struct spec spec;
    const char *isa; /* borrowed; "": the processor's best */
    int threads;     /* this and what follows: as measured, once it is */
    double pair_flops;
    bool measured;
    struct timing_samples *samples;  /* while it is measured */
    double peaks[2 * TIMING_ROUNDS]; /* FLOP/s, before and after each round */
    struct measurement row;          /* its texts are no longer valid, but for those below */
    char engine[96], stages[512];
    int columns, rows;      /* of the first patch */
    struct fft_seconds fft; /* NAN for algorithms that sum pairs, and in double */
};

/* Is the instruction set below the one that is chosen, or the line for that one? Other lines are left out. */
bool bench_line_here(const struct bench_line *line);

/* Measure the lines of one scene, all in turn in each round. Errors: as session_open; STATUS_FAILED for a line that
   fails or is refused. */
enum status bench_lines_measure(const struct scene *scene, struct bench_line *const *lines, int count);

/* The names of values for goals; NULL ends them. A value is NAN where the line has none. */
extern const char *const bench_values[];
double bench_value(const struct bench_line *line, int value);
double bench_peak(const struct bench_line *line); /* FLOP/s, the median */

#endif
