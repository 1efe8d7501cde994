/* What is on its way to its place: files and folders made beside it, under names of one pattern that no user gives.
   They go when a signal ends the program, and what a killed one left is swept away by the next that works in the
   folder: each is locked by who makes it, until its process ends. */
#ifndef SASBENCH_FILES_TEMPORARY_H
#define SASBENCH_FILES_TEMPORARY_H

#include <signal.h>
#include <stdbool.h>
#include <sys/types.h>

enum { TEMPORARY_NAME = 24 };
/* An empty file open for writing, or an empty folder that nobody else may enter, in an open folder; `made` is its name
   there. Returns its descriptor, by which it is locked; -1: errno says why. Each is followed by temporary_moved or
   temporary_remove, until which `folder` stays open. */
int temporary_file(int folder, char made[TEMPORARY_NAME]);
int temporary_folder(int folder, char made[TEMPORARY_NAME]);
/* Whether what we make in a folder belongs to whom the folder belongs to. errno says why not. */
bool temporary_ours(int folder);
/* A file that will be made inside such a folder, of which this is the descriptor. */
void temporary_inside(int inside, const char *name);
/* It has its place now. */
void temporary_moved(int folder, const char *made);
/* `inside`: the descriptor of a folder, which is closed and removed with the files in it; -1 for a file. errno stays.
 */
void temporary_remove(int folder, const char *made, int inside);
/* What killed programs left. `ours`: the folder is ours alone (folder.h), also where a file system knows no locks. */
void temporary_sweep(int folder, bool ours);

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
