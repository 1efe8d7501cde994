/* Work that may crash, in a process of its own: a crash of one algorithm ends its measurement, not the run. */
#ifndef SASBENCH_RUN_SUPERVISOR_H
#define SASBENCH_RUN_SUPERVISOR_H

/* Continue in a child process, before any thread is started. The parent waits. When a signal (also the system's for
   want of memory) or an exit ends the child within a task, the parent starts another child, which begins again from
   here and finds that task among the crashed ones. Otherwise the parent ends as the child did. Where no process can
   be started, the work is done unsupervised. The parents of several ranks hand out tasks meanwhile (ranks/ranks.h). */
void supervisor_begin(void);

/* The task from now on, one at a time, by a text that identifies it; and its end. */
void supervisor_enter(const char *task);
void supervisor_leave(void);

/* How this task's process ended, "ended by signal 11 (Segmentation fault)"; NULL if it did not crash. */
const char *supervisor_crash(const char *task);

/* The folder that keeps the measurements from now on: the parent names it where the work is interrupted. */
void supervisor_keeps(const char *folder);

#endif
