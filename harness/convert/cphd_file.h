/* CPHD files (NGA.STND.0068, version 1): a head of text, XML, parameters of each vector, samples; binary numbers are
   big endian. */
#ifndef SASBENCH_CONVERT_CPHD_FILE_H
#define SASBENCH_CONVERT_CPHD_FILE_H

#include <complex.h>
#include <stdbool.h>
#include <sys/types.h>

#include "contract/acquisition.h"
#include "convert/xml.h"

/* What is read of each vector. */
enum {
    CPHD_TX_TIME,
    CPHD_TX_POS,
    CPHD_RCV_TIME,
    CPHD_RCV_POS,
    CPHD_RCV_VEL,
    CPHD_SRP_POS,
    CPHD_A_FDOP,
    CPHD_FX1,
    CPHD_FX2,
    CPHD_SC0,
    CPHD_SCSS,
    CPHD_AMP_SF,
    CPHD_PARAMETERS
};

/* An open file, and its reference channel. */
struct cphd_file {
    const char *path;
    int descriptor;
    struct xml xml;
    bool is_toa;           /* samples of time of arrival, else of frequency */
    int sign;              /* of phases, 1 or -1 */
    int channels, channel; /* how many there are, and which this is, from 0 */
    int vectors, samples;
    int part_bytes;               /* of a real or imaginary part: whole numbers of 1 or 2 bytes, floats of 4 */
    off_t parameters, signal;     /* where the channel's begin */
    off_t vector_bytes;           /* of all parameters of a vector */
    off_t words[CPHD_PARAMETERS]; /* of 8 bytes, from a vector's beginning to a parameter; -1: not there */
};

/* `path` is kept; closed with cphd_close, also after a failure. Errors: STATUS_INVALID
   naming file, field, value and what is accepted; STATUS_FAILED without memory. */
enum status cphd_open(const char *path, struct cphd_file *file);
void cphd_close(struct cphd_file *file);

/* Text and number of a field of the XML; `accepted` is for messages. Errors: STATUS_INVALID, also where it is missing.
   The text is owned by the file. */
enum status cphd_text(const struct cphd_file *file, const char *field, const char *accepted, const char **text);
enum status cphd_number(const struct cphd_file *file, const char *field, double *number);
/* The same of the fields FIELD/X, FIELD/Y and FIELD/Z. */
enum status cphd_place(const struct cphd_file *file, const char *field, struct vector *place);

/* All parameters of vector number `vector` from 0, in x the scalars; AmpSF is 1 where it is not there. All are finite.
   Errors: STATUS_INVALID. */
enum status cphd_vector(const struct cphd_file *file, int vector, struct vector parameters[CPHD_PARAMETERS]);
/* Refuse a parameter of a vector; `why` tells value and what is accepted. */
enum status cphd_refuse(const struct cphd_file *file, int parameter, int vector, const char *why);
/* The samples of a vector: [samples], as they are, finite. Errors: STATUS_INVALID. */
enum status cphd_samples(const struct cphd_file *file, int vector, double complex *samples);

#endif
