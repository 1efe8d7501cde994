/* A results folder: measurements.csv and targets.csv, written row by row and continued after an interruption. */
#ifndef SASBENCH_RESULTS_RESULTS_FOLDER_H
#define SASBENCH_RESULTS_RESULTS_FOLDER_H

#include "results/provenance.h"
#include "results/results.h"

struct results_folder;
/* Make the folder, lock it (folder.h) until results_folder_close and open its two files. Rows left by an earlier run
   are kept when machine, instruction set, libraries, commit, program and threads are the same; otherwise the files
   are begun anew, and old ones with rows are kept beside them as measurements.N.csv and targets.N.csv, which is
   reported on standard error. An incomplete last line is dropped. Errors: STATUS_INVALID for a place that cannot be
   written, a folder that another program uses, or a CSV that is not ours (naming file and line). */
enum status results_folder_open(const char *directory, const struct provenance *provenance,
                                struct results_folder **folder);
/* Declare a scene before its rows. Rows from other content (hash) of the same name are dropped; the old files are
   kept and reported as above. */
enum status results_folder_scene(struct results_folder *folder, const char *scene, uint64_t hash);
/* The same of an algorithm from outside the program, by its origin: a rebuilt plug-in is measured anew. */
enum status results_folder_algorithm(struct results_folder *folder, const char *algorithm, const char *origin);
/* The finished row of an earlier run, or NULL; belongs to the folder, valid until results_folder_close. A failed row
   is not finished: the new row replaces it. */
const struct measurement *results_folder_find(const struct results_folder *folder, const char *scene,
                                              const char *algorithm, const char *options, const char *precision);
/* Append, onto the disk. A measurement's target rows are added before the measurement itself, so a measurement in
   the file is complete; it gets this host's name and load. The next run drops target rows without their measurement.
   Errors: STATUS_FAILED. */
enum status results_folder_targets(struct results_folder *folder, const struct target_row *rows, int count);
enum status results_folder_add(struct results_folder *folder, const struct measurement *row);
/* Errors: STATUS_FAILED for a file that cannot be closed. Accepts NULL. */
enum status results_folder_close(struct results_folder *folder);

#endif
