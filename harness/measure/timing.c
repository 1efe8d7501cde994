#include "measure/timing.h"

#include <dirent.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "backprojection/pairs.h"
#include "backprojection/turned.h"
#include "common/clock.h"
#include "measure/imaging.h"
#include "measure/scalar_loop.h"

static const double seconds_single = 10;

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

double quantile(const double *sorted, int count, double share)
{
    if (count == 0)
        return NAN;
    const double place = share * (count - 1);
    const int below = (int)floor(place);
    return below + 1 < count ? sorted[below] + (place - below) * (sorted[below + 1] - sorted[below])
                             : sorted[count - 1];
}

double timing_spread(const struct timing *timing)
{
    return (timing->run_q3_s - timing->run_q1_s) / timing->run_s;
}

/* s: how long threads of this process were ready to run and had no processor, all together; NAN where Linux does not
   say. */
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

static enum status run_once(struct imaging *imaging, const struct echoes *echoes, struct stages *stages,
                            double *seconds)
{
    stages_begin(stages);
    double start = stages->mark;
    enum status status = imaging_execute(imaging, echoes, stages);
    *seconds = seconds_now() - start;
    return status;
}

/* How long runs are repeated, alone or in one of several rounds. */
static const struct budget {
    int runs_fewest, runs_least; /* beyond seconds_most; within */
    double seconds_least, seconds_most;
} whole = {3, 5, 0.5, 3}, part = {1, 2, 0.5 / TIMING_ROUNDS, 3.0 / TIMING_ROUNDS};

/* Times of repeated runs, behind those of earlier rounds. */
static enum status repeat(struct imaging *imaging, const struct echoes *echoes, const struct budget *budget,
                          struct timing_samples *samples)
{
    double first;
    struct stages stages;
    enum status status = run_once(imaging, echoes, &stages, &first); /* warms up */
    double begin = seconds_now(), elapsed = 0, waited = waited_s();
    const bool single = first >= seconds_single;
    if (single && samples->runs == 0) { /* so long that it counts itself */
        samples->seconds[0] = first;
        samples->stages[0] = stages;
        samples->runs = 1;
    }
    for (int runs = 0; status == STATUS_OK && !single && samples->runs < TIMING_RUNS
                       && (runs < budget->runs_least || elapsed < budget->seconds_least)
                       && (runs < budget->runs_fewest || elapsed < budget->seconds_most);
         runs++) {
        status = run_once(imaging, echoes, &samples->stages[samples->runs], &samples->seconds[samples->runs]);
        samples->runs++;
        elapsed = seconds_now() - begin;
    }
    samples->waited += waited_s() - waited;
    samples->elapsed += elapsed;
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

/* The scalar reference loop's seconds for a pair: the faster of two. */
static double control_measure(const struct problem *problem, const struct echoes *echoes,
                              struct timing_samples *samples)
{
    double least = INFINITY;
    for (int k = 0; k < 2; k++) {
        const double seconds = control_seconds_per_pair(problem, echoes);
        least = fmin(least, seconds);
        if (samples->controls < 4 * TIMING_ROUNDS)
            samples->control[samples->controls++] = seconds;
    }
    return least;
}

enum status timing_measure(const struct spec *spec, const struct problem *problem, const struct echoes *echoes,
                           const struct echoes *control_echoes, struct timing_samples *samples, struct image *image,
                           struct timing *timing)
{
    static struct timing_samples own;
    const struct budget *budget = samples ? &part : &whole;
    struct imaging imaging;
    struct problem back = *problem; /* the control knows rows and columns along x and r only */
    struct turned_problem turned;
    double before = 0;
    own = (struct timing_samples){.runs = 0};
    samples = samples ? samples : &own;
    *timing = (struct timing){0};
    *image = (struct image){0};
    enum status status = imaging_open(spec, problem, &imaging);
    if (status != STATUS_OK)
        return status;
    status = problem_turn_back(&back, &turned, NULL);
    if (status == STATUS_OK) {
        timing->plan_s = imaging.plan_s;
        timing->work = imaging.algorithm->work(imaging.plan);
        before = control_measure(&back, control_echoes, samples);
        status = repeat(&imaging, echoes, budget, samples);
    }
    if (status == STATUS_OK)
        status = imaging_finish(&imaging, echoes, image);
    imaging_close(&imaging);
    if (status == STATUS_OK) {
        double pairs = timing->work.pairs > 0 ? timing->work.pairs : pairs_count(&back), sorted[4 * TIMING_ROUNDS];
        timing->drift = control_measure(&back, control_echoes, samples) / before - 1;
        for (int k = 0; k < samples->controls; k++)
            sorted[k] = samples->control[k];
        timing->control_s = median(sorted, samples->controls) * pairs;
        samples_evaluate(samples, timing);
    }
    turned_free(&turned);
    return status;
}

static enum status nothing_execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    (void)plan, (void)echoes, (void)image;
    stages_end(stages, "nothing");
    return STATUS_OK;
}

double timing_floor(void)
{
    const struct algorithm nothing = {.name = "nothing", .execute = nothing_execute};
    struct imaging imaging = {.algorithm = &nothing};
    static struct timing_samples samples;
    struct timing timing;
    samples = (struct timing_samples){.runs = 0};
    repeat(&imaging, NULL, &whole, &samples);
    samples_evaluate(&samples, &timing);
    return timing.run_s;
}

static int waits = -1; /* Linux's account of the thread, when waiting is left out */

/* Its second number: ns that the thread was ready to run and had no processor. */
static long long waited_ns(void)
{
    char text[80];
    long long waited = 0;
    ssize_t length = waits >= 0 ? pread(waits, text, sizeof text - 1, 0) : 0;
    text[length > 0 ? length : 0] = '\0';
    sscanf(text, "%*d %lld", &waited);
    return waited;
}

static double clock_without_waiting(void)
{
    double now;
    long long waited;
    do { /* again when the processor was lost between the two clocks */
        waited = waited_ns();
        now = clock_monotonic();
    } while (waited_ns() != waited);
    return now - 1e-9 * (double)waited;
}

void seconds_skip_waiting(void)
{
    waits = open("/proc/thread-self/schedstat", O_RDONLY | O_CLOEXEC);
    clock_set(clock_without_waiting);
}
