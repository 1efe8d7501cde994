/* The baseline: quality and work of a fast set of scenes and settings, the same on every machine. */
#ifndef SASBENCH_GATE_BASELINE_H
#define SASBENCH_GATE_BASELINE_H

#include "measure/outcome.h"
#include "results/results.h"

/* One row of quality and work, formed once and not timed, with numbers rounded to a tenth of what counts as a change.
   What fails or is unsupported becomes a row. Texts point to the session, the spec and `reason`. */
void baseline_row(struct session *session, const struct spec *spec, char *reason, size_t reason_size,
                  struct measurement *row);

/* Can the rows be an algorithm's baseline? Errors: STATUS_FAILED naming the row that failed, or whose error is above
   BASELINE_ERROR (without TRAIT_AREA), or the first reason where no scene is imaged. */
#define BASELINE_ERROR 0.5
enum status baseline_accept(const struct algorithm *algorithm, const struct measurement *rows, int count);

/* Measure all scenes of scenes/gate with all algorithms and the settings that they name, and write the file. Errors: as
   scene_load, session_open, folder_take_around, baseline_accept and measurements_write; nothing is then written. */
enum status baseline_write(const char *path);

#endif
