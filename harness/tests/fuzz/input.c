#include "tests/fuzz/input.h"

#include <dirent.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[256];
static pid_t owner; /* children that end by exit leave the folder alone */

void fuzz_fail(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fputs("fuzz: ", stderr);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    va_end(arguments);
    abort();
}

static void folder_remove(void)
{
    DIR *directory = getpid() == owner ? opendir(folder) : NULL;
    if (!directory)
        return;
    for (struct dirent *entry; (entry = readdir(directory));)
        unlinkat(dirfd(directory), entry->d_name, 0);
    closedir(directory);
    rmdir(folder);
}

const char *fuzz_folder(void)
{
    if (!*folder) {
        const char *base = getenv("TMPDIR");
        snprintf(folder, sizeof folder, "%s/fuzz-XXXXXX", base ? base : "/tmp");
        if (!mkdtemp(folder))
            fuzz_fail("no folder %s", folder);
        owner = getpid();
        atexit(folder_remove);
    }
    return folder;
}

const char *fuzz_file(int slot, const char *name, const uint8_t *data, size_t size)
{
    static char paths[FUZZ_SLOTS][PATH_MAX];
    snprintf(paths[slot], sizeof paths[slot], "%s/%s", fuzz_folder(), name);
    FILE *file = fopen(paths[slot], "wb");
    if (!file || fwrite(data, 1, size, file) != size || fclose(file) != 0)
        fuzz_fail("no file %s", paths[slot]);
    return paths[slot];
}

uint8_t take_byte(struct bytes *bytes)
{
    return bytes->next < bytes->end ? *bytes->next++ : 0;
}

int take_integer(struct bytes *bytes, int least, int most)
{
    return least + (int)(take_byte(bytes) % (unsigned)(most - least + 1));
}

double take_number(struct bytes *bytes, double least, double most)
{
    unsigned high = take_byte(bytes), low = take_byte(bytes);
    if (high % 16 == 15) {
        uint64_t bits = 0;
        double number;
        for (int i = 0; i < 8; i++)
            bits = bits << 8 | take_byte(bytes);
        memcpy(&number, &bits, sizeof number);
        return number;
    }
    return least + (most - least) * ((high << 8 | low) / 65535.0);
}
