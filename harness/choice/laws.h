/* What is known of candidates without any image: their work, its time, and their errors by law. */
#ifndef SASBENCH_CHOICE_LAWS_H
#define SASBENCH_CHOICE_LAWS_H

#include "choice/choice.h"

/* What all candidates of a problem share. */
struct setting {
    const struct problem *problem;
    const struct budget *budget;
    double pairs; /* of back projection */
    double ratio; /* back projection's measured errors over its laws, which hold for echoes as bright as the image;
                     1 until one is measured */
};

/* Of the budget, the error that what stands for the exact image may have by law. */
#define LAWS_EXACT 0.1

/* Fill the choice with all candidates. Those that are not out are slower (CANDIDATE_SLOWER) until one is chosen.
   Errors: STATUS_FAILED. */
enum status laws_fill(struct setting *setting, struct choice *choice);

/* The fastest so far, or one to be counted before, where that takes less time than may be gained: each of a family is
   slower than the one before, and waits until that is out. NULL without any. */
struct candidate *laws_next(struct choice *choice);
/* Does it sum the pairs of every pixel by themselves? */
bool laws_sums(const struct candidate *candidate);

/* Count its work, a setting called by its error with what the budget allows. */
enum status laws_count(const struct setting *setting, struct candidate *candidate);
bool laws_counted(const struct candidate *candidate);
/* Count it, and find its error by law. Of an interpolator that takes several times as long, of range migration's
   spectrum as long as a plan. */
enum status laws_complete(const struct setting *setting, struct candidate *candidate);
/* Is its error not known, and it is not out? */
bool laws_open(const struct candidate *candidate);

/* The error by law, of back projection times the ratio, against the budget: verdict and reason. */
void laws_compare(const struct setting *setting, struct candidate *candidate);

/* One candidate more: whichever back projection is the fastest with as small an aperture as its error leaves room for,
   where that is faster than the fastest within the budget. */
enum status laws_limit(const struct setting *setting, struct choice *choice, const struct candidate *fastest);
/* One candidate more: the same settings in the general engine, which has no tables. */
enum status laws_without_tables(const struct setting *setting, const struct candidate *from, struct choice *choice);

/* One that is refused says why, and that is no error. */
enum status laws_refused(struct candidate *candidate, enum status status);

#endif
