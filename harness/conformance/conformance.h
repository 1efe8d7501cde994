/* Every promise of algorithm.h, and of sasbench.h, checked for one algorithm on ordinary and extreme scenes. It may
   refuse a scene as unsupported, with a reason, unless its traits promise it; what it accepts must hold. */
#ifndef SASBENCH_CONFORMANCE_CONFORMANCE_H
#define SASBENCH_CONFORMANCE_CONFORMANCE_H

#include <stdio.h>

#include "conformance/conformance_scenes.h"
#include "imaging/spec.h"

/* What a check has: each runs in a process of its own, so that a crash ends it alone; its memory ends with it. */
struct conformance {
    FILE *stream;
    const struct algorithm *algorithm;
    struct spec specs[2];        /* by enum precision */
    const struct setting *usual; /* a scene that it must image: raw echoes, of a monostatic sonar where it needs one */
    struct tally {
        int kept, broken;
        char place[200]; /* what is at work */
        bool monostatic;
        int accepted;     /* scenes */
        bool ended;       /* the check ran to its end: no `exit` of the algorithm's */
        double failing_s; /* spent in plans and executes that fail */
    } * tally;            /* shared with the process that waits */
};

/* A check on one scene: on each of them, or on the usual one. */
struct conformance_check {
    const char *name;
    void (*run)(const struct conformance *conformance, const struct setting *setting);
    bool each;
};

/* Run all checks, then `more` [more_count], and print a line for each promise. Returns the number of broken ones. */
int conformance_run(const struct spec *spec, FILE *stream, const struct conformance_check *more, int more_count);

/* For checks. Print a promise, with what was found, at a place ("raw, float"). */
bool promise(const struct conformance *conformance, const char *place, bool kept, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
bool promise_most(const struct conformance *conformance, const char *place, const char *what, double value,
                  double bound);
/* Name what may crash next. */
void conformance_at(const struct conformance *conformance, const char *place);
/* End the check where it cannot go on: the harness itself failed. */
void conformance_need(const struct conformance *conformance, enum status status);

/* A plan; false where it is refused, as it should be. */
bool conformance_plan(const struct conformance *conformance, const struct setting *setting,
                      const struct problem *problem, void **plan);
/* Image a plan: pixels and echoes (converted here) lie at a page that cannot be touched, before or behind them. */
void conformance_execute(const struct conformance *conformance, const char *place, void *plan,
                         const struct problem *problem, const struct echoes *echoes, bool behind, struct image *image);
/* Plan on a number of threads, execute, destroy. */
bool conformance_form(const struct conformance *conformance, const struct setting *setting, struct problem problem,
                      enum precision precision, int threads, const struct echoes *echoes, struct image *image);
/* A scene and its echoes in double. */
void conformance_echoes(const struct conformance *conformance, const struct setting *setting, struct scene *scene,
                        struct grid grids[2], struct echoes *echoes);
bool same_bits(const struct image *a, const struct image *b);
/* |a - b|_2 / |b|_2, or |a|_2 where b is zero, whatever their places. */
double image_difference(const struct image *a, const struct image *b);

/* conformance_images.c, conformance_plans.c */
void check_images(const struct conformance *conformance, const struct setting *setting);
void check_linearity(const struct conformance *conformance, const struct setting *setting);
void check_translation(const struct conformance *conformance, const struct setting *setting);
void check_memory(const struct conformance *conformance, const struct setting *setting);
void check_schedules(const struct conformance *conformance, const struct setting *setting);
void check_state(const struct conformance *conformance, const struct setting *setting);
void check_settings(const struct conformance *conformance, const struct setting *setting);

#endif
