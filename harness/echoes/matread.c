/* Reading MATLAB files through libmatio.

   A damaged file can make libmatio and HDF5 crash, or allocate what a few bytes claim. So a child process reads every
   file under resource limits, and sends the variables that we want through a pipe. If the child fails, the program
   refuses the file. */
#include "echoes/matread.h"

#include <errno.h>
#include <fcntl.h>
#include <hdf5.h>
#include <matio.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum {
    BLOCK = 4096,           /* numbers sent at a time */
    SPARE_BYTES = 256 << 20 /* what libmatio and HDF5 may use beyond the numbers themselves */
};

static void discard_log(int level, char *message)
{
    (void)level;
    (void)message;
}

void matio_silence(void)
{
    Mat_LogInitFunc("sasbench", discard_log);
}

#define DEFINE_LOAD(type)                                                                                              \
    static double load_##type(const void *data, size_t index)                                                          \
    {                                                                                                                  \
        return (double)((const type *)data)[index];                                                                    \
    }
DEFINE_LOAD(int8_t)
DEFINE_LOAD(uint8_t)
DEFINE_LOAD(int16_t)
DEFINE_LOAD(uint16_t)
DEFINE_LOAD(int32_t)
DEFINE_LOAD(uint32_t)
DEFINE_LOAD(int64_t)
DEFINE_LOAD(uint64_t)
DEFINE_LOAD(float)
DEFINE_LOAD(double)

static const struct {
    double (*load)(const void *data, size_t index);
    size_t size;
} number_types[] = {
    [MAT_T_INT8] = {load_int8_t, 1},     [MAT_T_UINT8] = {load_uint8_t, 1},   [MAT_T_INT16] = {load_int16_t, 2},
    [MAT_T_UINT16] = {load_uint16_t, 2}, [MAT_T_INT32] = {load_int32_t, 4},   [MAT_T_UINT32] = {load_uint32_t, 4},
    [MAT_T_INT64] = {load_int64_t, 8},   [MAT_T_UINT64] = {load_uint64_t, 8}, [MAT_T_SINGLE] = {load_float, 4},
    [MAT_T_DOUBLE] = {load_double, 8},   [MAT_T_UTF8] = {load_uint8_t, 1},    [MAT_T_UTF16] = {load_uint16_t, 2},
    [MAT_T_UTF32] = {load_uint32_t, 4},
};

static const char *const class_names[] = {
    [MAT_C_EMPTY] = "empty, or its attribute MATLAB_class is no text of fixed length (h5py: numpy.bytes_('double'))",
    [MAT_C_CELL] = "a cell array",
    [MAT_C_STRUCT] = "a struct",
    [MAT_C_OBJECT] = "an object",
    [MAT_C_CHAR] = "text",
    [MAT_C_SPARSE] = "a sparse matrix",
    [MAT_C_DOUBLE] = "numeric",
    [MAT_C_SINGLE] = "numeric",
    [MAT_C_INT8] = "numeric",
    [MAT_C_UINT8] = "numeric",
    [MAT_C_INT16] = "numeric",
    [MAT_C_UINT16] = "numeric",
    [MAT_C_INT32] = "numeric",
    [MAT_C_UINT32] = "numeric",
    [MAT_C_INT64] = "numeric",
    [MAT_C_UINT64] = "numeric",
    [MAT_C_FUNCTION] = "a function",
    [MAT_C_OPAQUE] = "an object",
};

static void limit_resource(__rlimit_resource_t resource, rlim_t wish)
{
    struct rlimit limit;
    if (getrlimit(resource, &limit) == 0) {
        limit.rlim_cur = wish < limit.rlim_max ? wish : limit.rlim_max;
        setrlimit(resource, &limit);
    }
}

/* This process only reads; a thread that reads is in the process of another program, whose limits stay as they are. */
static bool process_reads;

/* Allow the process the memory of `bytes` more than it has mapped now, and the time to read them and to look through a
   file of `file_size` bytes. Some damaged files lead HDF5 round in circles; several processes may read one file. */
static void limit_memory_and_time(size_t bytes, size_t file_size)
{
    if (!process_reads) {
        return;
    }
    limit_resource(RLIMIT_CPU, (rlim_t)(clock() / CLOCKS_PER_SEC) + 5 + bytes / 10000000 + file_size / 100000000);
#ifndef SANITIZED /* its shadow memory alone is terabytes of address space */
    unsigned long pages;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file && fscanf(file, "%lu", &pages) == 1) {
        limit_resource(RLIMIT_AS, (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE) + SPARE_BYTES + bytes);
    }
    if (file) {
        fclose(file);
    }
#endif
}

bool write_fully(int descriptor, const void *data, size_t size)
{
    for (const char *next = data; size > 0;) {
        ssize_t written = write(descriptor, next, size);
        if (written < 0 && errno != EINTR) {
            return false;
        }
        if (written > 0) {
            next += written;
            size -= (size_t)written;
        }
    }
    return true;
}

/* The dimensions of a variable, if it has no more than it may and the file can hold them: zlib packs at most 1032:1. */
enum status check_claim(const char *path, const struct wanted *wanted, const matvar_t *matvar, size_t file_size,
                        struct variable *variable)
{
    *variable = (struct variable){
        .is_complex = matvar->isComplex != 0, .is_single = matvar->class_type == MAT_C_SINGLE, .dims = {1, 1, 1, 1, 1}};
    size_t bytes = 16; /* at most, for one number */
    for (int i = 0; i < matvar->rank; i++) {
        if (i < (strchr(wanted->name, '/') ? DIMENSIONS_MOST : 3)) {
            variable->dims[i] = matvar->dims[i];
        } else if (matvar->dims[i] != 1) {
            return status_set(STATUS_INVALID, "%s: variable `%s` has %d dimensions; %s is needed", path, wanted->name,
                              matvar->rank, wanted->accepted);
        }
        if (__builtin_mul_overflow(bytes, matvar->dims[i], &bytes) || bytes / 16 / 1032 > file_size) {
            return status_set(STATUS_INVALID,
                              "%s: variable `%s` claims more numbers than the file's %zu bytes can hold", path,
                              wanted->name, file_size);
        }
    }
    /* Twice the numbers: HDF5 may hold a whole data set as one packed chunk. */
    limit_memory_and_time(2 * bytes, file_size);
    return STATUS_OK;
}

static bool is_empty(const matvar_t *matvar)
{
    bool empty = false;
    for (int i = 0; i < matvar->rank; i++) {
        empty = empty || matvar->dims[i] == 0;
    }
    return empty;
}

/* Find the numbers of a variable that was read: libmatio reports success for some without numbers. */
static bool variable_parts(const matvar_t *matvar, size_t count, mat_complex_split_t *parts)
{
    size_t type = (size_t)matvar->data_type;
    *parts = matvar->data && matvar->isComplex ? *(const mat_complex_split_t *)matvar->data
                                               : (mat_complex_split_t){matvar->data, NULL};
    return parts->Re && (parts->Im || !matvar->isComplex) && type < sizeof number_types / sizeof *number_types
           && number_types[type].load && matvar->nbytes / number_types[type].size >= count;
}

/* A block at a time, so that the numbers are not held twice. */
static bool send_values(mat_complex_split_t parts, enum matio_types type, size_t count, int descriptor)
{
    double block[2 * BLOCK];
    for (size_t first = 0; first < count; first += BLOCK) {
        size_t length = count - first < BLOCK ? count - first : BLOCK;
        for (size_t i = 0; i < length; i++) {
            block[2 * i] = number_types[type].load(parts.Re, first + i);
            block[2 * i + 1] = parts.Im ? number_types[type].load(parts.Im, first + i) : 0;
        }
        if (!write_fully(descriptor, block, 2 * length * sizeof *block)) {
            return false;
        }
    }
    return true;
}

/* Some pings alone. In version 5 all has been read, into `parts`. */
static bool send_pings(const char *path, const struct wanted *wanted, const mat_complex_split_t *parts,
                       enum matio_types type, const struct packet *packet, int descriptor)
{
    const struct pings *pings = wanted->pings;
    const size_t each = pings->each, most = 1 + (1 << 18) / (each + 1),
                 bytes = each * precision_size(packet->precision);
    void *values = parts ? NULL : malloc(most * bytes);
    bool sent = parts || values || pings->count == 0;
    struct ping_run run = {0, 0, each};
    if (pings->count > 0 && variable_count(&packet->variable) != (size_t)pings->count * each)
        return true; /* the other side refuses it */
    while (sent && pings_run_next(pings, most, &run)) {
        const size_t at = run.first * each * number_types[type].size, numbers = (run.end - run.first) * each;
        const mat_complex_split_t from = {parts ? (char *)parts->Re + at : NULL,
                                          parts && parts->Im ? (char *)parts->Im + at : NULL};
        sent = parts ? send_values(from, type, numbers, descriptor)
                     : mat73_read_pings(path, wanted->name, pings, &run, packet->precision, values)
                           && write_fully(descriptor, values, (run.end - run.first) * bytes);
    }
    free(values);
    return sent;
}

/* The variable itself, or the field of a struct that `name` asks for as "STRUCT/FIELD"; NULL: another. */
static matvar_t *variable_named(matvar_t *matvar, const char *name)
{
    const size_t length = strcspn(name, "/");
    if (!matvar->name || strlen(matvar->name) != length || strncmp(matvar->name, name, length) != 0)
        return NULL;
    if (!name[length])
        return matvar;
    const bool is_one =
        matvar->class_type == MAT_C_STRUCT && matvar->rank == 2 && matvar->dims[0] == 1 && matvar->dims[1] == 1;
    return is_one ? Mat_VarGetStructFieldByName(matvar, name + length + 1, 0) : NULL;
}

/* `place` is the variable's element in a file of version 5. */
static enum status send_variable(const char *path, const struct wanted *wanted, int index, mat_t *mat, matvar_t *matvar,
                                 const struct mat5 *place, size_t file_size, int descriptor)
{
    const char *name = wanted[index].name;
    bool is_text = matvar->class_type == MAT_C_CHAR || matvar->class_type == MAT_C_UINT16; /* its codes */
    bool is_number = matvar->class_type >= MAT_C_DOUBLE && matvar->class_type <= MAT_C_UINT64;
    if (wanted[index].kind == KIND_TEXT ? !is_text : !is_number) {
        bool is_known = (size_t)matvar->class_type < sizeof class_names / sizeof *class_names;
        return status_set(STATUS_INVALID, "%s: variable `%s` is %s; %s is needed", path, name,
                          is_known ? class_names[matvar->class_type] : "of unknown class", wanted[index].accepted);
    }
    if (is_empty(matvar)) {
        return is_text && wanted[index].is_optional
                   ? STATUS_OK /* as if it were not there */
                   : status_set(STATUS_INVALID, "%s: variable `%s` is empty; %s is needed", path, name,
                                wanted[index].accepted);
    }
    struct packet packet;
    memset(&packet, 0, sizeof packet);
    packet.index = index;
    packet.precision = PRECISION_DOUBLE;
    enum status status = check_claim(path, &wanted[index], matvar, file_size, &packet.variable);
    if (status != STATUS_OK) {
        return status;
    }
    size_t count = variable_count(&packet.variable);
    const struct stored stored = {name, count, matvar->isComplex != 0, matvar->class_type == MAT_C_CHAR};
    const struct pings *pings = wanted[index].pings;
    if (!pings || pings->count == 0 || place->file) /* else it was checked before */
        status = place->file ? mat5_check(path, &stored, place) : mat73_check(path, &stored);
    if (status != STATUS_OK) {
        return status;
    }
    mat_complex_split_t parts;
    if (pings && !place->file) {
        if (packet.variable.is_single)
            packet.precision = pings->precision;
        return write_fully(descriptor, &packet, sizeof packet)
                       && send_pings(path, &wanted[index], NULL, MAT_T_DOUBLE, &packet, descriptor)
                   ? STATUS_OK
                   : status_set(STATUS_INVALID, "%s: variable `%s` cannot be read by pings; %s is needed", path, name,
                                wanted[index].accepted);
    }
    if (Mat_VarReadDataAll(mat, matvar) != 0 || !variable_parts(matvar, count, &parts)) {
        return status_set(STATUS_INVALID, "%s: variable `%s` is damaged or cut short; a whole file is needed", path,
                          name);
    }
    if (!write_fully(descriptor, &packet, sizeof packet)
        || !(pings ? send_pings(path, &wanted[index], &parts, matvar->data_type, &packet, descriptor)
                   : send_values(parts, matvar->data_type, count, descriptor))) {
        return status_set(STATUS_FAILED, "%s: nobody reads on", path);
    }
    return STATUS_OK;
}

/* libmatio silently ends its list at what it cannot read, and what follows is as if it were not there. */
static enum status rest_check(const char *path, const struct wanted *wanted, int count, const bool *sent,
                              struct mat5 *place)
{
    bool is_whole = !place->file || !mat5_next(place);
    for (int i = 0; i < count && !place->file; i++) {
        is_whole = is_whole && (sent[i] || !mat73_has(path, wanted[i].name));
    }
    return is_whole ? STATUS_OK
                    : status_set(STATUS_INVALID,
                                 "%s: holds something that cannot be read before a variable that is needed: it is "
                                 "damaged, or has an HDF5 group of its own; a whole MATLAB file is needed",
                                 path);
}

static enum status send_variables(const char *path, const struct wanted *wanted, int count, size_t file_size,
                                  mat_t *mat, int descriptor)
{
    if (!mat || Mat_GetVersion(mat) == MAT_FT_MAT4) {
        return strchr(wanted->name, '/')
                   ? status_set(STATUS_INVALID, "%s: is neither a MATLAB file of version 5 or 7.3 nor HDF5", path)
                   : status_set(STATUS_INVALID, "%s: is not a MATLAB file of version 5 or 7.3%s", path,
                                file_other_format(path));
    }
    struct mat5 place = {0};
    if (Mat_GetVersion(mat) == MAT_FT_MAT5 && (mat5_count(path) < 0 || !mat5_open(&place, path))) {
        return status_set(STATUS_INVALID, "%s: is cut short or damaged; a whole MATLAB file is needed", path);
    }
    bool sent[WANTED_MAX] = {false};
    char inside[64] = ""; /* the first struct, in which the variables may be */
    enum status status = hdf5_prepare(path, wanted, count);
    matvar_t *matvar;
    while (status == STATUS_OK && (matvar = Mat_VarReadNextInfo(mat))) {
        mat5_next(&place); /* in step with libmatio */
        for (int i = 0; i < count && status == STATUS_OK; i++) {
            matvar_t *named = sent[i] ? NULL : variable_named(matvar, wanted[i].name);
            if (named) {
                status = send_variable(path, wanted, i, mat, named, &place, file_size, descriptor);
                sent[i] = true;
            }
        }
        if (matvar->class_type == MAT_C_STRUCT && matvar->name && !*inside) {
            snprintf(inside, sizeof inside, "%.60s", matvar->name);
        }
        Mat_VarFree(matvar);
    }
    if (status == STATUS_OK) {
        status = rest_check(path, wanted, count, sent, &place);
    }
    mat5_close(&place);
    for (int i = 0; i < count && status == STATUS_OK && *inside; i++) {
        if (!sent[i] && !wanted[i].is_optional && !strchr(wanted[i].name, '/')) {
            status = status_set(
                STATUS_INVALID,
                "%s: variable `%s` is missing; %s is needed. The file holds a struct `%s`: its fields must be "
                "variables of their own (MATLAB: save('-v7', FILE, '-struct', '%s'); SciPy: savemat(FILE, %s))",
                path, wanted[i].name, wanted[i].accepted, inside, inside, inside);
        }
    }
    return status;
}

void variables_reply(const char *path, const struct wanted *wanted, int count, size_t file_size, int descriptor)
{
    struct packet packet;
    memset(&packet, 0, sizeof packet);
    packet.index = END;
    matio_silence();
    hdf5_begin();
    if (strchr(wanted->name, '/') && H5Fis_hdf5(path) > 0) {
        packet.status = hdf5_fields_send(path, wanted, count, file_size, descriptor);
    } else {
        mat_t *mat = Mat_Open(path, MAT_ACC_RDONLY);
        packet.status = send_variables(path, wanted, count, file_size, mat, descriptor);
        if (mat)
            Mat_Close(mat);
    }
    hdf5_end();
    char message[MESSAGE_SIZE] = "";
    snprintf(message, sizeof message, "%s", status_message());
    if (write_fully(descriptor, &packet, sizeof packet)) {
        write_fully(descriptor, message, sizeof message);
    }
}

_Noreturn void variables_send(const char *path, const struct wanted *wanted, int count, size_t file_size,
                              int descriptor)
{
    /* A crash ends the child quietly: without the program's handlers, and without messages of libraries on stderr. */
    static const int crashes[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU};
    for (size_t i = 0; i < sizeof crashes / sizeof *crashes; i++) {
        signal(crashes[i], SIG_DFL);
    }
    int silence = open("/dev/null", O_WRONLY);
    dup2(silence, STDERR_FILENO);
    limit_resource(RLIMIT_CORE, 0);
    process_reads = true;
    limit_memory_and_time(0, file_size);
    variables_reply(path, wanted, count, file_size, descriptor);
    _exit(0); /* the parent's buffers and exit handlers are not ours */
}
