/* One algorithm timed once, for the rounds of `bench`; the scenes that it is timed on. */
#ifndef SASBENCH_BENCH_BENCH_ONCE_H
#define SASBENCH_BENCH_BENCH_ONCE_H

#include "contract/algorithm.h"
#include "scene/scene.h"

/* A shipped scene and its echoes in float, to be freed both. Errors: as scene_load, scene_simulate and echoes_convert;
   nothing to free then. */
enum status bench_scene(const char *name, struct scene *scene, struct echoes *echoes);

struct bench_sample {
    double plan_s, run_s;
    int runs;
    struct stages stages; /* of the median run */
};

/* Plan a SPEC on as many threads and execute it: once where that takes half a second, else after a run that warms up
   three times and a quarter of a second at the least; times are the median's. *image, where not NULL, is the finished
   one, to be freed; *work, where not NULL, the plan's. Errors: as spec_parse, imaging_open, imaging_execute,
   imaging_finish. */
enum status bench_once(const char *text, const struct problem *problem, const struct echoes *echoes, int threads,
                       struct image *image, struct work *work, struct bench_sample *sample);

/* Of a sample's median run, the seconds of one stage; NAN where there is none. */
double bench_stage(const struct bench_sample *sample, const char *name);

#endif
