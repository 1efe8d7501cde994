/* What the library's files share. */
#ifndef SASBENCH_LIBRARY_LIBRARY_H
#define SASBENCH_LIBRARY_LIBRARY_H

#include "library/libsasbench.h"
#include "measure/session.h"
#include "scene/scene.h"

_Static_assert((int)STATUS_UNSUPPORTED == SAS_UNSUPPORTED && (int)STATUS_FAILED == SAS_FAILED, "one status");
_Static_assert((int)PRECISION_DOUBLE == SAS_DOUBLE, "one precision");

struct sasbench {
    int threads;
    char *scenes;
};

struct sasbench_scene {
    const struct sasbench *context;
    struct scene scene;
    struct sasbench_arrays shown;
    struct sas_acquisition acquisition; /* of it */
    struct sas_grid *grids;             /* [patch_count] of it */
    bool silent;                        /* neither echoes nor points */
    bool ready;                         /* for measurements */
    struct session session;
};

/* What a call may do while others run: images are formed beside each other, delays at any time, all else alone. */
enum turn { TURN_NONE, TURN_BESIDE, TURN_ALONE };
/* Begin a call with the context's threads, wait for its turn; returns the caller's threads. An algorithm that is
   measured may call back in the same thread: that call has the turn of the outer one. */
int turn_begin(const struct sasbench *context, enum turn turn);
/* End it, keep a failure's message; returns `status`. */
int turn_end(int threads, enum status status);
/* Is this thread within another call? */
bool turn_is_inner(void);

/* Does single precision hold numbers whose largest part is this, with all digits of those 2^24 times smaller? */
bool single_holds(double largest);
/* Errors: STATUS_INVALID for an int that is no precision; where a number of the samples is not finite. */
enum status precision_check(int precision);
/* Errors: STATUS_INVALID where the scene is silent. */
enum status scene_check(const struct sasbench_scene *scene);
enum status samples_check(const struct acquisition *acquisition, enum precision precision, const void *samples);

#endif
