/* The results of a run, in half a terminal. */
#ifndef SASBENCH_RUN_RUN_SUMMARY_H
#define SASBENCH_RUN_RUN_SUMMARY_H

#include <stdio.h>

#include "results/results.h"
#include "imaging/spec.h"
#include "scene/scene.h"

/* For four errors, the fastest algorithm on each scene, one line a scene; then the refusals, the time of `auto`'s
   choices, where the time was `spent`, and how noisy times are. Only rows of these scenes and SPECs count. */
void run_summary_print(FILE *stream, const struct results *results, int scene_count, const struct scene *scenes,
                       int spec_count, const struct spec *specs, const char *spent);

#endif
