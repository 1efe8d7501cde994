/* Probes (machine_rates.h): one scene whose echoes are zeros, for times do not depend on what
   is summed. */
#include "advise/machine_rates.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <string.h>

#include "common/clock.h"
#include "common/memory.h"
#include "echoes/echo_data.h"
#include "files/paths.h"
#include "imaging/imaging.h"
#include "measure/timing.h"
#include "scene/scene.h"

static const char scene_name[] = "sweep/speckle";
enum { ROUNDS = 3 }; /* of all probes */

/* The least of all rounds, for other work on the machine only adds time. */
struct probe {
    double total, compress, focus; /* s */
    double parts[MIGRATIONS];      /* s: of range migration */
    struct work work;
    struct forecast forecast;
};

static double stage_seconds(const struct stages *stages, const char *name)
{
    for (int k = 0; k < stages->count; k++)
        if (strcmp(stages->stage[k].name, name) == 0)
            return stages->stage[k].seconds;
    return 0;
}

/* The stages of range migration, by what its forecast counts. */
static void parts_add(const struct stages *stages, double parts[MIGRATIONS])
{
    static const struct {
        const char *stage;
        enum migration part;
    } list[] = {{"compress", MIGRATION_RECORDS},  {"map", MIGRATION_RECORDS},     {"spread", MIGRATION_SPREAD},
                {"bulk", MIGRATION_BLOCKS},       {"receivers", MIGRATION_TERMS}, {"differential", MIGRATION_BLOCKS},
                {"reconstruct", MIGRATION_FOCUS}, {"stolt", MIGRATION_FOCUS},     {"focus", MIGRATION_FOCUS},
                {"inverse", MIGRATION_FOCUS}};
    double seconds[MIGRATIONS] = {0};
    for (size_t k = 0; k < sizeof list / sizeof *list; k++)
        seconds[list[k].part] += stage_seconds(stages, list[k].stage);
    for (int k = 0; k < MIGRATIONS; k++)
        parts[k] = fmin(parts[k], seconds[k]);
}

static enum status probe_run(struct imaging *imaging, const struct echoes *echoes, struct probe *probe)
{
    enum status status = STATUS_OK;
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        struct stages stages;
        stages_begin(&stages);
        const double begin = stages.mark;
        status = imaging_execute(imaging, echoes, &stages);
        if (k == 0)
            continue; /* warm-up */
        probe->total = fmin(probe->total, seconds_now() - begin);
        probe->compress = fmin(probe->compress, stage_seconds(&stages, "compress"));
        probe->focus = fmin(probe->focus, stage_seconds(&stages, "focus"));
        parts_add(&stages, probe->parts);
    }
    return status;
}

/* The images of the probes: some rows of the scene with all of its columns; for many pairs for each entry of a table,
   as many records of fewer receivers and more pings, fewer rows and more columns; for few pairs, few columns; and a
   column of pixels further apart than samples. */
struct bench {
    struct scene scene;
    struct acquisition dense;
    struct grid usual, wide, narrow, steep;
    struct echoes echoes[2];
};

static enum status probe_spec(const struct bench *bench, const char *text, const struct grid *grid, struct probe *probe)
{
    const struct acquisition *acquisition = grid == &bench->wide ? &bench->dense : &bench->scene.acquisition;
    struct spec spec;
    struct imaging imaging;
    enum status status = spec_parse(text, &spec);
    if (status != STATUS_OK)
        return status;
    const struct problem problem = problem_make(acquisition, 1, grid, spec.precision);
    status = algorithm_cost(spec.algorithm, &problem, spec.options, &probe->forecast);
    if (status == STATUS_OK)
        status = imaging_open(&spec, &problem, &imaging);
    if (status == STATUS_OK) {
        probe->work = imaging.algorithm->work(imaging.plan);
        status = probe_run(&imaging, &bench->echoes[spec.precision], probe);
        imaging_close(&imaging);
    }
    spec_free(&spec);
    return status;
}

static const char *const specs[] = {"bp_nearest:engine=",
                                    "bp_linear:engine=",
                                    "bp_sinc:taps=4,engine=",
                                    "bp_sinc:taps=16,engine=",
                                    "bp_farrow:degree=3,engine=",
                                    "bp_farrow:degree=7,engine=",
                                    "bp_nearest:precision=double,engine="};
enum { NEAREST, LINE, FEW_TAPS, MANY_TAPS, FEW_BRANCHES, MANY_BRANCHES, DOUBLE, PROBES, PROBE_SETS = 5 };

/* Of a probe on two images: focus = pairs p + units u, twice. Neither is below 0. */
static void parts_solve(const struct probe *wide, const struct probe *narrow, double *pair, double *unit)
{
    const double p = wide->work.pairs, q = narrow->work.pairs, u = wide->forecast.units, w = narrow->forecast.units;
    *unit = fmin(fmax((narrow->focus * p - wide->focus * q) / (w * p - u * q), 0), wide->focus / u);
    *pair = (wide->focus - *unit * u) / p;
}

/* Of few values and of many: few = rate + value times their number, twice. Neither is below 0; where many cost more
   than in proportion, between the two. */
static void values_solve(double few, double many, const int values[2], double *rate, double *value)
{
    *value = values[1] > values[0] ? fmax(many - few, 0) / (values[1] - values[0]) : 0;
    if (*value * values[0] > few)
        *value = sqrt(few / values[0] * many / values[1]);
    *rate = fmax(few - *value * values[0], 0);
}

/* The rates of a kind, whose probes are of few values and of many. */
static void kind_fill(int engine, enum reading_kind kind, const struct probe *wide[2], const struct probe *narrow[2],
                      struct rates *rates)
{
    const int values[2] = {wide[0]->forecast.values, wide[1]->forecast.values};
    double pairs[2], units[2];
    for (int k = 0; k < 2; k++)
        parts_solve(wide[k], narrow[k], &pairs[k], &units[k]);
    values_solve(pairs[0], pairs[1], values, &rates->pair[engine][kind], &rates->value[engine][kind]);
    values_solve(units[0], units[1], values, &rates->unit[engine][kind], &rates->unit_value[engine][kind]);
}

/* What pairs without shared loads take more than others, of few values and of many. */
static void apart_fill(enum reading_kind kind, const struct probe *few, const struct probe *many, struct rates *rates)
{
    const struct probe *of[2] = {few, many};
    const int values[2] = {few->forecast.values, many->forecast.values};
    double more[2];
    for (int k = 0; k < 2; k++) {
        const double pair = rates->pair[0][kind] + rates->value[0][kind] * values[k],
                     unit = rates->unit[0][kind] + rates->unit_value[0][kind] * values[k];
        const double pairs = of[k]->work.pairs, alone = pairs * of[k]->forecast.apart;
        more[k] = alone > 0 ? fmax(of[k]->focus - pairs * pair - of[k]->forecast.units * unit, 0) / alone : 0;
    }
    values_solve(more[0], more[1], values, &rates->apart[kind], &rates->apart_value[kind]);
}

struct probes {
    struct probe of[2][PROBES], narrow[2][PROBES]; /* by engine; on the narrow image */
    struct probe steep[PROBES];                    /* by the general engine */
    struct probe blocks, terms, images;
    double nearest[ROUNDS]; /* s: of the general engine, in each round */
    double noise;
};

static enum status round_run(const struct bench *bench, struct probes *probes)
{
    enum status status = STATUS_OK;
    const struct {
        const struct grid *grid;
        struct probe *probes;
        const char *engine;
        int without; /* 1 << what rates_fill does not need */
    } sets[] = {{&bench->usual, probes->of[0], "general", 0},
                {&bench->wide, probes->of[1], "invariant", 0},
                {&bench->narrow, probes->narrow[0], "general", 1 << DOUBLE},
                {&bench->narrow, probes->narrow[1], "invariant", 1 << DOUBLE},
                {&bench->steep, probes->steep, "general", 1 << DOUBLE | 1 << FEW_TAPS | 1 << MANY_TAPS}};
    for (int k = 0; k < PROBE_SETS * PROBES && status == STATUS_OK; k++) {
        char text[80];
        const int set = k / PROBES, n = k % PROBES;
        snprintf(text, sizeof text, "%s%s", specs[n], sets[set].engine);
        if (!(sets[set].without & 1 << n))
            status = probe_spec(bench, text, sets[set].grid, &sets[set].probes[n]);
    }
    if (status == STATUS_OK)
        status = probe_spec(bench, "bp_factorised:stages=1,error=1e-3", &bench->usual, &probes->images);
    if (status == STATUS_OK)
        status = probe_spec(bench, "rma_lbf", &bench->usual, &probes->blocks);
    return status == STATUS_OK ? probe_spec(bench, "rma_delay", &bench->usual, &probes->terms) : status;
}

static double determinant(const double a[3], const double b[3], const double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* The time of records: compress = FLOPs c of transforms + FLOPs f of filters + values p, of few and many taps and of
   many branches in the general engine; in the invariant engine another p. None is below 0. */
static void records_fill(const struct probes *probes, struct rates *rates)
{
    const struct probe *of[3] = {&probes->of[0][FEW_TAPS], &probes->of[0][MANY_TAPS], &probes->of[0][MANY_BRANCHES]};
    double transforms[3], filters[3], values[3], seconds[3];
    for (int k = 0; k < 3; k++) {
        transforms[k] = of[k]->forecast.record_flops * of[k]->forecast.slowness;
        filters[k] = of[k]->forecast.kernel_flops;
        values[k] = of[k]->forecast.record_values;
        seconds[k] = of[k]->compress;
    }
    const double all = determinant(transforms, filters, values);
    rates->compress = fmax(determinant(seconds, filters, values) / all, 0);
    rates->filter = fmax(determinant(transforms, seconds, values) / all, 0);
    rates->put[0] = fmax(determinant(transforms, filters, seconds) / all, 0);
    const struct forecast *f = &probes->of[1][MANY_BRANCHES].forecast;
    const double rest = probes->of[1][MANY_BRANCHES].compress - rates->compress * f->record_flops * f->slowness
                        - rates->filter * f->kernel_flops;
    rates->put[1] = fmax(rest, 0) / f->record_values;
}

/* The time of subapertures' images, beside the pairs that they are summed from; at least a tenth of all. */
static void image_fill(const struct probe *probe, struct rates *rates)
{
    const struct forecast *f = &probe->forecast;
    const double pair = rates->pair[0][f->kind] + rates->value[0][f->kind] * f->values,
                 unit = rates->unit[0][f->kind] + rates->unit_value[0][f->kind] * f->values;
    const double all = probe->total - probe->compress, sums = pair * f->image_pairs + unit * f->units;
    rates->image = fmax(all - sums, 0.1 * all) / f->image_cost;
}

static void rates_fill(const struct probes *probes, struct rates *rates)
{
    static const struct {
        enum reading_kind kind;
        int few, many;
    } kinds[] = {{READ_NEAREST, NEAREST, NEAREST},
                 {READ_LINE, LINE, LINE},
                 {READ_TAPS, FEW_TAPS, MANY_TAPS},
                 {READ_BRANCHES, FEW_BRANCHES, MANY_BRANCHES}};
    for (int engine = 0; engine < 2; engine++)
        for (int k = 0; k < READ_KINDS; k++)
            kind_fill(
                engine, kinds[k].kind,
                (const struct probe *[]){&probes->of[engine][kinds[k].few], &probes->of[engine][kinds[k].many]},
                (const struct probe *[]){&probes->narrow[engine][kinds[k].few], &probes->narrow[engine][kinds[k].many]},
                rates);
    for (int k = 0; k < READ_KINDS; k++)
        if (kinds[k].kind != READ_TAPS) /* whose pixels always load their own */
            apart_fill(kinds[k].kind, &probes->steep[kinds[k].few], &probes->steep[kinds[k].many], rates);
    records_fill(probes, rates);
    image_fill(&probes->images, rates);
    for (int k = 0; k < MIGRATIONS; k++) {
        const struct probe *of = k == MIGRATION_BLOCKS ? &probes->blocks : &probes->terms;
        rates->migrate[k] = of->parts[k] / of->forecast.migration[k];
    }
    rates->doubled = sqrt(probes->of[0][DOUBLE].total / probes->of[0][NEAREST].total * probes->of[1][DOUBLE].total
                          / probes->of[1][NEAREST].total);
    rates->noise = probes->noise;
}

/* Rounds of all probes. The noise: by how much the first of them was slower in the median round than in the fastest. */
static enum status rounds_run(const struct bench *bench, struct probes *probes)
{
    struct probe none = {.total = INFINITY, .compress = INFINITY, .focus = INFINITY};
    struct probe *const all[] = {probes->of[0], probes->of[1], probes->narrow[0], probes->narrow[1], probes->steep};
    enum status status = STATUS_OK;
    for (int k = 0; k < MIGRATIONS; k++)
        none.parts[k] = INFINITY;
    for (int k = 0; k < PROBE_SETS * PROBES; k++)
        all[k / PROBES][k % PROBES] = none;
    probes->blocks = probes->terms = probes->images = none;
    for (int number = 0; number < ROUNDS && status == STATUS_OK; number++) {
        struct probe nearest = none;
        status = probe_spec(bench, "bp_nearest:engine=general", &bench->usual, &nearest);
        probes->nearest[number] = nearest.total;
        if (status == STATUS_OK)
            status = round_run(bench, probes);
    }
    const double middle = median(probes->nearest, ROUNDS); /* sorts them */
    probes->noise = middle / probes->nearest[0] - 1;
    return status;
}

/* The scene's records, as if they were of a quarter of the receivers and pings RATES_COLUMNS columns
   apart about the image. */
static enum status dense_make(struct bench *bench)
{
    enum { TIMES = 4 };
    const struct acquisition *a = &bench->scene.acquisition;
    struct acquisition *dense = &bench->dense;
    const struct grid *g = &bench->usual;
    *dense = *a;
    dense->pings *= TIMES;
    dense->receivers /= TIMES;
    const enum status status = acquisition_allocate(dense);
    if (status != STATUS_OK)
        return status;
    memcpy(dense->pulse, a->pulse, (size_t)a->pulse_length * sizeof *a->pulse);
    for (int p = 0; p < dense->pings; p++) {
        const double x = g->x_first + (0.5 * g->x_count + RATES_COLUMNS * (p - dense->pings / 2)) * g->x_step;
        dense->t0[p] = a->t0[0];
        dense->velocity[p] = a->velocity[0];
        dense->tx[p] = (struct vector){x, a->tx[0].y, a->tx[0].z};
        for (int m = 0; m < dense->receivers; m++) {
            struct vector *rx = &dense->rx[p * dense->receivers + m];
            *rx = a->rx[m];
            rx->x += x - a->tx[0].x;
        }
    }
    return STATUS_OK;
}

static enum status zeros_make(const struct acquisition *a, enum precision precision, struct echoes *echoes)
{
    const enum status status = echoes_allocate(a, precision, echoes);
    if (status == STATUS_OK)
        memory_clear((void *)echoes->samples, samples_bytes(a, precision));
    return status;
}

enum status machine_rates_measure(struct rates *rates)
{
    struct bench bench = {.echoes = {{0}, {0}}};
    struct probes probes = {0};
    const int threads = omp_get_max_threads();
    *rates = (struct rates){.doubled = 1};
    enum status status = scene_load(scene_name, data_path(DATA_SCENES), &bench.scene);
    if (status != STATUS_OK)
        return status;
    bench.usual = bench.scene.patches[0];
    bench.usual.r_count = 40; /* are enough rows */
    bench.wide = bench.narrow = bench.usual;
    bench.wide.r_count /= 4;
    bench.wide.x_count *= 4;
    bench.wide.x_first -= 1.5 * bench.usual.x_count * bench.usual.x_step;
    bench.narrow.x_count /= 4;
    bench.steep = bench.usual;
    bench.steep.x_count /= 10;
    bench.steep.r_count *= 10;
    bench.steep.r_step *= 1.25; /* samples */
    status = dense_make(&bench);
    for (int precision = 0; precision < 2 && status == STATUS_OK; precision++)
        status = zeros_make(&bench.scene.acquisition, (enum precision)precision, &bench.echoes[precision]);
    omp_set_num_threads(1); /* its time of waiting for a processor is measured */
    seconds_skip_waiting();
    if (status == STATUS_OK)
        status = rounds_run(&bench, &probes);
    clock_set(clock_monotonic);
    omp_set_num_threads(threads);
    if (status == STATUS_OK)
        rates_fill(&probes, rates);
    echoes_free(&bench.echoes[0]);
    echoes_free(&bench.echoes[1]);
    acquisition_free(&bench.dense);
    scene_free(&bench.scene);
    return status;
}
