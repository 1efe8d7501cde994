/* Predicted against measured errors (predicted.h). */
#include "advise/predicted.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "files/paths.h"
#include "files/text_file.h"
#include "results/provenance.h"
#include "results/results.h"
#include "imaging/spec.h"
#include "measure/timing.h"
#include "show/plot.h"
#include "sweep/sweep_tables.h"

/* An image that is predicted. */
struct prediction {
    const struct measurement *row;
    const struct algorithm *algorithm;
    double predicted, ratio; /* over the measured one */
    enum cause cause;
};

struct predictions {
    struct prediction *list; /* [count] */
    int count;
};

static enum status row_predict(const struct scene *scene, const struct measurement *row,
                               struct predictions *predictions)
{
    char text[400];
    struct spec spec;
    struct forecast forecast;
    if (strcmp(row->status, "ok") != 0 || !(row->error_gain > 0))
        return STATUS_OK;
    snprintf(text, sizeof text, "%s:%s%sprecision=%s", row->algorithm, row->options, *row->options ? "," : "",
             row->precision);
    if (spec_parse(text, &spec) != STATUS_OK)
        return STATUS_OK; /* of another program */
    enum status status = STATUS_UNSUPPORTED;
    const struct problem problem = scene_problem(scene, spec.precision);
    if (spec.algorithm->cost)
        status = algorithm_forecast(spec.algorithm, &problem, spec.options, &forecast);
    if (status == STATUS_OK && isfinite(forecast_error(&forecast))) {
        const double error = forecast_error(&forecast);
        predictions->list[predictions->count++] =
            (struct prediction){row, spec.algorithm, error, error / row->error_gain, forecast_cause(&forecast)};
    }
    spec_free(&spec);
    return status == STATUS_FAILED ? status : STATUS_OK;
}

/* The rows of one scene. */
static enum status scene_predict(const struct results *results, const struct scene *scene,
                                 struct predictions *predictions)
{
    enum status status = STATUS_OK;
    for (int k = 0; k < results->csv.row_count && status == STATUS_OK; k++)
        if (strcmp(results->measurements[k].scene, scene->name) == 0)
            status = row_predict(scene, &results->measurements[k], predictions);
    return status;
}

/* `algorithm` NULL: all of them. Writes nothing without predictions. */
static void summary_write(const struct predictions *predictions, const struct algorithm *algorithm, double *ratios,
                          FILE *file)
{
    const char *name = algorithm ? algorithm->name : "all";
    int count = 0;
    for (int k = 0; k < predictions->count; k++)
        if (!algorithm || predictions->list[k].algorithm == algorithm)
            ratios[count++] = predictions->list[k].ratio;
    if (count == 0)
        return;
    const double numbers[] = {count,
                              quantile(ratios, count, 0),
                              quantile(ratios, count, 0.25),
                              quantile(ratios, count, 0.5),
                              quantile(ratios, count, 0.75),
                              quantile(ratios, count, 1)};
    csv_write_fields(file, (const char *const[]){name, NULL}, numbers, 6, true);
    printf("  %-12s %6d %9.3g %9.3g %9.3g\n", name, count, numbers[1], numbers[3], numbers[5]);
}

static void rows_write(const struct predictions *predictions, FILE *file)
{
    fputs("# sasbench predicted 1\nscene,algorithm,options,precision,cause,predicted,error_gain,ratio\n", file);
    for (int k = 0; k < predictions->count; k++) {
        const struct prediction *p = &predictions->list[k];
        csv_write_fields(file,
                         (const char *const[]){p->row->scene, p->row->algorithm, p->row->options, p->row->precision,
                                               cause_names[p->cause], NULL},
                         (double[]){p->predicted, p->row->error_gain, p->ratio}, 3, true);
    }
}

static void summaries_write(const struct predictions *predictions, double *ratios, FILE *file)
{
    fputs("# sasbench predictions 1\nalgorithm,images,least,lower_quartile,median,upper_quartile,largest\n", file);
    printf("\nPredicted over measured error (after one gain):\n  %-12s %6s %9s %9s %9s\n", "algorithm", "images",
           "least", "median", "largest");
    summary_write(predictions, NULL, ratios, file);
    for (int k = 0; algorithms[k]; k++)
        summary_write(predictions, algorithms[k], ratios, file);
}

static enum status files_write(const char *directory, const struct predictions *predictions)
{
    struct text_file file;
    double *ratios = calloc((size_t)predictions->count + 1, sizeof *ratios);
    if (!ratios)
        return status_set(STATUS_FAILED, "%s: no memory for %d predictions", directory, predictions->count);
    enum status status = text_file_in(directory, "predicted.csv", &file);
    if (status == STATUS_OK) {
        rows_write(predictions, file.stream);
        status = text_file_close(&file, STATUS_OK);
    }
    if (status == STATUS_OK)
        status = text_file_in(directory, "predictions.csv", &file);
    if (status == STATUS_OK) {
        summaries_write(predictions, ratios, file.stream);
        status = text_file_close(&file, STATUS_OK);
    }
    free(ratios);
    return status;
}

enum status predicted_write(const char *directory, const struct scene *scenes, int scene_count, bool *any)
{
    struct results results;
    struct predictions predictions = {NULL, 0};
    const char **names = NULL;
    int count = 0;
    char path[4200];
    snprintf(path, sizeof path, "%s/measurements.csv", directory);
    *any = false;
    enum status status = results_read(path, &results);
    if (status != STATUS_OK)
        return status;
    predictions.list = calloc((size_t)results.csv.row_count + 1, sizeof *predictions.list);
    if (!predictions.list)
        status = status_set(STATUS_FAILED, "%s: no memory for %d rows", directory, results.csv.row_count);
    if (status == STATUS_OK)
        status = scenes_find(&results, &names, &count);
    for (int k = 0; k < count && status == STATUS_OK; k++) {
        struct scene loaded;
        const struct scene *scene = scene_measured(&results.csv, scenes, scene_count, names[k], &loaded);
        if (scene)
            status = scene_predict(&results, scene, &predictions);
        scene_free(&loaded);
    }
    *any = predictions.count > 0;
    if (status == STATUS_OK && *any)
        status = files_write(directory, &predictions);
    free(predictions.list);
    free(names);
    results_free(&results);
    return status;
}

enum status predicted_draw(const char *directory)
{
    char path[4200], csv[4200], footer[PROVENANCE_LINE];
    snprintf(path, sizeof path, "%s/predicted.png", directory);
    snprintf(csv, sizeof csv, "%s/predicted.csv", directory);
    provenance_line(footer);
    return plot_csv(path, data_path(DATA_PLOTS), "predicted.gp", csv, footer);
}
