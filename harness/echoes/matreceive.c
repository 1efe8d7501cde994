/* Reading MATLAB files: the process that gets the variables from another (matread.c). */
#define _GNU_SOURCE /* pipe2, _Fork */
#include "echoes/matread.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/memory.h"

bool pings_run_next(const struct pings *pings, size_t from, size_t most, size_t *first, size_t *end)
{
    const size_t count = (size_t)pings->count;
    for (*first = from; *first < count && !pings->read[*first];)
        ++*first;
    for (*end = *first; *end < count && pings->read[*end] && *end - *first < most;)
        ++*end;
    return *first < *end;
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

/* Into memory as echoes_allocate gives it, so that samples need no copy; of some pings, as memory_sparse does. */
static bool receive_values(const struct pings *pings, struct variable *variable, int descriptor)
{
    const size_t count = variable_count(variable);
    if (!pings)
        return read_fully(descriptor, variable->values, count * sizeof *variable->values);
    const size_t each = pings->count > 0 ? count / (size_t)pings->count : 0;
    for (size_t first = 0, end = 0; pings_run_next(pings, end, count, &first, &end);)
        if (!read_fully(descriptor, variable->values + first * each, (end - first) * each * sizeof *variable->values))
            return false;
    return true;
}

static void *values_allocate(const struct pings *pings, size_t size)
{
    if (size == 0 || size > PTRDIFF_MAX - 63)
        return NULL;
    return pings ? memory_sparse(size) : aligned_alloc(64, (size + 63) / 64 * 64);
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
        const struct pings *pings = wanted[packet.index].pings;
        struct variable *variable = &variables[packet.index];
        *variable = packet.variable;
        variable->is_sparse = pings != NULL;
        size_t size = size_product(variable_count(variable), sizeof(double complex), 1, 1);
        variable->values = values_allocate(pings, size);
        if (!variable->values) {
            return status_set(STATUS_FAILED, "%s: out of memory for a variable of %zu bytes", path, size);
        }
        if (!receive_values(pings, variable, descriptor)) {
            break;
        }
    }
    return status_set(STATUS_INVALID,
                      "%s: is damaged (its reader crashed, or ran out of memory or time); a MATLAB "
                      "file of version 5 or 7.3 is needed",
                      path);
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
    /* _Fork runs no handlers: LLVM's OpenMP would set itself up anew in the child and leave a file behind. The other
       threads are idle here and hold no locks. */
    pid_t child = _Fork();
    if (child < 0) {
        enum status failed = status_set(STATUS_FAILED, "%s: no process to read it: %s", path, strerror(errno));
        close(ends[0]);
        close(ends[1]);
        return failed;
    }
    if (child == 0) {
        close(ends[0]);
        variables_send(path, wanted, count, (size_t)file.st_size, ends[1]);
    }
    close(ends[1]);
    enum status status = receive_variables(path, wanted, count, variables, ends[0]);
    close(ends[0]);
    while (waitpid(child, NULL, 0) < 0 && errno == EINTR) {
    }
    if (status == STATUS_OK) {
        status = variables_check(path, wanted, count, variables);
    }
    if (status != STATUS_OK) {
        variables_free(variables, count);
    }
    return status;
}
