/* The worker that `compare --ab` starts in each of the two programs: requests and answers are in ab_worker.c. */
#ifndef SASBENCH_GATE_AB_WORKER_H
#define SASBENCH_GATE_AB_WORKER_H

#include "contract/status.h"

/* Answer requests of standard input on standard output until the input ends. Errors: STATUS_FAILED without memory. */
enum status ab_worker_serve(void);

#endif
