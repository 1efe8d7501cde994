/* Images in the format of NumPy (npy.h): a text that describes the array, then its numbers. */
#include "echoes/npy.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { DESCRIPTION_MOST = 4096, BLOCK = 4096 };
#define ACCEPTED "an array of '<c8', '<c16', '<f4' or '<f8' of version 1 to 3 is needed"

struct array {
    char type;          /* c or f */
    int size;           /* bytes of a number */
    bool fortran;       /* the first index runs fastest */
    int dimensions;     /* 1 or 2 */
    long long shape[2]; /* rows, columns */
};

/* The text behind 'key': in the description; NULL where the key is missing. */
static const char *value_find(const char *description, const char *key)
{
    const char *at = strstr(description, key);
    at = at ? strchr(at + strlen(key), ':') : NULL;
    return at ? at + 1 + strspn(at + 1, " ") : NULL;
}

static bool description_parse(const char *text, struct array *array)
{
    const char *type = value_find(text, "'descr'"), *order = value_find(text, "'fortran_order'"),
               *shape = value_find(text, "'shape'");
    int length = 0, alone = 0;
    if (!type || !order || !shape)
        return false;
    array->fortran = strncmp(order, "True", 4) == 0;
    if (sscanf(shape, "(%18lld ,%n", &array->shape[0], &alone) == 1 && alone > 0 && shape[alone] == ')') {
        array->shape[1] = 1;
        array->dimensions = 1;
        length = alone;
    } else if (sscanf(shape, "(%18lld ,%18lld )%n", &array->shape[0], &array->shape[1], &length) == 2)
        array->dimensions = 2;
    return sscanf(type, "'<%c%d'", &array->type, &array->size) == 2
           && ((array->type == 'c' && (array->size == 8 || array->size == 16))
               || (array->type == 'f' && (array->size == 4 || array->size == 8)))
           && length > 0;
}

/* Magic, version, length of the description, description: the numbers follow. */
static enum status head_read(FILE *stream, const char *path, struct array *array)
{
    unsigned char head[8], length[4] = {0};
    char text[DESCRIPTION_MOST + 1] = "";
    if (fread(head, sizeof head, 1, stream) != 1 || memcmp(head, "\x93NUMPY", 6) != 0 || head[6] < 1 || head[6] > 3)
        return status_set(STATUS_INVALID, "%s: not an .npy file; " ACCEPTED, path);
    const size_t bytes = head[6] == 1 ? 2 : 4;
    const bool known = fread(length, bytes, 1, stream) == 1;
    const uint32_t count = length[0] | (uint32_t)length[1] << 8 | (uint32_t)length[2] << 16 | (uint32_t)length[3] << 24;
    if (!known || (count <= DESCRIPTION_MOST && fread(text, 1, count, stream) != count))
        return status_set(STATUS_INVALID, "%s: its head is cut off; " ACCEPTED, path);
    if (count > DESCRIPTION_MOST || !description_parse(text, array)) {
        const int shown = (int)fmin((double)strcspn(text, "}"), 120) + 1; /* blanks fill the rest */
        return status_set(STATUS_INVALID, "%s: its array is %.*s; " ACCEPTED ", with two dimensions", path, shown,
                          text);
    }
    return STATUS_OK;
}

static double complex number(const struct array *array, const unsigned char *from)
{
    float single[2] = {0};
    double both[2] = {0};
    if (array->size == (array->type == 'c' ? 16 : 8))
        memcpy(both, from, (size_t)array->size);
    else {
        memcpy(single, from, (size_t)array->size);
        both[0] = single[0];
        both[1] = single[1];
    }
    double complex value;
    memcpy(&value, both, sizeof value);
    return value;
}

static void pixel_set(const struct image *image, int patch, size_t n, double complex value)
{
    if (image->precision == PRECISION_DOUBLE)
        ((double complex *)image->pixels[patch])[n] = value;
    else
        ((float complex *)image->pixels[patch])[n] = (float complex)value;
}

/* By blocks into one patch, whose pixels begin at number `before` of `all`. */
static enum status numbers_read(FILE *stream, const char *path, const struct array *array, const struct image *image,
                                int patch, size_t before, size_t all)
{
    const struct grid *grid = &image->patches[patch];
    const size_t rows = (size_t)grid->r_count, columns = (size_t)grid->x_count, count = rows * columns;
    unsigned char bytes[BLOCK * 16];
    for (size_t first = 0; first < count; first += BLOCK) {
        const size_t wanted = count - first < BLOCK ? count - first : BLOCK;
        const size_t found = fread(bytes, (size_t)array->size, wanted, stream);
        for (size_t k = 0; k < found; k++) {
            const size_t n = first + k;
            pixel_set(image, patch, array->fortran && array->dimensions == 2 ? n % rows * columns + n / rows : n,
                      number(array, bytes + k * (size_t)array->size));
        }
        if (found < wanted)
            return status_set(STATUS_INVALID, "%s: ends after %zu of %zu numbers", path, before + first + found, all);
    }
    return STATUS_OK;
}

enum status npy_pixels_read(FILE *stream, const char *path, const struct image *image)
{
    struct array array;
    const struct grid *grid = image->patches;
    size_t all = 0, before = 0;
    for (int k = 0; k < image->patch_count; k++)
        all += grid_pixels(&grid[k]);
    enum status status = head_read(stream, path, &array);
    if (status != STATUS_OK)
        return status;
    const bool whole = array.dimensions == 1 && array.shape[0] == (long long)all;
    if (!whole
        && (image->patch_count > 1 || array.dimensions == 1 || array.shape[0] != grid->r_count
            || array.shape[1] != grid->x_count)) {
        char shape[60];
        snprintf(shape, sizeof shape, array.dimensions == 1 ? "[%lld]" : "[%lld, %lld]", array.shape[0],
                 array.shape[1]);
        if (image->patch_count > 1)
            return status_set(STATUS_INVALID, "%s: the array is %s, the patches have [%zu] pixels", path, shape, all);
        return status_set(STATUS_INVALID,
                          "%s: the array is %s, the grid has %d ranges and %d places along the track, in this order",
                          path, shape, grid->r_count, grid->x_count);
    }
    for (int k = 0; k < image->patch_count && status == STATUS_OK; k++) {
        status = numbers_read(stream, path, &array, image, k, before, all);
        before += grid_pixels(&grid[k]);
    }
    return status;
}

enum status npy_image_read(const char *path, const struct grid *grid, struct image_file *file)
{
    *file = (struct image_file){.image.precision = PRECISION_DOUBLE, .origin = {.fc = NAN, .sound_speed = NAN}};
    struct stat place;
    if (stat(path, &place) == 0 && !S_ISREG(place.st_mode))
        return status_set(STATUS_INVALID, "%s: not a file; " ACCEPTED, path);
    FILE *stream = fopen(path, "rbe");
    if (!stream)
        return status_set(STATUS_INVALID, "%s: cannot be opened: %s", path, strerror(errno));
    file->patches = malloc(sizeof *file->patches);
    if (file->patches)
        *file->patches = *grid;
    enum status status = file->patches ? image_allocate(1, file->patches, PRECISION_DOUBLE, &file->image)
                                       : status_set(STATUS_FAILED, "%s: no memory for its grid", path);
    if (status == STATUS_OK)
        status = npy_pixels_read(stream, path, &file->image);
    fclose(stream);
    if (status != STATUS_OK)
        image_file_close(file);
    return status;
}
