/* One algorithm at work on one problem: images are formed here alone, by plan, execute, a check of the result and
   destroy. */
#ifndef SASBENCH_IMAGING_IMAGING_H
#define SASBENCH_IMAGING_IMAGING_H

#include "imaging/spec.h"

/* Made by imaging_open, released by imaging_close, which accepts a zeroed struct. */
struct imaging {
    const struct algorithm *algorithm;
    void *plan;
    double plan_s;      /* s, what the plan took */
    struct grid part;   /* of a problem's window */
    struct image image; /* of the problem's patches, or of `part`, and of its precision */
    int fenced;         /* of its patches, those with bytes beside them that a guest may not touch */
};

/* Allocate the image, then plan. Spec, problem's patches and acquisition outlive the imaging. Errors: STATUS_FAILED
   when the image does not fit into memory, with the figure and before anything is planned; what plan returns. Nothing
   to close then. */
enum status imaging_open(const struct spec *spec, const struct problem *problem, struct imaging *imaging);

/* Set read[pings] where execute reads a ping's records. */
void imaging_reads(const struct imaging *imaging, const struct problem *problem, bool *read);

/* Execute once, and nothing else: what is timed. Errors: what execute returns. */
enum status imaging_execute(struct imaging *imaging, const struct echoes *echoes, struct stages *stages);
/* Was the memory beside a guest's image left alone? */
bool imaging_is_fenced(const struct imaging *imaging);

/* The finished image: checked, scaled by the echoes' exponent, handed over to the caller, who frees it with image_free;
   the imaging keeps none. Of a window, image->patches points into the imaging. Errors: STATUS_FAILED when a pixel is
   not finite, a guest wrote outside the image, or memory is missing, STATUS_INVALID when the scaled image is beyond the
   range of double; *image is then empty. */
enum status imaging_finish(struct imaging *imaging, const struct echoes *echoes, struct image *image);

/* Multiply a finished image by 2^exponent, exactly. Errors: STATUS_FAILED without memory, STATUS_INVALID when the image
   is then beyond the range of double; *image is then empty. `name`: the algorithm's. */
enum status imaging_scale(const char *name, int exponent, struct image *image);

void imaging_close(struct imaging *imaging);

/* Plan, execute and finish. *work (may be NULL) is the plan's. Errors: as above; *image is then empty. */
enum status imaging_form(const struct spec *spec, const struct problem *problem, const struct echoes *echoes,
                         struct image *image, struct work *work);

/* What an algorithm with these options may say of its work on a problem: all pairs (pairs_count; within its setting
   `aperture`, if it has one) or none, and FLOPs from least to most, the most for ordinary scenes: images of few pixels
   may take more, and timing then asks what processors can do in the time. */
struct work_bounds {
    double pairs, flops_least, flops_most;
};
struct work_bounds work_bounds(const struct algorithm *algorithm, const void *options, const struct problem *problem,
                               const struct work *work);
/* Is the work within its bounds? Empty counts (NAN, of external programs) pass. Errors: STATUS_FAILED naming the
   count. */
enum status work_check(const char *name, const struct work_bounds *bounds, const struct work *work);

#endif
