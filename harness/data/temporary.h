/* What is on its way to its place: files and folders made beside it, under names of one pattern that no user gives.
   They go when a signal ends the program, and what a killed one left is swept away by the next that works in the
   folder. */
#ifndef SASBENCH_DATA_TEMPORARY_H
#define SASBENCH_DATA_TEMPORARY_H

#include <limits.h>
#include <signal.h>
#include <stdbool.h>
#include <sys/types.h>

/* An empty file open for writing, or an empty folder, beside `path`; `made` is its own path. -1 or false: errno says
   why. Each is followed by temporary_moved or temporary_remove. */
int temporary_file(const char *path, char made[PATH_MAX]);
bool temporary_folder(const char *path, char made[PATH_MAX]);
/* A file that will be made inside such a folder. */
void temporary_inside(const char *path);
/* It has its place now. */
void temporary_moved(const char *made);
/* A folder with the files in it; errno stays. */
void temporary_remove(const char *made);
/* What killed programs left in a folder that is ours alone (folder.h). */
void temporary_sweep(const char *directory);

/* Between these two no signal ends the program: what is made there is known when one does. `before` is the thread's
   signal mask. */
void temporary_hold(sigset_t *before);
void temporary_release(const sigset_t *before);
/* A process group that a signal ends together with the program, until it is dropped; of up to PROCESSES_MOST. */
enum { PROCESSES_MOST = 16 };
void temporary_process_add(pid_t group);
void temporary_process_drop(pid_t group);
/* From now on, signals that end the program remove first what is on its way. One that is ignored stays so. To be called
   by the thread that makes temporary files, the only one that does. */
void temporary_guard(void);

#endif
