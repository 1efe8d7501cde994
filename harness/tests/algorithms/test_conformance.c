/* Every registered algorithm through every promise (conformance.h). */
#include "tests/algorithms/conformance.h"

int main(void)
{
    int failed = 0;
    for (int k = 0; algorithms[k]; k++)
        failed += conformance_run(algorithms[k]);
    return failed;
}
