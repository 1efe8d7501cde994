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

void set_write(hid_t file, const char *name, hid_t type, int rank, const hsize_t *dims, const void *values)
{
    const hid_t links = H5Pcreate(H5P_LINK_CREATE), space = H5Screate_simple(rank, dims, NULL);
    H5Pset_create_intermediate_group(links, 1);
    const hid_t set = H5Dcreate2(file, name, type, space, links, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(set >= 0 && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    H5Dclose(set);
    H5Sclose(space);
    H5Pclose(links);
}
