/* What is common to builds with libexpat and without (xml.h). */
#include "convert/xml.h"

#include <stdlib.h>
#include <string.h>

void xml_free(struct xml *xml)
{
    for (int k = 0; k < xml->count; k++) {
        free(xml->leaves[k].path);
        free(xml->leaves[k].text);
    }
    free(xml->leaves);
    *xml = (struct xml){0, NULL};
}

const char *xml_text(const struct xml *xml, const char *path, int index)
{
    for (int k = 0; k < xml->count; k++)
        if (strcmp(xml->leaves[k].path, path) == 0 && index-- == 0)
            return xml->leaves[k].text;
    return NULL;
}
