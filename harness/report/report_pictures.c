/* The pictures of a report (report_parts.h). */
#include "report/report_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <fcntl.h>
#include <unistd.h>

#include "files/paths.h"
#include "show/plot.h"
#include "report/report.h"
#include "show/plot_script.h"
#include "files/folder.h"

/* Thumbnails: total bytes in the page, shared by the scenes; their pixels; factor of pixels of slices. */
static const double BYTES_MOST = 2e6, PIXELS_LEAST = 1.2e4, PIXELS_MOST = 1e5, SLICES_LARGER = 2;

/* A thumbnail's bytes in the page, in base64, as measured between 1e4 and 1e5 pixels. */
static double thumbnail_bytes(double pixels)
{
    return 12.7e3 * pow(pixels / 1.05e4, 0.69);
}

static bool room_for(const struct page *page, const struct stat *info, double growth, struct pictures_count *count)
{
    const bool regular = S_ISREG(info->st_mode);
    const bool fits = (double)ftell(page->stream) + growth * (double)info->st_size <= REPORT_HTML_BYTES;
    count->irregular += !regular;
    count->left_out += regular && !fits;
    return regular && fits;
}

bool report_room(const struct page *page, const char *path, double growth, struct pictures_count *count)
{
    struct stat info; /* missing: pictures not drawn, a sweep's images, a run without gnuplot */
    return lstat(path, &info) == 0 && room_for(page, &info, growth, count);
}

enum status report_picture_show(struct page *page, const char *path, int small, const char *caption,
                                struct pictures_count *count)
{
    const char *name = strrchr(path, '/');
    struct stat info;
    if ((small < 0 ? lstat(path, &info) : fstat(small, &info)) != 0 || !room_for(page, &info, 4.0 / 3, count))
        return STATUS_OK;
    count->shown++;
    return small >= 0 ? page_thumbnail(page, small, name ? name + 1 : path, caption) : page_image(page, path, caption);
}

void report_left_out_show(struct page *page, const struct pictures_count *count)
{
    char caption[300];
    if (count->irregular) {
        snprintf(caption, sizeof caption,
                 "%d %s left out: links, folders or pipes; only regular files of the folder itself are shown.",
                 count->irregular, count->irregular == 1 ? "picture is" : "pictures are");
        page_paragraph(page, caption);
    }
    if (count->left_out) {
        snprintf(caption, sizeof caption,
                 "%d pictures are left out to keep this page below %d MB; they lie beside "
                 "it.",
                 count->left_out, REPORT_HTML_BYTES >> 20);
        page_paragraph(page, caption);
    }
}

/* --- Small copies, by gnuplot: plots/thumbnails.gp --- */

enum { THUMBNAILS_MOST = 64 }; /* of one set; further pictures have no thumbnail */

/* A set in the making: thumbnails_add each picture, thumbnails_draw, use them, thumbnails_end. */
struct thumbnails {
    struct plot plot; /* behind its preamble, the files are the thumbnails */
    int count;
    int sources[THUMBNAILS_MOST]; /* [count] descriptors */
};

enum { SIDE_MOST = 6000 }; /* limit of a picture's sides, pixels */

/* Pictures whose thumbnail cannot be made have none. */
static void thumbnails_begin(struct thumbnails *thumbnails)
{
    static const char *const arrays[] = {"sources",       "outputs",     "source_width",
                                         "source_height", "small_width", "small_height"};
    *thumbnails = (struct thumbnails){.count = 0};
    if (plot_begin(&thumbnails->plot, "thumbnails", false) != STATUS_OK)
        return;
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        plot_array(thumbnails->plot.preamble, arrays[k], THUMBNAILS_MOST);
}

static void thumbnails_end(struct thumbnails *thumbnails)
{
    plot_end(&thumbnails->plot);
    for (int k = 0; k < thumbnails->count; k++)
        close(thumbnails->sources[k]);
    *thumbnails = (struct thumbnails){.count = 0};
}

/* Width and height of a PNG file, from its first bytes; false for other files. */
static bool size_read(int file, int size[2])
{
    static const char head[] = "\x89PNG\r\n\x1a\n";
    unsigned char bytes[24];
    struct stat info;
    if (fstat(file, &info) != 0 || !S_ISREG(info.st_mode) || pread(file, bytes, sizeof bytes, 0) != sizeof bytes
        || memcmp(bytes, head, sizeof head - 1) != 0)
        return false;
    for (int k = 0; k < 2; k++) {
        const unsigned char *at = bytes + 16 + 4 * k;
        size[k] = at[0] || at[1] ? SIDE_MOST + 1 : at[2] << 8 | at[3];
    }
    return size[0] > 0 && size[1] > 0 && size[0] <= SIDE_MOST && size[1] <= SIDE_MOST;
}

/* A PNG file, of about so many `pixels` when it is small. Returns its number, -1 where the file is no PNG picture of a
   usual size. */
static int thumbnails_add(struct thumbnails *thumbnails, const char *path, double pixels)
{
    FILE *preamble = thumbnails->plot.preamble, *output;
    int size[2], number = thumbnails->count;
    char source[PLOT_NAME];
    const int file = preamble && number < THUMBNAILS_MOST ? place_read(path, O_NOFOLLOW | O_NONBLOCK) : -1;
    if (file < 0 || !size_read(file, size)
        || plot_file_open(&thumbnails->plot, "outputs", number, &output) != STATUS_OK) {
        if (file >= 0)
            close(file);
        return -1;
    }
    const double scale = fmin(1, sqrt(pixels / size[0] / size[1]));
    const int width = (int)fmax(1, size[0] * scale), height = (int)fmax(1, size[1] * scale);
    plot_file_name(file, source);
    plot_array_write(preamble, "sources", number, source);
    fprintf(preamble, "source_width[%d] = %d; source_height[%d] = %d\n", number + 1, size[0], number + 1, size[1]);
    fprintf(preamble, "small_width[%d] = %d; small_height[%d] = %d\n", number + 1, width, number + 1, height);
    thumbnails->sources[number] = file;
    return thumbnails->count++;
}

static void thumbnails_draw(struct thumbnails *thumbnails, const char *plots_directory)
{
    if (thumbnails->count == 0)
        return;
    fprintf(thumbnails->plot.preamble, "thumbnails = %d\n", thumbnails->count);
    (void)plot_run(&thumbnails->plot, plots_directory, "thumbnails.gp"); /* those before a faulty one stay */
}

/* The descriptor of a thumbnail's file; -1 without one. */
static int thumbnails_file(const struct thumbnails *thumbnails, int number)
{
    struct stat info;
    const int file = number < 0 ? -1 : fileno(thumbnails->plot.files[1 + number]);
    return fstat(file, &info) == 0 && info.st_size > 0 ? file : -1;
}

/* --- Scenes --- */

/* The pictures of one scene: slices first, then the images in the order of the rows. */
struct picture {
    char path[4096], caption[1200];
    int thumbnail;
};

/* Errors: STATUS_FAILED without memory; *list is to be freed. */
static enum status pictures_find(const char *directory, const struct results *results, const char *scene,
                                 struct picture **list, int *count)
{
    char name[700], label[600];
    *count = 1;
    *list = calloc((size_t)results->csv.row_count + 1, sizeof **list);
    if (!*list)
        return status_set(STATUS_FAILED, "%s: no memory for the pictures of %d rows", directory,
                          results->csv.row_count);
    picture_path(directory, scene, "slices.png", (*list)->path, sizeof(*list)->path);
    snprintf((*list)->caption, sizeof(*list)->caption, "%s: azimuth slices", scene);
    for (int row = 0; row < results->csv.row_count; row++) {
        const struct measurement *measured = &results->measurements[row];
        struct picture *picture = &(*list)[*count];
        if (strcmp(measured->scene, scene) != 0 || strcmp(measured->status, "ok") != 0)
            continue;
        picture_label(measured->algorithm, measured->options, measured->precision, label, sizeof label);
        snprintf(name, sizeof name, "%s.png", label);
        picture_path(directory, scene, name, picture->path, sizeof picture->path);
        snprintf(picture->caption, sizeof picture->caption, "%s: %s", scene, label);
        ++*count;
    }
    return STATUS_OK;
}

/* The size of a scene's thumbnails within its share of the bytes, and the number of images that have one. */
static int thumbnails_choose(double share, int images, double *pixels)
{
    *pixels = PIXELS_MOST;
    while (*pixels > PIXELS_LEAST
           && thumbnail_bytes(SLICES_LARGER * *pixels) + images * thumbnail_bytes(*pixels) > share)
        *pixels /= 1.05;
    const int fit = (int)((share - thumbnail_bytes(SLICES_LARGER * *pixels)) / thumbnail_bytes(*pixels));
    const int most = images < THUMBNAILS_MOST ? images : THUMBNAILS_MOST - 1;
    return fit < 1 ? 1 : fit < most ? fit : most;
}

/* Images without room for a thumbnail, as links. */
static void links_show(struct page *page, const struct picture *list, int count)
{
    int shown = 0;
    struct stat info;
    for (int k = 0; k < count; k++)
        if (lstat(list[k].path, &info) == 0 && S_ISREG(info.st_mode)) {
            fputs(shown++ ? ", " : "<p>Beside this page: ", page->stream);
            page_file(page, strrchr(list[k].path, '/') + 1, list[k].caption);
        }
    fputs(shown ? "</p>\n" : "", page->stream);
}

static enum status scene_show(struct page *page, struct picture *list, int list_count, double share,
                              struct pictures_count *count)
{
    struct thumbnails thumbnails;
    double pixels;
    const int shown = 1 + thumbnails_choose(share, list_count - 1, &pixels);
    enum status status = STATUS_OK;
    thumbnails_begin(&thumbnails);
    for (int k = 0; k < list_count && k < shown; k++)
        list[k].thumbnail = thumbnails_add(&thumbnails, list[k].path, k ? pixels : SLICES_LARGER * pixels);
    thumbnails_draw(&thumbnails, data_path(DATA_PLOTS));
    for (int k = 0; k < list_count && k < shown && status == STATUS_OK; k++) {
        const int small = thumbnails_file(&thumbnails, list[k].thumbnail);
        if (k == 1)
            fputs("<div class=\"gallery\">\n", page->stream);
        status = report_picture_show(page, list[k].path, small, list[k].caption, count);
    }
    if (list_count > 1)
        fputs("</div>\n", page->stream);
    if (shown < list_count)
        links_show(page, list + shown, list_count - shown);
    thumbnails_end(&thumbnails);
    return status;
}

enum status report_pictures_show(struct page *page, const char *directory, const struct results *results,
                                 int scene_count, const char *const *scenes)
{
    enum status status = STATUS_OK;
    struct pictures_count count = {0};
    page_heading(page, 2, "images", "Slices and images");
    page_paragraph(page, "Each links to its full size, which lies beside this page.");
    for (int s = 0; s < scene_count && status == STATUS_OK; s++) {
        struct picture *list;
        int list_count;
        status = pictures_find(directory, results, scenes[s], &list, &list_count);
        page_part_begin(page, scenes[s]);
        if (status == STATUS_OK)
            status = scene_show(page, list, list_count, BYTES_MOST / scene_count, &count);
        page_part_end(page);
        free(list);
    }
    if (count.shown == 0)
        page_paragraph(page, "None in this folder: `run` draws them, `sweep` does not.");
    report_left_out_show(page, &count);
    return status;
}
