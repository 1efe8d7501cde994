#include "common/isa.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const char *const names[] = {"baseline", "v3", "v4"};

const char *isa_name(enum isa isa)
{
    return names[isa];
}

enum isa isa_choose(void)
{
    enum isa best = ISA_BASELINE;
#ifdef SASBENCH_X86_64
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        best = ISA_V3;
    if (best == ISA_V3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw")
        && __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq")
        && __builtin_cpu_supports("avx512vl"))
        best = ISA_V4;
#endif
    const char *wanted = getenv("SASBENCH_ISA");
    for (enum isa isa = ISA_BASELINE; wanted && isa < best; isa++)
        if (strcmp(wanted, names[isa]) == 0)
            return isa;
    return best;
}

enum status isa_check(void)
{
    const char *wanted = getenv("SASBENCH_ISA");
    bool known = !wanted || !*wanted;
    for (size_t k = 0; !known && k < sizeof names / sizeof *names; k++)
        known = strcmp(wanted, names[k]) == 0;
    return known ? STATUS_OK
                 : status_set(STATUS_INVALID, "SASBENCH_ISA=%s: accepted are baseline, v3 and v4, or to leave it unset",
                              wanted);
}
