/* Small copies of pictures (thumbnails.h), by gnuplot: plots/thumbnails.gp. */
#include "report/thumbnails.h"

#include <fcntl.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "files/folder.h"

enum { SIDE_MOST = 6000 }; /* limit of a picture's sides, pixels */

void thumbnails_begin(struct thumbnails *thumbnails)
{
    static const char *const arrays[] = {"sources",       "outputs",     "source_width",
                                         "source_height", "small_width", "small_height"};
    *thumbnails = (struct thumbnails){.count = 0};
    if (plot_begin(&thumbnails->plot, "thumbnails", false) != STATUS_OK)
        return;
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        plot_array(thumbnails->plot.preamble, arrays[k], THUMBNAILS_MOST);
}

void thumbnails_end(struct thumbnails *thumbnails)
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

int thumbnails_add(struct thumbnails *thumbnails, const char *path, double pixels)
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

void thumbnails_draw(struct thumbnails *thumbnails, const char *plots_directory)
{
    if (thumbnails->count == 0)
        return;
    fprintf(thumbnails->plot.preamble, "thumbnails = %d\n", thumbnails->count);
    (void)plot_run(&thumbnails->plot, plots_directory, "thumbnails.gp"); /* those before a faulty one stay */
}

int thumbnails_file(const struct thumbnails *thumbnails, int number)
{
    struct stat info;
    const int file = number < 0 ? -1 : fileno(thumbnails->plot.files[1 + number]);
    return fstat(file, &info) == 0 && info.st_size > 0 ? file : -1;
}
