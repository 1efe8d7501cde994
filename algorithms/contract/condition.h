/* Conditions for an algorithm to image a scene correctly: by name, each with its value and its limit, before any
   work. */
#ifndef SASBENCH_CONTRACT_CONDITION_H
#define SASBENCH_CONTRACT_CONDITION_H

#include <stdbool.h>
#include <stddef.h>

#include "contract/acquisition.h"
#include "contract/status.h"

struct problem;

enum severity {
    SEVERITY_REFUSE, /* the algorithm does not image the scene */
    SEVERITY_WARN,   /* it does, and the image, back projection's as well, may have the condition's fault */
    SEVERITY_INFORM  /* decides which way of computing is possible */
};

struct condition {
    const char *name;
    double value, limit;
    bool at_least; /* the value must lie above the limit, not below */
    enum severity severity;
    const char *meaning; /* of the value: a static text */
    char cure[200];      /* a remedy, in figures where they are known */
};

enum { CONDITIONS_MAX = 24 }; /* of one algorithm */

/* A condition whose value may be at most `limit`, or must lie above it. */
struct condition condition_most(enum severity severity, const char *name, double value, double limit,
                                const char *meaning, const char *cure);
struct condition condition_least(enum severity severity, const char *name, double value, double limit,
                                 const char *meaning, const char *cure);

/* Is the condition met? Not by NaN. */
bool condition_holds(const struct condition *condition);
/* A further part of the cure, formatted. */
#ifdef __GNUC__
__attribute__((format(printf, 2, 3)))
#endif
void condition_cure_add(struct condition *condition, const char *format, ...);
/* A value to three digits, rounded down, so that it is a valid upper limit. */
double condition_at_most(double value);
/* "condition NAME: MEANING is VALUE; at most LIMIT is needed (cure: CURE)". */
void condition_message(const struct condition *condition, char *text, size_t size);
/* True if none of `list` refuses. */
bool conditions_accept(const struct condition *list, int count);
/* STATUS_UNSUPPORTED with the message of the first of `list` that refuses and is not met; `name` is the algorithm's. */
enum status conditions_check(const char *name, const struct condition *list, int count);

/* Fill list[room] with the conditions that all algorithms have, in the order of their names in docs/conditions.md, and
   return their number. */
int conditions_general(const struct problem *problem, struct condition *list, int room);
/* The conditions of back projections: the general ones, and those of azimuth sampling by pings and receivers. */
int conditions_sampled(const struct problem *problem, struct condition *list, int room);

enum { CONDITIONS_SCENE = 10 };
/* Fill `list` with the conditions of the scene itself, for any algorithm, and return the number: units, pixels as fine
   as the image's resolution, pixels and patches within the records, pixels within the beam, the beam within the
   records. All of them warn. Without patches: units and the conditions of the pings alone. */
int conditions_scene(const struct problem *problem, struct condition list[CONDITIONS_SCENE]);

/* Of a straight track, `spacing` m from ping to ping: the sampling of the azimuth band; with several receivers,
   ghosts. */
struct condition condition_doppler(const struct problem *problem, double spacing);
/* If the echoes' beam is not given, let the cure be to give it. */
void condition_beam_named(const struct acquisition *acquisition, struct condition *condition);
struct condition condition_ghost(const struct acquisition *acquisition, double spacing);

/* m/s: of the fastest ping. */
double condition_speed(const struct acquisition *acquisition);
/* Unit vector from the first ping to the last, x >= 0, along which an array's offsets count; distance along it from one
   place to another, m. */
struct vector condition_axis(const struct acquisition *acquisition);
double condition_along(struct vector axis, struct vector from, struct vector to);
/* s/m: the steepest delay along the track, less that on the beam's axis, over places of the patches and pings that see
   them. */
double condition_slope(const struct problem *problem);
/* Offset of the receiver that is n/2 of the way from the least to the greatest, m along the track; n = 0, 1, 2. */
double condition_offset(const struct acquisition *acquisition, int n);
/* |sin theta_t| up to which the echoes count: their stated truncation, where both elements' amplitude falls to a
   quarter, or the half-power beam of a transmitter of given length; INFINITY where none is given. */
double condition_beam_sine(const struct acquisition *acquisition);
/* The same whether the amplitude tapers or not: the stated truncation, or the half-power beam. */
double condition_cut_sine(const struct acquisition *acquisition);
/* Does a ping see a place within this sine (condition_beam_sine, which takes a search) of its beam's axis? */
bool condition_sees(const struct acquisition *acquisition, double sine, int ping, struct vector place);
/* Do all echoes come from within a given beam, without noise? */
bool condition_beam_known(const struct acquisition *acquisition);
/* |sin theta_t| up to which anything is seen at all: condition_beam_sine, but three nulls of a beam that tapers. */
double condition_seen_sine(const struct acquisition *acquisition);
/* Amplitude of the echo of a unit target r m beside a straight track along x, the transmitter u m ahead of it: 1 inside
   the beam, or both elements' sinc where the echoes taper; 0 where it is not seen. */
double condition_amplitude(const struct acquisition *acquisition, double r, double u);
/* The same by the receiver d m ahead of the transmitter, whose own sinc counts from its place. */
double condition_pair_amplitude(const struct acquisition *acquisition, double r, double u, double d);
/* sin(pi z)/(pi z) */
double condition_sinc(double z);
/* The larger of two values; NAN, which meets no limit, if one of them is. */
double condition_worse(double worst, double value);

#endif
