/* MATLAB files variable by variable: the base of matfile.c. */
#ifndef SASBENCH_ECHOES_MATVAR_H
#define SASBENCH_ECHOES_MATVAR_H

#include <stdint.h>
#include <stdio.h>
#include <sys/types.h>

#include "echoes/echo_data.h"
#include "files/folder.h"

enum kind { KIND_TEXT, KIND_SCALAR, KIND_REAL, KIND_COMPLEX };

struct pings;
/* A variable that a file may or must have. A name "GROUP/.../NAME" is a field: of a struct in version 5, or a data set
   of any HDF5 file. A call asks for variables or for fields of numbers, not for both. */
struct wanted {
    const char *name;
    enum kind kind;
    bool is_optional;
    const char *accepted;      /* for messages: "X is needed" */
    const struct pings *pings; /* NULL: all of it is read; else these pings of [... x P], to a place of their own */
};

enum { WANTED_MAX = 20, DIMENSIONS_MOST = 5 };

/* A variable as read: complex doubles whatever its class, text as character codes, MATLAB's order. */
struct variable {
    bool is_complex, is_single; /* of MATLAB's class single */
    size_t
        dims[DIMENSIONS_MOST]; /* trailing dimensions of 1 filled in; more than 3 of fields alone; 0: not in the file */
    double complex *values;    /* 64-byte aligned, free(); NULL: not in the file, or read by pings */
};

/* Read the wanted variables of a file (count <= WANTED_MAX) into variables[count], freed with variables_free. Other
   variables are not read. Errors, with nothing to free: STATUS_INVALID naming file, variable and what is accepted, for
   every file that is not whole or lacks a needed one; STATUS_FAILED without memory. */
enum status variables_read(const char *path, const struct wanted *wanted, int count, struct variable *variables);
void variables_free(struct variable *variables, int count);
/* Check a variable by the table of wanted ones: there, real, a scalar. Errors: STATUS_INVALID. */
enum status variables_check(const char *path, const struct wanted *wanted, int count, const struct variable *variables);
/* Refuse number i of samples [dims], which is not finite. */
enum status samples_refuse(const char *path, const size_t dims[3], size_t i, double complex z);
/* Check the raster of positions of class single, which is coarser the farther they are from the origin, all in m.
   Errors: STATUS_INVALID where it is more than a fiftieth of a wavelength. */
enum status positions_check(const char *path, const char *name, const struct variable *positions, double wavelength);
/* Transpose [rows x columns] to [columns x rows]. Errors: STATUS_FAILED without memory. */
enum status variable_transpose(struct variable *variable);
/* Number `index` of vectors that follow one another, as in [3 x M x P]. */
struct vector variable_vector(const struct variable *variable, size_t index);
size_t variable_count(const struct variable *variable);
bool variable_is_vector(const struct variable *variable); /* a row or a column */
bool variable_has_shape(const struct variable *variable, size_t rows, size_t columns, size_t pages);

/* Around all that reads a file, one at a time: HDF5 prints nothing, and takes texts as hdf5_prepare needs them. */
void hdf5_begin(void);
void hdf5_end(void);
/* Let HDF5 read names of MATLAB's classes as h5py writes them. Names of no fixed length become empty: such a variable
   has no class, but it and all that follow are still listed. Errors: STATUS_INVALID for complex numbers whose parts are
   not `real` and `imag`, of which libmatio would read nothing, silently. */
enum status hdf5_prepare(const char *path, const struct wanted *wanted, int count);

/* Keep libmatio from printing: what matters is in the status message. */
void matio_silence(void);

/* Top-level elements of a version 5 file, one after the other by their stated lengths. */
struct mat5 {
    FILE *file;
    bool is_little_endian;
    uint32_t type, length;   /* of the element at hand */
    off_t first, next, size; /* where its data and what follows it begin; where the file ends */
};
/* False where there is none; what was opened is then closed. */
bool mat5_open(struct mat5 *file, const char *path);
bool mat5_next(struct mat5 *file);
void mat5_close(struct mat5 *file);

/* The number of variables in a version 5 file; -1 when their lengths do not end where the file does. libmatio takes a
   truncated file for one with fewer variables, and does not notice a full disk either. */
int mat5_count(const char *path);

/* A variable as libmatio takes it: it reads what the dimensions ask for, whether that is there or not. */
struct stored {
    const char *name;
    size_t count;
    bool is_complex, is_text;
};
/* Read the numbers of a data set's pings [first, end), of `each` numbers, as complex `precision`. In a process that
   ends soon. */
struct ping_run {
    size_t first, end, each;
};
bool mat73_read_pings(const char *path, const char *name, const struct pings *pings, const struct ping_run *run,
                      enum precision precision, void *values);
/* Are all its numbers in the file, in the element at hand (version 5), in a data set of this file (7.3)? Errors:
   STATUS_INVALID, with the length found and the one needed. */
enum status mat5_check(const char *path, const struct stored *stored, const struct mat5 *file);
enum status mat73_check(const char *path, const struct stored *stored);
/* Read all numbers of a data set as complex double; count of them. In a process that ends soon. */
bool mat73_read(const char *path, const struct stored *stored, double complex *values);
bool mat73_has(const char *path, const char *name);
/* For a file of no such version: what it probably is, and how to write a MATLAB file. */
const char *file_other_format(const char *path);
enum status storage_refuse(const char *path, const char *name, const char *part, size_t found, size_t needed);

/* A file that is being written. The first failure is kept, and later calls do nothing. So only writer_open (after whose
   failure the writer is not closed) and writer_close need checking. */
struct writer {
    const char *path;
    struct place place; /* of the file that a symbolic link stands for, or of `path` itself */
    struct made made;
    char temporary[64]; /* the path of what is made */
    struct _mat_t *mat;
    int count;  /* variables written */
    off_t room; /* bytes taken on the disk, in version 7.3 */
    enum status status;
    /* Adds to the file that libmatio has closed, before it gets its place; false: the status is set, or errno has the
       reason. NULL: none. */
    bool (*add)(struct writer *writer);
    void *with;
};

/* Both return the writer's status. Errors: STATUS_INVALID when the place cannot be written, STATUS_FAILED without
   memory. */
bool writer_fits_v5(size_t largest_variable_bytes);
enum status writer_open(struct writer *writer, const char *path, size_t largest_variable_bytes);
enum status writer_close(struct writer *writer);

void write_text(struct writer *writer, const char *name, const char *text);
void write_reals(struct writer *writer, const char *name, size_t rows, size_t columns, size_t pages,
                 const double *values);
/* Complex numbers, in memory row by row [rows][columns], as MATLAB's array `dims`, column by column. */
void write_complex(struct writer *writer, const char *name, const size_t dims[3], enum precision precision,
                   const void *values, size_t rows, size_t columns);

/* A variable of a version 7.3 file that lies in one place of it, contiguous: writing its numbers there leaves all else
   as it is. */
struct set73 {
    const char *name;
    bool is_text; /* else complex numbers */
    enum precision precision;
    int rank;
    size_t dims[3]; /* HDF5's order, the reverse of MATLAB's */
};
/* Add it, at its full size, to a file that is also open at `descriptor`. False: errno has the reason, or is 0. */
bool set73_make(const char *path, int descriptor, const struct set73 *set);
/* Where its numbers lie; -1: there is none, or another. */
off_t set73_find(const char *path, const struct set73 *set);
/* pwrite of all. False: errno has the reason. */
bool write_at(int descriptor, const void *data, size_t size, off_t at);

/* Write the notes, if there are any. */
struct echo_notes;
void echo_notes_write(struct writer *writer, const struct echo_notes *notes);
/* Write all of an echo file but its format and its samples. */
void acquisition_write(struct writer *writer, const struct acquisition *acquisition, const struct echo_notes *notes);
/* Write all of an image file but its pixels: a patch's axes, and the image's origin. */
struct image_origin;
void image_axes_write(struct writer *writer, const struct grid *grid, int patch);
void image_sayings_write(struct writer *writer, const struct image_origin *origin);

#endif
