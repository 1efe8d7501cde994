/* Whether recorded samples, or their pulse, are the conjugates of what they should be. Used within scene/ only. */
#ifndef SASBENCH_SCENE_CONJUGATED_H
#define SASBENCH_SCENE_CONJUGATED_H

#include "scene/scene.h"

/* Of recorded echoes: how much more strongly the strongest of them focus with samples, pulse or both conjugated than as
   they are. The cure says which. 0 where too few records or too short an aperture tell nothing, or noise; NAN without
   memory. */
struct condition conjugated_condition(const struct scene *scene);

#endif
