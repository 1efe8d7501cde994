/* An XML document as its texts. */
#ifndef SASBENCH_CONVERT_XML_H
#define SASBENCH_CONVERT_XML_H

#include <stddef.h>

#include "contract/status.h"

/* Elements without elements inside, in the order of the document. */
struct xml {
    int count;
    struct xml_leaf {
        char *path; /* names from below the root on, "Global/SGN", without prefixes of name spaces */
        char *text; /* without blanks around it */
    } * leaves;     /* [count] */
};

/* Read a document of `size` bytes; freed with xml_free. `place` begins messages. Errors, with nothing to free:
   STATUS_INVALID for what is no XML, and in a build without libexpat; STATUS_FAILED without memory. */
enum status xml_read(const char *place, const char *document, size_t size, struct xml *xml);
void xml_free(struct xml *xml);
/* The text of number `index` from 0 of the leaves with a path; NULL: there is none. Owned by `xml`. */
const char *xml_text(const struct xml *xml, const char *path, int index);

#endif
