/* The command `bench`: how near the engines come to the machine's limits at the papers' sizes. Everything is a ratio of
   one run: against the processor's multiply-add peak, the scalar reference loop, FFTW, or another setting. */
#include "bench/bench.h"

#include "files/folder.h"
#include "files/paths.h"
#include "files/text_file.h"
#include "results/provenance.h"
#include "measure/spec.h"
#include "show/plot.h"
#include "bench/bench_algorithms.h"
#include "bench/bench_bp.h"
#include "bench/bench_front.h"
#include "bench/bench_growth.h"
#include "bench/bench_rma.h"
#include "bench/bench_wk.h"

enum status bench_file(const char *directory, const char *name,
                       enum status (*measure_into)(FILE *file, struct bench_goals *goals), struct bench_goals *goals)
{
    char csv[4096], picture[4096], script[60], footer[PROVENANCE_LINE];
    struct text_file file;
    snprintf(csv, sizeof csv, "%s/%s.csv", directory, name);
    snprintf(script, sizeof script, "%s.gp", name);
    enum status status = text_file_open(csv, &file);
    if (status != STATUS_OK)
        return status;
    status = text_file_close(&file, measure_into(file.stream, goals));
    provenance_line(footer);
    snprintf(picture, sizeof picture, "%s/%s.png", directory, name);
    if (status == STATUS_OK)
        status = plot_csv(picture, PLOT_DIRECTORY, script, csv, footer);
    if (status == STATUS_OK)
        printf("\nResults: %s/%s.csv, %s.png, %s.svg\n", directory, name, name, name);
    return status;
}

/* Each measures into files of its own in the folder, and says what its goals are. */
static enum status (*const parts[])(const char *directory, struct bench_goals *goals) = {bench_bp, bench_front,
                                                                                         bench_rma, bench_wk};

static enum status specs_check(const char *const *specs, int count)
{
    enum status status = STATUS_OK;
    for (int k = 0; k < count && status == STATUS_OK; k++) {
        struct spec spec;
        status = spec_parse(specs[k], &spec);
        if (status == STATUS_OK)
            spec_free(&spec);
    }
    return status;
}

enum status bench_run(const char *directory, const char *const *specs, int count)
{
    struct bench_goals goals = {0};
    int lock = -1;
    enum status status = specs_check(specs, count);
    if (status == STATUS_OK)
        status = directory_make(directory);
    if (status == STATUS_OK)
        status = folder_take(directory, &lock);
    if (status == STATUS_OK && count > 0)
        status = bench_algorithms(directory, specs, count);
    for (size_t k = 0; k < sizeof parts / sizeof *parts && count == 0 && status == STATUS_OK; k++)
        status = parts[k](directory, &goals);
    if (count == 0 && status == STATUS_OK)
        status = bench_growth(directory);
    if (count == 0 && status == STATUS_OK)
        status = bench_goals_write(&goals, directory);
    folder_leave(lock);
    return status;
}
