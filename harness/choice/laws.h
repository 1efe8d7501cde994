/* What is known of candidates without any image: their work, its time, and their errors by law. */
#ifndef SASBENCH_CHOICE_LAWS_H
#define SASBENCH_CHOICE_LAWS_H

#include "choice/choice.h"

/* What all candidates of a problem share. */
struct setting {
    const struct problem *problem;
    const struct budget *budget;
    double pairs;            /* of back projection */
    double reads;            /* pairs that images of subapertures cannot do without */
    struct forecast records; /* what the records' transforms take of any back projection */
    double ratio; /* back projection's measured errors over its laws, which hold for echoes as bright as the image;
                     1 until one is measured */
};

/* Of the budget, the error that what stands for the exact image may have by law. */
#define LAWS_EXACT 0.1

/* Fill the choice with all candidates, of each family up to one that is so exact. Those within the budget by law are
   slower (CANDIDATE_SLOWER) until one is chosen; those of which no law tells the error have INFINITY. Errors:
   STATUS_FAILED. */
enum status laws_fill(struct setting *setting, struct choice *choice);

/* Look at more of each family, where the ratio asks for it. */
enum status laws_extend(struct setting *setting, struct choice *choice);

/* What is costly to tell of an open candidate: without echoes, the error of range migration's spectrum; of
   bp_factorised the setting that the budget allows, its work and error. */
enum status laws_complete(const struct setting *setting, struct candidate *candidate);
/* Is the candidate one of these, not refused and not completed? */
bool laws_open(const struct candidate *candidate);

/* The error by law, of back projection times the ratio, against the budget: verdict and reason. */
void laws_compare(const struct setting *setting, struct candidate *candidate);

/* One candidate more: the same settings in the general engine, which has no tables. False where there is none. */
bool laws_without_tables(const struct setting *setting, const struct candidate *from, struct choice *choice,
                         enum status *status);

/* The fastest within the budget so far, its error known or not; NULL without one. Without the costly, none that is
   still to be completed. */
struct candidate *laws_fastest(struct choice *choice, bool costly);

/* One that is refused says why, and that is no error. */
enum status laws_refused(struct candidate *candidate, enum status status);

#endif
