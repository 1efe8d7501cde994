/* Errors predicted before any plan, against measured ones. */
#ifndef SASBENCH_ADVISE_PREDICTED_H
#define SASBENCH_ADVISE_PREDICTED_H

#include "scene/scene.h"

/* Read DIR/measurements.csv, predict each of its images whose settings a law covers, and write beside it predicted.csv
   (a row an image: predicted error, measured one after one gain, ratio, main cause) and predictions.csv (a row an
   algorithm: how many, and the ratio's least, quartiles, median and largest), which is printed. `scenes` are those
   measured; others are looked up by name, and left out if they have changed or are missing. *any: whether an image is
   predicted. Errors: as results_read; STATUS_INVALID for a folder that cannot be written; STATUS_FAILED without
   memory. */
enum status predicted_write(const char *directory, const struct scene *scenes, int scene_count, bool *any);
/* Draw predicted.csv into DIR/predicted.png. Errors: as plot_csv (plot.h). */
enum status predicted_draw(const char *directory);

#endif
