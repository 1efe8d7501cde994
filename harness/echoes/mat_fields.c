/* Fields of HDF5 files that MATLAB need not have written: data sets of numbers, named by their path. */
#include <hdf5.h>
#include <matio.h>
#include <stdlib.h>
#include <string.h>

#include "echoes/matread.h"

/* HDF5 must not be asked for a path whose groups are not there. */
static bool path_is_there(hid_t file, const char *name)
{
    char part[200];
    bool there = strlen(name) < sizeof part;
    for (size_t end = 0; there && name[end]; end += name[end] == '/') {
        end += strcspn(name + end, "/");
        memcpy(part, name, end);
        part[end] = '\0';
        there = H5Lexists(file, part, H5P_DEFAULT) > 0;
    }
    return there && H5Oexists_by_name(file, name, H5P_DEFAULT) > 0;
}

/* Its shape in MATLAB's order, as libmatio would describe it; false where it is no array of numbers. */
static bool set_describe(hid_t set, matvar_t *matvar, size_t dims[H5S_MAX_RANK])
{
    hsize_t found[H5S_MAX_RANK];
    const hid_t type = H5Dget_type(set), space = H5Dget_space(set);
    const H5T_class_t class = H5Tget_class(type);
    const int rank = H5Sget_simple_extent_ndims(space);
    bool is_numbers = class == H5T_INTEGER || class == H5T_FLOAT;
    if (class == H5T_COMPOUND)
        is_numbers = H5Tget_nmembers(type) == 2 && H5Tget_member_index(type, "real") >= 0
                     && H5Tget_member_index(type, "imag") >= 0;
    is_numbers = is_numbers && rank >= 0 && H5Sget_simple_extent_dims(space, found, NULL) == rank;
    for (int k = 0; is_numbers && k < rank; k++)
        dims[k] = found[rank - 1 - k];
    const bool is_single = H5Tget_size(type) == sizeof(float) * (class == H5T_COMPOUND ? 2 : 1);
    *matvar = (matvar_t){.rank = rank, .dims = dims, .isComplex = class == H5T_COMPOUND};
    matvar->class_type = is_single && class != H5T_INTEGER ? MAT_C_SINGLE : MAT_C_DOUBLE;
    H5Sclose(space);
    H5Tclose(type);
    return is_numbers;
}

static enum status field_send(const char *path, const struct wanted *wanted, int index, hid_t set, size_t file_size,
                              int descriptor)
{
    const char *name = wanted[index].name, *accepted = wanted[index].accepted;
    size_t dims[H5S_MAX_RANK];
    matvar_t matvar;
    struct packet packet;
    memset(&packet, 0, sizeof packet);
    packet.index = index;
    packet.precision = PRECISION_DOUBLE;
    if (set < 0 || !set_describe(set, &matvar, dims))
        return status_set(STATUS_INVALID, "%s: variable `%s` is no array of numbers; %s is needed", path, name,
                          accepted);
    enum status status = check_claim(path, &wanted[index], &matvar, file_size, &packet.variable);
    const size_t count = variable_count(&packet.variable);
    const struct stored stored = {name, count, packet.variable.is_complex, false};
    if (status == STATUS_OK && (count == 0 || H5Aexists(set, "MATLAB_empty") > 0))
        return status_set(STATUS_INVALID, "%s: variable `%s` is empty; %s is needed", path, name, accepted);
    if (status == STATUS_OK)
        status = mat73_check(path, &stored);
    if (status != STATUS_OK)
        return status;
    if (wanted[index].pings) /* its dimensions alone */
        return write_fully(descriptor, &packet, sizeof packet) ? STATUS_OK
                                                               : status_set(STATUS_FAILED, "%s: nobody reads on", path);
    double complex *values = malloc(count * sizeof *values);
    if (!values || !mat73_read(path, &stored, values))
        status =
            status_set(STATUS_INVALID, "%s: variable `%s` is damaged or cut short; a whole file is needed", path, name);
    else if (!write_fully(descriptor, &packet, sizeof packet)
             || !write_fully(descriptor, values, count * sizeof *values))
        status = status_set(STATUS_FAILED, "%s: nobody reads on", path);
    free(values);
    return status;
}

enum status hdf5_fields_send(const char *path, const struct wanted *wanted, int count, size_t file_size, int descriptor)
{
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    enum status status =
        file >= 0 ? STATUS_OK
                  : status_set(STATUS_INVALID, "%s: is cut short or damaged; a whole HDF5 file is needed", path);
    for (int k = 0; k < count && status == STATUS_OK; k++)
        if (path_is_there(file, wanted[k].name))
            status = field_send(path, wanted, k, H5Dopen2(file, wanted[k].name, H5P_DEFAULT), file_size, descriptor);
    return status;
}
