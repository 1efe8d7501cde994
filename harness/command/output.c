/* -o, --range and --memory of commands, pictures, and an image's origin on the terminal. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "files/paths.h"
#include "command/task.h"
#include "text/number.h"
#include "text/text_append.h"
#include "metrics/metrics.h"
#include "results/provenance.h"
#include "echoes/matfile.h"
#include "show/plot.h"
#include "show/table.h"

bool has_extension(const char *path, const char *extension)
{
    const char *found = path ? strrchr(path, '.') : NULL;
    return found && strcasecmp(found, extension) == 0;
}

bool output_is_picture(const char *path)
{
    return has_extension(path, ".png") || has_extension(path, ".svg");
}

enum status output_check(const char *command, const char *output)
{
    if (!output)
        return status_set(STATUS_INVALID, "%s: -o FILE.mat is missing", command);
    enum status status = matfile_place(output);
    if (status == STATUS_OK && !has_extension(output, ".mat"))
        status = status_set(STATUS_INVALID, "%s: -o %s has another ending; accepted: FILE.mat%s", command, output,
                            strcmp(command, "image") == 0 ? ", FILE.png, FILE.svg" : "");
    return status;
}

enum status picture_check(const char *command, const char *output)
{
    enum status status = matfile_place(output);
    if (status == STATUS_OK && !output_is_picture(output))
        status =
            status_set(STATUS_INVALID, "%s: -o %s has another ending; accepted: FILE.png, FILE.svg", command, output);
    return status;
}

enum status range_parse(const char *command, const char *text, double *range_db)
{
    const char *end = text ? number_read(text, range_db) : "";
    if (!text)
        *range_db = IMAGE_RANGE_DB;
    if (!end || *end || !(*range_db >= 1 && *range_db <= 400))
        return status_set(STATUS_INVALID, "%s: --range is '%s', must be a number of dB from 1 to 400", command, text);
    return STATUS_OK;
}

enum status memory_parse(const char *command, const char *text, double *bytes)
{
    static const char prefixes[] = "kMGTK"; /* KiB, and kB */
    const char *end = number_read(text, bytes), *prefix = end && *end ? strchr(prefixes, *end) : NULL;
    if (prefix) {
        const bool binary = end[1] == 'i';
        *bytes *= pow(binary ? 1024 : 1000, (double)((prefix - prefixes) % 4) + 1);
        end += 1 + binary;
    }
    if (end && *end == 'B')
        end++;
    return end && !*end && *bytes > 0 && *bytes < INFINITY
               ? STATUS_OK
               : status_set(STATUS_INVALID,
                            "%s: --memory is '%s', must be bytes above 0: 4e9, or with k, M, G, T, Ki, Mi, Gi or Ti "
                            "and B behind, as 2GB, 512MiB",
                            command, text);
}

enum status memory_of_tiles(const char *command, const struct task *task, double *bytes)
{
    *bytes = 0;
    if (!task->memory)
        return STATUS_OK;
    if (!task->echoes)
        return status_set(STATUS_INVALID,
                          "%s: --memory %s is for tiles of an echo file, --echoes FILE.mat (a scene's is written by "
                          "`simulate`)",
                          command, task->memory);
    return memory_parse(command, task->memory, bytes);
}

enum status picture_draw(const char *path, bool named, const struct image *image, const char *title, double range_db,
                         const struct scene *scene)
{
    char footer[PROVENANCE_LINE];
    provenance_line(footer);
    const struct image_picture picture = {.image = image,
                                          .title = title,
                                          .footer = footer,
                                          .range_db = range_db,
                                          .targets = scene ? scene->targets : NULL,
                                          .target_count = scene ? scene->point_count : 0,
                                          .named = named};
    return plot_image(NULL, path, data_path(DATA_PLOTS), &picture);
}

enum status picture_differ(const char *path, const struct image *image, const struct image *reference,
                           const char *const names[2])
{
    char footer[PROVENANCE_LINE], title[1000];
    provenance_line(footer);
    snprintf(title, sizeof title, "%.400s, and its difference to %.400s", names[0], names[1]);
    const struct image_picture picture = {
        .image = image, .reference = reference, .title = title, .footer = footer, .named = true};
    return plot_image(NULL, path, data_path(DATA_PLOTS), &picture);
}

struct choice_text origin_choice(const struct image_origin *origin)
{
    struct choice_text choice = {""};
    if (strcmp(origin->algorithm, "auto") == 0 && *origin->engine)
        snprintf(choice.text, sizeof choice.text, " chose %s", origin->engine);
    return choice;
}

/* "NAME VALUE, NAME VALUE", of those that are not empty. */
static void pairs_print(const char *const pairs[][2], int count)
{
    char text[1200] = "";
    for (int k = 0; k < count; k++)
        if (*pairs[k][1])
            text_append(text, sizeof text, "%s%s %s", *text ? ", " : "", pairs[k][0], pairs[k][1]);
    if (*text)
        table_text(stdout, 2, text);
}

void origin_print(const struct image_origin *origin)
{
    char fc[40] = "", speed[40] = "";
    if (!isnan(origin->fc))
        snprintf(fc, sizeof fc, "%g Hz", origin->fc);
    if (!isnan(origin->sound_speed))
        snprintf(speed, sizeof speed, "%g m/s", origin->sound_speed);
    pairs_print((const char *const[][2]){{"engine", origin->engine}, {"fc", fc}, {"sound speed", speed}}, 3);
    pairs_print((const char *const[][2]){{"of the scene's content", origin->scene_hash},
                                         {"by commit", origin->commit},
                                         {"on", origin->date}},
                3);
}

void image_describe(const struct image *image)
{
    const struct sharpness sharpness = metrics_sharpness(image);
    for (int p = 0; p < image->patch_count && p < 8; p++) {
        const struct grid *g = &image->patches[p];
        const double x_last = g->x_first + (g->x_count - 1) * g->x_step;
        const double r_last = g->r_first + (g->r_count - 1) * g->r_step;
        printf("  %d x %d pixels, x %s to %s m, r %s to %s m%s\n", g->x_count, g->r_count,
               cell_place(g->x_first, g->x_step).text, cell_place(x_last, g->x_step).text,
               cell_place(g->r_first, g->r_step).text, cell_place(r_last, g->r_step).text,
               g->angle_rad != 0 ? " (turned axes)" : "");
    }
    if (image->patch_count > 8)
        printf("  and %d patches more\n", image->patch_count - 8);
    if (!(sharpness.peak > 0)) {
        printf("  all pixels are zero\n");
        return;
    }
    printf("  peak %.4g at (%s, %s) m", sharpness.peak, cell_place(sharpness.x, image->patches[0].x_step).text,
           cell_place(sharpness.r, image->patches[0].r_step).text);
    if (isfinite(sharpness.peak_over_median))
        printf(", %.4g times the median", sharpness.peak_over_median);
    printf("\n");
}
