/* The platform's place at each ping: evenly along x, or as measured, with motion errors that the imager uses or
   ignores. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "files/csv.h"
#include "scene/random.h"
#include "scene/contents.h"
#include "echoes/matvar.h"
#include "scene/names.h"

static const double degree = M_PI / 180;

/* ---- measured positions ---- */

static enum status poses_allocate(struct reading *reading, const char *path, size_t count)
{
    if (count < 1 || count > 0x1p26)
        return status_set(STATUS_INVALID, "%s: positions of %zu pings; of 1 to %.0f are needed", path, count, 0x1p26);
    reading->poses = calloc(count, sizeof *reading->poses);
    if (!reading->poses)
        return scene_out_of_memory(reading);
    reading->scene.acquisition.pings = (int)count;
    return STATUS_OK;
}

static enum status csv_poses(struct reading *reading, const char *path)
{
    static const char *const names[] = {"x", "y", "z", "yaw", "vx", "vy", "vz"};
    enum { NEEDED = 3, YAW = 3, VELOCITY = 4, NAMES = 7 };
    struct csv csv;
    int columns[NAMES];
    enum status status = csv_read(path, CSV_TAIL_KEEP, &csv);
    if (status != STATUS_OK)
        return status;
    for (int k = 0; k < NAMES; k++) {
        columns[k] = csv_column(&csv, names[k]);
        const bool lone = k > VELOCITY && (columns[k] < 0) != (columns[VELOCITY] < 0);
        if (status == STATUS_OK && ((k < NEEDED && columns[k] < 0) || lone))
            status = status_set(
                STATUS_INVALID,
                "%s: column '%s' is missing; x, y, z in m are needed, yaw in degrees and vx, vy, vz in m/s may "
                "stand beside them",
                path, columns[k] < 0 ? names[k] : names[VELOCITY]);
    }
    if (status == STATUS_OK)
        status = poses_allocate(reading, path, (size_t)csv.row_count);
    for (int row = 0; row < csv.row_count && status == STATUS_OK; row++) {
        double values[NAMES] = {0};
        for (int k = 0; k < NAMES && status == STATUS_OK; k++)
            if (columns[k] >= 0 && !(csv_number(csv_cell(&csv, row, columns[k]), &values[k]) && isfinite(values[k])))
                status = status_set(STATUS_INVALID, "%s:%d: %s is '%s'; a finite number is needed", path,
                                    csv.lines[row], names[k], csv_cell(&csv, row, columns[k]));
        reading->poses[row] = (struct pose){{values[0], values[1], values[2]},
                                            {values[VELOCITY], values[VELOCITY + 1], values[VELOCITY + 2]},
                                            values[YAW] * degree};
    }
    reading->measured_velocity = columns[VELOCITY] >= 0;
    csv_free(&csv);
    return status;
}

static enum status mat_poses(struct reading *reading, const char *path)
{
    enum { TX, YAW, VELOCITY, VARIABLES };
    static const struct wanted wanted[VARIABLES] = {{"tx", KIND_REAL, false, "a real array [3 x P] in m"},
                                                    {"yaw", KIND_REAL, true, "a real row [1 x P] in degrees"},
                                                    {"velocity", KIND_REAL, true, "a real array [3 x P] in m/s"}};
    struct variable v[VARIABLES];
    enum status status = variables_read(path, wanted, VARIABLES, v);
    if (status != STATUS_OK)
        return status;
    const size_t pings = v[TX].dims[1];
    const bool fits[VARIABLES] = {variable_has_shape(&v[TX], 3, pings, 1),
                                  !v[YAW].values || (variable_is_vector(&v[YAW]) && variable_count(&v[YAW]) == pings),
                                  !v[VELOCITY].values || variable_has_shape(&v[VELOCITY], 3, pings, 1)};
    for (int k = 0; k < VARIABLES && status == STATUS_OK; k++)
        if (!fits[k])
            status = status_set(
                STATUS_INVALID, "%s: variable `%s` is [%zu x %zu x %zu], `tx` [%zu x %zu]; %s is needed", path,
                wanted[k].name, v[k].dims[0], v[k].dims[1], v[k].dims[2], v[TX].dims[0], pings, wanted[k].accepted);
    if (status == STATUS_OK)
        status = poses_allocate(reading, path, pings);
    for (size_t p = 0; p < pings && status == STATUS_OK; p++) {
        reading->poses[p].tx = variable_vector(&v[TX], p);
        if (v[YAW].values)
            reading->poses[p].yaw = creal(v[YAW].values[p]) * degree;
        if (v[VELOCITY].values)
            reading->poses[p].velocity = variable_vector(&v[VELOCITY], p);
    }
    reading->measured_velocity = v[VELOCITY].values != NULL;
    variables_free(v, VARIABLES);
    return status;
}

/* By differences of neighbouring places, if not measured. */
static void velocity_add(struct pose *poses, const struct vector *places, int count, double pri)
{
    for (int p = 0; p < count && count > 1; p++) {
        const int from = p > 0 ? p - 1 : 0, to = p < count - 1 ? p + 1 : count - 1;
        const double seconds = (to - from) * pri;
        poses[p].velocity.x += (places[to].x - places[from].x) / seconds;
        poses[p].velocity.y += (places[to].y - places[from].y) / seconds;
        poses[p].velocity.z += (places[to].z - places[from].z) / seconds;
    }
}

static enum status poses_check(const struct reading *reading, const char *path)
{
    for (int p = 0; p < reading->scene.acquisition.pings; p++) {
        const struct vector *tx = &reading->poses[p].tx;
        if (!(fabs(tx->x) <= COORDINATE_MAX_M && fabs(tx->y) <= COORDINATE_MAX_M && fabs(tx->z) <= COORDINATE_MAX_M))
            return status_set(STATUS_INVALID, "%s: ping %d lies at (%g, %g, %g) m; within +-%g m is needed", path,
                              p + 1, tx->x, tx->y, tx->z, COORDINATE_MAX_M);
    }
    return STATUS_OK;
}

static enum status measured_read(struct reading *reading, const char *path)
{
    const char *extension = strrchr(path, '.');
    enum status status =
        extension && strcmp(extension, ECHO_EXTENSION) == 0 ? mat_poses(reading, path) : csv_poses(reading, path);
    const int pings = reading->scene.acquisition.pings;
    if (status == STATUS_OK)
        status = poses_check(reading, path);
    if (status != STATUS_OK)
        return status;
    for (int p = 0; p < pings; p++)
        hash_add(&reading->scene.hash, &reading->poses[p], sizeof reading->poses[p]);
    if (reading->measured_velocity)
        return STATUS_OK;
    struct vector *places = malloc((size_t)pings * sizeof *places);
    if (!places)
        return scene_out_of_memory(reading);
    for (int p = 0; p < pings; p++)
        places[p] = reading->poses[p].tx;
    velocity_add(reading->poses, places, pings, reading->scene.acquisition.pri);
    free(places);
    return STATUS_OK;
}

static enum status straight_poses(struct reading *reading)
{
    const int pings = reading->scene.acquisition.pings;
    reading->poses = calloc((size_t)pings, sizeof *reading->poses);
    if (!reading->poses)
        return scene_out_of_memory(reading);
    for (int p = 0; p < pings; p++) {
        reading->poses[p].tx.x = reading->x_first_m
                                 + (reading->spacing_m != 0 ? p * reading->spacing_m
                                                            : p * reading->speed_m_s * reading->scene.acquisition.pri);
        reading->poses[p].velocity.x = reading->speed_m_s;
    }
    return STATUS_OK;
}

enum status track_read(struct reading *reading)
{
    static const char *const even[] = {"speed", "pings", "spacing", "x_first"};
    const bool measured = *reading->track_file != '\0';
    for (int k = 0; k < 4; k++) {
        const bool given = key_member(reading->track, even[k]) != NULL;
        if (measured && given)
            return refuse(reading, reading->track, "track", even[k], "left out with `file`, which gives it");
        if (!measured && !given && k < 2)
            return refuse(reading, reading->track, "track", even[k],
                          k == 0 ? "a number that is finite m/s" : "an integer >= 1");
    }
    if (!measured)
        return STATUS_OK;
    char *path = path_beside(reading, key_member(reading->track, "file"), reading->track_file);
    if (!path)
        return scene_out_of_memory(reading);
    enum status status = measured_read(reading, path);
    free(path);
    return status;
}

/* ---- motion errors ---- */

enum motion_axis { SWAY, SURGE, HEAVE, YAW_AXIS };

/* The displacement of each ping by one error, m or degrees. */
static void error_make(const struct motion_keys *keys, int index, const struct reading *reading, double *values)
{
    struct random random = random_seed(keys->seed, (uint64_t)index);
    double walked = 0;
    for (int p = 0; p < reading->scene.acquisition.pings; p++) {
        values[p] = keys->amplitude
                    * sin(2 * M_PI * (p * reading->scene.acquisition.pri / keys->period_s) + keys->phase_deg * degree);
        if (keys->walk > 0) {
            values[p] = walked;
            walked += keys->walk * M_SQRT2 * creal(random_normal(&random)); /* whose parts have a variance of 1/2 */
        }
    }
}

static enum status error_add(struct reading *reading, int index, struct pose *poses, double *values,
                             struct vector *places)
{
    struct motion_keys keys;
    config_setting_t *setting = config_setting_get_elem(reading->motion, (unsigned)index);
    enum status status = group_read(reading, setting, "track.errors", &keys);
    if (status != STATUS_OK)
        return status;
    if ((keys.walk > 0) == (keys.amplitude != 0))
        return refuse(reading, setting, "track.errors", NULL, "a group with either `amplitude` and `period` or `walk`");
    if (keys.amplitude != 0 && !(keys.period_s > 0))
        return refuse(reading, setting, "track.errors", "period", "a number > 0 s with `amplitude`");
    keys.period_s = keys.amplitude != 0 ? keys.period_s : 1;
    error_make(&keys, index, reading, values);
    const int pings = reading->scene.acquisition.pings;
    for (int p = 0; p < pings; p++) {
        places[p] = (struct vector){keys.axis == SURGE ? values[p] : 0, keys.axis == SWAY ? values[p] : 0,
                                    keys.axis == HEAVE ? values[p] : 0};
        poses[p].tx.x += places[p].x;
        poses[p].tx.y += places[p].y;
        poses[p].tx.z += places[p].z;
        poses[p].yaw += keys.axis == YAW_AXIS ? values[p] * degree : 0;
    }
    velocity_add(poses, places, pings, reading->scene.acquisition.pri);
    return STATUS_OK;
}

/* poses [pings] with all errors added. */
static enum status errors_add(struct reading *reading, struct pose *poses)
{
    const size_t pings = (size_t)reading->scene.acquisition.pings;
    double *values = malloc(pings * sizeof *values);
    struct vector *places = malloc(pings * sizeof *places);
    enum status status = values && places ? STATUS_OK : scene_out_of_memory(reading);
    for (int k = 0; k < config_setting_length(reading->motion) && status == STATUS_OK; k++)
        status = error_add(reading, k, poses, values, places);
    free(values);
    free(places);
    return status;
}

static void poses_put(const struct reading *reading, const struct pose *poses, struct acquisition *a)
{
    for (int p = 0; p < a->pings; p++) {
        const double cosine = cos(poses[p].yaw), sine = sin(poses[p].yaw);
        a->tx[p] = poses[p].tx;
        a->tx[p].x += reading->x_offset_m;
        a->velocity[p] = poses[p].velocity;
        for (int m = 0; m < a->receivers; m++) {
            const double offset = reading->first_offset_m + m * reading->pitch_m;
            struct vector *rx = &a->rx[(size_t)p * (size_t)a->receivers + (size_t)m];
            *rx = a->tx[p];
            /* Keep an even track the same to the bit. */
            rx->x =
                sine == 0 ? a->tx[p].x + reading->first_offset_m + m * reading->pitch_m : a->tx[p].x + offset * cosine;
            rx->y += offset * sine;
        }
    }
}

enum status track_fill(struct reading *reading)
{
    struct scene *scene = &reading->scene;
    struct acquisition *a = &scene->acquisition;
    const bool errors = reading->motion && config_setting_length(reading->motion) > 0;
    enum status status = reading->poses ? STATUS_OK : straight_poses(reading);
    if (status != STATUS_OK)
        return status;
    poses_put(reading, reading->poses, a);
    if (!errors)
        return STATUS_OK;
    status = errors_add(reading, reading->poses);
    if (status == STATUS_OK && !reading->errors_known) {
        scene->flown = calloc(1, sizeof *scene->flown);
        status = scene->flown ? acquisition_turn(a, 0, scene->flown) : scene_out_of_memory(reading);
    }
    if (status == STATUS_OK)
        poses_put(reading, reading->poses, scene->flown ? scene->flown : a);
    return status == STATUS_OK && scene->flown ? acquisition_check(scene->flown, reading->path) : status;
}
