/* A results folder: measurements.csv and targets.csv, written row by row and taken up again after a cut. */
#ifndef SASBENCH_RESULTS_RESULTS_FOLDER_H
#define SASBENCH_RESULTS_RESULTS_FOLDER_H

#include "results/provenance.h"
#include "results/results.h"

struct results_folder;
/* Make the folder and take it (folder.h) until results_folder_close; open its two files. Rows left by an earlier run
   are kept when machine, instruction set, libraries, commit, program and threads are the same; otherwise the files are
   begun anew, and the old ones, where they have rows, are kept beside them as measurements.N.csv and targets.N.csv,
   which is said on standard error. A last line that was cut short is dropped. Errors: STATUS_INVALID for a place that
   cannot be written, a folder that another program works in, or a CSV that is not ours (naming file and line). */
enum status results_folder_open(const char *directory, const struct provenance *provenance,
                                struct results_folder **folder);
/* Declare a scene before its rows. Rows kept from other content (hash) of the same name are dropped, and the old files
   kept and reported as above. */
enum status results_folder_scene(struct results_folder *folder, const char *scene, uint64_t hash);
/* The finished row of an earlier run, or NULL; belongs to the folder, valid until results_folder_close. One that failed
   is not finished: it gives way to the row that is added in its place. */
const struct measurement *results_folder_find(const struct results_folder *folder, const char *scene,
                                              const char *algorithm, const char *options, const char *precision);
/* Append, onto the disk. The rows of a measurement's targets are added before the measurement itself: when that is
   there, all of it is. Target rows without their measurement are dropped by the next run. Errors: STATUS_FAILED. */
enum status results_folder_targets(struct results_folder *folder, const struct target_row *rows, int count);
enum status results_folder_add(struct results_folder *folder, const struct measurement *row);
/* Errors: STATUS_FAILED for a file that cannot be closed. Accepts NULL. */
enum status results_folder_close(struct results_folder *folder);

#endif
