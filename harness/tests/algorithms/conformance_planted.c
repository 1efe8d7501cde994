#include "tests/algorithms/conformance_planted.h"

#include <fftw3.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "scene/simulate.h"
#include "tests/support.h"

/* ---- plans ---- */

const struct param by_hand[] = {
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

enum status plan_good(const struct problem *problem, const void *method, const void *options, void **plan)
{
    (void)method, (void)options;
    return plan_of(problem->acquisition, problem, plan);
}

enum status plan_leaks(const struct problem *problem, const void *method, const void *options, void **plan)
{
    static void *lost;
    lost = malloc(1);
    return lost ? plan_good(problem, method, options, plan) : status_set(STATUS_FAILED, "no memory to be lost");
}

enum status plan_unlimited(const struct problem *problem, const void *method, const void *options, void **plan)
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

enum status plan_without_y(const struct problem *problem, const void *method, const void *options, void **plan)
{
    (void)method, (void)options;
    return plan_flat(problem, plan, 0, 1, 1);
}

enum status plan_without_z(const struct problem *problem, const void *method, const void *options, void **plan)
{
    (void)method, (void)options;
    return plan_flat(problem, plan, 1, 0, 1);
}

enum status plan_along_x(const struct problem *problem, const void *method, const void *options, void **plan)
{
    (void)method, (void)options;
    return plan_flat(problem, plan, 1, 1, 0);
}

static enum status plan_mirrored(const struct problem *problem, void **plan)
{
    static struct acquisition changed;
    static struct vector velocity[PLACES];
    changed = *problem->acquisition;
    changed.velocity = velocity;
    assert_true(changed.pings <= PLACES);
    for (int p = 0; p < changed.pings; p++)
        velocity[p] = (struct vector){-problem->acquisition->velocity[p].x, 0, 0};
    return plan_of(&changed, problem, plan);
}

enum status plan_one_t0(const struct problem *problem, const void *method, const void *options, void **plan)
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

enum status plan_straight_only(const struct problem *problem, const void *method, const void *options, void **plan)
{
    *plan = NULL;
    if (acquisition_is_straight(problem->acquisition, NULL))
        return plan_good(problem, method, options, plan);
    return status_set(STATUS_UNSUPPORTED, "the track is not straight");
}

enum status plan_without_reason(const struct problem *problem, const void *method, const void *options, void **plan)
{
    *plan = NULL;
    return problem->acquisition->pings > 1 ? plan_good(problem, method, options, plan)
                                           : status_set(STATUS_UNSUPPORTED, "no");
}

/* Keeps what it has when memory ends. */
enum status plan_half_made(const struct problem *problem, const void *method, const void *options, void **plan)
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

enum status execute_allocates(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    fftw_free(fftw_alloc_complex(16));
    return bp_execute(plan, echoes, image, stages);
}

enum status execute_plans(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    static fftwf_complex in[16], out[16];
    fftwf_destroy_plan(fftwf_plan_dft_1d(16, in, out, FFTW_FORWARD, FFTW_ESTIMATE));
    return bp_execute(plan, echoes, image, stages);
}

/* Parts are added in the order in which threads come by. */
enum status execute_races(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
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

enum status execute_last_pixel(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    size_t last = grid_pixels(&image->patches[0]) - 1;
    size_t size = image->precision == PRECISION_DOUBLE ? 16 : 8;
    unsigned char kept[16];
    memcpy(kept, (unsigned char *)image->pixels[0] + last * size, size);
    enum status status = bp_execute(plan, echoes, image, stages);
    memcpy((unsigned char *)image->pixels[0] + last * size, kept, size);
    return status;
}

enum status execute_nan(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    enum status status = bp_execute(plan, echoes, image, stages);
    if (image->precision == PRECISION_DOUBLE)
        ((double *)image->pixels[0])[7] = NAN;
    else
        ((float *)image->pixels[0])[7] = NAN;
    return status;
}

enum status execute_exits(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    (void)plan, (void)echoes, (void)image, (void)stages;
    exit(0);
}

enum status execute_adds(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    enum status status = bp_execute(plan, echoes, image, stages);
    if (image->precision == PRECISION_DOUBLE)
        ((double *)image->pixels[0])[0] += 1e-6;
    return status;
}

/* Every weight a tenth too small. */
enum status execute_gain(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    enum status status = bp_execute(plan, echoes, image, stages);
    for (int k = 0; k < image->patch_count; k++)
        for (int n = 0; n < 2 * image->patches[k].x_count * image->patches[k].r_count; n++)
            if (image->precision == PRECISION_DOUBLE)
                ((double *)image->pixels[k])[n] *= 0.9;
            else
                ((float *)image->pixels[k])[n] *= 0.9F;
    return status;
}

enum status execute_first_patch(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    const size_t size = image->precision == PRECISION_DOUBLE ? 16 : 8;
    enum status status = bp_execute(plan, echoes, image, stages);
    for (int k = 1; k < image->patch_count; k++)
        memset(image->pixels[k], 0, size * grid_pixels(&image->patches[k]));
    return status;
}

enum status execute_threads(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    enum status status = bp_execute(plan, echoes, image, stages);
    omp_set_num_threads(1);
    return status;
}

static volatile double read_sum;

enum status execute_past_end(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    const struct acquisition *a = echoes->acquisition;
    const size_t count = (size_t)a->pings * (size_t)a->receivers * (size_t)a->samples;
    read_sum = echoes->precision == PRECISION_DOUBLE ? ((const double *)echoes->samples)[2 * count]
                                                     : ((const float *)echoes->samples)[2 * count];
    return bp_execute(plan, echoes, image, stages);
}

enum status execute_ahead(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    read_sum = ((const double *)echoes->samples)[-1];
    return bp_execute(plan, echoes, image, stages);
}

enum status execute_maps(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    char *map = mmap(NULL, 1 << 16, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    assert_true(map != MAP_FAILED);
    for (int k = 0; k < 1 << 16; k += 4096)
        map[k] = 1;
    munmap(map, 1 << 16);
    return bp_execute(plan, echoes, image, stages);
}

/* The last image again, while the samples' address is the same. */
enum status execute_memoised(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    static const void *samples, *of;
    static double kept[2 * 2000];
    const size_t size = sizeof(double) * 2 * grid_pixels(&image->patches[0]);
    assert_true(size <= sizeof kept);
    if (samples == echoes->samples && of == plan && image->precision == PRECISION_DOUBLE && image->patch_count == 1) {
        memcpy(image->pixels[0], kept, size);
        stages_end(stages, "focus");
        return STATUS_OK;
    }
    enum status status = bp_execute(plan, echoes, image, stages);
    if (image->precision == PRECISION_DOUBLE) {
        memcpy(kept, image->pixels[0], size);
        samples = echoes->samples;
        of = plan;
    }
    return status;
}

/* The exact image of the targets that the scene around the acquisition knows. */
enum status execute_known(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    const struct acquisition *a = echoes->acquisition;
    const struct scene *around = (const void *)((const char *)a - offsetof(struct scene, acquisition));
    struct scene scene = *around;
    struct echoes own;
    if (scene.target_count == 0 || image->precision == PRECISION_FLOAT)
        return bp_execute(plan, echoes, image, stages);
    assert_int_equal(scene_simulate(&scene, &own), STATUS_OK);
    own.acquisition = a;
    enum status status = bp_execute(plan, &own, image, stages);
    echoes_free(&own);
    return status;
}

static void *latest; /* the plan that was made last */

enum status plan_static(const struct problem *problem, const void *method, const void *options, void **plan)
{
    enum status status = plan_good(problem, method, options, plan);
    latest = *plan;
    return status;
}

enum status execute_static(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    (void)plan;
    return bp_execute(latest, echoes, image, stages);
}

/* What both executes write, before either reads it. */
enum status execute_shared(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    static const void *shared;
    shared = plan;
    usleep(1000);
    enum status status = bp_execute(plan, echoes, image, stages);
    if (shared != plan)
        memset(image->pixels[0], 0, 64);
    return status;
}

enum status plan_maps(const struct problem *problem, const void *method, const void *options, void **plan)
{
    if (mmap(NULL, 1 << 14, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) == MAP_FAILED)
        return status_set(STATUS_FAILED, "no memory to be lost");
    return plan_good(problem, method, options, plan);
}

enum status plan_unturned(const struct problem *problem, const void *method, const void *options, void **plan)
{
    static struct grid grids[2]; /* outlives the plan */
    struct problem changed = *problem;
    for (int k = 0; k < problem->patch_count; k++) {
        grids[k] = problem->patches[k];
        grids[k].angle_rad = 0;
    }
    changed.patches = grids;
    return plan_good(&changed, method, options, plan);
}

/* An engine that takes every track to run towards +x: the velocity's sign is wrong on others. */
enum status plan_forward(const struct problem *problem, const void *method, const void *options, void **plan)
{
    (void)method, (void)options;
    const struct acquisition *a = problem->acquisition;
    return a->pings > 1 && a->tx[1].x < a->tx[0].x ? plan_mirrored(problem, plan) : plan_of(a, problem, plan);
}

enum status forecast_perfect(const struct problem *problem, const void *method, const void *options,
                             struct forecast *forecast)
{
    (void)problem, (void)method, (void)options;
    *forecast = (struct forecast){.error = {1e-9}};
    return STATUS_OK;
}

int conditions_false(const struct problem *problem, const void *method, const void *options, struct condition *list,
                     int room)
{
    (void)problem, (void)method, (void)options, (void)room;
    list[0] = condition_most(SEVERITY_REFUSE, "receivers", 6, 5, "the number of receivers", "fewer");
    return 1;
}

/* Of another type than the field, and one that nothing reads. */
const struct param unread[] = {
    {PARAM(struct options, scale), .summary = "a number that nothing reads", .initial = 1, .min = 1, .max = 9},
    {.name = NULL},
};
