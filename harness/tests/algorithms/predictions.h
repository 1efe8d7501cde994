/* Errors that are predicted, beside those that are measured. */
#ifndef SASBENCH_TESTS_PREDICTIONS_H
#define SASBENCH_TESTS_PREDICTIONS_H

#include "measure/session.h"

/* What is forecast of a SPEC on a problem. */
struct forecast forecast_of(const char *text, const struct problem *problem);

/* Of a SPEC on the session's scene, by what planning knows of it; *error is the measured one. */
double predicted_over_measured(struct session *session, const char *text, double *error);

/* A random scene of which `count` points are all targets; freed by the caller. */
void points_scene(int seed, int count, struct scene *scene);

#endif
