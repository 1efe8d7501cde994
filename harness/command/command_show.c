/* The command `show`: a picture of an image file. */
#include <stdio.h>
#include <string.h>

#include "command/task.h"
#include "echoes/mat_tiles.h"
#include "show/plot.h"

/* FILE.png for FILE.mat. */
static void usual_output(const char *file, char *path, size_t size)
{
    const char *dot = strrchr(file, '.'), *slash = strrchr(file, '/');
    const int length = dot && (!slash || dot > slash) ? (int)(dot - file) : (int)strlen(file);
    snprintf(path, size, "%.*s.png", length, file);
}

static enum status file_open(const char *path, struct image_file *file)
{
    bool echoes;
    enum status status = echo_file_is(path, &echoes);
    if (status == STATUS_OK && echoes)
        return status_set(
            STATUS_INVALID,
            "show: %s holds echoes, not an image; sasbench image --echoes %s --grid GRID --algorithm SPEC -o "
            "FILE.png draws one",
            path, path);
    return status == STATUS_OK ? image_file_open(path, file) : status;
}

enum status command_show(const struct task *task)
{
    struct image_file file;
    char output[4200], title[1200], part[60] = "";
    double range_db;
    int done, count;
    if (task->output)
        snprintf(output, sizeof output, "%s", task->output);
    else
        usual_output(task->names[0], output, sizeof output);
    enum status status = picture_check("show", output);
    if (status == STATUS_OK)
        status = range_parse("show", task->range, &range_db);
    if (status == STATUS_OK)
        status = file_open(task->names[0], &file);
    if (status != STATUS_OK)
        return status;
    const struct image_origin *o = &file.origin;
    if (tiles_claimed(task->names[0], &done, &count)) {
        snprintf(part, sizeof part, ", unfinished: %d of %d tiles", done, count);
        tiles_blank(task->names[0], &file.image.patches[0], file.image.pixels[0]);
    }
    snprintf(title, sizeof title, "%s%s%s%s%s%s%s", *o->scene ? o->scene : task->names[0], *o->algorithm ? ": " : "",
             o->algorithm, *o->options ? ":" : "", o->options, origin_choice(o).text, part);
    status = picture_draw(output, task->output, &file.image, title, range_db, NULL);
    if (status == STATUS_OK) {
        printf("%s: %s\n", output, title);
        origin_print(o);
        image_describe(&file.image);
    }
    image_file_close(&file);
    return status;
}
