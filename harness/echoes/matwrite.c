/* Writing MATLAB files through libmatio: version 5, or 7.3 where that cannot hold a variable. */
#define _GNU_SOURCE /* fallocate */
#include "echoes/matfile.h"
#include "echoes/matvar.h"

#include <errno.h>
#include <fcntl.h>
#include <hdf5.h>
#include <matio.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define ACCEPTED "a new or regular file in a writable folder is needed"

static enum status write_failed(struct writer *writer)
{
    int reason = errno ? errno : EIO;
    return writer->status =
               status_set(STATUS_INVALID, "%s: cannot be written: %s; " ACCEPTED, writer->path, strerror(reason));
}

/* The place of a path, through symbolic links. */
static enum status place_find(const char *path, struct place *place)
{
    struct stat old;
    place->folder = -1;
    if (strlen(path) + NAME_MAX > PATH_MAX)
        return status_set(STATUS_INVALID, "%.100s...: cannot be written: path too long; " ACCEPTED, path);
    if (stat(path, &old) == 0 && !S_ISREG(old.st_mode))
        return status_set(STATUS_INVALID, "%s: cannot be written: it is not a regular file; " ACCEPTED, path);
    errno = ENOENT;
    if (*path && place_open(path, true, place) && faccessat(place->folder, ".", W_OK | X_OK, 0) == 0)
        return STATUS_OK;
    int reason = errno;
    place_close(place);
    return status_set(STATUS_INVALID, "%s: cannot be written: %s; " ACCEPTED, path, strerror(reason));
}

enum status matfile_place(const char *path)
{
    struct place place;
    enum status status = place_find(path, &place);
    place_close(&place);
    return status;
}

static void writer_end(struct writer *writer)
{
    place_drop(&writer->place, &writer->made);
    place_close(&writer->place);
}

/* Version 5 holds up to 2 GiB a variable. */
bool writer_fits_v5(size_t largest_variable_bytes)
{
    return largest_variable_bytes < ((size_t)1 << 31) - 4096;
}

/* HDF5 crashes on a full disk, also where it only closes a file: room for a variable, and for what HDF5 adds, is taken
   beforehand. A file system that cannot take it is as good as one with room. */
static bool room_take(struct writer *writer, size_t bytes)
{
    enum { HEADS_MOST = 1 << 14 };
    writer->room += (off_t)(bytes + HEADS_MOST);
    return fallocate(writer->made.descriptor, FALLOC_FL_KEEP_SIZE, 0, writer->room) == 0
           || (errno != ENOSPC && errno != EDQUOT);
}

enum status writer_open(struct writer *writer, const char *path, size_t largest_variable_bytes)
{
    *writer = (struct writer){.path = path};
    writer->status = place_find(path, &writer->place);
    if (writer->status != STATUS_OK)
        return writer->status;
    if (!place_make(&writer->place, &writer->made)) {
        write_failed(writer);
        place_close(&writer->place);
        return writer->status;
    }
    const bool fits_v5 = writer_fits_v5(largest_variable_bytes);
    if (!fits_v5)
        place_tidy(&writer->place);
    const bool named = !fits_v5 && place_name(&writer->place, &writer->made); /* HDF5 opens no file without a name */
    /* libmatio opens by name what is there already. */
    snprintf(writer->temporary, sizeof writer->temporary, "/proc/self/fd/%d%s%s",
             named ? writer->place.folder : writer->made.descriptor, named ? "/" : "", named ? writer->made.name : "");
    matio_silence();
    setenv("HDF5_USE_FILE_LOCKING", "FALSE", 0); /* the file is locked already, which NFS counts as another's */
    H5dont_atexit();                             /* its exit handler crashes after a full disk */
    errno = 0;
    if (fits_v5 || (named && room_take(writer, 0)))
        writer->mat = Mat_CreateVer(writer->temporary, NULL, fits_v5 ? MAT_FT_MAT5 : MAT_FT_MAT73);
    if (!writer->mat) {
        write_failed(writer);
        writer_end(writer);
    }
    return writer->status;
}

static void write_variable(struct writer *writer, const char *name, enum matio_classes class, enum matio_types type,
                           const size_t shape[3], void *data, int flags)
{
    if (writer->status != STATUS_OK) {
        return;
    }
    size_t dims[3] = {shape[0], shape[1], shape[2]};
    errno = 0;
    const bool is_v5 = Mat_GetVersion(writer->mat) == MAT_FT_MAT5;
    if (!is_v5 && !room_take(writer, dims[0] * dims[1] * dims[2] * sizeof(double complex))) {
        write_failed(writer);
        return;
    }
    matvar_t *matvar = Mat_VarCreate(name, class, type, dims[2] == 1 ? 2 : 3, dims, data, MAT_F_DONT_COPY_DATA | flags);
    /* Not packed: the numbers are noise to a packer, which would take longer than most images. */
    if (!matvar || Mat_VarWrite(writer->mat, matvar, MAT_COMPRESSION_NONE) != 0) {
        write_failed(writer);
    }
    Mat_VarFree(matvar);
    writer->count++;
}

void write_reals(struct writer *writer, const char *name, size_t rows, size_t columns, size_t pages,
                 const double *values)
{
    write_variable(writer, name, MAT_C_DOUBLE, MAT_T_DOUBLE, (size_t[]){rows, columns, pages}, (void *)values, 0);
}

void write_text(struct writer *writer, const char *name, const char *text)
{
    write_variable(writer, name, MAT_C_CHAR, MAT_T_UTF8, (size_t[]){strlen(text) > 0, strlen(text), 1}, (void *)text,
                   0);
}

/* libmatio needs real and imaginary parts apart. */
void write_complex(struct writer *writer, const char *name, const size_t dims[3], enum precision precision,
                   const void *values, size_t rows, size_t columns)
{
    size_t count = rows * columns, part_size = precision_size(precision) / 2;
    mat_complex_split_t parts = {malloc(count * part_size), malloc(count * part_size)};
    if (!parts.Re || !parts.Im) {
        writer->status = status_set(STATUS_FAILED, "%s: out of memory to write %zu numbers", writer->path, count);
    }
    for (size_t i = 0; writer->status == STATUS_OK && i < rows; i++) {
        for (size_t j = 0; j < columns; j++) {
            size_t from = i * columns + j, to = j * rows + i;
            if (precision == PRECISION_FLOAT) {
                ((float *)parts.Re)[to] = crealf(((const float complex *)values)[from]);
                ((float *)parts.Im)[to] = cimagf(((const float complex *)values)[from]);
            } else {
                ((double *)parts.Re)[to] = creal(((const double complex *)values)[from]);
                ((double *)parts.Im)[to] = cimag(((const double complex *)values)[from]);
            }
        }
    }
    bool is_float = precision == PRECISION_FLOAT;
    write_variable(writer, name, is_float ? MAT_C_SINGLE : MAT_C_DOUBLE, is_float ? MAT_T_SINGLE : MAT_T_DOUBLE, dims,
                   &parts, MAT_F_COMPLEX);
    free(parts.Re);
    free(parts.Im);
}

enum status writer_close(struct writer *writer)
{
    bool is_v5 = Mat_GetVersion(writer->mat) == MAT_FT_MAT5;
    errno = 0;
    if (Mat_Close(writer->mat) != 0 && writer->status == STATUS_OK) {
        write_failed(writer);
    }
    if (writer->status == STATUS_OK && is_v5 && mat5_count(writer->temporary) != writer->count) {
        errno = ENOSPC;
        write_failed(writer);
    }
    errno = 0;
    if (writer->status == STATUS_OK && writer->add && !writer->add(writer) && writer->status == STATUS_OK)
        write_failed(writer);
    if (writer->status == STATUS_OK
        && !(place_sync(writer->made.descriptor) && place_put(&writer->place, &writer->made)))
        write_failed(writer);
    writer_end(writer);
    return writer->status;
}
