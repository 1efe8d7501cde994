/* Access to options structs by the tables of their params. */
#ifndef SASBENCH_CONTRACT_PARAM_H
#define SASBENCH_CONTRACT_PARAM_H

#include "contract/algorithm.h"

/* One field that is no text; a choice by its index. */
void param_store(const struct param *param, void *options, double value);
double param_load(const struct param *param, const void *options);
/* Index of a name among a choice's, -1 if it is none. */
int param_choice(const struct param *param, const char *name);

/* Every parameter of an algorithm's options [options_size] at its default, all else 0. */
void options_fill(const struct algorithm *algorithm, void *options);

#endif
