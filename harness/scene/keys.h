/* The keys of a scene file: reading them, and the one form of their error messages. Used within scene/ only. */
#ifndef SASBENCH_SCENE_KEYS_H
#define SASBENCH_SCENE_KEYS_H

#include <libconfig.h>

#include "files/hash.h"
#include "scene/scene.h"
#include "scene/text.h"

#define SCATTERERS_MAX 10000000 /* of all fields */
/* The accepted value of a key whose value comes from the echo file. */
#define LEFT_OUT "left out with `echoes`, whose file says it"

/* Groups stay libconfig settings until they are read in turn; NULL when the file leaves them out. */
struct reading {
    const char *path; /* of the scene file */
    struct scene_text text;
    struct scene scene;
    const char *description, *echoes; /* belong to libconfig; echoes "": the scene is simulated */
    config_setting_t *root;
    const char *track_file; /* belongs to libconfig; "": the track is even */
    config_setting_t *motion;
    bool errors_known, measured_velocity;
    struct pose *poses; /* [pings] malloc'ed; NULL until they are made */
    config_setting_t *base, *sonar, *pulse, *array, *track, *record, *beam, *area, *targets, *noise, *image;
    double first_offset_m, pitch_m;
    double speed_m_s, spacing_m, x_first_m; /* spacing 0: follows from speed and pri */
    double squint_deg, angle_deg;           /* of the beam; of the image's axes */
    double x_offset_m;                      /* added to every x of transmitters, targets and pixels */
    int first_sample;
    double time_offset_s; /* added to the time of each record's first sample */
    config_setting_t *points, *fields;
    config_setting_t *x, *r, *reference, *around_targets, *patches;
};

/* The platform's position at a ping. */
struct pose {
    struct vector tx, velocity; /* m, m/s */
    double yaw;                 /* rad, of the receivers about the transmitter, towards +r */
};

struct motion_keys {
    int axis; /* index of motion_names */
    double amplitude, period_s, phase_deg, walk;
    uint64_t seed;
};

struct scatter_field {
    double x_m[2], r_m[2]; /* min, max */
    int count;
    uint64_t seed;
};

struct axis_keys {
    double first_m, step_m;
    int count;
};

struct patch_keys {
    config_setting_t *x, *r;
};

struct around_keys {
    double half_x_m, half_r_m, x_step_m, r_step_m;
};

/* Read every key of `group` ("targets.points") from its setting (NULL: all defaults) into that group's struct, and
   add the values to the scene's hash. Errors: STATUS_INVALID. */
enum status group_read(struct reading *reading, config_setting_t *setting, const char *group, void *out);
/* The same for the file's own keys and all groups that occur once. */
enum status groups_read(struct reading *reading, config_setting_t *root);

/* A setting of a group, or of the nearest scene of the group's `base` chain; NULL if there is none. */
config_setting_t *key_member(const config_setting_t *group, const char *name);

/* Check the keys against each other. Errors: STATUS_INVALID. */
enum status keys_check(const struct reading *reading);

/* The one error of a key: "FILE:LINE: key 'sonar.fs' is -3, must be ..."; `format` is what is accepted. `name` NULL
   means the group itself; `group_name` is used where the group is missing. Returns STATUS_INVALID. */
enum status refuse(const struct reading *reading, const config_setting_t *group, const char *group_name,
                   const char *name, const char *format, ...) __attribute__((format(printf, 5, 6)));

/* The file of a line of the scene's text. */
const char *line_path(const struct reading *reading, unsigned line);
/* "FILE:LINE" of a line of the scene's text as libconfig counts them; 0: "FILE", the scene's. */
void place_format(const struct reading *reading, unsigned line, char *text, size_t size);

extern const char *const truncation_names[]; /* by enum truncation_kind */

#endif
