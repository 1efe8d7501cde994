/* The baseline: quality and work of a fast set of scenes and settings, the same on every machine. */
#ifndef SASBENCH_GATE_BASELINE_H
#define SASBENCH_GATE_BASELINE_H

#include "measure/outcome.h"
#include "results/results.h"

/* One row of quality and work, formed once and not timed, with numbers rounded to a tenth of what counts as a change.
   What fails or is unsupported becomes a row. Texts point to the session, the spec and `reason`. */
void baseline_row(struct session *session, const struct spec *spec, char *reason, size_t reason_size,
                  struct measurement *row);

/* Measure all scenes of the gate with all algorithms and some of their settings, and write the file. Errors: as
   scene_load, session_open, folder_take_around and measurements_write; nothing is then written. */
enum status baseline_write(const char *path);

/* The path of the reviewed one. */
#define BASELINE_PATH SASBENCH_ROOT "/results/baseline.csv"

#endif
