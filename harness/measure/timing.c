#include "measure/timing.h"

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

enum { RUNS_FEWEST = 3, RUNS_LEAST = 5, RUNS_MOST = 1000 };
static const double seconds_least = 0.5, seconds_most = 3, seconds_single = 10;

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

static enum status run_once(struct imaging *imaging, const struct echoes *echoes, struct stages *stages,
                            double *seconds)
{
    stages_begin(stages);
    double start = stages->mark;
    enum status status = imaging_execute(imaging, echoes, stages);
    *seconds = seconds_now() - start;
    return status;
}

/* Times of the repeated runs; stages of the run nearest the median. */
static enum status repeat(struct imaging *imaging, const struct echoes *echoes, struct timing *timing)
{
    static double seconds[RUNS_MOST], sorted[RUNS_MOST];
    static struct stages stages[RUNS_MOST];
    enum status status = run_once(imaging, echoes, &stages[0], &seconds[0]); /* warms up */
    int runs = seconds[0] >= seconds_single;
    double begin = seconds_now(), elapsed = 0;
    while (status == STATUS_OK && seconds[0] < seconds_single && runs < RUNS_MOST
           && (runs < RUNS_LEAST || elapsed < seconds_least) && (runs < RUNS_FEWEST || elapsed < seconds_most)) {
        status = run_once(imaging, echoes, &stages[runs], &seconds[runs]);
        runs++;
        elapsed = seconds_now() - begin;
    }
    if (status != STATUS_OK)
        return status;
    for (int k = 0; k < runs; k++)
        sorted[k] = seconds[k];
    timing->runs = runs;
    timing->run_s = median(sorted, runs);
    timing->run_min_s = sorted[0];
    timing->run_q1_s = runs >= 4 ? quantile(sorted, runs, 0.25) : NAN;
    timing->run_q3_s = runs >= 4 ? quantile(sorted, runs, 0.75) : NAN;
    int nearest = 0;
    for (int k = 1; k < runs; k++)
        if (fabs(seconds[k] - timing->run_s) < fabs(seconds[nearest] - timing->run_s))
            nearest = k;
    timing->stages = stages[nearest];
    return STATUS_OK;
}

enum status timing_measure(const struct spec *spec, const struct problem *problem, const struct echoes *echoes,
                           const struct echoes *control_echoes, struct image *image, struct timing *timing)
{
    double control[4];
    struct imaging imaging;
    struct problem back = *problem; /* the control knows rows and columns along x and r only */
    struct turned_problem turned;
    *timing = (struct timing){0};
    *image = (struct image){0};
    enum status status = imaging_open(spec, problem, &imaging);
    if (status != STATUS_OK)
        return status;
    status = problem_turn_back(&back, &turned, NULL);
    if (status == STATUS_OK) {
        timing->plan_s = imaging.plan_s;
        timing->work = imaging.algorithm->work(imaging.plan);
        control[0] = control_seconds_per_pair(&back, control_echoes);
        control[1] = control_seconds_per_pair(&back, control_echoes);
        status = repeat(&imaging, echoes, timing);
    }
    if (status == STATUS_OK)
        status = imaging_finish(&imaging, echoes, image);
    imaging_close(&imaging);
    if (status == STATUS_OK) {
        control[2] = control_seconds_per_pair(&back, control_echoes);
        control[3] = control_seconds_per_pair(&back, control_echoes);
        double pairs = timing->work.pairs > 0 ? timing->work.pairs : pairs_count(&back);
        timing->control_s = median(control, 4) * pairs;
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
    struct timing timing;
    repeat(&imaging, NULL, &timing);
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
