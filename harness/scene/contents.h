/* From the keys of a scene file to the scene. Used within scene/ only. */
#ifndef SASBENCH_SCENE_CONTENTS_H
#define SASBENCH_SCENE_CONTENTS_H

#include "scene/keys.h"

/* Read all groups from the root of the file, check them, and fill reading->scene. On failure the scene contains what
   was made so far and is freed with scene_free. Errors: STATUS_INVALID naming the key; STATUS_FAILED without memory. */
enum status scene_fill(struct reading *reading, config_setting_t *root);

/* Acquisition and samples of the file that `echoes` names. Errors: as echo_file_read, naming the key's place. */
enum status recorded_fill(struct reading *reading);

/* The number of pings and the keys of the track, before they are checked against others; places if a file has them. */
enum status track_read(struct reading *reading);
/* Transmitters, receivers and velocities of the allocated acquisition, and scene->flown where the imager has only a
   part of the motion. */
enum status track_fill(struct reading *reading);

/* The path for the text `name` of a key: without a leading slash, from the folder of the key's file. NULL without
   memory. */
char *path_beside(const struct reading *reading, const config_setting_t *setting, const char *name);

/* The scene's patches and those of its exact image; acquisition and targets come before. Errors: as scene_fill. */
enum status image_fill(struct reading *reading);

enum status scene_out_of_memory(const struct reading *reading);

#endif
