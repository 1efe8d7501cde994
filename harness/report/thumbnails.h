/* Small copies of pictures, for a page with many of them. */
#ifndef SASBENCH_REPORT_THUMBNAILS_H
#define SASBENCH_REPORT_THUMBNAILS_H

#include "show/plot_script.h"

enum { THUMBNAILS_MOST = 64 }; /* of one set; further pictures have no thumbnail */

/* A set in the making: thumbnails_add each picture, thumbnails_draw, use them, thumbnails_end. */
struct thumbnails {
    struct plot plot; /* behind its preamble, the files are the thumbnails */
    int count;
    int sources[THUMBNAILS_MOST]; /* [count] descriptors */
};

/* Pictures whose thumbnail cannot be made have none. */
void thumbnails_begin(struct thumbnails *thumbnails);
/* A PNG file, of about so many `pixels` when it is small. Returns its number, -1 where the file is no PNG picture of
   a usual size. */
int thumbnails_add(struct thumbnails *thumbnails, const char *path, double pixels);
void thumbnails_draw(struct thumbnails *thumbnails, const char *plots_directory);
/* The descriptor of a thumbnail's file; -1 without one. */
int thumbnails_file(const struct thumbnails *thumbnails, int number);
void thumbnails_end(struct thumbnails *thumbnails);

#endif
