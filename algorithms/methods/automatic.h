/* The settings of `auto`. */
#ifndef SASBENCH_METHODS_AUTOMATIC_H
#define SASBENCH_METHODS_AUTOMATIC_H

#include "contract/algorithm.h"

struct automatic_options {
    double error;  /* relative L2 */
    double memory; /* GB */
};

extern const struct algorithm automatic;

#endif
