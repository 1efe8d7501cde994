/* How far each formula of the two-dimensional spectrum is from the exact one (LBF21 Figs 2 to 9). It shows before
   imaging whether LBF or PCA is accurate enough for a set-up. */
#include "papers/phase.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "range_migration/spectrum.h"
#include "files/csv.h"
#include "files/folder.h"
#include "report/published.h"
#include "results/provenance.h"
#include "show/plot.h"
#include "files/paths.h"
#include "files/text_file.h"

static const struct {
    const char *name, *title, *algorithm;
    spectrum_function *function;
} formulas[] = {
    {"exact", "exact", "rma_numeric", spectrum_exact},
    {"lbf_fc", "LBF (5), theta at fc", "rma_lbf", spectrum_lbf_printed},
    {"lbf_F", "LBF (5), theta at F", "rma_lbf", spectrum_lbf_corrected},
    {"lbf7_fc", "LBF (7), theta at fc", "rma_lbf", spectrum_lbf7},
    {"pca", "PCA (6)", "rma_pca", spectrum_pca},
};
enum { FORMULAS = sizeof formulas / sizeof *formulas };

const char *const phase_setups[] = {[PHASE_SHORT] = "lbf21/_phase_short", [PHASE_LONG] = "lbf21/_phase_long"};

static const double ranges_m[] = {50, 135, 220, 300};
enum { RANGES = 4, DOPPLERS = 201, FREQUENCIES = 3, RECEIVERS = 2 };

const struct phase_figure phase_figures[] = {
    {"lbf21_f2", "1st receiver, 50 to 300 m", PHASE_SHORT, false, 50, 300, "lbf7_fc", "LBF", false},
    {"lbf21_f3", "66th receiver, 135 to 300 m", PHASE_SHORT, true, 135, 300, "lbf7_fc", "LBF", false},
    {"lbf21_f4", "1st receiver, 50 to 300 m", PHASE_SHORT, false, 50, 300, NULL, NULL, false},
    {"lbf21_f5", "66th receiver, 135 to 300 m", PHASE_SHORT, true, 135, 300, "pca", "PCA", false},
    {"lbf21_f6", "1st receiver, 50 m", PHASE_LONG, false, 50, 50, NULL, NULL, false},
    {"lbf21_f6", "1st receiver, 50 to 300 m", PHASE_LONG, false, 50, 300, "lbf7_fc", "LBF", false},
    {"lbf21_f7", "1st receiver, 50 to 300 m", PHASE_LONG, false, 50, 300, "pca", "PCA", false},
    {"lbf21_f8", "last receiver, 50 to 300 m", PHASE_LONG, true, 50, 300, "lbf7_fc", "LBF", true},
    {"lbf21_f9", "last receiver, 50 to 300 m", PHASE_LONG, true, 50, 300, NULL, NULL, false},
    {.table = NULL},
};

/* One scene's errors. Along each curve the azimuth wavenumber goes evenly from -nu_max to nu_max. */
struct study {
    const char *scene;
    struct spectrum_setting setting;
    double offset[RECEIVERS];                    /* m: of the first and the last receiver */
    int receiver[RECEIVERS];                     /* their numbers, from 1 */
    double frequency[FREQUENCIES];               /* Hz: f_tau of -B/2, 0, B/2 */
    double nu_max;                               /* cycles/m: the transmitter's 1/D_tx, or the end of the spectrum */
    double largest[RECEIVERS][FORMULAS][RANGES]; /* rad */
};

static double nu_at(const struct study *study, int n)
{
    return study->nu_max * (2.0 * n / (DOPPLERS - 1) - 1);
}

static double error_at(const struct study *study, int receiver, int formula, int range, int n, int k)
{
    double d = study->offset[receiver], r = ranges_m[range], nu = nu_at(study, n);
    double frequency = study->setting.fc + study->frequency[k];
    return formulas[formula].function(&study->setting, d, r, frequency, nu)
           - spectrum_exact(&study->setting, d, r, frequency, nu);
}

static enum status study_begin(const struct scene *scene, struct study *study)
{
    const struct acquisition *a = &scene->acquisition;
    struct straight_track track;
    *study = (struct study){.scene = scene->name, .receiver = {1, a->receivers}};
    if (!acquisition_is_straight(a, &track))
        return status_set(STATUS_UNSUPPORTED, "%s: the spectra are valid for uniform straight tracks only",
                          scene->name);
    if (!(a->tx_length > 0))
        return status_set(STATUS_INVALID, "%s: tx_length is %g m; > 0 is needed: it bounds the Doppler frequencies",
                          scene->name, a->tx_length);
    if (!(a->fc > a->bandwidth / 2))
        return status_set(STATUS_INVALID, "%s: bandwidth is %g Hz; below 2 fc = %g Hz is accepted", scene->name,
                          a->bandwidth, 2 * a->fc);
    study->setting = (struct spectrum_setting){.sound_speed = a->sound_speed, .speed = track.speed, .fc = a->fc};
    for (int k = 0; k < RECEIVERS; k++)
        study->offset[k] = a->rx[study->receiver[k] - 1].x - a->tx[0].x;
    for (int k = 0; k < FREQUENCIES; k++)
        study->frequency[k] = (k - 1) * a->bandwidth / 2;
    double evanescent = 2 * (a->fc - a->bandwidth / 2) / a->sound_speed / (1 + fabs(track.speed) / a->sound_speed);
    study->nu_max = fmin(1 / a->tx_length, 0.99 * evanescent);
    return STATUS_OK;
}

/* All curves as CSV; finds the largest errors as well. */
static enum status study_write(struct study *study, const char *path)
{
    struct text_file text;
    enum status status = text_file_open(path, &text);
    if (status != STATUS_OK)
        return status;
    FILE *file = text.stream;
    fprintf(file, "# scene: %s\nreceiver,d_m,r_m,f_tau_hz,nu_per_m,f_hz,exact_rad", study->scene);
    for (int j = 1; j < FORMULAS; j++)
        fprintf(file, ",%s_error_rad", formulas[j].name);
    fprintf(file, "\n");
    for (int i = 0; i < RECEIVERS; i++)
        for (int r = 0; r < RANGES; r++)
            for (int k = 0; k < FREQUENCIES; k++)
                for (int n = 0; n < DOPPLERS; n++) {
                    double nu = nu_at(study, n), frequency = study->setting.fc + study->frequency[k];
                    fprintf(file, "%d,%.9g,%g,%.9g,%.9g,%.9g,%.17g", study->receiver[i], study->offset[i], ranges_m[r],
                            study->frequency[k], nu, nu * study->setting.speed,
                            spectrum_exact(&study->setting, study->offset[i], ranges_m[r], frequency, nu));
                    for (int j = 1; j < FORMULAS; j++) {
                        double error = error_at(study, i, j, r, n, k);
                        study->largest[i][j][r] = fmax(study->largest[i][j][r], fabs(error));
                        fprintf(file, ",%.6g", error);
                    }
                    fprintf(file, "\n");
                }
    return text_file_close(&text, STATUS_OK);
}

/* The value that LBF21 prints for a line of the study, and whether it is only a bound; 0 where it prints none. */
static double printed_find(const struct csv *published, const struct study *study, int receiver, int formula,
                           bool *bound)
{
    double value;
    *bound = false;
    for (const struct phase_figure *f = phase_figures; f->table; f++)
        if (f->formula && strcmp(phase_setups[f->setup], study->scene) == 0 && f->last == receiver
            && strcmp(f->formula, formulas[formula].name) == 0
            && published_values(published, f->table, f->target, f->method, "phase_error_rad", &value, 1) == 1) {
            *bound = f->bound;
            return value;
        }
    return 0;
}

/* The papers' set-ups by their figures. */
static const char *study_title(const struct study *study)
{
    static const char *const titles[PHASE_SETUPS] = {
        [PHASE_SHORT] = "LBF21 Figs 2 to 5, 66 receivers", [PHASE_LONG] = "LBF21 Figs 6 to 9, 132 receivers"};
    for (int k = 0; k < PHASE_SETUPS; k++)
        if (strcmp(study->scene, phase_setups[k]) == 0)
            return titles[k];
    return study->scene;
}

static void study_print(const struct study *study, const struct csv *published)
{
    printf("%s: largest phase error in rad,\n|f/v| <= %.4g/m (|f| <= %.4g Hz), f_tau = -B/2, 0, B/2\n",
           study_title(study), study->nu_max, study->nu_max * fabs(study->setting.speed));
    printf("%8s %7s  %-22s", "receiver", "d (m)", "formula");
    for (int r = 0; r < RANGES; r++)
        printf("%7g m", ranges_m[r]);
    printf("  LBF21 prints\n");
    for (int i = 0; i < RECEIVERS; i++)
        for (int j = 1; j < FORMULAS; j++) {
            printf("%8d %7.3f  %-22s", study->receiver[i], study->offset[i], formulas[j].title);
            for (int r = 0; r < RANGES; r++)
                printf("%9.3g", study->largest[i][j][r]);
            bool bound;
            const double printed = printed_find(published, study, i, j, &bound);
            if (printed > 0)
                printf("  %s%.4g", bound ? "< " : "", printed);
            printf("\n");
        }
    printf("Largest of all (rad):\n");
    for (int j = 1; j < FORMULAS; j++) {
        double largest = 0;
        for (int i = 0; i < RECEIVERS; i++)
            for (int r = 0; r < RANGES; r++)
                largest = fmax(largest, study->largest[i][j][r]);
        printf("  %-22s %.3g\n", formulas[j].title, largest);
    }
    printf("\n");
}

/* One picture a receiver, PNG or SVG: a panel a range, a line a formula, the largest of the errors at the three
   f_tau. */
static enum status study_draw(const struct study *study, const struct csv *published, int receiver, const char *path)
{
    char title[400], texts[RANGES][32], footer[PROVENANCE_LINE];
    const char *panels[RANGES];
    struct slice_line lines[RANGES][FORMULAS - 1];
    double position[DOPPLERS], values[RANGES][FORMULAS - 1][DOPPLERS];
    bool bound;
    for (int r = 0; r < RANGES; r++) {
        snprintf(texts[r], sizeof texts[r], "r = %g m", ranges_m[r]);
        panels[r] = texts[r];
        for (int j = 1; j < FORMULAS; j++) {
            for (int n = 0; n < DOPPLERS; n++) {
                double largest = 0;
                for (int k = 0; k < FREQUENCIES; k++) {
                    double error = error_at(study, receiver, j, r, n, k);
                    largest = fabs(error) > fabs(largest) ? error : largest;
                }
                position[n] = nu_at(study, n);
                values[r][j - 1][n] = largest;
            }
            lines[r][j - 1] = (struct slice_line){.label = formulas[j].title,
                                                  .position_m = position,
                                                  .power_db = values[r][j - 1],
                                                  .count = DOPPLERS,
                                                  .algorithm = formulas[j].algorithm,
                                                  .printed = printed_find(published, study, receiver, j, &bound)};
        }
    }
    snprintf(title, sizeof title, "%.300s: phase error of receiver %d (d = %g m)", study_title(study),
             study->receiver[receiver], study->offset[receiver]);
    provenance_line(footer);
    return plot_slices(NULL, path, data_path(DATA_PLOTS),
                       &(struct slices_picture){.title = title,
                                                .footer = footer,
                                                .panel_count = RANGES,
                                                .line_count = FORMULAS - 1,
                                                .panel_titles = panels,
                                                .lines = lines[0],
                                                .phase = true});
}

void phase_path(const char *directory, const char *scene, const char *rest, char *path, size_t size)
{
    char name[256];
    snprintf(name, sizeof name, "%s", scene);
    for (char *p = name; *p; p++)
        if (*p == '/')
            *p = '_';
    snprintf(path, size, "%s/phase-%s%s", directory, name, rest);
}

enum status phase_curves_write(const struct scene *scene, const char *directory)
{
    struct study study;
    char path[4200];
    phase_path(directory, scene->name, ".csv", path, sizeof path);
    enum status status = study_begin(scene, &study);
    return status == STATUS_OK ? study_write(&study, path) : status;
}

enum status phase_scene_study(const char *name, const char *directory, bool taken)
{
    struct scene scene;
    struct study study;
    struct csv published;
    char path[4200], rest[40];
    int lock = -1;
    enum status status = scene_load(name, data_path(DATA_SCENES), &scene);
    if (status != STATUS_OK)
        return status;
    status = published_read(&published);
    if (status == STATUS_OK)
        status = study_begin(&scene, &study);
    if (status == STATUS_OK)
        status = directory_make(directory);
    if (status == STATUS_OK && !taken)
        status = folder_take(directory, &lock);
    if (status == STATUS_OK) {
        phase_path(directory, scene.name, ".csv", path, sizeof path);
        status = study_write(&study, path);
    }
    if (status == STATUS_OK)
        study_print(&study, &published);
    for (int i = 0; status == STATUS_OK && i < RECEIVERS && study.receiver[i] > (i ? 1 : 0); i++) {
        snprintf(rest, sizeof rest, "-receiver%d.png", study.receiver[i]);
        phase_path(directory, scene.name, rest, path, sizeof path);
        status = study_draw(&study, &published, i, path);
        plot_path_svg(path);
        if (status == STATUS_OK)
            status = study_draw(&study, &published, i, path);
    }
    folder_leave(lock);
    csv_free(&published);
    scene_free(&scene);
    return status;
}

/* ---- at given points ---- */

enum { COLUMNS = 7 };
static const char *const columns[] = {"d", "r", "F", "f", "fc", "v", "c", NULL};

static double point_phase(const double *values, int formula)
{
    const struct spectrum_setting setting = {.sound_speed = values[6], .speed = values[5], .fc = values[4]};
    return formulas[formula].function(&setting, values[0], values[1], values[2], values[3] / values[5]);
}

/* The row's numbers in the order of `columns`. */
static enum status point_read(const struct csv *csv, int row, const int *index, double *values)
{
    for (int k = 0; k < COLUMNS; k++) {
        const char *cell = csv_cell(csv, row, index[k]);
        if (!csv_number(cell, &values[k]) || !isfinite(values[k]))
            return status_set(STATUS_INVALID, "%s: line %d: column %s is '%.60s'; a finite number is needed", csv->path,
                              csv->lines[row], columns[k], cell);
    }
    const double c = values[6], speed = fabs(values[5]), beta = values[5] / c, sine = c * values[3] / (2 * values[5]);
    const double least = fmin(values[2], values[4]);
    const struct {
        int column;
        bool good;
        const char *accepted;
    } checks[] = {
        {6, c > 0, "a sound speed > 0 m/s"},
        {5, speed > 0 && speed < c, "a speed of magnitude between 0 and c, both excluded,"},
        {1, values[1] > 0, "a range > 0 m"},
        {2, values[2] > 0, "a frequency > 0 Hz"},
        {4, values[4] > 0, "a frequency > 0 Hz"},
        {3, fabs(sine) < least && sine * (1 + beta) < values[2] && -sine * (1 - beta) < values[2],
         "no evanescent wave, c f/(2 v) between -F/(1 - v/c) and F/(1 + v/c) and below min(F, fc) in magnitude,"},
    };
    for (size_t k = 0; k < sizeof checks / sizeof *checks; k++)
        if (!checks[k].good)
            return status_set(STATUS_INVALID, "%s: line %d: column %s is %.17g; %s is needed", csv->path,
                              csv->lines[row], columns[checks[k].column], values[checks[k].column], checks[k].accepted);
    for (int j = 0; j < FORMULAS; j++)
        if (!isfinite(point_phase(values, j)))
            return status_set(STATUS_INVALID,
                              "%s: line %d: the phase '%s' at d = %g m and r = %g m is no finite number; a "
                              "greater range is needed",
                              csv->path, csv->lines[row], formulas[j].name, values[0], values[1]);
    return STATUS_OK;
}

static void point_print(const double *values)
{
    for (int k = 0; k < COLUMNS; k++)
        printf("%.17g,", values[k]);
    for (int j = 0; j < FORMULAS; j++)
        printf("%.17g%c", point_phase(values, j), j < FORMULAS - 1 ? ',' : '\n');
}

enum status phase_points_print(const char *path)
{
    struct csv csv;
    int index[COLUMNS];
    enum status status = csv_read(path, CSV_TAIL_KEEP, &csv);
    if (status != STATUS_OK)
        return status;
    status = csv_columns(&csv, columns, index);
    double *values = calloc((size_t)csv.row_count + 1, COLUMNS * sizeof *values);
    if (status == STATUS_OK && !values)
        status = status_set(STATUS_FAILED, "%s: no memory for %d rows", path, csv.row_count);
    for (int row = 0; status == STATUS_OK && row < csv.row_count; row++)
        status = point_read(&csv, row, index, values + row * COLUMNS);
    if (status == STATUS_OK) {
        for (int k = 0; k < COLUMNS; k++)
            printf("%s,", columns[k]);
        for (int j = 0; j < FORMULAS; j++)
            printf("%s%c", formulas[j].name, j < FORMULAS - 1 ? ',' : '\n');
        for (int row = 0; row < csv.row_count; row++)
            point_print(values + row * COLUMNS);
    }
    free(values);
    csv_free(&csv);
    return status;
}

const char *phase_formula(int k)
{
    return k + 1 < FORMULAS ? formulas[k + 1].name : NULL; /* the first is the exact one */
}

enum status phase_study(const char *directory, bool taken)
{
    enum status status = STATUS_OK;
    for (int k = 0; status == STATUS_OK && k < PHASE_SETUPS; k++)
        status = phase_scene_study(phase_setups[k], directory, taken);
    return status;
}
