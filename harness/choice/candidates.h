/* The settings that a planner chooses among. */
#ifndef SASBENCH_CHOICE_CANDIDATES_H
#define SASBENCH_CHOICE_CANDIDATES_H

#include "choice/choice.h"

enum { CANDIDATES_MAX = 128 };

/* Fill list[CANDIDATES_MAX] with algorithm, settings and options of every candidate, back projections first; the rest
   is zero. Returns their number. Range migration of a track that is not straight is a chain. */
int candidates_fill(const struct acquisition *acquisition, struct candidate *list);

/* Add a setting to a candidate; false where its algorithm has no such parameter or does not accept the value. */
bool candidate_set(struct candidate *candidate, const char *key, const char *value);
/* Set its parameter `error`, rounded down to two digits, at most the largest accepted; false where it is too small. */
bool candidate_set_error(struct candidate *candidate, double error);

#endif
