/* A signal that asks to end, held until what is measured can be written down; one that comes more than a second
   after it ends at once. */
#ifndef SASBENCH_RUN_INTERRUPTION_H
#define SASBENCH_RUN_INTERRUPTION_H

#include <stdbool.h>

/* From now on SIGINT and SIGTERM are only noted, but where they are ignored. */
void interruption_hold(void);
bool interruption_seen(void);
/* End by the signal that was noted, as the program would have; returns where there was none, and holds no more. */
void interruption_end(void);

#endif
