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
#include "sweep/sweep_group.h"

/* The front, then the settings that only the noise of the times keeps off it. */
static void fronts_write(struct group *group, FILE *file)
{
    for (int c = 0; c < SWEEP_COSTS; c++) {
        group_values(group, &sweep_costs[c]);
        const int size = pareto_front_find(group->points.count, group->cost, group->error, group->front);
        const int ties =
            pareto_ties_find(group->points.count, group->low, group->high, group->error, size, group->front);
        for (int k = 0; k < size + ties; k++) {
            const struct measurement *row = group->points.list[group->front[k]].row;
            csv_write_fields(file,
                             (const char *const[]){row->scene, sweep_costs[c].name, row->algorithm, row->options,
                                                   row->precision, NULL},
                             (double[]){group->cost[group->front[k]], row->error, k >= size}, 3, true);
        }
    }
}

/* The rules for the upsampling rate at this scene's numbers (BP22 Eq. (20), ZP15's lambda/8), and two error laws:
   the envelope's phase at the band's edge at rate 1, which falls as 1/rate, and the floor of linear interpolation.
   That is its loss 1 - sinc^2(f/fs), about (pi f/fs)^2/3, rms over a flat band |f| <= B/2:
   pi^2 (B/fs)^2/(12 sqrt 5). A scene that is missing or has changed since has none. */
static void rules_write(struct group *group, const struct scene *given, const struct csv *csv, FILE *file)
{
    struct scene scene = {0};
    char key[300], hash[17];
    if (!given && scene_load(group->points.scene, SCENE_DIRECTORY, &scene) != STATUS_OK)
        return;
    given = given ? given : &scene;
    snprintf(key, sizeof key, "scene %s", group->points.scene);
    snprintf(hash, sizeof hash, "%016" PRIx64, given->hash);
    const char *measured = csv_comment(csv, key);
    if (measured && strcmp(measured, hash) == 0) {
        const struct acquisition *a = &given->acquisition;
        double lambda = a->sound_speed / a->fc, bin = a->sound_speed / (2 * a->fs);
        double resolution = a->tx_length > 0 ? a->tx_length / 2 : NAN, fraction = a->bandwidth / a->fs;
        double bp22 = 2 * bin * 10 * lambda / (resolution * resolution), zp15 = 2 * a->fc / a->fs;
        csv_write_fields(file, (const char *const[]){group->points.scene, NULL},
                         (double[]){a->fc, a->fs, a->bandwidth, bp22, zp15, M_PI * fraction / 2,
                                    M_PI * M_PI / (12 * sqrt(5)) * fraction * fraction},
                         7, true);
        if (group->told)
            printf("\n%s: upsampling rates required by BP22 Eq. (20) > %.3g, by ZP15's lambda/8 > %.3g\n",
                   group->points.scene, bp22, zp15);
    }
    scene_free(&scene);
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

/* `given` is the scene itself, or NULL. */
static enum status scene_tables(const struct results *results, const char *scene, const struct scene *given, bool told,
                                struct text_file *files)
{
    struct group group;
    enum status status = group_fill(results, scene, &group);
    group.told = told;
    if (status == STATUS_OK && group.points.count > 0) {
        fronts_write(&group, files[FRONTS].stream);
        cheapest_write(&group, files[CHEAPEST].stream);
        rules_write(&group, given, &results->csv, files[RULES].stream);
        slopes_write(&group, files[SLOPES].stream);
    }
    group_free(&group);
    return status;
}

bool scene_seen(const struct results *results, int row)
{
    for (int k = 0; k < row; k++)
        if (strcmp(results->measurements[k].scene, results->measurements[row].scene) == 0)
            return true;
    return false;
}

static enum status table_open(const char *directory, int table, const struct csv *csv, struct text_file *file)
{
    static const char *const keys[] = {"machine", "commit", "date", "threads"};
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", directory, tables[table].file);
    enum status status = text_file_open(path, file);
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

const struct scene *scene_find(const struct scene *scenes, int count, const char *name)
{
    for (int k = 0; k < count; k++)
        if (strcmp(scenes[k].name, name) == 0)
            return &scenes[k];
    return NULL;
}

enum status sweep_tables(const char *directory, const struct scene *scenes, int scene_count, const char *told)
{
    struct results results;
    struct text_file files[TABLES];
    int opened = 0;
    char path[4096];
    snprintf(path, sizeof path, "%s/measurements.csv", directory);
    enum status status = results_read(path, &results);
    while (opened < TABLES && status == STATUS_OK) {
        status = table_open(directory, opened, &results.csv, &files[opened]);
        opened += status == STATUS_OK;
    }
    for (int row = 0; row < results.csv.row_count && status == STATUS_OK; row++)
        if (!scene_seen(&results, row)) {
            const char *scene = results.measurements[row].scene;
            status = scene_tables(&results, scene, scene_find(scenes, scene_count, scene),
                                  told && strcmp(told, scene) == 0, files);
        }
    for (int k = 0; k < opened; k++)
        status = text_file_close(&files[k], status);
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
