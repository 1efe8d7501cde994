#include "files/hash.h"

#include <inttypes.h>
#include <stdio.h>

void hash_add(uint64_t *hash, const void *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++)
        *hash = (*hash ^ ((const unsigned char *)bytes)[i]) * 0x100000001b3u;
}

bool hash_file(const char *path, char text[HASH_TEXT])
{
    unsigned char block[65536];
    uint64_t hash = HASH_BEGIN;
    FILE *file = fopen(path, "rb");
    snprintf(text, HASH_TEXT, "unknown");
    if (!file)
        return false;
    for (size_t count; (count = fread(block, 1, sizeof block, file)) > 0;)
        hash_add(&hash, block, count);
    const bool whole = !ferror(file);
    if (whole)
        snprintf(text, HASH_TEXT, "%016" PRIx64, hash);
    fclose(file);
    return whole;
}
