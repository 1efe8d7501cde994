/* Headings, tables and pictures as HTML (page.h). */
#include "report/page.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "files/folder.h"
#include "text/shown_text.h"

/* --- Text ------------------------------------------------------------------------------------------------------ */

/* Write the character at *text and advance to the next one. */
static void character_write(struct page *page, const char **text)
{
    static const struct {
        char sign;
        const char *instead;
    } escapes[] = {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}};
    size_t length = shown_length(*text);
    const char *instead = length ? NULL : "\ufffd";
    for (size_t k = 0; k < sizeof escapes / sizeof *escapes; k++)
        if (escapes[k].sign == **text)
            instead = escapes[k].instead;
    if (instead)
        fputs(instead, page->stream);
    else
        fwrite(*text, 1, length, page->stream);
    *text += length ? length : 1;
}

void page_text(struct page *page, const char *text)
{
    while (*text)
        character_write(page, &text);
}

/* <NAME ATTRIBUTE="VALUE">TEXT</NAME>; without a value no attribute. */
static void element_write(struct page *page, const char *name, const char *attribute, const char *value,
                          const char *text)
{
    fprintf(page->stream, "<%s", name);
    if (value) {
        fprintf(page->stream, " %s=\"", attribute);
        page_text(page, value);
        fputc('"', page->stream);
    }
    fputc('>', page->stream);
    page_text(page, text);
    fprintf(page->stream, "</%s>", name);
}

/* --- Structure ------------------------------------------------------------------------------------------------- */

void page_begin(struct page *page, const char *title)
{
    fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n  <meta charset=\"utf-8\"/>\n"
          "  <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n  ",
          page->stream);
    element_write(page, "title", NULL, NULL, title);
    fprintf(page->stream, "\n%s</head>\n<body>\n", page_style);
    element_write(page, "h1", NULL, NULL, title);
    fputc('\n', page->stream);
}

void page_end(struct page *page)
{
    fprintf(page->stream, "%s</body>\n</html>\n", page_script);
}

void page_heading(struct page *page, int level, const char *id, const char *text)
{
    element_write(page, level == 2 ? "h2" : "h3", "id", id, text);
    fputc('\n', page->stream);
}

void page_part_begin(struct page *page, const char *title)
{
    fputs("<details>\n", page->stream);
    element_write(page, "summary", NULL, NULL, title);
    fputc('\n', page->stream);
}

void page_part_end(struct page *page)
{
    fputs("</details>\n", page->stream);
}

void page_paragraph(struct page *page, const char *text)
{
    element_write(page, "p", NULL, NULL, text);
    fputc('\n', page->stream);
}

void page_link(struct page *page, const char *id, const char *text)
{
    fprintf(page->stream, "  <a href=\"#%s\">", id);
    page_text(page, text);
    fputs("</a>\n", page->stream);
}

/* --- Tables ---------------------------------------------------------------------------------------------------- */

void page_table_begin(struct page *page, int count, const struct page_column *columns)
{
    page->columns = columns;
    page->column_count = count;
    fputs("<table>\n<thead><tr>", page->stream);
    for (int k = 0; k < count; k++)
        element_write(page, "th", "class", columns[k].number ? "number" : NULL, columns[k].title);
    fputs("</tr></thead>\n<tbody>\n", page->stream);
}

/* A row's name, which may be a long SPEC: it may break between its parts. */
static void name_write(struct page *page, const char *name)
{
    fputs("<th>", page->stream);
    while (*name) {
        char sign = *name;
        character_write(page, &name);
        if (sign == ':' || sign == ',')
            fputs("<wbr/>", page->stream);
    }
    fputs("</th>", page->stream);
}

static void cell_write(struct page *page, const struct page_column *column, const struct page_cell *cell)
{
    fputs("<td data-label=\"", page->stream);
    page_text(page, column->title);
    fprintf(page->stream, "\" class=\"%s\">", cell->class ? cell->class : column->number ? "number" : "text");
    page_text(page, cell->text);
    fputs("</td>", page->stream);
}

void page_row(struct page *page, const struct page_cell *cells)
{
    fputs("<tr>", page->stream);
    name_write(page, cells[0].text);
    for (int k = 1; k < page->column_count; k++)
        cell_write(page, &page->columns[k], &cells[k]);
    fputs("</tr>\n", page->stream);
}

void page_row_note(struct page *page, const char *name, const char *note)
{
    fputs(*name ? "<tr>" : "<tr class=\"below\">", page->stream);
    name_write(page, name);
    fprintf(page->stream, "<td class=\"note\" colspan=\"%d\">", page->column_count - 1);
    page_text(page, note);
    fputs("</td></tr>\n", page->stream);
}

void page_table_end(struct page *page)
{
    fputs("</tbody>\n</table>\n", page->stream);
}

/* --- Pictures -------------------------------------------------------------------------------------------------- */

/* The file of a descriptor, which is closed; -1: the one at `path`. A picture must be in the folder itself: a link
   would show another file's content, and a pipe would wait for a writer. */
static enum status file_read(int descriptor, const char *path, char **bytes, size_t *size)
{
    struct stat info;
    descriptor = descriptor >= 0 ? descriptor : place_read(path, O_NOFOLLOW | O_NONBLOCK);
    FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "rb");
    *bytes = NULL;
    bool regular = file && fstat(descriptor, &info) == 0 && S_ISREG(info.st_mode);
    if (regular && (*bytes = malloc((size_t)info.st_size + 1)))
        *size = fread(*bytes, 1, (size_t)info.st_size, file);
    bool good = *bytes && !ferror(file);
    enum status status = good ? STATUS_OK
                              : status_set(STATUS_FAILED, "%s: cannot be read: %s", path,
                                           file && !regular ? "no regular file" : strerror(errno));
    if (file)
        fclose(file);
    else if (descriptor >= 0)
        close(descriptor);
    if (good) {
        (*bytes)[*size] = '\0';
    } else {
        free(*bytes);
        *bytes = NULL;
    }
    return status;
}

/* An SVG file's root element. Its names are unique within the file only: each gets the drawing's number as prefix. */
static void drawing_write(struct page *page, const char *svg)
{
    static const char *const marks[] = {" id=\"", " id='", "href='#", "href=\"#", "url(#"};
    while (*svg) {
        size_t length = 0;
        for (size_t k = 0; k < sizeof marks / sizeof *marks && !length; k++)
            if (strncmp(svg, marks[k], strlen(marks[k])) == 0)
                length = strlen(marks[k]);
        size_t character = strchr("\n\t", *svg) ? 1 : shown_length(svg);
        if (length)
            fprintf(page->stream, "%.*sd%d-", (int)length, svg, page->drawings);
        else if (character)
            fwrite(svg, 1, character, page->stream);
        else
            fputs("\ufffd", page->stream);
        svg += length ? length : character ? character : 1;
    }
}

enum status page_drawing(struct page *page, const char *path, const char *title)
{
    char *svg;
    size_t size;
    enum status status = file_read(-1, path, &svg, &size);
    if (status != STATUS_OK)
        return status;
    const char *root = strstr(svg, "<svg");
    if (root) {
        page->drawings++;
        fputs("<div class=\"drawing\" role=\"img\" aria-label=\"", page->stream);
        page_text(page, title);
        fputs("\">\n", page->stream);
        drawing_write(page, root);
        fputs("</div>\n", page->stream);
    } else {
        status = status_set(STATUS_FAILED, "%s: holds no SVG picture", path);
    }
    free(svg);
    return status;
}

static void base64_write(FILE *stream, const char *bytes, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t k = 0; k < size; k += 3) {
        unsigned group = 0;
        for (size_t n = 0; n < 3; n++)
            group = group << 8 | (k + n < size ? (unsigned char)bytes[k + n] : 0u);
        for (size_t n = 0; n < 4; n++)
            fputc(k + n <= size ? digits[group >> (18 - 6 * n) & 63] : '=', stream);
    }
}

/* The beginning of a link to a file beside the page. */
static void link_write(struct page *page, const char *name)
{
    fputs("<a href=\"", page->stream);
    for (const char *at = name; *at; at++)
        fprintf(page->stream, isalnum((unsigned char)*at) || strchr("-_.", *at) ? "%c" : "%%%02X", (unsigned char)*at);
    fputs("\">", page->stream);
}

void page_file(struct page *page, const char *name, const char *text)
{
    link_write(page, name);
    page_text(page, text);
    fputs("</a>", page->stream);
}

/* A picture of the type, inside a link where `link` is not NULL. */
static enum status figure_write(struct page *page, int descriptor, const char *path, const char *type, const char *link,
                                const char *caption)
{
    char *bytes;
    size_t size;
    enum status status = file_read(descriptor, path, &bytes, &size);
    if (status != STATUS_OK)
        return status;
    fputs("<figure>\n", page->stream);
    if (link)
        link_write(page, link);
    fputs("<img alt=\"", page->stream);
    page_text(page, caption);
    fprintf(page->stream, "\" src=\"data:image/%s;base64,", type);
    base64_write(page->stream, bytes, size);
    fprintf(page->stream, "\"/>%s\n", link ? "</a>" : "");
    element_write(page, "figcaption", NULL, NULL, caption);
    fputs("\n</figure>\n", page->stream);
    free(bytes);
    return STATUS_OK;
}

enum status page_image(struct page *page, const char *path, const char *caption)
{
    return figure_write(page, -1, path, "png", NULL, caption);
}

enum status page_thumbnail(struct page *page, int small, const char *name, const char *caption)
{
    const int descriptor = fcntl(small, F_DUPFD_CLOEXEC, 0);
    lseek(descriptor, 0, SEEK_SET);
    return figure_write(page, descriptor, name, "jpeg", name, caption);
}
