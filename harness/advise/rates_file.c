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

/* The k-th number of the file and its name; NULL behind the last. */
static double *rate_at(struct rates *rates, int k, char name[48])
{
    static const char *const engines[] = {"general", "invariant"};
    static const char *const kinds[READ_KINDS] = {"nearest", "line", "taps", "branches"};
    const struct {
        const char *name;
        double *rate;
    } others[] = {{"compress", &rates->compress},
                  {"filter", &rates->filter},
                  {"image", &rates->image},
                  {"general_put", &rates->put[0]},
                  {"invariant_put", &rates->put[1]},
                  {"migrate_records", &rates->migrate[MIGRATION_RECORDS]},
                  {"migrate_spread", &rates->migrate[MIGRATION_SPREAD]},
                  {"migrate_blocks", &rates->migrate[MIGRATION_BLOCKS]},
                  {"migrate_terms", &rates->migrate[MIGRATION_TERMS]},
                  {"migrate_focus", &rates->migrate[MIGRATION_FOCUS]},
                  {"doubled", &rates->doubled},
                  {"noise", &rates->noise}};
    const struct {
        const char *name;
        double (*rates)[READ_KINDS]; /* [2] */
    } pairs[] = {
        {"pair", rates->pair}, {"value", rates->value}, {"unit", rates->unit}, {"unit_value", rates->unit_value}};
    const int of_pairs = 4 * 2 * READ_KINDS, engine = k / (4 * READ_KINDS), kind = k / 4 % READ_KINDS;
    if (k < of_pairs) {
        snprintf(name, 48, "%s_%s_%s", engines[engine], kinds[kind], pairs[k % 4].name);
        return &pairs[k % 4].rates[engine][kind];
    }
    k -= of_pairs;
    if (k < 2 * READ_KINDS) {
        snprintf(name, 48, "general_%s_apart%s", kinds[k / 2], k % 2 ? "_value" : "");
        return &(k % 2 ? rates->apart_value : rates->apart)[k / 2];
    }
    k -= 2 * READ_KINDS;
    if (k >= (int)(sizeof others / sizeof *others))
        return NULL;
    snprintf(name, 48, "%s", others[k].name);
    return others[k].rate;
}

void machine_rates_path(char *path, size_t size)
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
    struct rates rates = {.doubled = NAN};
    bool whole = false;
    machine_rates_path(path, sizeof path);
    owner_format(owner, sizeof owner);
    if (*path && csv_read(path, CSV_TAIL_DROP, &csv) == STATUS_OK) {
        const char *of = csv_comment(&csv, "machine");
        const int name = csv_column(&csv, "rate"), value = csv_column(&csv, "value");
        whole = of && strcmp(of, owner) == 0 && name >= 0 && value >= 0;
        for (int k = 0; whole; k++) {
            char wanted[48];
            double *rate = rate_at(&rates, k, wanted);
            int row = 0;
            if (!rate)
                break;
            while (row < csv.row_count && strcmp(csv_cell(&csv, row, name), wanted) != 0)
                row++;
            whole = row < csv.row_count && csv_number(csv_cell(&csv, row, value), rate);
        }
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
    machine_rates_path(path, sizeof path);
    if (!*path)
        return STATUS_OK;
    snprintf(directory, sizeof directory, "%.*s", (int)(strrchr(path, '/') - path), path);
    owner_format(owner, sizeof owner);
    enum status status = directory_make(directory);
    if (status == STATUS_OK)
        status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    fprintf(file.stream, "# sasbench rates 1\n# machine: %s\nrate,value\n", owner);
    struct rates copy = *rates;
    char name[48];
    for (int k = 0; rate_at(&copy, k, name); k++)
        fprintf(file.stream, "%s,%.9g\n", name, *rate_at(&copy, k, name));
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
    machine_rates_path(path, sizeof path);
    fprintf(stderr, "sasbench: measured this machine's rates, to %.0f %%; kept in %s\n", 100 * rates_get()->noise,
            kept && *path ? path : "nothing");
    return STATUS_OK;
}
