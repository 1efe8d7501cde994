/* Small copies of pictures, for a page that holds many. */
#ifndef SASBENCH_REPORT_THUMBNAILS_H
#define SASBENCH_REPORT_THUMBNAILS_H

#include <limits.h>
#include <stdbool.h>

#include "show/plot_script.h"

enum { THUMBNAILS_MOST = 64 }; /* of one set; more are left without */

/* A set in the making: thumbnails_add each picture, thumbnails_draw, use them, thumbnails_end. */
struct thumbnails {
    struct plot plot; /* its temporary folder holds them */
    int count;
};

/* `beside`: a path in the folder of the pictures, in which a temporary one is made; borrowed until thumbnails_end.
   What cannot be made leaves pictures without thumbnails. */
void thumbnails_begin(struct thumbnails *thumbnails, const char *beside);
/* A PNG file of that folder, of about so many `pixels` when it is small. Returns its number, -1 for what is no PNG
   picture of a usual size. */
int thumbnails_add(struct thumbnails *thumbnails, const char *path, double pixels);
void thumbnails_draw(struct thumbnails *thumbnails, const char *plots_directory);
/* The path of a thumbnail; false where there is none. */
bool thumbnails_path(const struct thumbnails *thumbnails, int number, char path[PATH_MAX]);
void thumbnails_end(struct thumbnails *thumbnails);

#endif
