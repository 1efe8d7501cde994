#include "tests/measure/fake_clock.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "measure/scalar_loop.h"
#include "tests/assertions.h"

struct fake_clock fake;

/* What the linker calls in their place, and what it leaves us as theirs. */
int __real_clock_gettime(clockid_t id, struct timespec *now);
int __wrap_clock_gettime(clockid_t id, struct timespec *now);
time_t __real_time(time_t *now);
time_t __wrap_time(time_t *now);
int __real_getrusage(int who, struct rusage *usage);
int __wrap_getrusage(int who, struct rusage *usage);
FILE *__real_fopen64(const char *path, const char *mode);
FILE *__wrap_fopen64(const char *path, const char *mode);
ssize_t __real_pread64(int file, void *bytes, size_t size, off_t offset);
ssize_t __wrap_pread64(int file, void *bytes, size_t size, off_t offset);
double __real_cos(double angle);
double __wrap_cos(double angle);
void __real_sincos(double angle, double *sine, double *cosine);
void __wrap_sincos(double angle, double *sine, double *cosine);
double __real_scalar_loop_seconds(const struct scalar_loop *loop);
double __wrap_scalar_loop_seconds(const struct scalar_loop *loop);

static const long long second = 1000000000;

void fake_clock_begin(void)
{
    fake = (struct fake_clock){.on = true, .now = 1000 * second};
}

void fake_clock_pass(double seconds)
{
    fake.now += llround(1e9 * seconds);
}

int __wrap_clock_gettime(clockid_t id, struct timespec *now)
{
    if (!fake.on)
        return __real_clock_gettime(id, now);
    if (id == CLOCK_PROCESS_CPUTIME_ID) {
        const long long busy = llround(told.processors * (double)fake.now);
        *now = (struct timespec){busy / second, busy % second};
        return 0;
    }
    if (id != CLOCK_MONOTONIC && id != CLOCK_THREAD_CPUTIME_ID)
        fail_msg("clock %d, which may be set, is read for a time", (int)id);
    const long long at = id == CLOCK_MONOTONIC ? fake.now : fake.now - fake.waited;
    *now = (struct timespec){at / second, at % second};
    fake.now += id == CLOCK_MONOTONIC ? fake.tick : 0;
    return 0;
}

/* Of dates alone: now a year ahead, then a year behind. */
time_t __wrap_time(time_t *now)
{
    static int readings;
    const time_t at = __real_time(now) + (fake.on ? (readings++ % 2 ? -1 : 1) * 31557600 : 0);
    if (now)
        *now = at;
    return at;
}

int __wrap_getrusage(int who, struct rusage *usage)
{
    if (!fake.on)
        return __real_getrusage(who, usage);
    *usage = (struct rusage){.ru_stime = {fake.system / second, fake.system % second / 1000}};
    return 0;
}

/* Linux's accounts of the threads: the first one has all the waiting. */
FILE *__wrap_fopen64(const char *path, const char *mode)
{
    static char first[64], text[80];
    snprintf(first, sizeof first, "/proc/self/task/%d/schedstat", (int)getpid());
    if (!fake.on || strcmp(path, first) != 0)
        return __real_fopen64(path, mode);
    snprintf(text, sizeof text, "%lld %lld 7\n", fake.now, fake.waited);
    return fmemopen(text, strlen(text), "r");
}

ssize_t __wrap_pread64(int file, void *bytes, size_t size, off_t offset)
{
    if (!fake.on)
        return __real_pread64(file, bytes, size, offset);
    return snprintf(bytes, size, "%lld %lld 7\n", fake.now, fake.waited);
}

/* Of the scalar reference loop, each pair has a phasor. */
static _Thread_local long phasors;

double __wrap_cos(double angle)
{
    phasors++;
    return __real_cos(angle);
}

void __wrap_sincos(double angle, double *sine, double *cosine)
{
    phasors++;
    __real_sincos(angle, sine, cosine);
}

/* The loop reads the clock before and after; between, what was told has passed. */
double __wrap_scalar_loop_seconds(const struct scalar_loop *loop)
{
    if (!fake.on)
        return __real_scalar_loop_seconds(loop);
    const long long tick = fake.tick;
    const long before = phasors;
    fake.tick = llround(1e9 * fake.control[fake.controls++]);
    const double seconds = __real_scalar_loop_seconds(loop);
    fake.now -= fake.tick; /* that of the second reading */
    fake.tick = tick;
    assert_int_equal(phasors - before, FAKE_PAIRS);
    return seconds;
}

/* --- An algorithm whose runs take what they are told --- */

struct told told;
int runs_done;
static int plan_made;

static enum status told_plan(const struct problem *problem, const void *method, const void *options, void **plan)
{
    (void)problem, (void)method, (void)options;
    if (fake.on)
        fake_clock_pass(0.004);
    *plan = &plan_made;
    return STATUS_OK;
}

static void spend(double seconds)
{
    if (told.busy)
        for (const double end = seconds_now() + seconds; seconds_now() < end;)
            ;
    else
        fake_clock_pass(seconds);
}

/* A quarter to compress, the rest to focus in two parts. */
static enum status told_execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    (void)plan;
    static float complex kept;
    const struct acquisition *a = echoes->acquisition;
    if (!told.keeps || runs_done == 0) {
        kept = 0;
        for (int n = 0; n < a->samples * a->receivers * a->pings; n++)
            kept += ((const float complex *)echoes->samples)[n];
    }
    for (int k = 0; k < image->patch_count; k++)
        for (int i = 0; i < image->patches[k].r_count * image->patches[k].x_count; i++)
            ((float complex *)image->pixels[k])[i] = kept;
    int n = runs_done++;
    fake.system += n == 0 ? llround(1e9 * told.clearing_s) : 0;
    n = n < RUNS_TOLD ? n : RUNS_TOLD - 1;
    while (n > 0 && told.seconds[n] == 0)
        n--;
    const double seconds = told.seconds[n];
    spend(0.25 * seconds);
    stages_end(stages, "compress");
    spend(0.5 * seconds);
    stages_end(stages, "focus");
    spend(0.25 * seconds);
    stages_end(stages, "focus");
    fake.waited += llround(1e9 * told.waited * seconds);
    return STATUS_OK;
}

static struct work told_work(const void *plan)
{
    (void)plan;
    return (struct work){.flops = 6.46e7, .pairs = told.pairs, .engine = "told"};
}

static void told_destroy(void *plan)
{
    (void)plan;
}

const struct algorithm telling = {
    .name = "telling", .plan = told_plan, .execute = told_execute, .work = told_work, .destroy = told_destroy};
