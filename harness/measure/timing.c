#include "measure/timing.h"

#include <dirent.h>
#include <fcntl.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "common/clock.h"
#include "common/memory.h"
#include "echoes/echo_data.h"
#include "guests/keeper.h"
#include "imaging/imaging.h"
#include "measure/guise.h"

#define FLOPS_MOST    1e12 /* a second and thread: no processor does as many */
#define THREADS_SLACK 1.1  /* of processor time over threads times run time, for clocks that tick differently */

static int compare_double(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double median(double *values, int count)
{
    if (count == 0)
        return NAN;
    qsort(values, (size_t)count, sizeof *values, compare_double);
    return count % 2 ? values[count / 2] : (values[count / 2 - 1] + values[count / 2]) / 2;
}

double quantile(double *values, int count, double share)
{
    if (count == 0)
        return NAN;
    qsort(values, (size_t)count, sizeof *values, compare_double);
    const double place = share * (count - 1);
    const int below = (int)floor(place);
    return below + 1 < count ? values[below] + (place - below) * (values[below + 1] - values[below])
                             : values[count - 1];
}

double timing_spread(const struct timing *timing)
{
    return (timing->run_q3_s - timing->run_q1_s) / timing->run_s;
}

/* s: how long threads of this process were ready to run without a processor, in total; NAN where Linux does not
   report it. */
static double waited_s(void)
{
    DIR *threads = opendir("/proc/self/task");
    double sum = 0;
    if (!threads)
        return NAN;
    for (struct dirent *entry; (entry = readdir(threads));) {
        char path[300];
        long long waited;
        snprintf(path, sizeof path, "/proc/self/task/%s/schedstat", entry->d_name);
        FILE *file = entry->d_name[0] == '.' ? NULL : fopen(path, "r");
        if (file && fscanf(file, "%*d %lld", &waited) == 1)
            sum += 1e-9 * (double)waited;
        if (file)
            fclose(file);
    }
    closedir(threads);
    return sum;
}

/* s of processor time that the system used for this process. */
static double system_s(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? usage.ru_stime.tv_sec + 1e-6 * usage.ru_stime.tv_usec : 0;
}

/* Runs that are compared. */
struct trial {
    struct imaging *imaging;
    struct guise guise;
};

/* Pixels that the imaging leaves unwritten stay NaN, which imaging_finish refuses. */
static enum status run_once(struct trial *trial, struct stages *stages, double *seconds)
{
    struct imaging *imaging = trial->imaging;
    guise_spoil(&imaging->image);
    stages_begin(stages);
    double start = stages->mark;
    enum status status = imaging_execute(imaging, trial->guise.echoes, stages);
    *seconds = seconds_now() - start;
    const enum status next = guise_next(&trial->guise, &imaging->image);
    if (status == STATUS_OK && stages->count == 0)
        return status_set(STATUS_FAILED, "%s: it names no stage, must name at least one", imaging->algorithm->name);
    if (status == STATUS_OK && !imaging_is_fenced(imaging))
        return status_set(STATUS_FAILED, "%s wrote outside its image", imaging->algorithm->name);
    return status == STATUS_OK ? next : status;
}

/* Restore the echoes and their image; filters, which need not be linear, form it again, as do those whose last image is
   of other echoes. */
static enum status trial_end(struct trial *trial, bool whole)
{
    struct stages stages;
    double seconds;
    const bool filtered = trial->imaging->algorithm->traits & TRAIT_FILTERED;
    enum status status = STATUS_OK;
    if (whole && trial->guise.runs > 0 && (!guise_plain(&trial->guise) || (filtered && trial->guise.runs % 2 == 0)))
        status = run_once(trial, &stages, &seconds);
    const enum status ended = guise_end(&trial->guise, &trial->imaging->image);
    return ended == STATUS_OK ? status : ended;
}

/* s of processor time that the process used, and external programs. */
static double busy_s(void)
{
    struct timespec now;
    const double own =
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now) == 0 ? (double)now.tv_sec + 1e-9 * (double)now.tv_nsec : 0;
    return own + keepers_busy_s();
}

/* How long runs are repeated: by effort, and in one of several rounds. */
static const struct budget {
    int runs_fewest, runs_least; /* number of runs beyond seconds_most; within it */
    double seconds_least, seconds_most;
    double first_counts,
        single; /* s: a first run of at least this counts, since it warms up meanwhile; is the only one */
} budgets[] = {[EFFORT_BRIEF] = {2, 5, 0.04, 0.15, 0.04, 0.3}, [EFFORT_WHOLE] = {3, 5, 0.5, 3, 10, 10}},
  part = {1, 2, 0.5 / TIMING_ROUNDS, 3.0 / TIMING_ROUNDS, 0.5, 10};

/* Of a first run: beyond it, the time is mostly the system's allocation of memory. */
static const double system_share_most = 0.25;

/* Append the times of repeated runs to those of earlier rounds. */
static enum status repeat(struct trial *trial, const struct budget *budget, struct timing_samples *samples)
{
    double first, begin = seconds_now(), elapsed = 0, waited = waited_s();
    const double system = system_s();
    struct stages stages;
    int runs = 0;
    const int most = budget == &part ? samples->runs + TIMING_RUNS / TIMING_ROUNDS : TIMING_RUNS; /* a round's share */
    enum status status = run_once(trial, &stages, &first);
    const bool cold = system_s() - system > system_share_most * first;
    const bool single = first >= budget->single && !cold;
    if (first >= budget->first_counts && !cold) {
        samples->seconds[samples->runs] = first;
        samples->stages[samples->runs] = stages;
        samples->runs++;
        runs = 1;
        elapsed = seconds_now() - begin;
    } else { /* it warmed up */
        begin = seconds_now();
        waited = waited_s();
    }
    for (; status == STATUS_OK && !single && samples->runs < most
           && (runs < budget->runs_least || elapsed < budget->seconds_least)
           && (runs < budget->runs_fewest || elapsed < budget->seconds_most);
         runs++) {
        status = run_once(trial, &samples->stages[samples->runs], &samples->seconds[samples->runs]);
        samples->runs++;
        elapsed = seconds_now() - begin;
    }
    samples->waited += waited_s() - waited;
    samples->elapsed += elapsed;
    return status;
}

/* Repeated runs, checked against their number of threads. In a virtual machine the two clocks can part for some
   milliseconds: what is too much is measured again. */
static enum status try_runs(struct trial *trial, const struct budget *budget, struct timing_samples *samples)
{
    enum { TRIES = 3 };
    const int threads = omp_get_max_threads();
    double processors = INFINITY;
    enum status status = STATUS_OK;
    for (int k = 0; k < TRIES && status == STATUS_OK && processors > THREADS_SLACK * threads; k++) {
        const double begin = seconds_now(), busy = busy_s();
        status = repeat(trial, budget, samples);
        processors = (busy_s() - busy) / (seconds_now() - begin);
    }
    const enum status ended = trial_end(trial, status == STATUS_OK);
    status = status == STATUS_OK ? ended : status;
    if (status == STATUS_OK && processors > THREADS_SLACK * threads)
        return status_set(STATUS_FAILED, "%s kept %.1f processors busy with --threads %d",
                          trial->imaging->algorithm->name, processors, threads);
    return status;
}

/* Stages are those of the run nearest the median. */
static void samples_evaluate(const struct timing_samples *samples, struct timing *timing)
{
    static double sorted[TIMING_RUNS];
    const int runs = samples->runs;
    for (int k = 0; k < runs; k++)
        sorted[k] = samples->seconds[k];
    timing->waited = samples->elapsed > 0 ? samples->waited / samples->elapsed : NAN;
    timing->runs = runs;
    timing->run_s = median(sorted, runs);
    timing->run_min_s = sorted[0];
    timing->run_q1_s = runs >= 4 ? quantile(sorted, runs, 0.25) : NAN;
    timing->run_q3_s = runs >= 4 ? quantile(sorted, runs, 0.75) : NAN;
    int nearest = 0;
    for (int k = 1; k < runs; k++)
        if (fabs(samples->seconds[k] - timing->run_s) < fabs(samples->seconds[nearest] - timing->run_s))
            nearest = k;
    timing->stages = samples->stages[nearest];
}

struct control control_begin(const struct problem *problem, const struct echoes *echoes)
{
    return (struct control){.problem = *problem, .echoes = echoes, .measured = -INFINITY};
}

void control_end(struct control *control)
{
    scalar_loop_free(&control->loop);
    turned_free(&control->turned);
    *control = (struct control){.open = false};
}

static enum status control_open(struct control *control)
{
    enum status status = problem_turn_back(&control->problem, &control->turned, NULL);
    if (status == STATUS_OK)
        control->loop = scalar_loop_choose(&control->problem, control->echoes);
    control->open = status == STATUS_OK;
    return status;
}

/* Time the loop into control->seconds; *least is the faster run. With `recent`, a measurement of the last second is
   used again. */
static enum status control_measure(struct control *control, bool recent, double *least)
{
    enum status status = control->open ? STATUS_OK : control_open(control);
    if (status != STATUS_OK)
        return status;
    if (!recent || seconds_now() - control->measured > 1) {
        for (int k = 0; k < CONTROL_RUNS; k++)
            control->seconds[k] = scalar_loop_seconds(&control->loop);
        control->measured = seconds_now();
    }
    *least = fmin(control->seconds[0], control->seconds[1]);
    return STATUS_OK;
}

/* Add the scalar reference loop's times to the samples; *least: the faster one. */
static enum status control_sample(struct control *control, bool recent, struct timing_samples *samples, double *least)
{
    enum status status = control_measure(control, recent, least);
    for (int k = 0; k < CONTROL_RUNS && status == STATUS_OK && samples->controls < TIMING_CONTROLS; k++)
        samples->control[samples->controls++] = control->seconds[k];
    return status;
}

enum status timing_measure(const struct spec *spec, const struct problem *problem, struct echoes *echoes,
                           struct control *control, enum effort effort, struct timing_samples *samples,
                           struct image *image, struct timing *timing)
{
    static struct timing_samples own;
    const struct budget *budget = samples ? &part : &budgets[effort];
    struct imaging imaging;
    double before = 0, after = 0;
    own = (struct timing_samples){.runs = 0};
    samples = samples ? samples : &own;
    *timing = (struct timing){0};
    *image = (struct image){0};
    enum status status = imaging_open(spec, problem, &imaging);
    if (status != STATUS_OK)
        return status;
    timing->plan_s = imaging.plan_s;
    timing->work = imaging.algorithm->work(imaging.plan);
    status = control_sample(control, true, samples, &before);
    const double begin = seconds_now();
    if (status == STATUS_OK)
        status = try_runs(&(struct trial){&imaging, guise_begin(imaging.algorithm, echoes)}, budget, samples);
    timing->spent_s = seconds_now() - begin;
    if (status == STATUS_OK)
        status = control_sample(control, effort == EFFORT_BRIEF, samples, &after);
    if (status == STATUS_OK)
        status = imaging_finish(&imaging, echoes, image);
    imaging_close(&imaging);
    if (status == STATUS_OK) {
        const struct work *work = &timing->work;
        struct work_bounds bounds = work_bounds(spec->algorithm, spec->options, problem, work);
        const bool empty = bounds.pairs <= 0;
        double sorted[TIMING_CONTROLS];
        timing->drift = after / before - 1;
        for (int k = 0; k < samples->controls; k++)
            sorted[k] = samples->control[k];
        timing->control_s = median(sorted, samples->controls) * bounds.pairs;
        samples_evaluate(samples, timing);
        if (spec->algorithm->traits & TRAIT_FILTERED) /* a chain checks its last link's least */
            bounds = (struct work_bounds){.pairs = work->pairs};
        bounds.flops_most = FLOPS_MOST * omp_get_max_threads() * timing->run_min_s;
        if (empty)
            status = status_set(STATUS_UNSUPPORTED, "no ping and pixel meet within beam, aperture and record: "
                                                    "there is nothing to image");
        else if (timing->run_min_s <= 0 || timing->control_s <= 0)
            status = status_set(STATUS_FAILED,
                                "a run of %s takes %g s, of the scalar reference loop %g s: the system's "
                                "clock stands still",
                                spec->algorithm->name, timing->run_min_s, timing->control_s);
        else
            status = work_check(spec->algorithm->name, &bounds, work);
    }
    if (status != STATUS_OK)
        image_free(image);
    return status;
}

static int waits = -1; /* Linux's account of the thread, while waiting is excluded */

/* Its second number: ns that the thread was ready to run without a processor. */
static long long waited_ns(void)
{
    char text[80];
    long long waited = 0;
    ssize_t length = waits >= 0 ? pread(waits, text, sizeof text - 1, 0) : 0;
    text[length > 0 ? length : 0] = '\0';
    sscanf(text, "%*d %lld", &waited);
    return waited;
}

/* s of processor time that the thread used. */
static double processor_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Linux's account costs microseconds, so it is read only when the thread has not run for a while since the last
   reading. */
static double clock_without_waiting(void)
{
    static const double while_s = 2e-6;
    static double idle = -1; /* s: of the system's clock, without the processor, at the last reading */
    static long long waited;
    double now = clock_monotonic();
    if (idle >= 0 && now - processor_s() - idle < while_s)
        return now - 1e-9 * (double)waited;
    do { /* repeat if the thread lost the processor between the two clocks */
        waited = waited_ns();
        now = clock_monotonic();
        idle = now - processor_s();
    } while (waited_ns() != waited);
    return now - 1e-9 * (double)waited;
}

void seconds_skip_waiting(void)
{
    waits = open("/proc/thread-self/schedstat", O_RDONLY | O_CLOEXEC);
    clock_set(clock_without_waiting);
}
