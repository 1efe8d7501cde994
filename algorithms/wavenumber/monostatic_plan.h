/* Multi-receiver echoes as the echoes of one monostatic sonar on a straight track, for what images these alone (SQ18
   section 1: echoes of many receivers are preprocessed, and imaged as those of one), and motion compensation.

   Receiver m of ping p becomes a ping of its own, nearly at the middle between it and the transmitter, on a straight
   raster of pings `spacing` apart. At the sonar's speed v, an echo from range rho along the beam's axis, theta off
   broadside, comes back to it at t with  rho = t (c^2 - v^2)/(2 (c - v sin theta)).  From that point the real pair,
   wherever it is, has the exact delay tau(t) (delay.h), so that its compressed record x becomes

       y(t) = x(tau(t)) exp(j 2 pi fc (tau(t) - t))

   by taps of least squares (range_migration/delay_compensation.h). Exact along the axis, at any range. From an angle
   theta' off it the phase is wrong: by an array of length d as pi fc d^2 (cos^2 theta' - cos^2 theta)/(2 c r), by a
   sway of s as 4 pi fc s (cos theta' - cos theta)/c, by a surge of s as 4 pi fc s (sin theta' - sin theta)/c.

   These phasors are nearly of low rank over the records n (delay_compensation.h has the same idea over receivers):
   exp(j phase) = sum over q of V_qn U_q(theta', t). Along the raster, theta' is the wavenumber nu, so that

       z(nu, t) = sum over q of U_q(nu, t) (transform over n of V_qn y_n(t))

   undoes them. The motion may vary from record to record: a product over records and one over wavenumbers are the
   adjoint of what it did, as back projection is. */
#ifndef SASBENCH_WAVENUMBER_MONOSTATIC_PLAN_H
#define SASBENCH_WAVENUMBER_MONOSTATIC_PLAN_H

#include "common/isa.h"
#include "common/memory.h"
#include "contract/algorithm.h"
#include "contract/delay.h"
#include "range_migration/spectrum.h"

struct traces;

enum {
    MONOSTATIC_NODES = 2048, /* fractions of a sample with weights: their steps err by 2e-4 at the band's edge */
    MONOSTATIC_TERMS = 8,    /* at most */
    MONOSTATIC_ANGLES = 65,  /* of the table of U, even in angle */
    MONOSTATIC_RANGES = 9,   /* even in 1/range */
    MONOSTATIC_STRIP = 8,    /* samples whose transforms go side by side */
    MONOSTATIC_STRIPS = 3    /* of a thread: the echoes, a term of them, the sum of the terms */
};

/* A record: its place among its ping's, and transmitter, receiver and its velocity from its ping of the raster. */
struct centre {
    int place;
    struct vector tx, rx, velocity;
};

struct monostatic;

/* ---- the loops of each instruction set (monostatic_lines.c) ---- */
/* Fill a row of `begins`, `nodes` and `turns`. */
typedef void monostatic_delays_function(const struct monostatic *m, int row);
/* A compressed record, with its guards, to a record of the raster, by a row of the tables. */
typedef void monostatic_record_function(const struct monostatic *m, int row, const void *record, void *converted);
/* A strip of all pings times V of a term: [pings receivers][MONOSTATIC_STRIP]. */
typedef void monostatic_vector_function(const struct monostatic *m, int term, const void *held, void *turned);
/* U of a term times the strip's transforms, that begins at sample `first`, is added to `sum`:
   [wavenumbers][MONOSTATIC_STRIP]. */
typedef void monostatic_product_function(const struct monostatic *m, int term, int first, const void *transforms,
                                         void *sum);
ISA_DECLARE(monostatic_delays_function, monostatic_delays);
ISA_DECLARE(monostatic_record_function, monostatic_record);
ISA_DECLARE(monostatic_vector_function, monostatic_vector);
ISA_DECLARE(monostatic_product_function, monostatic_product);

struct monostatic {
    const struct acquisition *acquisition; /* the problem's */
    enum precision precision;
    double first, spacing, speed, squint; /* m, signed; m/s; rad */
    double side;                          /* 1 or -1: of the track, that the rows lie on */
    bool straight;
    int rows;                           /* of tables: the receivers of a straight track, else all records */
    int taps, threads, length;          /* length: values of a compressed record with its guards */
    double left;                        /* relative L2 error that the conversion is predicted to leave */
    struct centre *centres;             /* [rows] */
    int *begins;                        /* [rows][samples]: of the taps in a compressed record */
    unsigned short *nodes;              /* [rows][samples]: their weights */
    void *turns;                        /* complex [rows][samples]: the phases; 0 where nothing is read */
    void *weights;                      /* real [MONOSTATIC_NODES + 1][taps][2]: twice, for both parts of a value */
    void *scratch;                      /* complex [threads][length] */
    int terms;                          /* 0: what is left needs none */
    double angle_first, angle_step;     /* rad off broadside: of the table */
    double inverse_first, inverse_step; /* 1/m */
    double complex *basis;              /* [terms][rows]: V */
    double complex *coefficients;       /* [terms][MONOSTATIC_RANGES][MONOSTATIC_ANGLES]: U */
    int wavenumbers;                    /* length of the transforms along the raster */
    void *vectors;                      /* complex [terms][pings receivers]: V along the raster */
    void *products;                     /* complex [terms][MONOSTATIC_RANGES][wavenumbers]: U */
    void *strips;                       /* complex [threads][MONOSTATIC_STRIPS][wavenumbers][MONOSTATIC_STRIP] */
    void *forward, *inverse;
    struct traces *traces;
    monostatic_delays_function *delays_loop;
    monostatic_record_function *record_loop;
    monostatic_vector_function *vector_loop;
    monostatic_product_function *product_loop;
    struct work work;
    struct store store;
};

/* The ping of the raster that record m of ping p becomes, counted from its first; and its row of the tables. */
static inline int monostatic_row(const struct monostatic *m, int ping, int receiver)
{
    return m->straight ? receiver : ping * m->acquisition->receivers + receiver;
}

/* Of the raster. */
static inline struct spectrum_setting monostatic_setting(const struct monostatic *m)
{
    return (struct spectrum_setting){
        .sound_speed = m->acquisition->sound_speed, .speed = m->speed, .fc = m->acquisition->fc};
}

/* m: along `angle` off broadside, of an echo that comes back to a ping of the raster after t. */
static inline double monostatic_range(const struct monostatic *m, double angle, double t)
{
    const double c = m->acquisition->sound_speed, v = m->speed;
    return t * (c - v) * (c + v) / (2 * (c - v * sin(angle)));
}

/* Seconds from emission: of a pair's echo from the point at `range` and `angle` off broadside of its ping of the
   raster. */
static inline double monostatic_pair_delay(const struct monostatic *m, const struct centre *centre, double range,
                                           double angle)
{
    const struct vector place = {range * sin(angle), m->side * range * cos(angle), 0};
    return delay_exact(centre->tx, centre->rx, centre->velocity, place, m->acquisition->sound_speed);
}

/* Of a pair's echo from the point on the axis from which its ping of the raster has an echo after t. NAN where t is not
   positive. */
static inline double monostatic_delay(const struct monostatic *m, const struct centre *centre, double t)
{
    return t > 0 ? monostatic_pair_delay(m, centre, monostatic_range(m, m->squint, t), m->squint) : NAN;
}

/* Set `left`, `terms` (the fewest that leave as little as all), their tables and these' extents. Failures are the
   store's. */
void monostatic_terms(struct monostatic *m, const struct problem *problem);
/* U of a term at a wavenumber (cycles/m) and a range of the table. */
double complex monostatic_value(const struct monostatic *m, int term, int range, double nu);

/* Tables and plans of a precision; failures are the store's. */
void monostatic_fill_float(struct monostatic *m);
void monostatic_fill_double(struct monostatic *m);
/* Records [pings][receivers][samples] to [pings receivers][samples]. The same bits for any number of threads. */
void monostatic_convert_float(const struct monostatic *m, const void *samples, void *converted);
void monostatic_convert_double(const struct monostatic *m, const void *samples, void *converted);

#endif
