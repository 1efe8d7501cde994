/* The command `bench` (bench.h); scenes/bench has its lines and goals. */
#include "bench/bench.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/isa.h"
#include "files/csv.h"
#include "echoes/echo_data.h"
#include "files/folder.h"
#include "files/paths.h"
#include "files/text_file.h"
#include "imaging/imaging.h"
#include "results/rows.h"
#include "show/plot.h"
#include "bench/bench_line.h"

struct bench {
    const char *directory;
    int count;
    struct bench_line *lines; /* [count] those of one scene in a row */
    FILE *file;               /* of bench.csv */
};

static void bench_free(struct bench *bench)
{
    for (int k = 0; k < bench->count; k++)
        spec_free(&bench->lines[k].spec);
    free(bench->lines);
}

/* ---- lines ---- */

static const char *line_isa(const struct bench_line *line)
{
    return *line->isa ? line->isa : isa_name(isa_choose());
}

/* The run on one thread over that on all; NAN where one was not measured. */
static double gain_of_threads(const struct bench *bench, const struct bench_line *line)
{
    for (int k = 0; k < bench->count; k++) {
        const struct bench_line *alone = &bench->lines[k];
        if (alone->measured && alone->threads == 1 && line->threads > 1 && spec_equal(&alone->spec, &line->spec)
            && strcmp(alone->scene, line->scene) == 0 && strcmp(alone->isa, line->isa) == 0)
            return alone->row.run_s / line->row.run_s;
    }
    return NAN;
}

static void bench_head_write(FILE *file)
{
    struct provenance p;
    provenance_fill(&p, omp_get_max_threads());
    fputs("# sasbench bench 5\n", file);
    provenance_write(file, &p);
    fprintf(file, "line,scene,engine,isa,algorithm,precision,threads,columns,rows,runs,pairs,flops,plan_bytes,plan_s,"
                  "run_s,sum_s,pairs_per_s,peak_flops,fraction_of_peak,ratio_to_control,gain_of_threads,error,"
                  "fft_plan_s,fft_strips_s,run_to_fft\n");
    printf("\n%-16s %-8s %-34s %-6s %2s %8s %8s %7s %6s %7s %5s %6s\n", "scene", "isa", "algorithm", "prec.", "t",
           "plan s", "run s", "Gpair/s", "peak", "control", "gain", "FFTs");
}

static void line_write(const struct bench *bench, const struct bench_line *line)
{
    const struct measurement *row = &line->row;
    const double rate = row->pairs > 0 ? row->pairs / measurement_stage(row, "focus") : NAN;
    const double flops = line->pair_flops > 0 ? line->pair_flops * rate : row->flops / row->run_s;
    const double peak = bench_peak(line), gain = gain_of_threads(bench, line);
    const double numbers[] = {line->threads,
                              line->columns,
                              line->rows,
                              row->runs,
                              row->pairs,
                              row->flops,
                              row->bytes,
                              row->plan_s,
                              row->run_s,
                              measurement_stage(row, "focus"),
                              rate,
                              peak,
                              flops / peak,
                              row->control_s / row->run_s,
                              gain,
                              row->error,
                              line->fft.plan,
                              line->fft.strips,
                              row->run_s / line->fft.best};
    char name[320];
    snprintf(name, sizeof name, "%s%s%s", line->spec.algorithm->name, *line->spec.text ? ":" : "", line->spec.text);
    csv_write_fields(bench->file,
                     (const char *const[]){line->name, line->scene, line->engine, line_isa(line), name,
                                           precision_name(line->spec.precision), NULL},
                     numbers, sizeof numbers / sizeof *numbers, true);
    printf("%-16s %-8s %-34.34s %-6s %2d %8.3g %8.3g %7.3f %6.3f %7.3g %5.2f %6.2f\n", line->scene, line_isa(line),
           name, precision_name(line->spec.precision), line->threads, row->plan_s, row->run_s, 1e-9 * rate,
           flops / peak, row->control_s / row->run_s, gain, row->run_s / line->fft.best);
    fflush(stdout);
}

/* The lines from one on that follow one another for one scene, and that this machine can measure. */
static enum status scene_measure(struct bench *bench, int first, int count)
{
    struct scene scene;
    struct bench_line **lines = calloc((size_t)count, sizeof(struct bench_line *));
    int here = 0;
    for (int k = first; lines && k < first + count; k++)
        if (bench_line_here(&bench->lines[k]))
            lines[here++] = &bench->lines[k];
    enum status status = lines ? scene_load(bench->lines[first].scene, data_path(DATA_SCENES), &scene)
                               : status_set(STATUS_FAILED, "no memory for %d lines", count);
    if (status == STATUS_OK) {
        status = bench_lines_measure(&scene, lines, here);
        scene_free(&scene);
    }
    for (int k = 0; k < here && status == STATUS_OK; k++)
        line_write(bench, lines[k]);
    free(lines);
    return status;
}

/* Into DIRECTORY/bench.csv, with a picture where there are goals: of settings side by side. */
static enum status bench_measure(struct bench *bench, bool picture)
{
    char csv[4200], png[4200], footer[PROVENANCE_LINE];
    struct text_file file;
    snprintf(csv, sizeof csv, "%s/bench.csv", bench->directory);
    snprintf(png, sizeof png, "%s/bench.png", bench->directory);
    enum status status = text_file_open(csv, &file);
    if (status != STATUS_OK)
        return status;
    bench->file = file.stream;
    bench_head_write(file.stream);
    for (int first = 0, next; first < bench->count && status == STATUS_OK; first = next) {
        for (next = first; next < bench->count; next++)
            if (strcmp(bench->lines[next].scene, bench->lines[first].scene) != 0)
                break;
        status = scene_measure(bench, first, next - first);
    }
    status = text_file_close(&file, status);
    if (status != STATUS_OK || !picture)
        return status;
    provenance_line(footer);
    return plot_csv(png, data_path(DATA_PLOTS), "bench.gp", csv, footer);
}

/* The folder is taken for as long as this lasts. */
static enum status directory_measure(struct bench *bench, bool picture)
{
    int lock = -1;
    enum status status = directory_make(bench->directory);
    if (status != STATUS_OK)
        return status;
    status = folder_take(bench->directory, &lock);
    if (status == STATUS_OK)
        status = bench_measure(bench, picture);
    folder_leave(lock);
    return status;
}

/* ---- files ---- */

/* A CSV of the folder with these columns [count] and no others. Errors: as csv_read, STATUS_INVALID. */
static enum status table_read(const char *folder, const char *name, const char *const *columns, struct csv *csv)
{
    char path[4200];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    const enum status status = csv_read(path, CSV_TAIL_KEEP, csv);
    return status == STATUS_OK ? csv_columns(csv, columns, NULL) : status;
}

static enum status cell_refuse(const struct csv *csv, int row, int column, const char *accepted)
{
    return status_set(STATUS_INVALID, "%s: line %d: column %s is '%s'; accepted: %s", csv->path, csv->lines[row],
                      csv->columns[column], csv_cell(csv, row, column), accepted);
}

enum { LINE, SCENE, ALGORITHM, THREADS, ISA, PAIR_FLOPS };
static const char *const line_columns[] = {"line", "scene", "algorithm", "threads", "isa", "pair_flops", NULL};

static enum status line_read(const struct csv *csv, int row, struct bench_line *line)
{
    const char *threads = csv_cell(csv, row, THREADS);
    const bool all = strcmp(threads, "all") == 0;
    *line = (struct bench_line){.name = csv_cell(csv, row, LINE),
                                .scene = csv_cell(csv, row, SCENE),
                                .isa = csv_cell(csv, row, ISA),
                                .threads = all ? omp_get_max_threads() : 1};
    if (!all && strcmp(threads, "1") != 0)
        return cell_refuse(csv, row, THREADS, "1, all");
    if (!csv_number(csv_cell(csv, row, PAIR_FLOPS), &line->pair_flops))
        return cell_refuse(csv, row, PAIR_FLOPS, "a number");
    return spec_own(csv_cell(csv, row, ALGORITHM), &line->spec);
}

/* ---- goals ---- */

enum { OF_LINE, VALUE, OVER, SENSE, GOAL };
static const char *const goal_columns[] = {"line", "value", "over", "sense", "goal", NULL};

struct goal {
    char what[200];
    bool least;                 /* at least the goal; else at most */
    double value, goal, margin; /* margin: at least 1 if it is met; NAN: not measured here */
};

static const struct bench_line *line_find(const struct bench *bench, const char *name)
{
    for (int k = 0; k < bench->count; k++)
        if (strcmp(bench->lines[k].name, name) == 0)
            return &bench->lines[k];
    return NULL;
}

/* The divisor of a value: NAN where it is not measured, 0 for an unknown name. */
static double goal_over(const struct bench *bench, const struct bench_line *line, int value, const char *over)
{
    const struct bench_line *other = line_find(bench, over);
    const struct {
        const char *name;
        double divisor;
    } units[] = {{"", 1},
                 {"peak", bench_peak(line) / line->pair_flops},
                 {"fft", line->fft.best},
                 {"fft by one plan", line->fft.plan}};
    if (other)
        return other->measured ? bench_value(other, value) : NAN;
    for (size_t k = 0; k < sizeof units / sizeof *units; k++)
        if (strcmp(over, units[k].name) == 0)
            return line->measured ? units[k].divisor : NAN;
    return 0;
}

static enum status goal_read(const struct bench *bench, const struct csv *csv, int row, struct goal *goal)
{
    const char *name = csv_cell(csv, row, OF_LINE), *value_name = csv_cell(csv, row, VALUE);
    const char *over = csv_cell(csv, row, OVER), *sense = csv_cell(csv, row, SENSE);
    const struct bench_line *line = line_find(bench, name);
    int value = 0;
    while (bench_values[value] && strcmp(bench_values[value], value_name) != 0)
        value++;
    if (!line)
        return cell_refuse(csv, row, OF_LINE, "a line of lines.csv");
    if (!bench_values[value])
        return cell_refuse(csv, row, VALUE, "run_s, sum_s, full_s, rate, run_rate, phase_s, focused_s, error");
    const double divisor = goal_over(bench, line, value, over);
    if (divisor == 0)
        return cell_refuse(csv, row, OVER, "a line of lines.csv, peak, fft, fft by one plan, or nothing");
    if (!csv_number(csv_cell(csv, row, GOAL), &goal->goal) || !(goal->goal > 0))
        return cell_refuse(csv, row, GOAL, "a number above 0");
    goal->least = strcmp(sense, "at least") == 0;
    if (!goal->least && strcmp(sense, "at most") != 0)
        return cell_refuse(csv, row, SENSE, "at least, at most");
    goal->value = line->measured ? bench_value(line, value) / divisor : NAN;
    goal->margin = goal->least ? goal->value / goal->goal : goal->goal / goal->value;
    snprintf(goal->what, sizeof goal->what, "%s, %s%s%s", name, value_name, *over ? " over " : "", over);
    return STATUS_OK;
}

static int by_margin(const void *a, const void *b)
{
    const double x = ((const struct goal *)a)->margin, y = ((const struct goal *)b)->margin;
    return isnan(x) || isnan(y) ? isnan(x) - isnan(y) : (x > y) - (x < y);
}

/* Print the finding, in five lines at most: how many goals are met, and those that are not, the worst first. `goals`
   are in order. */
static void finding_print(const struct goal *goals, int count, const char *path)
{
    enum { SHOWN = 3 };
    int missed = 0, measured = 0;
    for (int k = 0; k < count; k++) {
        measured += !isnan(goals[k].margin);
        missed += goals[k].margin < 1;
    }
    printf("\n%d of %d goals are met", measured - missed, measured);
    if (measured < count)
        printf(" (%d more cannot be measured on this processor)", count - measured);
    if (missed < measured)
        printf("; the nearest of them: %s %.3g, %s %g", goals[missed].what, goals[missed].value,
               goals[missed].least ? "at least" : "at most", goals[missed].goal);
    putchar('\n');
    for (int k = 0; k < missed && k < SHOWN; k++)
        printf("missed: %s %.3g, %s %g\n", goals[k].what, goals[k].value, goals[k].least ? "at least" : "at most",
               goals[k].goal);
    if (missed > SHOWN)
        printf("missed: %d more; ", missed - SHOWN);
    printf("all of them: %s\n", path);
}

static enum status goals_write(const struct goal *goals, int count, const char *directory)
{
    char path[4200];
    struct text_file file;
    snprintf(path, sizeof path, "%s/goals.csv", directory);
    enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    fprintf(file.stream, "# sasbench goals 2\nwhat,value,sense,goal,held\n");
    printf("\n%-70s %9s    %9s\n", "goals", "measured", "goal");
    for (int k = 0; k < count; k++) {
        const struct goal *g = &goals[k];
        const char *held = isnan(g->margin) ? "not measured" : g->margin < 1 ? "no" : "yes";
        csv_write_fields(file.stream, (const char *const[]){g->what, NULL}, &g->value, 1, false);
        fprintf(file.stream, "%s,%g,%s\n", g->least ? "at least" : "at most", g->goal, held);
        printf("%-70s %9.3g %s %9.3g  %s\n", g->what, g->value, g->least ? ">=" : "<=", g->goal,
               strcmp(held, "yes") == 0 ? "" : held);
    }
    finding_print(goals, count, path);
    return text_file_close(&file, STATUS_OK);
}

/* Every goal; before anything is measured this is a check of its cells. */
static enum status goals_read(const struct bench *bench, const struct csv *csv, struct goal *goals)
{
    enum status status = STATUS_OK;
    for (int row = 0; row < csv->row_count && status == STATUS_OK; row++)
        status = goal_read(bench, csv, row, &goals[row]);
    return status;
}

static enum status goals_measure(struct bench *bench, const struct csv *csv)
{
    struct goal *goals = calloc((size_t)csv->row_count + 1, sizeof *goals);
    enum status status =
        goals ? goals_read(bench, csv, goals) : status_set(STATUS_FAILED, "no memory for %d goals", csv->row_count);
    if (status == STATUS_OK)
        status = directory_measure(bench, true);
    if (status == STATUS_OK)
        status = goals_read(bench, csv, goals);
    if (status == STATUS_OK) {
        qsort(goals, (size_t)csv->row_count, sizeof *goals, by_margin);
        status = goals_write(goals, csv->row_count, bench->directory);
    }
    free(goals);
    return status;
}

enum status bench_goals(const char *folder, const char *directory)
{
    struct csv lines = {0}, goals = {0};
    struct bench bench = {.directory = directory};
    enum status status = table_read(folder, "lines.csv", line_columns, &lines);
    if (status == STATUS_OK)
        status = table_read(folder, "goals.csv", goal_columns, &goals);
    if (status == STATUS_OK && !(bench.lines = calloc((size_t)lines.row_count + 1, sizeof *bench.lines)))
        status = status_set(STATUS_FAILED, "no memory for %d lines", lines.row_count);
    while (status == STATUS_OK && bench.count < lines.row_count) {
        status = line_read(&lines, bench.count, &bench.lines[bench.count]);
        bench.count++;
    }
    if (status == STATUS_OK)
        status = goals_measure(&bench, &goals);
    bench_free(&bench);
    csv_free(&goals);
    csv_free(&lines);
    return status;
}

/* ---- SPECs ---- */

/* Tried in this order. */
static const struct wanted {
    const char *scene;
    bool exact; /* exact algorithms, too, which are slow */
    bool pairs; /* only algorithms that sum pairs: others cost as much for few rows as for all */
} candidates[] = {
    {"bench/rows", false, true},       /* back projection */
    {"lbf21/real_size", false, false}, /* range migration */
    {"sq18/full_20", false, false},    /* omega-k */
    {"sweep/speckle", true, false},
};
enum { CANDIDATES = sizeof candidates / sizeof *candidates };

/* Can an algorithm image the scene? Its plan and its work decide, without echoes. */
static enum status candidate_try(const struct spec *spec, const struct wanted *candidate)
{
    struct scene scene;
    struct imaging imaging;
    enum status status = scene_load(candidate->scene, data_path(DATA_SCENES), &scene);
    if (status != STATUS_OK)
        return status;
    const struct problem problem = scene_problem(&scene, spec->precision);
    status = imaging_open(spec, &problem, &imaging);
    if (status == STATUS_OK) {
        if (candidate->pairs && !(imaging.algorithm->work(imaging.plan).pairs > 0))
            status = status_set(STATUS_UNSUPPORTED, "%s sums no pairs", spec->algorithm->name);
        imaging_close(&imaging);
    }
    scene_free(&scene);
    return status;
}

/* Two lines of a SPEC, in the precision that it names or in the given one. */
static enum status spec_add(struct bench *bench, const struct spec *given, enum precision precision)
{
    enum status status = STATUS_UNSUPPORTED;
    for (int n = 0; n < 1 + (omp_get_max_threads() > 1); n++) {
        struct bench_line *line = &bench->lines[bench->count];
        *line = (struct bench_line){.name = "", .isa = "", .threads = n ? omp_get_max_threads() : 1};
        status = spec_given(given, "precision") ? spec_copy(given, &line->spec)
                                                : spec_vary(given, "precision", precision_name(precision), &line->spec);
        if (status != STATUS_OK)
            return status;
        bench->count++;
        status = STATUS_UNSUPPORTED;
        for (int k = 0; k < CANDIDATES && status == STATUS_UNSUPPORTED; k++) {
            line->scene = candidates[k].scene;
            if (candidates[k].exact || !(given->algorithm->traits & TRAIT_EXACT))
                status = candidate_try(&line->spec, &candidates[k]);
        }
        if (status != STATUS_OK)
            return status;
    }
    return STATUS_OK;
}

enum status bench_specs(const char *directory, const char *const *specs, int count)
{
    struct bench bench = {.directory = directory, .lines = calloc(4 * (size_t)count, sizeof *bench.lines)};
    enum status status = bench.lines ? STATUS_OK : status_set(STATUS_FAILED, "no memory for %d algorithms", count);
    for (int k = 0; k < count && status == STATUS_OK; k++) {
        struct spec given;
        status = spec_asked(specs[k], &given);
        if (status != STATUS_OK)
            break;
        for (int p = 0; p < 2 - spec_given(&given, "precision") && status == STATUS_OK; p++)
            status = spec_add(&bench, &given, (enum precision)p);
        spec_free(&given);
    }
    if (status == STATUS_OK)
        status = directory_measure(&bench, false);
    if (status == STATUS_OK)
        printf("\nResults: %s/bench.csv\n", directory);
    bench_free(&bench);
    return status;
}
