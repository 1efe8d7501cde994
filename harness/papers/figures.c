/* The papers' pictures from our own images (figures.h). */
#include "papers/figures.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "echoes/echo_data.h"
#include "files/folder.h"
#include "files/paths.h"
#include "files/text_file.h"
#include "metrics/metrics.h"
#include "results/provenance.h"
#include "measure/session.h"
#include "papers/sources.h"
#include "show/plot.h"
#include "measure/filtering.h"
#include "scene/simulate.h"

enum { SCENES_MAX = 6, METHODS_MAX = 5, PANELS_MAX = 6 };

/* Figures of the same images. A method's SPEC NULL is the exact image, in place of the papers' back projection. */
struct figures {
    const char *layout;                  /* ids; NULL: none. The layout of the targets */
    const char *images, *slices, *close; /* close: the slices near the peak */
    double close_m;                      /* shown to either side */
    const char *title;
    int first; /* the papers' number of the first target of a layout */
    struct {
        const char *scene;
        int targets;      /* number of its targets, from the first, that the papers have */
        const char *what; /* its panels' titles begin with this; may be NULL */
    } scenes[SCENES_MAX];
    struct {
        const char *label, *spec;
    } methods[METHODS_MAX];
};

#define PRINTED(options)   "rma_lbf:variant=printed,spacing=uniform,blend=off," options
#define CORRECTED(options) "rma_lbf:" options

static const struct figures sets[] = {
    {NULL,
     "bp22_f8",
     "bp22_f9",
     "bp22_f10",
     0.1,
     "BP22 Figs 8 to 10",
     0,
     {{"bp22/table3", 6, NULL}},
     {{"nearest", NEAREST}, {"linear, beta 2", LINEAR_2}, {"linear, beta 8", LINEAR_8}, {"sinc", SINC_8}}},
    {NULL,
     "zp15_f3",
     "zp15_f4",
     "zp15_f4_close",
     0.1,
     "ZP15 Figs 3 and 4",
     0,
     {{"zp15/target", 1, NULL}},
     {{"no interpolation", NEAREST}, {"truncated sinc", SINC_8}, {"zero padding", ZEROPAD_8}}},
    {NULL,
     NULL,
     "lbf21_f11",
     "lbf21_f12",
     0.05,
     "LBF21 Figs 11 and 12",
     0,
     {{"lbf21/blocks_30_0", 1, "sub-blocks of 30 m: "},
      {"lbf21/blocks_18_0", 1, "sub-blocks of 18 m: "},
      {"lbf21/blocks_12_0", 1, "sub-blocks of 12 m: "},
      {"lbf21/blocks_11_4", 1, "sub-blocks of 11.4 m: "},
      {"lbf21/blocks_9_6", 1, "sub-blocks of 9.6 m: "},
      {"lbf21/blocks_2_7", 1, "sub-blocks of 2.7 m: "}},
     {{"BP", NULL},
      {"LBF, as printed", "rma_lbf:variant=printed,blend=off,blocks=1,spacing=uniform"},
      {"PCA", PCA_16}}},
    {"lbf21_f13",
     "lbf21_f14",
     "lbf21_f15",
     NULL,
     0,
     "LBF21 Figs 13 to 15",
     1,
     {{"lbf21/table3_near", 2, NULL}, {"lbf21/table3_far", 4, NULL}},
     {{"BP", NULL},
      {"LBF, as printed", PRINTED("blocks=16")},
      {"LBF, corrected", CORRECTED("blocks=16")},
      {"PCA", PCA_16}}},
    {"lbf21_f16",
     "lbf21_f17",
     "lbf21_f18",
     NULL,
     0,
     "LBF21 Figs 16 to 18",
     7,
     {{"lbf21/table4_near", 2, NULL}, {"lbf21/table4_far", 2, NULL}},
     {{"BP", NULL},
      {"LBF, as printed", PRINTED("blocks=16")},
      {"LBF, corrected", CORRECTED("blocks=16")},
      {"PCA", PCA_16},
      {"Wu", WU_16}}},
    {.images = "pf05_f5",
     .title = "PF05 Figs 5D to 5F",
     .scenes = {{"pf05/picture", 0, NULL}, {"pf05/picture_inside", 0, NULL}},
     .methods = {{"4 sub-apertures", POLAR_4}, {"2 sub-apertures", POLAR_2}, {"no filter", IDEAL}}},
    {.images = "sq18_f3a",
     .title = "SQ18 Fig. 3(a)",
     .scenes = {{"sq18/picture", 0, NULL}},
     .methods = {{"improved omega-k", TURNED}}},
    {.images = "sq18_f3b",
     .title = "SQ18 Fig. 3(b)",
     .scenes = {{"sq18/squint_20", 0, NULL}, {"sq18/squint_00", 0, NULL}},
     .methods = {{"improved omega-k", TURNED}, {"BP", NULL}}},
};
enum { SETS = sizeof sets / sizeof *sets };

/* The slices of one set while its images are formed. */
struct drawing {
    const struct figures *set;
    const char *directory;
    bool images, slices, close; /* requested and missing */
    int panel_count, method_count;
    char titles[PANELS_MAX][120], footer[PROVENANCE_LINE];
    struct slice_line lines[PANELS_MAX][METHODS_MAX];
    int *undrawn;
};

static void picture_name(const struct drawing *drawing, const char *id, const char *scene, const char *label,
                         char *path, size_t size)
{
    char name[160] = "";
    if (scene)
        snprintf(name, sizeof name, "-%s-%s", strrchr(scene, '/') + 1, label);
    for (char *at = name; *at; at++)
        *at = *at == ' ' || *at == ',' ? '_' : *at;
    snprintf(path, size, "%s/figure-%s%s.png", drawing->directory, id, name);
}

/* Is there an id, is it requested, and is its picture, or its last image, missing? */
static bool wanted(const struct drawing *drawing, const char *id, bool asked, bool images)
{
    char path[4200];
    int s = 0, m = 0;
    while (s + 1 < SCENES_MAX && drawing->set->scenes[s + 1].scene)
        s++;
    while (m + 1 < METHODS_MAX && drawing->set->methods[m + 1].label)
        m++;
    if (!id || !asked)
        return false;
    picture_name(drawing, id, images ? drawing->set->scenes[s].scene : NULL, drawing->set->methods[m].label, path,
                 sizeof path);
    return !place_is_file(path);
}

/* One method's image of a scene: drawn, and its slices kept. `first`: the scene's first panel. */
static void image_use(struct drawing *drawing, const struct session *session, const struct image *image, int s, int m,
                      int first)
{
    const struct scene *scene = session->scene;
    const struct figures *set = drawing->set;
    char path[4200], title[200];
    if (drawing->images) {
        picture_name(drawing, set->images, set->scenes[s].scene, set->methods[m].label, path, sizeof path);
        snprintf(title, sizeof title, "%s: %s, %s", set->title, scene->name, set->methods[m].label);
        undrawn_note(plot_image(NULL, path, data_path(DATA_PLOTS),
                                &(struct image_picture){.image = image,
                                                        .title = title,
                                                        .footer = drawing->footer,
                                                        .targets = scene->targets,
                                                        .target_count = scene->point_count}),
                     drawing->undrawn);
    }
    for (int t = 0; t < set->scenes[s].targets && (drawing->slices || drawing->close); t++) {
        struct slice_line *line = &drawing->lines[first + t][m];
        line->label = set->methods[m].label;
        line->algorithm = set->methods[m].spec ? set->methods[m].spec : "reference";
        metrics_slice_samples(image, &scene->acquisition, &scene->targets[t], AXIS_AZIMUTH, &line->position_m,
                              &line->power_db, &line->count);
    }
}

static enum status scene_use(struct drawing *drawing, int s, int first)
{
    struct scene scene;
    struct session session;
    const struct figures *set = drawing->set;
    enum status status = scene_load(set->scenes[s].scene, data_path(DATA_SCENES), &scene);
    if (status != STATUS_OK)
        return status;
    status = session_open(&scene, &session);
    if (status != STATUS_OK) {
        scene_free(&scene);
        return status;
    }
    for (int t = 0; t < set->scenes[s].targets; t++) {
        char name[60] = "";
        if (set->scenes[s].what)
            snprintf(name, sizeof name, "%s", set->scenes[s].what);
        else if (set->first > 0)
            snprintf(name, sizeof name, "PT%d: ", set->first + first + t);
        snprintf(drawing->titles[first + t], sizeof drawing->titles[0], "%sx = %g m, r = %g m", name,
                 scene.targets[t].x, scene.targets[t].r);
    }
    for (int m = 0; m < drawing->method_count && status == STATUS_OK; m++) {
        struct spec spec;
        struct image image = {0};
        if (!set->methods[m].spec) {
            image_use(drawing, &session, &session.reference, s, m, first);
            continue;
        }
        status = spec_parse(set->methods[m].spec, &spec);
        if (status != STATUS_OK)
            break;
        status = session_image(&session, &spec, &image);
        if (status == STATUS_OK)
            image_use(drawing, &session, &image, s, m, first);
        undrawn_note(status, drawing->undrawn);
        status = STATUS_OK;
        image_free(&image);
        spec_free(&spec);
    }
    session_close(&session);
    scene_free(&scene);
    return status;
}

/* One panel a target; `most_m`: distance from the target that is shown. */
static void slices_draw(const struct drawing *drawing, const char *id, double most_m)
{
    struct slice_line shown[PANELS_MAX * METHODS_MAX];
    const char *titles[PANELS_MAX];
    char path[4200], title[200];
    int count = 0;
    for (int p = 0; p < drawing->panel_count; p++) {
        titles[p] = drawing->titles[p];
        for (int m = 0; m < drawing->method_count; m++) {
            const struct slice_line line = drawing->lines[p][m];
            int from = 0, to = line.count;
            while (from < to && line.position_m[from] < -most_m)
                from++;
            while (to > from && line.position_m[to - 1] > most_m)
                to--;
            shown[count] = line;
            shown[count].position_m += from;
            shown[count].power_db += from;
            shown[count++].count = to - from;
        }
    }
    picture_name(drawing, id, NULL, NULL, path, sizeof path);
    snprintf(title, sizeof title, "%s: azimuth slices%s", drawing->set->title, isfinite(most_m) ? ", close" : "");
    const struct slices_picture picture = {.title = title,
                                           .footer = drawing->footer,
                                           .panel_count = drawing->panel_count,
                                           .line_count = drawing->method_count,
                                           .panel_titles = titles,
                                           .lines = shown};
    undrawn_note(plot_slices(NULL, path, data_path(DATA_PLOTS), &picture), drawing->undrawn);
    plot_path_svg(path);
    undrawn_note(plot_slices(NULL, path, data_path(DATA_PLOTS), &picture), drawing->undrawn);
}

static enum status set_draw(struct drawing *drawing)
{
    const struct figures *set = drawing->set;
    enum status status = STATUS_OK;
    bool whole = true;
    while (drawing->method_count < METHODS_MAX && set->methods[drawing->method_count].label)
        drawing->method_count++;
    for (int s = 0; s < SCENES_MAX && set->scenes[s].scene && status == STATUS_OK; s++) {
        status = scene_use(drawing, s, drawing->panel_count);
        drawing->panel_count += set->scenes[s].targets;
    }
    for (int p = 0; p < drawing->panel_count; p++)
        for (int m = 0; m < drawing->method_count; m++)
            whole = whole && drawing->lines[p][m].count > 0;
    if (status == STATUS_OK && whole && drawing->slices)
        slices_draw(drawing, set->slices, INFINITY);
    if (status == STATUS_OK && whole && drawing->close)
        slices_draw(drawing, set->close, set->close_m);
    for (int p = 0; p < PANELS_MAX; p++)
        for (int m = 0; m < METHODS_MAX; m++) {
            free(drawing->lines[p][m].position_m);
            free(drawing->lines[p][m].power_db);
        }
    return status;
}

/* The targets of all of a set's scenes as figure-ID.csv, and drawn. */
static enum status layout_draw(struct drawing *drawing)
{
    const struct figures *set = drawing->set;
    char picture[4200], csv[4200];
    struct text_file file;
    int number = set->first;
    picture_name(drawing, set->layout, NULL, NULL, picture, sizeof picture);
    snprintf(csv, sizeof csv, "%.*scsv", (int)strlen(picture) - 3, picture);
    enum status status = text_file_open(csv, &file);
    if (status != STATUS_OK)
        return status;
    fputs("target,x_m,r_m,added\n", file.stream);
    for (int s = 0; s < SCENES_MAX && set->scenes[s].scene && status == STATUS_OK; s++) {
        struct scene scene;
        status = scene_load(set->scenes[s].scene, data_path(DATA_SCENES), &scene);
        for (int t = 0; t < scene.point_count && status == STATUS_OK; t++) {
            bool added = t >= set->scenes[s].targets;
            char name[16] = "";
            if (!added)
                snprintf(name, sizeof name, "PT%d", number++);
            fprintf(file.stream, "%s,%.9g,%.9g,%d\n", name, scene.targets[t].x, scene.targets[t].r, added);
        }
        if (status == STATUS_OK)
            scene_free(&scene);
    }
    status = text_file_close(&file, status);
    if (status == STATUS_OK)
        undrawn_note(plot_csv(picture, data_path(DATA_PLOTS), "layout.gp", csv, drawing->footer), drawing->undrawn);
    return status;
}

/* ---- PF05's echoes ---- */

enum step { RECORDED, COMPRESSED, FILTERED, STEPS };
static const struct {
    const char *name, *title;
} steps[STEPS] = {
    [RECORDED] = {"recorded", "PF05 Fig. 5A: echoes as recorded"},
    [COMPRESSED] = {"compressed", "PF05 Fig. 5B: range compressed"},
    [FILTERED] = {"filtered", "PF05 Fig. 5C: filtered by 4 sub-apertures"},
};

static bool is_drawn(const char *directory, enum step step, char path[4200])
{
    snprintf(path, 4200, "%s/figure-pf05_f5_echoes-%s.png", directory, steps[step].name);
    return place_is_file(path);
}

/* Records side by side, as an image over the transmitter's place and half the sound's path. */
static enum status records_draw(const struct acquisition *a, const double complex *records, const char *path,
                                const char *title, int *undrawn)
{
    const struct grid grid = {.x_first = a->tx[0].x,
                              .x_step = a->tx[1].x - a->tx[0].x,
                              .x_count = a->pings,
                              .r_first = a->t0[0] * a->sound_speed / 2,
                              .r_step = a->sound_speed / (2 * a->fs),
                              .r_count = a->samples};
    struct image image;
    char footer[PROVENANCE_LINE];
    enum status status = image_allocate(1, &grid, PRECISION_DOUBLE, &image);
    if (status != STATUS_OK)
        return status;
    double complex *pixels = image.pixels[0];
    for (int n = 0; n < a->samples; n++)
        for (int p = 0; p < a->pings; p++)
            pixels[(size_t)n * (size_t)a->pings + (size_t)p] = records[(size_t)p * (size_t)a->samples + (size_t)n];
    provenance_line(footer);
    undrawn_note(plot_image(NULL, path, data_path(DATA_PLOTS),
                            &(struct image_picture){.image = &image, .title = title, .footer = footer}),
                 undrawn);
    image_free(&image);
    return STATUS_OK;
}

static enum status steps_draw(const struct scene *scene, const struct filtering *filtering, const char *directory,
                              int *undrawn)
{
    struct echoes echoes;
    enum status status = scene_simulate(scene, &echoes);
    if (status != STATUS_OK)
        return status;
    double complex *records = (double complex *)echoes.samples;
    for (enum step step = RECORDED; step < STEPS && status == STATUS_OK; step++) {
        char path[4200];
        if (step == COMPRESSED)
            filtering_compress(filtering, records);
        if (step == FILTERED)
            filtering_apply(filtering, records);
        if (!is_drawn(directory, step, path))
            status = records_draw(&scene->acquisition, records, path, steps[step].title, undrawn);
    }
    echoes_free(&echoes);
    return status;
}

static enum status echo_figures_draw(const char *directory, int *undrawn)
{
    struct scene scene;
    struct spec spec = {0};
    struct filtering filtering;
    char path[4200];
    bool complete = true;
    for (enum step step = RECORDED; step < STEPS; step++)
        complete = is_drawn(directory, step, path) && complete;
    if (complete)
        return STATUS_OK;
    enum status status = scene_load("pf05/nine", data_path(DATA_SCENES), &scene);
    if (status != STATUS_OK)
        return status;
    status = spec_parse(POLAR_4, &spec);
    if (status == STATUS_OK)
        status = filtering_open(&scene.acquisition, &spec, &filtering);
    if (status == STATUS_OK) {
        status = steps_draw(&scene, &filtering, directory, undrawn);
        filtering_close(&filtering);
    }
    spec_free(&spec);
    scene_free(&scene);
    return status;
}

enum status figures_draw(const char *directory, bool (*asked)(const void *of, const char *id), const void *of,
                         int *undrawn)
{
    enum status status = STATUS_OK;
    for (int k = 0; k < SETS && status == STATUS_OK; k++) {
        struct drawing drawing = {.set = &sets[k], .directory = directory, .undrawn = undrawn};
        provenance_line(drawing.footer);
        if (wanted(&drawing, sets[k].layout, sets[k].layout && asked(of, sets[k].layout), false))
            status = layout_draw(&drawing);
        drawing.images = wanted(&drawing, sets[k].images, sets[k].images && asked(of, sets[k].images), true);
        drawing.slices = wanted(&drawing, sets[k].slices, sets[k].slices && asked(of, sets[k].slices), false);
        drawing.close = wanted(&drawing, sets[k].close, sets[k].close && asked(of, sets[k].close), false);
        if (status == STATUS_OK && (drawing.images || drawing.slices || drawing.close))
            status = set_draw(&drawing);
    }
    if (status == STATUS_OK && asked(of, "pf05_f5_echoes"))
        status = echo_figures_draw(directory, undrawn);
    return status;
}
