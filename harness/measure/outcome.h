/* One algorithm on one scene: image, work, quality and, when wanted, times, as a row of measurements.csv. */
#ifndef SASBENCH_MEASURE_OUTCOME_H
#define SASBENCH_MEASURE_OUTCOME_H

#include "measure/session.h"
#include "measure/timing.h"

/* Begins a warning in the reason of a row with status ok. */
#define OUTCOME_WARNING "warning: "

/* The warning of a noisy time, the last of a reason. */
#define OUTCOME_NOISE OUTCOME_WARNING "times scatter"

/* The reason of a row whose scene has no points to measure. */
#define OUTCOME_NO_TARGETS "no point targets to measure lobes of"

/* Made by outcome_measure, released by outcome_free. Texts of the rows point into it, the session and the SPEC: do
   not copy it. */
struct outcome {
    struct measurement row;
    struct image image; /* finished; empty unless the row's status is ok */
    struct work work;   /* of the plan */
    int target_count;   /* rows, several for each point target */
    struct target_row *targets;
    char reason[2400], skipped[400], stages[512], noise[300];
};

/* "warning: condition NAME: MEANING is VALUE, limit LIMIT (cure: CURE)". */
void outcome_warning(const struct condition *condition, char *text, size_t size);

/* Measure a SPEC on a session's scene. It returns no error: a failure or a refusal becomes a row with the reason.
   Timed as timing.h describes; `samples` are those of the earlier rounds, or NULL. With EFFORT_NONE the image is
   formed once and the row has no times. */
void outcome_measure(struct session *session, const struct spec *spec, enum effort effort,
                     struct timing_samples *samples, struct outcome *outcome);
/* One of the earlier rounds: times alone. A failure appears again in outcome_measure. */
void outcome_round(struct session *session, const struct spec *spec, struct timing_samples *samples);
/* The row of an image that another program formed, with `image` as its engine: the outcome takes the image over.
   `seconds` is its stated time, NAN for none. Errors: STATUS_FAILED without memory; nothing to free then. */
enum status outcome_score(struct session *session, const char *name, struct image *image, double seconds,
                          struct outcome *outcome);
void outcome_free(struct outcome *outcome);

#endif
