/* A results folder of its own for every test, and rows to put into it. */
#ifndef SASBENCH_TEST_RESULTS_FIXTURE_H
#define SASBENCH_TEST_RESULTS_FIXTURE_H

#include "results/results_folder.h"
#include "tests/assertions.h"

#define MEASUREMENT_COLUMNS                                                                                            \
    "scene,algorithm,options,precision,threads,engine,status,reason,skipped,plan_s,run_s,run_min_s,runs,control_s,"    \
    "stages,flops_published,flops,pairs,bytes,error,error_gain,phase_rms_rad,width_m,pslr_db,islr_db,"                 \
    "run_q1_s,run_q3_s,entropy,contrast,peak_over_median,host,load,error_flown"
#define MEASUREMENT_HEADER MEASUREMENT_COLUMNS "\n"

#define PROVENANCE "# machine: a machine\n# isa: v3\n# libraries: some\n# commit: c1\n# program: 0123\n# threads: 2\n"
#define TARGET_HEADER                                                                                                  \
    "scene,algorithm,options,precision,target,axis,definition,extent_m,position_error_m,phase_error_rad,width_m,"      \
    "pslr_db,islr_db\n"

extern char results_directory[256], measurements_path[300], targets_path[300];

/* Fixtures; the removal fails when a temporary file was left behind. */
int results_make(void **state);
int results_remove(void **state);
void file_write(const char *path, const char *mode, const char *text);
/* The whole file; valid until the next call. */
char *file_text(const char *path);
struct provenance provenance_of(const char *commit, int threads);
struct measurement measurement_of(const char *scene, const char *algorithm);
struct target_row target_of(const char *scene, const char *algorithm);
/* The folder of a program of this commit. */
struct results_folder *open_ok(const char *commit, int threads);
void add_ok(struct results_folder *results, const char *scene, const char *algorithm);
const struct measurement *find(const struct results_folder *results, const char *scene, const char *algorithm);
/* How many rows a file has. */
int rows_of(const char *path);

#endif
