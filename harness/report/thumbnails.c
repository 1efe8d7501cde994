/* Small copies of pictures (thumbnails.h), by gnuplot: plots/thumbnails.gp. */
#include "report/thumbnails.h"

#include <fcntl.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SIDE_MOST = 6000 }; /* pixels: of a picture that is read */

void thumbnails_begin(struct thumbnails *thumbnails, const char *beside)
{
    static const char *const arrays[] = {"sources",       "outputs",     "source_width",
                                         "source_height", "small_width", "small_height"};
    *thumbnails = (struct thumbnails){.count = 0};
    if (plot_begin(&thumbnails->plot, beside, false) != STATUS_OK) {
        thumbnails_end(thumbnails);
        return;
    }
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        plot_array(thumbnails->plot.preamble, arrays[k], THUMBNAILS_MOST);
}

void thumbnails_end(struct thumbnails *thumbnails)
{
    plot_end(&thumbnails->plot);
    *thumbnails = (struct thumbnails){.count = 0};
}

/* Width and height of a regular PNG file, from its first bytes; false for anything else. */
static bool size_read(const char *path, int size[2])
{
    static const char head[] = "\x89PNG\r\n\x1a\n";
    unsigned char bytes[24];
    struct stat info;
    const int file = place_read(path, O_NOFOLLOW | O_NONBLOCK);
    if (file < 0)
        return false;
    const bool read_whole =
        fstat(file, &info) == 0 && S_ISREG(info.st_mode) && read(file, bytes, sizeof bytes) == (ssize_t)sizeof bytes;
    close(file);
    if (!read_whole || memcmp(bytes, head, sizeof head - 1) != 0)
        return false;
    for (int k = 0; k < 2; k++) {
        const unsigned char *at = bytes + 16 + 4 * k;
        size[k] = at[0] || at[1] ? SIDE_MOST + 1 : at[2] << 8 | at[3];
    }
    return size[0] > 0 && size[1] > 0 && size[0] <= SIDE_MOST && size[1] <= SIDE_MOST;
}

int thumbnails_add(struct thumbnails *thumbnails, const char *path, double pixels)
{
    FILE *preamble = thumbnails->plot.preamble;
    int size[2], number = thumbnails->count;
    char output[32], source[NAME_MAX + 4];
    const char *slash = strrchr(path, '/');
    if (!preamble || number == THUMBNAILS_MOST || !size_read(path, size)
        || snprintf(source, sizeof source, "../%s", slash ? slash + 1 : path) >= (int)sizeof source)
        return -1;
    const double scale = fmin(1, sqrt(pixels / size[0] / size[1]));
    const int width = (int)fmax(1, size[0] * scale), height = (int)fmax(1, size[1] * scale);
    snprintf(output, sizeof output, "%d.jpg", number);
    temporary_inside(thumbnails->plot.directory, output);
    plot_array_write(preamble, "sources", number, source);
    plot_array_write(preamble, "outputs", number, output);
    fprintf(preamble, "source_width[%d] = %d; source_height[%d] = %d\n", number + 1, size[0], number + 1, size[1]);
    fprintf(preamble, "small_width[%d] = %d; small_height[%d] = %d\n", number + 1, width, number + 1, height);
    return thumbnails->count++;
}

void thumbnails_draw(struct thumbnails *thumbnails, const char *plots_directory)
{
    if (thumbnails->count == 0)
        return;
    fprintf(thumbnails->plot.preamble, "thumbnails = %d\n", thumbnails->count);
    (void)plot_run(&thumbnails->plot, plots_directory, "thumbnails.gp"); /* those before a faulty one are there */
}

bool thumbnails_path(const struct thumbnails *thumbnails, int number, char path[PATH_MAX])
{
    const struct plot *plot = &thumbnails->plot;
    const char *slash = strrchr(plot->path, '/');
    char name[32];
    struct stat info;
    snprintf(name, sizeof name, "%d.jpg", number);
    if (number < 0 || plot->directory < 0 || fstatat(plot->directory, name, &info, 0) != 0 || info.st_size == 0)
        return false;
    const int used = slash ? (int)(slash + 1 - plot->path) : 0;
    return snprintf(path, PATH_MAX, "%.*s%s/%s", used, plot->path, plot->made, name) < PATH_MAX;
}
