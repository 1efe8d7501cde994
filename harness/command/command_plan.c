/* The command `plan`: the least work for an error budget, before any imaging. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "command/plan_tiles.h"
#include "command/task.h"
#include "text/number.h"
#include "text/shown_text.h"
#include "text/text_append.h"
#include "show/table.h"
#include "files/text_file.h"
#include "run/batch.h"
#include "advise/check.h"
#include "advise/machine_rates.h"
#include "advise/planned.h"

/* The file that a scene's echoes are to be written to, where the image is formed in tiles. */
#define TILED_ECHOES "echoes.mat"

static enum status error_parse(const char *text, double *error)
{
    const char *end = text ? number_read(text, error) : "";
    if (!text)
        *error = 1e-3;
    return end && !*end && *error > 0 && *error <= 1
               ? STATUS_OK
               : status_set(STATUS_INVALID, "plan: --error is '%s', must be a number above 0, at most 1", text);
}

static enum status nodes_parse(const char *text, int *nodes)
{
    enum { MOST = 100000 };
    long long number = 0;
    const char *end = text ? whole_read(text, 1, MOST, &number) : "";
    *nodes = (int)number;
    return end && !*end
               ? STATUS_OK
               : status_set(STATUS_INVALID, "plan: --nodes is '%s', must be a whole number from 1 to %d", text, MOST);
}

/* As options of `image`, to be taken from the terminal. Tiles are formed of an echo file. */
static void source_format(const struct task *task, bool tiled, char *text, size_t size)
{
    snprintf(text, size, "--%s ", task->echoes || tiled ? "echoes" : "scene");
    text_append_word(text, size, task->echoes ? task->echoes : tiled ? TILED_ECHOES : task->names[0]);
    if (task->echoes && task->grid)
        text_append(text, size, " --grid=%s", task->grid);
    if (tiled)
        text_append(text, size, " --memory %s", task->memory);
    shown_make(text);
}

static enum status answer_print(const struct task *task, const struct scene *scene, const struct planned *planned,
                                const struct tiled *tiled, int nodes)
{
    char source[8400];
    const bool found = planned_precision(planned) >= 0, in_tiles = tiled->tiles.columns > 0;
    source_format(task, in_tiles, source, sizeof source);
    planned_answer(stdout, planned, source);
    if (found && in_tiles)
        tiles_print(scene, tiled);
    if (found && in_tiles && !task->echoes)
        printf("Its echoes are written by `simulate` to %s.\n", TILED_ECHOES);
    return found && nodes > 0 ? nodes_print(nodes, scene, planned, tiled) : STATUS_OK;
}

static enum status plan_scene(const struct task *task, const struct scene *scene, const struct budget *budget,
                              int nodes)
{
    struct planned planned;
    struct tiled tiled;
    struct text_file file;
    table_begin(stdout, false);
    enum status status = plan_make(scene, budget, task->output, &planned, &tiled);
    if (status == STATUS_OK)
        status = answer_print(task, scene, &planned, &tiled, nodes);
    check_warnings(stdout, scene, false);
    if (status == STATUS_OK && task->all)
        planned_print(stdout, &planned);
    else if (status == STATUS_OK)
        puts("--all: every candidate, and what the choice leaves out");
    if (status == STATUS_OK && task->output)
        status = text_file_open_named(task->output, &file);
    if (status == STATUS_OK && task->output) {
        planned_write(file.stream, &planned);
        status = text_file_close(&file, STATUS_OK);
    }
    if (status == STATUS_OK && planned_precision(&planned) < 0)
        status =
            status_set(STATUS_FAILED,
                       "plan: nothing images %s within an error of %.3g and %.6g MB; the least predicted is %.3g (the "
                       "exact image is `reference` with precision=double)",
                       scene->name, budget->error, budget->bytes / 1e6, planned.choices[PRECISION_DOUBLE].least);
    planned_free(&planned);
    return status;
}

/* --time in place of --error: the least budget whose choice takes no longer, to a quarter. */
static enum status time_search(const char *text, const struct scene *scene, struct budget *budget)
{
    double seconds, low = -7, high = 0.1; /* powers of ten */
    const char *end = number_read(text, &seconds);
    if (!(end && !*end && seconds > 0))
        return status_set(STATUS_INVALID, "plan: --time is '%s', must be a number of seconds above 0", text);
    while (high - low > 0.1) {
        struct planned planned;
        struct tiled tiled;
        const double middle = (low + high) / 2;
        const struct budget tried = {.error = pow(10, middle), .bytes = budget->bytes, .seconds = budget->seconds};
        const enum status status = plan_make(scene, &tried, false, &planned, &tiled);
        if (status != STATUS_OK)
            return status;
        const int precision = planned_precision(&planned);
        const bool fits = precision >= 0 && planned.choices[precision].list[0].seconds <= seconds;
        *(fits ? &high : &low) = middle;
        planned_free(&planned);
    }
    budget->error = pow(10, high);
    return budget->error <= 1 ? STATUS_OK
                              : status_set(STATUS_FAILED, "plan: nothing images %s in %g s and %.6g MB", scene->name,
                                           seconds, budget->bytes / 1e6);
}

/* The scene; echoes that are beyond the memory stay in their file. */
static enum status scene_take(const struct task *task, const struct budget *budget, struct scene **scene, int *count)
{
    struct task whole = *task;
    whole.memory = NULL;
    enum status status = task_scenes("plan", task, 0, NULL, scene, count);
    if (status != STATUS_OK || !task->echoes || plan_is_tiled(&(*scene)[0], budget->bytes))
        return status;
    scenes_free(*scene, *count);
    return task_scenes("plan", &whole, 0, NULL, scene, count);
}

enum status command_plan(const struct task *given)
{
    struct task with = *given, *task = &with;
    struct scene *scene = NULL;
    struct budget budget = {.seconds = 0.5, .all = true};
    int count = 0, nodes = 0;
    if (!task->name_count && !task->echoes)
        return status_set(STATUS_INVALID, "plan: a SCENE, or --echoes FILE.mat, is missing");
    if (task->error && task->time)
        return status_set(STATUS_INVALID, "plan: one of --error and --time is needed, not both");
    with.memory = given->memory ? given->memory : "4G";
    enum status status = error_parse(task->error, &budget.error);
    if (status == STATUS_OK)
        status = memory_parse("plan", task->memory, &budget.bytes);
    if (status == STATUS_OK)
        status = nodes_parse(task->nodes, &nodes);
    if (status == STATUS_OK)
        status = scene_take(task, &budget, &scene, &count);
    if (status == STATUS_OK)
        status = machine_rates_need();
    if (status == STATUS_OK && task->time)
        status = time_search(task->time, &scene[0], &budget);
    if (status == STATUS_OK)
        status = plan_scene(task, &scene[0], &budget, nodes);
    scenes_free(scene, count);
    return status;
}
