/* The ranks of one `mpirun`, which share the tasks of one command: cells of a run, or tiles of an image. Rank 0 hands
   out numbers, and nothing else is sent. Of each rank a child works, which may crash, and its parent sends and receives
   while it waits (run/supervisor.h): MPI knows the parents alone. Without MPI there is one rank, 0. */
#ifndef SASBENCH_RANKS_RANKS_H
#define SASBENCH_RANKS_RANKS_H

#include <stdbool.h>
#include <sys/types.h>

#include "contract/status.h"

/* How many processes did mpirun, or srun, begin together? From the environment; 1: by itself. */
int ranks_started(void);
/* Call it ahead of a refusal's message. Before they join, each finds the same fault: rank 0 shows it, and its end ends
   the others, which wait for that here. Returns true. */
bool ranks_refuse(void);
/* Join the others, once, ahead of the first child. Errors: STATUS_INVALID where this build is without MPI, and where
   the ranks run different programs, numbers of threads, or kinds of machine, whose times are not compared. */
enum status ranks_begin(void);
/* The ranks that joined, and this one's number among them, from 0; 1 and 0 for a process by itself. */
int ranks_count(void);
int ranks_number(void);

/* ---- The parent ---- */

/* Ahead of each child: a channel to it. False: the system has none. */
bool ranks_prepare(void);
/* waitpid of the child; hands out meanwhile. */
pid_t ranks_wait(pid_t child, int *state);
/* The child ended for good: end with the others, or end them where its exit status is not 0. */
void ranks_end(int status);

/* ---- The child ---- */

/* Does it follow one that crashed? */
bool ranks_again(void);
/* Rank 0: the tasks that are to be done, in the order in which they are handed out. Of neighbours, which read much the
   same, each rank is given a stretch instead. Until then others wait for one. What a child that follows a crashed one
   offers is ignored. */
void ranks_offer(int count, const int *tasks, bool neighbours);
/* Others: wait until rank 0 has offered tasks; what it prepares is then there. */
void ranks_meet(void);
/* The next task; -1: none is left. To a child that follows a crashed one all that the rank has are handed out again. */
int ranks_next(void);
/* Rank 0: wait until the children of all others have ended well. */
void ranks_join(void);

#endif
