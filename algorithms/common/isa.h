/* Which of the builds of a vectorised file this machine runs. */
#ifndef SASBENCH_COMMON_ISA_H
#define SASBENCH_COMMON_ISA_H

#include "contract/status.h"

enum isa { ISA_BASELINE, ISA_V3, ISA_V4 };

/* The best instruction set of this processor; the environment variable SASBENCH_ISA=baseline|v3|v4 lowers it (a higher
   one changes nothing). */
enum isa isa_choose(void);
/* Errors: STATUS_INVALID where SASBENCH_ISA is set to anything else. */
enum status isa_check(void);
const char *isa_name(enum isa isa);

#endif
