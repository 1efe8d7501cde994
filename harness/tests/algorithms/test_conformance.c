/* Every registered algorithm through every promise (conformance.h). */
#include "tests/algorithms/conformance.h"

int main(void)
{
    int failed = 0;
    for (int k = 0; algorithms[k]; k++)
        if (algorithms[k]->plan) /* else a choice among the others */
            failed += conformance_run(algorithms[k]);
    return failed;
}
