/* The parts of a report. */
#ifndef SASBENCH_REPORT_REPORT_PARTS_H
#define SASBENCH_REPORT_REPORT_PARTS_H

#include <stdbool.h>

#include "files/csv.h"
#include "results/results.h"
#include "report/page.h"
#include "show/plot_points.h"

/* How many rows there are, which are the fastest, and which were refused, failed, are noisy or have warnings. */
void report_sentences_show(struct page *page, const struct results *results, int scene_count,
                           const char *const *scenes);
/* All scenes at a glance. */
void report_overview_show(struct page *page, const struct points *points, int scene_count);
/* A scene's chart, its front as a table, and the commands that measure the front again. Errors: as page_chart. */
struct families;
enum status report_front_show(struct page *page, const struct families *families, const struct points *points);
/* The same for each scene. */
enum status report_fronts_show(struct page *page, const struct points *points, int scene_count);
/* A row for each scene, a column for each power of ten of error that any setting reaches. `id`: of its heading; NULL:
   without one. */
void report_cheapest_show(struct page *page, const char *id, const struct results *results, const struct points *points,
                          int scene_count);

/* Each warning of a scene once, with its images; nothing without warnings. */
void report_warnings_show(struct page *page, const struct results *results);
/* Heading, and a folded table for each scene; below a row how its image was made. */
void report_measurements_show(struct page *page, const struct results *results, int scene_count,
                              const char *const *scenes);

struct pictures_count {
    int shown, left_out, irregular;
};

/* Does the file exist, and does the page have room for `growth` times its size? An existing file without room is
   counted. */
bool report_room(const struct page *page, const char *path, double growth, struct pictures_count *count);
/* A PNG of the folder. The JPEG file of the descriptor `small` (-1: none) takes its place and links to it. Errors:
   as page_image. */
enum status report_picture_show(struct page *page, const char *path, int small, const char *caption,
                                struct pictures_count *count);
/* Which pictures are not on the page, and why. */
void report_left_out_show(struct page *page, const struct pictures_count *count);

/* Slices and images of `run`, by scene. Errors: as page_image. */
enum status report_pictures_show(struct page *page, const char *directory, const struct results *results,
                                 int scene_count, const char *const *scenes);

enum { REPORT_COLUMNS = 13 };

/* A CSV file on the page. */
struct report_table {
    const char *file, *id, *title, *text;
    const char *group;                                         /* column whose values become headings, or NULL */
    void (*summary)(struct page *page, const struct csv *csv); /* for all groups, ahead of them; may be NULL */
    struct {
        const char *name, *title;
        enum { SHOW_TEXT, SHOW_NUMBER, SHOW_VERDICT, SHOW_ONCE } show; /* SHOW_ONCE: not repeated in the rows below */
    } columns[REPORT_COLUMNS];                                         /* title NULL ends */
};
enum { REPORT_TABLES = 8, REPORT_STABILITY = 7 };
extern const struct report_table report_tables[REPORT_TABLES];

/* The file in DIR, into a zeroed *csv, which stays zeroed without a file. Errors: as csv_read; STATUS_INVALID naming
   a missing column. */
enum status report_table_read(const char *directory, const struct report_table *table, struct csv *csv);
/* Heading, text and rows; nothing for a file without rows. */
void report_table_show(struct page *page, const struct report_table *table, const struct csv *csv);

#endif
