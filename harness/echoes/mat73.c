/* Where a version 7.3 file keeps its numbers. HDF5 fills in what is missing: with zeros where another file that has it
   is short or missing, from uninitialised memory where a chunk is short. MATLAB keeps everything in the file itself,
   packed by gzip or not at all. */
#include "echoes/matfile.h"
#include "echoes/matvar.h"

#include <hdf5.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { FILTERS_MOST = 3 };

/* A data set as it lies in the file. */
struct data_set {
    hid_t file, id, type, settings;
    hsize_t dims[H5S_MAX_RANK], chunk[H5S_MAX_RANK];
    int rank, filter_count;
    H5Z_filter_t filters[FILTERS_MOST]; /* in the order of writing */
    size_t needed, chunk_bytes;
};

static enum status set_refuse(const char *path, const char *name, const char *what)
{
    return status_set(STATUS_INVALID,
                      "%s: variable `%s` %s; numbers in the file itself are needed, packed by gzip or not at all", path,
                      name, what);
}

static bool set_open(const char *path, const struct stored *stored, struct data_set *set)
{
    *set = (struct data_set){.file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT)};
    set->id = H5Dopen2(set->file, stored->name, H5P_DEFAULT);
    set->type = H5Dget_type(set->id);
    set->settings = H5Dget_create_plist(set->id);
    const hid_t space = H5Dget_space(set->id);
    set->rank = H5Sget_simple_extent_dims(space, set->dims, NULL);
    set->needed = stored->count * H5Tget_size(set->type);
    const bool fits = set->rank >= 0 && set->settings >= 0 && set->needed > 0
                      && H5Sget_simple_extent_npoints(space) == (hssize_t)stored->count;
    H5Sclose(space);
    return fits;
}

/* Handles that were not opened are refused, silently. */
static void set_close(const struct data_set *set)
{
    H5Pclose(set->settings);
    H5Tclose(set->type);
    H5Dclose(set->id);
    H5Fclose(set->file);
}

/* Another file may be named by the data set, or by the name that led to it. */
static bool is_elsewhere(const struct data_set *set)
{
    H5O_info_t file, own;
    return H5Pget_layout(set->settings) == H5D_VIRTUAL || H5Pget_external_count(set->settings) != 0
           || H5Oget_info(set->file, &file) < 0 || H5Oget_info(set->id, &own) < 0 || file.fileno != own.fileno;
}

/* Shuffled, packed by gzip and given a sum to check, in any order, each at most once. */
static bool filters_read(struct data_set *set)
{
    unsigned seen = 0;
    const int count = H5Pget_nfilters(set->settings);
    for (int k = 0; k < count; k++) {
        unsigned flags, configuration;
        size_t values = 0;
        const H5Z_filter_t filter =
            H5Pget_filter2(set->settings, (unsigned)k, &flags, &values, NULL, 0, NULL, &configuration);
        if (filter < H5Z_FILTER_DEFLATE || filter > H5Z_FILTER_FLETCHER32 || seen & 1u << filter) {
            return false;
        }
        seen |= 1u << filter;
        set->filters[set->filter_count++] = filter;
    }
    return count >= 0;
}

/* Bytes that `packed` unpacks to, as far as it is whole; `most` at most. */
static size_t unpacked_size(const unsigned char *packed, size_t size, size_t most)
{
    unsigned char nowhere[1 << 14];
    z_stream stream = {.next_in = (unsigned char *)packed, .avail_in = (uInt)size};
    if (inflateInit(&stream) != Z_OK) {
        return 0;
    }
    for (int result = Z_OK; result == Z_OK && stream.total_out < most;) {
        stream.next_out = nowhere;
        stream.avail_out = sizeof nowhere;
        result = inflate(&stream, Z_SYNC_FLUSH);
    }
    inflateEnd(&stream);
    return stream.total_out;
}

/* Bytes of numbers that the chunk at `place` has; 0 where it was never written. */
static size_t chunk_size(const struct data_set *set, const hsize_t *place)
{
    hsize_t stored = 0;
    uint32_t skipped = 0; /* filters that this chunk went without */
    if (H5Dget_chunk_storage_size(set->id, place, &stored) < 0 || stored == 0) {
        return 0;
    }
    unsigned char *bytes = malloc(stored);
    size_t size = bytes && H5Dread_chunk(set->id, H5P_DEFAULT, place, &skipped, bytes) >= 0 ? stored : 0;
    for (int k = set->filter_count - 1; k >= 0; k--) {
        if (skipped >> k & 1) {
            continue;
        }
        if (set->filters[k] == H5Z_FILTER_FLETCHER32) {
            size -= size < 4 ? size : 4;
        } else if (set->filters[k] == H5Z_FILTER_DEFLATE) {
            size = unpacked_size(bytes, size, set->chunk_bytes + 4);
        }
    }
    free(bytes);
    return size;
}

/* To the next chunk; false after the last one. */
static bool chunk_next(const struct data_set *set, hsize_t *place)
{
    for (int k = set->rank - 1; k >= 0; k--) {
        place[k] += set->chunk[k];
        if (place[k] < set->dims[k]) {
            return true;
        }
        place[k] = 0;
    }
    return false;
}

/* Chunks that are not packed are whole or missing, unless somebody forged them: their checksum decides. */
static enum status chunks_check(const char *path, const char *name, struct data_set *set)
{
    hsize_t place[H5S_MAX_RANK] = {0};
    if (!filters_read(set) || H5Pget_chunk(set->settings, set->rank, set->chunk) != set->rank) {
        return set_refuse(path, name, "is packed otherwise");
    }
    set->chunk_bytes = H5Tget_size(set->type);
    for (int k = 0; k < set->rank; k++) {
        set->chunk_bytes *= set->chunk[k]; /* below 4 GiB by HDF5 */
    }
    size_t found = 0, needed = set->chunk_bytes;
    for (int k = 0; k < set->rank; k++) {
        needed = size_product(needed, (set->dims[k] + set->chunk[k] - 1) / set->chunk[k], 1, 1);
    }
    if (needed == 0) {
        return set_refuse(path, name, "has chunks beyond any memory");
    }
    for (bool more = set->filter_count > 0; more; more = more && chunk_next(set, place)) {
        const size_t size = chunk_size(set, place);
        more = size >= set->chunk_bytes;
        found += more ? set->chunk_bytes : size;
    }
    found = set->filter_count > 0 ? found : H5Dget_storage_size(set->id);
    return found >= needed ? STATUS_OK : storage_refuse(path, name, "", found, needed);
}

bool mat73_has(const char *path, const char *name)
{
    const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    const bool has = H5Lexists(file, name, H5P_DEFAULT) > 0;
    H5Fclose(file);
    return has;
}

static enum status set_check(const char *path, const struct stored *stored, struct data_set *set)
{
    if (!set_open(path, stored, set)) {
        return set_refuse(path, stored->name, "has another size than its dimensions");
    }
    if (is_elsewhere(set)) {
        return set_refuse(path, stored->name, "is kept in another file");
    }
    if (H5Pget_layout(set->settings) == H5D_CHUNKED) {
        return chunks_check(path, stored->name, set);
    }
    const size_t found = H5Dget_storage_size(set->id);
    return found >= set->needed ? STATUS_OK : storage_refuse(path, stored->name, "", found, set->needed);
}

enum status mat73_check(const char *path, const struct stored *stored)
{
    struct data_set set;
    const enum status status = set_check(path, stored, &set);
    set_close(&set);
    return status;
}

/* Complex numbers, or real ones, which are then spread. */
static bool slab_read(const struct data_set *set, hid_t space, hid_t room, size_t count, enum precision precision,
                      void *values)
{
    const size_t size = precision_size(precision), part = size / 2;
    const hid_t part_type = precision == PRECISION_DOUBLE ? H5T_NATIVE_DOUBLE : H5T_NATIVE_FLOAT;
    if (H5Tget_class(set->type) != H5T_COMPOUND) {
        if (H5Dread(set->id, part_type, room, space, H5P_DEFAULT, values) < 0)
            return false;
        for (size_t k = count; k-- > 0;) {
            memmove((char *)values + k * size, (char *)values + k * part, part);
            memset((char *)values + k * size + part, 0, part);
        }
        return true;
    }
    const hid_t type = H5Tcreate(H5T_COMPOUND, size);
    H5Tinsert(type, "real", 0, part_type);
    H5Tinsert(type, "imag", part, part_type);
    const bool read = H5Dread(set->id, type, room, space, H5P_DEFAULT, values) >= 0;
    H5Tclose(type);
    return read;
}

bool mat73_read_pings(const char *path, const char *name, const struct pings *pings, const struct ping_run *run,
                      enum precision precision, void *values)
{
    static struct data_set set; /* stays open: the process that reads ends soon */
    const struct stored stored = {name, run->each * (size_t)pings->count, true, false};
    if (!set.id && !set_open(path, &stored, &set))
        return false;
    hsize_t begin[H5S_MAX_RANK] = {0}, count[H5S_MAX_RANK], numbers = (run->end - run->first) * run->each;
    const bool by_ping = set.rank > 0 && set.dims[0] == (hsize_t)pings->count;
    if (!by_ping && pings->count > 1) /* a single ping may have no dimension of its own */
        return false;
    for (int k = 0; k < set.rank; k++)
        count[k] = set.dims[k];
    if (by_ping) {
        begin[0] = run->first;
        count[0] = run->end - run->first;
    }
    const hid_t space = H5Dget_space(set.id), room = H5Screate_simple(1, &numbers, NULL);
    const bool read = H5Sselect_hyperslab(space, H5S_SELECT_SET, begin, NULL, count, NULL) >= 0
                      && slab_read(&set, space, room, numbers, precision, values);
    H5Sclose(room);
    H5Sclose(space);
    return read;
}

bool mat73_read(const char *path, const struct stored *stored, double complex *values)
{
    struct data_set set;
    return set_open(path, stored, &set) && slab_read(&set, H5S_ALL, H5S_ALL, stored->count, PRECISION_DOUBLE, values);
}
