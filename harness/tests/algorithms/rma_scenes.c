#include "tests/algorithms/rma_scenes.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>

/* A straight track at 3 m/s with 150 kHz and 20 kHz bandwidth, compressed records, receivers from the transmitter
   on. */
void make_scene(const struct rma_track *track, struct scene *scene)
{
    const int pings = track->pings, receivers = track->receivers;
    *scene = (struct scene){.pulse_kind = PULSE_FLAT, .beam = {BEAM_TXRX, TRUNCATION_DOPPLER, 0.5, true}};
    struct acquisition *a = &scene->acquisition;
    *a = (struct acquisition){.sound_speed = 1500,
                              .fc = 150e3,
                              .fs = track->fs,
                              .bandwidth = 20e3,
                              .samples = track->samples,
                              .receivers = receivers,
                              .pings = pings,
                              .tx_length = 0.08,
                              .rx_length = track->pitch,
                              .aperture_limit = INFINITY,
                              .compressed = true};
    assert_int_equal(acquisition_allocate(a), STATUS_OK);
    for (int p = 0; p < pings; p++) {
        a->t0[p] = track->t0;
        a->velocity[p].x = RMA_SPEED;
        a->tx[p].x = track->x_first + p * track->spacing;
        for (int m = 0; m < receivers; m++)
            a->rx[p * receivers + m].x = a->tx[p].x + m * track->pitch;
    }
    assert_int_equal(acquisition_check(a, "test"), STATUS_OK);
}

void free_scene(struct scene *scene)
{
    free(scene->targets);
    acquisition_free(&scene->acquisition);
}

/* One SPEC's image of a problem; the test fails where that fails. */
void form(const char *spec, struct problem problem, const struct echoes *echoes, struct image *image)
{
    if (support_image(spec, problem, echoes, image) != STATUS_OK)
        fail_msg("%s: %s", spec, status_message());
}

/* Targets at x = 0 and the ranges given. */
void add_targets(struct scene *scene, int count, const double *r)
{
    scene->target_count = count;
    scene->targets = calloc((size_t)count, sizeof *scene->targets);
    for (int t = 0; t < count; t++)
        scene->targets[t] = (struct target){0.01 * t - 0.02, r[t], cexp(I * t)};
}

double swath_error(const char *spec, struct problem problem, const struct echoes *echoes, const struct image *exact)
{
    struct image image;
    form(spec, problem, echoes, &image);
    double error = support_difference(&image, exact);
    print_message("    %-70s %.2e\n", spec, error);
    image_free(&image);
    return error;
}

double patch_error(const struct image *image, const struct image *exact, int patch)
{
    const struct grid *g = &exact->patches[patch];
    double difference = 0, norm = 0;
    for (int i = 0; i < g->r_count; i++)
        for (int j = 0; j < g->x_count; j++) {
            double complex value = image_pixel(exact, patch, i, j);
            difference += pow(cabs(image_pixel(image, patch, i, j) - value), 2);
            norm += pow(cabs(value), 2);
        }
    return sqrt(difference / norm);
}
