/* Fast factorised back projection (Ulander, Hellsten, Stenstrom, IEEE TAES 39, 2003), of any track, bistatic, with
   exact delays. Pings are divided into subapertures of some `base` records. Their images, of a small number of
   directions, are summed from the records on polar grids about their centres. `factor` images at a time are merged into
   one of more directions, `stages` levels in all; pixels are interpolated from the last.
   backprojection/factorised/tree.h has the grids and their sampling.

   Cost: a pixel reads the images of the largest subapertures, one for base factor^(stages-1) records, in place of all
   records: with n records, some n^(1/stages) for each stage. Images have about as many samples as the records.

   Error, relative L2: each read of an image interpolates along range and across directions, each to e = 0.85
   error/sqrt(2 stages + 1), as do reads of the records: together `error` at most. Taps and oversampling have error e
   with the least work (factorised/taps.h), the records' polynomials as well. Pixels that cannot read an image sum the
   records (near pixels, ends of records, edges of the aperture limit). */
#include <math.h>
#include <stdlib.h>

#include "backprojection/factorised/factorised.h"
#include "backprojection/farrow.h"

struct options {
    double error;
    int base, factor, stages;
};

enum { STAGES_AUTO }; /* of `stage_names`: the others are one more than their number */
static const char *const stage_names[] = {"auto", "0", "1", "2", "3", "4", "5", "6", NULL};

static const struct param params[] = {
    {PARAM(struct options, error), .summary = "relative L2 error that the interpolations may make together",
     .initial = 1e-2, .min = 1e-5, .max = 0.3, .sweep = "1e-1 3e-2 1e-2 3e-3 1e-3 1e-4"},
    {PARAM(struct options, base), .summary = "records of the smallest subapertures, about: those of whole pings",
     .initial = 16, .min = 1, .max = 4096, .terse = true},
    {PARAM(struct options, factor), .summary = "subapertures that are merged into one", .initial = 8, .min = 2,
     .max = 64, .terse = true},
    {PARAM_NAMED(struct options, stages, stage_names),
     .summary = "levels of images; 0: none, direct back projection; auto: as many as take the least work",
     .initial = STAGES_AUTO, .max = 1 + STAGES_MOST, .terse = true},
    {.name = NULL},
};

static double promise(const void *options)
{
    return ((const struct options *)options)->error;
}

struct planned {
    struct grid part; /* of the grid: a window's */
    void *direct;     /* of back projection, or */
    struct factorised *tree;
};

/* A window has a tree of its own. */
static struct problem tree_problem(const struct problem *problem, struct grid *part)
{
    struct problem own = *problem;
    if (own.window) {
        *part = grid_part(own.patches, own.window);
        own.patches = part;
        own.window = NULL;
    }
    return own;
}

static int conditions(const struct problem *problem, const void *method, const void *options, struct condition *list,
                      int room)
{
    (void)method, (void)options;
    return conditions_sampled(problem, list, room);
}

static enum status requirements_check(const struct problem *problem)
{
    struct condition list[CONDITIONS_MAX];
    return conditions_check("bp_factorised", list, conditions_sampled(problem, list, CONDITIONS_MAX));
}

/* Without images: back projection by polynomials. */
static const struct bp_options direct_options = {BP_ENGINE_AUTO, 0, 1e-4, 1};

static enum status direct_branches(const struct problem *problem, double error, struct interpolator *branches)
{
    const int degree = farrow_degree_choose(error, problem, 1);
    *branches = (struct interpolator){.upsample = 1, .taps = 1, .degree = degree};
    return degree > 0 ? STATUS_OK : STATUS_FAILED;
}

static enum status plan_direct(const struct problem *problem, double error, void **plan)
{
    struct interpolator branches;
    const enum status status = direct_branches(problem, error, &branches);
    return status == STATUS_OK ? bp_plan(problem, &branches, &direct_options, plan) : status;
}

static enum status forecast_direct(const struct problem *problem, double error, struct forecast *forecast)
{
    struct interpolator branches;
    const enum status status = direct_branches(problem, error, &branches);
    return status == STATUS_OK ? bp_forecast(problem, &branches, &direct_options, forecast) : status;
}

/* The number of levels with the least work, which falls and then rises with it; 0: back projection itself. */
static enum status choose_stages(const struct problem *problem, struct tree_settings *settings,
                                 struct factorised_cost *chosen)
{
    struct forecast direct;
    double least = INFINITY, before = INFINITY;
    enum status status = forecast_direct(problem, settings->error, &direct);
    if (status == STATUS_OK)
        status = factorised_cost_direct(problem, &direct, &least);
    struct tree_settings tried = *settings;
    settings->stages = 0;
    double pings = tried.base;
    for (tried.stages = 1; status == STATUS_OK && tried.stages <= STAGES_MOST; tried.stages++) {
        struct factorised_cost cost;
        status = factorised_cost(problem, &tried, &cost);
        if (status == STATUS_OK && factorised_pairs(&cost) < least) {
            least = factorised_pairs(&cost);
            *chosen = cost;
            settings->stages = tried.stages;
        }
        if (status == STATUS_OK && (pings >= problem->acquisition->pings || factorised_pairs(&cost) > before))
            break;
        before = factorised_pairs(&cost);
        pings *= tried.factor;
    }
    return status;
}

/* The settings planned; the cost is given if the number of levels was chosen and is not 0. */
static enum status settings_make(const struct problem *problem, const struct options *options,
                                 struct tree_settings *settings, struct factorised_cost *cost)
{
    const int base = options->base / problem->acquisition->receivers;
    *settings = (struct tree_settings){options->error, base > 1 ? base : 1, options->factor, options->stages - 1};
    return options->stages == STAGES_AUTO ? choose_stages(problem, settings, cost) : STATUS_OK;
}

/* Its errors are counted as well: they decide the number of levels. */
static enum status cost(const struct problem *problem, const void *method, const void *given, struct forecast *forecast)
{
    (void)method;
    const struct options *options = given;
    struct tree_settings settings;
    struct factorised_cost own;
    enum status status = requirements_check(problem);
    if (status == STATUS_OK)
        status = settings_make(problem, options, &settings, &own);
    if (status == STATUS_OK && settings.stages > 0 && options->stages != STAGES_AUTO)
        status = factorised_cost(problem, &settings, &own);
    if (status != STATUS_OK)
        return status;
    if (settings.stages > 0)
        return factorised_forecast(problem, &settings, &own, forecast);
    return forecast_direct(problem, options->error, forecast);
}

static enum status plan(const struct problem *problem, const void *method, const void *given, void **out)
{
    (void)method;
    const struct options *options = given;
    struct tree_settings settings;
    struct factorised_cost cost;
    *out = NULL;
    struct planned *planned = calloc(1, sizeof *planned);
    if (!planned)
        return status_set(STATUS_FAILED, "no memory for the plan");
    const struct problem own = tree_problem(problem, &planned->part);
    enum status status = requirements_check(problem);
    if (status == STATUS_OK)
        status = settings_make(&own, options, &settings, &cost);
    if (status == STATUS_OK && settings.stages == 0)
        status = plan_direct(problem, options->error, &planned->direct);
    else if (status == STATUS_OK)
        status = factorised_plan(&own, &settings, &planned->tree);
    if (status != STATUS_OK) {
        free(planned);
        return status;
    }
    *out = planned;
    return STATUS_OK;
}

static enum status execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    const struct planned *planned = plan;
    if (planned->direct)
        return bp_execute(planned->direct, echoes, image, stages);
    return factorised_execute(planned->tree, echoes, image, stages);
}

static void reads(const void *plan, bool *read)
{
    const struct planned *planned = plan;
    if (planned->direct)
        bp_reads(planned->direct, read);
    else
        factorised_reads(planned->tree, read);
}

static struct work work(const void *plan)
{
    const struct planned *planned = plan;
    struct work work = planned->direct ? bp_work(planned->direct) : factorised_work(planned->tree);
    work.bytes += sizeof *planned;
    return work;
}

static void destroy(void *plan)
{
    struct planned *planned = plan;
    if (!planned)
        return;
    bp_destroy(planned->direct);
    factorised_destroy(planned->tree);
    free(planned);
}

static const struct candidate_family candidates[] = {
    {"", "error", "budget"},
    {.fixed = NULL},
};

static const char *const gated[] = {"stages=1,base=4", "stages=2,base=2,factor=4,error=1e-3",
                                    "stages=2,base=2,factor=4,error=1e-3,precision=double", NULL};

const struct algorithm bp_factorised = {
    .name = "bp_factorised",
    .summary = "fast factorised back projection, subapertures on polar grids",
    .reference = "Ulander, Hellsten, Stenstrom, IEEE TAES 39 (2003)",
    .traits = TRAIT_ANY_TRACK | TRAIT_APERTURE_LIMIT | TRAIT_WINDOW,
    .options_size = sizeof(struct options),
    .params = params,
    .gated = gated,
    .candidates = candidates,
    .conditions = conditions,
    .promise = promise,
    .cost = cost,
    .plan = plan,
    .execute = execute,
    .reads = reads,
    .work = work,
    .destroy = destroy,
};
