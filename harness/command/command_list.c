/* The commands `list` and `info`: the algorithm tables, printed. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "command/task.h"
#include "echoes/mat_tiles.h"
#include "show/table.h"
#include "command/inspect.h"
#include "guests/guests.h"

static const struct {
    enum trait trait;
    const char *text;
} traits[] = {
    {TRAIT_EXACT, "exact"},
    {TRAIT_ANY_TRACK, "any track"},
    {TRAIT_APERTURE_LIMIT, "aperture limit"},
    {TRAIT_AREA, "target area alone"},
};

static void print_traits(const struct algorithm *algorithm)
{
    const char *separator = "";
    for (size_t k = 0; k < sizeof traits / sizeof *traits; k++)
        if (algorithm->traits & traits[k].trait) {
            printf("%s%s", separator, traits[k].text);
            separator = ", ";
        }
    if (!(algorithm->traits & TRAIT_ANY_TRACK))
        printf("%suniform straight tracks", separator);
    printf("\n");
}

enum status command_list(const struct task *task)
{
    (void)task;
    for (int k = 0; algorithms[k]; k++) {
        printf("%-13s %s\n%-13s %s; ", algorithms[k]->name, algorithms[k]->summary, "", algorithms[k]->reference);
        print_traits(algorithms[k]);
    }
    for (int k = 0; algorithm_filters[k]; k++)
        printf("%-13s %s: ahead of an algorithm, '%s | wk_squint'\n%-13s %s\n", algorithm_filters[k]->name,
               algorithm_filters[k]->summary, algorithm_filters[k]->name, "", algorithm_filters[k]->reference);
    return STATUS_OK;
}

/* "2 to 64", or a choice's names. */
static void accepted_format(const struct param *param, char *text, size_t size)
{
    char min[32], max[32];
    if (param->type == PARAM_CHOICE) {
        size_t used = 0;
        for (int k = 0; param->choices[k] && used < size; k++)
            used += (size_t)snprintf(text + used, size - used, "%s%s", k ? ", " : "", param->choices[k]);
        return;
    }
    if (param->type == PARAM_TEXT) {
        snprintf(text, size, "a text without commas");
        return;
    }
    param_format(param, param->min, min, sizeof min);
    param_format(param, param->max, max, sizeof max);
    snprintf(text, size, "%s to %s", min, max);
}

#define LAYOUT "%-11s %-10s %-24s %s\n"

static enum status file_info(const char *path)
{
    struct image_file file;
    bool echoes, is_image = false;
    enum status status = echo_file_is(path, &echoes);
    if (status == STATUS_OK && !echoes)
        status = image_file_is(path, &is_image);
    if (status == STATUS_OK && !is_image)
        return inspect_echoes(path); /* of neither kind: the message has what echoes need */
    if (status == STATUS_OK)
        status = image_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    const struct image_origin *o = &file.origin;
    printf("%s: an image%s%s%s%s%s%s%s\n", path, *o->scene ? " of " : "", o->scene, *o->algorithm ? " by " : "",
           o->algorithm, *o->options ? ":" : "", o->options, origin_choice(o).text);
    origin_print(o);
    int done, count;
    if (tiles_claimed(path, &done, &count))
        printf("  unfinished: %d of %d tiles are done, the others are zero\n", done, count);
    else if (strncmp(o->status, "unfinished", strlen("unfinished")) == 0)
        printf("  unfinished, and the journal of its tiles, %s" TILES_JOURNAL ", is not there\n", path);
    image_describe(&file.image);
    image_file_close(&file);
    return STATUS_OK;
}

enum status command_info(const struct task *task)
{
    const char *rest;
    struct spec spec;
    const enum status invited = guest_invite(task->names[0]);
    if (invited != STATUS_OK)
        return invited;
    const struct algorithm *algorithm = guest_find(task->names[0], &rest);
    if (*rest)
        algorithm = NULL;
    if (has_extension(task->names[0], ".mat") || (!algorithm && access(task->names[0], F_OK) == 0))
        return file_info(task->names[0]);
    if (!algorithm) {
        enum status status = spec_parse(task->names[0], &spec); /* its message has what is accepted */
        if (status != STATUS_OK)
            return status;
        spec_free(&spec);
        return status_set(STATUS_INVALID, "info: '%.100s' has settings, must be the name of an algorithm alone",
                          task->names[0]);
    }
    if (algorithm->filter)
        printf("A filter, ahead of an algorithm: '%s | bp_sinc'\n", algorithm->name);
    printf("%s: %s\nreference: %s\n%s%s%s", algorithm->name, algorithm->summary, algorithm->reference,
           algorithm->origin ? "origin: " : "", algorithm->origin ? algorithm->origin : "",
           algorithm->origin ? "\n" : "");
    if (!algorithm->filter) {
        printf("traits: ");
        print_traits(algorithm);
    }
    if (!algorithm->filter || (algorithm->params && algorithm->params->name))
        printf("\n" LAYOUT, "parameter", "default", "accepted", "sweep");
    if (!algorithm->filter) { /* it has the precision of what follows */
        printf(LAYOUT, "precision", "float", "float, double", "float double");
        table_text(stdout, 12, "of samples, sums and pixels; geometry is always double");
    }
    for (const struct param *p = algorithm->params; p && p->name; p++) {
        char initial[64], accepted[160];
        if (p->hidden)
            continue;
        if (p->type == PARAM_TEXT)
            snprintf(initial, sizeof initial, "'%.60s'", p->text);
        else if (p->type == PARAM_REAL)
            snprintf(initial, sizeof initial, "%.6g", p->initial);
        else
            param_format(p, p->initial, initial, sizeof initial);
        accepted_format(p, accepted, sizeof accepted);
        printf(LAYOUT, p->name, initial, accepted, p->sweep ? p->sweep : "-");
        table_text(stdout, 12, p->summary);
    }
    return STATUS_OK;
}
