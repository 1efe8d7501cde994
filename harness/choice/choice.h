/* Which algorithm, with which settings, images a problem within an error budget in the least time? A candidate's time
   follows from its counted work and the machine's rates, its error from a law. The fastest's error is measured on some
   pixels of the image itself. Each has the reason why it is chosen or not. */
#ifndef SASBENCH_CHOICE_CHOICE_H
#define SASBENCH_CHOICE_CHOICE_H

#include <stddef.h>

#include "imaging/probe.h"
#include "imaging/spec.h"

enum candidacy { CANDIDATE_CHOSEN, CANDIDATE_SLOWER, CANDIDATE_MEMORY, CANDIDATE_ERROR, CANDIDATE_REFUSED };

struct candidate {
    const struct algorithm *algorithm;
    char settings[80];           /* as in a SPEC: "degree=4", may be empty */
    max_align_t options[8];      /* the algorithm's options struct */
    int family;                  /* of candidates, each slower than the one before */
    bool budgeted;               /* its parameter `error` is set to what the budget allows */
    double sine;                 /* up to which it sums pairs, beside the acquisition's own limit; 1: all */
    struct forecast forecast;    /* zero where refused; range migration's without the error of its spectrum */
    double error;                /* relative L2: measured, or else by law; INFINITY without either */
    struct probe_error measured; /* `pixels` is 0 where it was not */
    double seconds;              /* of a run; INFINITY where unknown; of bp_factorised without a forecast a bound */
    double count_s;              /* s: about what it takes to count it */
    double flops, pairs;         /* counted; NAN where unknown */
    double bytes;                /* of the process (process.h); NAN where no plan was made */
    enum candidacy verdict;
    char reason[480]; /* why it is not chosen; empty for the chosen one */
};

/* Made by choice_make, released by choice_free, which accepts a zeroed struct. */
struct choice {
    struct candidate *list; /* [count]: the chosen one first, then by verdict and time */
    int count;
    bool found;
    double least;       /* the least error of those that are not refused; INFINITY if all are */
    struct work work;   /* of the chosen one's plan */
    struct image image; /* by the chosen one, finished (imaging.h), where choosing formed all of it; else empty */
};

/* The budgets of a choice. */
struct budget {
    double error;         /* relative L2 of the complex image after one best complex gain, > 0 */
    double bytes;         /* that the process may take */
    double seconds;       /* that an image may take that is formed to measure its error; 0: laws alone */
    bool windows;         /* by settings alone that form a part of an image, of the pings that it takes */
    bool all;             /* count slower back projections and compute their errors by law as well */
    struct region region; /* of the image, where the error counts */
};

/* Choose among all candidates for the problem's precision. `echoes` [2] by enum precision, or NULL: laws alone. The
   same problem, echoes and rates (rates.h) give the same choice. Where nothing fits, found is false, and each candidate
   has its reason. Errors: STATUS_FAILED without memory, as imaging_finish. */
enum status choice_make(const struct problem *problem, const struct echoes *echoes, const struct budget *budget,
                        struct choice *choice);
void choice_free(struct choice *choice);

/* Does the SPEC leave the choice to choice_make? *budget is then its own. */
bool choice_asked(const struct spec *spec, struct budget *budget);
/* The chosen setting as a SPEC of the same precision, freed with spec_free. Errors: STATUS_UNSUPPORTED naming the least
   error where nothing was found, STATUS_FAILED. */
enum status choice_spec(const struct choice *choice, const struct budget *budget, enum precision precision,
                        struct spec *chosen);

/* A copy of the SPEC, or what is chosen for it, freed with spec_free. Errors: as choice_make and choice_spec. */
enum status choice_resolve(const struct spec *spec, const struct problem *problem, const struct echoes *echoes,
                           struct spec *resolved);

/* "bp_farrow:degree=4": as the column `engine` holds it. */
enum { CANDIDATE_NAME = 96 };
void candidate_name(const struct candidate *candidate, char text[CANDIDATE_NAME]);

#endif
