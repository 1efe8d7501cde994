/* The choice among the builds of a vectorised file on this machine. */
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

/* For a function that is built for each precision and instruction set: its declarations, and its build of a precision
   for this machine. */
#define ISA_DECLARE(type, name)                                                                                        \
    type name##_float_baseline, name##_double_baseline, name##_float_v3, name##_double_v3, name##_float_v4,            \
        name##_double_v4
#define ISA_CHOOSE(name, precision)                                                                                    \
    (((__typeof__(&name##_float_baseline)[][2]){ISA_PAIR(name, baseline) ISA_X86(name)})[isa_choose()][precision])
#define ISA_PAIR(name, isa) {name##_float_##isa, name##_double_##isa},
#ifdef SASBENCH_X86_64
#define ISA_X86(name) ISA_PAIR(name, v3) ISA_PAIR(name, v4)
#else
#define ISA_X86(name)
#endif

#endif
