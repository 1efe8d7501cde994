/* Tables from the rows of a sweep (sweep_tables.h). */
#include "sweep/sweep_tables.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "files/csv.h"
#include "scene/scene.h"
#include "text/shown_text.h"
#include "show/plot_points.h"
#include "show/table.h"
#include "files/paths.h"
#include "files/text_file.h"

const struct sweep_cost sweep_costs[SWEEP_COSTS] = {
    [SWEEP_RUN_TIME] = {"run_s", "run time", offsetof(struct measurement, run_s)},
    [SWEEP_FLOPS] = {"flops", "counted FLOPs", offsetof(struct measurement, flops)},
};

/* The front, then the settings that only the noise of the times keeps off it. */
static enum status fronts_write(const struct points *points, FILE *file)
{
    const size_t most = (size_t)points->count + 1;
    double *cost = calloc(4 * most, sizeof *cost), *error = cost + most, *low = error + most, *high = low + most;
    int *front = calloc(most, sizeof *front);
    for (int c = 0; c < SWEEP_COSTS && cost && front; c++) {
        for (int k = 0; k < points->count; k++) {
            const struct measurement *row = points->list[k].row;
            cost[k] = low[k] = high[k] = *(const double *)((const char *)row + sweep_costs[c].offset);
            error[k] = row->error;
            if (c == SWEEP_RUN_TIME)
                measurement_interval(row, &low[k], &high[k]);
        }
        const int size = pareto_front_find(points->count, cost, error, front);
        const int ties = pareto_ties_find(points->count, low, high, error, size, front);
        for (int k = 0; k < size + ties; k++) {
            const struct measurement *row = points->list[front[k]].row;
            csv_write_fields(file,
                             (const char *const[]){row->scene, sweep_costs[c].name, row->algorithm, row->options,
                                                   row->precision, NULL},
                             (double[]){cost[front[k]], row->error, k >= size}, 3, true);
        }
    }
    const bool whole = cost && front;
    free(cost);
    free(front);
    return whole ? STATUS_OK : status_set(STATUS_FAILED, "%s: no memory for %zu rows", points->scene, most);
}

const struct scene *scene_measured(const struct csv *csv, const struct scene *scenes, int count, const char *name,
                                   struct scene *loaded)
{
    const struct scene *scene = NULL;
    char key[300], hash[17];
    *loaded = (struct scene){0};
    for (int k = 0; k < count; k++)
        scene = strcmp(scenes[k].name, name) == 0 ? &scenes[k] : scene;
    if (!scene && scene_load(name, data_path(DATA_SCENES), loaded) != STATUS_OK)
        return NULL;
    scene = scene ? scene : loaded;
    snprintf(key, sizeof key, "scene %s", name);
    snprintf(hash, sizeof hash, "%016" PRIx64, scene->hash);
    const char *measured = csv_comment(csv, key);
    return measured && strcmp(measured, hash) == 0 ? scene : NULL;
}

/* The rules for the upsampling rate at this scene's numbers (BP22 Eq. (20), ZP15's lambda/8), and two error laws:
   the envelope's phase at the band's edge at rate 1, which falls as 1/rate, and the floor of linear interpolation.
   That is its loss 1 - sinc^2(f/fs), about (pi f/fs)^2/3, rms over a flat band |f| <= B/2:
   pi^2 (B/fs)^2/(12 sqrt 5). */
static void rules_write(const struct scene *scene, bool told, FILE *file)
{
    const struct acquisition *a = &scene->acquisition;
    double lambda = a->sound_speed / a->fc, bin = a->sound_speed / (2 * a->fs);
    double resolution = a->tx_length > 0 ? a->tx_length / 2 : NAN, fraction = a->bandwidth / a->fs;
    double bp22 = 2 * bin * 10 * lambda / (resolution * resolution), zp15 = 2 * a->fc / a->fs;
    csv_write_fields(file, (const char *const[]){scene->name, NULL},
                     (double[]){a->fc, a->fs, a->bandwidth, bp22, zp15, M_PI * fraction / 2,
                                M_PI * M_PI / (12 * sqrt(5)) * fraction * fraction},
                     7, true);
    if (told)
        printf("\n%s: upsampling rates required by BP22 Eq. (20) > %.3g, by ZP15's lambda/8 > %.3g\n", scene->name,
               bp22, zp15);
}

enum { FRONTS, CHEAPEST, SLOPES, RULES, TABLES };

static const struct {
    const char *file, *format, *header;
} tables[TABLES] = {
    [FRONTS] = {"fronts.csv", "sasbench fronts 1", "scene,cost,algorithm,options,precision,value,error,tie"},
    [CHEAPEST] = {"cheapest.csv", "sasbench cheapest 1",
                  "scene,cost,error_below,algorithm,options,precision,run_s,speed_up,flops,error,error_gain,pslr_db,"
                  "islr_db,family,ties,noise"},
    [SLOPES] = {"slopes.csv", "sasbench slopes 1",
                "scene,algorithm,options,precision,setting,part,first,last,rate_first,rate_last,points,slope,"
                "error_first,error_last,residual_log10"},
    [RULES] = {"rules.csv", "sasbench rules 1",
               "scene,fc_hz,fs_hz,bandwidth_hz,bp22_eq20_rate,zp15_rate,edge_phase_rad,linear_floor"},
};

static enum status scene_tables(const struct results *results, const char *name, const struct scene *scene, bool told,
                                struct text_file *files)
{
    struct points points;
    enum status status = points_find(results, name, &points);
    if (status == STATUS_OK && points.count > 0) {
        status = fronts_write(&points, files[FRONTS].stream);
        cheapest_write(&points, told, files[CHEAPEST].stream);
        if (scene)
            rules_write(scene, told, files[RULES].stream);
        if (status == STATUS_OK)
            status = slopes_write(&points, told, files[SLOPES].stream);
    }
    points_free(&points);
    return status;
}

static enum status table_open(const char *directory, int table, const struct csv *csv, struct text_file *file)
{
    static const char *const keys[] = {"machine", "commit", "date", "threads"};
    enum status status = text_file_in(directory, tables[table].file, file);
    if (status != STATUS_OK)
        return status;
    fprintf(file->stream, "# %s\n", tables[table].format);
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        const char *value = csv_comment(csv, keys[k]);
        fprintf(file->stream, "# %s: %s\n", keys[k], value ? value : "unknown");
    }
    fprintf(file->stream, "%s\n", tables[table].header);
    return STATUS_OK;
}

enum status sweep_tables(const char *directory, const struct scene *scenes, int scene_count, const char *told)
{
    struct results results;
    struct text_file files[TABLES];
    const char **names = NULL;
    int opened = 0, name_count = 0;
    char path[4096];
    snprintf(path, sizeof path, "%s/measurements.csv", directory);
    enum status status = results_read(path, &results);
    if (status == STATUS_OK)
        status = scenes_find(&results, &names, &name_count);
    while (opened < TABLES && status == STATUS_OK) {
        status = table_open(directory, opened, &results.csv, &files[opened]);
        opened += status == STATUS_OK;
    }
    for (int k = 0; k < name_count && status == STATUS_OK; k++) {
        struct scene loaded;
        const struct scene *scene = scene_measured(&results.csv, scenes, scene_count, names[k], &loaded);
        status = scene_tables(&results, names[k], scene, told && strcmp(told, names[k]) == 0, files);
        scene_free(&loaded);
    }
    for (int k = 0; k < opened; k++)
        status = text_file_close(&files[k], status);
    free(names);
    results_free(&results);
    return status;
}

bool sweep_is(const char *directory)
{
    char path[4096];
    struct results results;
    bool found = false;
    snprintf(path, sizeof path, "%s/measurements.csv", directory);
    if (access(path, F_OK) == 0 && results_read(path, &results) == STATUS_OK) {
        for (int k = 1; k < results.csv.row_count && !found; k++) {
            const struct measurement *row = &results.measurements[k], *before = row - 1;
            found = strcmp(row->scene, before->scene) == 0 && strcmp(row->algorithm, before->algorithm) == 0
                    && strcmp(row->options, before->options) != 0;
        }
        results_free(&results);
    }
    return found;
}
