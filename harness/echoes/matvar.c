/* Variables of MATLAB files once they are read (matvar.h). */
#include "echoes/matvar.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

size_t variable_count(const struct variable *variable)
{
    const size_t *dims = variable->dims;
    return size_product(size_product(dims[0], dims[1], dims[2], 1), dims[3], dims[4], 1);
}

bool variable_has_shape(const struct variable *variable, size_t rows, size_t columns, size_t pages)
{
    return variable->dims[0] == rows && variable->dims[1] == columns && variable->dims[2] == pages
           && variable->dims[3] == 1 && variable->dims[4] == 1;
}

bool variable_is_vector(const struct variable *variable)
{
    return variable_has_shape(variable, 1, variable->dims[1], 1)
           || variable_has_shape(variable, variable->dims[0], 1, 1);
}

void variables_free(struct variable *variables, int count)
{
    for (int i = 0; i < count; i++) {
        free(variables[i].values);
    }
}

enum status storage_refuse(const char *path, const char *name, const char *part, size_t found, size_t needed)
{
    return status_set(STATUS_INVALID,
                      "%s: variable `%s` has %zu bytes%s, its dimensions need %zu; a whole file is needed", path, name,
                      found, part, needed);
}

const char *file_other_format(const char *path)
{
    static const struct {
        const char *begin, *text;
    } formats[] = {
        {"# Created by Octave", ": it is in Octave's text format; save -v7 FILE.mat writes MATLAB's"},
        {"Octave-1-", ": it is in Octave's binary format; save -v7 FILE.mat writes MATLAB's"},
        {"\x93NUMPY", ": it is a NumPy array; scipy.io.savemat writes MATLAB files"},
        {"PK", ": it is a zip archive (NumPy's .npz?); scipy.io.savemat writes MATLAB files"},
        {"\x89HDF", ": it is HDF5 without MATLAB's head; save -v7.3 (MATLAB) or save -v7 (Octave) writes it"},
    };
    char begin[32] = "";
    FILE *file = fopen(path, "rb");
    if (file) {
        begin[fread(begin, 1, sizeof begin - 1, file)] = '\0';
        fclose(file);
    }
    for (size_t k = 0; k < sizeof formats / sizeof *formats; k++) {
        if (strncmp(begin, formats[k].begin, strlen(formats[k].begin)) == 0) {
            return formats[k].text;
        }
    }
    return "; save -v7 writes one (MATLAB, Octave), and scipy.io.savemat";
}

enum status variables_check(const char *path, const struct wanted *wanted, int count, const struct variable *variables)
{
    for (int i = 0; i < count; i++) {
        const struct variable *variable = &variables[i];
        if (variable->dims[0] == 0) {
            if (!wanted[i].is_optional) {
                return status_set(STATUS_INVALID, "%s: variable `%s` is missing; %s is needed", path, wanted[i].name,
                                  wanted[i].accepted);
            }
            continue;
        }
        if (variable->is_complex && wanted[i].kind != KIND_COMPLEX) {
            return status_set(STATUS_INVALID, "%s: variable `%s` is complex; %s is needed", path, wanted[i].name,
                              wanted[i].accepted);
        }
        if (wanted[i].kind == KIND_SCALAR && variable_count(variable) != 1) {
            return status_set(STATUS_INVALID, "%s: variable `%s` is [%zu x %zu x %zu]; %s is needed", path,
                              wanted[i].name, variable->dims[0], variable->dims[1], variable->dims[2],
                              wanted[i].accepted);
        }
    }
    return STATUS_OK;
}

enum status positions_check(const char *path, const char *name, const struct variable *positions, double wavelength)
{
    double farthest = 0;
    for (size_t i = 0; positions->is_single && i < variable_count(positions); i++) {
        farthest = fmax(farthest, fabs(creal(positions->values[i])));
    }
    const double raster = farthest > 0 ? ldexp(1, ilogb(farthest) - 23) : 0;
    if (50 * raster > wavelength) {
        return status_set(
            STATUS_INVALID,
            "%s: variable `%s` is of class single, whose values at %.7g m lie %.3g wavelengths apart; class "
            "double is needed, or a nearer origin, so that these are at most 0.02",
            path, name, farthest, raster / wavelength);
    }
    return STATUS_OK;
}

enum status variable_transpose(struct variable *variable)
{
    const size_t rows = variable->dims[0], columns = variable->dims[1],
                 bytes = rows * columns * sizeof *variable->values;
    double complex *turned = aligned_alloc(64, (bytes + 63) / 64 * 64);
    if (!turned) {
        return status_set(STATUS_FAILED, "out of memory for a variable of %zu bytes", bytes);
    }
    for (size_t i = 0; i < rows; i++) {
        for (size_t j = 0; j < columns; j++) {
            turned[i * columns + j] = variable->values[j * rows + i];
        }
    }
    free(variable->values);
    variable->values = turned;
    variable->dims[0] = columns;
    variable->dims[1] = rows;
    return STATUS_OK;
}

struct vector variable_vector(const struct variable *variable, size_t index)
{
    const double complex *v = variable->values + 3 * index;
    return (struct vector){creal(v[0]), creal(v[1]), creal(v[2])};
}
