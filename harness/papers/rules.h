/* The papers' rules for the upsampling rate, followed on scenes that are drawn from seeds: is the error that they leave
   within a budget, and would a lower rate do? */
#ifndef SASBENCH_PAPERS_RULES_H
#define SASBENCH_PAPERS_RULES_H

#include "papers/measured.h"

/* Which rule, and the method that it is for: BP22 Eq. (20) the smallest beta of linear upsampling; ZP15's lambda/8 the
   smallest factor of zero padding, 2 fc/fs rounded up. NULL ends the names. */
extern const char *const rule_names[];
/* Of a rule, by a number: `met`, the share of the scenes with an error after one gain up to it; `met_2b`,
   the same of those that sample at twice the bandwidth and more; `error`, the error that this share of the scenes stays
   below; `overpaid`, the same of the rule's rate over the least one that is predicted to leave an error of 0.1 (of
   scenes where there is one). NULL ends the names. */
extern const char *const rule_quantities[];

/* Follow both on 200 scenes, those whose exact image holds anything, into DIRECTORY/rules_random.csv, a row a scene and
   rule: sampling rate over bandwidth, error after one gain (empty where the setting is refused, which meets no
   budget), the rule's rate, and the least that is enough. Errors: STATUS_INVALID for a place that cannot be written,
   STATUS_FAILED without memory. */
enum status rules_study(const char *directory);
/* NAN with `missing` set where the study was not made, or where no scene has what is asked for. */
double rule_value(struct measured *measured, const char *rule, const char *quantity, double number);

#endif
