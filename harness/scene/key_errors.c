/* The one error of a key: its place, its value, and what is accepted. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "text/text_append.h"
#include "scene/key_types.h"
#include "scene/keys.h"

/* "targets.points[2].x" */
static void append_setting_path(char *text, size_t size, const config_setting_t *setting)
{
    const config_setting_t *parent = config_setting_parent(setting);
    if (!parent) {
        return;
    }
    append_setting_path(text, size, parent);
    if (config_setting_name(setting)) {
        text_append(text, size, "%s%s", *text ? "." : "", config_setting_name(setting));
    } else {
        text_append(text, size, "[%d]", config_setting_index(setting));
    }
}

static void append_value(char *text, size_t size, const config_setting_t *setting)
{
    char number[40];
    const char *string;
    switch (config_setting_type(setting)) {
    case CONFIG_TYPE_INT: text_append(text, size, "%d", config_setting_get_int(setting)); break;
    case CONFIG_TYPE_INT64: text_append(text, size, "%lld", config_setting_get_int64(setting)); break;
    case CONFIG_TYPE_FLOAT:
        snprintf(number, sizeof number, "%.10g", config_setting_get_float(setting));
        text_append(text, size, "%s%s", number, strpbrk(number, ".en") ? "" : ".0"); /* 40.0 is no integer */
        break;
    case CONFIG_TYPE_BOOL: text_append(text, size, "%s", config_setting_get_bool(setting) ? "true" : "false"); break;
    case CONFIG_TYPE_STRING:
        string = config_setting_get_string(setting);
        text_append(text, size, "\"%.*s\"", (int)strcspn(string, "\r\n"), string);
        break;
    default:
        text_append(text, size, "%s",
                    config_setting_is_group(setting)  ? "a group { ... }"
                    : config_setting_is_list(setting) ? "a list ( ... )"
                                                      : "an array [ ... ]");
        for (int i = 0; config_setting_is_array(setting) && i < config_setting_length(setting) && i < 3; i++) {
            text_append(text, size, "%s", i == 0 ? " of " : ", ");
            append_value(text, size, config_setting_get_elem(setting, (unsigned)i));
        }
    }
}

/* The text piece that contains a line. */
static const struct text_piece *piece_find(const struct reading *reading, unsigned line)
{
    const struct text_piece *piece = reading->text.pieces + reading->text.piece_count - 1;
    while (piece > reading->text.pieces && piece->first_line > (int)line) {
        piece--;
    }
    return piece;
}

const char *line_path(const struct reading *reading, unsigned line)
{
    return line == 0 ? reading->path : piece_find(reading, line)->path;
}

void place_format(const struct reading *reading, unsigned line, char *text, size_t size)
{
    if (line == 0) {
        snprintf(text, size, "%.300s", reading->path);
        return;
    }
    const struct text_piece *piece = piece_find(reading, line);
    snprintf(text, size, "%.300s:%d", piece->path, piece->line + (int)line - piece->first_line);
}

enum status refuse(const struct reading *reading, const config_setting_t *group, const char *group_name,
                   const char *name, const char *format, ...)
{
    const config_setting_t *setting = name ? key_member(group, name) : group, *near = setting ? setting : group;
    char place[320], path[200] = "", value[200] = "", accepted[400];
    if (near) {
        place_format(reading, config_setting_source_line(near), place, sizeof place);
        append_setting_path(path, sizeof path, near);
    } else {
        place_format(reading, 0, place, sizeof place);
        text_append(path, sizeof path, "%s", group_name);
    }
    if (!setting) {
        text_append(path, sizeof path, "%s%s", *path ? "." : "", name);
        text_append(value, sizeof value, "missing");
    } else {
        append_value(value, sizeof value, setting);
    }
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(accepted, sizeof accepted, format, arguments);
    va_end(arguments);
    return status_set(STATUS_INVALID, "%s: key '%s' is %s, must be %s", place, path, value, accepted);
}
