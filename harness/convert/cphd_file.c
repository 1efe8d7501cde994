/* CPHD files: head, XML, and where numbers lie (cphd_file.h). */
#include "convert/cphd_file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "text/number.h"

enum { HEAD_MOST = 1 << 16, XML_MOST = 1 << 26, WORD = 8 }; /* bytes */

static const struct {
    const char *name, *format;
    bool is_optional;
} parameters[CPHD_PARAMETERS] = {
    [CPHD_TX_TIME] = {"TxTime", "F8", false},
    [CPHD_TX_POS] = {"TxPos", "X=F8;Y=F8;Z=F8;", false},
    [CPHD_RCV_TIME] = {"RcvTime", "F8", false},
    [CPHD_RCV_POS] = {"RcvPos", "X=F8;Y=F8;Z=F8;", false},
    [CPHD_RCV_VEL] = {"RcvVel", "X=F8;Y=F8;Z=F8;", false},
    [CPHD_SRP_POS] = {"SRPPos", "X=F8;Y=F8;Z=F8;", false},
    [CPHD_A_FDOP] = {"aFDOP", "F8", false},
    [CPHD_FX1] = {"FX1", "F8", false},
    [CPHD_FX2] = {"FX2", "F8", false},
    [CPHD_SC0] = {"SC0", "F8", false},
    [CPHD_SCSS] = {"SCSS", "F8", false},
    [CPHD_AMP_SF] = {"AmpSF", "F8", true},
};

static enum status field_refuse(const struct cphd_file *file, const char *field, const char *text, const char *accepted)
{
    return status_set(STATUS_INVALID, "%s: variable `%s` is '%.40s'; %s is needed", file->path, field, text, accepted);
}

/* Of number `index` of the fields with that name. */
static enum status indexed_text(const struct cphd_file *file, const char *field, int index, const char *accepted,
                                const char **text)
{
    *text = xml_text(&file->xml, field, index);
    return *text
               ? STATUS_OK
               : status_set(STATUS_INVALID, "%s: variable `%s` is missing; %s is needed", file->path, field, accepted);
}

enum status cphd_text(const struct cphd_file *file, const char *field, const char *accepted, const char **text)
{
    return indexed_text(file, field, 0, accepted, text);
}

enum status cphd_number(const struct cphd_file *file, const char *field, double *number)
{
    static const char accepted[] = "a finite number";
    const char *text, *end;
    const enum status status = cphd_text(file, field, accepted, &text);
    if (status != STATUS_OK)
        return status;
    end = number_read(text, number);
    return end && !*end ? STATUS_OK : field_refuse(file, field, text, accepted);
}

enum status cphd_place(const struct cphd_file *file, const char *field, struct vector *place)
{
    double *const axes[] = {&place->x, &place->y, &place->z};
    enum status status = STATUS_OK;
    for (int k = 0; k < 3 && status == STATUS_OK; k++) {
        char name[100];
        snprintf(name, sizeof name, "%s/%c", field, 'X' + k);
        status = cphd_number(file, name, axes[k]);
    }
    return status;
}

static enum status whole(const struct cphd_file *file, const char *field, int index, long long least, long long most,
                         long long *value)
{
    char accepted[80];
    const char *text, *end;
    snprintf(accepted, sizeof accepted, "a whole number from %lld to %lld", least, most);
    const enum status status = indexed_text(file, field, index, accepted, &text);
    if (status != STATUS_OK)
        return status;
    end = whole_read(text, least, most, value);
    return end && !*end ? STATUS_OK : field_refuse(file, field, text, accepted);
}

/* One of some words; *which: its number. */
static enum status word(const struct cphd_file *file, const char *field, const char *const *words, int count,
                        const char *accepted, int *which)
{
    const char *text;
    const enum status status = cphd_text(file, field, accepted, &text);
    for (*which = 0; status == STATUS_OK && *which < count; ++*which)
        if (strcmp(words[*which], text) == 0)
            return STATUS_OK;
    return status == STATUS_OK ? field_refuse(file, field, text, accepted) : status;
}

/* So much of a line is shown. */
static int shown(const char *text)
{
    const size_t length = strcspn(text, "\r\n");
    return length < 40 ? (int)length : 40;
}

/* A line "KEY := NUMBER" of the head. */
static enum status head_number(const struct cphd_file *file, const char *head, const char *key, long long most,
                               long long *value)
{
    char line[80];
    snprintf(line, sizeof line, "\n%s := ", key);
    const char *found = strstr(head, line), *text = found ? found + strlen(line) : "";
    const char *end = whole_read(text, 0, most, value);
    if (end && (*end == '\n' || *end == '\r'))
        return STATUS_OK;
    return status_set(STATUS_INVALID,
                      "%s: variable `%s` of its head is %s%.*s; a whole number from 0 to %lld is needed", file->path,
                      key, found ? "" : "missing", shown(text), text, most);
}

/* A block's place, in the file as a whole. */
static enum status head_block(const struct cphd_file *file, const char *head, const char *block, off_t file_size,
                              off_t most, off_t *first, off_t *size)
{
    char key[80];
    long long at = 0, bytes = 0;
    snprintf(key, sizeof key, "%s_BLOCK_BYTE_OFFSET", block);
    enum status status = head_number(file, head, key, LLONG_MAX, &at);
    snprintf(key, sizeof key, "%s_BLOCK_SIZE", block);
    if (status == STATUS_OK)
        status = head_number(file, head, key, most, &bytes);
    if (status == STATUS_OK && (at > file_size || bytes > file_size - at))
        status = status_set(STATUS_INVALID,
                            "%s: variable `%s` of its head is %lld from byte %lld on, the file has %lld bytes; a whole "
                            "file is needed",
                            file->path, key, bytes, at, (long long)file_size);
    *first = at;
    *size = bytes;
    return status;
}

static enum status bytes_read(const struct cphd_file *file, off_t at, size_t size, void *bytes)
{
    for (size_t done = 0; done < size;) {
        const ssize_t count = pread(file->descriptor, (char *)bytes + done, size - done, at + (off_t)done);
        if (count == 0 || (count < 0 && errno != EINTR))
            return status_set(STATUS_INVALID, "%s: cannot be read at byte %lld; a whole file is needed", file->path,
                              (long long)at + (long long)done);
        done += count > 0 ? (size_t)count : 0;
    }
    return STATUS_OK;
}

static enum status xml_block_read(struct cphd_file *file, off_t at, off_t size)
{
    char *document = malloc((size_t)size + 1);
    if (!document)
        return status_set(STATUS_FAILED, "%s: out of memory for its XML of %lld bytes", file->path, (long long)size);
    enum status status = bytes_read(file, at, (size_t)size, document);
    if (status == STATUS_OK)
        status = xml_read(file->path, document, (size_t)size, &file->xml);
    free(document);
    return status;
}

/* The reference channel among all. */
static enum status channel_find(struct cphd_file *file)
{
    static const char packed[] = "Data/Channel/CompressedSignalSize";
    const char *reference;
    const enum status status = cphd_text(file, "Channel/RefChId", "the identifier of a channel", &reference);
    if (status != STATUS_OK)
        return status;
    file->channels = 0;
    file->channel = -1;
    for (int k = 0; k < file->xml.count; k++) {
        if (strcmp(file->xml.leaves[k].path, "Data/Channel/Identifier") != 0)
            continue;
        if (file->channel < 0 && strcmp(file->xml.leaves[k].text, reference) == 0)
            file->channel = file->channels;
        file->channels++;
    }
    if (file->channel < 0)
        return field_refuse(file, "Channel/RefChId", reference, "one of `Data/Channel/Identifier`");
    const char *size = xml_text(&file->xml, packed, 0);
    return size ? field_refuse(file, packed, size, "a signal that is not packed") : STATUS_OK;
}

static enum status signal_describe(struct cphd_file *file)
{
    static const char *const domains[] = {"FX", "TOA"}, *const signs[] = {"-1", "+1", "1"},
                             *const formats[] = {"CI2", "CI4", "CF8"};
    int domain = 0, sign = 0, format = 0;
    long long vectors = 0, samples = 0, vector_bytes = 0;
    enum status status = word(file, "Global/DomainType", domains, 2, "FX or TOA", &domain);
    if (status == STATUS_OK)
        status = word(file, "Global/SGN", signs, 3, "+1 or -1", &sign);
    if (status == STATUS_OK)
        status = word(file, "Data/SignalArrayFormat", formats, 3, "CI2, CI4 or CF8", &format);
    if (status == STATUS_OK)
        status = channel_find(file);
    if (status == STATUS_OK)
        status = whole(file, "Data/Channel/NumVectors", file->channel, 1, INT_MAX, &vectors);
    if (status == STATUS_OK)
        status = whole(file, "Data/Channel/NumSamples", file->channel, 2, INT_MAX / 8, &samples);
    if (status == STATUS_OK)
        status = whole(file, "Data/NumBytesPVP", 0, WORD, INT_MAX, &vector_bytes);
    file->is_toa = domain == 1;
    file->sign = sign == 0 ? -1 : 1;
    file->part_bytes = 1 << format;
    file->vectors = (int)vectors;
    file->samples = (int)samples;
    file->vector_bytes = vector_bytes;
    return status;
}

/* The channel's array in a block. */
static enum status array_find(const struct cphd_file *file, const char *field, off_t size, off_t block,
                              off_t block_size, off_t *first)
{
    long long at = 0;
    const enum status status = whole(file, field, file->channel, 0, LLONG_MAX, &at);
    if (status == STATUS_OK && (at > block_size || size > block_size - at))
        return status_set(
            STATUS_INVALID,
            "%s: variable `%s` is %lld, from where the channel's %lld bytes end beyond their block of %lld; "
            "a whole block is needed",
            file->path, field, at, (long long)size, (long long)block_size);
    *first = block + at;
    return status;
}

static enum status parameters_find(struct cphd_file *file)
{
    enum status status = STATUS_OK;
    for (int k = 0; k < CPHD_PARAMETERS && status == STATUS_OK; k++) {
        char offset[80], format[80];
        const char *text;
        long long at = 0;
        snprintf(offset, sizeof offset, "PVP/%s/Offset", parameters[k].name);
        snprintf(format, sizeof format, "PVP/%s/Format", parameters[k].name);
        file->words[k] = -1;
        if (parameters[k].is_optional && !xml_text(&file->xml, offset, 0))
            continue;
        status = cphd_text(file, format, parameters[k].format, &text);
        if (status == STATUS_OK && strcmp(text, parameters[k].format) != 0)
            status = field_refuse(file, format, text, parameters[k].format);
        const long long size = *parameters[k].format == 'X' ? 3 : 1;
        if (status == STATUS_OK)
            status = whole(file, offset, 0, 0, file->vector_bytes / WORD - size, &at);
        file->words[k] = at;
    }
    return status;
}

static enum status blocks_find(struct cphd_file *file, const char *head, off_t file_size)
{
    off_t xml, xml_size, block, block_size;
    enum status status = head_block(file, head, "XML", file_size, XML_MOST, &xml, &xml_size);
    if (status == STATUS_OK)
        status = xml_block_read(file, xml, xml_size);
    if (status == STATUS_OK)
        status = signal_describe(file);
    if (status == STATUS_OK)
        status = parameters_find(file);
    if (status == STATUS_OK)
        status = head_block(file, head, "PVP", file_size, LLONG_MAX, &block, &block_size);
    if (status == STATUS_OK)
        status = array_find(file, "Data/Channel/PVPArrayByteOffset", file->vectors * file->vector_bytes, block,
                            block_size, &file->parameters);
    if (status == STATUS_OK)
        status = head_block(file, head, "SIGNAL", file_size, LLONG_MAX, &block, &block_size);
    if (status == STATUS_OK)
        status =
            array_find(file, "Data/Channel/SignalArrayByteOffset",
                       (off_t)file->vectors * file->samples * 2 * file->part_bytes, block, block_size, &file->signal);
    return status;
}

enum status cphd_open(const char *path, struct cphd_file *file)
{
    char *head = calloc(HEAD_MOST + 1, 1);
    struct stat stat;
    *file = (struct cphd_file){.path = path, .descriptor = open(path, O_RDONLY | O_CLOEXEC)};
    enum status status = head ? STATUS_OK : status_set(STATUS_FAILED, "%s: out of memory for its head", path);
    if (status == STATUS_OK && (file->descriptor < 0 || fstat(file->descriptor, &stat) != 0))
        status = status_set(STATUS_INVALID, "%s: cannot be read: %s", path, strerror(errno));
    if (status == STATUS_OK)
        status = bytes_read(file, 0, (size_t)(stat.st_size < HEAD_MOST ? stat.st_size : HEAD_MOST), head);
    if (status == STATUS_OK) {
        char *end = strstr(head, "\f\n");
        if (strncmp(head, "CPHD/1.", 7) != 0 || !end)
            status =
                status_set(STATUS_INVALID, "%s: begins with '%.*s'%s; a whole head of CPHD/1.0 or CPHD/1.1 is needed",
                           path, shown(head), head, end ? "" : ", a head without end");
        else
            *end = '\0';
    }
    if (status == STATUS_OK)
        status = blocks_find(file, head, stat.st_size);
    free(head);
    return status;
}

void cphd_close(struct cphd_file *file)
{
    if (file->descriptor >= 0)
        close(file->descriptor);
    xml_free(&file->xml);
}

static uint64_t big_endian(const unsigned char *bytes, int count)
{
    uint64_t number = 0;
    for (int k = 0; k < count; k++)
        number = number << 8 | bytes[k];
    return number;
}

static double part_read(const unsigned char *bytes, int count)
{
    const uint64_t number = big_endian(bytes, count);
    const uint32_t low = (uint32_t)number;
    float single;
    double real;
    memcpy(&single, &low, sizeof single);
    memcpy(&real, &number, sizeof real);
    return count == 1 ? (int8_t)number : count == 2 ? (int16_t)number : count == 4 ? single : real;
}

enum status cphd_refuse(const struct cphd_file *file, int parameter, int vector, const char *why)
{
    return status_set(STATUS_INVALID, "%s: variable `PVP/%s` of vector %d %s", file->path, parameters[parameter].name,
                      vector + 1, why);
}

enum status cphd_vector(const struct cphd_file *file, int vector, struct vector values[CPHD_PARAMETERS])
{
    unsigned char bytes[3 * WORD];
    for (int k = 0; k < CPHD_PARAMETERS; k++) {
        double axes[3] = {1};
        const int count = *parameters[k].format == 'X' ? 3 : 1;
        if (file->words[k] >= 0) {
            const enum status status =
                bytes_read(file, file->parameters + vector * file->vector_bytes + file->words[k] * WORD,
                           (size_t)(count * WORD), bytes);
            if (status != STATUS_OK)
                return status;
            for (int i = 0; i < count; i++)
                axes[i] = part_read(bytes + WORD * i, WORD);
        }
        if (!isfinite(axes[0]) || !isfinite(axes[1]) || !isfinite(axes[2]))
            return cphd_refuse(file, k, vector, "is no finite number; finite numbers are needed");
        values[k] = (struct vector){axes[0], axes[1], axes[2]};
    }
    return STATUS_OK;
}

enum status cphd_samples(const struct cphd_file *file, int vector, double complex *samples)
{
    const size_t bytes = (size_t)file->part_bytes, count = (size_t)file->samples;
    /* In the second half of their own place, which each sample leaves before another takes it. */
    unsigned char *from = (unsigned char *)(samples + count) - 2 * bytes * count;
    const enum status status =
        bytes_read(file, file->signal + (off_t)vector * (off_t)(2 * bytes * count), 2 * bytes * count, from);
    for (size_t n = 0; n < count && status == STATUS_OK; n++, from += 2 * bytes) {
        const double real = part_read(from, file->part_bytes), imaginary = part_read(from + bytes, file->part_bytes);
        samples[n] = __builtin_complex(real, imaginary);
        if (!isfinite(real) || !isfinite(imaginary))
            return status_set(STATUS_INVALID, "%s: sample %zu of vector %d is %g%+gi; finite numbers are needed",
                              file->path, n + 1, vector + 1, real, imaginary);
    }
    return status;
}
