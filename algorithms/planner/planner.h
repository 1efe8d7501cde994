/* Which algorithm, with which settings, images a problem within an error budget in the least time: every candidate's
   forecast, its time from the work that is counted and the machine's rates, and why it is chosen or not. */
#ifndef SASBENCH_PLANNER_PLANNER_H
#define SASBENCH_PLANNER_PLANNER_H

#include <stddef.h>

#include "contract/algorithm.h"

enum verdict { VERDICT_CHOSEN, VERDICT_SLOWER, VERDICT_MEMORY, VERDICT_ERROR, VERDICT_REFUSED };

struct candidate {
    const struct algorithm *algorithm;
    char settings[80];        /* as in a SPEC: "degree=4", may be empty */
    max_align_t options[8];   /* the algorithm's options struct */
    bool budgeted;            /* its parameter `error` is set to what the budget allows */
    double sine;              /* up to which it sums pairs, beside the acquisition's own limit; 1: all */
    struct forecast forecast; /* zero where refused; errors are, too, where it is too slow whatever they be */
    double error;             /* relative L2 that is planned with; INFINITY where there is no forecast */
    double seconds;           /* of a run; INFINITY where unknown; of bp_factorised without a forecast a lower bound */
    double flops, pairs;      /* counted; NAN where unknown */
    double bytes;             /* of the process (process.h); NAN where no plan was made */
    enum verdict verdict;
    char reason[480]; /* why it is not chosen; empty for the one that is */
};

/* Made by planner_choose, released by choice_free, which accepts a zeroed struct. */
struct choice {
    struct candidate *list; /* [count]: the chosen one first, then by verdict and time */
    int count;
    bool found;
    void *plan;   /* of the chosen one's algorithm: the caller may take it, and leave NULL */
    double least; /* the least error of those that are not refused; INFINITY if all are */
};

/* What is asked for. */
struct budget {
    double error; /* relative L2 of the complex image after one best complex gain, > 0 */
    double bytes; /* that the process may take */
    bool every;   /* forecast the errors of all candidates, also of those that are slower for sure: takes seconds */
};

/* Errors: STATUS_UNSUPPORTED as condition_targets_shown, STATUS_FAILED without memory. Where nothing fits, found is
   false, and the reasons say why. */
enum status planner_choose(const struct problem *problem, const struct budget *budget, struct choice *choice);
void choice_free(struct choice *choice);

/* From now on `hear` is told of each choice that `auto` makes, before it is freed; NULL: nobody is. For one thread. */
void automatic_tell(void (*hear)(void *to, const struct problem *problem, const struct budget *budget,
                                 const struct choice *choice),
                    void *to);

/* "bp_farrow:degree=4": as the column `engine` holds it. */
enum { CANDIDATE_NAME = 96 };
void candidate_name(const struct candidate *candidate, char text[CANDIDATE_NAME]);

#endif
