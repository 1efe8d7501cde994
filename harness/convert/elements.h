/* Ultrasound by a probe: one element sends at a time, and all receive. */
#ifndef SASBENCH_CONVERT_ELEMENTS_H
#define SASBENCH_CONVERT_ELEMENTS_H

#include "convert/layout.h"

/* What a file has of it. Its (x, y, z), z into depth, is our (x, -z, y). */
struct elements {
    const struct variable *places; /* m */
    size_t place_step, axis_step;  /* numbers from one element to the next, from one axis to the next */
    /* Their real parts are the numbers of all records: real samples, or I and Q; quadrature NULL: real samples. */
    const double complex *in_phase, *quadrature;
    size_t sample_step, element_step, ping_step; /* numbers from one to the next */
    int samples;                                 /* of a record, >= 2 */
    double rate;                                 /* Hz: samples in a second */
    double fc;          /* Hz: what I and Q were mixed with; the middle of the band that is kept of real samples */
    double mixed_since; /* s: time of the first sample since I and Q were in phase with the carrier */
    const struct wanted *places_field, *rate_field, *fc_field; /* for messages */
};

/* Set the acquisition's fs, fc, bandwidth and samples, and allocate it and the echoes. Its sound speed, pings and
   receivers (of all elements) are set beforehand. Errors: STATUS_INVALID for frequencies and positions that do not fit,
   naming `path`, field and value; STATUS_FAILED without memory. */
enum status elements_open(const char *path, const struct elements *elements, struct recording *recording);
/* One ping's geometry: the element that sends, and the time of the first sample after its emission, s. */
void elements_ping(const struct elements *elements, int ping, size_t sender, double t0, struct acquisition *a);
/* The samples, once all pings are set. Errors: STATUS_FAILED without memory. */
enum status elements_fill(const struct elements *elements, struct recording *recording);
/* The place of an element in our axes, m. */
struct vector element_place(const struct elements *elements, size_t element);

#endif
