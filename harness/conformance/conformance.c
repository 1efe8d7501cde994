/* Checks in processes of their own, and what they share (conformance.h). */
#define _GNU_SOURCE /* MAP_ANONYMOUS */
#include "conformance/conformance.h"

#include <math.h>
#include <omp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/clock.h"
#include "echoes/echo_data.h"
#include "guests/guests.h"
#include "scene/simulate.h"
#include "text/shown_text.h"

enum { SECONDS_MOST = 600, FAILING_MOST = 30 }; /* of one check; of all executes that fail */

/* ---- promises ---- */

void conformance_at(const struct conformance *c, const char *place)
{
    snprintf(c->tally->place, sizeof c->tally->place, "%s", place);
}

bool promise(const struct conformance *c, const char *place, bool kept, const char *format, ...)
{
    char text[600];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    shown_make(text);
    fprintf(c->stream, "  %s %s: %s\n", kept ? "kept  " : "BROKEN", place, text);
    fflush(c->stream); /* ahead of a crash */
    *(kept ? &c->tally->kept : &c->tally->broken) += 1;
    return kept;
}

bool promise_most(const struct conformance *c, const char *place, const char *what, double value, double bound)
{
    return promise(c, place, value <= bound, "%s is %.3g, at most %.3g", what, value, bound);
}

void conformance_need(const struct conformance *c, enum status status)
{
    if (status == STATUS_OK)
        return;
    promise(c, c->tally->place, false, "this check ended early: %s", status_message());
    c->tally->ended = true;
    _exit(0);
}

/* ---- plans and images ---- */

bool conformance_plan(const struct conformance *c, const struct setting *setting, const struct problem *problem,
                      void **plan)
{
    int unset;
    *plan = &unset;
    const double begin = seconds_now();
    const enum status status = algorithm_plan(c->algorithm, problem, c->specs[problem->precision].options, plan);
    if (status == STATUS_OK)
        return true;
    c->tally->failing_s += status == STATUS_UNSUPPORTED ? 0 : seconds_now() - begin;
    const char *reason = status_message();
    if (status != STATUS_UNSUPPORTED || strlen(reason) <= 10)
        promise(c, setting->name, false, "plan returns status %d, \"%s\", must be 0, or %d with a reason", status,
                reason, STATUS_UNSUPPORTED);
    if (*plan)
        promise(c, setting->name, false, "plan refuses and leaves *plan set, must be NULL");
    if (setting->promise & c->algorithm->traits)
        promise(c, setting->name, false, "refused, \"%s\", in spite of its trait", reason);
    return false;
}

/* Between two pages that cannot be touched: up to the one behind, or from the one before. Never freed: the check's
   process ends. */
static void *guarded(const struct conformance *c, size_t size, bool behind)
{
    const size_t page = (size_t)sysconf(_SC_PAGESIZE), whole = (size + page - 1) / page * page;
    char *map = mmap(NULL, whole + 2 * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (map == MAP_FAILED || mprotect(map, page, PROT_NONE) != 0 || mprotect(map + page + whole, page, PROT_NONE) != 0)
        conformance_need(c, status_set(STATUS_FAILED, "no memory for %zu bytes", size));
    return map + page + (behind ? whole - size : 0);
}

void conformance_execute(const struct conformance *c, const char *place, void *plan, const struct problem *problem,
                         const struct echoes *echoes, bool behind, struct image *image)
{
    struct echoes converted, given;
    struct stages stages;
    const size_t size = precision_size(problem->precision);
    const size_t bytes = samples_bytes(problem->acquisition, problem->precision);
    conformance_need(c, echoes_convert(echoes, problem->precision, &converted));
    given = converted;
    given.acquisition = problem->acquisition;
    given.samples = memcpy(guarded(c, bytes, behind), converted.samples, bytes);
    *image = (struct image){problem->patch_count, problem->patches, problem->precision,
                            calloc((size_t)problem->patch_count, sizeof(void *))};
    for (int k = 0; k < problem->patch_count; k++) {
        const size_t pixels = grid_pixels(&problem->patches[k]) * size;
        image->pixels[k] = guarded(c, pixels, behind);
        memset(image->pixels[k], 0x5a, pixels); /* every pixel must be written */
    }
    conformance_at(c, place);
    stages_begin(&stages);
    const double begin = seconds_now();
    const enum status status = c->algorithm->execute(plan, &given, image, &stages);
    if (status != STATUS_OK) {
        promise(c, place, false, "execute returns status %d, \"%s\"", status, status_message());
        c->tally->failing_s += seconds_now() - begin;
    }
    if (memcmp(given.samples, converted.samples, bytes) != 0)
        promise(c, place, false, "execute changes its samples, must only read them");
    echoes_free(&converted);
    if (status == STATUS_OK && stages.count == 0)
        promise(c, place, false, "execute names no stage, must name at least one");
}

bool conformance_form(const struct conformance *c, const struct setting *setting, struct problem problem,
                      enum precision precision, int threads, const struct echoes *echoes, struct image *image)
{
    void *plan;
    char place[120];
    problem.precision = precision;
    omp_set_num_threads(threads);
    snprintf(place, sizeof place, "%s, %s", setting->name, precision_name(precision));
    conformance_at(c, place);
    if (!conformance_plan(c, setting, &problem, &plan))
        return false;
    conformance_execute(c, place, plan, &problem, echoes, threads > 1, image);
    c->algorithm->destroy(plan);
    return true;
}

/* Known targets are elsewhere once the echoes are made: an image drawn from them shows it. */
void conformance_echoes(const struct conformance *c, const struct setting *setting, struct scene *scene,
                        struct grid grids[2], struct echoes *echoes)
{
    conformance_need(c, make_scene(setting, scene, grids));
    conformance_need(c, scene_simulate(scene, echoes));
    for (int k = 0; k < scene->target_count; k++)
        scene->targets[k].x -= 0.1;
}

bool same_bits(const struct image *a, const struct image *b)
{
    bool same = true;
    for (int k = 0; k < a->patch_count; k++)
        same &= memcmp(a->pixels[k], b->pixels[k], grid_pixels(&a->patches[k]) * precision_size(a->precision)) == 0;
    return same;
}

double image_difference(const struct image *a, const struct image *b)
{
    double difference = 0, norm = 0;
    for (int k = 0; k < b->patch_count; k++)
        for (int i = 0; i < b->patches[k].r_count; i++)
            for (int j = 0; j < b->patches[k].x_count; j++) {
                const double complex exact = image_pixel(b, k, i, j);
                difference += pow(cabs(image_pixel(a, k, i, j) - exact), 2);
                norm += pow(cabs(exact), 2);
            }
    return sqrt(norm > 0 ? difference / norm : difference);
}

/* ---- processes ---- */

/* Which scene is the usual one. */
static void check_usual(const struct conformance *c, const struct setting *setting)
{
    struct scene scene;
    struct grid grids[2];
    void *plan;
    conformance_need(c, make_scene(setting, &scene, grids));
    const struct problem problem = scene_problem(&scene, PRECISION_DOUBLE);
    c->tally->monostatic =
        algorithm_plan(c->algorithm, &problem, c->specs[PRECISION_DOUBLE].options, &plan) != STATUS_OK;
}

static void check_description(const struct conformance *c, const struct setting *setting)
{
    const struct algorithm *a = c->algorithm;
    const char *rest;
    (void)setting;
    promise(c, "description", guest_find(a->name, &rest) == a, "its name finds it");
    promise(c, "description", strlen(a->summary) > 5 && strlen(a->reference) > 3,
            "summary and reference are \"%s\" and \"%s\", must have some words", a->summary, a->reference);
}

/* One check on one scene in a process of its own: its lines are printed by it, a crash by the process that waits. */
static void run_apart(const struct conformance *c, const struct conformance_check *check, const struct setting *setting)
{
    int state = 0;
    snprintf(c->tally->place, sizeof c->tally->place, "%s", setting->name);
    c->tally->ended = false;
    fflush(c->stream);
    const pid_t child = fork();
    if (child == 0) {
        alarm(SECONDS_MOST);
        check->run(c, setting);
        c->tally->ended = true;
        _exit(0);
    }
    if (child > 0)
        waitpid(child, &state, 0);
    if (child < 0 || WIFSIGNALED(state))
        promise(c, c->tally->place, false, "%s ended by signal %d (%s)", check->name, WTERMSIG(state),
                strsignal(WTERMSIG(state)));
    else if (!c->tally->ended)
        promise(c, c->tally->place, false, "%s ended the program with exit status %d", check->name, WEXITSTATUS(state));
}

static const struct conformance_check checks[] = {
    {"the scene that it images", check_usual, false},
    {"description", check_description, false},
    {"settings", check_settings, false},
    {"images", check_images, true},
    {"linearity", check_linearity, false},
    {"translation", check_translation, false},
    {"memory", check_memory, false},
    {"threads", check_schedules, false},
    {"state", check_state, false},
};
enum { CHECKS = sizeof checks / sizeof *checks };

int conformance_run(const struct spec *spec, FILE *stream, const struct conformance_check *more, int more_count)
{
    struct conformance c = {
        .stream = stream, .algorithm = spec->algorithm, .usual = &settings[RAW], .specs = {*spec, *spec}};
    c.specs[PRECISION_FLOAT].precision = PRECISION_FLOAT;
    c.specs[PRECISION_DOUBLE].precision = PRECISION_DOUBLE;
    c.tally = mmap(NULL, sizeof *c.tally, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (c.tally == MAP_FAILED)
        return 1;
    for (int k = 0; k < CHECKS + more_count; k++) {
        const struct conformance_check *check = k < CHECKS ? &checks[k] : &more[k - CHECKS];
        fprintf(stream, "%s: %s\n", c.algorithm->name, check->name);
        for (int n = 0; n < (check->each ? SETTINGS : 1) && c.tally->failing_s < FAILING_MOST; n++)
            run_apart(&c, check, check->each ? &settings[n] : c.usual);
        c.usual = &settings[c.tally->monostatic ? MONOSTATIC : RAW];
    }
    if (c.tally->failing_s >= FAILING_MOST)
        promise(&c, "time", false, "executes that fail took %.3g s; the checks behind them are left out",
                c.tally->failing_s);
    promise(&c, "all scenes", c.tally->accepted > 0, "%d of %d are accepted", c.tally->accepted, SETTINGS);
    const int broken = c.tally->broken;
    fprintf(stream, "%s: %d of %d promises are broken\n", c.algorithm->name, broken, broken + c.tally->kept);
    munmap(c.tally, sizeof *c.tally);
    return broken;
}
