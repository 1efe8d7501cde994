/* Two programs side by side (ab.h): rounds of questions to both, and verdicts from their times. */
#include "gate/ab.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "gate/ab_interval.h"
#include "gate/ab_process.h"
#include "scene/scene.h"
#include "measure/outcome.h"
#include "show/table.h"
#include "files/paths.h"
#include "run/progress_line.h"
#include "measure/timing.h"

/* 8 rounds decide between identical programs on a quiet machine. */
const struct ab_effort ab_usual = {8, 4, 64, 240, 600};

/* The default set: small, yet every stage of back projection and range migration holds much of the time somewhere. */
static const struct {
    const char *scene;
    const char *specs[8]; /* none: every algorithm */
} usual[] = {
    {"gate/points", {NULL}},                                            /* raw echoes, few pixels */
    {"gate/blocks", {"bp_nearest", "bp_linear", "bp_sinc", "rma_lbf"}}, /* many pixels, many sub-blocks */
};
enum { USUAL = sizeof usual / sizeof *usual };

#define ERROR_PROBABILITY 0.05      /* of any false finding in all of one comparison */
#define STAGE_LEAST       0.2       /* of the time: smaller stages are not compared alone */
static const double slot_s = 0.005; /* that one question is to take, by repetition */
enum { PARTS_MOST = 13, ROUNDS_MOST = 64 };

/* Seconds of one execute in one block of a round: the mean of the two runs of each program. */
struct sample {
    double seconds[2][PARTS_MOST]; /* by program and part; 0: no such part */
};

/* One scene with one SPEC. Part 0 is the total, the others are stages by name. */
struct unit {
    const char *scene, *spec; /* as they are shown */
    const char *question;     /* "plan SPEC SCENE" */
    bool skipped, decided;
    int plans[2]; /* this round's number of the unit, by program */
    int rounds, part_count;
    char parts[PARTS_MOST][40];
    struct sample samples[ROUNDS_MOST * AB_BLOCKS];
};

struct contest {
    const char *paths[2];
    struct ab_process processes[2];
    struct diff *diff;
    int unit_count;
    struct unit *units;
};

/* --- Rounds --------------------------------------------------------------------------------------------------- */

static enum status answer_wrong(const struct ab_process *process, const char *question, const char *answer,
                                const char *needed)
{
    return status_set(STATUS_INVALID, "%s %s answers '%.100s' to '%.100s'; %s is needed", process->role, process->path,
                      answer, question, needed);
}

/* In the first round, a unit that only one program can plan is a finding; later rounds leave it out. */
static enum status unit_plan(struct contest *contest, struct unit *unit, bool first)
{
    static const char refused[] = "refused ";
    char answers[2][600];
    unsigned long long hashes[2] = {0, 0};
    bool can[2];
    for (int k = 0; k < 2; k++) {
        struct ab_process *process = &contest->processes[k];
        enum status status = ab_process_ask(process, unit->question, answers[k], sizeof answers[k]);
        if (status != STATUS_OK)
            return status;
        can[k] = sscanf(answers[k], "planned %d %llx", &unit->plans[k], &hashes[k]) == 2;
        if (!can[k] && (!first || strncmp(answers[k], refused, strlen(refused)) != 0))
            return answer_wrong(process, unit->question, answers[k], "'planned JOB HASH'");
    }
    if (can[0] && can[1] && hashes[0] != hashes[1])
        return status_set(STATUS_INVALID,
                          "scene %s: OLD and NEW read it differently, so that their times are not "
                          "comparable",
                          unit->scene);
    if (can[0] && can[1])
        return STATUS_OK;
    unit->skipped = true;
    if (!can[0] && !can[1])
        return diff_note(contest->diff, "%s with %s is left out: %s", unit->scene, unit->spec,
                         answers[1] + strlen(refused));
    return diff_add(contest->diff, &(struct finding){.verdict = can[0] ? VERDICT_GONE : VERDICT_NEW,
                                                     .class = CLASS_TIME,
                                                     .scene = unit->scene,
                                                     .spec = unit->spec,
                                                     .detail = "",
                                                     .metric = "time",
                                                     .unit = "s",
                                                     .before = NAN,
                                                     .after = NAN,
                                                     .change = NAN,
                                                     .slack = NAN,
                                                     .before_text = can[0] ? "planned" : "refused",
                                                     .after_text = can[1] ? "planned" : "refused"});
}

static int part_index(struct unit *unit, const char *name, size_t length)
{
    for (int k = 0; k < unit->part_count; k++)
        if (strlen(unit->parts[k]) == length && strncmp(unit->parts[k], name, length) == 0)
            return k;
    if (unit->part_count == PARTS_MOST || length == 0 || length >= sizeof unit->parts[0])
        return -1;
    snprintf(unit->parts[unit->part_count], sizeof unit->parts[0], "%.*s", (int)length, name);
    return unit->part_count++;
}

/* "took SECONDS STAGE=SECONDS;..." is added to seconds[parts]. */
static bool times_read(struct unit *unit, const char *answer, double *seconds)
{
    static const char took[] = "took ";
    double total;
    int used = 0;
    if (strncmp(answer, took, strlen(took)) != 0 || sscanf(answer + strlen(took), "%lf%n", &total, &used) != 1
        || !(total > 0 && total < DBL_MAX))
        return false;
    seconds[part_index(unit, "total", strlen("total"))] += total;
    for (const char *at = answer + strlen(took) + used; *at == ' ' || *at == ';';) {
        const char *equals = strchr(++at, '=');
        if (!equals)
            return *at == '\0' && at[-1] == ' '; /* no stages */
        char *end;
        double stage = strtod(equals + 1, &end);
        int part = part_index(unit, at, (size_t)(equals - at));
        if (part < 0 || end == equals + 1 || !(stage >= 0 && stage < DBL_MAX) || (*end && *end != ';'))
            return false;
        seconds[part] += stage;
        at = end;
    }
    return true;
}

static enum status unit_run(struct contest *contest, struct unit *unit, int side, int count, double *seconds)
{
    char question[60], answer[2000];
    struct ab_process *process = &contest->processes[side];
    snprintf(question, sizeof question, "run %d %d", unit->plans[side], count);
    enum status status = ab_process_ask(process, question, answer, sizeof answer);
    if (status == STATUS_OK && !times_read(unit, answer, seconds))
        status = answer_wrong(process, question, answer, "'took SECONDS STAGE=SECONDS;...'");
    return status;
}

/* Warm up, then A B B A, and the other way round in every other block. */
static enum status unit_round(struct contest *contest, struct unit *unit, int round)
{
    double warm[2][PARTS_MOST] = {{0}};
    enum status status = STATUS_OK;
    for (int side = 0; side < 2 && status == STATUS_OK; side++)
        status = unit_run(contest, unit, side, 1, warm[side]);
    if (status != STATUS_OK)
        return status;
    int count = (int)fmax(1, slot_s / fmax(fmax(warm[0][0], warm[1][0]), 1e-6));
    for (int block = 0; block < AB_BLOCKS; block++) {
        struct sample *sample = &unit->samples[unit->rounds * AB_BLOCKS + block];
        int first = (round + block) % 2;
        *sample = (struct sample){0};
        for (int k = 0; k < 4 && status == STATUS_OK; k++) {
            int side = k == 0 || k == 3 ? first : !first;
            status = unit_run(contest, unit, side, count, sample->seconds[side]);
        }
        for (int part = 0; part < PARTS_MOST; part++)
            for (int side = 0; side < 2; side++)
                sample->seconds[side][part] /= 2 * count;
    }
    unit->rounds++;
    return status;
}

static enum status contest_round(struct contest *contest, int round, const struct ab_effort *effort)
{
    static const char *const roles[2] = {"OLD", "NEW"};
    enum status status = STATUS_OK;
    for (int k = 0; k < 2 && status == STATUS_OK; k++)
        status = ab_process_start(roles[k], contest->paths[k], round, effort->patience_s, &contest->processes[k]);
    for (int k = 0; k < contest->unit_count && status == STATUS_OK; k++)
        if (!contest->units[k].skipped && !contest->units[k].decided)
            status = unit_plan(contest, &contest->units[k], round == 0);
    for (int k = 0; k < contest->unit_count && status == STATUS_OK; k++) {
        struct unit *unit = &contest->units[k];
        if (unit->skipped || unit->decided)
            continue;
        progress_line(false, "round %d: %s %s", round + 1, unit->scene, unit->spec);
        status = unit_round(contest, unit, round);
    }
    progress_line_clear();
    for (int k = 0; k < 2; k++)
        ab_process_stop(&contest->processes[k]);
    return status;
}

/* --- Verdicts ------------------------------------------------------------------------------------------------ */

/* The median over the blocks. */
static double part_seconds(const struct unit *unit, int side, int part)
{
    double seconds[ROUNDS_MOST * AB_BLOCKS];
    for (int k = 0; k < unit->rounds * AB_BLOCKS; k++)
        seconds[k] = unit->samples[k].seconds[side][part];
    return median(seconds, unit->rounds * AB_BLOCKS);
}

/* The total, and the stages of both programs that take enough of the time of either. */
static bool part_counts(const struct unit *unit, int part)
{
    double share = 0;
    for (int k = 0; k < unit->rounds * AB_BLOCKS; k++)
        if (!(unit->samples[k].seconds[0][part] > 0 && unit->samples[k].seconds[1][part] > 0))
            return false;
    for (int side = 0; side < 2; side++)
        share = fmax(share, part_seconds(unit, side, part) / part_seconds(unit, side, 0));
    return share >= STAGE_LEAST;
}

static struct ab_interval part_interval(const struct unit *unit, int part, double miss)
{
    double ratios[ROUNDS_MOST][AB_BLOCKS];
    for (int k = 0; k < unit->rounds; k++)
        for (int block = 0; block < AB_BLOCKS; block++) {
            const struct sample *sample = &unit->samples[k * AB_BLOCKS + block];
            ratios[k][block] = sample->seconds[1][part] / sample->seconds[0][part];
        }
    return ab_interval_find(ratios, unit->rounds, miss);
}

/* Bonferroni: over all comparisons and all times of looking; half on either side. */
static double miss_probability(const struct contest *contest, const struct ab_effort *effort)
{
    int comparisons = 0, looks = 1 + (effort->rounds_most - effort->rounds_least) / effort->rounds_step;
    for (int k = 0; k < contest->unit_count; k++)
        for (int part = 0; part < contest->units[k].part_count; part++)
            comparisons += part_counts(&contest->units[k], part);
    return ERROR_PROBABILITY / 2 / fmax(1, comparisons) / looks;
}

/* Marks the units that are fully decided, or worse in something, and returns how many are left. */
static int contest_look(struct contest *contest, const struct ab_effort *effort)
{
    double miss = miss_probability(contest, effort);
    int open = 0;
    for (int k = 0; k < contest->unit_count; k++) {
        struct unit *unit = &contest->units[k];
        bool worse = false, clear = true;
        if (unit->skipped || unit->decided)
            continue;
        for (int part = 0; part < unit->part_count; part++) {
            if (!part_counts(unit, part))
                continue;
            const struct ab_interval interval = part_interval(unit, part, miss);
            enum verdict verdict = ab_interval_verdict(&interval);
            worse = worse || verdict == VERDICT_WORSE;
            clear =
                clear && verdict != VERDICT_NOISY && (verdict != VERDICT_WARNING || interval.high < 1 + EFFECT_FAIL);
        }
        unit->decided = worse || clear;
        open += !unit->decided;
    }
    return open;
}

static enum status findings_add(struct contest *contest, const struct ab_effort *effort)
{
    double miss = miss_probability(contest, effort);
    enum status status = STATUS_OK;
    for (int k = 0; k < contest->unit_count; k++) {
        const struct unit *unit = &contest->units[k];
        for (int part = 0; part < unit->part_count && status == STATUS_OK; part++) {
            if (!part_counts(unit, part))
                continue;
            const struct ab_interval interval = part_interval(unit, part, miss);
            const char *detail = diff_text(contest->diff, "%s", unit->parts[part]);
            if (!detail)
                return STATUS_FAILED;
            double before = part_seconds(unit, 0, part), after = part_seconds(unit, 1, part);
            status = diff_add(contest->diff, &(struct finding){.verdict = ab_interval_verdict(&interval),
                                                               .class = CLASS_TIME,
                                                               .scene = unit->scene,
                                                               .spec = unit->spec,
                                                               .detail = detail,
                                                               .metric = "time",
                                                               .unit = "s",
                                                               .before = before,
                                                               .after = after,
                                                               .change = interval.middle - 1,
                                                               .change_low = interval.low - 1,
                                                               .change_high = interval.high - 1,
                                                               .slack = after * (interval.high - interval.low) / 2,
                                                               .lower_is_better = true});
        }
    }
    return status;
}

/* --- The comparison ------------------------------------------------------------------------------------------- */

static enum status unit_make(struct contest *contest, const char *scene, const char *spec, struct unit *unit)
{
    const char *path = diff_text(contest->diff, "%s/%s.cfg", data_path(DATA_SCENES), scene);
    if (!path)
        return STATUS_FAILED;
    if (access(path, R_OK) != 0)
        path = scene; /* both programs are to read one and the same file */
    *unit = (struct unit){.scene = scene, .spec = spec};
    unit->question = diff_text(contest->diff, "plan %s %s", spec, path);
    return unit->question ? STATUS_OK : STATUS_FAILED;
}

static enum status scene_check(const char *name)
{
    struct scene scene;
    enum status status = scene_load(name, data_path(DATA_SCENES), &scene);
    if (status == STATUS_OK)
        scene_free(&scene);
    return status;
}

/* Every scene with every SPEC; specs[] has texts, and without any it is every algorithm. */
static enum status scene_units(struct contest *contest, const char *scene, const char *const *specs, int spec_count)
{
    enum status status = scene_check(scene);
    for (int k = 0; status == STATUS_OK && (spec_count > 0 ? k < spec_count : algorithms[k] != NULL); k++) {
        struct unit *units = realloc(contest->units, ((size_t)contest->unit_count + 1) * sizeof *units);
        if (!units)
            return status_set(STATUS_FAILED, "no memory for %d units", contest->unit_count + 1);
        contest->units = units;
        status =
            unit_make(contest, scene, spec_count > 0 ? specs[k] : algorithms[k]->name, &units[contest->unit_count]);
        contest->unit_count += status == STATUS_OK;
    }
    return status;
}

/* A SPEC as it is written. */
static const char *spec_text(struct diff *diff, const struct spec *spec)
{
    char text[512];
    struct measurement row = measurement_empty("", spec->algorithm->name, spec->text, spec->precision);
    measurement_spec(&row, text, sizeof text);
    return diff_text(diff, "%s", text);
}

static enum status units_make(struct contest *contest, const char *const *scenes, int scene_count,
                              const struct spec *specs, int spec_count)
{
    const char **texts = calloc((size_t)spec_count + 1, sizeof *texts);
    enum status status = texts ? STATUS_OK : status_set(STATUS_FAILED, "no memory for %d algorithms", spec_count);
    for (int k = 0; k < spec_count && status == STATUS_OK; k++)
        if (!(texts[k] = spec_text(contest->diff, &specs[k])))
            status = STATUS_FAILED;
    for (int k = 0; k < (scene_count > 0 ? scene_count : USUAL) && status == STATUS_OK; k++) {
        int usual_count = 0;
        while (scene_count == 0 && spec_count == 0 && usual[k].specs[usual_count])
            usual_count++;
        const char *scene = scene_count > 0 ? scenes[k] : usual[k].scene;
        status = usual_count > 0 ? scene_units(contest, scene, usual[k].specs, usual_count)
                                 : scene_units(contest, scene, texts, spec_count);
    }
    free(texts);
    return status;
}

static enum status contest_run(struct contest *contest, const struct ab_effort *effort)
{
    int round = 0, open = 1;
    double begin = seconds_now();
    enum status status = STATUS_OK;
    while (status == STATUS_OK && open > 0 && round < effort->rounds_most
           && (round < effort->rounds_least || seconds_now() - begin < effort->budget_s)) {
        status = contest_round(contest, round++, effort);
        if (status == STATUS_OK && round >= effort->rounds_least
            && (round - effort->rounds_least) % effort->rounds_step == 0)
            open = contest_look(contest, effort);
    }
    if (status == STATUS_OK)
        status = findings_add(contest, effort);
    if (status == STATUS_OK && contest->diff->finding_count == 0)
        status = status_set(STATUS_INVALID, "neither program can measure this: %s",
                            contest->diff->note_count > 0 ? contest->diff->notes[0] : "nothing is");
    if (status == STATUS_OK)
        status = diff_note(contest->diff,
                           "%d rounds in %.0f s, one thread; joint confidence of all intervals %g %%; "
                           "a slowdown beyond %g %% warns, beyond %g %% fails",
                           round, seconds_now() - begin, 100 * (1 - ERROR_PROBABILITY), 100 * EFFECT_WARN,
                           100 * EFFECT_FAIL);
    return status;
}

enum status ab_run(const char *old, const char *new, const char *const *scenes, int scene_count,
                   const struct spec *specs, int spec_count, const struct ab_effort *effort, struct diff *diff)
{
    *diff = (struct diff){0};
    struct contest contest = {.paths = {old, new}, .diff = diff};
    enum status status = units_make(&contest, scenes, scene_count, specs, spec_count);
    if (status == STATUS_OK)
        status = contest_run(&contest, effort);
    free(contest.units);
    return status;
}
