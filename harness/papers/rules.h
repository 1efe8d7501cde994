/* The papers' rules for the upsampling rate on random scenes from seeds: is the error within a budget, and would a
   lower rate suffice? */
#ifndef SASBENCH_PAPERS_RULES_H
#define SASBENCH_PAPERS_RULES_H

#include "papers/measured.h"

/* A rule and its method: BP22 Eq. (20) gives the smallest beta of linear upsampling; ZP15's lambda/8 the smallest
   factor of zero padding, 2 fc/fs rounded up. NULL ends the names. */
extern const char *const rule_names[];
/* Quantities of a rule, by a number n. `met`: the share of scenes with an error after one gain of at most n.
   `met_2b`: the same of scenes that sample at twice the bandwidth or more. `error`: the error that a share n of the
   scenes stays below. `overpaid`: the same of the rule's rate over the least rate with a predicted error of 0.1, of
   scenes with such a rate. NULL ends the names. */
extern const char *const rule_quantities[];

/* Follow both rules on 200 scenes, those whose exact image is not empty, into DIRECTORY/rules_random.csv, a row a
   scene and rule: sampling rate over bandwidth, error after one gain (empty where the setting is refused, which
   meets no budget), the rule's rate, and the least sufficient rate. Errors: STATUS_INVALID for a place that cannot
   be written, STATUS_FAILED without memory. */
enum status rules_study(const char *directory);
/* NAN with `missing` set without a study, or where no scene has the quantity. */
double rule_value(struct measured *measured, const char *rule, const char *quantity, double number);

#endif
