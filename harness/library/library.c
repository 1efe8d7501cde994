/* The library's contexts, messages and turns (libsasbench.h). */
#define _GNU_SOURCE /* dladdr */
#include <ctype.h>
#include <dlfcn.h>
#include <float.h>
#include <limits.h>
#include <math.h>
#include <omp.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "common/progress.h"
#include "echoes/matfile.h"
#include "files/paths.h"
#include "library/library.h"

enum { THREADS_MOST = 1024 };

static _Thread_local char message[1024];
static _Thread_local int depth;
static _Thread_local bool held;
/* Images that others form one after the other keep nobody from a turn alone. */
#ifdef PTHREAD_RWLOCK_WRITER_NONRECURSIVE_INITIALIZER_NP
static pthread_rwlock_t turns = PTHREAD_RWLOCK_WRITER_NONRECURSIVE_INITIALIZER_NP;
#else
static pthread_rwlock_t turns = PTHREAD_RWLOCK_INITIALIZER;
#endif

const char *sasbench_version(void)
{
    return SASBENCH_VERSION;
}

const char *sasbench_message(void)
{
    return message;
}

/* ---- SIGINT ---- */

static _Thread_local bool interruptible;
static _Thread_local int begun; /* interruptions until the call */
static atomic_int interruptions;
static struct sigaction before_call; /* of the one thread that is interruptible */

static void interrupt(int number)
{
    atomic_fetch_add(&interruptions, 1);
    progress_stop(true);
    before_call.sa_handler(number);
}

/* Only another function is joined: a process that ignores the signal, or is ended by it, goes on so. */
static bool handler_joins(void)
{
    return !(before_call.sa_flags & SA_SIGINFO) && before_call.sa_handler != SIG_DFL
           && before_call.sa_handler != SIG_IGN;
}

static void interrupt_await(void)
{
    sigaction(SIGINT, NULL, &before_call);
    struct sigaction joined = before_call;
    joined.sa_handler = interrupt;
    progress_stop(false);
    if (handler_joins())
        sigaction(SIGINT, &joined, NULL);
}

static void interrupt_forget(void)
{
    if (handler_joins())
        sigaction(SIGINT, &before_call, NULL);
    progress_stop(false);
}

void sasbench_interruptible(void)
{
    interruptible = true;
}

int turn_begin(const struct sasbench *context, enum turn turn)
{
    const int threads = omp_get_max_threads();
    if (depth++ == 0) {
        held = turn != TURN_NONE;
        begun = interruptions;
        if (interruptible && held)
            interrupt_await();
        if (turn == TURN_ALONE)
            pthread_rwlock_wrlock(&turns);
        else if (held)
            pthread_rwlock_rdlock(&turns);
    }
    if (context)
        omp_set_num_threads(context->threads);
    return threads;
}

int turn_end(int threads, enum status status)
{
    if (depth == 1 && held && interruptions != begun) /* the result is void, in whatever thread */
        status = status_set(STATUS_FAILED, "interrupted");
    if (status != STATUS_OK)
        snprintf(message, sizeof message, "%s", status_message());
    for (char *at = message; *at; at++) /* a line, whatever names it quotes */
        if (iscntrl((unsigned char)*at))
            *at = '?';
    omp_set_num_threads(threads);
    if (--depth == 0 && held) {
        pthread_rwlock_unlock(&turns);
        if (interruptible)
            interrupt_forget();
    }
    return (int)status;
}

bool turn_is_inner(void)
{
    return depth > 1;
}

bool single_holds(double largest)
{
    return largest == 0 || (largest >= (double)FLT_MIN * 0x1p24 && largest <= (double)FLT_MAX);
}

enum status precision_check(int precision)
{
    return precision == SAS_FLOAT || precision == SAS_DOUBLE
               ? STATUS_OK
               : status_set(STATUS_INVALID, "precision is %d, must be SAS_FLOAT or SAS_DOUBLE", precision);
}

enum status samples_check(const struct acquisition *acquisition, enum precision precision, const void *samples)
{
    const size_t each = (size_t)acquisition->samples, receivers = (size_t)acquisition->receivers;
    const size_t count = 2 * each * receivers * (size_t)acquisition->pings;
    const float *single = samples;
    const double *both = samples;
    for (size_t k = 0; k < count; k++) {
        const double part = precision == PRECISION_DOUBLE ? both[k] : single[k];
        if (!isfinite(part))
            return status_set(STATUS_INVALID,
                              "echoes: sample %zu of receiver %zu in ping %zu has %g; finite numbers are needed",
                              k / 2 % each, k / 2 / each % receivers, k / 2 / each / receivers, part);
    }
    return STATUS_OK;
}

/* The scenes beside the library, or below SASBENCH_DATA of its prefix, a folder or two above; else the source's. */
static char *scenes_find(void)
{
    static const char *const above[] = {"", "/../" SASBENCH_DATA, "/../../" SASBENCH_DATA};
    char path[PATH_MAX + 64] = "";
    Dl_info library;
    const char *slash = dladdr(&turns, &library) != 0 ? strrchr(library.dli_fname, '/') : NULL;
    for (size_t k = 0; slash && k < sizeof above / sizeof *above; k++) {
        struct stat folder;
        snprintf(path, sizeof path, "%.*s%s/scenes", (int)(slash - library.dli_fname), library.dli_fname, above[k]);
        if (stat(path, &folder) == 0 && S_ISDIR(folder.st_mode))
            return strdup(path);
    }
    return strdup(data_path(DATA_SCENES));
}

int sasbench_open(int threads, const char *scenes, struct sasbench **context)
{
    const int before = turn_begin(NULL, TURN_ALONE);
    struct stat folder;
    enum status status = STATUS_OK;
    *context = NULL;
    variables_read_by_thread();
    if (threads < 0 || threads > THREADS_MOST)
        status = status_set(STATUS_INVALID, "threads is %d, must be 0 to %d", threads, THREADS_MOST);
    else if (scenes && (stat(scenes, &folder) != 0 || !S_ISDIR(folder.st_mode)))
        status = status_set(STATUS_INVALID, "%s: is no folder; the folder of the shipped scenes is needed", scenes);
    struct sasbench *made = status == STATUS_OK ? calloc(1, sizeof *made) : NULL;
    if (made)
        *made = (struct sasbench){threads > 0 ? threads : before, scenes ? strdup(scenes) : scenes_find()};
    if (status == STATUS_OK && (!made || !made->scenes))
        status = status_set(STATUS_FAILED, "no memory");
    if (status == STATUS_OK)
        *context = made;
    else
        sasbench_close(made);
    return turn_end(before, status);
}

void sasbench_close(struct sasbench *context)
{
    if (context)
        free(context->scenes);
    free(context);
}

const char *sasbench_algorithm(int index, const char **summary, const char **reference)
{
    for (int k = 0; index >= 0 && algorithms[k]; k++)
        if (k == index) {
            if (summary)
                *summary = algorithms[k]->summary;
            if (reference)
                *reference = algorithms[k]->reference;
            return algorithms[k]->name;
        }
    return NULL;
}

int sasbench_setting(int index, int setting, struct sas_setting *out)
{
    static const enum sas_kind kinds[] = {
        [PARAM_INTEGER] = SAS_INTEGER, [PARAM_REAL] = SAS_REAL, [PARAM_CHOICE] = SAS_NAME, [PARAM_TEXT] = SAS_TEXT};
    const struct param *param = sasbench_algorithm(index, NULL, NULL) ? algorithms[index]->params : NULL;
    for (; param && param->name; param++) {
        if (param->hidden || setting-- > 0)
            continue;
        *out = (struct sas_setting){sizeof *out,    (int32_t)kinds[param->type],
                                    param->name,    param->summary,
                                    param->initial, param->min,
                                    param->max,     param->choices,
                                    param->text,    param->sweep};
        return setting == -1;
    }
    return 0;
}
