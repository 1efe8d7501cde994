/* Any tiny acquisition and grid that the checks of echo files let through: every algorithm makes a plan and a finite
   image of it, or says why not. */
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "choice/choice.h"
#include "methods/automatic.h"
#include "echoes/echo_data.h"
#include "scene/random.h"
#include "scene/scene.h"
#include "tests/fuzz/input.h"

enum { OPTIONS_SIZE = 512 };

int LLVMFuzzerInitialize(int *count, char ***arguments)
{
    (void)count;
    (void)arguments;
    omp_set_num_threads(1);
    return 0;
}

static struct vector take_vector(struct bytes *bytes, double reach)
{
    double x = take_number(bytes, -reach, reach), y = take_number(bytes, -reach, reach);
    return (struct vector){x, y, take_number(bytes, -reach, reach)};
}

/* Receivers and transmitters: on a uniform straight track, or anywhere. */
static void places_fill(struct bytes *bytes, struct acquisition *a)
{
    bool straight = take_byte(bytes) % 4 != 0;
    double first = take_number(bytes, -1, 1), spacing = take_number(bytes, -0.5, 0.5);
    double offset = take_number(bytes, -1, 1), pitch = take_number(bytes, -0.1, 0.1);
    double t0 = take_number(bytes, 0, 0.02), speed = take_number(bytes, -10, 10);
    for (int p = 0; p < a->pings; p++) {
        a->t0[p] = straight ? t0 : take_number(bytes, 0, 0.02);
        a->tx[p] = straight ? (struct vector){first + p * spacing, 0, 0} : take_vector(bytes, 2);
        a->velocity[p] = straight ? (struct vector){speed, 0, 0} : take_vector(bytes, 10);
        for (int m = 0; m < a->receivers; m++) {
            struct vector *rx = &a->rx[p * a->receivers + m];
            *rx = straight ? (struct vector){a->tx[p].x + (offset + m * pitch), 0, 0} : take_vector(bytes, 2);
        }
    }
}

/* As an echo file would bring it: false where the checks refuse it. */
static bool acquisition_take(struct bytes *bytes, struct acquisition *a)
{
    *a = (struct acquisition){.echo_sine = 0, .aperture_limit = INFINITY};
    a->samples = take_integer(bytes, 2, 65);
    a->receivers = take_integer(bytes, 1, 4);
    a->pings = take_integer(bytes, 1, 9);
    a->compressed = take_byte(bytes) % 2;
    a->pulse_length = a->compressed ? 0 : take_integer(bytes, 1, 16);
    a->sound_speed = take_number(bytes, 100, 3000);
    a->fs = take_number(bytes, 1e3, 1e5);
    a->bandwidth = take_byte(bytes) % 4 ? a->fs / 2 : take_number(bytes, 1e3, 1e5);
    a->fc = take_number(bytes, 0, 3e5);
    a->tx_length = take_byte(bytes) % 2 ? take_number(bytes, 0, 1) : 0;
    a->rx_length = a->tx_length;
    if (take_byte(bytes) % 4 == 0)
        a->aperture_limit = take_number(bytes, 0, 1);
    if (acquisition_allocate(a) != STATUS_OK)
        return false;
    places_fill(bytes, a);
    for (int k = 0; k < a->pulse_length; k++) { /* the reader of echo files brings pulses to about 1 */
        double re = take_byte(bytes) / 128.0 - 1;
        a->pulse[k] = __builtin_complex(re, take_byte(bytes) / 128.0 - 1);
    }
    return acquisition_check(a, "fuzz") == STATUS_OK;
}

static bool grid_take(struct bytes *bytes, const struct acquisition *a, struct grid *grid)
{
    *grid = (struct grid){.x_first = take_number(bytes, -2, 2),
                          .x_step = take_number(bytes, 0, 0.2),
                          .x_count = take_integer(bytes, 1, 40),
                          .r_first = take_number(bytes, -1, 20),
                          .r_step = take_number(bytes, 0, 0.2),
                          .r_count = take_integer(bytes, 1, 9)};
    return grid_check(grid, "fuzz") == STATUS_OK && grid_meets_records(a, 1, grid, "fuzz") == STATUS_OK;
}

/* Any settings within their bounds, but none beyond 16, for a few pixels shall not take seconds. */
static void options_take(struct bytes *bytes, const struct algorithm *algorithm, void *options)
{
    memset(options, 0, algorithm->options_size); /* as a SPEC leaves what has no key */
    for (const struct param *param = algorithm->params; param && param->name; param++) {
        double most = fmin(param->max, fmax(16, param->initial)), share = take_byte(bytes) / 255.0;
        double value = share == 0 ? param->initial : param->min + (most - param->min) * share;
        if (param->type == PARAM_REAL)
            *(double *)((char *)options + param->offset) = value;
        else
            *(int *)((char *)options + param->offset) = (int)lround(value);
    }
}

static void image_form(const struct algorithm *algorithm, const struct problem *problem, const void *options,
                       const struct echoes *echoes)
{
    void *plan = NULL;
    struct image image;
    struct stages stages;
    enum status status = algorithm_plan(algorithm, problem, options, &plan);
    if (status != STATUS_OK) {
        if (plan || !*status_message())
            fuzz_fail("%s: refused without a message, or with a plan", algorithm->name);
        return;
    }
    if (image_allocate(problem->patch_count, problem->patches, problem->precision, &image) == STATUS_OK) {
        stages_begin(&stages);
        if (algorithm->execute(plan, echoes, &image, &stages) == STATUS_OK && !image_is_finite(&image))
            fuzz_fail("%s: an image that is not finite", algorithm->name);
        image_free(&image);
    }
    struct work work = algorithm->work(plan);
    if (!(work.flops >= 0 && work.bytes >= 0 && work.pairs >= 0))
        fuzz_fail("%s: work of %g FLOPs, %g pairs, %g bytes", algorithm->name, work.flops, work.pairs, work.bytes);
    algorithm->destroy(plan);
}

/* What `auto` makes of it: a choice, whose image is finite as well. */
static void choice_form(const struct problem *problem, const struct automatic_options *options,
                        const struct echoes *double_echoes)
{
    const struct budget budget = {.error = options->error, .bytes = 1e9 * options->memory, .seconds = INFINITY};
    struct echoes echoes[2] = {[PRECISION_DOUBLE] = *double_echoes};
    struct choice choice;
    if (echoes_convert(double_echoes, PRECISION_FLOAT, &echoes[PRECISION_FLOAT]) != STATUS_OK)
        return;
    if (choice_make(problem, echoes, &budget, &choice) == STATUS_OK) {
        if (choice.image.patch_count > 0 && !image_is_finite(&choice.image))
            fuzz_fail("auto: an image that is not finite");
        if (choice.found && !(choice.work.bytes <= budget.bytes))
            fuzz_fail("auto: %g bytes of %g", choice.work.bytes, budget.bytes);
        choice_free(&choice);
    }
    echoes_free(&echoes[PRECISION_FLOAT]);
}

static void echoes_image(struct bytes *bytes, const struct acquisition *a, const struct grid *grid)
{
    struct problem problem = problem_make(a, 1, grid, take_byte(bytes) % 2 ? PRECISION_DOUBLE : PRECISION_FLOAT);
    struct echoes echoes, converted;
    _Alignas(max_align_t) char options[OPTIONS_SIZE];
    if (echoes_allocate(a, PRECISION_DOUBLE, &echoes) != STATUS_OK)
        return;
    struct random random = random_seed(take_byte(bytes), 0);
    for (int k = 0; k < a->pings * a->receivers * a->samples; k++)
        ((double complex *)echoes.samples)[k] = random_normal(&random);
    if (echoes_convert(&echoes, problem.precision, &converted) == STATUS_OK) {
        for (int k = 0; algorithms[k]; k++) {
            if (algorithms[k]->options_size > sizeof options)
                fuzz_fail("%s: options of %zu bytes", algorithms[k]->name, algorithms[k]->options_size);
            options_take(bytes, algorithms[k], options);
            if (algorithms[k]->plan)
                image_form(algorithms[k], &problem, algorithms[k]->options_size > 0 ? options : NULL, &converted);
            else
                choice_form(&problem, (const struct automatic_options *)options, &echoes);
        }
        echoes_free(&converted);
    }
    echoes_free(&echoes);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct bytes bytes = {data, data + size};
    struct acquisition acquisition;
    struct grid grid;
    if (acquisition_take(&bytes, &acquisition) && grid_take(&bytes, &acquisition, &grid))
        echoes_image(&bytes, &acquisition, &grid);
    acquisition_free(&acquisition);
    return 0;
}
