/* One scene of a batch while its algorithms are measured and drawn; a crashed task is not begun again
   (supervisor.h). */
#ifndef SASBENCH_RUN_VISIT_H
#define SASBENCH_RUN_VISIT_H

#include "run/batch.h"
#include "show/pictures.h"

struct visit {
    struct session session;
    const struct spec *specs;
    int spec_count;
    struct pictures pictures;       /* all zero when none are drawn */
    struct timing_samples *samples; /* [TURNS] of the settings from turns_first on; NULL: each is timed at once */
    int turns_first;
};
enum { TURNS = 24 }; /* settings that are timed in turn */

/* Make echoes and exact image. On failure the visit is closed. */
enum status visit_open(struct batch *batch, const struct scene *scene, int spec_count, const struct spec *specs,
                       struct visit *visit);
void visit_close(struct visit *visit);

/* Measure one algorithm, record and draw it. Only a fault of the record itself is an error: a failure or a refusal
   becomes a row. */
enum status visit_measure(struct batch *batch, struct visit *visit, int index);
/* All rounds but the last, of the settings from `first` on that are to be measured; visit_measure adds the last. */
void visit_turns(struct batch *batch, struct visit *visit, int first);
/* Draw a row that an earlier run finished. It is not timed again; its image is formed for the overlaid slices.
   Pictures that cannot be drawn are reported and stop nothing. */
void visit_redraw(struct visit *visit, int index, const struct measurement *row);
/* Is an image, or are the slices, of finished rows still to be drawn? */
bool visit_pictures_missing(const struct batch *batch, const struct scene *scene, int spec_count,
                            const struct spec *specs);
/* The row of a failed measurement. */
struct measurement visit_failed_row(const struct batch *batch, const struct scene *scene, const struct spec *spec,
                                    const char *reason);

#endif
