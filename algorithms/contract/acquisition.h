/* The recording: all about the echoes but the samples themselves. */
#ifndef SASBENCH_CONTRACT_ACQUISITION_H
#define SASBENCH_CONTRACT_ACQUISITION_H

#include <complex.h>
#include <math.h>
#include <stdbool.h>

#include "contract/status.h"

/* A point or a direction in space. x runs along the track (azimuth), y across it; pixels lie at (x, r, 0). */
struct vector {
    double x, y, z;
};

static inline struct vector vector_difference(struct vector a, struct vector b)
{
    return (struct vector){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline double vector_dot(struct vector a, struct vector b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline double vector_norm(struct vector v)
{
    return sqrt(vector_dot(v, v));
}

/* PF05 Eq. (12): |x - x_c| < half_x and |r - r_c| < half_r, m. */
struct target_area {
    double x, r, half_x, half_r; /* half_x = half_r = 0: none */
};

/* Owner: whoever made it (a scene or an echo file), freed with acquisition_free. Plans only read it and may keep the
   pointer until they are destroyed. All arrays are ping-major. */
struct acquisition {
    double sound_speed;          /* c, m/s, > 0, <= 1e9 */
    double fc;                   /* carrier frequency, Hz, >= 1e-6 fs; echo phase is exp(-j 2 pi fc tau) */
    double fs;                   /* sampling rate of the complex baseband, Hz, >= bandwidth */
    double bandwidth;            /* B, Hz, > 0 */
    int samples;                 /* N: fast-time samples of a record, >= 2 */
    int receivers;               /* M >= 1 */
    int pings;                   /* P >= 1 */
    double *t0;                  /* [pings] s: time of each record's first sample after emission */
    struct vector *tx;           /* [pings] m: transmitter at emission */
    struct vector *rx;           /* [pings][receivers] m: receivers at the transmitter's emission */
    struct vector *velocity;     /* [pings] m/s: of the receivers during propagation; zero = stop-and-hop */
    double pri;                  /* s: from each ping to the next; 0 = not given */
    double tx_length, rx_length; /* m: element lengths along the track; 0 = not given */
    double echo_sine;            /* echoes come from |sin theta_t| <= this; 0 = not given, INFINITY = anywhere */
    double echo_squint;          /* rad: the beam's axis, from which theta_t counts, ahead of broadside (r > 0) */
    bool echo_tapers;            /* and their amplitude falls as both elements' sinc does */
    bool noisy;                  /* the samples contain, or may contain, noise, which comes from anywhere */
    bool filtered;               /* a filter made the samples: what they hold beyond the band is unknown */
    double noise;                /* share of white noise in the compressed echoes' energy, where known; 0: none */
    double aperture_limit;       /* back projection sums pairs with |sin theta_t| <= this only; INFINITY = all */
    struct target_area area;     /* the area of interest; a filter may remove the echoes from elsewhere */
    bool compressed;             /* the samples are range compressed: a unit target peaks at 1 */
    int pulse_length;            /* K: samples of the replica; 0 if compressed */
    double complex *pulse;       /* [pulse_length] replica at fs, beginning at emission; NULL if compressed */
};

/* Allocate the arrays for `samples`, `receivers`, `pings` (set beforehand) and `pulse_length`, zeroed. Errors:
   STATUS_FAILED without memory. acquisition_free releases them and clears the struct; it accepts a zeroed struct. */
enum status acquisition_allocate(struct acquisition *acquisition);
void acquisition_free(struct acquisition *acquisition);

/* Pings [first, first + pings) of it: a view of its arrays, nothing to free. */
struct acquisition acquisition_part(const struct acquisition *acquisition, int first, int pings);

/* Check every condition stated above (ranges, finite numbers, |velocity| < c, phase precise enough: 8 pi fc tau eps <=
   1e-3). `place` (a file name) begins the message. Errors: STATUS_INVALID. */
enum status acquisition_check(const struct acquisition *acquisition, const char *place);

/* A copy, freed by the caller, in axes turned by `angle` (rad) about the origin: x' = x cos - y sin,
   y' = x sin + y cos. Errors: STATUS_FAILED without memory. */
enum status acquisition_turn(const struct acquisition *acquisition, double angle, struct acquisition *out);

/* Unit vector along the track at ping p: the difference of the neighbouring transmitter positions; the velocity's
   direction for a single ping; +x where both vanish. */
struct vector acquisition_heading(const struct acquisition *acquisition, int ping);

/* Unit vector normal to the plane that theta_t of ping p counts from: the heading, turned by the beam's squint, so that
   the plane contains the beam's axis (r > 0). A squint points towards +x whichever way the track runs. */
struct vector acquisition_normal(const struct acquisition *acquisition, int ping);

/* A uniform straight track: tx(p).x = x_first + p spacing, rx(p, m).x - tx(p).x = offset(m), y = z = 0, one velocity
   (speed, 0, 0) and one t0, all within lambda/1000 (offset(m) is read from the first ping). */
struct straight_track {
    double x_first, spacing; /* m; spacing may be negative, never 0 with more than one ping */
    double speed;            /* m/s along +x, of the receivers during propagation */
};

/* Wavelengths: the tolerance of a uniform straight track. */
#define ACQUISITION_UNEVEN_MOST 1e-3

/* m: the greatest distance of transmitters, receivers, starts of record (times the sound speed) and velocities (times
   the longest delay) from the nearest uniform straight track, *track; INFINITY where all pings are in one place. */
double acquisition_unevenness(const struct acquisition *acquisition, struct straight_track *track);

/* True when the track is uniform and straight; fills *track (may be NULL). */
bool acquisition_is_straight(const struct acquisition *acquisition, struct straight_track *track);

#endif
