/* The command `score`: an image that another program formed, measured as those of `run` are. */
#include <complex.h>
#include <ctype.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "files/paths.h"
#include "command/task.h"
#include "echoes/matfile.h"
#include "echoes/npy.h"
#include "measure/outcome.h"
#include "metrics/metrics.h"
#include "results/results_folder.h"
#include "show/table.h"
#include "text/number.h"

enum { NAME_MOST = 60 };

/* Of --name, or of the file: its name without folder and extension. */
static enum status name_find(const struct task *task, char name[NAME_MOST + 1])
{
    const char *path = task->names[0], *slash = strrchr(path, '/'), *from = task->name ? task->name : path;
    if (!task->name && slash)
        from = slash + 1;
    size_t length = strlen(from);
    if (!task->name && strrchr(from, '.') && strrchr(from, '.') != from)
        length = (size_t)(strrchr(from, '.') - from);
    bool plain = length > 0 && length <= NAME_MOST;
    for (size_t k = 0; k < length && plain; k++)
        plain = isalnum((unsigned char)from[k]) || (k > 0 && strchr("_-.", from[k]));
    if (!plain)
        return status_set(STATUS_INVALID,
                          "score: --name is '%.*s', must be 1 to %d letters, digits, '_', '-' or '.', the first a "
                          "letter or digit",
                          (int)fmin((double)length, 200), from, NAME_MOST);
    snprintf(name, NAME_MOST + 1, "%.*s", (int)length, from);
    if (algorithm_find(name))
        return status_set(STATUS_INVALID, "score: --name is '%s', an algorithm of this program; another is needed",
                          name);
    return STATUS_OK;
}

static enum status seconds_find(const char *text, double *seconds)
{
    *seconds = NAN;
    const char *end = text ? number_read(text, seconds) : "";
    if (!end || *end || (text && !(*seconds > 0)))
        return status_set(STATUS_INVALID, "score: --seconds is '%s', must be a number above 0 (s)", text);
    return STATUS_OK;
}

static enum status scene_find(const struct task *task, struct scene *scene)
{
    if ((task->name_count == 2) == !!task->echoes)
        return status_set(STATUS_INVALID, "score: exactly one of SCENE and --echoes FILE.mat is needed");
    if (task->echoes)
        return echoes_scene(task, scene);
    if (task->grid && !has_extension(task->names[0], ".npy"))
        return status_set(STATUS_INVALID, "score: --grid %s goes with --echoes FILE.mat, or with an image in .npy",
                          task->grid);
    return scene_load(task->names[1], data_path(DATA_SCENES), scene);
}

/* An .npy file has no axes: they are those of --grid, or the scene's. */
static enum status image_find(const struct task *task, const struct scene *scene, struct image_file *file)
{
    const char *path = task->names[0];
    struct grid grid = scene->patches[0];
    if (!has_extension(path, ".npy"))
        return image_file_open_whole(path, file);
    if (!task->grid && scene->patch_count > 1)
        return status_set(STATUS_INVALID, "score: %s images %d patches; --grid must say which one %s is", scene->name,
                          scene->patch_count, path);
    enum status status = task->grid ? grid_parse(task->grid, &grid) : STATUS_OK;
    return status == STATUS_OK ? npy_image_read(path, &grid, file) : status;
}

/* The folder of -o, taken before the work; a name's row stays as it is. */
static enum status folder_find(const struct task *task, const struct scene *scene, const char *name,
                               enum precision precision, struct results_folder **folder)
{
    struct provenance provenance;
    if (!task->output)
        return STATUS_OK;
    provenance_fill(&provenance, omp_get_max_threads());
    enum status status = results_folder_open(task->output, &provenance, folder);
    if (status == STATUS_OK)
        status = results_folder_scene(*folder, scene->name, scene->hash);
    if (status == STATUS_OK && results_folder_find(*folder, scene->name, name, "", precision_name(precision)))
        status = status_set(STATUS_INVALID, "score: %s has a row of '%s' on %s; another --name is needed", task->output,
                            name, scene->name);
    return status;
}

static enum status row_add(struct results_folder *folder, const struct outcome *outcome)
{
    const enum status status = results_folder_targets(folder, outcome->targets, outcome->target_count);
    return status == STATUS_OK ? results_folder_add(folder, &outcome->row) : status;
}

/* Conjugates the image; was any of its pixels not real? */
static bool conjugate(const struct image *image)
{
    bool is_complex = false;
    for (int k = 0; k < image->patch_count; k++) {
        const size_t count = grid_pixels(&image->patches[k]);
        float complex *single = image->pixels[k];
        double complex *pixels = image->pixels[k];
        for (size_t n = 0; n < count; n++)
            if (image->precision == PRECISION_DOUBLE) {
                is_complex |= cimag(pixels[n]) != 0;
                pixels[n] = conj(pixels[n]);
            } else {
                is_complex |= cimagf(single[n]) != 0;
                single[n] = conjf(single[n]);
            }
    }
    return is_complex;
}

/* What foreign images most often lack is their phase, or its sign. */
static void phase_warn(const struct image *image, const struct image *reference, double error)
{
    if (!conjugate(image)) {
        puts("    warning: no pixel has an imaginary part: errors and phases are those of complex images");
        return;
    }
    const double conjugated = metrics_error(image, reference).error_gain;
    if (conjugated < error / 2)
        printf("    warning: the image's complex conjugate has an error of %.2g after one gain: echoes here turn by "
               "exp(-j 2 pi fc delay)\n",
               conjugated);
}

static enum status score(const struct scene *scene, const char *name, double seconds, struct image *image,
                         struct results_folder *folder)
{
    struct session session;
    struct outcome outcome;
    enum status status = session_open(scene, &session);
    if (status != STATUS_OK)
        return status;
    if (*session.no_reference)
        status = status_set(STATUS_UNSUPPORTED, "score: there is no exact image of %s: %s", scene->name,
                            session.no_reference);
    if (status == STATUS_OK)
        status = outcome_score(&session, name, image, seconds, &outcome);
    if (status == STATUS_OK) {
        outcome.row.threads = omp_get_max_threads();
        status = folder ? row_add(folder, &outcome) : STATUS_OK;
        table_begin(stdout, false);
        table_row(stdout, &outcome.row);
        phase_warn(&outcome.image, &session.reference, outcome.row.error_gain);
        outcome_free(&outcome);
    }
    session_close(&session);
    return status;
}

enum status command_score(const struct task *task)
{
    char name[NAME_MOST + 1];
    double seconds;
    struct scene scene;
    struct image_file file = {.patches = NULL};
    struct results_folder *folder = NULL;
    enum status status = name_find(task, name);
    if (status == STATUS_OK)
        status = seconds_find(task->seconds, &seconds);
    if (status == STATUS_OK)
        status = scene_find(task, &scene);
    if (status != STATUS_OK)
        return status;
    status = image_find(task, &scene, &file);
    if (status == STATUS_OK) {
        status = scene.reference_count > 0 ? metrics_cover(&file.image, scene.reference_count, scene.reference_patches)
                                           : metrics_cover(&file.image, scene.patch_count, scene.patches);
        if (status != STATUS_OK)
            status = status_set(status, "score: %s does not fit %s: %s (cure: %s--grid)", task->names[0], scene.name,
                                status_message(), task->echoes ? "another " : "--echoes FILE.mat with a ");
        else if (!image_is_finite(&file.image))
            status = status_set(STATUS_INVALID, "score: %s has pixels that are not finite", task->names[0]);
    }
    if (status == STATUS_OK)
        status = folder_find(task, &scene, name, file.image.precision, &folder);
    if (status == STATUS_OK)
        status = score(&scene, name, seconds, &file.image, folder);
    const enum status closed = results_folder_close(folder);
    image_file_close(&file);
    scene_free(&scene);
    return status == STATUS_OK ? closed : status;
}
