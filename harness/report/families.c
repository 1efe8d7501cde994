/* The table of plots/families.gp (families.h). */
#include "report/families.h"

#include <stdio.h>
#include <string.h>

void families_read(const char *plots_directory, struct families *families)
{
    char path[4096], line[200];
    *families = (struct families){.list = {{"others", "#666666", 3}}};
    snprintf(path, sizeof path, "%s/families.gp", plots_directory);
    FILE *file = fopen(path, "r");
    while (file && families->count < FAMILIES_MOST && fgets(line, sizeof line, file)) {
        struct family family;
        if (sscanf(line, "%31s #%6[0-9a-f] %d", family.name, family.colour + 1, &family.point) == 3) {
            family.colour[0] = '#';
            families->list[families->count++] = family;
        }
    }
    families->count += families->count == 0;
    if (file)
        fclose(file);
}

const struct family *family_of(const struct families *families, const char *algorithm)
{
    for (int k = 0; k < families->count; k++)
        if (strcmp(families->list[k].name, algorithm) == 0)
            return &families->list[k];
    return &families->list[families->count - 1];
}
