/* Filters ahead of an algorithm: "./notch.so:low=1e3 | bp_farrow:degree=5". The chain is an algorithm, whose name ends
   before the settings of the last link: these are its own. Each filter's echoes are the next link's recording. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "echoes/echo_data.h"
#include "guests/guests.h"
#include "imaging/imaging.h"
#include "text/text_append.h"

enum { FILTERS_MOST = 6, ORIGIN_TEXT = 160 };
static const char *const stage_names[FILTERS_MOST] = {"filter_1", "filter_2", "filter_3",
                                                      "filter_4", "filter_5", "filter_6"};

/* Kept until the program ends. */
struct chain {
    const char *name;
    int count; /* of filters */
    struct spec filters[FILTERS_MOST];
    const struct algorithm *last;
    char origin[ORIGIN_TEXT], summary[300];
};

/* A filter at work. Zeroed where it is not planned. */
struct link {
    void *plan;
    struct acquisition acquisition; /* of its echoes */
    struct echoes echoes;
    bool moves; /* its execute changed the acquisition once */
};

struct chain_plan {
    const struct chain *chain;
    struct problem problem;
    void *options; /* of the last link */
    struct link links[FILTERS_MOST];
    void *last;
    bool checked; /* that the echoes are finite */
};

static struct problem problem_at(const struct chain_plan *plan, int k)
{
    struct problem problem = plan->problem;
    if (k > 0)
        problem.acquisition = &plan->links[k - 1].acquisition;
    return problem;
}

/* Of the last link, and the filters from `first` on. */
static void plans_drop(struct chain_plan *plan, int first)
{
    const struct chain *chain = plan->chain;
    if (plan->last)
        chain->last->destroy(plan->last);
    plan->last = NULL;
    for (int k = first; k < chain->count; k++) {
        struct link *link = &plan->links[k];
        if (link->plan)
            chain->filters[k].algorithm->destroy(link->plan);
        acquisition_free(&link->acquisition);
        echoes_free(&link->echoes);
        *link = (struct link){.moves = link->moves};
    }
}

/* What a filter does not write stays NaN, which the first execute refuses. */
static enum status link_echoes(struct link *link, enum precision precision)
{
    const enum status status = echoes_allocate(&link->acquisition, precision, &link->echoes);
    if (status != STATUS_OK)
        return status;
    memset((void *)link->echoes.samples, 0xff, samples_bytes(&link->acquisition, precision));
    return STATUS_OK;
}

/* Without room for its echoes. */
static enum status filter_plan(struct chain_plan *plan, int k)
{
    const struct spec *filter = &plan->chain->filters[k];
    const struct problem problem = problem_at(plan, k);
    struct link *link = &plan->links[k];
    enum status status = algorithm_plan(filter->algorithm, &problem, filter->options, &link->plan);
    if (status == STATUS_OK) {
        static const struct work_bounds bounds = {0, 0, HUGE_VAL};
        const struct work work = filter->algorithm->work(link->plan);
        status = work_check(filter->algorithm->name, &bounds, &work);
    }
    if (status == STATUS_OK)
        status = filter->algorithm->filtered(link->plan, &link->acquisition);
    link->acquisition.filtered = true;
    return status;
}

/* The work that timing holds against the problem is, of a chain, that of its last link's echoes. */
static enum status last_plan(struct chain_plan *plan)
{
    const struct algorithm *last = plan->chain->last;
    const struct problem problem = problem_at(plan, plan->chain->count);
    const enum status status = algorithm_plan(last, &problem, plan->options, &plan->last);
    if (status != STATUS_OK)
        return status;
    const struct work work = last->work(plan->last);
    struct work_bounds bounds = work_bounds(last, plan->options, &problem, &work);
    bounds.flops_most = HUGE_VAL; /* the whole chain's: timing.c */
    return work_check(last->name, &bounds, &work);
}

/* Of the filters from `first` on, and of the last link. */
static enum status plans_make(struct chain_plan *plan, int first)
{
    enum status status = STATUS_OK;
    for (int k = first; k < plan->chain->count && status == STATUS_OK; k++) {
        status = filter_plan(plan, k);
        if (status == STATUS_OK)
            status = link_echoes(&plan->links[k], plan->problem.precision);
    }
    return status == STATUS_OK ? last_plan(plan) : status;
}

static void chain_destroy(void *data)
{
    struct chain_plan *plan = data;
    if (!plan)
        return;
    plans_drop(plan, 0);
    free(plan->options);
    free(plan);
}

static struct chain_plan *chain_begin(const struct chain *chain, const struct problem *problem, const void *options)
{
    const size_t size = chain->last->options_size;
    struct chain_plan *plan = calloc(1, sizeof *plan);
    if (!plan)
        return NULL;
    *plan = (struct chain_plan){.chain = chain, .problem = *problem, .options = size > 0 ? malloc(size) : NULL};
    if (size > 0 && !plan->options) {
        free(plan);
        return NULL;
    }
    if (size > 0)
        memcpy(plan->options, options, size);
    return plan;
}

static enum status chain_plan(const struct problem *problem, const void *method, const void *options, void **out)
{
    struct chain_plan *plan = chain_begin(method, problem, options);
    *out = NULL;
    if (!plan)
        return status_set(STATUS_FAILED, "%s: no memory for a plan", ((const struct chain *)method)->name);
    const enum status status = plans_make(plan, 0);
    if (status == STATUS_OK)
        *out = plan;
    else
        chain_destroy(plan);
    return status;
}

/* ---- execute ---- */

static bool same(const void *a, const void *b, size_t count, size_t size)
{
    return count == 0 || memcmp(a, b, count * size) == 0;
}

/* Has the filter changed what its echoes are? *now is the acquisition then, else freed. */
static enum status acquisition_moved(const struct link *link, const struct spec *filter, struct acquisition *now,
                                     bool *moved)
{
    const struct acquisition *was = &link->acquisition;
    const enum status status = filter->algorithm->filtered(link->plan, now);
    if (status != STATUS_OK)
        return status;
    const size_t pings = (size_t)now->pings, records = pings * (size_t)now->receivers;
    if (now->pings != was->pings || now->receivers != was->receivers || now->samples != was->samples
        || now->pulse_length != was->pulse_length) {
        acquisition_free(now);
        return status_set(STATUS_FAILED, "%s: its execute changed the sizes of its echoes", filter->algorithm->name);
    }
    *moved = !(now->sound_speed == was->sound_speed && now->fc == was->fc && now->fs == was->fs
               && now->bandwidth == was->bandwidth && same(now->t0, was->t0, pings, sizeof *now->t0)
               && same(now->tx, was->tx, pings, sizeof *now->tx) && same(now->rx, was->rx, records, sizeof *now->rx)
               && same(now->velocity, was->velocity, pings, sizeof *now->velocity)
               && same(now->pulse, was->pulse, (size_t)now->pulse_length, now->pulse ? sizeof *now->pulse : 0));
    if (!*moved)
        acquisition_free(now);
    return STATUS_OK;
}

/* What comes after a filter whose acquisition depends on its samples is planned anew, each time. */
static enum status move(struct chain_plan *plan, int k, struct stages *stages)
{
    struct link *link = &plan->links[k];
    struct acquisition now;
    bool moved = false;
    enum status status = acquisition_moved(link, &plan->chain->filters[k], &now, &moved);
    link->moves = link->moves || moved;
    if (status != STATUS_OK || !link->moves)
        return status;
    plans_drop(plan, k + 1);
    if (moved) {
        acquisition_free(&link->acquisition);
        link->acquisition = now;
        link->acquisition.filtered = true;
    }
    status = plans_make(plan, k + 1);
    stages_end(stages, "plan");
    return status;
}

static bool echoes_are_finite(const struct echoes *echoes)
{
    return isfinite(largest_part(echoes->samples, echoes->precision, acquisition_samples(echoes->acquisition)));
}

static enum status chain_execute(void *data, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    struct chain_plan *plan = data;
    const struct chain *chain = plan->chain;
    struct echoes from = *echoes;
    enum status status = STATUS_OK;
    for (int k = 0; k < chain->count && status == STATUS_OK; k++) {
        struct link *link = &plan->links[k];
        const struct algorithm *filter = chain->filters[k].algorithm;
        status = filter->filter(link->plan, from.samples, (void *)link->echoes.samples, stages);
        stages_end(stages, stage_names[k]);
        if (status == STATUS_OK && !plan->checked && !echoes_are_finite(&link->echoes))
            status = status_set(STATUS_FAILED, "%s: it left samples unwritten, or they are not finite", filter->name);
        if (status == STATUS_OK)
            status = move(plan, k, stages);
        from = link->echoes;
        from.exponent = echoes->exponent;
    }
    plan->checked = true;
    return status == STATUS_OK ? chain->last->execute(plan->last, &from, image, stages) : status;
}

static struct work chain_work(const void *data)
{
    const struct chain_plan *plan = data;
    struct work work = plan->chain->last->work(plan->last);
    work.bytes += sizeof *plan + (double)plan->chain->last->options_size;
    for (int k = 0; k < plan->chain->count; k++) {
        const struct link *link = &plan->links[k];
        const struct acquisition *a = &link->acquisition;
        const double records = (double)a->pings * a->receivers;
        const struct work filter = plan->chain->filters[k].algorithm->work(link->plan);
        work.flops += filter.flops;
        work.bytes += filter.bytes + records * a->samples * (double)precision_size(link->echoes.precision)
                      + (records * sizeof *a->rx) + a->pings * (2.0 * sizeof *a->tx + sizeof *a->t0)
                      + a->pulse_length * (double)sizeof *a->pulse;
    }
    return work;
}

/* The filters alone are planned; *plan goes to chain_destroy. */
static enum status filters_plan(const struct chain *chain, const struct problem *problem, const void *options,
                                struct chain_plan **plan)
{
    enum status status = STATUS_OK;
    *plan = chain_begin(chain, problem, options);
    if (!*plan)
        return status_set(STATUS_FAILED, "%s: no memory for a plan", chain->name);
    for (int k = 0; k < chain->count && status == STATUS_OK; k++)
        status = filter_plan(*plan, k);
    return status;
}

/* Those of the last link, of the filtered recording; none where a filter refuses. */
static int chain_conditions(const struct problem *problem, const void *method, const void *options,
                            struct condition *list, int room)
{
    const struct chain *chain = method;
    struct chain_plan *plan;
    enum status status = filters_plan(chain, problem, options, &plan);
    int count = 0;
    if (status == STATUS_OK) {
        const struct problem last = problem_at(plan, chain->count);
        count = algorithm_conditions(chain->last, &last, plan->options, list, room);
    }
    chain_destroy(plan);
    return count;
}

/* Cost or errors of the last link, of the filtered recording, and of each filter. */
static enum status chain_predict(bool errors, const struct problem *problem, const struct chain *chain,
                                 const void *options, struct forecast *forecast)
{
    struct chain_plan *plan;
    enum status status = filters_plan(chain, problem, options, &plan);
    if (status == STATUS_OK) {
        const struct problem last = problem_at(plan, chain->count);
        status = (errors ? algorithm_errors : algorithm_cost)(chain->last, &last, options, forecast);
    }
    for (int k = 0; k < chain->count && status == STATUS_OK; k++) {
        const struct spec *filter = &chain->filters[k];
        const struct problem own = problem_at(plan, k);
        const double flops = errors ? 0 : filter->algorithm->work(plan->links[k].plan).flops;
        forecast->migration[MIGRATION_BLOCKS] += flops;
        forecast->migration_flops += flops;
        status = errors ? algorithm_errors(filter->algorithm, &own, filter->options, forecast) : STATUS_OK;
    }
    chain_destroy(plan);
    return status;
}

static enum status chain_cost(const struct problem *problem, const void *method, const void *options,
                              struct forecast *forecast)
{
    return chain_predict(false, problem, method, options, forecast);
}

static enum status chain_errors(const struct problem *problem, const void *method, const void *options,
                                struct forecast *forecast)
{
    return chain_predict(true, problem, method, options, forecast);
}

/* Are all links range migrations and filters with a forecast? */
static bool has_forecast(const struct chain *chain)
{
    bool all = chain->last->cost && !(chain->last->traits & TRAIT_APERTURE_LIMIT);
    for (int k = 0; k < chain->count; k++)
        all = all && chain->filters[k].algorithm->errors;
    return all;
}

/* ---- the text of a SPEC ---- */

/* One filter "PATH:settings" of the name. */
static enum status filter_take(struct chain *chain, const char *text)
{
    if (!*text)
        return status_set(STATUS_INVALID,
                          "SPEC '%.100s': a filter is missing ahead of '|'; accepted: 'FILTER | ALGORITHM'",
                          chain->name);
    if (chain->count == FILTERS_MOST)
        return status_set(STATUS_INVALID, "SPEC '%.100s': it has more than %d filters", chain->name, FILTERS_MOST);
    struct spec *filter = &chain->filters[chain->count];
    enum status status = guest_invite(text);
    if (status == STATUS_OK)
        status = spec_parse(text, filter);
    if (status != STATUS_OK)
        return status;
    chain->count++;
    if (!filter->algorithm->filter)
        return status_set(STATUS_INVALID,
                          "SPEC '%.100s': %s forms images, so it must be the last link; accepted ahead of '|': "
                          "monostatic, shared objects that define sas_filter_plugin",
                          chain->name, filter->algorithm->name);
    if (spec_given(filter, "precision"))
        return status_set(STATUS_INVALID, "SPEC '%.100s': precision is given to a filter; accepted: to the last link",
                          chain->name);
    text_append(chain->origin, sizeof chain->origin, "%s%s", filter->algorithm->origin ? filter->algorithm->origin : "",
                filter->algorithm->origin ? " " : "");
    text_append(chain->summary, sizeof chain->summary, "%s, then ", filter->algorithm->summary);
    return STATUS_OK;
}

static enum status last_take(struct chain *chain, const char *text)
{
    const char *rest;
    if (!*text)
        return status_set(STATUS_INVALID,
                          "SPEC '%.100s': an algorithm is missing behind '|'; accepted: '%.100s bp_sinc'", chain->name,
                          chain->name);
    enum status status = guest_invite(text);
    if (status != STATUS_OK)
        return status;
    chain->last = guest_find(text, &rest);
    if (!chain->last) { /* its message has what is accepted */
        struct spec spec;
        return spec_parse(text, &spec);
    }
    if (chain->last->filter)
        return status_set(STATUS_INVALID,
                          "SPEC '%.100s': %s is a filter; an algorithm must follow it: '%.100s | bp_sinc'", chain->name,
                          text, chain->name);
    if (!chain->last->plan)
        return status_set(STATUS_INVALID,
                          "SPEC '%.100s': %s chooses by the unfiltered echoes; accepted after '|': any other algorithm",
                          chain->name, text);
    text_append(chain->origin, sizeof chain->origin, "%s", chain->last->origin ? chain->last->origin : "");
    text_append(chain->summary, sizeof chain->summary, "%s", chain->last->summary);
    return STATUS_OK;
}

static enum status chain_make(const char *name, struct algorithm *algorithm)
{
    struct chain *chain = calloc(1, sizeof *chain);
    char *text = strdup(name), *at = text;
    enum status status = chain && text ? STATUS_OK : status_set(STATUS_FAILED, "SPEC '%.100s': out of memory", name);
    if (chain)
        chain->name = name;
    for (const char *last = text ? text + (guest_last(name) - name) : NULL; status == STATUS_OK && at < last;) {
        char *bar = strchr(at, '|'), *end = bar;
        at += strspn(at, " \t\n");
        while (end > at && strchr(" \t\n", end[-1]))
            end--;
        *end = '\0';
        status = filter_take(chain, at);
        at = bar + 1 + strspn(bar + 1, " \t\n");
    }
    if (status == STATUS_OK)
        status = last_take(chain, at);
    free(text);
    if (status != STATUS_OK) {
        for (int k = 0; chain && k < chain->count; k++)
            spec_free(&chain->filters[k]);
        free(chain);
        return status;
    }
    *algorithm = (struct algorithm){
        .name = name,
        .origin = *chain->origin ? chain->origin : NULL,
        .summary = chain->summary,
        .reference = chain->last->reference,
        .traits = (chain->last->traits & ~(unsigned)TRAIT_WINDOW) | TRAIT_FILTERED,
        .options_size = chain->last->options_size,
        .params = chain->last->params,
        .method = chain,
        .conditions = chain_conditions,
        .cost = has_forecast(chain) ? chain_cost : NULL,
        .errors = has_forecast(chain) ? chain_errors : NULL,
        .plan = chain_plan,
        .execute = chain_execute,
        .work = chain_work,
        .destroy = chain_destroy,
    };
    return STATUS_OK;
}

const struct guest_kind guest_chain = {NULL, chain_make};
