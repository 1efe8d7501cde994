/* Plans: what they hold, keep and share (conformance.h). */
#include <math.h>
#include <omp.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "conformance/conformance.h"
#include "contract/param.h"
#include "echoes/echo_data.h"

/* Pages of memory that the process has mapped. */
static long pages_mapped(void)
{
    long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%ld", &pages) != 1)
        pages = 0;
    if (file)
        fclose(file);
    return pages;
}

static long pages_touched(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? usage.ru_minflt : 0;
}

/* Memory as the system sees it, whatever it was taken by: no page is mapped for good by a plan and its destroy, and
   execute touches none for the first time when it is repeated. */
void check_memory(const struct conformance *c, const struct setting *setting)
{
    enum { ROUNDS = 6, RUNS = 8 };
    struct scene scene;
    struct grid grids[2];
    struct echoes echoes;
    conformance_echoes(c, setting, &scene, grids, &echoes);
    for (int precision = 0; precision < 2; precision++) {
        struct problem problem = scene_problem(&scene, (enum precision)precision);
        struct echoes converted;
        struct image image;
        struct stages stages;
        long mapped[ROUNDS], touched = 0, grown = 0;
        char place[80];
        snprintf(place, sizeof place, "%s, %s", setting->name, precision_name(problem.precision));
        conformance_at(c, place);
        conformance_need(c, echoes_convert(&echoes, problem.precision, &converted));
        conformance_need(c, image_allocate(problem.patch_count, problem.patches, problem.precision, &image));
        for (int n = 0; n < ROUNDS; n++) {
            void *plan;
            if (!conformance_plan(c, setting, &problem, &plan))
                return;
            for (int k = 0; k < RUNS && n == ROUNDS - 1; k++) {
                const long before = pages_touched();
                stages_begin(&stages);
                c->algorithm->execute(plan, &converted, &image, &stages);
                const long now = pages_touched() - before;
                touched = k == 0 || now < touched ? now : touched;
            }
            c->algorithm->destroy(plan);
            mapped[n] = pages_mapped();
        }
        c->algorithm->destroy(NULL);
        for (int n = 1; n < ROUNDS; n++) { /* the least: what a library takes once is no leak */
            const long now = mapped[n] - mapped[n - 1];
            grown = n == 1 || now < grown ? now : grown;
        }
#ifndef SANITIZED
        promise_most(c, place, "the pages that plan and destroy leave mapped each time", (double)grown, 0);
        promise_most(c, place, "the pages that a repeated execute touches anew", (double)touched, 0);
#endif
    }
}

/* The same bits for any number of threads, also fewer than planned for, however often a plan is executed and however
   loops are scheduled; and OpenMP's settings stay. */
void check_schedules(const struct conformance *c, const struct setting *setting)
{
    static const int threads[] = {1, 2, 3, 5};
    static const omp_sched_t kinds[] = {omp_sched_static, omp_sched_dynamic, omp_sched_guided};
    enum { COUNTS = sizeof threads / sizeof *threads, REPEATS = 12 };
    struct scene scene;
    struct grid grids[2];
    struct echoes echoes;
    conformance_echoes(c, setting, &scene, grids, &echoes);
    for (int precision = 0; precision < 2; precision++) {
        const struct problem problem = scene_problem(&scene, (enum precision)precision);
        struct image first, again;
        int others = 0, changed = 0;
        char place[80];
        snprintf(place, sizeof place, "%s, %s", setting->name, precision_name(problem.precision));
        for (int k = 0; k < COUNTS; k++) {
            void *plan;
            omp_set_num_threads(threads[k]);
            if (!conformance_plan(c, setting, &problem, &plan))
                return;
            for (int n = 0; n < REPEATS; n++) {
                const int used = n < REPEATS - 1 || k == 0 ? threads[k] : threads[k - 1];
                omp_sched_t kind;
                int chunk;
                omp_set_num_threads(used);
                omp_set_schedule(kinds[n % 3], 1);
                conformance_execute(c, place, plan, &problem, &echoes, n % 2, k + n == 0 ? &first : &again);
                omp_get_schedule(&kind, &chunk);
                changed += omp_get_max_threads() != used || kind != kinds[n % 3] || chunk != 1;
                others += k + n > 0 && !same_bits(&first, &again);
            }
            c->algorithm->destroy(plan);
        }
        promise(c, place, others == 0, "other bits by %d of %d executes on 1, 2, 3, 5 threads, must be none", others,
                COUNTS * REPEATS);
        promise(c, place, changed == 0, "OpenMP's settings differ behind %d executes, must be none", changed);
    }
}

/* ---- state ---- */

struct job {
    const struct conformance *conformance;
    struct problem problem;
    const struct echoes *echoes;
    void *plan;
    struct image image;
    struct image alone; /* as the plan forms it when no other one is there */
    pthread_barrier_t *begin;
    int others; /* executes with other bits */
};

static void *job_run(void *data)
{
    struct job *job = data;
    struct stages stages;
    omp_set_num_threads(1); /* as the plan was made with */
    if (job->begin)
        pthread_barrier_wait(job->begin);
    stages_begin(&stages);
    for (int k = 0; k < 20; k++) {
        job->conformance->algorithm->execute(job->plan, job->echoes, &job->image, &stages);
        job->others += !same_bits(&job->image, &job->alone);
    }
    return NULL;
}

/* Two plans of different pixels, live at once and executed at once, form the images that each forms alone; and so does
   a plan whose samples' array holds other echoes the next time. */
void check_state(const struct conformance *c, const struct setting *setting)
{
    struct scene scene;
    struct grid grids[2];
    struct echoes echoes;
    struct job jobs[2];
    struct stages stages;
    pthread_t threads[2];
    pthread_barrier_t begin;
    conformance_echoes(c, setting, &scene, grids, &echoes);
    grids[1] = grids[0];
    grids[1].r_first += 7.3 * grids[1].r_step;
    grids[1].x_count -= 4;
    omp_set_num_threads(1);
    for (int k = 0; k < 2; k++) {
        jobs[k] = (struct job){.conformance = c, .echoes = &echoes};
        jobs[k].problem = problem_make(&scene.acquisition, 1, &grids[k], PRECISION_DOUBLE);
        conformance_need(c, image_allocate(1, &grids[k], PRECISION_DOUBLE, &jobs[k].image));
        if (!conformance_form(c, setting, jobs[k].problem, PRECISION_DOUBLE, 1, &echoes, &jobs[k].alone))
            return;
    }
    for (int k = 0; k < 2; k++)
        if (!conformance_plan(c, setting, &jobs[k].problem, &jobs[k].plan))
            return;
    conformance_at(c, "two live plans");
    for (int k = 0; k < 2; k++)
        job_run(&jobs[k]);
    promise(c, "two live plans", jobs[0].others + jobs[1].others == 0,
            "%d of 40 images have other bits than when formed alone, must be none", jobs[0].others + jobs[1].others);
    conformance_at(c, "two executes at once");
    pthread_barrier_init(&begin, NULL, 2);
    for (int k = 0; k < 2; k++) {
        jobs[k].begin = &begin;
        jobs[k].others = 0;
    }
    for (int k = 0; k < 2; k++)
        if (pthread_create(&threads[k], NULL, job_run, &jobs[k]) != 0)
            conformance_need(c, status_set(STATUS_FAILED, "no thread"));
    for (int k = 0; k < 2; k++)
        pthread_join(threads[k], NULL);
    promise(c, "two executes at once", jobs[0].others + jobs[1].others == 0,
            "%d of 40 images have other bits than when formed alone, must be none", jobs[0].others + jobs[1].others);
    c->algorithm->destroy(jobs[1].plan);
    jobs[0].begin = NULL;
    job_run(&jobs[0]);
    echoes_negate(&echoes);
    stages_begin(&stages);
    c->algorithm->execute(jobs[0].plan, &echoes, &jobs[0].image, &stages);
    image_negate(&jobs[0].image);
    promise_most(c, "other echoes in the same array", "the difference from the negated image",
                 image_difference(&jobs[0].image, &jobs[0].alone), 0);
    c->algorithm->destroy(jobs[0].plan);
}

/* ---- settings ---- */

/* The declaration of one setting, and its sweep. */
static void check_param(const struct conformance *c, const char *place, const struct param *p)
{
    const size_t size = p->type == PARAM_REAL ? sizeof(double) : sizeof(int);
    if (!c->algorithm->origin) /* else the host lays them out */
        promise(c, place, p->type == PARAM_TEXT || (p->size == size && p->offset % size == 0),
                "a field of %zu bytes at %zu of %zu must hold its type; declare it by PARAM or PARAM_NAMED", p->size,
                p->offset, c->algorithm->options_size);
    promise(c, place, p->type == PARAM_TEXT || (p->initial >= p->min && p->initial <= p->max),
            "the default is %g, must lie from %g to %g", p->initial, p->min, p->max);
    promise(c, place, p->summary && *p->summary && (p->type == PARAM_CHOICE) == (p->choices != NULL),
            "it has a summary, and choices when it is one");
    char sweep[128], *rest = sweep;
    snprintf(sweep, sizeof sweep, "%s", p->sweep ? p->sweep : "");
    for (char *value; (value = strtok_r(rest, " ", &rest));) {
        char text[256];
        struct spec spec;
        snprintf(text, sizeof text, "%s:%s=%s", c->algorithm->name, p->name, value);
        const bool parsed = spec_parse(text, &spec) == STATUS_OK;
        promise(c, place, parsed, "its sweep holds %s%s%s", value, parsed ? "" : ": ", parsed ? "" : status_message());
    }
}

/* The image and the work of a plan. */
struct formed {
    struct image image;
    struct work work;
};

static bool settings_form(const struct conformance *c, const struct spec *spec, const struct problem *problem,
                          const struct echoes *echoes, struct formed *formed)
{
    void *plan;
    struct stages stages;
    conformance_need(c, image_allocate(problem->patch_count, problem->patches, problem->precision, &formed->image));
    if (algorithm_plan(c->algorithm, problem, spec->options, &plan) != STATUS_OK)
        return false;
    stages_begin(&stages);
    c->algorithm->execute(plan, echoes, &formed->image, &stages);
    formed->work = c->algorithm->work(plan);
    c->algorithm->destroy(plan);
    return true;
}

/* Values other than the default, as texts: those of the sweep, of the list, or beside the default. */
static int values_of(const struct param *p, char values[16][64])
{
    int count = 0;
    char sweep[128], *rest = sweep;
    snprintf(sweep, sizeof sweep, "%s", p->sweep ? p->sweep : "");
    for (char *value; count < 8 && (value = strtok_r(rest, " ", &rest));)
        snprintf(values[count++], 64, "%s", value);
    for (int k = 0; p->type == PARAM_CHOICE && p->choices[k] && count < 12; k++)
        snprintf(values[count++], 64, "%s", p->choices[k]);
    const double near[] = {2 * p->initial + 1, p->initial / 2, p->min, fmin(p->max, 4 * p->initial)};
    for (int k = 0; k < 4 && p->type != PARAM_CHOICE; k++)
        param_format(p, near[k], values[count++], 64);
    return count;
}

/* Do two SPECs form the images and count the work of a scene alike? Where one of both is refused, they do. */
static bool specs_alike(const struct conformance *c, const struct spec *a, const struct spec *b,
                        const struct setting *setting)
{
    struct scene scene;
    struct grid grids[2];
    struct echoes echoes;
    struct formed of_a, of_b;
    conformance_echoes(c, setting, &scene, grids, &echoes);
    const struct problem problem = scene_problem(&scene, PRECISION_DOUBLE);
    return !settings_form(c, a, &problem, &echoes, &of_a) || !settings_form(c, b, &problem, &echoes, &of_b)
           || (same_bits(&of_a.image, &of_b.image) && of_a.work.flops == of_b.work.flops
               && of_a.work.bytes == of_b.work.bytes && strcmp(of_a.work.engine, of_b.work.engine) == 0);
}

/* Does one of a setting's values change something, on a scene, beside `base`? */
static bool param_acts(const struct conformance *c, const struct spec *base, const struct param *p,
                       const struct setting *setting)
{
    char place[80], values[16][64];
    const int count = values_of(p, values);
    bool acts = false;
    for (int k = 0; k < count && !acts; k++) {
        struct spec varied;
        snprintf(place, sizeof place, "setting %s=%.40s", p->name, values[k]);
        conformance_at(c, place);
        acts = spec_vary(base, p->name, values[k], &varied) == STATUS_OK && !specs_alike(c, base, &varied, setting);
    }
    return acts;
}

/* Off its default, each setting changes the image or the work: of a scene, or beside another setting off its own. */
void check_settings(const struct conformance *c, const struct setting *setting)
{
    const struct spec *spec = &c->specs[PRECISION_DOUBLE];
    for (const struct param *p = c->algorithm->params; p && p->name; p++) {
        char place[80], values[16][64];
        snprintf(place, sizeof place, "setting %s", p->name);
        check_param(c, place, p);
        if (p->hidden || p->type == PARAM_TEXT || spec_given(spec, p->name))
            continue;
        bool acts = param_acts(c, spec, p, setting);
        for (const struct param *q = c->algorithm->params; q->name && !acts; q++)
            for (int count = q == p || q->type == PARAM_TEXT ? 0 : values_of(q, values), k = 0; k < count && !acts;
                 k++) {
                struct spec beside;
                acts = spec_vary(spec, q->name, values[k], &beside) == STATUS_OK && param_acts(c, &beside, p, setting);
            }
        for (int k = 0; k < SETTINGS && !acts; k++)
            acts = param_acts(c, spec, p, &settings[k]);
        promise(c, place, acts, "off its default it changes the image or the work of a scene");
    }
}
