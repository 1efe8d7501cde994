/* MATLAB files in a folder of their own, as others may write them. */
#ifndef SASBENCH_TEST_MAT_FIXTURE_H
#define SASBENCH_TEST_MAT_FIXTURE_H

#include <matio.h>

#include "echoes/matfile.h"
#include "tests/support.h"

extern char directory[128];
extern char path[160]; /* the one file in it */

enum { N = 5, M = 2, P = 3, K = 4, MOST = 64 }; /* of the files that file_begin begins */

/* One variable of a file. */
struct mat_values {
    const char *name;
    enum matio_classes class;
    enum matio_types type;
    size_t dims[3];
    const void *values, *imaginary; /* imaginary: NULL for real ones */
};

/* Fixtures. */
int fixture_make(void **state);
int directory_remove(void **state);
/* Nothing but . and .. and, perhaps, the one file. */
void assert_no_temporary_files(void);
void assert_ok(enum status status);
/* Refused, in one line that begins with the path and says `says`. */
void assert_invalid(enum status status, const char *says);
void assert_echoes_invalid(const char *says);
/* A track in space; echoes of any numbers. */
struct acquisition make_acquisition(int samples, int receivers, int pings, bool compressed);
void fill_echoes(struct echoes *echoes);
void variable_add(mat_t *mat, const struct mat_values *values, bool packed);
/* Begin a file with everything that an echo file needs but `except`. Values are 0.001 (index + 1), or given. */
mat_t *file_begin(enum mat_ft version, bool packed, const char *except);
/* A file's bytes: read, malloc'ed; written again. */
unsigned char *bytes_read(size_t *size);
void bytes_write(const void *bytes, size_t size);

#endif
