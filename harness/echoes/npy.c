/* Images in the format of NumPy (npy.h): a text that describes the array, then its numbers. */
#include "echoes/npy.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { DESCRIPTION_MOST = 4096 };
#define ACCEPTED "an array of '<c8', '<c16', '<f4' or '<f8' of version 1 to 3 is needed"

struct array {
    char type;          /* c or f */
    int size;           /* bytes of a number */
    bool fortran;       /* the first index runs fastest */
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
    int length = 0;
    if (!type || !order || !shape)
        return false;
    array->fortran = strncmp(order, "True", 4) == 0;
    return sscanf(type, "'<%c%d'", &array->type, &array->size) == 2
           && ((array->type == 'c' && (array->size == 8 || array->size == 16))
               || (array->type == 'f' && (array->size == 4 || array->size == 8)))
           && sscanf(shape, "(%18lld ,%18lld )%n", &array->shape[0], &array->shape[1], &length) == 2 && length > 0;
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
    if (!known || count > DESCRIPTION_MOST || fread(text, 1, count, stream) != count
        || !description_parse(text, array)) {
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

static enum status numbers_read(FILE *stream, const char *path, const struct array *array, double complex *pixels)
{
    const size_t rows = (size_t)array->shape[0], columns = (size_t)array->shape[1], count = rows * columns;
    unsigned char bytes[16];
    for (size_t n = 0; n < count; n++) {
        if (fread(bytes, (size_t)array->size, 1, stream) != 1)
            return status_set(STATUS_INVALID, "%s: ends after %zu of %zu numbers", path, n, count);
        const double complex value = number(array, bytes);
        pixels[array->fortran ? n % rows * columns + n / rows : n] = value;
    }
    return STATUS_OK;
}

enum status npy_image_read(const char *path, const struct grid *grid, struct image_file *file)
{
    struct array array;
    *file = (struct image_file){.image.precision = PRECISION_DOUBLE, .origin = {.fc = NAN, .sound_speed = NAN}};
    struct stat place;
    FILE *stream = NULL;
    if (stat(path, &place) == 0 && !S_ISREG(place.st_mode))
        return status_set(STATUS_INVALID, "%s: not a file; " ACCEPTED, path);
    stream = fopen(path, "rbe");
    if (!stream)
        return status_set(STATUS_INVALID, "%s: cannot be opened: %s", path, strerror(errno));
    enum status status = head_read(stream, path, &array);
    if (status == STATUS_OK && (array.shape[0] != grid->r_count || array.shape[1] != grid->x_count))
        status = status_set(STATUS_INVALID,
                            "%s: the array is [%lld, %lld], the grid has %d ranges and %d places along "
                            "the track, in this order",
                            path, array.shape[0], array.shape[1], grid->r_count, grid->x_count);
    if (status == STATUS_OK) {
        const size_t pixels = (size_t)grid->r_count * (size_t)grid->x_count;
        file->patches = malloc(sizeof *file->patches);
        file->image.pixels = calloc(1, sizeof *file->image.pixels);
        file->image.patches = file->patches;
        if (file->patches && file->image.pixels) {
            file->image.patch_count = 1;
            *file->patches = *grid;
            file->image.pixels[0] = malloc(pixels * sizeof(double complex));
        }
        status = file->image.patch_count == 1 && file->image.pixels[0]
                     ? numbers_read(stream, path, &array, file->image.pixels[0])
                     : status_set(STATUS_FAILED, "%s: no memory for %zu pixels", path, pixels);
    }
    fclose(stream);
    if (status != STATUS_OK)
        image_file_close(file);
    return status;
}
