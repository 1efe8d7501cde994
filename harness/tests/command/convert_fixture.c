/* What the tests of `convert` share (convert_fixture.h). */
#include "tests/command/convert_fixture.h"

#include <hdf5.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "convert/layouts.h"

double pixel_x(const struct raster *raster, int pixel)
{
    return raster->x + raster->step * (pixel % GRID);
}

double pixel_r(const struct raster *raster, int pixel)
{
    return raster->r + raster->step * (pixel / GRID);
}

void assert_image(const char *echoes, const struct raster *raster, const double complex *wanted)
{
    char text[100];
    const char *const image[ARGUMENTS_MAX] = {
        "image", "--echoes", echoes, "--grid", text, "-a", "reference:precision=double", "-o", "image.mat"};
    struct grid grid;
    double complex *pixels;
    double error = 0, energy = 0;
    snprintf(text, sizeof text, "%g:%g:%d,%g:%g:%d", raster->x, raster->step, GRID, raster->r, raster->step, GRID);
    free(program_output(image));
    assert_int_equal(image_file_read(path_in("image.mat"), &grid, &pixels), STATUS_OK);
    assert_int_equal(grid.x_count * grid.r_count, GRID * GRID);
    for (int k = 0; k < GRID * GRID; k++) {
        error += pow(cabs(pixels[k] - wanted[k]), 2);
        energy += pow(cabs(wanted[k]), 2);
    }
    free(pixels);
    print_message("%s: error %.2g\n", echoes, sqrt(error / energy));
    if (!(error <= 1e-6 * energy))
        fail_msg("%s: error %g, at most 1e-3 is accepted", echoes, sqrt(error / energy));
}

void assert_field_refused(const char *good, const char *bad, const char *field, const char *reason)
{
    char paths[2][600], begin[700];
    const char *const both[] = {paths[0], paths[1]};
    struct recording recording;
    snprintf(paths[0], sizeof *paths, "%s", path_in(good ? good : bad));
    snprintf(paths[1], sizeof *paths, "%s", path_in(bad));
    snprintf(begin, sizeof begin, "%s: variable `%s", paths[1], field);
    const enum status status = recording_read(both, good ? 2 : 1, &recording);
    if (status != STATUS_INVALID || strncmp(status_message(), begin, strlen(begin)) != 0
        || !strstr(status_message(), reason) || strchr(status_message(), '\n'))
        fail_msg("status %d, '%s', not '%s ... %s'", status, status_message(), begin, reason);
}

void assert_converted(const char *file, const char *told, const struct raster *raster, const double complex *wanted)
{
    const char *const convert[ARGUMENTS_MAX] = {"convert", file, "-o", "echo.mat"};
    char begin[200];
    snprintf(begin, sizeof begin, "echo.mat: %s", told);
    char *says = program_output(convert);
    if (strncmp(says, begin, strlen(begin)) != 0)
        fail_msg("'%s', not '%s'", says, begin);
    free(says);
    assert_image("echo.mat", raster, wanted);
}

void record_add(const double complex *record, int count, bool is_real, const double *delays, double turns,
                double complex *image)
{
    for (int k = is_real ? 1 : -count / 2; k < count / 2; k++) {
        double complex line = 0;
        for (int n = 0; n < count; n++)
            line += (is_real ? 2 : 1) * record[n] * cexp(-2 * M_PI * I * ((double)(k * n % count) / count)) / count;
        for (int i = 0; i < GRID * GRID; i++)
            image[i] += line * cexp(2 * M_PI * I * ((double)k / count + turns) * delays[i]);
    }
}

void sets_write(const char *name, const struct set *sets, size_t count, const char *left_out)
{
    const hid_t file = H5Fcreate(path_in(name), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t links = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    for (size_t k = 0; k < count; k++) {
        if (!sets[k].values || (left_out && strcmp(sets[k].name, left_out) == 0))
            continue;
        const hid_t type = sets[k].is_single ? H5T_NATIVE_FLOAT : H5T_NATIVE_DOUBLE;
        const hid_t space = H5Screate_simple(sets[k].rank, sets[k].dims, NULL);
        const hid_t set = H5Dcreate2(file, sets[k].name, type, space, links, H5P_DEFAULT, H5P_DEFAULT);
        assert_true(set >= 0 && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, sets[k].values) >= 0);
        H5Dclose(set);
        H5Sclose(space);
    }
    H5Pclose(links);
    assert_true(H5Fclose(file) >= 0);
}
