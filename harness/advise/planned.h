/* A plan in words: the chosen setting, the reasons, and what it leaves out (choice/choice.h). */
#ifndef SASBENCH_ADVISE_PLANNED_H
#define SASBENCH_ADVISE_PLANNED_H

#include <stdio.h>

#include "choice/choice.h"
#include "scene/scene.h"

/* The choice in float, and in double. */
struct planned {
    const struct scene *scene;
    struct budget budget;
    bool measured;            /* else by laws alone, for there are too many echoes */
    struct choice choices[2]; /* by enum precision */
};

/* Plan a scene by images of its echoes that take at most `budget->seconds` each, and by laws beyond that. Where float
   is within the budget, double is planned if `both` are wanted, by laws alone. planned_free is due even on failure.
   Errors: as choice_make. */
enum status planned_make(const struct scene *scene, const struct budget *budget, bool both, struct planned *planned);
void planned_free(struct planned *planned);
/* The chosen precision: float, unless only double is within the budget; -1 where neither is. */
int planned_precision(const struct planned *planned);

extern const char *const plan_verdict_names[]; /* by enum verdict */
/* Is candidate k, over the budget or refused, the best of an algorithm that has none within the budget? */
bool planned_nearest(const struct choice *choice, int k);
/* A line for each thing that the chosen setting leaves out, with what it adds to the error. */
void planned_left_out(const struct problem *problem, const struct candidate *chosen,
                      void (*line)(void *to, const char *text), void *to);

/* Print the choice, the command that runs it on a `source` ("--scene NAME"), and why: the next of each family. */
void planned_answer(FILE *stream, const struct planned *planned, const char *source);
/* Print the candidates of the chosen precision, the chosen one first, and what it leaves out. */
void planned_print(FILE *stream, const struct planned *planned);
/* Write the candidates of both precisions as CSV. */
void planned_write(FILE *stream, const struct planned *planned);

#endif
