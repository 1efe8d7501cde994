/* The papers' tables and figures (tables.h): for each printed number the corresponding measurement, by every
   possible definition. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "files/paths.h"
#include "papers/sources.h"
#include "papers/tables.h"
#include "papers/assumptions.h"
#include "papers/unimaged.h"

int upsampling_rate(double bin_m, double resolution_m, double wavelength_m)
{
    int beta = 0;
    while (beta < 10000 && !(2 * bin_m / (beta + 1) < resolution_m * resolution_m / (10 * wavelength_m)))
        beta++;
    return beta;
}

/* ---- lines of reproduced.csv ---- */

struct lines {
    struct measured *measured;
    struct reproduced *line;
    int count, room;
    bool failed; /* without memory */
};

/* "pixel", or "pixel, corrected" where the number is the corrected scheme's. Kept for the lines. */
static const char *label_of(const struct source *source, const char *definition)
{
    static char labels[32][80];
    char text[80];
    int k = 0;
    if (!source->by_scheme || source->scheme == SCHEME_PRINTED)
        return definition;
    snprintf(text, sizeof text, "%s, %s", definition, scheme_names[source->scheme]);
    while (k < 31 && *labels[k] && strcmp(labels[k], text) != 0)
        k++;
    strcpy(labels[k], text);
    return labels[k];
}

/* A line for the printed number in `row`, with the value just requested. */
static void line_add(struct lines *lines, int row, const struct paper_table *table, const char *definition,
                     double paper, double ours)
{
    struct csv *csv = &lines->measured->published;
    if (lines->count == lines->room) {
        int room = lines->room ? 2 * lines->room : 256;
        struct reproduced *line = realloc(lines->line, (size_t)room * sizeof *line);
        lines->failed |= !line;
        if (!line)
            return;
        lines->line = line;
        lines->room = room;
    }
    struct reproduced *line = &lines->line[lines->count++];
    *line = (struct reproduced){table->id,
                                csv_cell(csv, row, PUBLISHED_TARGET),
                                csv_cell(csv, row, PUBLISHED_METHOD),
                                csv_cell(csv, row, PUBLISHED_QUANTITY),
                                definition,
                                csv_cell(csv, row, PUBLISHED_UNIT),
                                paper,
                                ours,
                                table->assumption,
                                csv_cell(csv, row, PUBLISHED_NOTE),
                                ""};
    if (!isfinite(ours))
        snprintf(line->missing, sizeof line->missing, "%s", lines->measured->missing);
    *lines->measured->missing = '\0';
}

static bool source_is(const struct source *source, const struct paper_table *table, const char *method)
{
    return strcmp(source->table, table->id) == 0 && strcmp(source->method, method) == 0;
}

/* PSLR, ISLR and the like, of the target that corresponds to the printed one. */
static void lines_of_target(struct lines *lines, int row, const struct paper_table *table, double paper)
{
    static const struct {
        const char *quantity, *definition, *label;
        size_t offset;
        bool magnitude; /* the paper prints the magnitude */
    } kinds[] = {
        {"pslr_db", "null", "null", offsetof(struct target_row, pslr_db), false},
        {"pslr_db", "pixel", "pixel", offsetof(struct target_row, pslr_db), false},
        {"islr_db", "null", "null", offsetof(struct target_row, islr_db), false},
        {"islr_db", "3db", "3db", offsetof(struct target_row, islr_db), false},
        {"islr_db", "pixel", "pixel", offsetof(struct target_row, islr_db), false},
        {"width_m", "null", "-3 dB", offsetof(struct target_row, width_m), false},
        {"offset_m", "null", "peak", offsetof(struct target_row, position_error_m), true},
    };
    struct measured *measured = lines->measured;
    const char *target = csv_cell(&measured->published, row, PUBLISHED_TARGET);
    const char *method = csv_cell(&measured->published, row, PUBLISHED_METHOD);
    const char *quantity = csv_cell(&measured->published, row, PUBLISHED_QUANTITY);
    const struct source *source;
    for (int s = 0; (source = source_at(s)); s++) {
        if (!source_is(source, table, method))
            continue;
        int index = 0;
        const char *place = source_place(table->id, target, &index), *scene = source->scene ? source->scene : place;
        for (size_t k = 0; scene && k < sizeof kinds / sizeof *kinds; k++)
            if (strcmp(kinds[k].quantity, quantity) == 0) {
                double ours = measured_target(measured, scene, source->spec, index, kinds[k].definition,
                                              kinds[k].offset, quantity);
                line_add(lines, row, table, label_of(source, kinds[k].label), paper,
                         kinds[k].magnitude ? fabs(ours) : ours);
            }
    }
}

/* Times, the paper's and ours, as ratios to those of the table's base. */
static void lines_of_time(struct lines *lines, int row, const struct paper_table *table, double paper)
{
    struct measured *measured = lines->measured;
    const char *method = csv_cell(&measured->published, row, PUBLISHED_METHOD);
    double base = published_value(measured, table->id, "", table->base, "time_s");
    const struct source *source;
    for (int s = 0; (source = source_at(s)); s++)
        if (source_is(source, table, method)) {
            double ours = table_seconds(measured, source->scheme, table->id, method, source->definition)
                          / table_seconds(measured, source->scheme, table->id, table->base, source->definition);
            line_add(lines, row, table, label_of(source, source->definition), paper / base, ours);
            if (!lines->failed) {
                lines->line[lines->count - 1].quantity = "time_ratio";
                lines->line[lines->count - 1].unit = "1";
            }
        }
}

static void lines_of_image(struct lines *lines, int row, const struct paper_table *table, double paper)
{
    static const struct {
        const char *quantity;
        size_t offset;
    } kinds[] = {{"error", offsetof(struct measurement, error)},
                 {"phase_rms_rad", offsetof(struct measurement, phase_rms_rad)}};
    struct measured *measured = lines->measured;
    const char *method = csv_cell(&measured->published, row, PUBLISHED_METHOD);
    const char *quantity = csv_cell(&measured->published, row, PUBLISHED_QUANTITY);
    const struct source *source;
    for (int s = 0; (source = source_at(s)); s++)
        for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
            if (source_is(source, table, method) && strcmp(kinds[k].quantity, quantity) == 0)
                line_add(lines, row, table, "against the exact image", paper,
                         measured_value(measured, source->scene, source->spec, kinds[k].offset, quantity));
}

static void lines_of_flops(struct lines *lines, int row, const struct paper_table *table, double paper)
{
    struct measured *measured = lines->measured;
    const char *method = csv_cell(&measured->published, row, PUBLISHED_METHOD);
    const struct source *source;
    for (int s = 0; (source = source_at(s)); s++)
        if (source_is(source, table, method)) {
            line_add(lines, row, table, label_of(source, source->definition), paper,
                     measured_flops(measured, source->scene, source->spec, true));
            line_add(lines, row, table, label_of(source, "counted"), paper,
                     measured_flops(measured, source->scene, source->spec, false));
        }
}

static void lines_of_phase(struct lines *lines, int row, const struct paper_table *table, double paper)
{
    static const struct {
        const char *method, *formula, *label;
    } formulas[] = {
        {"LBF", "lbf_fc", "Eq. (5), theta by fc"},
        {"LBF", "lbf7_fc", "Eq. (7), theta by fc"},
        {"LBF", "lbf_F", "Eq. (5), theta by F"},
        {"PCA", "pca", "Eq. (6)"},
    };
    struct measured *measured = lines->measured;
    const char *target = csv_cell(&measured->published, row, PUBLISHED_TARGET);
    const char *method = csv_cell(&measured->published, row, PUBLISHED_METHOD);
    for (const struct phase_figure *figure = phase_figures; figure->table; figure++)
        for (size_t k = 0; k < sizeof formulas / sizeof *formulas; k++)
            if (strcmp(figure->table, table->id) == 0 && strcmp(figure->target, target) == 0
                && strcmp(formulas[k].method, method) == 0) {
                const struct phase_part part = {figure->setup,   figure->last,   formulas[k].formula,
                                                figure->least_m, figure->most_m, 1};
                line_add(lines, row, table, formulas[k].label, paper, measured_phase(measured, &part));
            }
}

/* By the nominal resolution, and by that of Table 3's scene. */
static void lines_of_rate(struct lines *lines, int row, const struct paper_table *table, double paper)
{
    struct scene scene;
    if (assumed_scene_load("bp22/table3", &scene) != STATUS_OK) {
        snprintf(lines->measured->missing, sizeof lines->measured->missing, "%s", status_message());
        line_add(lines, row, table, "rho_a = D_tx/2", paper, NAN);
        return;
    }
    const struct acquisition *a = &scene.acquisition;
    double bin = a->sound_speed / (2 * a->fs), wavelength = a->sound_speed / a->fc, nominal = a->tx_length / 2;
    scene_free(&scene);
    line_add(lines, row, table, "rho_a = D_tx/2", paper, upsampling_rate(bin, nominal, wavelength));
    double width = MEASURED(lines->measured, "bp22/table3", SINC_8, width_m);
    line_add(lines, row, table, "rho_a = measured -3 dB width", paper,
             isfinite(width) ? upsampling_rate(bin, width, wavelength) : NAN);
}

bool table_has_phases(const char *id)
{
    bool has = false;
    for (const struct phase_figure *figure = phase_figures; figure->table; figure++)
        has |= strcmp(figure->table, id) == 0;
    return has;
}

/* Does the table take its numbers from plans? */
static bool table_is_planned(const char *id)
{
    const struct source *source;
    bool planned = false;
    for (int k = 0; (source = source_at(k)); k++)
        planned |= source->planned && strcmp(source->table, id) == 0;
    return planned;
}

bool table_is_full_size(const struct paper_table *table)
{
    return table->base || table_is_planned(table->id);
}

enum status tables_evaluate(struct measured *measured, const bool *asked, struct reproduced **line, int *count)
{
    static const struct {
        const char *quantity;
        void (*add)(struct lines *lines, int row, const struct paper_table *table, double paper);
    } kinds[] = {
        {"pslr_db", lines_of_target},       {"islr_db", lines_of_target}, {"width_m", lines_of_target},
        {"offset_m", lines_of_target},      {"time_s", lines_of_time},    {"error", lines_of_image},
        {"phase_rms_rad", lines_of_image},  {"flops", lines_of_flops},    {"phase_error_rad", lines_of_phase},
        {"upsampling_rate", lines_of_rate},
    };
    struct lines lines = {.measured = measured};
    *measured->missing = '\0';
    for (int row = 0; row < measured->published.row_count; row++) {
        double paper = NAN;
        const struct paper_table *table = paper_tables;
        while (table->id && strcmp(table->id, csv_cell(&measured->published, row, PUBLISHED_TABLE)) != 0)
            table++;
        if (table->id && asked && !asked[table - paper_tables] && table_is_planned(table->id))
            continue;
        csv_number(csv_cell(&measured->published, row, PUBLISHED_PAPER), &paper);
        for (size_t k = 0; table->id && k < sizeof kinds / sizeof *kinds; k++)
            if (strcmp(kinds[k].quantity, csv_cell(&measured->published, row, PUBLISHED_QUANTITY)) == 0)
                kinds[k].add(&lines, row, table, paper);
    }
    if (lines.failed) {
        free(lines.line);
        return status_set(STATUS_FAILED, "no memory for the papers' numbers");
    }
    *line = lines.line;
    *count = lines.count;
    return STATUS_OK;
}
