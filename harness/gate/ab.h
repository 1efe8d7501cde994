/* Two programs run side by side, to find whether the new one is slower: `compare --ab`. */
#ifndef SASBENCH_GATE_AB_H
#define SASBENCH_GATE_AB_H

#include "gate/diff.h"
#include "imaging/spec.h"

/* The effort. */
struct ab_effort {
    int rounds_least, rounds_step, rounds_most; /* both programs are started anew each round; compared after `least` and
                                                   then every `step` of them, while a finding is undecided */
    double budget_s;                            /* no round begins after this */
    double patience_s;                          /* a program that does not answer within this has failed */
};
extern const struct ab_effort ab_usual;

/* Run programs OLD and NEW (paths of two sasbench) on every scene (name or path) with every SPEC, or else on a default
   set, and add the findings: seconds of one execute on one thread, in all and of each stage that takes a fifth of it,
   compared by ab_interval_verdict. A SPEC that only one of the programs can plan is gone or new. Every round starts
   both anew, on one processor, and runs A B B A and B A A B in turn. Scenes outlive *diff. Errors: STATUS_INVALID
   naming the program, the question and the answer when one of them cannot be run, crashes, hangs, or gives a wrong
   answer (ab_process.h), for a scene that cannot be read, and when both can do nothing in common. No process is left.
   *diff is to be freed in any case. */
enum status ab_run(const char *old, const char *new, const char *const *scenes, int scene_count,
                   const struct spec *specs, int spec_count, const struct ab_effort *effort, struct diff *diff);

/* The other end, which ab_run starts in each program: answer requests of standard input on standard output until the
   input ends (ab_worker.c). Errors: STATUS_FAILED without memory. */
enum status ab_worker_serve(void);

#endif
