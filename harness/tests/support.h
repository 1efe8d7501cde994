/* What several tests need: a scene with its echoes, one image of it, a folder. */
#ifndef SASBENCH_TEST_SUPPORT_H
#define SASBENCH_TEST_SUPPORT_H

#include "tests/assertions.h"

#include "echoes/echo_data.h"
#include "scene/random.h"
#include "scene/scene.h"
#include "imaging/spec.h"

/* Load a shipped scene; the test fails where that fails. */
void support_scene(const char *name, struct scene *scene);
/* The random scene of a seed (scene/random_scene.h), written into the test's folder. */
void support_random_scene(int seed, struct scene *scene);
/* The same with noise of this standard deviation in each sample. */
void support_noisy_scene(int seed, double noise_std, struct scene *scene);
/* A scene's echoes in double. */
void support_echoes(const struct scene *scene, struct echoes *echoes);
/* Compressed echoes' acquisition at 150 kHz, B = 15 kHz, fs = 30 kHz, c = 1500 m/s: all places, velocities and t0 are
   0. To be freed. */
struct acquisition support_acquisition(int pings, int receivers, int samples);
/* Its echoes as noise, in double; to be freed. */
void support_noise(struct acquisition *acquisition, struct random *random, struct echoes *echoes);
/* Records of 24 pings at fs = 30 kHz that are noise of a flat spectrum, bandwidth `band` fs: every frequency and, in an
   image about 21 m away, every place between samples count alike. To be freed. */
void support_flat_noise(double band, struct acquisition *acquisition, struct echoes *echoes);
/* Image a problem by SPEC (the SPEC's precision replaces the problem's) from double echoes. *image is allocated
   here. */
enum status support_image(const char *spec, struct problem problem, const struct echoes *echoes, struct image *image);
/* What the plan of SPEC counts (the SPEC's precision replaces the problem's). */
struct work support_work(const char *spec, struct problem problem);
/* A zeroed image; one of its pixels, whatever the precision. */
void support_image_make(const struct grid *patches, int count, enum precision precision, struct image *image);
void support_pixel_set(struct image *image, int patch, int i, int j, double complex value);
/* |a - b|_2 / |b|_2 over all pixels of two images of the same patches; |a|_2 when b is all zero. */
double support_difference(const struct image *a, const struct image *b);
double support_peak(const struct image *image);

/* The path of a file of recorded echoes, which are not ours to ship: SASBENCH_DATA names their folder. False where it
   is not there. */
bool support_recording(const char *file, char *path, size_t size);

/* The first patch of an image file, its pixels malloc'ed complex double [r_count][x_count]. Errors: as
   image_file_open. */
enum status image_file_read(const char *path, struct grid *grid, double complex **pixels);

/* A folder of its own for every test: fixtures, and the path of a name in it (the last four stay valid). */
extern char folder[256];
int folder_make(void **state);
int folder_make_quoted(void **state); /* its name has blanks and an apostrophe */
/* A text between apostrophes as gnuplot reads it, its own ones doubled; until the next call. */
const char *gnuplot_text(const char *text);
int folder_remove(void **state); /* with all that is in it */
const char *path_of(const char *name);
bool support_exists(const char *name);
void support_write(const char *name, const char *text);
char *support_read(const char *name); /* the whole file, malloc'ed; NULL if it is not there */
/* The text of a page of ours, tables as lines of |cell|cell|, or NULL; to be freed. */
char *support_read_cells(const char *path);

/* Lines of the shell, in the test's folder; $ROOT is the source's. What they say is added to the files out and err.
   Returns the exit status, -1 for a signal. */
int support_shell(const char *lines);
/* The same; the test fails on any other status than the wanted one. */
void assert_shell(const char *lines, int wanted);

/* Amplitude of a pair's echo from target point p at total frequency F (Hz), tau = the exact delay. */
double support_beam_weight(const struct scene *scene, int ping, int receiver, struct vector p, double tau,
                           double frequency);

#endif
