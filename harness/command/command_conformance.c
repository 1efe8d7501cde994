/* The command `conformance`: every promise of one algorithm. */
#include "command/task.h"
#include "conformance/conformance.h"

enum status command_conformance(const struct task *task)
{
    struct spec spec;
    printf("%s\n", task->names[0]); /* a plug-in may crash where it is loaded */
    fflush(stdout);
    enum status status = spec_asked(task->names[0], &spec);
    if (status != STATUS_OK)
        return status;
    if (!spec.algorithm->plan)
        status =
            status_set(STATUS_INVALID, "conformance: %s chooses among the algorithms, which are checked one by one",
                       spec.algorithm->name);
    else if (spec.algorithm->traits & TRAIT_FILTERED)
        status = status_set(STATUS_INVALID, "conformance: filters form another image; must be one algorithm alone");
    else if (conformance_run(&spec, stdout, NULL, 0) > 0)
        status = status_set(STATUS_FAILED, "%s breaks promises: see BROKEN above", task->names[0]);
    spec_free(&spec);
    return status;
}
