/* Small scenes for factorised back projection with a tree, which small scenes are not given by default. */
#ifndef SASBENCH_TESTS_FACTORISED_SCENES_H
#define SASBENCH_TESTS_FACTORISED_SCENES_H

#include "contract/acquisition.h"
#include "contract/algorithm.h"

enum { FACTORISED_PINGS = 96 };

/* What is seen, and how. */
enum factorised_kind { STRAIGHT, CURVED, LIMITED, SQUINTED, SIDES, ENDED, TURNED, ENDFIRE, FACTORISED_KINDS };
extern const char *const factorised_names[FACTORISED_KINDS];
extern const struct grid factorised_grids[FACTORISED_KINDS];

/* Places of the sonar, and records of noise of a flat spectrum up to the band's edge, which comes from everywhere; both
   are freed by the caller. */
void factorised_scene(enum factorised_kind kind, struct acquisition *a, struct echoes *echoes);

/* A random scene of a seed whose nearest pixels are .3 to 6 m away, nearer than a long track is wide, in front of the
   sonar, behind it or on both sides; the echoes, as above, end before or behind the furthest pixels. Sampled
   `oversampling` times; at random where that is 0. To be freed. */
void factorised_near_scene(int seed, double oversampling, struct acquisition *a, struct grid *grid,
                           struct echoes *echoes);

/* The error of an image by SPEC; the test fails where there is none. */
double factorised_error(const char *spec, struct problem problem, const struct echoes *echoes,
                        const struct image *exact);

/* The errors of trees of `stages` for each of the `count` errors asked for stay below, and not far: by a factor of 30
   at most. */
void factorised_check(enum factorised_kind kind, int stages, int count, const double *errors);

#endif
