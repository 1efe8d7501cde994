/* Every registered algorithm through every promise (conformance.h). */
#include "tests/algorithms/conformance_counted.h"

int main(void)
{
    int broken = 0;
    for (int k = 0; algorithms[k]; k++)
        if (algorithms[k]->plan) /* else a choice among the others */
            broken += conformance_counted(algorithms[k]->name);
    return broken > 0;
}
