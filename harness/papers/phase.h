/* The phase study: how far each formula of the two-dimensional spectrum is from the exact one. */
#ifndef SASBENCH_PAPERS_PHASE_H
#define SASBENCH_PAPERS_PHASE_H

#include <stdbool.h>

#include "scene/scene.h"

/* Name of formula k; the study's files have its column NAME_error_rad. NULL for k behind the last. */
const char *phase_formula(int k);

/* LBF21's two set-ups. */
enum phase_setup { PHASE_SHORT, PHASE_LONG, PHASE_SETUPS };
extern const char *const phase_setups[PHASE_SETUPS]; /* their scenes */

/* LBF21's printed phase errors, in published.csv by `table` and `target`. */
struct phase_figure {
    const char *table, *target;
    enum phase_setup setup;
    bool last;                    /* the last receiver; else the first */
    double least_m, most_m;       /* ranges */
    const char *formula, *method; /* the study prints this formula's largest error beside it; NULL: none */
    bool bound;                   /* the paper gives only an upper bound */
};
extern const struct phase_figure phase_figures[]; /* table NULL ends */

/* LBF21's two set-ups: CSV files and pictures in the folder; on standard output, the largest errors beside those
   that the paper prints. The folder exists; `taken`: the caller has locked it, too (folder.h). Errors:
   STATUS_INVALID for files that cannot be read or written. */
enum status phase_study(const char *directory, bool taken);
/* The same for the array of one scene, by name or path; the folder is made. */
enum status phase_scene_study(const char *scene, const char *directory, bool taken);

/* The CSV file alone, of a loaded scene. Errors: as above; STATUS_UNSUPPORTED for a track that is not straight. */
enum status phase_curves_write(const struct scene *scene, const char *directory);
/* "DIR/phase-SCENE" and what follows it: the study's files. */
void phase_path(const char *directory, const char *scene, const char *rest, char *path, size_t size);

/* Every formula at the points of a CSV file (columns d, r, F, f, fc, v, c), as CSV on standard output. Errors:
   STATUS_INVALID naming file, line, column, value and what is accepted. */
enum status phase_points_print(const char *path);

#endif
