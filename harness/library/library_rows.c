/* The library's measurements: images scored, algorithms run, their rows (libsasbench.h). */
#include <ctype.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "echoes/echo_data.h"
#include "gate/diff.h"
#include "guests/plugin.h"
#include "library/library.h"
#include "measure/outcome.h"
#include "metrics/metrics.h"
#include "results/measurement.h"
#include "run/visit.h"
#include "sweep/sweep_settings.h"

/* A struct finding of gate/diff.h as a row. */
struct finding_row {
    const char *verdict, *class, *scene, *spec, *detail, *metric, *unit;
    double before, after, change, slack;
    const char *before_text, *after_text;
};

#define F_COLUMN(kind, name)                                                                                           \
    {                                                                                                                  \
#name, COLUMN_##kind, offsetof(struct finding_row, name), .unit = NULL                                         \
    }
static const struct column finding_columns[] = {
    F_COLUMN(TEXT, verdict),    F_COLUMN(TEXT, class),  F_COLUMN(TEXT, scene), F_COLUMN(TEXT, spec),
    F_COLUMN(TEXT, detail),     F_COLUMN(TEXT, metric), F_COLUMN(TEXT, unit),  F_COLUMN(REAL, before),
    F_COLUMN(REAL, after),      F_COLUMN(REAL, change), F_COLUMN(REAL, slack), F_COLUMN(TEXT, before_text),
    F_COLUMN(TEXT, after_text), {.name = NULL}};

_Static_assert((int)COLUMN_TEXT == SASBENCH_TEXT && (int)COLUMN_REAL == SASBENCH_REAL, "one type");

static const struct kind {
    const struct column *columns;
    size_t size;
} kinds[] = {{measurement_columns, sizeof(struct measurement)},
             {target_columns, sizeof(struct target_row)},
             {finding_columns, sizeof(struct finding_row)}};
enum { KINDS = sizeof kinds / sizeof *kinds };

struct sasbench_table {
    int counts[KINDS];
    char *rows[KINDS]; /* structs of the kind, whose texts belong to the table */
};

int sasbench_table(struct sasbench_table **table)
{
    const int threads = turn_begin(NULL, TURN_NONE);
    *table = calloc(1, sizeof **table);
    return turn_end(threads, *table ? STATUS_OK : status_set(STATUS_FAILED, "no memory for a table"));
}

static void row_free(const struct kind *kind, char *row)
{
    for (const struct column *column = kind->columns; column->name; column++)
        if (column->type == COLUMN_TEXT)
            free(*(char **)(row + column->offset));
}

void sasbench_table_free(struct sasbench_table *table)
{
    for (int k = 0; table && k < KINDS; k++) {
        for (int n = 0; n < table->counts[k]; n++)
            row_free(&kinds[k], table->rows[k] + (size_t)n * kinds[k].size);
        free(table->rows[k]);
    }
    free(table);
}

static enum status row_add(struct sasbench_table *table, int k, const void *row)
{
    const struct kind *kind = &kinds[k];
    char *rows = realloc(table->rows[k], ((size_t)table->counts[k] + 1) * kind->size);
    if (!rows)
        return status_set(STATUS_FAILED, "no memory for a row");
    table->rows[k] = rows;
    char *own = rows + (size_t)table->counts[k] * kind->size;
    bool whole = true;
    memcpy(own, row, kind->size);
    for (const struct column *column = kind->columns; column->name; column++)
        if (column->type == COLUMN_TEXT) {
            char **text = (char **)(own + column->offset);
            *text = strdup(*text);
            whole = whole && *text;
        }
    if (whole)
        table->counts[k]++;
    else
        row_free(kind, own);
    return whole ? STATUS_OK : status_set(STATUS_FAILED, "no memory for a row");
}

static enum status outcome_add(struct outcome *outcome, struct sasbench_table *table)
{
    outcome->row.threads = omp_get_max_threads();
    enum status status = row_add(table, SASBENCH_MEASUREMENTS, &outcome->row);
    for (int k = 0; k < outcome->target_count && status == STATUS_OK; k++)
        status = row_add(table, SASBENCH_TARGETS, &outcome->targets[k]);
    return status;
}

static const struct column *column_at(int rows, int index)
{
    const struct column *column = rows >= 0 && rows < KINDS ? kinds[rows].columns : NULL;
    for (int k = 0; column && column->name && k < index; k++)
        column++;
    return column && column->name && index >= 0 ? column : NULL;
}

const char *sasbench_column(int rows, int index, int *type)
{
    const struct column *column = column_at(rows, index);
    if (column)
        *type = (int)column->type;
    return column ? column->name : NULL;
}

int sasbench_table_count(const struct sasbench_table *table, int rows)
{
    return rows >= 0 && rows < KINDS ? table->counts[rows] : 0;
}

/* NULL where there is none. */
static const void *cell_at(const struct sasbench_table *table, int rows, int row, const struct column *column)
{
    return column && row >= 0 && row < table->counts[rows]
               ? table->rows[rows] + (size_t)row * kinds[rows].size + column->offset
               : NULL;
}

const char *sasbench_table_text(const struct sasbench_table *table, int rows, int row, int column)
{
    const struct column *of = column_at(rows, column);
    const void *cell = cell_at(table, rows, row, of);
    return cell && of->type == COLUMN_TEXT ? *(const char *const *)cell : "";
}

double sasbench_table_number(const struct sasbench_table *table, int rows, int row, int column)
{
    const struct column *of = column_at(rows, column);
    const void *cell = cell_at(table, rows, row, of);
    if (cell && of->type == COLUMN_REAL)
        return *(const double *)cell;
    return cell && of->type == COLUMN_INTEGER && *(const int *)cell >= 0 ? *(const int *)cell : NAN;
}

/* The scene's echoes and its exact image, made once. */
static enum status session_need(struct sasbench_scene *scene)
{
    if (turn_is_inner())
        return status_set(STATUS_INVALID, "%s: an algorithm that is measured cannot measure", scene->scene.name);
    if (scene->ready)
        return STATUS_OK;
    enum status status = scene_check(scene);
    if (status == STATUS_OK)
        status = session_open(&scene->scene, &scene->session);
    scene->ready = status == STATUS_OK;
    return status;
}

static enum status name_check(const char *name)
{
    bool plain = *name && strlen(name) <= 60;
    for (size_t k = 0; name[k] && plain; k++)
        plain = isalnum((unsigned char)name[k]) || (k > 0 && strchr("_-.", name[k]));
    if (!plain)
        return status_set(STATUS_INVALID,
                          "the name is '%.200s', must be 1 to 60 letters, digits, '_', '-' or '.', the first a letter "
                          "or digit",
                          name);
    return algorithm_find(name) ? status_set(STATUS_INVALID, "the name is '%s', an algorithm of this library", name)
                                : STATUS_OK;
}

static enum status image_copy(const struct scene *scene, enum precision precision, const void *const *pixels,
                              struct image *image)
{
    const enum status status = image_allocate(scene->patch_count, scene->patches, precision, image);
    if (status != STATUS_OK)
        return status;
    for (int k = 0; k < scene->patch_count; k++)
        memcpy(image->pixels[k], pixels[k],
               size_product((size_t)scene->patches[k].r_count, (size_t)scene->patches[k].x_count, 1,
                            precision_size(precision)));
    return image_is_finite(image)
               ? STATUS_OK
               : status_set(STATUS_INVALID, "the image of %s has pixels that are not finite", scene->name);
}

int sasbench_score(struct sasbench_scene *scene, const char *name, int precision, const void *const *pixels,
                   double seconds, struct sasbench_table *table)
{
    const int threads = turn_begin(scene->context, TURN_ALONE);
    struct image image = {0};
    struct outcome outcome;
    enum status status = precision_check(precision);
    if (status == STATUS_OK)
        status = name_check(name);
    if (status == STATUS_OK && !isnan(seconds) && !(seconds > 0 && seconds < INFINITY))
        status = status_set(STATUS_INVALID, "seconds is %g, must be a number above 0 (s)", seconds);
    if (status == STATUS_OK)
        status = image_copy(&scene->scene, (enum precision)precision, pixels, &image);
    if (status == STATUS_OK)
        status = session_need(scene);
    if (status == STATUS_OK && *scene->session.no_reference)
        status = status_set(STATUS_UNSUPPORTED, "there is no exact image of %s: %s", scene->scene.name,
                            scene->session.no_reference);
    if (status == STATUS_OK)
        status = outcome_score(&scene->session, name, &image, seconds, &outcome);
    if (status == STATUS_OK) {
        status = outcome_add(&outcome, table);
        outcome_free(&outcome);
    }
    image_free(&image);
    return turn_end(threads, status);
}

/* What an algorithm of the caller's does not count. */
static struct work own_work(const void *plan)
{
    (void)plan;
    return (struct work){.flops = NAN, .pairs = NAN, .bytes = NAN, .engine = "caller"};
}

static enum status own_take(const char *name, int precision, const struct sas_algorithm *own, struct plugin *plugin,
                            struct algorithm *algorithm, struct spec *spec)
{
    enum status status = precision_check(precision);
    if (status == STATUS_OK)
        status = name_check(name);
    if (status == STATUS_OK)
        status = plugin_adopt(name, "caller", own, plugin, algorithm);
    if (status == STATUS_OK && algorithm->options_size > 0)
        status = status_set(STATUS_INVALID, "%s: it has settings, which only plug-ins have", name);
    algorithm->work = own_work;
    *spec = (struct spec){.algorithm = algorithm, .precision = (enum precision)precision};
    return status;
}

int sasbench_run(struct sasbench_scene *scene, const char *text, int precision, const struct sas_algorithm *own,
                 int timed, struct sasbench_table *table)
{
    const int threads = turn_begin(scene->context, TURN_ALONE);
    struct plugin plugin = {0};
    struct algorithm algorithm = {0};
    struct spec spec = {0};
    struct outcome outcome;
    enum status status = own ? own_take(text, precision, own, &plugin, &algorithm, &spec) : spec_own(text, &spec);
    if (status == STATUS_OK)
        status = session_need(scene);
    if (status == STATUS_OK) {
        outcome_measure(&scene->session, &spec, timed ? EFFORT_WHOLE : EFFORT_NONE, NULL, &outcome);
        status = outcome_add(&outcome, table);
        outcome_free(&outcome);
    }
    spec_free(&spec);
    return turn_end(threads, status);
}

/* Settings in turn, as the command times them. */
static enum status turns_measure(struct session *session, const struct sweep_settings *settings, int first, bool timed,
                                 struct sasbench_table *table)
{
    const int end = first + TURNS < settings->count ? first + TURNS : settings->count;
    struct timing_samples *samples = calloc(TURNS, sizeof *samples);
    enum status status = samples ? STATUS_OK : status_set(STATUS_FAILED, "no memory for %d settings", TURNS);
    for (int round = 1; round < TIMING_ROUNDS && timed && samples; round++)
        for (int k = first; k < end; k++)
            outcome_round(session, &settings->specs[k], &samples[k - first]);
    for (int k = first; k < end && status == STATUS_OK; k++) {
        struct outcome outcome;
        outcome_measure(session, &settings->specs[k], timed ? EFFORT_WHOLE : EFFORT_NONE,
                        timed ? &samples[k - first] : NULL, &outcome);
        status = outcome_add(&outcome, table);
        outcome_free(&outcome);
    }
    free(samples);
    return status;
}

int sasbench_sweep(struct sasbench_scene *scene, int count, const char *const *texts, const char *precision, int timed,
                   struct sasbench_table *table)
{
    const int threads = turn_begin(scene->context, TURN_ALONE);
    struct sweep_settings settings = {0};
    int taken = 0;
    struct spec *specs = count >= 0 ? calloc((size_t)count + 1, sizeof *specs) : NULL;
    enum status status =
        specs ? STATUS_OK : status_set(STATUS_INVALID, "a sweep of %d SPECs, must be 0 or more", count);
    for (; taken < count && status == STATUS_OK; taken += status == STATUS_OK)
        status = spec_own(texts[taken], &specs[taken]);
    if (status == STATUS_OK)
        status = settings_load(taken, specs, precision, &settings);
    if (status == STATUS_OK)
        status = session_need(scene);
    for (int k = 0; k < settings.count && status == STATUS_OK; k += TURNS)
        status = turns_measure(&scene->session, &settings, k, timed, table);
    settings_free(&settings);
    for (int k = 0; k < taken; k++)
        spec_free(&specs[k]);
    free(specs);
    return turn_end(threads, status);
}

int sasbench_compare(const char *before, const char *after, struct sasbench_table *table)
{
    const int threads = turn_begin(NULL, TURN_NONE);
    struct diff diff = {0};
    enum status status = diff_results(before, after, &diff);
    for (int k = 0; k < diff.finding_count && status == STATUS_OK; k++) {
        const struct finding *f = &diff.findings[k];
        const struct finding_row row = {verdict_names[f->verdict],
                                        class_names[f->class],
                                        f->scene,
                                        f->spec,
                                        f->detail,
                                        f->metric,
                                        f->unit,
                                        f->before,
                                        f->after,
                                        f->change,
                                        f->slack,
                                        f->before_text ? f->before_text : "",
                                        f->after_text ? f->after_text : ""};
        status = row_add(table, SASBENCH_FINDINGS, &row);
    }
    diff_free(&diff);
    return turn_end(threads, status);
}
