/* The pictures of a report: each once, small where that can be made, as long as the page has room. */
#ifndef SASBENCH_REPORT_REPORT_PICTURES_H
#define SASBENCH_REPORT_REPORT_PICTURES_H

#include <stdbool.h>

#include "results/results.h"
#include "report/page.h"

struct pictures_count {
    int shown, left_out, irregular;
};

/* Is a file there that the page has room for, when it takes `growth` times its size? Others but missing ones are
   counted. */
bool report_room(const struct page *page, const char *path, double growth, struct pictures_count *count);
/* A PNG of the folder, or in its place the JPEG file of the descriptor `small` (-1: none), which links to it. Errors: as
   page_image. */
enum status report_picture_show(struct page *page, const char *path, int small, const char *caption,
                                struct pictures_count *count);
/* What of the pictures is not on the page, and why. */
void report_left_out_show(struct page *page, const struct pictures_count *count);

/* Slices and images that `run` left, by scene. Errors: as page_image. */
enum status report_pictures_show(struct page *page, const char *directory, const struct results *results,
                                 int scene_count, const char *const *scenes);

#endif
