/* XML by libexpat (xml.h). */
#include <expat.h>
#include <limits.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "convert/xml.h"

/* Where the parser is. */
struct state {
    XML_Parser parser;
    struct xml *xml;
    char path[500]; /* of the element at hand, each name with a '/' ahead; empty: the root */
    int depth;
    bool is_leaf; /* so far */
    char *text;   /* [text_size + 1], of which `text_length` are the element's */
    size_t text_length, text_size;
    bool is_full; /* without memory */
};

static void give_up(struct state *state, bool is_full)
{
    state->is_full = state->is_full || is_full;
    XML_StopParser(state->parser, XML_FALSE);
}

static void element_begin(void *with, const char *name, const char **attributes)
{
    struct state *state = with;
    const char *colon = strrchr(name, ':'), *own = colon ? colon + 1 : name;
    const size_t length = strlen(state->path);
    (void)attributes;
    if (state->depth++ > 0) {
        if (length + strlen(own) + 2 > sizeof state->path) {
            give_up(state, false);
            return;
        }
        state->path[length] = '/';
        strcpy(state->path + length + 1, own);
    }
    state->is_leaf = true;
    state->text_length = 0;
}

static void text_take(void *with, const char *text, int length)
{
    struct state *state = with;
    const size_t needed = state->text_length + (size_t)length;
    if (!state->is_leaf)
        return;
    if (needed > state->text_size) {
        char *grown = realloc(state->text, 2 * needed + 1);
        if (!grown) {
            give_up(state, true);
            return;
        }
        state->text = grown;
        state->text_size = 2 * needed;
    }
    memcpy(state->text + state->text_length, text, (size_t)length);
    state->text_length = needed;
}

/* Room for leaf number `count` at every power of two. */
static bool leaf_add(struct xml *xml, const char *path, const char *text, size_t length)
{
    static const char blanks[] = " \t\r\n";
    if ((xml->count & (xml->count - 1)) == 0) {
        struct xml_leaf *grown = xml->count < INT_MAX / 2
                                     ? realloc(xml->leaves, (xml->count ? 2 * (size_t)xml->count : 1) * sizeof *grown)
                                     : NULL;
        if (!grown)
            return false;
        xml->leaves = grown;
    }
    while (length > 0 && strchr(blanks, text[0])) {
        text++;
        length--;
    }
    while (length > 0 && strchr(blanks, text[length - 1]))
        length--;
    struct xml_leaf leaf = {strdup(path), strndup(length ? text : "", length)};
    if (!leaf.path || !leaf.text) {
        free(leaf.path);
        free(leaf.text);
        return false;
    }
    xml->leaves[xml->count++] = leaf;
    return true;
}

static void element_end(void *with, const char *name)
{
    struct state *state = with;
    (void)name;
    if (state->is_leaf && *state->path && !leaf_add(state->xml, state->path + 1, state->text, state->text_length))
        give_up(state, true);
    state->is_leaf = false;
    state->depth--;
    if (*state->path)
        *strrchr(state->path, '/') = '\0';
}

enum status xml_read(const char *place, const char *document, size_t size, struct xml *xml)
{
    struct state state = {.parser = XML_ParserCreate(NULL), .xml = xml};
    enum status status = STATUS_OK;
    *xml = (struct xml){0, NULL};
    if (!state.parser)
        return status_set(STATUS_FAILED, "%s: out of memory for its XML", place);
    XML_SetUserData(state.parser, &state);
    XML_SetElementHandler(state.parser, element_begin, element_end);
    XML_SetCharacterDataHandler(state.parser, text_take);
    if (XML_Parse(state.parser, document, (int)size, XML_TRUE) != XML_STATUS_OK) {
        const enum XML_Error error = XML_GetErrorCode(state.parser);
        status = state.is_full || error == XML_ERROR_NO_MEMORY
                     ? status_set(STATUS_FAILED, "%s: out of memory for its XML of %zu bytes", place, size)
                     : status_set(STATUS_INVALID, "%s: its XML is damaged at line %lu: %s", place,
                                  (unsigned long)XML_GetCurrentLineNumber(state.parser), XML_ErrorString(error));
        xml_free(xml);
    }
    XML_ParserFree(state.parser);
    free(state.text);
    return status;
}
