/* Reading MATLAB files: the process that gets the variables from another, or from a thread (matread.c). */
#define _GNU_SOURCE /* pipe2, _Fork */
#include "echoes/matread.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

bool pings_run_next(const struct pings *pings, size_t most, struct ping_run *run)
{
    const size_t count = (size_t)pings->count;
    for (run->first = run->end; run->first < count && !pings->read[run->first];)
        run->first++;
    for (run->end = run->first; run->end < count && pings->read[run->end] && run->end - run->first < most;)
        run->end++;
    return run->first < run->end;
}

static enum status reader_crashed(const char *path)
{
    return status_set(STATUS_INVALID,
                      "%s: is damaged (its reader crashed, or ran out of memory or time); a MATLAB "
                      "file of version 5 or 7.3 is needed",
                      path);
}

static bool read_fully(int descriptor, void *data, size_t size)
{
    for (char *next = data; size > 0;) {
        ssize_t got = read(descriptor, next, size);
        if (got == 0 || (got < 0 && errno != EINTR)) {
            return false;
        }
        if (got > 0) {
            next += got;
            size -= (size_t)got;
        }
    }
    return true;
}

enum { BLOCK = 1 << 14 }; /* numbers received at a time */

/* Numbers that came in a precision, into samples from `at` on. */
static void block_put(const struct pings *pings, size_t at, const void *block, enum precision precision, size_t count)
{
    for (size_t i = 0; i < 2 * count; i++) {
        const double came = precision == PRECISION_FLOAT ? ((const float *)block)[i] : ((const double *)block)[i];
        const double part = pings->exponent ? ldexp(came, -pings->exponent) : came;
        if (pings->precision == PRECISION_FLOAT)
            ((float *)pings->samples)[2 * at + i] = (float)part;
        else
            ((double *)pings->samples)[2 * at + i] = part;
    }
}

static enum status not_finite(const char *path, const struct packet *packet, size_t at, const void *block)
{
    const size_t *dims = packet->variable.dims;
    for (;; at++, block = (const char *)block + precision_size(packet->precision)) {
        const double *both = block;
        const float *single = block;
        const double re = packet->precision == PRECISION_FLOAT ? single[0] : both[0];
        const double im = packet->precision == PRECISION_FLOAT ? single[1] : both[1];
        if (!isfinite(re) || !isfinite(im))
            return samples_refuse(path, dims, at, __builtin_complex(re, im));
    }
}

/* Some pings, to the place of their own. */
static enum status receive_pings(const char *path, const struct pings *pings, const struct packet *packet,
                                 int descriptor)
{
    static double block[2 * BLOCK];
    const size_t count = variable_count(&packet->variable), size = precision_size(packet->precision);
    struct ping_run run = {0, 0, pings->each};
    if (pings->count > 0 && count != (size_t)pings->count * pings->each)
        return status_set(STATUS_INVALID, "%s: has been replaced meanwhile", path);
    while (pings_run_next(pings, count, &run))
        for (size_t at = run.first * run.each, end = run.end * run.each, most; at < end; at += most) {
            most = end - at < BLOCK ? end - at : BLOCK;
            if (!read_fully(descriptor, block, most * size))
                return reader_crashed(path);
            const double largest = largest_part(block, packet->precision, most);
            if (!isfinite(largest))
                return not_finite(path, packet, at, block);
            block_put(pings, at, block, packet->precision, most);
            *pings->largest = fmax(*pings->largest, ldexp(largest, -pings->exponent));
        }
    return STATUS_OK;
}

/* As echoes_allocate gives it, so that samples need no copy. */
static double complex *values_allocate(size_t size)
{
    return size == 0 || size > PTRDIFF_MAX - 63 ? NULL : aligned_alloc(64, (size + 63) / 64 * 64);
}

static enum status receive_variable(const char *path, const struct pings *pings, const struct packet *packet,
                                    struct variable *variable, int descriptor)
{
    *variable = packet->variable;
    if (pings)
        return receive_pings(path, pings, packet, descriptor);
    const size_t size = size_product(variable_count(variable), sizeof(double complex), 1, 1);
    variable->values = values_allocate(size);
    if (!variable->values)
        return status_set(STATUS_FAILED, "%s: out of memory for a variable of %zu bytes", path, size);
    return read_fully(descriptor, variable->values, size) ? STATUS_OK : reader_crashed(path);
}

static enum status receive_variables(const char *path, const struct wanted *wanted, int count,
                                     struct variable *variables, int descriptor)
{
    struct packet packet;
    while (read_fully(descriptor, &packet, sizeof packet)) {
        if (packet.index == END) {
            char message[MESSAGE_SIZE];
            if (!read_fully(descriptor, message, sizeof message)) {
                break;
            }
            return packet.status == STATUS_OK ? STATUS_OK : status_set(packet.status, "%s", message);
        }
        if (packet.index < 0 || packet.index >= count) {
            break;
        }
        const enum status status =
            receive_variable(path, wanted[packet.index].pings, &packet, &variables[packet.index], descriptor);
        if (status != STATUS_OK) {
            return status;
        }
    }
    return reader_crashed(path);
}

static bool by_thread;

void variables_read_by_thread(void)
{
    by_thread = true;
}

/* What reads a file and writes into a pipe, whose writing end it closes. */
struct reader {
    const char *path;
    const struct wanted *wanted;
    int count;
    size_t file_size;
    int ends[2];
    pid_t process;
    pthread_t thread;
};

/* _Fork runs no handlers: LLVM's OpenMP would set itself up anew in the child and leave a file behind. The other
   threads are idle here and hold no locks. */
static bool process_begin(struct reader *reader)
{
    reader->process = _Fork();
    if (reader->process == 0) {
        close(reader->ends[0]);
        variables_send(reader->path, reader->wanted, reader->count, reader->file_size, reader->ends[1]);
    }
    if (reader->process > 0)
        close(reader->ends[1]);
    return reader->process > 0;
}

static void *thread_run(void *data)
{
    const struct reader *reader = data;
    variables_reply(reader->path, reader->wanted, reader->count, reader->file_size, reader->ends[1]);
    close(reader->ends[1]);
    return NULL;
}

/* Without signals, above all that of a pipe which nobody reads on. */
static bool thread_begin(struct reader *reader)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const bool begun = pthread_create(&reader->thread, NULL, thread_run, reader) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return begun;
}

static void reader_end(struct reader *reader)
{
    if (by_thread)
        pthread_join(reader->thread, NULL);
    while (!by_thread && waitpid(reader->process, NULL, 0) < 0 && errno == EINTR) {
    }
}

enum status variables_read(const char *path, const struct wanted *wanted, int count, struct variable *variables)
{
    for (int i = 0; i < count; i++) {
        variables[i] = (struct variable){0};
    }
    struct stat file;
    if (stat(path, &file) != 0 || access(path, R_OK) != 0) {
        return status_set(STATUS_INVALID, "%s: cannot be read: %s; a readable MATLAB file is needed", path,
                          strerror(errno));
    }
    if (!S_ISREG(file.st_mode)) {
        return status_set(STATUS_INVALID, "%s: is not a regular file; a MATLAB file is needed", path);
    }
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) {
        return status_set(STATUS_FAILED, "%s: no pipe to read it through: %s", path, strerror(errno));
    }
    fcntl(ends[0], F_SETPIPE_SZ, 1 << 20); /* fewer turns; where refused, it is smaller */
    struct reader reader = {path, wanted, count, (size_t)file.st_size, {ends[0], ends[1]}};
    const bool begun = by_thread ? thread_begin(&reader) : process_begin(&reader);
    if (!begun) {
        enum status failed = status_set(STATUS_FAILED, "%s: no %s to read it", path, by_thread ? "thread" : "process");
        close(ends[0]);
        close(ends[1]);
        return failed;
    }
    enum status status = receive_variables(path, wanted, count, variables, ends[0]);
    close(ends[0]);
    reader_end(&reader);
    if (status == STATUS_OK) {
        status = variables_check(path, wanted, count, variables);
    }
    if (status != STATUS_OK) {
        variables_free(variables, count);
    }
    return status;
}
