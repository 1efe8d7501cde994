/* The struct of a key, and its possible types. Used within scene/ only. */
#ifndef SASBENCH_SCENE_KEY_TYPES_H
#define SASBENCH_SCENE_KEY_TYPES_H

#include <float.h>
#include <libconfig.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#define REQUIRED NAN          /* as a default: none, the key is required */
#define ABOVE_0  DBL_TRUE_MIN /* as a lower bound: > 0 */

struct key {
    const char *group, *name, *unit;
    const struct type *type;
    size_t offset;              /* of the field in the group's struct */
    double initial, min, max;   /* default (REQUIRED: none) and closed bounds */
    const char *const *choices; /* NULL-terminated, else NULL */
};

/* read: store a setting in its field, or the default when the setting is NULL; false when the setting is refused. */
struct type {
    const char *accepts;
    bool (*read)(const struct key *key, config_setting_t *setting, void *field);
    size_t bytes; /* of the field that enter the hash; 0 = none */
};

extern const struct type REAL, INTEGER, SEED, BOOLEAN, CHOICE, TEXT, SPAN, AMPLITUDE, LEVEL, GROUP, LIST;

/* What a key accepts, in words, at the end of a text. */
void key_accepted_append(char *text, size_t size, const struct key *key);

#endif
