/* A scene: platform, sonar and targets, read from a libconfig file (every key: scenes/README.md), or recorded
   echoes. */
#ifndef SASBENCH_SCENE_SCENE_H
#define SASBENCH_SCENE_SCENE_H

#include <stdint.h>

#include "contract/algorithm.h"
#include "echoes/matfile.h"

#define COORDINATE_MAX_M 1e12 /* bound of every coordinate read, so that no square overflows */

enum pulse_kind { PULSE_LFM, PULSE_LFM_TIME, PULSE_FLAT };
enum beam_kind { BEAM_RECT, BEAM_TXRX };
enum truncation_kind { TRUNCATION_NONE, TRUNCATION_TX, TRUNCATION_MID, TRUNCATION_DOPPLER, TRUNCATION_SINE };

/* The beam's direction is part of the acquisition (echo_squint): all angles here count from it. Amplitude of the
   echo of one pair (element beams sinc(D sin(theta)/lambda) or rect, and their truncation). theta_t is measured at
   emission, theta_r at reception. A property of the echoes: it never limits imaging. */
struct beam {
    enum beam_kind kind; /* rect: 1; txrx: sinc(D_tx sin theta_t F/c) sinc(D_rx sin theta_r F/c) */
    enum truncation_kind truncation;
    double limit;       /* tx, mid: |D_tx F sin theta/c| <= it; doppler: |D_tx F (sin + sin)/2c| <= it;
                           sine: |sin theta_t| <= it */
    bool per_frequency; /* F = fc + f_tau instead of F = fc (lambda = c/F) */
};

/* Samples that stay in their file. */
struct recording_file {
    char *path; /* NULL: they do not */
    int pings;  /* in the file; those of the scene begin at `first` */
    int first;
    int exponent;   /* of the power of two that they are divided by */
    double largest; /* magnitude of a part, of some pings */
    double bytes;   /* of the file, nearly all of them samples */
};

/* Freed with scene_free. */
struct scene {
    char *name;        /* without extension: the path below scenes/, or the name of a file elsewhere */
    char *path;        /* of the file, absolute and without links */
    bool shipped;      /* it lies below scenes/ */
    char *description; /* one line, from the file */
    uint64_t hash;     /* FNV-1a of the content after @include: the same content has the same hash */
    struct acquisition acquisition;
    struct acquisition *flown; /* the platform's true motion; NULL: that of `acquisition`, which the imager uses */
    double complex *recorded;  /* [pings][receivers][samples] of an echo file; NULL: the echoes are simulated */
    struct recording_file recording; /* the echo file, if its samples stay in it */
    enum pulse_kind pulse_kind;      /* flat: the echoes are compressed */
    double pulse_duration;           /* s; lfm and lfm_time */
    struct beam beam;
    int point_count;        /* the first targets are points: metrics measure these */
    int target_count;       /* points, then all scatterers of the fields, drawn from their seeds */
    struct target *targets; /* [target_count] */
    double noise_std;       /* standard deviation of the complex noise of each sample; 0 = none */
    uint64_t noise_seed;
    int patch_count;
    struct grid *patches; /* [patch_count] the image */
    bool full_size;       /* left out of the default `run` */
    /* Where `reference` is computed when that is not the whole image: sub-grids of patches[0] around each point
       target. reference_count == 0: reference_patches is NULL and the patches themselves are used. */
    int reference_count;
    struct grid *reference_patches;
};

/* SCENE is a path to a .cfg file, or a name below `scene_directory` without its extension.
   Errors: STATUS_INVALID, the message naming file, line, key, value and what is accepted. */
enum status scene_load(const char *scene, const char *scene_directory, struct scene *out);
/* The scene of an echo file alone, with its point targets, named after the file; its image is `grid`, which `place`
   names in messages; NULL: the file's own. Errors: as echo_file_read, and STATUS_INVALID where there is no grid or no
   pixel meets any record; nothing to free then. Unless `whole`, the samples stay in the file and are read ping by ping;
   the hash has the file's size and time in their place. */
enum status scene_from_echoes(const char *path, const struct grid *grid, const char *place, bool whole,
                              struct scene *out);
void scene_free(struct scene *scene);
/* What an echo file keeps of the scene; borrows from it. */
struct echo_notes scene_notes(const struct scene *scene);
/* The whole image from the scene's echoes; borrows from the scene. */
struct problem scene_problem(const struct scene *scene, enum precision precision);
/* Where two files share a name and not both are shipped, lengthen their names by the folders that distinguish them.
   Errors: STATUS_FAILED without memory. */
enum status scenes_tell_apart(struct scene *a, struct scene *b);

/* Fill `list` with conditions_scene, the conditions of recorded samples and those of motion errors without the
   imager's knowledge, and return their number. All of them warn. */
enum { SCENE_CONDITIONS = CONDITIONS_SCENE + 3 };
int scene_conditions(const struct scene *scene, struct condition list[SCENE_CONDITIONS]);

/* The folder below the scenes that `stability` alone uses: some of its scenes must be refused. */
#define SCENES_EXTREME "extreme"

/* Names of all scenes below `scene_directory` (recursive, sorted, without extension; files whose name begins with '_'
   are for @include and are left out, and so is its folder SCENES_EXTREME). The caller frees each name and the array
   (scene_names_free). */
enum status scene_names(const char *scene_directory, char ***names, int *count);
void scene_names_free(char **names, int count);

/* GRID as on the command line, "xmin:xstep:xcount,rmin:rstep:rcount" in metres, with ",angle" in degrees for axes
   turned as by a scene's image.angle. Errors: STATUS_INVALID. */
enum status grid_parse(const char *text, struct grid *grid);
/* Positive finite steps, counts >= 1, count products that fit; `place` begins the message. Errors: STATUS_INVALID. */
enum status grid_check(const struct grid *grid, const char *place);
/* Does any pixel of any patch meet any record? STATUS_INVALID (naming `place`, the delays and the record) if none. */
enum status grid_meets_records(const struct acquisition *acquisition, int patch_count, const struct grid *patches,
                               const char *place);

#endif
