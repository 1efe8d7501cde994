/* Work that may crash, in a process of its own: what one algorithm does wrong ends its own measurement, not the run. */
#ifndef SASBENCH_RUN_SUPERVISOR_H
#define SASBENCH_RUN_SUPERVISOR_H

/* Go on in a child process, before any thread is started. The parent waits. When a signal (also the system's for want
   of memory) or an exit ends the child amid a task, it starts another, which begins again from here and finds that task
   among the crashed ones; otherwise the parent ends as the child did. Where no process can be started, the work is done
   unsupervised. */
void supervisor_begin(void);

/* What is done from now on, one task at a time, in words that tell it from all others; and its end. */
void supervisor_enter(const char *task);
void supervisor_leave(void);

/* How the process ended that did this task, "ended by signal 11 (Segmentation fault)"; NULL if none did. */
const char *supervisor_crash(const char *task);

/* What is measured from now on is kept in this folder: where the work is interrupted, the parent says so. */
void supervisor_keeps(const char *folder);

#endif
