#include "tests/support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "imaging/imaging.h"
#include "echoes/matfile.h"
#include "echoes/noise.h"
#include "scene/random_scene.h"
#include "scene/simulate.h"

#define CHECK(status)                                                                                                  \
    do {                                                                                                               \
        if ((status) != STATUS_OK)                                                                                     \
            fail_msg("%s", status_message());                                                                          \
    } while (0)

void support_scene(const char *name, struct scene *scene)
{
    CHECK(scene_load(name, SASBENCH_ROOT "/scenes", scene));
}

void support_random_scene(int seed, struct scene *scene)
{
    const char *path = path_of("random.cfg");
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    random_scene_write(file, (uint64_t)seed);
    fclose(file);
    support_scene(path, scene);
}

void support_noisy_scene(int seed, double noise_std, struct scene *scene)
{
    support_random_scene(seed, scene);
    scene->noise_std = noise_std;
    scene->acquisition.noisy = noise_std > 0;
    scene->acquisition.noise =
        noise_of_targets(&scene->acquisition, scene->target_count, scene->targets, scene->noise_std);
}

void support_echoes(const struct scene *scene, struct echoes *echoes)
{
    CHECK(scene_simulate(scene, echoes));
}

struct acquisition support_acquisition(int pings, int receivers, int samples)
{
    struct acquisition a = {.sound_speed = 1500,
                            .fc = 150e3,
                            .fs = 30e3,
                            .bandwidth = 15e3,
                            .samples = samples,
                            .receivers = receivers,
                            .pings = pings,
                            .compressed = true,
                            .aperture_limit = INFINITY};
    CHECK(acquisition_allocate(&a));
    return a;
}

void support_noise(struct acquisition *a, struct random *random, struct echoes *echoes)
{
    a->noise = 1;
    CHECK(echoes_allocate(a, PRECISION_DOUBLE, echoes));
    for (int n = 0; n < a->samples * a->receivers * a->pings; n++)
        ((double complex *)echoes->samples)[n] = random_normal(random);
}

void support_flat_noise(double band, struct acquisition *a, struct echoes *echoes)
{
    enum { SAMPLES = 240, PINGS = 24 };
    struct random random = random_seed(3, 1);
    *a = support_acquisition(PINGS, 1, SAMPLES);
    a->bandwidth = band * a->fs;
    CHECK(echoes_allocate(a, PRECISION_DOUBLE, echoes));
    double complex *s = (double complex *)echoes->samples;
    for (int p = 0; p < PINGS; p++) {
        a->t0[p] = 780 / a->fs;
        a->tx[p].x = a->rx[p].x = (p - PINGS / 2) * 0.171;
        a->velocity[p].x = 2.5;
        const int edge = (int)floor(band * SAMPLES / 2);
        double complex bins[SAMPLES] = {0};
        for (int k = -edge; k <= edge; k++)
            bins[(k + SAMPLES) % SAMPLES] += random_normal(&random);
        for (int n = 0; n < SAMPLES; n++, s++) {
            *s = 0;
            for (int k = -edge; k <= edge; k++)
                *s += bins[(k + SAMPLES) % SAMPLES] * cexp(2 * M_PI * I * (k * n % SAMPLES) / SAMPLES);
        }
    }
}

enum status support_image(const char *text, struct problem problem, const struct echoes *echoes, struct image *image)
{
    struct spec spec;
    struct echoes converted;
    CHECK(spec_parse(text, &spec));
    CHECK(echoes_convert(echoes, spec.precision, &converted));
    problem.precision = spec.precision;
    enum status status = imaging_form(&spec, &problem, &converted, image, NULL);
    echoes_free(&converted);
    spec_free(&spec);
    return status;
}

struct work support_work(const char *text, struct problem problem)
{
    struct spec spec;
    void *plan;
    CHECK(spec_parse(text, &spec));
    problem.precision = spec.precision;
    CHECK(algorithm_plan(spec.algorithm, &problem, spec.options, &plan));
    const struct work work = spec.algorithm->work(plan);
    spec.algorithm->destroy(plan);
    spec_free(&spec);
    return work;
}

void support_pixel_set(struct image *image, int patch, int i, int j, double complex value)
{
    size_t at = (size_t)i * (size_t)image->patches[patch].x_count + (size_t)j;
    if (image->precision == PRECISION_DOUBLE)
        ((double complex *)image->pixels[patch])[at] = value;
    else
        ((float complex *)image->pixels[patch])[at] = (float complex)value;
}

void support_image_make(const struct grid *patches, int count, enum precision precision, struct image *image)
{
    assert_int_equal(image_allocate(count, patches, precision, image), STATUS_OK);
}

double support_difference(const struct image *a, const struct image *b)
{
    double difference = 0, norm = 0;
    for (int k = 0; k < b->patch_count; k++)
        for (int i = 0; i < b->patches[k].r_count; i++)
            for (int j = 0; j < b->patches[k].x_count; j++) {
                double complex exact = image_pixel(b, k, i, j), delta = image_pixel(a, k, i, j) - exact;
                difference += creal(delta) * creal(delta) + cimag(delta) * cimag(delta);
                norm += creal(exact) * creal(exact) + cimag(exact) * cimag(exact);
            }
    return sqrt(norm > 0 ? difference / norm : difference);
}

double support_peak(const struct image *image)
{
    double peak = 0;
    for (int k = 0; k < image->patch_count; k++)
        for (int i = 0; i < image->patches[k].r_count; i++)
            for (int j = 0; j < image->patches[k].x_count; j++)
                peak = worse_of(peak, cabs(image_pixel(image, k, i, j)));
    return peak;
}

bool support_recording(const char *file, char *path, size_t size)
{
    const char *directory = getenv("SASBENCH_DATA");
    snprintf(path, size, "%s/%s", directory ? directory : SASBENCH_ROOT "/../shared/data", file);
    return access(path, R_OK) == 0;
}

char folder[256];

static int folder_named(const char *name)
{
    const char *base = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/%s-XXXXXX", base ? base : "/tmp", name);
    return mkdtemp(folder) ? 0 : -1;
}

int folder_make(void **state)
{
    (void)state;
    return folder_named("sasbench");
}

int folder_make_quoted(void **state)
{
    (void)state;
    return folder_named("it's a sasbench");
}

const char *gnuplot_text(const char *text)
{
    static char quoted[2000];
    size_t length = 0;
    quoted[length++] = '\'';
    for (; *text; text++) {
        assert_true(length + 4 < sizeof quoted);
        if (*text == '\'')
            quoted[length++] = '\'';
        quoted[length++] = *text;
    }
    snprintf(quoted + length, 2, "'");
    return quoted;
}

int folder_remove(void **state)
{
    (void)state;
    char command[300];
    snprintf(command, sizeof command, "rm -r \"%s\"", folder);
    return system(command);
}

const char *path_of(const char *name)
{
    static char paths[4][400];
    static int next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

bool support_exists(const char *name)
{
    return access(path_of(name), F_OK) == 0;
}

void support_write(const char *name, const char *text)
{
    FILE *file = fopen(path_of(name), "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

char *support_read(const char *name)
{
    struct stat info;
    FILE *file = fopen(path_of(name), "r");
    if (!file)
        return NULL;
    assert_int_equal(fstat(fileno(file), &info), 0);
    char *text = calloc((size_t)info.st_size + 1, 1);
    assert_non_null(text);
    assert_int_equal(fread(text, 1, (size_t)info.st_size, file), info.st_size);
    fclose(file);
    return text;
}

int support_shell(const char *lines)
{
    char command[3000];
    snprintf(command, sizeof command, "cd \"$TEST_FOLDER\" && { %s\n} >>out 2>>err", lines);
    if (setenv("ROOT", SASBENCH_ROOT, 1) != 0 || setenv("TEST_FOLDER", folder, 1) != 0)
        return -1;
    const int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void assert_shell(const char *lines, int wanted)
{
    const int status = support_shell(lines);
    if (status == wanted)
        return;
    char *said = support_read("err");
    fail_msg("%s exits with %d, says: %s", lines, status, said ? said : "");
}

char *support_read_cells(const char *path)
{
    char *text = support_read(path), *to = text;
    for (const char *at = text; at && *at;) {
        const size_t length = *at == '<' ? strcspn(at, ">") + 1 : 1;
        if (strncmp(at, "<tr", 3) == 0 || strncmp(at, "</td", 4) == 0 || strncmp(at, "</th>", 5) == 0)
            *to++ = '|';
        else if (*at != '<')
            *to++ = *at;
        at += length;
    }
    if (to)
        *to = '\0';
    return text;
}

enum status image_file_read(const char *path, struct grid *grid, double complex **pixels)
{
    struct image_file file;
    const enum status status = image_file_open(path, &file);
    *pixels = NULL;
    if (status != STATUS_OK)
        return status;
    *grid = file.patches[0];
    *pixels = file.image.pixels[0];
    file.image.pixels[0] = NULL;
    image_file_close(&file);
    return STATUS_OK;
}

double support_beam_weight(const struct scene *scene, int ping, int receiver, struct vector p, double tau,
                           double frequency)
{
    const struct beam_angles angles = beam_angles(&scene->acquisition, ping, receiver, p, tau);
    const double offset = frequency - scene->acquisition.fc;
    double weight;
    beam_weights(scene, &angles, &offset, 1, &weight);
    return weight;
}
