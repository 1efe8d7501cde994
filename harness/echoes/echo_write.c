/* Writing echo files. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "echoes/matfile.h"
#include "echoes/matvar.h"

/* Do all pings have the first one's `size` bytes? */
static bool is_constant(const void *values, size_t size, int pings)
{
    for (int p = 1; p < pings; p++) {
        if (memcmp(values, (const char *)values + (size_t)p * size, size) != 0) {
            return false;
        }
    }
    return true;
}

/* Echoes as they were recorded: times 2^exponent. Errors: STATUS_INVALID where double cannot hold them. */
static enum status echoes_restore(const char *path, const struct echoes *echoes, struct echoes *restored)
{
    const struct acquisition *a = echoes->acquisition;
    enum status status = echoes_allocate(a, PRECISION_DOUBLE, restored);
    size_t count = (size_t)a->samples * (size_t)a->receivers * (size_t)a->pings;
    for (size_t i = 0; i < count && status == STATUS_OK; i++) {
        double complex z = echoes->precision == PRECISION_FLOAT ? ((const float complex *)echoes->samples)[i]
                                                                : ((const double complex *)echoes->samples)[i];
        double re = ldexp(creal(z), echoes->exponent), im = ldexp(cimag(z), echoes->exponent);
        ((double complex *)restored->samples)[i] = __builtin_complex(re, im);
        if (!isfinite(re) || !isfinite(im))
            status =
                status_set(STATUS_INVALID,
                           "%s: sample %zu would be %g%+gi times 2^%d, beyond the range of double; the echoes must "
                           "be smaller",
                           path, i + 1, creal(z), cimag(z), echoes->exponent);
    }
    if (status != STATUS_OK)
        echoes_free(restored);
    return status;
}

static void write_scalars(struct writer *writer, const struct acquisition *a)
{
    const struct {
        const char *name;
        double value;
        bool is_written;
    } scalars[] = {
        {"compressed", a->compressed, true},
        {"fs", a->fs, true},
        {"fc", a->fc, true},
        {"bandwidth", a->bandwidth, true},
        {"sound_speed", a->sound_speed, true},
        {"pri", a->pri, a->pri > 0},
        {"tx_length", a->tx_length, a->tx_length > 0},
        {"rx_length", a->rx_length, a->rx_length > 0},
        {"beam_limit", a->aperture_limit, a->aperture_limit <= 1},
        {"echo_sine", a->echo_sine, a->echo_sine > 0},
        {"echo_tapers", a->echo_tapers, a->echo_sine > 0},
        {"echo_squint", a->echo_squint, a->echo_squint != 0},
    };
    for (size_t i = 0; i < sizeof scalars / sizeof *scalars; i++)
        if (scalars[i].is_written)
            write_reals(writer, scalars[i].name, 1, 1, 1, &scalars[i].value);
}

enum status echo_file_write(const char *path, const struct echoes *echoes, const struct echo_notes *notes)
{
    const struct acquisition *a = echoes->acquisition;
    if (echoes->exponent != 0) {
        struct echoes restored;
        enum status status = echoes_restore(path, echoes, &restored);
        if (status == STATUS_OK) {
            status = echo_file_write(path, &restored, notes);
            echoes_free(&restored);
        }
        return status;
    }
    size_t samples = (size_t)a->samples, receivers = (size_t)a->receivers, pings = (size_t)a->pings;
    size_t samples_bytes = samples * receivers * pings * precision_size(echoes->precision);
    size_t rx_bytes = receivers * pings * sizeof *a->rx;
    struct writer writer;
    if (writer_open(&writer, path, samples_bytes > rx_bytes ? samples_bytes : rx_bytes) != STATUS_OK) {
        return writer.status;
    }
    write_text(&writer, "format", "sas-echoes 1");
    write_complex(&writer, "samples", (size_t[]){samples, receivers, pings}, echoes->precision, echoes->samples,
                  samples * receivers * pings, 1);
    if (!a->compressed) {
        size_t length = (size_t)a->pulse_length;
        write_complex(&writer, "pulse", (size_t[]){length, 1, 1}, PRECISION_DOUBLE, a->pulse, length, 1);
    }
    write_scalars(&writer, a);
    if (a->area.half_x > 0) {
        write_reals(&writer, "area", 1, 4, 1, &a->area.x);
    }
    size_t t0_count = is_constant(a->t0, sizeof *a->t0, a->pings) ? 1 : pings;
    size_t velocity_count = is_constant(a->velocity, sizeof *a->velocity, a->pings) ? 1 : pings;
    write_reals(&writer, "t0", 1, t0_count, 1, a->t0);
    write_reals(&writer, "tx", 3, pings, 1, &a->tx->x);
    write_reals(&writer, "rx", 3, receivers, pings, &a->rx->x);
    write_reals(&writer, "velocity", 3, velocity_count, 1, &a->velocity->x);
    echo_notes_write(&writer, notes);
    return writer_close(&writer);
}
