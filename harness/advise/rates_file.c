/* Rates in the user's cache (machine_rates.h). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "files/csv.h"
#include "files/folder.h"
#include "files/text_file.h"
#include "results/provenance.h"
#include "advise/machine_rates.h"

/* The file has the struct's numbers in their order: no other program reads it, and another build measures anew. */
enum { RATES = sizeof(struct rates) / sizeof(double) };

/* The file's path; empty where the environment names no folder. */
static void rates_path(char *path, size_t size)
{
    const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    *path = '\0';
    if (cache && *cache == '/') /* relative ones are not followed, by the XDG rules */
        snprintf(path, size, "%s/sasbench/rates.csv", cache);
    else if (home && *home)
        snprintf(path, size, "%s/.cache/sasbench/rates.csv", home);
}

/* What rates depend on: another build may be faster. */
static void owner_format(char *text, size_t size)
{
    struct provenance provenance;
    provenance_fill(&provenance, 1);
    snprintf(text, size, "%s, %s, program %s", provenance.machine, provenance.isa, provenance.program);
}

void machine_rates_use(bool *found)
{
    char path[4096], owner[300];
    struct csv csv = {0};
    double numbers[RATES] = {0};
    struct rates rates;
    bool whole = false;
    rates_path(path, sizeof path);
    owner_format(owner, sizeof owner);
    if (*path && csv_read(path, CSV_TAIL_DROP, &csv) == STATUS_OK) {
        const char *of = csv_comment(&csv, "machine");
        whole = of && strcmp(of, owner) == 0 && csv.row_count == RATES;
        for (int k = 0; k < RATES && whole; k++)
            whole = csv_number(csv_cell(&csv, k, 0), &numbers[k]);
        memcpy(&rates, numbers, sizeof rates);
        whole = whole && rates_plausible(&rates);
    }
    csv_free(&csv);
    if (whole)
        rates_set(&rates);
    if (found)
        *found = whole;
}

enum status machine_rates_keep(const struct rates *rates)
{
    char path[4096], directory[4096], owner[300];
    struct text_file file;
    if (!rates_plausible(rates))
        return status_set(STATUS_FAILED, "the measured times are not plausible; the built-in rates are used");
    rates_set(rates);
    rates_path(path, sizeof path);
    if (!*path)
        return STATUS_OK;
    snprintf(directory, sizeof directory, "%.*s", (int)(strrchr(path, '/') - path), path);
    owner_format(owner, sizeof owner);
    enum status status = directory_make(directory);
    if (status == STATUS_OK)
        status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    fprintf(file.stream, "# sasbench rates 2\n# machine: %s\nrate\n", owner);
    double numbers[RATES];
    memcpy(numbers, rates, sizeof numbers);
    for (int k = 0; k < RATES; k++)
        fprintf(file.stream, "%.9g\n", numbers[k]);
    return text_file_close(&file, status);
}

enum status machine_rates_need(void)
{
    char path[4096];
    bool found;
    struct rates rates;
    machine_rates_use(&found);
    if (found)
        return STATUS_OK;
    enum status status = machine_rates_measure(&rates);
    if (status != STATUS_OK)
        return status;
    const bool kept = machine_rates_keep(&rates) == STATUS_OK;
    if (!kept)
        fprintf(stderr, "sasbench: warning: this machine's rates are not kept: %s\n", status_message());
    rates_path(path, sizeof path);
    fprintf(stderr, "sasbench: measured this machine's rates, to %.0f %%; kept in %s\n", 100 * rates_get()->noise,
            kept && *path ? path : "nothing");
    return STATUS_OK;
}
