#include "tests/algorithms/conformance_counted.h"
#include "files/paths.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "conformance/conformance.h"
#include "files/csv.h"
#include "gate/baseline.h"
#include "tests/allocations.h"

static void run_plan(const struct conformance *c, void *plan, const struct echoes *echoes, struct image *image)
{
    struct stages stages;
    stages_begin(&stages);
    conformance_need(c, c->algorithm->execute(plan, echoes, image, &stages));
}

/* What a plan holds, in one precision: as many bytes as work.bytes says (with one thread), nothing taken or planned by
   execute, nothing left by destroy. */
static void check_held(const struct conformance *c, const struct scene *scene, const struct echoes *echoes,
                       enum precision precision)
{
    const char *place = precision == PRECISION_DOUBLE ? "raw, double" : "raw, float";
    const struct problem problem = scene_problem(scene, precision);
    struct echoes converted;
    struct image first, second;
    void *plan;
    conformance_need(c, echoes_convert(echoes, precision, &converted));
    conformance_need(c, image_allocate(1, problem.patches, precision, &first));
    conformance_need(c, image_allocate(1, problem.patches, precision, &second));
    omp_set_num_threads(1);
    allocations_begin(-1);
    if (!conformance_plan(c, c->usual, &problem, &plan))
        return;
    struct allocations planned = allocations_now();
    double bytes = c->algorithm->work(plan).bytes;
    run_plan(c, plan, &converted, &first);
    run_plan(c, plan, &converted, &second);
    struct allocations executed = allocations_now();
    c->algorithm->destroy(plan);
    c->algorithm->destroy(NULL);
    struct allocations left = allocations_end();
    promise(c, place, fabs(bytes / planned.bytes - 1) <= 0.01,
            "work.bytes is %.0f, must be what the plan holds on one thread, %.0f, to 1 %%", bytes, planned.bytes);
    promise(c, place, executed.taken == planned.taken && executed.freed == planned.freed,
            "execute allocates %d and frees %d blocks, must be none", executed.taken - planned.taken,
            executed.freed - planned.freed);
    promise(c, place, executed.plans == planned.plans, "execute makes %d FFT plans, must be none",
            executed.plans - planned.plans);
    promise(c, place, left.blocks == 0 && left.plans == left.plans_destroyed,
            "destroy leaves %d blocks of %.0f bytes and %d FFT plans, must be none", left.blocks, left.bytes,
            left.plans - left.plans_destroyed);
    promise(c, place, same_bits(&first, &second), "the same bits by the second execute of a plan");
}

/* Whichever allocation fails: plan says so and leaves nothing, or does without. Of many allocations some 50 are tried,
   evenly, half of them in each precision. */
static void check_refused(const struct conformance *c, const struct scene *scene, enum precision precision)
{
    enum { TRIED = 25 };
    const struct problem problem = scene_problem(scene, precision);
    const void *options = c->specs[precision].options;
    omp_set_num_threads(1);
    void *whole = NULL;
    allocations_begin(-1);
    if (algorithm_plan(c->algorithm, &problem, options, &whole) == STATUS_OK)
        c->algorithm->destroy(whole);
    const int count = allocations_end().taken;
    const int step = 1 + count / TRIED;
    for (int call = precision == PRECISION_DOUBLE ? step / 2 : 0; call < count; call += step) {
        void *plan = NULL;
        allocations_begin(call);
        enum status status = algorithm_plan(c->algorithm, &problem, options, &plan);
        if (status == STATUS_OK)
            c->algorithm->destroy(plan);
        struct allocations left = allocations_end();
        const bool refused = left.refused > 0;
        if (status != STATUS_OK && (!refused || status != STATUS_FAILED || plan || strlen(status_message()) <= 10))
            promise(c, "raw", false,
                    "without the memory of allocation %d plan returns status %d, \"%s\", must be %d with a reason",
                    call, status, status_message(), STATUS_FAILED);
        if (status == STATUS_OK && refused)
            promise(c, "raw", false, "plan goes on without the memory of allocation %d, must say so", call);
        if (left.blocks != 0 || left.plans != left.plans_destroyed)
            promise(c, "raw", false,
                    "without the memory of allocation %d plan leaves %d blocks and %d FFT plans, must be none", call,
                    left.blocks, left.plans - left.plans_destroyed);
    }
}

static void check_allocations(const struct conformance *c, const struct setting *setting)
{
    struct scene scene;
    struct grid grids[2];
    struct echoes echoes;
    conformance_echoes(c, setting, &scene, grids, &echoes);
    for (int precision = 0; precision < 2; precision++) {
        check_held(c, &scene, &echoes, (enum precision)precision);
        check_refused(c, &scene, (enum precision)precision);
    }
}

/* Its quality and work are on record, so that the gate can tell when they get worse. */
static void check_baseline(const struct conformance *c, const struct setting *setting)
{
    struct csv csv;
    int rows = 0;
    (void)setting;
    conformance_need(c, csv_read(data_path(DATA_BASELINE), CSV_TAIL_KEEP, &csv));
    for (int row = 0; row < csv.row_count; row++)
        rows += strcmp(csv_cell(&csv, row, csv_column(&csv, "algorithm")), c->algorithm->name) == 0;
    promise(c, "results/baseline.csv", rows > 0,
            "%d rows of it; `./sasbench baseline` adds them: review and commit them with the algorithm", rows);
}

int conformance_counted(const char *algorithm)
{
    static const struct conformance_check more[] = {{"allocations", check_allocations, false},
                                                    {"baseline", check_baseline, false}};
    struct spec spec;
    if (spec_parse(algorithm, &spec) != STATUS_OK) {
        fprintf(stderr, "%s\n", status_message());
        return 1;
    }
    const int broken = conformance_run(&spec, stdout, more, sizeof more / sizeof *more);
    spec_free(&spec);
    return broken;
}
