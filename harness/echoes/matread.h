/* The messages of the process, or the thread, that reads a MATLAB file to the one that started it. */
#ifndef SASBENCH_ECHOES_MATREAD_H
#define SASBENCH_ECHOES_MATREAD_H

#include "echoes/matfile.h"
#include "echoes/matvar.h"

enum { MESSAGE_SIZE = 1024 };

/* The child sends a packet and its values for each variable, then one with index END and the message. */
struct packet {
    enum { END = -1 } index; /* of the wanted variable, or END */
    enum status status;      /* END only */
    struct variable variable;
    enum precision precision; /* of the numbers that follow */
};

/* Read the file and send all of it. */
void variables_reply(const char *path, const struct wanted *wanted, int count, size_t file_size, int descriptor);
/* All that the reading process does, until it ends. */
_Noreturn void variables_send(const char *path, const struct wanted *wanted, int count, size_t file_size,
                              int descriptor);
/* Write all of it. False: errno has the reason. */
bool write_fully(int descriptor, const void *data, size_t size);
/* The dimensions of a variable that the file can hold, and limits of memory and time to read it. Errors:
   STATUS_INVALID. */
struct matvar_t;
enum status check_claim(const char *path, const struct wanted *wanted, const struct matvar_t *matvar, size_t file_size,
                        struct variable *variable);
/* Send the wanted fields of an HDF5 file, of MATLAB or not: data sets of numbers by their paths. Errors:
   STATUS_INVALID. */
enum status hdf5_fields_send(const char *path, const struct wanted *wanted, int count, size_t file_size,
                             int descriptor);
/* To the next run of pings to read, of at most `most`, behind the end of *run; false: none. */
bool pings_run_next(const struct pings *pings, size_t most, struct ping_run *run);

#endif
