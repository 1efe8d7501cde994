/* Candidates before any image: their work, its time, and their errors by law. */
#ifndef SASBENCH_CHOICE_LAWS_H
#define SASBENCH_CHOICE_LAWS_H

#include "choice/choice.h"
#include "imaging/spec.h"

/* What all candidates of a problem share. */
struct setting {
    const struct problem *problem;
    const struct budget *budget;
    double pairs; /* of back projection */
    double ratio; /* back projection's measured errors over its laws, which assume echoes as bright as the image; 1
                     until one is measured */
};

/* Fill the choice with all candidates. Those that are not out are CANDIDATE_SLOWER until one is chosen. Errors:
   STATUS_FAILED. */
enum status laws_fill(struct setting *setting, struct choice *choice);

/* The fastest so far, or a candidate to count first, if counting it takes less time than it may gain. Each of a family
   is slower than the one before, and waits until that is out. NULL without any. */
struct candidate *laws_next(struct choice *choice);
/* Does it sum each pixel's pairs separately? */
bool laws_sums(const struct candidate *candidate);

/* Count its work; a candidate with a parameter `error` gets what the budget allows. */
enum status laws_count(const struct setting *setting, struct candidate *candidate);
bool laws_counted(const struct candidate *candidate);
/* Count it, and compute its error by law. That takes several times as long for an interpolator, and as long as a plan
   for range migration's spectrum. */
enum status laws_complete(const struct setting *setting, struct candidate *candidate);
/* Is its error unknown, and is it not out? */
bool laws_open(const struct candidate *candidate);

/* Compare the error by law, of back projection times the ratio, with the budget: verdict and reason. */
void laws_compare(const struct setting *setting, struct candidate *candidate);

/* Add a candidate: the fastest back projection with as small an aperture as its error leaves room for, if it is faster
   than the fastest within the budget. */
enum status laws_limit(const struct setting *setting, struct choice *choice, const struct candidate *fastest);
/* Add a candidate: the same settings in the general engine, which has no tables. */
enum status laws_without_tables(const struct setting *setting, const struct candidate *from, struct choice *choice);

/* Keep a refusal as the candidate's reason: it is no error. */
enum status laws_refused(struct candidate *candidate, enum status status);

/* A SPEC that stands for the exact image on few pixels, freed with spec_free, and its error by law: polynomials whose
   error is small beside the budget, or `reference` with 0, as no law covers an image that is `dark` beside its
   echoes. */
enum status laws_exact(const struct setting *setting, bool dark, struct spec *spec, double *error);

#endif
