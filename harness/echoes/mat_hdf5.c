/* Reads as MATLAB's what other programs, h5py above all, write into HDF5 otherwise. */
#include <hdf5.h>
#include <string.h>

#include "echoes/matvar.h"

/* Texts of the same length keep their bytes, those of no fixed length become empty. The parameters are HDF5's. */
/* NOLINTNEXTLINE(readability-function-size) */
static herr_t text_convert(hid_t from, hid_t to, H5T_cdata_t *data, size_t count, size_t stride, size_t aside_stride,
                           void *texts, void *aside, hid_t properties)
{
    (void)aside_stride, (void)aside, (void)properties;
    const bool variable = H5Tis_variable_str(from) > 0;
    const size_t size = H5Tget_size(to);
    if (data->command == H5T_CONV_INIT)
        return H5Tis_variable_str(to) == 0 && (variable || H5Tget_size(from) == size) ? 0 : -1;
    for (size_t k = 0; data->command == H5T_CONV_CONV && variable && k < count; k++)
        memset((char *)texts + k * (stride ? stride : size), 0, size);
    return 0;
}

/* HDF5 itself cuts a letter off texts without a zero behind, and stops at those of no fixed length. */
static void texts_take(void)
{
    const hid_t fixed = H5Tcopy(H5T_C_S1), variable = H5Tcopy(H5T_C_S1);
    H5Tset_size(variable, H5T_VARIABLE);
    H5Tregister(H5T_PERS_SOFT, "texts", fixed, fixed, text_convert);
    H5Tregister(H5T_PERS_SOFT, "no texts", variable, fixed, text_convert);
    H5Tclose(fixed);
    H5Tclose(variable);
}

/* One reader at a time (matread.h). */
static H5E_auto2_t tell;
static void *tell_data;

void hdf5_begin(void)
{
    H5Eget_auto2(H5E_DEFAULT, &tell, &tell_data);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    texts_take();
}

void hdf5_end(void)
{
    H5Tunregister(H5T_PERS_DONTCARE, NULL, -1, -1, text_convert);
    H5Eset_auto2(H5E_DEFAULT, tell, tell_data);
}

/* Are a dataset's values, where they are complex, of members `real` and `imag`? */
static bool is_of_parts(hid_t file, const char *name)
{
    const hid_t set = H5Dopen2(file, name, H5P_DEFAULT), type = set >= 0 ? H5Dget_type(set) : -1;
    const bool compound = type >= 0 && H5Tget_class(type) == H5T_COMPOUND;
    const bool is = !compound || (H5Tget_member_index(type, "real") >= 0 && H5Tget_member_index(type, "imag") >= 0);
    if (type >= 0)
        H5Tclose(type);
    if (set >= 0)
        H5Dclose(set);
    return is;
}

enum status hdf5_prepare(const char *path, const struct wanted *wanted, int count)
{
    enum status status = STATUS_OK;
    const hid_t file = H5Fis_hdf5(path) > 0 ? H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT) : -1;
    for (int k = 0; file >= 0 && k < count && status == STATUS_OK; k++)
        if (H5Lexists(file, wanted[k].name, H5P_DEFAULT) > 0 && !is_of_parts(file, wanted[k].name))
            status = status_set(STATUS_INVALID,
                                "%s: variable `%s` is of complex numbers without members `real` and `imag`, MATLAB's "
                                "names for them; h5py: a dtype [('real', 'f8'), ('imag', 'f8')]",
                                path, wanted[k].name);
    if (file >= 0)
        H5Fclose(file);
    return status;
}
