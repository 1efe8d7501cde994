/* One scene imaged in every rounding mode. Threads inherit the mode when they start, so each mode has a process of
   its own, which sets it first; a crash ends that process alone. The processes write into shared memory. */
#ifndef SASBENCH_STABILITY_TRIAL_H
#define SASBENCH_STABILITY_TRIAL_H

#include "imaging/spec.h"
#include "scene/scene.h"
#include "stability/exact_image.h"

enum { TRIAL_MODES = 4 };
extern const char *const trial_mode_names[TRIAL_MODES]; /* nearest, downward, upward, zero */

/* One SPEC in one mode. */
struct attempt {
    bool done;
    enum status status; /* of plan and execute */
    char message[400];  /* why status is not OK; or how the process ended */
    char engine[96];
    bool same_bits;  /* one and two threads made the same image */
    int exceptions;  /* FE_INVALID, FE_DIVBYZERO, FE_OVERFLOW that plan or execute raised, with one thread */
    bool is_stopped; /* a signal ended the process */
};

/* Results of the process of the echoes and of that of the exact images. */
struct trial_exact {
    enum status status;
    char message[400];
    int exponent; /* of the echoes: the recorded samples are these times 2^exponent */
};

/* Made by trial_run, released by trial_close. */
struct trial {
    const struct scene *scene; /* borrowed, like the specs */
    const struct spec *specs;
    int spec_count, mode_count;
    size_t pixels;
    void *memory; /* shared between processes; what follows points into it */
    size_t bytes;
    double complex *samples;    /* [pings][receivers][samples] */
    struct attempt *attempts;   /* [mode][spec] */
    double complex *images;     /* [mode][spec][pixels] */
    struct exact_sum *ideal;    /* [pixels] the right image */
    struct exact_sum *exact;    /* [spec][pixels] the method's own sum, where it has a reading */
    struct trial_exact *note;   /* of the processes that make the echoes and the exact images */
    const char *ideal_excludes; /* why there is no closed form; the ideal is then reference's image */
};

/* Echoes in one process, then images of all specs in the first `mode_count` modes, then the exact images. Errors:
   STATUS_FAILED without memory or processes, or where the echoes or the exact images fail; nothing to close then. */
enum status trial_run(const struct scene *scene, const struct spec *specs, int spec_count, int mode_count,
                      struct trial *trial);
void trial_close(struct trial *trial);

const struct attempt *trial_attempt(const struct trial *trial, int mode, int spec);
const double complex *trial_image(const struct trial *trial, int mode, int spec);

#endif
