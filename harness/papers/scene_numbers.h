/* Numbers of a scene's acquisition that claims ask for by name. */
#ifndef SASBENCH_PAPERS_SCENE_NUMBERS_H
#define SASBENCH_PAPERS_SCENE_NUMBERS_H

#include "contract/acquisition.h"

extern const char *const scene_number_names[]; /* with their units; NULL ends them */
/* Of the name at this place. NAN for what only a straight track has. */
double scene_number_value(int place, const struct acquisition *acquisition);

#endif
