/* What the tests of MATLAB files share (mat_fixture.h). */
#include "tests/echoes/mat_fixture.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

char directory[128];
char path[160];

int fixture_make(void **state)
{
    (void)state;
    const char *parent = getenv("TMPDIR");
    snprintf(directory, sizeof directory, "%s/sasbench.XXXXXX", parent ? parent : "/tmp");
    if (!mkdtemp(directory)) {
        return -1;
    }
    snprintf(path, sizeof path, "%s/test.mat", directory);
    return 0;
}

int directory_remove(void **state)
{
    (void)state;
    unlink(path);
    return rmdir(directory);
}

/* Nothing but . and .. and, perhaps, the one file. */
void assert_no_temporary_files(void)
{
    DIR *listing = opendir(directory);
    assert_non_null(listing);
    for (const struct dirent *entry; (entry = readdir(listing));) {
        assert_true(entry->d_name[0] == '.' || strcmp(entry->d_name, "test.mat") == 0);
    }
    closedir(listing);
}

void assert_ok(enum status status)
{
    if (status != STATUS_OK) {
        fail_msg("status %d: %s", status, status_message());
    }
}

/* Refused, in one line that begins with the path and says `says`. */
void assert_invalid(enum status status, const char *says)
{
    if (status != STATUS_INVALID || strncmp(status_message(), path, strlen(path)) != 0 || strchr(status_message(), '\n')
        || !strstr(status_message(), says)) {
        fail_msg("status %d, \"%s\" does not say \"%s\"", status, status_message(), says);
    }
}

void assert_echoes_invalid(const char *says)
{
    struct acquisition acquisition;
    struct echoes echoes;
    assert_invalid(echo_file_read(path, &acquisition, &echoes), says);
    assert_null(acquisition.tx);
    assert_null(echoes.samples);
}

struct acquisition make_acquisition(int samples, int receivers, int pings, bool compressed)
{
    struct acquisition a = {.sound_speed = 1500.25,
                            .fc = 150e3,
                            .fs = 40e3,
                            .bandwidth = 20e3,
                            .samples = samples,
                            .receivers = receivers,
                            .pings = pings,
                            .pri = 0.3,
                            .tx_length = 0.04,
                            .rx_length = 0.03,
                            .aperture_limit = 0.25,
                            .echo_sine = compressed ? INFINITY : 0.07,
                            .echo_tapers = !compressed,
                            .echo_squint = compressed ? 0.3490658503988659 : 0,
                            .area = compressed ? (struct target_area){1 / 3.0, 20, 1.5, 2} : (struct target_area){0},
                            .compressed = compressed,
                            .pulse_length = compressed ? 0 : 3};
    assert_ok(acquisition_allocate(&a));
    for (int p = 0; p < pings; p++) {
        a.t0[p] = 0.05;
        a.tx[p] = (struct vector){0.1 * p, 0.01 * p, -p};
        a.velocity[p] = (struct vector){2, 0, -0.1};
        for (int m = 0; m < receivers; m++) {
            a.rx[p * receivers + m] = (struct vector){0.1 * p + 0.03 * m, 1.0 / 3 + m, p - m};
        }
    }
    for (int k = 0; k < a.pulse_length; k++) {
        a.pulse[k] = 0.1 * k - I;
    }
    return a;
}

void fill_echoes(struct echoes *echoes)
{
    const struct acquisition *a = echoes->acquisition;
    for (int i = 0; i < a->samples * a->receivers * a->pings; i++) {
        double complex z = sin(0.7 * i * i) - 1e-3 * I * i;
        if (echoes->precision == PRECISION_FLOAT) {
            ((float complex *)echoes->samples)[i] = (float complex)z;
        } else {
            ((double complex *)echoes->samples)[i] = z;
        }
    }
}

void variable_add(mat_t *mat, const struct mat_values *values, bool packed)
{
    size_t dims[3] = {values->dims[0], values->dims[1], values->dims[2]};
    mat_complex_split_t parts = {(void *)values->values, (void *)values->imaginary};
    matvar_t *matvar = Mat_VarCreate(values->name, values->class, values->type, dims[2] == 1 ? 2 : 3, dims,
                                     values->imaginary ? (void *)&parts : (void *)values->values,
                                     values->imaginary ? MAT_F_COMPLEX : 0);
    assert_non_null(matvar);
    assert_int_equal(Mat_VarWrite(mat, matvar, packed ? MAT_COMPRESSION_ZLIB : MAT_COMPRESSION_NONE), 0);
    Mat_VarFree(matvar);
}

/* Begin a file with everything that an echo file needs but `except`. Values are 0.001 (index + 1), or given. */
mat_t *file_begin(enum mat_ft version, bool packed, const char *except)
{
    static const struct {
        const char *name;
        size_t rows, columns, pages;
        bool is_complex;
        double value; /* of a scalar */
    } variables[] = {
        {"samples", N, M, P, true, 0},
        {"compressed", 1, 1, 1, false, 0},
        {"pulse", K, 1, 1, true, 0},
        {"fs", 1, 1, 1, false, 30e3},
        {"fc", 1, 1, 1, false, 100e3},
        {"bandwidth", 1, 1, 1, false, 20e3},
        {"sound_speed", 1, 1, 1, false, 1500},
        {"t0", 1, 1, 1, false, 0.1},
        {"tx_length", 1, 1, 1, false, 0.1},
        {"tx", 3, P, 1, false, 0},
        {"rx", 3, M, P, false, 0},
        {"velocity", 3, 1, 1, false, 0},
    }; /* the last one is not optional: a file cut at its beginning must not pass */
    mat_t *mat = Mat_CreateVer(path, NULL, version);
    assert_non_null(mat);
    if (strcmp(except, "format") != 0) {
        variable_add(mat, &(struct mat_values){"format", MAT_C_CHAR, MAT_T_UTF8, {1, 12, 1}, "sas-echoes 1", NULL},
                     packed);
    }
    for (size_t i = 0; i < sizeof variables / sizeof *variables; i++) {
        double values[MOST];
        for (int k = 0; k < MOST; k++) {
            values[k] = variables[i].value != 0 ? variables[i].value : 1e-3 * (k + 1);
        }
        if (strcmp(variables[i].name, "compressed") == 0) {
            values[0] = 0;
        }
        if (strcmp(variables[i].name, except) != 0) {
            variable_add(mat,
                         &(struct mat_values){variables[i].name,
                                              MAT_C_DOUBLE,
                                              MAT_T_DOUBLE,
                                              {variables[i].rows, variables[i].columns, variables[i].pages},
                                              values,
                                              variables[i].is_complex ? values : NULL},
                         packed);
        }
    }
    return mat;
}

/* A file's bytes: read, changed, written again. */
unsigned char *bytes_read(size_t *size)
{
    struct stat status;
    assert_int_equal(stat(path, &status), 0);
    *size = (size_t)status.st_size;
    unsigned char *bytes = malloc(*size);
    FILE *file = fopen(path, "rb");
    assert_true(bytes && file && fread(bytes, 1, *size, file) == *size);
    fclose(file);
    return bytes;
}

void bytes_write(const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}
