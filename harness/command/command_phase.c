/* The command `phase`: phase errors of the two-dimensional spectra, of a scene's array or at given points. */
#include "papers/phase.h"

#include "command/task.h"

enum status command_phase(const struct task *task)
{
    if (task->at && (task->name_count || task->output))
        return status_set(STATUS_INVALID,
                          "phase: --at %s prints to standard output; neither a scene nor -o is "
                          "accepted",
                          task->at);
    if (task->at)
        return phase_points_print(task->at);
    const char *directory = task->output ? task->output : "results/phase";
    return task->name_count ? phase_scene_study(task->names[0], directory, false) : phase_study(directory, false);
}
