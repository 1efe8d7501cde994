/* Processes of a trial (trial.h). The parent never starts an OpenMP thread: it could not be forked afterwards. */
#define _GNU_SOURCE /* MAP_ANONYMOUS */
#include "stability/trial.h"

#include <fenv.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "echoes/echo_data.h"
#include "guests/keeper.h"
#include "imaging/imaging.h"
#include "scene/simulate.h"
#include "stability/method.h"

static const int modes[TRIAL_MODES] = {FE_TONEAREST, FE_DOWNWARD, FE_UPWARD, FE_TOWARDZERO};
const char *const trial_mode_names[TRIAL_MODES] = {"nearest", "downward", "upward", "zero"};

enum { PATIENCE_S = 300 }; /* of one process */

const struct attempt *trial_attempt(const struct trial *trial, int mode, int spec)
{
    return &trial->attempts[mode * trial->spec_count + spec];
}

const double complex *trial_image(const struct trial *trial, int mode, int spec)
{
    return trial->images + (size_t)(mode * trial->spec_count + spec) * trial->pixels;
}

/* ---- in a process of its own ---- */

static enum status echoes_make(struct trial *trial, int unused)
{
    struct echoes echoes;
    (void)unused;
    enum status status = scene_echoes(trial->scene, &echoes);
    if (status != STATUS_OK)
        return status;
    memcpy(trial->samples, echoes.samples, samples_bytes(&trial->scene->acquisition, PRECISION_DOUBLE));
    trial->note->exponent = echoes.exponent;
    echoes_free(&echoes);
    return STATUS_OK;
}

/* Form the image with a number of threads; record exceptions of plan and execute. */
static enum status image_form(const struct scene *scene, const struct echoes *echoes, const struct spec *spec,
                              int threads, struct image *image, struct attempt *attempt)
{
    const struct problem problem = scene_problem(scene, spec->precision);
    struct work work;
    omp_set_num_threads(threads);
    feclearexcept(FE_ALL_EXCEPT);
    enum status status = imaging_form(spec, &problem, &echoes[spec->precision], image, &work);
    if (threads == 1)
        attempt->exceptions = fetestexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
    if (status == STATUS_OK)
        snprintf(attempt->engine, sizeof attempt->engine, "%s", work.engine);
    return status;
}

static void attempt_make(const struct scene *scene, const struct echoes *echoes, const struct spec *spec,
                         struct attempt *attempt, double complex *pixels)
{
    struct image one, two;
    enum status status = image_form(scene, echoes, spec, 1, &one, attempt);
    if (status == STATUS_OK) {
        status = image_form(scene, echoes, spec, 2, &two, attempt);
        attempt->same_bits = status == STATUS_OK;
        for (int k = 0; k < one.patch_count && status == STATUS_OK; k++) {
            const struct grid *patch = &one.patches[k];
            const size_t columns = (size_t)patch->x_count, count = columns * (size_t)patch->r_count;
            const bool same = memcmp(one.pixels[k], two.pixels[k], count * precision_size(one.precision)) == 0;
            attempt->same_bits = attempt->same_bits && same;
            for (size_t i = 0; i < count; i++)
                *pixels++ = image_pixel(&one, k, (int)(i / columns), (int)(i % columns));
        }
        image_free(&one);
        image_free(&two);
    }
    attempt->status = status;
    if (status != STATUS_OK)
        snprintf(attempt->message, sizeof attempt->message, "%s", status_message());
    attempt->done = true;
}

/* All specs that are not finished yet. */
static enum status mode_run(struct trial *trial, int mode)
{
    const struct echoes shared = {&trial->scene->acquisition, PRECISION_DOUBLE, trial->samples, trial->note->exponent};
    struct echoes echoes[2]; /* by enum precision */
    if (fesetround(modes[mode]) != 0 || echoes_convert(&shared, PRECISION_FLOAT, &echoes[PRECISION_FLOAT]) != STATUS_OK
        || echoes_convert(&shared, PRECISION_DOUBLE, &echoes[PRECISION_DOUBLE]) != STATUS_OK)
        _exit(3);
    for (int k = 0; k < trial->spec_count; k++) {
        struct attempt *attempt = &trial->attempts[mode * trial->spec_count + k];
        if (!attempt->done)
            attempt_make(trial->scene, echoes, &trial->specs[k], attempt,
                         (double complex *)trial_image(trial, mode, k));
    }
    echoes_free(&echoes[PRECISION_FLOAT]);
    echoes_free(&echoes[PRECISION_DOUBLE]);
    return STATUS_OK;
}

/* Scale to the samples as recorded. */
static void sums_scale(const struct trial *trial, struct exact_sum *sums)
{
    for (size_t i = 0; i < trial->pixels; i++) {
        long double *const parts[] = {&sums[i].re, &sums[i].im, &sums[i].size, &sums[i].ties};
        for (size_t k = 0; k < sizeof parts / sizeof *parts; k++)
            *parts[k] = ldexpl(*parts[k], trial->note->exponent);
    }
}

/* The right image, and each method's own sum where it made an image. */
static enum status exact_make(struct trial *trial, int unused)
{
    (void)unused;
    const struct scene *scene = trial->scene;
    const struct problem problem = scene_problem(scene, PRECISION_DOUBLE);
    enum status status = trial->ideal_excludes ? STATUS_OK : exact_ideal(scene, trial->ideal);
    for (int k = 0; k < trial->spec_count && status == STATUS_OK && scene->acquisition.compressed; k++) {
        const struct attempt *attempt = trial_attempt(trial, 0, k);
        const struct method method = method_of(&trial->specs[k], attempt->engine, &problem);
        struct exact_sum *sums = trial->exact + (size_t)k * trial->pixels;
        if (method.has_reading && attempt->status == STATUS_OK) {
            status = exact_method(&problem, trial->samples, &method.reading, sums);
            sums_scale(trial, sums);
        }
    }
    return status;
}

/* ---- the parent ---- */

/* Run `work` in a process of its own; *state is the one from waitpid. */
static enum status process_run(struct trial *trial, enum status (*work)(struct trial *, int), int argument, int *state)
{
    fflush(NULL);
    pid_t child = fork();
    if (child < 0)
        return status_set(STATUS_FAILED, "%s: no process can be started", trial->scene->name);
    if (child == 0) {
        signals_reset();
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        alarm(PATIENCE_S);
        trial->note->status = work(trial, argument);
        if (trial->note->status != STATUS_OK)
            snprintf(trial->note->message, sizeof trial->note->message, "%s", status_message());
        _exit(0);
    }
    if (waitpid(child, state, 0) != child)
        return status_set(STATUS_FAILED, "%s: a process was lost", trial->scene->name);
    return STATUS_OK;
}

/* A process that must succeed: echoes, exact images. */
static enum status process_need(struct trial *trial, enum status (*work)(struct trial *, int), const char *what)
{
    int state;
    enum status status = process_run(trial, work, 0, &state);
    if (status != STATUS_OK)
        return status;
    if (!WIFEXITED(state) || WEXITSTATUS(state) != 0)
        return status_set(STATUS_FAILED, "%s: the process of the %s ended by signal %d", trial->scene->name, what,
                          WIFSIGNALED(state) ? WTERMSIG(state) : 0);
    return trial->note->status == STATUS_OK ? STATUS_OK : status_set(trial->note->status, "%s", trial->note->message);
}

/* A spec that crashes its process is recorded, and another process continues with the rest. */
static enum status mode_trial(struct trial *trial, int mode)
{
    for (;;) {
        int state;
        enum status status = process_run(trial, mode_run, mode, &state);
        if (status != STATUS_OK || (WIFEXITED(state) && WEXITSTATUS(state) == 0))
            return status;
        struct attempt *next = &trial->attempts[mode * trial->spec_count], *end = next + trial->spec_count;
        while (next < end && next->done)
            next++;
        if (next == end || WIFEXITED(state))
            return status_set(STATUS_FAILED, "%s: the process in rounding mode %s ended with status %d",
                              trial->scene->name, trial_mode_names[mode], WIFEXITED(state) ? WEXITSTATUS(state) : 0);
        *next = (struct attempt){.done = true, .status = STATUS_FAILED, .is_stopped = true};
        snprintf(next->message, sizeof next->message, "ended by signal %d (%s)", WTERMSIG(state),
                 strsignal(WTERMSIG(state)));
    }
}

/* The next part of the shared memory, on cache lines of its own. */
static void *part_take(char **next, size_t bytes)
{
    void *part = *next;
    *next += (bytes + 63) / 64 * 64;
    return part;
}

static enum status memory_share(struct trial *trial)
{
    const size_t specs = (size_t)trial->spec_count, images = TRIAL_MODES * specs, parts = 6;
    const size_t samples = acquisition_samples(&trial->scene->acquisition);
    const size_t bytes = samples * sizeof *trial->samples + images * sizeof *trial->attempts
                         + images * trial->pixels * sizeof *trial->images
                         + (1 + specs) * trial->pixels * sizeof *trial->ideal + sizeof *trial->note + parts * 64;
    void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED)
        return status_set(STATUS_FAILED, "%s: no memory for %.0f MB shared between processes", trial->scene->name,
                          (double)bytes / 1e6);
    char *next = trial->memory = memory;
    trial->bytes = bytes;
    trial->samples = part_take(&next, samples * sizeof *trial->samples);
    trial->attempts = part_take(&next, images * sizeof *trial->attempts);
    trial->images = part_take(&next, images * trial->pixels * sizeof *trial->images);
    trial->ideal = part_take(&next, trial->pixels * sizeof *trial->ideal);
    trial->exact = part_take(&next, specs * trial->pixels * sizeof *trial->exact);
    trial->note = part_take(&next, sizeof *trial->note);
    return STATUS_OK;
}

enum status trial_run(const struct scene *scene, const struct spec *specs, int spec_count, int mode_count,
                      struct trial *trial)
{
    *trial = (struct trial){.scene = scene,
                            .specs = specs,
                            .spec_count = spec_count,
                            .mode_count = mode_count,
                            .pixels = exact_pixels(scene->patch_count, scene->patches),
                            .ideal_excludes = exact_ideal_excludes(scene)};
    enum status status = memory_share(trial);
    if (status != STATUS_OK)
        return status;
    status = process_need(trial, echoes_make, "echoes");
    for (int mode = 0; mode < mode_count && status == STATUS_OK; mode++)
        status = mode_trial(trial, mode);
    if (status == STATUS_OK)
        status = process_need(trial, exact_make, "exact images");
    if (status != STATUS_OK)
        trial_close(trial);
    return status;
}

void trial_close(struct trial *trial)
{
    if (trial->memory)
        munmap(trial->memory, trial->bytes);
    *trial = (struct trial){0};
}
