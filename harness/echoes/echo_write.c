/* Writing echo files. */
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "echoes/matfile.h"
#include "echoes/matvar.h"

enum { STREAM_BYTES = 32 << 20 }; /* of samples in memory, or one ping */

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

/* Samples as they were recorded: times 2^exponent; the first is number `first` of all. Errors: STATUS_INVALID where
   double cannot hold them. */
static enum status samples_restore(const char *path, int exponent, size_t first, size_t count, double complex *samples)
{
    for (size_t i = 0; i < count && exponent != 0; i++) {
        const double complex z = samples[i];
        const double re = ldexp(creal(z), exponent), im = ldexp(cimag(z), exponent);
        samples[i] = __builtin_complex(re, im);
        if (!isfinite(re) || !isfinite(im))
            return status_set(
                STATUS_INVALID,
                "%s: sample %zu would be %g%+gi times 2^%d, beyond the range of double; the echoes must be smaller",
                path, first + i + 1, creal(z), cimag(z), exponent);
    }
    return STATUS_OK;
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

void acquisition_write(struct writer *writer, const struct acquisition *a, const struct echo_notes *notes)
{
    const size_t receivers = (size_t)a->receivers, pings = (size_t)a->pings;
    if (!a->compressed) {
        const size_t length = (size_t)a->pulse_length;
        write_complex(writer, "pulse", (size_t[]){length, 1, 1}, PRECISION_DOUBLE, a->pulse, length, 1);
    }
    write_scalars(writer, a);
    if (a->area.half_x > 0) {
        write_reals(writer, "area", 1, 4, 1, &a->area.x);
    }
    size_t t0_count = is_constant(a->t0, sizeof *a->t0, a->pings) ? 1 : pings;
    size_t velocity_count = is_constant(a->velocity, sizeof *a->velocity, a->pings) ? 1 : pings;
    write_reals(writer, "t0", 1, t0_count, 1, a->t0);
    write_reals(writer, "tx", 3, pings, 1, &a->tx->x);
    write_reals(writer, "rx", 3, receivers, pings, &a->rx->x);
    write_reals(writer, "velocity", 3, velocity_count, 1, &a->velocity->x);
    echo_notes_write(writer, notes);
}

static enum status begin(struct writer *writer, const char *path, const struct acquisition *a, size_t bytes)
{
    const size_t rx_bytes = (size_t)a->receivers * (size_t)a->pings * sizeof *a->rx;
    const enum status status = writer_open(writer, path, bytes > rx_bytes ? bytes : rx_bytes);
    if (status == STATUS_OK)
        write_text(writer, "format", "sas-echoes 1");
    return status;
}

/* Of echoes in memory. */
static enum status held_pings(void *echoes, int first, int count, double complex *samples)
{
    const struct echoes *from = echoes;
    const size_t each = (size_t)from->acquisition->samples * (size_t)from->acquisition->receivers;
    for (size_t i = 0, at = (size_t)first * each; i < (size_t)count * each; i++, at++)
        samples[i] = from->precision == PRECISION_FLOAT ? ((const float complex *)from->samples)[at]
                                                        : ((const double complex *)from->samples)[at];
    return STATUS_OK;
}

enum status echo_file_write(const char *path, const struct echoes *echoes, const struct echo_notes *notes)
{
    const struct acquisition *a = echoes->acquisition;
    const size_t dims[] = {(size_t)a->samples, (size_t)a->receivers, (size_t)a->pings};
    const size_t count = dims[0] * dims[1] * dims[2];
    struct writer writer;
    if (echoes->exponent != 0)
        return echo_file_stream(path, a, &(struct sample_source){echoes->exponent, held_pings, (void *)echoes}, notes);
    if (begin(&writer, path, a, samples_bytes(a, echoes->precision)) != STATUS_OK)
        return writer.status;
    write_complex(&writer, "samples", dims, echoes->precision, echoes->samples, count, 1);
    acquisition_write(&writer, a, notes);
    return writer_close(&writer);
}

/* Samples on their way to a file. */
struct stream {
    const char *path;
    const struct acquisition *acquisition;
    const struct sample_source *source;
    int most; /* pings in memory */
};

/* Make some pings, as they are stored. */
static enum status stream_pings(const struct stream *stream, int first, int count, double complex *samples)
{
    const struct sample_source *source = stream->source;
    const size_t each = (size_t)stream->acquisition->samples * (size_t)stream->acquisition->receivers;
    const enum status status = source->pings(source->with, first, count, samples);
    return status == STATUS_OK
               ? samples_restore(stream->path, source->exponent, (size_t)first * each, (size_t)count * each, samples)
               : status;
}

/* Add the samples, some pings at a time. */
static bool stream_add(struct writer *writer)
{
    const struct stream *stream = writer->with;
    const struct acquisition *a = stream->acquisition;
    const size_t bytes = (size_t)a->samples * (size_t)a->receivers * sizeof(double complex);
    const int most = stream->most;
    const struct set73 set = {
        "samples", false, PRECISION_DOUBLE, 3, {(size_t)a->pings, (size_t)a->receivers, (size_t)a->samples}};
    const int file = open(writer->temporary, O_RDWR | O_CLOEXEC);
    double complex *samples = malloc((size_t)most * bytes);
    errno = samples ? 0 : ENOMEM;
    bool written = file >= 0 && samples && set73_make(writer->temporary, file, &set);
    const off_t at = written ? set73_find(writer->temporary, &set) : -1;
    written = written && at > 0;
    for (int p = 0, count; p < a->pings && written; p += count) {
        count = a->pings - p < most ? a->pings - p : most;
        writer->status = stream_pings(stream, p, count, samples);
        written = writer->status == STATUS_OK
                  && write_at(file, samples, (size_t)count * bytes, at + (off_t)((size_t)p * bytes));
    }
    const int reason = errno;
    free(samples);
    if (file >= 0)
        close(file);
    errno = reason;
    return written;
}

/* All of them at once, where they fit into a file of version 5. */
static enum status stream_whole(const struct stream *stream, const struct echo_notes *notes)
{
    const struct acquisition *a = stream->acquisition;
    struct echoes echoes;
    enum status status = echoes_allocate(a, PRECISION_DOUBLE, &echoes);
    if (status != STATUS_OK)
        return status;
    status = stream_pings(stream, 0, a->pings, (double complex *)echoes.samples);
    if (status == STATUS_OK)
        status = echo_file_write(stream->path, &echoes, notes);
    echoes_free(&echoes);
    return status;
}

enum status echo_file_blocks(const char *path, const struct acquisition *a, const struct sample_source *source,
                             int most_pings, const struct echo_notes *notes)
{
    struct stream stream = {path, a, source, most_pings};
    struct writer writer;
    if (begin(&writer, path, a, SIZE_MAX) != STATUS_OK)
        return writer.status;
    acquisition_write(&writer, a, notes);
    writer.add = stream_add;
    writer.with = &stream;
    return writer_close(&writer);
}

enum status echo_file_stream(const char *path, const struct acquisition *a, const struct sample_source *source,
                             const struct echo_notes *notes)
{
    const size_t bytes = samples_bytes(a, PRECISION_DOUBLE), each = bytes / (size_t)a->pings;
    const int most = 1 + STREAM_BYTES / (int)(each < STREAM_BYTES ? each : STREAM_BYTES);
    return writer_fits_v5(bytes) ? stream_whole(&(struct stream){path, a, source, a->pings}, notes)
                                 : echo_file_blocks(path, a, source, most, notes);
}
