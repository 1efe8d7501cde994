/* Which parts of a text may be shown (shown_text.h). */
#include "text/shown_text.h"

#include <ctype.h>
#include <stdbool.h>
#include <string.h>
#include <strings.h>
#include <sys/ioctl.h>
#include <unistd.h>

/* Bytes of the character in UTF-8 and its number; 0 where there is none. */
static size_t character_read(const char *text, uint32_t *code)
{
    const unsigned char *at = (const unsigned char *)text;
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    const size_t length = at[0] < 0x80   ? 1
                          : at[0] < 0xc2 ? 0
                          : at[0] < 0xe0 ? 2
                          : at[0] < 0xf0 ? 3
                          : at[0] < 0xf5 ? 4
                                         : 0;
    *code = length < 2 ? at[0] : at[0] & (0x7fu >> length);
    for (size_t k = 1; k < length; k++) {
        if ((at[k] & 0xc0) != 0x80)
            return 0;
        *code = *code << 6 | (at[k] & 0x3fu);
    }
    const bool is_none = *code < least[length] || *code > 0x10ffff || (*code >= 0xd800 && *code <= 0xdfff);
    return is_none ? 0 : length;
}

size_t control_length(const char *text, uint32_t *code)
{
    static const struct {
        uint32_t first, last;
    } controls[] = {{0x1, 0x1f},      {0x7f, 0x9f},     {0xad, 0xad},     {0x61c, 0x61c},
                    {0x180e, 0x180e}, {0x200b, 0x200b}, {0x200e, 0x200f}, {0x2028, 0x202e},
                    {0x2060, 0x206f}, {0xfeff, 0xfeff}, {0xfff9, 0xfffb}, {0xe0000, 0xe0fff}};
    const size_t length = character_read(text, code);
    for (size_t k = 0; k < sizeof controls / sizeof *controls; k++)
        if (*code >= controls[k].first && *code <= controls[k].last)
            return length;
    return 0;
}

size_t shown_length(const char *text)
{
    uint32_t code;
    return control_length(text, &code) > 0 ? 0 : character_read(text, &code);
}

size_t shown_columns(const char *text)
{
    size_t columns = 0;
    for (; *text; text++)
        columns += ((unsigned char)*text & 0xc0) != 0x80;
    return columns;
}

void shown_make(char *text)
{
    while (*text) {
        size_t length = shown_length(text);
        if (length == 0)
            *text = '?';
        text += length ? length : 1;
    }
}

void shown_write(FILE *stream, const char *text)
{
    while (*text) {
        size_t length = shown_length(text);
        if (length)
            fwrite(text, 1, length, stream);
        else
            fputc('?', stream);
        text += length ? length : 1;
    }
}

void shown_note(const char *text)
{
    struct winsize size;
    const bool terminal = isatty(STDERR_FILENO) && ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    char line[1100];
    snprintf(line, sizeof line, "sasbench: %s", text);
    shown_make(line);
    fflush(stdout);
    for (const char *at = line; *at;) {
        size_t length = strlen(at);
        if (terminal && length > size.ws_col) {
            length = size.ws_col;
            while (length > 0 && at[length] != ' ')
                length--;
            if (length == 0) /* a path stays whole */
                length = strcspn(at, " ");
        }
        fprintf(stderr, "%.*s\n", (int)length, at);
        at += length;
        at += *at == ' ';
    }
}

/* The escape of an ASCII character; NULL: unchanged. Bare addresses become links, too. Neither a backslash nor an
   entity keeps @NAME from notifying that person, or #1 from becoming a link: a zero-width blank does. */
static const char *markdown_escape(const char *start, const char *at)
{
    static const struct {
        char sign;
        const char *instead;
    } escapes[] = {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"},  {'|', "\\|"}, {'*', "\\*"},      {'`', "\\`"},
                   {'[', "\\["},   {']', "\\]"},  {'\\', "\\\\"}, {'~', "\\~"}, {'@', "@&#8203;"}, {'#', "#&#8203;"}};
    for (size_t k = 0; k < sizeof escapes / sizeof *escapes; k++)
        if (escapes[k].sign == *at)
            return escapes[k].instead;
    if (*at == ':' && at[1] == '/')
        return "&#58;";
    if (*at == '.' && at - start >= 3 && strncasecmp(at - 3, "www", 3) == 0)
        return "&#46;";
    if (*at == '_' && !(at > start && isalnum((unsigned char)at[-1]) && isalnum((unsigned char)at[1])))
        return "\\_";
    return NULL;
}

void shown_markdown(FILE *stream, const char *text)
{
    for (const char *at = text; *at;) {
        size_t length = shown_length(at);
        const char *instead = length == 0 ? "?" : length == 1 ? markdown_escape(text, at) : NULL;
        if (instead)
            fputs(instead, stream);
        else
            fwrite(at, 1, length, stream);
        at += length ? length : 1;
    }
}
