/* The tile for a memory (tile_size.h). */
#include "measure/tile_size.h"

#include <math.h>
#include <stdlib.h>

#include "choice/process.h"
#include "echoes/matfile.h"
#include "imaging/imaging.h"

/* Of the memory, for plans. The rest is for what they do not count: scratch of further threads, buffers of files. */
static const double SHARE = 15.0 / 16;

static int parts_of(int whole, int part)
{
    return (whole + part - 1) / part;
}

struct pixel_window tile_dearest(const struct acquisition *a, const struct tiles *tiles)
{
    const struct grid *g = &tiles->grid;
    const struct vector middle = a->tx[a->pings / 2];
    const double column = (grid_coordinates(g, middle.x, middle.y).x - g->x_first) / g->x_step - tiles->columns / 2.0;
    return (struct pixel_window){g->r_count - tiles->rows, tiles->rows,
                                 (int)fmax(fmin(column, g->x_count - tiles->columns), 0), tiles->columns};
}

enum status tile_cost(const struct spec *spec, const struct scene *scene, const struct tiles *tiles,
                      struct tile_cost *cost)
{
    const struct acquisition *a = &scene->acquisition;
    const struct pixel_window window = tile_dearest(a, tiles);
    struct problem problem = problem_make(a, 1, &tiles->grid, spec->precision);
    struct imaging imaging;
    bool *read = calloc((size_t)a->pings, sizeof *read);
    problem.window = &window;
    problem.estimate = true;
    enum status status =
        read ? imaging_open(spec, &problem, &imaging) : status_set(STATUS_FAILED, "out of memory for pings");
    if (status == STATUS_OK) {
        const struct work work = imaging.algorithm->work(imaging.plan);
        imaging_reads(&imaging, &problem, read);
        *cost = (struct tile_cost){.flops = work.flops, .first = -1};
        for (int p = 0; p < a->pings; p++)
            if (read[p]) {
                cost->pings++;
                cost->last = p;
                cost->first = cost->first < 0 ? p : cost->first;
            }
        cost->bytes = process_tile_bytes(&problem, work.bytes, cost->pings);
        imaging_close(&imaging);
    }
    free(read);
    return status;
}

/* The widest tile of tiles->rows that fits; tiles->columns is 0 where not even one of a single column does. Memory
   grows about in proportion to the columns: the next width is where the line through two that fit reaches the limit,
   so that no plan takes much more than it. As all tiles get the same width, a wider one is of use where they get fewer,
   and is tried at the least width that makes as few. */
static enum status widen(const struct spec *spec, const struct scene *scene, double bytes, struct tiles *tiles,
                         struct tile_cost *cost)
{
    enum { GROWTH = 16, CLOSE = 32 };
    const int columns = tiles->grid.x_count;
    int fits = 0, beyond = columns + 1;
    double held = 0; /* bytes, of `fits` */
    enum status status = STATUS_OK;
    for (int next = 1; status == STATUS_OK && next > fits;) {
        struct tile_cost tried;
        double reach = INFINITY;
        tiles->columns = next;
        status = tile_cost(spec, scene, tiles, &tried);
        if (status == STATUS_OK && tried.bytes <= SHARE * bytes) {
            if (fits > 0 && tried.bytes > held)
                reach = next + (SHARE * bytes - tried.bytes) * (next - fits) / (tried.bytes - held);
            fits = next;
            held = tried.bytes;
            *cost = tried;
        } else {
            beyond = next;
        }
        const int most =
            (int)fmin(fmin(reach, (double)GROWTH * fits), beyond > columns ? columns : (fits + beyond) / 2);
        next = 0;
        if (beyond - fits > 1 + fits / CLOSE && fits > 0 && parts_of(columns, most) < parts_of(columns, fits))
            next = parts_of(columns, parts_of(columns, most));
    }
    tiles->columns = fits;
    return status;
}

enum status tile_choose(const struct spec *spec, const struct scene *scene, double bytes, struct tiles *tiles,
                        struct tile_cost *cost)
{
    enum { PARTS_MOST = 64, TRACKS = 2 };
    const struct acquisition *a = &scene->acquisition;
    struct tiles tried = *tiles;
    const double whole = process_reading_bytes(a);
    double reads = INFINITY;
    enum status status = STATUS_OK;
    if (scene->recording.path && echo_file_is_read_whole(scene->recording.path) && whole > bytes)
        return status_set(STATUS_UNSUPPORTED,
                          "--memory: %s is of version 5, which is read whole and takes %.4g MB; at most %.4g MB are "
                          "wanted (cure: a file of version 7.3: save -v7.3)",
                          scene->recording.path, 1e-6 * whole, 1e-6 * bytes);
    for (int parts = 1; status == STATUS_OK && parts <= PARTS_MOST && parts <= tiles->grid.r_count
                        && reads > (double)TRACKS * a->pings;
         parts *= 2) {
        struct tile_cost one;
        tried.rows = parts_of(tiles->grid.r_count, parts);
        status = widen(spec, scene, bytes, &tried, &one);
        const double all =
            tried.columns > 0 ? (double)one.pings * parts_of(tiles->grid.x_count, tried.columns) : INFINITY;
        if (status == STATUS_OK && all < reads) {
            reads = all;
            tiles->rows = tried.rows;
            tiles->columns = parts_of(tiles->grid.x_count, parts_of(tiles->grid.x_count, tried.columns));
            *cost = one;
        }
    }
    if (status == STATUS_OK && reads == INFINITY)
        status = status_set(STATUS_UNSUPPORTED,
                            "--memory: no tile fits into %.4g MB, not even one of 1x%d pixels (cure: more "
                            "memory, fewer receivers or samples)",
                            bytes / 1e6, tried.rows);
    return status;
}
