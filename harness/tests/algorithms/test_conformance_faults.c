/* The conformance checks catch what they are there for: nearest-neighbour back projection with one fault at a time must
   fail them, by name. Each faulty algorithm runs in a program of its own, this one with the fault's name as
   argument. */
#include <fftw3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "backprojection/bp.h"
#include "tests/algorithms/conformance.h"

extern const struct algorithm reference;

static const struct fault *injected;

/* ---- plans ---- */

struct options {
    struct bp_options bp;
    double scale;
};

static const struct param by_hand[] = {
    {.name = "scale",
     .summary = "a double that is called an integer",
     .type = PARAM_INTEGER,
     .offset = offsetof(struct options, scale),
     .max = 9},
    {.name = NULL},
};

static enum status plan_of(const struct acquisition *acquisition, const struct problem *problem, void **plan)
{
    const struct interpolator nearest = {.upsample = 1, .steps = 1, .taps = 1};
    const struct bp_options options = {.engine = BP_ENGINE_GENERAL, .phase_limit = 1e-4};
    struct problem changed = *problem;
    changed.acquisition = acquisition;
    return bp_plan(&changed, &nearest, &options, plan);
}

static enum status plan_good(const struct problem *problem, const void *method, const void *options, void **plan)
{
    (void)method, (void)options;
    return plan_of(problem->acquisition, problem, plan);
}

static enum status plan_leaks(const struct problem *problem, const void *method, const void *options, void **plan)
{
    static void *lost;
    lost = malloc(1);
    return lost ? plan_good(problem, method, options, plan) : status_set(STATUS_FAILED, "no memory to be lost");
}

static enum status plan_unlimited(const struct problem *problem, const void *method, const void *options, void **plan)
{
    static struct acquisition changed; /* outlives the plan */
    (void)method, (void)options;
    changed = *problem->acquisition;
    changed.aperture_limit = INFINITY;
    return plan_of(&changed, problem, plan);
}

enum { PLACES = 100 };

static void drop(struct vector *places, const struct vector *from, int count, double y, double z)
{
    assert_true(count <= PLACES);
    for (int k = 0; k < count; k++)
        places[k] = (struct vector){from[k].x, y * from[k].y, z * from[k].z};
}

/* The acquisition with some coordinates taken for zero. */
static enum status plan_flat(const struct problem *problem, void **plan, double y, double z, double moving)
{
    static struct acquisition changed;
    static struct vector tx[PLACES], rx[PLACES], velocity[PLACES];
    const struct acquisition *a = problem->acquisition;
    changed = *a;
    changed.tx = tx;
    changed.rx = rx;
    changed.velocity = velocity;
    drop(tx, a->tx, a->pings, y, z);
    drop(rx, a->rx, a->pings * a->receivers, y, z);
    drop(velocity, a->velocity, a->pings, moving * y, moving * z);
    return plan_of(&changed, problem, plan);
}

static enum status plan_without_y(const struct problem *problem, const void *method, const void *options, void **plan)
{
    (void)method, (void)options;
    return plan_flat(problem, plan, 0, 1, 1);
}

static enum status plan_without_z(const struct problem *problem, const void *method, const void *options, void **plan)
{
    (void)method, (void)options;
    return plan_flat(problem, plan, 1, 0, 1);
}

static enum status plan_along_x(const struct problem *problem, const void *method, const void *options, void **plan)
{
    (void)method, (void)options;
    return plan_flat(problem, plan, 1, 1, 0);
}

static enum status plan_one_t0(const struct problem *problem, const void *method, const void *options, void **plan)
{
    static struct acquisition changed;
    static double t0[PLACES];
    (void)method, (void)options;
    changed = *problem->acquisition;
    changed.t0 = t0;
    for (int p = 0; p < changed.pings; p++)
        t0[p] = problem->acquisition->t0[0];
    return plan_of(&changed, problem, plan);
}

static enum status plan_straight_only(const struct problem *problem, const void *method, const void *options,
                                      void **plan)
{
    *plan = NULL;
    if (acquisition_is_straight(problem->acquisition, NULL))
        return plan_good(problem, method, options, plan);
    return status_set(STATUS_UNSUPPORTED, "the track is not straight");
}

static enum status plan_without_reason(const struct problem *problem, const void *method, const void *options,
                                       void **plan)
{
    *plan = NULL;
    return problem->acquisition->pings > 1 ? plan_good(problem, method, options, plan)
                                           : status_set(STATUS_UNSUPPORTED, "no");
}

/* Keeps what it has when memory ends. */
static enum status plan_half_made(const struct problem *problem, const void *method, const void *options, void **plan)
{
    static void *first, *second;
    *plan = NULL;
    first = malloc(1);
    second = malloc(1);
    if (!first || !second)
        return status_set(STATUS_FAILED, "no memory for the two");
    free(first);
    free(second);
    return plan_good(problem, method, options, plan);
}

/* ---- executes ---- */

static enum status execute_allocates(void *plan, const struct echoes *echoes, struct image *image,
                                     struct stages *stages)
{
    fftw_free(fftw_alloc_complex(16));
    return bp_execute(plan, echoes, image, stages);
}

static enum status execute_plans(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    static fftwf_complex in[16], out[16];
    fftwf_destroy_plan(fftwf_plan_dft_1d(16, in, out, FFTW_FORWARD, FFTW_ESTIMATE));
    return bp_execute(plan, echoes, image, stages);
}

/* Parts are added in the order in which threads come by. */
static enum status execute_races(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    enum { PARTS = 64, LEAST = 525 };
    enum status status = bp_execute(plan, echoes, image, stages);
    double sums[LEAST] = {0}, wanted = 0;
    for (int k = 0; k < PARTS; k++)
        wanted += 1 / (k + 1.0);
#pragma omp parallel for schedule(dynamic)
    for (int k = 0; k < PARTS; k++) {
        usleep(10); /* as if it took time: another thread comes by */
#pragma omp critical
        for (int i = 0; i < LEAST; i++)
            sums[i] += (i + 1) / (k + 1.0);
    }
    if (image->precision == PRECISION_DOUBLE)
        for (int i = 0; i < LEAST; i++)
            ((double *)image->pixels[0])[i] *= sums[i] / (wanted * (i + 1));
    return status;
}

static enum status execute_last_pixel(void *plan, const struct echoes *echoes, struct image *image,
                                      struct stages *stages)
{
    size_t last = (size_t)image->patches[0].x_count * (size_t)image->patches[0].r_count - 1;
    size_t size = image->precision == PRECISION_DOUBLE ? 16 : 8;
    unsigned char kept[16];
    memcpy(kept, (unsigned char *)image->pixels[0] + last * size, size);
    enum status status = bp_execute(plan, echoes, image, stages);
    memcpy((unsigned char *)image->pixels[0] + last * size, kept, size);
    return status;
}

static enum status execute_nan(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    enum status status = bp_execute(plan, echoes, image, stages);
    if (image->precision == PRECISION_DOUBLE)
        ((double *)image->pixels[0])[7] = NAN;
    else
        ((float *)image->pixels[0])[7] = NAN;
    return status;
}

static enum status execute_adds(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    enum status status = bp_execute(plan, echoes, image, stages);
    if (image->precision == PRECISION_DOUBLE)
        ((double *)image->pixels[0])[0] += 1e-6;
    return status;
}

/* ---- works ---- */

static struct work work_few_flops(const void *plan)
{
    struct work work = bp_work(plan);
    work.flops /= 1000;
    return work;
}

static struct work work_many_flops(const void *plan)
{
    struct work work = bp_work(plan);
    work.flops *= 1000;
    return work;
}

static struct work work_without_pairs(const void *plan)
{
    struct work work = bp_work(plan);
    work.pairs = 0;
    return work;
}

static struct work work_three_pairs(const void *plan)
{
    struct work work = bp_work(plan);
    work.pairs = 3;
    return work;
}

static struct work work_one_byte(const void *plan)
{
    struct work work = bp_work(plan);
    work.bytes = 1;
    return work;
}

static void destroy_nothing(void *plan)
{
    (void)plan;
}

/* ---- the table ---- */

static const struct fault {
    const char *name, *says;  /* a part of the message */
    struct algorithm differs; /* what is not as in a good one */
} faults[] = {
    {"none", NULL, {0}},
    {"double declared integer", "scale: a field of 0 bytes", {.params = by_hand}},
    {"leak", "raw, float: destroy leaves 1 blocks of 1 bytes", {.plan = plan_leaks}},
    {"plan kept", "raw, float: destroy leaves", {.destroy = destroy_nothing}},
    {"fftw_alloc in execute", "raw, float: execute allocates 2 and frees 2 blocks", {.execute = execute_allocates}},
    {"fftw_plan in execute", "raw, float: execute makes 2 FFT plans", {.execute = execute_plans}},
    {"flops off by 1000", "ordinary: work.flops is", {.work = work_few_flops}},
    {"flops 1000 times too many", "work.flops is", {.work = work_many_flops}},
    {"3 pairs", "ordinary: work.pairs is 3,", {.work = work_three_pairs}},
    {"1 byte", "raw, float: work.bytes is 1,", {.work = work_one_byte}},
    {"aperture limit ignored",
     "aperture limit: the error against reference is",
     {.plan = plan_unlimited, .work = work_without_pairs}},
    {"y ignored", "curved track in space: the error against reference is", {.plan = plan_without_y}},
    {"z ignored", "curved track in space: the error against reference is", {.plan = plan_without_z}},
    {"velocity along x only", "curved track in space: the error against reference is", {.plan = plan_along_x}},
    {"t0 of the first ping", "curved track in space: the error against reference is", {.plan = plan_one_t0}},
    {"straight tracks only",
     "curved track in space: refused, \"the track is not straight\"",
     {.plan = plan_straight_only}},
    {"no reason", "one ping: plan returns status 3, \"no\"", {.plan = plan_without_reason}},
    {"half a plan", "raw: without the memory of allocation 0 plan leaves 1 blocks", {.plan = plan_half_made}},
    {"races", "other bits", {.execute = execute_races}},
    {"last pixel not written", "the error against reference is", {.execute = execute_last_pixel}},
    {"NaN", "ordinary: the error against reference is nan, must be at most 0.15", {.execute = execute_nan}},
    {"not linear", "sum of two echoes: the difference", {.execute = execute_adds}},
    {"not exact", "ordinary: the error against reference is 0.0", {.traits = TRAIT_EXACT}},
    {"without a baseline", "no row of it; `./sasbench baseline` adds them", {.name = "no_such_algorithm"}},
};
enum { FAULTS = sizeof faults / sizeof *faults };

/* Takes the name of a shipped one, whose rows are in the baseline. */
static struct algorithm faulty = {
    .name = "bp_nearest",
    .summary = "nearest-neighbour back projection with a fault",
    .reference = "none",
    .traits = TRAIT_ANY_TRACK | TRAIT_APERTURE_LIMIT,
    .options_size = sizeof(struct options),
    .plan = plan_good,
    .execute = bp_execute,
    .work = bp_work,
    .destroy = bp_destroy,
};
const struct algorithm *const algorithms[] = {&reference, &faulty, NULL};

const struct algorithm *algorithm_find(const char *name)
{
    for (int k = 0; algorithms[k]; k++)
        if (strcmp(algorithms[k]->name, name) == 0)
            return algorithms[k];
    return NULL;
}

static int run_with(const char *name)
{
    for (int k = 0; k < FAULTS && !injected; k++)
        if (strcmp(faults[k].name, name) == 0)
            injected = &faults[k];
    assert_non_null(injected);
    const struct algorithm *d = &injected->differs;
    faulty.name = d->name ? d->name : faulty.name;
    faulty.params = d->params;
    faulty.traits |= d->traits;
    faulty.plan = d->plan ? d->plan : faulty.plan;
    faulty.execute = d->execute ? d->execute : faulty.execute;
    faulty.work = d->work ? d->work : faulty.work;
    faulty.destroy = d->destroy ? d->destroy : faulty.destroy;
    return conformance_run(&faulty);
}

static const char *program;

/* Everything that the program with this fault prints; its exit status. */
static int output_of(const char *fault, char *text, size_t size)
{
    setenv("FAULTY", program, 1);
    setenv("FAULT", fault, 1);
    FILE *pipe = popen("\"$FAULTY\" \"$FAULT\" 2>&1", "r");
    assert_non_null(pipe);
    size_t length = fread(text, 1, size - 1, pipe);
    text[length] = '\0';
    return pclose(pipe);
}

static void each_fault_is_caught(void **state)
{
    (void)state;
    static char text[1 << 16];
    int missed = 0;
    for (int k = 0; k < FAULTS; k++) {
        int status = output_of(faults[k].name, text, sizeof text);
        const char *says = faults[k].says ? strstr(text, faults[k].says) : NULL;
        bool right = faults[k].says ? WIFEXITED(status) && WEXITSTATUS(status) > 0 && says : status == 0;
        print_message("%s: %.*s\n", faults[k].name, says ? (int)strcspn(says, "\n") : 0, says ? says : "");
        if (!right)
            print_error("%s: status %d, must %s\n%s\n", faults[k].name, status,
                        faults[k].says ? "fail and say" : "pass", faults[k].says ? faults[k].says : text);
        missed += !right;
    }
    assert_int_equal(missed, 0);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_fault_is_caught),
    };
    program = argv[0];
    return argc > 1 ? run_with(argv[1]) : cmocka_run_group_tests_name("conformance faults", tests, NULL, NULL);
}
