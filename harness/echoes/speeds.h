/* Recordings in which each ping has a sound speed of its own. All that images knows one: records move to it as they are
   read. A delay R/c_p becomes R/c0 where the record's time is stretched by c0/c_p from the emission on,

       z(t) = y(t c0/c_p) exp(j 2 pi fc t (c0/c_p - 1)),

   of compressed echoes y: raw ones are compressed first, as their pulse would be stretched, too. Receivers that move
   during propagation move as far within the stretched time where their velocity is c0/c_p times as large. Images are
   then those of the true speeds. */
#ifndef SASBENCH_ECHOES_SPEEDS_H
#define SASBENCH_ECHOES_SPEEDS_H

#include "contract/algorithm.h"

/* The speeds of a->pings pings, m/s: *a gets their mean, and velocities and band of moved records; raw echoes become
   compressed ones, without a pulse. Equal speeds change nothing but a->sound_speed. Errors: STATUS_INVALID, naming
   `path`, ping, value and what is accepted. */
enum status speeds_unite(const char *path, const double *speeds, struct acquisition *a);

/* Move the records of some pings: read [a->pings] (NULL: of all), samples [pings][receivers][samples] of the precision.
   `pulse` [pulse_length]: of raw echoes, else NULL. Equal speeds change nothing. Errors: STATUS_FAILED without
   memory. */
enum status speeds_move(const struct acquisition *a, const double *speeds, int pulse_length,
                        const double complex *pulse, const bool *read, enum precision precision, void *samples);

#endif
