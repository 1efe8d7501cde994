/* Echoes of a scene with exact delays, without the stop-and-hop approximation. */
#ifndef SASBENCH_SCENE_SIMULATE_H
#define SASBENCH_SCENE_SIMULATE_H

#include "scene/scene.h"

/* Allocates *echoes (double) and fills it; freed with echoes_free. lfm: the replica's spectrum delayed by
   exp(-j 2 pi (fc+f) tau), raw; lfm_time: the chirp sampled at n/fs - tau, raw; flat: spectrum 1 on |f| <= B/2 (bins
   at B/2 weigh 1/2), compressed. The same bits for any number of threads. Echoes of amplitudes beyond
   2^+-400 are divided by a power of two, exactly: echoes->exponent. Errors: STATUS_FAILED without memory,
   STATUS_INVALID for numbers so extreme that an echo is not finite; nothing to free then. */
enum status scene_simulate(const struct scene *scene, struct echoes *echoes);

/* The same ping by ping: room for `pings` of them is checked. `samples` [count][receivers][samples] are the echoes
   divided by 2^exponent. Errors: as scene_simulate; nothing to close then. */
struct simulation;
enum status simulation_open(const struct scene *scene, int pings, struct simulation **simulation);
int simulation_exponent(const struct simulation *simulation);
enum status simulation_pings(struct simulation *simulation, int first, int count, double complex *samples);
/* The adjoint: from `samples` [pings][receivers][samples] to each target's sum over all of them, times the conjugate of
   what a unit amplitude there adds. The same bits for any number of threads. Errors: STATUS_FAILED without memory,
   STATUS_INVALID for numbers so extreme that a sum is not finite. */
enum status simulation_adjoint(struct simulation *simulation, const double complex *samples,
                               double complex *amplitudes);
void simulation_close(struct simulation *simulation);

/* The scene's echoes: a copy of recorded ones, or simulated as above. Same errors. */
enum status scene_echoes(const struct scene *scene, struct echoes *echoes);
/* In each precision, in the unit of the double ones, whose exponent is set to 0: images of them are compared with each
   other. Same errors; nothing to free then. */
enum status scene_echoes_both(const struct scene *scene, struct echoes echoes[2]);

/* The replica of an LFM pulse: exp(j pi (B/T)(t - T/2)^2), t = k/fs in [0, T): floor(T fs) samples, at least 1. */
int pulse_length_lfm(double duration, double fs);
void pulse_lfm(double bandwidth, double duration, double fs, int length, double complex *pulse);

/* Sines of the angles off the beam's axis, which lies in the plane across the track but for its squint: of the
   transmitter at emission, of the receiver at reception, and at the bistatic midpoint of the two. tau: the exact delay,
   s, of target point p. */
struct beam_angles {
    double tx, rx, mid;
};
struct beam_angles beam_angles(const struct acquisition *a, int ping, int receiver, struct vector p, double tau);

/* weight [count]: amplitude of a pair's echo at frequencies `offset`, Hz from the carrier [count], by the scene's
   beam. */
void beam_weights(const struct scene *scene, const struct beam_angles *angles, const double *offset, int count,
                  double *weight);
/* |sin theta_t| up to which the scene's beam sees targets, by its truncation; INFINITY without a bound. */
double beam_sine(const struct scene *scene);

#endif
