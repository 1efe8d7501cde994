/* What an algorithm's table of parameters must say of itself. */
#ifndef SASBENCH_TESTS_CONFORMANCE_PARAMS_H
#define SASBENCH_TESTS_CONFORMANCE_PARAMS_H

#include "contract/algorithm.h"

/* Fails the test where a row is not declared by PARAM or PARAM_NAMED, or says what is not true. */
void conformance_check_param(const struct algorithm *algorithm, const struct param *p);

#endif
