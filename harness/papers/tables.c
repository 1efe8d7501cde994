/* The papers' tables and figures (tables.h): for each printed number, which measurement stands for it, by every
   definition that could be meant. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "data/paths.h"
#include "papers/tables.h"
#include "scene/scene.h"

/* Which scene's target stands for a printed one. */
static const struct place {
    const char *table, *target, *scene;
    int index;
} places[] = {
    {"bp22_t3", "T1", "bp22/table3", 0},         {"bp22_t3", "T2", "bp22/table3", 1},
    {"bp22_t3", "T3", "bp22/table3", 2},         {"bp22_t3", "T4", "bp22/table3", 3},
    {"bp22_t3", "T5", "bp22/table3", 4},         {"bp22_t3", "T6", "bp22/table3", 5},
    {"lbf21_t3", "PT1", "lbf21/table3_near", 0}, {"lbf21_t3", "PT2", "lbf21/table3_near", 1},
    {"lbf21_t3", "PT3", "lbf21/table3_far", 0},  {"lbf21_t3", "PT4", "lbf21/table3_far", 1},
    {"lbf21_t3", "PT5", "lbf21/table3_far", 2},  {"lbf21_t3", "PT6", "lbf21/table3_far", 3},
    {"lbf21_t4", "PT7", "lbf21/table4_near", 0}, {"lbf21_t4", "PT8", "lbf21/table4_near", 1},
    {"lbf21_t4", "PT9", "lbf21/table4_far", 0},  {"lbf21_t4", "PT10", "lbf21/table4_far", 1},
};

/* Plain engines are timed on a part of the task, and each stage scaled to all of it: back projection on some rows, of
   which the sums depend and the compression does not; range migration with a sixth of the receivers, on which the
   conversion depends twice (receivers and wavenumbers) and all else once. */
struct scaling {
    double factor; /* of the stages in `stages` (separated by blanks) */
    const char *stages;
    double rest; /* of the others */
};
static const struct scaling bp22_rows = {50, "focus", 1}, lbf21_rows = {4096.0 / 103, "focus", 1};
static const struct scaling lbf21_part = {36, "bulk differential reconstruct", 6};

/* The measurement that stands for a method. */
static const struct source {
    const char *table, *method;
    const char *definition; /* of a time or a formula; NULL: by the definitions of the quantity */
    const char *scene;      /* NULL: the target's, from `places` */
    const char *spec;
    const struct scaling *scaling; /* of a time; NULL: the whole was timed */
} sources[] = {
    {"bp22_t1", "nearest", "Eq. (11) by the plan", "bp22/full", NEAREST, NULL},
    {"bp22_t1", "linear, beta 2", "Eq. (11) by the plan", "bp22/full", LINEAR_2, NULL},
    {"bp22_t1", "linear, beta 8", "Eq. (11) by the plan", "bp22/full", LINEAR_8, NULL},
    {"bp22_t1", "sinc", "Eq. (11) by the plan", "bp22/full", SINC_8, NULL},
    {"bp22_t3", "nearest", NULL, NULL, NEAREST, NULL},
    {"bp22_t3", "linear, beta 2", NULL, NULL, LINEAR_2, NULL},
    {"bp22_t3", "linear, beta 8", NULL, NULL, LINEAR_8, NULL},
    {"bp22_t3", "sinc", NULL, NULL, SINC_8, NULL},
    {"bp22_t4", "nearest", PLAIN_TIMES, "bp22/full_rows", NEAREST ":" PLAIN_BP, &bp22_rows},
    {"bp22_t4", "linear, beta 2", PLAIN_TIMES, "bp22/full_rows", LINEAR_2 "," PLAIN_BP, &bp22_rows},
    {"bp22_t4", "linear, beta 8", PLAIN_TIMES, "bp22/full_rows", LINEAR_8 "," PLAIN_BP, &bp22_rows},
    {"bp22_t4", "sinc", PLAIN_TIMES, "bp22/full_rows", SINC_8 "," PLAIN_BP, &bp22_rows},
    {"bp22_t4", "nearest", FAST_TIMES, "bp22/full", NEAREST, NULL},
    {"bp22_t4", "linear, beta 2", FAST_TIMES, "bp22/full", LINEAR_2, NULL},
    {"bp22_t4", "linear, beta 8", FAST_TIMES, "bp22/full", LINEAR_8, NULL},
    {"bp22_t4", "sinc", FAST_TIMES, "bp22/full", SINC_8, NULL},
    {"bp22_t4", "nearest", FAST_LIMITED, "bp22/full_limited", NEAREST, NULL},
    {"bp22_t4", "linear, beta 2", FAST_LIMITED, "bp22/full_limited", LINEAR_2, NULL},
    {"bp22_t4", "linear, beta 8", FAST_LIMITED, "bp22/full_limited", LINEAR_8, NULL},
    {"bp22_t4", "sinc", FAST_LIMITED, "bp22/full_limited", SINC_8, NULL},
    {"bp22_eq20", "linear", NULL, "bp22/table3", SINC_8, NULL},
    {"zp15_f3", "nearest", NULL, "zp15/target", NEAREST, NULL},
    {"zp15_f3", "truncated sinc", NULL, "zp15/target", SINC_8, NULL},
    {"zp15_f3", "zero padding", NULL, "zp15/target", ZEROPAD_8, NULL},
    {"zp15_f4", "nearest", NULL, "zp15/target", NEAREST, NULL},
    {"zp15_f4", "truncated sinc", NULL, "zp15/target", SINC_8, NULL},
    {"zp15_f4", "zero padding", NULL, "zp15/target", ZEROPAD_8, NULL},
    {"lbf21_t2", "LBF, 30.0 m", NULL, "lbf21/blocks_30_0", LBF_BLOCK, NULL},
    {"lbf21_t2", "LBF, 18.0 m", NULL, "lbf21/blocks_18_0", LBF_BLOCK, NULL},
    {"lbf21_t2", "LBF, 12.0 m", NULL, "lbf21/blocks_12_0", LBF_BLOCK, NULL},
    {"lbf21_t2", "LBF, 11.4 m", NULL, "lbf21/blocks_11_4", LBF_BLOCK, NULL},
    {"lbf21_t2", "LBF, 9.6 m", NULL, "lbf21/blocks_9_6", LBF_BLOCK, NULL},
    {"lbf21_t2", "LBF, 2.7 m", NULL, "lbf21/blocks_2_7", LBF_BLOCK, NULL},
    {"lbf21_t2", "PCA", NULL, "lbf21/blocks", PCA_1, NULL},
    {"lbf21_t2", "BP", NULL, "lbf21/blocks", ZEROPAD_8, NULL},
    {"lbf21_t3", "LBF", NULL, NULL, LBF_16, NULL},
    {"lbf21_t3", "PCA", NULL, NULL, PCA_16, NULL},
    {"lbf21_t3", "BP", NULL, NULL, ZEROPAD_8, NULL},
    {"lbf21_t4", "LBF", NULL, NULL, LBF_16, NULL},
    {"lbf21_t4", "PCA", NULL, NULL, PCA_16, NULL},
    {"lbf21_t4", "Wu", NULL, NULL, WU_16, NULL},
    {"lbf21_t4", "BP", NULL, NULL, ZEROPAD_8, NULL},
    {"lbf21_t5", "LBF, 8 blocks", PLAIN_TIMES, "lbf21/real_size_part", LBF_8 "," PLAIN_RMA, &lbf21_part},
    {"lbf21_t5", "LBF, 16 blocks", PLAIN_TIMES, "lbf21/real_size_part", LBF_16 "," PLAIN_RMA, &lbf21_part},
    {"lbf21_t5", "PCA", PLAIN_TIMES, "lbf21/real_size_part", PCA_16 "," PLAIN_RMA, &lbf21_part},
    {"lbf21_t5", "Wu", PLAIN_TIMES, "lbf21/real_size_part", WU_16 "," PLAIN_RMA, &lbf21_part},
    {"lbf21_t5", "BP", PLAIN_TIMES, "lbf21/real_size_rows", ZEROPAD_8 "," PLAIN_BP, &lbf21_rows},
    {"lbf21_t5", "LBF, 8 blocks", PLAIN_SINC, "lbf21/real_size_part", LBF_8 "," PLAIN_RMA, &lbf21_part},
    {"lbf21_t5", "LBF, 16 blocks", PLAIN_SINC, "lbf21/real_size_part", LBF_16 "," PLAIN_RMA, &lbf21_part},
    {"lbf21_t5", "PCA", PLAIN_SINC, "lbf21/real_size_part", PCA_16 "," PLAIN_RMA, &lbf21_part},
    {"lbf21_t5", "Wu", PLAIN_SINC, "lbf21/real_size_part", WU_16 "," PLAIN_RMA, &lbf21_part},
    {"lbf21_t5", "BP", PLAIN_SINC, "lbf21/real_size_rows", SINC_8 "," PLAIN_BP, &lbf21_rows},
    {"lbf21_t5", "LBF, 8 blocks", FAST_TIMES, "lbf21/real_size", LBF_8, NULL},
    {"lbf21_t5", "LBF, 16 blocks", FAST_TIMES, "lbf21/real_size", LBF_16, NULL},
    {"lbf21_t5", "PCA", FAST_TIMES, "lbf21/real_size", PCA_16, NULL},
    {"lbf21_t5", "Wu", FAST_TIMES, "lbf21/real_size", WU_16, NULL},
    {"lbf21_t5", "BP", FAST_TIMES, "lbf21/real_size", ZEROPAD_8, NULL},
    {"lbf21_t5", "LBF, 8 blocks", FAST_SINC, "lbf21/real_size", LBF_8, NULL},
    {"lbf21_t5", "LBF, 16 blocks", FAST_SINC, "lbf21/real_size", LBF_16, NULL},
    {"lbf21_t5", "PCA", FAST_SINC, "lbf21/real_size", PCA_16, NULL},
    {"lbf21_t5", "Wu", FAST_SINC, "lbf21/real_size", WU_16, NULL},
    {"lbf21_t5", "BP", FAST_SINC, "lbf21/real_size", SINC_8, NULL},
    {"lbf21_flops", "LBF", "Eq. (20) by the plan", "lbf21/real_size", LBF_16, NULL},
    {"lbf21_flops", "PCA", "Eq. (21) by the plan", "lbf21/real_size", PCA_16, NULL},
    {"lbf21_flops", "Wu", "Eq. (22) by the plan", "lbf21/real_size", WU_16, NULL},
    {"lbf21_flops", "BP", "BP22 Eq. (11) by the plan", "lbf21/real_size", ZEROPAD_8, NULL},
};
enum { PLACES = sizeof places / sizeof *places, SOURCES = sizeof sources / sizeof *sources };

/* Which part of the phase study a figure's printed maximum is of. */
static const struct figure {
    const char *table, *target;
    struct phase_part part; /* the formula is the method's */
} figures[] = {
    {"lbf21_f2", "1st receiver, 50 to 300 m", {PHASE_SHORT, false, NULL, 50, 300, 1}},
    {"lbf21_f3", "66th receiver, 135 to 300 m", {PHASE_SHORT, true, NULL, 135, 300, 1}},
    {"lbf21_f4", "1st receiver, 50 to 300 m", {PHASE_SHORT, false, NULL, 50, 300, 1}},
    {"lbf21_f5", "66th receiver, 135 to 300 m", {PHASE_SHORT, true, NULL, 135, 300, 1}},
    {"lbf21_f6", "1st receiver, 50 m", {PHASE_LONG, false, NULL, 50, 50, 1}},
    {"lbf21_f6", "1st receiver, 50 to 300 m", {PHASE_LONG, false, NULL, 50, 300, 1}},
    {"lbf21_f7", "1st receiver, 50 to 300 m", {PHASE_LONG, false, NULL, 50, 300, 1}},
    {"lbf21_f8", "last receiver, 50 to 300 m", {PHASE_LONG, true, NULL, 50, 300, 1}},
    {"lbf21_f9", "last receiver, 50 to 300 m", {PHASE_LONG, true, NULL, 50, 300, 1}},
};

/* ---- needs ---- */

int need_add(struct need *needs, int count, int room, struct need need)
{
    for (int k = 0; k < count; k++)
        if (strcmp(needs[k].scene, need.scene) == 0 && strcmp(needs[k].spec, need.spec) == 0)
            return count;
    if (count == room)
        return count;
    needs[count] = need;
    return count + 1;
}

int table_needs(const char *id, struct need *needs, int count, int room)
{
    for (int k = 0; k < SOURCES; k++) {
        const struct source *source = &sources[k];
        if (strcmp(id, "claims") != 0 && strcmp(id, source->table) != 0)
            continue;
        if (source->scene)
            count = need_add(needs, count, room, (struct need){source->scene, source->spec});
        for (int p = 0; p < PLACES && !source->scene; p++)
            if (strcmp(places[p].table, source->table) == 0)
                count = need_add(needs, count, room, (struct need){places[p].scene, source->spec});
    }
    return count;
}

/* ---- values ---- */

static double source_seconds(struct measured *measured, const struct source *source)
{
    const struct scaling *scaling = source->scaling;
    double seconds = MEASURED(measured, source->scene, source->spec, run_s);
    if (!scaling)
        return seconds;
    double scaled = 0;
    char stages[64], *rest = stages;
    snprintf(stages, sizeof stages, "%s", scaling->stages);
    for (char *stage; (stage = strsep(&rest, " "));)
        scaled += measured_stage(measured, source->scene, source->spec, stage);
    return scaling->factor * scaled + scaling->rest * (seconds - scaled);
}

/* The measurement that stands for such a time; NULL if there is none. */
static const struct source *time_source(const char *id, const char *method, const char *definition)
{
    for (int k = 0; k < SOURCES; k++)
        if (strcmp(sources[k].table, id) == 0 && strcmp(sources[k].method, method) == 0 && sources[k].definition
            && strcmp(sources[k].definition, definition) == 0)
            return &sources[k];
    return NULL;
}

double table_seconds(struct measured *measured, const char *id, const char *method, const char *definition)
{
    const struct source *source = time_source(id, method, definition);
    return source ? source_seconds(measured, source)
                  : measured_missing(measured, "%s has no times of %s by %s", id, method, definition);
}

/* The table whose times are divided by those of `base` is one of times. */
static bool table_has_times(const char *id)
{
    for (const struct paper_table *table = paper_tables; table->id; table++)
        if (strcmp(table->id, id) == 0)
            return table->base;
    return false;
}

int table_seconds_check(const char *id, const char *method, const char *definition, char *accepted, size_t size)
{
    const char *const wanted[] = {id, method, definition};
    bool fits[SOURCES];
    for (int k = 0; k < SOURCES; k++)
        fits[k] = table_has_times(sources[k].table);
    for (int text = 0; text < 3; text++) {
        bool known = false;
        *accepted = '\0';
        for (int k = 0; k < SOURCES; k++) {
            const char *const texts[] = {sources[k].table, sources[k].method, sources[k].definition};
            char quoted[100];
            snprintf(quoted, sizeof quoted, "'%s'", fits[k] ? texts[text] : "");
            size_t used = strlen(accepted);
            if (fits[k] && !strstr(accepted, quoted))
                snprintf(accepted + used, size - used, "%s%s", used ? ", " : "", quoted);
            fits[k] = fits[k] && strcmp(texts[text], wanted[text]) == 0;
            known |= fits[k];
        }
        if (!known)
            return text;
    }
    return -1;
}

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
    bool failed; /* no memory */
};

/* A line for the printed number in `row`, with the value that was just asked for. */
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

/* PSLR, ISLR and the like: of the target that stands for the printed one. */
static void lines_of_target(struct lines *lines, int row, const struct paper_table *table, double paper)
{
    static const struct {
        const char *quantity, *definition, *label;
        size_t offset;
        bool magnitude; /* is what the paper prints */
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
    for (int s = 0; s < SOURCES; s++) {
        if (strcmp(sources[s].table, table->id) != 0 || strcmp(sources[s].method, method) != 0)
            continue;
        struct place place = {table->id, target, sources[s].scene, 0};
        for (int p = 0; p < PLACES && !sources[s].scene; p++)
            if (strcmp(places[p].table, table->id) == 0 && strcmp(places[p].target, target) == 0)
                place = places[p];
        for (size_t k = 0; place.scene && k < sizeof kinds / sizeof *kinds; k++)
            if (strcmp(kinds[k].quantity, quantity) == 0) {
                double ours = measured_target(measured, place.scene, sources[s].spec, place.index, kinds[k].definition,
                                              kinds[k].offset, quantity);
                line_add(lines, row, table, kinds[k].label, paper, kinds[k].magnitude ? fabs(ours) : ours);
            }
    }
}

/* Times, as ratios of both the paper's and ours to those of the table's base. */
static void lines_of_time(struct lines *lines, int row, const struct paper_table *table, double paper)
{
    struct measured *measured = lines->measured;
    const char *method = csv_cell(&measured->published, row, PUBLISHED_METHOD);
    double base = published_value(measured, table->id, "", table->base, "time_s");
    for (int s = 0; s < SOURCES; s++)
        if (strcmp(sources[s].table, table->id) == 0 && strcmp(sources[s].method, method) == 0) {
            double ours = source_seconds(measured, &sources[s])
                          / table_seconds(measured, table->id, table->base, sources[s].definition);
            line_add(lines, row, table, sources[s].definition, paper / base, ours);
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
    for (int s = 0; s < SOURCES; s++)
        for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
            if (strcmp(sources[s].table, table->id) == 0 && strcmp(sources[s].method, method) == 0
                && strcmp(kinds[k].quantity, quantity) == 0)
                line_add(lines, row, table, "against the exact image", paper,
                         measured_value(measured, sources[s].scene, sources[s].spec, kinds[k].offset, quantity));
}

static void lines_of_flops(struct lines *lines, int row, const struct paper_table *table, double paper)
{
    struct measured *measured = lines->measured;
    const char *method = csv_cell(&measured->published, row, PUBLISHED_METHOD);
    for (int s = 0; s < SOURCES; s++)
        if (strcmp(sources[s].table, table->id) == 0 && strcmp(sources[s].method, method) == 0) {
            const char *scene = sources[s].scene, *spec = sources[s].spec;
            line_add(lines, row, table, sources[s].definition, paper, MEASURED(measured, scene, spec, flops_published));
            line_add(lines, row, table, "counted", paper, MEASURED(measured, scene, spec, flops));
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
    for (size_t f = 0; f < sizeof figures / sizeof *figures; f++)
        for (size_t k = 0; k < sizeof formulas / sizeof *formulas; k++)
            if (strcmp(figures[f].table, table->id) == 0 && strcmp(figures[f].target, target) == 0
                && strcmp(formulas[k].method, method) == 0) {
                struct phase_part part = figures[f].part;
                part.formula = formulas[k].formula;
                line_add(lines, row, table, formulas[k].label, paper, measured_phase(measured, &part));
            }
}

/* By the nominal resolution, and by the one that the scene of Table 3 has. */
static void lines_of_rate(struct lines *lines, int row, const struct paper_table *table, double paper)
{
    struct scene scene;
    if (scene_load("bp22/table3", SCENE_DIRECTORY, &scene) != STATUS_OK) {
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

enum status tables_evaluate(struct measured *measured, struct reproduced **line, int *count)
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
