#include <math.h>

#include "contract/algorithm.h"

struct vector grid_coordinates(const struct grid *grid, double x, double r)
{
    if (grid->angle_rad == 0)
        return (struct vector){x, r, 0};
    double cosine = cos(grid->angle_rad), sine = sin(grid->angle_rad);
    return (struct vector){x * cosine - r * sine, x * sine + r * cosine, 0};
}

struct problem problem_make(const struct acquisition *acquisition, int patch_count, const struct grid *patches,
                            enum precision precision)
{
    return (struct problem){
        .acquisition = acquisition, .patch_count = patch_count, .patches = patches, .precision = precision};
}

struct grid grid_part(const struct grid *grid, const struct pixel_window *window)
{
    struct grid part = *grid;
    part.x_first += window->column * grid->x_step;
    part.x_count = window->columns;
    part.r_first += window->row * grid->r_step;
    part.r_count = window->rows;
    return part;
}

struct pixel_window problem_window(const struct problem *problem, int patch)
{
    const struct grid *grid = &problem->patches[patch];
    return problem->window ? *problem->window : (struct pixel_window){0, grid->r_count, 0, grid->x_count};
}

size_t grid_pixels(const struct grid *grid)
{
    return (size_t)grid->r_count * (size_t)grid->x_count;
}

struct vector grid_point(const struct grid *grid, double i, double j)
{
    double x = grid->x_first + j * grid->x_step, r = grid->r_first + i * grid->r_step;
    if (grid->angle_rad == 0)
        return (struct vector){x, r, 0};
    double cosine = cos(grid->angle_rad), sine = sin(grid->angle_rad);
    return (struct vector){x * cosine + r * sine, r * cosine - x * sine, 0};
}
