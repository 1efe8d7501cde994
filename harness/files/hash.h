/* FNV-1a: what identifies content. */
#ifndef SASBENCH_FILES_HASH_H
#define SASBENCH_FILES_HASH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define HASH_BEGIN 14695981039346656037u

void hash_add(uint64_t *hash, const void *bytes, size_t count);
/* Of a file's bytes, as 16 hexadecimal digits. False: errno has the reason, and the text is "unknown". */
enum { HASH_TEXT = 17 };
bool hash_file(const char *path, char text[HASH_TEXT]);

#endif
