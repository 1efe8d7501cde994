/* Are recorded samples, or their pulse, conjugated by mistake? Used within scene/ only. */
#ifndef SASBENCH_SCENE_CONJUGATED_H
#define SASBENCH_SCENE_CONJUGATED_H

#include "scene/scene.h"

/* Of recorded echoes: how much more strongly the strongest of them focus with samples, pulse or both conjugated than
   unchanged. The cure names which. 0 where too few records, too short an aperture or noise leave it open; NAN
   without memory. */
struct condition conjugated_condition(const struct scene *scene);

#endif
