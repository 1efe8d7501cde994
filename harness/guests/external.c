/* Any program as an algorithm: `external:python3 my.py`. One process for each plan, which it makes and executes by
   lines on its descriptors 3 and 4, each of which begins with a token of the version (docs/plugins.md):

       sasbench1 plan FOLDER          sasbench1 ok [WORDS]       or   sasbench1 unsupported REASON
       sasbench1 execute              sasbench1 took SECONDS
       sasbench1 quit

   Our clock counts, from the samples in memory to the image in memory; the program's own seconds become a stage. A
   program that does anything else is ended, and its reason is the row's. */
#include "guests/external.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <omp.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <wordexp.h>

#include "files/hash.h"
#include "guests/exchange.h"
#include "guests/guests.h"
#include "guests/keeper.h"
#include "text/number.h"
#include "text/shown_text.h"

#define PREFIX "external:"
#define TOKEN  "sasbench1"
enum { LINE_MOST = 4096 };
static const double QUIT_S = 2, VERSION_S = 5; /* s that a program has to end; to print its version */

static double timeout_s = 600;
static char logs[4096];

void external_timeout(double seconds)
{
    timeout_s = seconds;
}

void external_logs(const char *folder)
{
    snprintf(logs, sizeof logs, "%s", folder ? folder : "");
}

/* One SPEC's program, kept until ours ends. */
struct external {
    const char *name;
    wordexp_t words;
    char origin[128];
};

struct external_plan {
    const struct external *external;
    struct keeper keeper;
    struct exchange exchange;
    char heard[LINE_MOST + 1]; /* of descriptor 4, not yet taken */
    size_t heard_count;
    char failure[1000]; /* once it has failed: why */
    char engine[96];
};

/* ---- the end of a program ---- */

static void log_keep(const struct external_plan *plan)
{
    if (*logs)
        exchange_log_keep(&plan->exchange, logs, plan->external->name);
}

/* End it, and keep the reason, with what its log says last. */
static enum status __attribute__((format(printf, 2, 3))) fail(struct external_plan *plan, const char *format, ...)
{
    char why[600], line[300];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(why, sizeof why, format, arguments);
    va_end(arguments);
    shown_make(why);
    exchange_log_line(&plan->exchange, true, line, sizeof line);
    snprintf(plan->failure, sizeof plan->failure, "%s%s%s", why, *line ? "; it printed last: " : "", line);
    log_keep(plan);
    keeper_stop(&plan->keeper);
    return STATUS_FAILED;
}

static enum status failed(const struct external_plan *plan, enum status status)
{
    return status_set(status, "%s: %s", plan->external->name, plan->failure);
}

/* ---- lines ---- */

static enum status say(struct external_plan *plan, const char *words)
{
    char line[LINE_MOST + 1], how[200];
    const int length = snprintf(line, sizeof line, TOKEN " %s\n", words);
    if (write(plan->keeper.to, line, (size_t)length) == length)
        return STATUS_OK;
    const int error = errno;
    if (keeper_ended(&plan->keeper, 0, how, sizeof how))
        return fail(plan, "%s", how);
    return fail(plan, "does not read its descriptor 3: %s", strerror(error));
}

/* It has closed its descriptor 4, or ended. */
static enum status silence_explain(struct external_plan *plan, const char *during)
{
    char how[200];
    const bool ended = keeper_ended(&plan->keeper, QUIT_S, how, sizeof how);
    return fail(plan, "%s during %s%s", ended ? how : "closed its descriptor 4", during,
                plan->heard_count > 0 ? ", within a line" : "");
}

/* Take a line, without its end. */
static enum status hear(struct external_plan *plan, const char *during, char line[LINE_MOST + 1])
{
    const double begin = seconds_now();
    for (;;) {
        char *end = memchr(plan->heard, '\n', plan->heard_count);
        if (end) {
            const size_t length = (size_t)(end - plan->heard);
            memcpy(line, plan->heard, length);
            line[length] = '\0';
            plan->heard_count -= length + 1;
            memmove(plan->heard, end + 1, plan->heard_count + 1);
            if (strlen(line) == length)
                return STATUS_OK;
            return fail(plan, "said a line with a zero byte, '%.60s', during %s", line, during);
        }
        if (plan->heard_count == LINE_MOST)
            return fail(plan, "said a line of more than %d bytes, '%.60s...', during %s", LINE_MOST, plan->heard,
                        during);
        const double left = timeout_s - (seconds_now() - begin);
        struct pollfd polled[] = {{plan->keeper.from, POLLIN, 0}, {plan->keeper.end, POLLIN, 0}};
        const int ready = left > 0 ? poll(polled, 2, (int)fmin(1000 * left + 1, 1e9)) : 0;
        if (ready < 0 && errno == EINTR)
            continue;
        if (ready <= 0)
            return plan->heard_count == 0
                       ? fail(plan, "was silent for %g s during %s (--timeout)", timeout_s, during)
                       : fail(plan, "was silent for %g s (--timeout) during %s, after '%.*s' without a line's end",
                              timeout_s, during, (int)fmin((double)plan->heard_count, 60), plan->heard);
        const ssize_t found =
            polled[0].revents ? read(plan->keeper.from, plan->heard + plan->heard_count, LINE_MOST - plan->heard_count)
                              : 0;
        if (found <= 0)
            return silence_explain(plan, during);
        plan->heard_count += (size_t)found;
        plan->heard[plan->heard_count] = '\0';
    }
}

/* What follows the token and a word in a line; NULL for another line. */
static const char *behind(const char *line, const char *word)
{
    const size_t token = strlen(TOKEN " "), length = strlen(word);
    if (strncmp(line, TOKEN " ", token) != 0 || strncmp(line + token, word, length) != 0)
        return NULL;
    const char *rest = line + token + length;
    return *rest == '\0' ? rest : *rest == ' ' ? rest + 1 : NULL;
}

/* ---- struct algorithm ---- */

static void external_destroy(void *data)
{
    struct external_plan *plan = data;
    char how[200];
    if (plan && plan->keeper.pid > 0) {
        if (say(plan, "quit") == STATUS_OK) {
            keeper_ended(&plan->keeper, QUIT_S, how, sizeof how);
            log_keep(plan);
        }
        keeper_stop(&plan->keeper);
    }
    if (plan)
        exchange_close(&plan->exchange);
    free(plan);
}

/* From the `plan` to its answer. */
static enum status plan_ask(struct external_plan *plan, const struct problem *problem)
{
    char line[LINE_MOST + 1], words[sizeof plan->exchange.folder + 8];
    enum status status = exchange_open(&plan->exchange, problem);
    if (status != STATUS_OK)
        return fail(plan, "%s", status_message());
    snprintf(words, sizeof words, "plan %s", plan->exchange.folder);
    status = say(plan, words);
    if (status == STATUS_OK)
        status = hear(plan, "`plan`", line);
    if (status != STATUS_OK)
        return status;
    const char *ok = behind(line, "ok"), *unsupported = behind(line, "unsupported");
    if (unsupported) {
        snprintf(plan->failure, sizeof plan->failure, "%.600s",
                 *unsupported ? unsupported : "is unsupported, by its own word");
        shown_make(plan->failure);
        return STATUS_UNSUPPORTED;
    }
    if (!ok)
        return fail(plan, "said '%.200s' to `plan`, must be '" TOKEN " ok' or '" TOKEN " unsupported REASON'", line);
    snprintf(plan->engine, sizeof plan->engine, "%.*s", (int)sizeof plan->engine - 1, *ok ? ok : "external");
    shown_make(plan->engine);
    return STATUS_OK;
}

static enum status external_plan(const struct problem *problem, const void *method, const void *options, void **out)
{
    const struct external *external = method;
    struct external_plan *plan = calloc(1, sizeof *plan);
    (void)options;
    *out = NULL;
    if (!plan)
        return status_set(STATUS_FAILED, "%s: no memory for a plan", external->name);
    *plan = (struct external_plan){.external = external, .exchange.samples = -1};
    enum status status = exchange_folder(&plan->exchange);
    if (status == STATUS_OK) {
        status = keeper_start(external->words.we_wordv, plan->exchange.folder, omp_get_max_threads(), &plan->keeper);
        if (status != STATUS_OK)
            rmdir(plan->exchange.folder);
    }
    if (status != STATUS_OK)
        snprintf(plan->failure, sizeof plan->failure, "%.600s", status_message());
    else
        status = plan_ask(plan, problem);
    if (status == STATUS_OK)
        *out = plan;
    else {
        failed(plan, status);
        external_destroy(plan);
    }
    return status;
}

/* `took SECONDS`: the program's own, which must fit into ours. */
static enum status took_read(struct external_plan *plan, const char *line, double elapsed, double *seconds)
{
    const char *text = behind(line, "took"), *end = text ? number_read(text, seconds) : NULL;
    if (!end || *end || !(*seconds >= 0))
        return fail(plan, "said '%.200s' to `execute`, must be '" TOKEN " took SECONDS'", line);
    if (*seconds > 1.01 * elapsed + 1e-3)
        return fail(plan, "said that it took %.3g s, of %.3g s by our clock", *seconds, elapsed);
    return STATUS_OK;
}

static enum status execute_ask(struct external_plan *plan, const struct echoes *echoes, struct image *image,
                               double *took)
{
    char line[LINE_MOST + 1];
    struct pollfd early = {plan->keeper.from, POLLIN, 0};
    if (plan->heard_count == 0 && poll(&early, 1, 0) > 0 && early.revents & POLLIN) {
        const ssize_t found = read(plan->keeper.from, plan->heard, LINE_MOST);
        plan->heard_count = found > 0 ? (size_t)found : 0;
        plan->heard[plan->heard_count] = '\0';
    }
    if (plan->heard_count > 0)
        return fail(plan, "said '%.*s' without being asked", (int)fmin((double)strcspn(plan->heard, "\n"), 60),
                    plan->heard);
    if (exchange_give(&plan->exchange, echoes->samples) != STATUS_OK)
        return fail(plan, "%s", status_message());
    const double begin = seconds_now();
    enum status status = say(plan, "execute");
    if (status == STATUS_OK)
        status = hear(plan, "`execute`", line);
    if (status == STATUS_OK)
        status = took_read(plan, line, seconds_now() - begin, took);
    if (status == STATUS_OK && exchange_take(&plan->exchange, image) != STATUS_OK)
        status = fail(plan, "%s", status_message());
    return status;
}

static enum status external_execute(void *data, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    struct external_plan *plan = data;
    double took = 0;
    const enum status status = *plan->failure ? STATUS_FAILED : execute_ask(plan, echoes, image, &took);
    if (status != STATUS_OK)
        return failed(plan, status);
    stages->mark += took; /* of the whole, the rest is ours */
    stages_end(stages, "exchange");
    stages->mark -= took;
    stages_end(stages, "program");
    return STATUS_OK;
}

/* Nobody counts what a program does. */
static struct work external_work(const void *data)
{
    const struct external_plan *plan = data;
    struct work work = {.flops = NAN, .pairs = NAN, .bytes = NAN};
    snprintf(work.engine, sizeof work.engine, "%s", plan->engine);
    return work;
}

/* ---- making ---- */

/* The first line that it prints for --version. */
static void version_ask(char *program, char *version, size_t size)
{
    char *const words[] = {program, "--version", NULL};
    struct exchange exchange;
    struct keeper keeper;
    char how[200];
    *version = '\0';
    if (exchange_folder(&exchange) != STATUS_OK)
        return;
    if (keeper_start(words, exchange.folder, 1, &keeper) != STATUS_OK) {
        rmdir(exchange.folder);
        return;
    }
    if (keeper_ended(&keeper, VERSION_S, how, sizeof how))
        exchange_log_line(&exchange, false, version, size);
    keeper_stop(&keeper);
}

/* The file that a word names; the first one as a shell finds it. */
static bool file_of(const char *word, bool command, char path[4096])
{
    struct stat info;
    const char *folders = command && !strchr(word, '/') ? getenv("PATH") : "";
    while (folders) {
        const int length = (int)strcspn(folders, ":");
        snprintf(path, 4096, "%.*s%s%s", length, folders, length > 0 ? "/" : "", word);
        if (stat(path, &info) == 0 && S_ISREG(info.st_mode))
            return true;
        folders = folders[length] ? folders + length + 1 : NULL;
    }
    return false;
}

/* One hash of all files that the command names, and the version of what runs a script. */
static void origin_fill(struct external *external)
{
    char *const *words = external->words.we_wordv;
    char path[4096], text[HASH_TEXT], version[80] = "";
    uint64_t hash = HASH_BEGIN;
    for (size_t k = 0; words[k]; k++) {
        if (!file_of(words[k], k == 0, path))
            continue;
        hash_file(path, text);
        hash_add(&hash, text, sizeof text);
        if (k > 0 && !*version)
            version_ask(words[0], version, sizeof version);
    }
    snprintf(external->origin, sizeof external->origin, "%016" PRIx64 "%s%s", hash, *version ? " by " : "", version);
    for (char *at = external->origin; *at; at++) /* a colon ends a name in results */
        *at = *at == ':' ? ' ' : *at;
}

/* Up to a colon outside quotes, as a shell reads them. */
static size_t external_length(const char *spec)
{
    if (strncmp(spec, PREFIX, strlen(PREFIX)) != 0)
        return 0;
    char quote = '\0';
    const char *at = spec + strlen(PREFIX);
    for (; *at && (quote || *at != ':'); at++)
        if (*at == '\\' && quote != '\'' && at[1])
            at++;
        else if (quote ? *at == quote : *at == '\'' || *at == '"')
            quote = quote ? '\0' : *at;
    return (size_t)(at - spec);
}

static enum status external_make(const char *name, struct algorithm *algorithm)
{
    struct external *external = calloc(1, sizeof *external);
    if (!external)
        return status_set(STATUS_FAILED, "%s: out of memory", name);
    external->name = name;
    const char *fault = NULL;
    const int parsed = wordexp(name + strlen(PREFIX), &external->words, WRDE_NOCMD | WRDE_UNDEF);
    if (parsed == WRDE_BADCHAR)
        fault = "one of |&;<>(){} needs quotes";
    else if (parsed == WRDE_BADVAL)
        fault = "a variable is not defined";
    else if (parsed == WRDE_CMDSUB)
        fault = "commands are not substituted";
    else if (parsed != 0)
        fault = "a quote is not closed";
    else if (external->words.we_wordc == 0)
        fault = "the command is missing";
    if (fault) {
        if (parsed == 0)
            wordfree(&external->words);
        free(external);
        return status_set(STATUS_INVALID, "%s: %s; accepted: external:COMMAND, with quotes as in a shell", name, fault);
    }
    origin_fill(external);
    *algorithm = (struct algorithm){.name = name,
                                    .origin = external->origin,
                                    .summary = "a program outside this one, by messages on descriptors 3 and 4",
                                    .reference = "the program's own; docs/plugins.md",
                                    .method = external,
                                    .plan = external_plan,
                                    .execute = external_execute,
                                    .work = external_work,
                                    .destroy = external_destroy};
    return STATUS_OK;
}

const struct guest_kind guest_external = {external_length, external_make};
