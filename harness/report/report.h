/* A results folder as a page to read. */
#ifndef SASBENCH_REPORT_REPORT_H
#define SASBENCH_REPORT_REPORT_H

#include "contract/status.h"

/* Write DIR/report.html, self-contained, into a locked folder (folder.h): three sentences, all scenes side by side,
   the fronts, the fastest settings, warnings; then the tables, folded, pictures, and the machine, as far as the
   folder has them. Images are thumbnails that link to the files beside it; the page stays below REPORT_HTML_BYTES:
   further pictures are counted and left out. Errors: STATUS_INVALID for a folder without a measurements.csv of ours,
   with a file that is not as in results/README.md, or that cannot be written; an older page is then left as it is. */
enum status report_write(const char *directory);

enum { REPORT_HTML_BYTES = 3 << 20 };

#endif
