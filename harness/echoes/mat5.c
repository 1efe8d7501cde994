/* The elements of a version 5 file ("MAT-File Format", MathWorks). libmatio reads as many bytes as a variable's
   dimensions ask for, beyond its element or from uninitialised memory; so an element's length is checked here first. */
#include "echoes/matvar.h"

#include <matio.h>
#include <string.h>
#include <sys/stat.h>
#include <zlib.h>

enum { HEADER_SIZE = 128, INPUT_SIZE = 1 << 14 };

/* The bytes of one variable, one after the other, packed or not. */
struct source {
    FILE *file;
    size_t left; /* of the element in the file */
    bool is_packed, is_little_endian;
    z_stream stream;
    unsigned char input[INPUT_SIZE];
};

/* Type and length of an element; up to four bytes of data stand in the tag itself. */
struct tag {
    uint32_t type, length;
    bool is_small;
    unsigned char small[4];
};

static uint32_t word(const unsigned char *bytes, bool is_little_endian)
{
    uint32_t value = 0;
    for (int i = 0; i < 4; i++) {
        value = value << 8 | bytes[is_little_endian ? 3 - i : i];
    }
    return value;
}

bool mat5_open(struct mat5 *file, const char *path)
{
    unsigned char header[HEADER_SIZE];
    struct stat status;
    *file = (struct mat5){.file = fopen(path, "rb"), .next = HEADER_SIZE};
    const bool is_readable =
        file->file && fstat(fileno(file->file), &status) == 0 && fread(header, sizeof header, 1, file->file) == 1;
    if (is_readable) {
        file->is_little_endian = header[HEADER_SIZE - 2] == 'I';
        file->size = status.st_size;
    } else {
        mat5_close(file);
    }
    return is_readable;
}

void mat5_close(struct mat5 *file)
{
    if (file->file) {
        fclose(file->file);
    }
    *file = (struct mat5){0};
}

bool mat5_next(struct mat5 *file)
{
    unsigned char tag[8];
    if (file->next >= file->size || fseeko(file->file, file->next, SEEK_SET) != 0
        || fread(tag, sizeof tag, 1, file->file) != 1) {
        return false;
    }
    file->type = word(tag, file->is_little_endian);
    file->length = word(tag + 4, file->is_little_endian);
    file->first = file->next + (off_t)sizeof tag;
    file->next = file->first + (off_t)file->length;
    return true;
}

int mat5_count(const char *path)
{
    struct mat5 file;
    int count = 0;
    if (!mat5_open(&file, path)) {
        return -1;
    }
    while (mat5_next(&file)) {
        count++;
    }
    const bool is_whole = file.next == file.size;
    mat5_close(&file);
    return is_whole ? count : -1;
}

/* Both take `size` bytes or what is left, and return how many; `to` may be NULL. */
static size_t plain_take(struct source *source, unsigned char *to, size_t size)
{
    size = size < source->left ? size : source->left;
    if (!to) {
        size = fseeko(source->file, (off_t)size, SEEK_CUR) == 0 ? size : 0;
    } else {
        size = fread(to, 1, size, source->file);
    }
    source->left -= size;
    return size;
}

static size_t packed_take(struct source *source, unsigned char *to, size_t size)
{
    unsigned char nowhere[INPUT_SIZE] = {0};
    z_stream *stream = &source->stream;
    size_t taken = 0;
    for (int result = Z_OK; taken < size && result == Z_OK;) {
        if (stream->avail_in == 0) {
            stream->next_in = source->input;
            stream->avail_in = (uInt)plain_take(source, source->input, INPUT_SIZE);
        }
        const size_t room = size - taken < INPUT_SIZE ? size - taken : INPUT_SIZE;
        stream->next_out = to ? to + taken : nowhere;
        stream->avail_out = (uInt)room;
        result = inflate(stream, Z_SYNC_FLUSH);
        taken += room - stream->avail_out;
    }
    return taken;
}

static size_t source_take(struct source *source, unsigned char *to, size_t size)
{
    return source->is_packed ? packed_take(source, to, size) : plain_take(source, to, size);
}

static bool tag_take(struct source *source, struct tag *tag)
{
    unsigned char bytes[8];
    if (source_take(source, bytes, sizeof bytes) != sizeof bytes) {
        return false;
    }
    const uint32_t first = word(bytes, source->is_little_endian), second = word(bytes + 4, source->is_little_endian);
    *tag = first >> 16 ? (struct tag){first & 0xffff, first >> 16, true} : (struct tag){first, second, false};
    memcpy(tag->small, bytes + 4, sizeof tag->small);
    return !tag->is_small || tag->length <= sizeof tag->small;
}

/* Pass over an element's data; returns how many of its bytes there are. */
static size_t data_pass(struct source *source, const struct tag *tag)
{
    if (tag->is_small) {
        return tag->length;
    }
    const size_t found = source_take(source, NULL, tag->length);
    source_take(source, NULL, (8 - tag->length % 8) % 8);
    return found;
}

/* Read an element's data, which may be cut short. */
static void data_take(struct source *source, const struct tag *tag, void *to)
{
    if (tag->is_small) {
        memcpy(to, tag->small, tag->length);
    } else {
        source_take(source, to, tag->length);
        source_take(source, NULL, (8 - tag->length % 8) % 8);
    }
}

/* Pass over flags and dimensions. */
static bool head_pass(struct source *source)
{
    struct tag tag;
    for (int k = 0; k < 2; k++) {
        if (!tag_take(source, &tag) || data_pass(source, &tag) != tag.length) {
            return false;
        }
    }
    return true;
}

/* Read up to the name, which must be the one that libmatio found: then its data follow. */
static bool name_reach(struct source *source, const char *name, size_t length)
{
    struct tag tag;
    char text[64] = "";
    if (!head_pass(source) || !tag_take(source, &tag) || tag.length != length || tag.length >= sizeof text) {
        return false;
    }
    data_take(source, &tag, text);
    return strncmp(text, name, length) == 0;
}

/* From a struct's name to the data of one of its fields: the length of each name, the names, the fields in turn. */
static bool field_reach(struct source *source, const char *name)
{
    enum { NAMES_MOST = 1 << 12 };
    struct tag tag;
    unsigned char size[4] = {0};
    char names[NAMES_MOST] = "";
    if (!tag_take(source, &tag) || tag.length != sizeof size) {
        return false;
    }
    data_take(source, &tag, size);
    const size_t each = word(size, source->is_little_endian);
    if (!tag_take(source, &tag) || tag.length >= sizeof names || each == 0 || each > tag.length) {
        return false;
    }
    const size_t count = tag.length / each;
    data_take(source, &tag, names);
    for (size_t k = 0; k < count && tag_take(source, &tag); k++) {
        if (strncmp(names + k * each, name, each) == 0) {
            return head_pass(source) && tag_take(source, &tag) && data_pass(source, &tag) == tag.length;
        }
        if (data_pass(source, &tag) != tag.length) {
            return false;
        }
    }
    return false;
}

/* Bytes of a number as it is stored; 0 for types that libmatio cannot read. */
static size_t number_size(uint32_t type, bool is_text)
{
    const bool is_code = type == MAT_T_UINT8 || type == MAT_T_UINT16 || type == MAT_T_UTF8 || type == MAT_T_UTF16;
    const bool is_number = (type >= MAT_T_INT8 && type <= MAT_T_SINGLE) || type == MAT_T_DOUBLE || type == MAT_T_INT64
                           || type == MAT_T_UINT64;
    return (is_text ? is_code : is_number) ? Mat_SizeOf((enum matio_types)type) : 0;
}

static enum status parts_check(const char *path, const struct stored *stored, struct source *source)
{
    static const char *const parts[] = {"", " of its imaginary part"};
    for (int k = 0; k < 1 + stored->is_complex; k++) {
        struct tag tag = {0};
        const size_t found = tag_take(source, &tag) ? data_pass(source, &tag) : 0;
        const size_t size = number_size(tag.type, stored->is_text), needed = size * stored->count;
        if (size == 0) {
            return status_set(STATUS_INVALID, "%s: variable `%s` is stored as type %u, which is none of %s", path,
                              stored->name, (unsigned)tag.type, stored->is_text ? "text" : "numbers");
        }
        /* A character of UTF-8 may take several bytes. */
        if (tag.type == MAT_T_UTF8 ? found < needed : found != needed) {
            return storage_refuse(path, stored->name, parts[k], found, needed);
        }
    }
    return STATUS_OK;
}

enum status mat5_check(const char *path, const struct stored *stored, const struct mat5 *file)
{
    struct source source = {.file = file->file,
                            .left = file->length,
                            .is_packed = file->type == MAT_T_COMPRESSED,
                            .is_little_endian = file->is_little_endian};
    struct tag matrix;
    if (fseeko(file->file, file->first, SEEK_SET) != 0 || (source.is_packed && inflateInit(&source.stream) != Z_OK)) {
        return status_set(STATUS_FAILED, "%s: no memory to read variable `%s`", path, stored->name);
    }
    const size_t length = strcspn(stored->name, "/");
    const bool is_found = (!source.is_packed || tag_take(&source, &matrix)) && name_reach(&source, stored->name, length)
                          && (!stored->name[length] || field_reach(&source, stored->name + length + 1));
    enum status status = is_found ? parts_check(path, stored, &source)
                                  : status_set(STATUS_INVALID, "%s: variable `%s` is damaged; a whole file is needed",
                                               path, stored->name);
    if (source.is_packed) {
        inflateEnd(&source.stream);
    }
    return status;
}
