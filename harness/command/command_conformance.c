/* The command `conformance`: every promise of one algorithm. */
#include "command/task.h"
#include "conformance/conformance.h"
#include "guests/guests.h"

enum status command_conformance(const struct task *task)
{
    struct spec spec;
    const char *rest;
    enum status status = guest_invite(task->names[0]);
    const struct algorithm *named = guest_find(task->names[0], &rest);
    if (status == STATUS_OK && named && named->filter)
        status = status_set(STATUS_INVALID, "conformance: %s is a filter; accepted: an algorithm", named->name);
    if (status == STATUS_OK)
        status = spec_asked(task->names[0], &spec);
    if (status != STATUS_OK)
        return status;
    if (!spec.algorithm->plan)
        status =
            status_set(STATUS_INVALID, "conformance: %s chooses among the algorithms, which are checked one by one",
                       spec.algorithm->name);
    else if (spec.algorithm->traits & TRAIT_FILTERED)
        status = status_set(STATUS_INVALID, "conformance: filters form another image; accepted: one algorithm alone");
    else if (conformance_run(&spec, stdout, NULL, 0) > 0)
        status = status_set(STATUS_FAILED, "%s breaks promises: see BROKEN above", task->names[0]);
    spec_free(&spec);
    return status;
}
