/* Variables of version 7.3 files that are made at their full size and written later, in their place. */
#include <errno.h>
#include <fcntl.h>
#include <hdf5.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "echoes/matvar.h"

enum { HEADS_MOST = 1 << 16 }; /* bytes that HDF5 adds around the numbers, at most */

/* Of its numbers: MATLAB's complex ones, or codes of text. */
static hid_t set_type(const struct set73 *set)
{
    const bool is_double = set->precision == PRECISION_DOUBLE;
    const hid_t part = is_double ? H5T_NATIVE_DOUBLE : H5T_NATIVE_FLOAT;
    const size_t size = precision_size(set->precision);
    if (set->is_text)
        return H5Tcopy(H5T_NATIVE_UINT16);
    const hid_t type = H5Tcreate(H5T_COMPOUND, size);
    H5Tinsert(type, "real", 0, part);
    H5Tinsert(type, "imag", size / 2, part);
    return type;
}

static bool attribute_write(hid_t id, const char *name, hid_t type, const void *value)
{
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t attribute = H5Acreate2(id, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    const bool written = attribute >= 0 && H5Awrite(attribute, type, value) >= 0;
    H5Aclose(attribute);
    H5Sclose(space);
    return written;
}

static bool class_write(hid_t id, const struct set73 *set)
{
    const char *class = set->is_text ? "char" : set->precision == PRECISION_DOUBLE ? "double" : "single";
    const int decode = 2; /* MATLAB's text is of codes of two bytes */
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, strlen(class));
    const bool written = attribute_write(id, "MATLAB_class", type, class)
                         && (!set->is_text || attribute_write(id, "MATLAB_int_decode", H5T_NATIVE_INT, &decode));
    H5Tclose(type);
    return written;
}

static hsize_t dims_fill(const struct set73 *set, hsize_t dims[3])
{
    hsize_t count = 1;
    for (int k = 0; k < set->rank; k++)
        count *= dims[k] = set->dims[k];
    return count;
}

/* Take the room at once: a full disk is found before the work, and before HDF5, which crashes there. */
static bool room_take(int descriptor, hsize_t bytes)
{
    struct stat file;
    if (fstat(descriptor, &file) != 0)
        return false;
    errno = posix_fallocate(descriptor, 0, file.st_size + (off_t)bytes + HEADS_MOST);
    return errno == 0;
}

bool set73_make(const char *path, int descriptor, const struct set73 *set)
{
    hsize_t dims[3];
    if (!room_take(descriptor, dims_fill(set, dims) * precision_size(set->precision)))
        return false;
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), type = set_type(set);
    const hid_t space = H5Screate_simple(set->rank, dims, NULL), settings = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_layout(settings, H5D_CONTIGUOUS);
    H5Pset_alloc_time(settings, H5D_ALLOC_TIME_EARLY);
    H5Pset_fill_time(settings, H5D_FILL_TIME_NEVER);
    const hid_t id = H5Dcreate2(file, set->name, type, space, H5P_DEFAULT, settings, H5P_DEFAULT);
    bool made = id >= 0 && class_write(id, set);
    H5Dclose(id);
    made = H5Fclose(file) >= 0 && made;
    H5Pclose(settings);
    H5Sclose(space);
    H5Tclose(type);
    return made;
}

off_t set73_find(const char *path, const struct set73 *set)
{
    hsize_t dims[3];
    const hsize_t count = dims_fill(set, dims);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT), wanted = set_type(set);
    const hid_t id = H5Dopen2(file, set->name, H5P_DEFAULT), type = H5Dget_type(id), space = H5Dget_space(id);
    const haddr_t offset = H5Dget_offset(id);
    const bool fits = id >= 0 && offset != HADDR_UNDEF && H5Tequal(type, wanted) > 0
                      && H5Sget_simple_extent_npoints(space) == (hssize_t)count;
    H5Sclose(space);
    H5Tclose(type);
    H5Dclose(id);
    H5Tclose(wanted);
    H5Fclose(file);
    return fits ? (off_t)offset : -1;
}

bool write_at(int descriptor, const void *data, size_t size, off_t at)
{
    for (const char *next = data; size > 0;) {
        const ssize_t written = pwrite(descriptor, next, size, at);
        if (written <= 0 && errno != EINTR)
            return false;
        if (written > 0) {
            next += written;
            at += written;
            size -= (size_t)written;
        }
    }
    return true;
}
