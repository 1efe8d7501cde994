/* The cheapest sufficient setting: cheapest.csv of a sweep (sweep_tables.h). */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "text/shown_text.h"
#include "text/text_append.h"
#include "show/table.h"
#include "sweep/sweep_tables.h"

enum { TIES_TOLD = 3 };

/* Families by the beginning of the name; the first is that of all algorithms. */
static const struct {
    const char *name, *begins, *title;
} families[] = {
    {"all", "", "by"},
    {"bp", "bp_", "back projection, by"},
    {"rma", "rma_", "range migration, by"},
    {"wk", "wk_", "omega-k, by"},
};

static bool is_candidate(const struct measurement *row, double below, const char *begins)
{
    return row->error <= below && strncmp(row->algorithm, begins, strlen(begins)) == 0;
}

/* The cheapest row with an error up to `below`, of equal ones the fastest; NULL without such a row. */
static const struct measurement *cheapest_find(const struct points *points, int c, double below, const char *begins)
{
    const struct measurement *best = NULL;
    for (int k = 0; k < points->count; k++)
        if (is_candidate(points->list[k].row, below, begins)
            && measurement_is_cheaper(points->list[k].row, best, sweep_costs[c].offset, below))
            best = points->list[k].row;
    return best;
}

/* The settings whose times' interval overlaps the cheapest one's, separated by "; ". */
static void ties_find(const struct points *points, const struct measurement *best, double below, const char *begins,
                      char *text, size_t size)
{
    double low, high, best_low, best_high;
    int count = 0;
    *text = '\0';
    measurement_interval(best, &best_low, &best_high);
    for (int k = 0; k < points->count && best_high > best_low; k++) {
        const struct measurement *row = points->list[k].row;
        char spec[512];
        measurement_interval(row, &low, &high);
        if (row == best || !is_candidate(row, below, begins) || low > best_high)
            continue;
        measurement_spec(row, spec, sizeof spec);
        if (count++ < TIES_TOLD)
            text_append(text, size, "%s%s", *text ? "; " : "", spec);
    }
    if (count > TIES_TOLD)
        text_append(text, size, "; %d more", count - TIES_TOLD);
}

static void row_tell(const struct measurement *row, const char *threshold, const char *ties)
{
    char spec[512], tied[2000];
    measurement_spec(row, spec, sizeof spec);
    shown_make(spec);
    printf("    %7s  %8s %8s %9s  %7.1e  ", threshold, cell_run_time(row).text,
           cell_significant(row->control_s / row->run_s, "x").text, cell_significant(1e-6 * row->flops, "").text,
           row->error);
    if (52 + (int)strlen(spec) <= table_width(stdout))
        puts(spec);
    else {
        putchar('\n');
        table_text(stdout, 8, spec);
    }
    if (!*ties)
        return;
    snprintf(tied, sizeof tied, "as fast, within the noise: %s", ties);
    shown_make(tied);
    table_text(stdout, 52, tied);
}

/* Does the terminal show the family? That of all algorithms always, another one only among several and by run time. */
static bool is_told(const struct points *points, size_t family, int c)
{
    const char *begins = families[family].begins;
    bool others = false;
    for (int k = 0; k < points->count; k++) {
        const char *name = points->list[k].row->algorithm;
        others |= strcmp(name, "reference") != 0 && strncmp(name, begins, strlen(begins)) != 0;
    }
    return family == 0 || (others && c == SWEEP_RUN_TIME);
}

/* For each decade from 1 down to the smallest that any setting of the family reaches. */
static void family_write(const struct points *points, size_t family, int c, bool told, FILE *file)
{
    const char *begins = families[family].begins;
    const struct measurement *row = cheapest_find(points, c, 1, begins);
    if (row && told)
        printf("  %s %s\n      below      time speed-up     MFLOP    error  setting\n", families[family].title,
               sweep_costs[c].title);
    for (int decade = 0; row; decade--, row = cheapest_find(points, c, pow(10, decade), begins)) {
        char threshold[16], ties[1800] = "";
        snprintf(threshold, sizeof threshold, "1e%d", decade);
        if (c == SWEEP_RUN_TIME)
            ties_find(points, row, pow(10, decade), begins, ties, sizeof ties);
        if (told)
            row_tell(row, threshold, ties);
        csv_write_fields(file,
                         (const char *const[]){row->scene, sweep_costs[c].name, threshold, row->algorithm, row->options,
                                               row->precision, NULL},
                         (double[]){row->run_s, row->control_s / row->run_s, row->flops, row->error, row->error_gain,
                                    row->pslr_db, row->islr_db},
                         7, false);
        csv_write_fields(file, (const char *const[]){families[family].name, ties, is_noisy(row) ? "~" : "", NULL}, NULL,
                         0, true);
    }
}

void cheapest_write(const struct points *points, bool told, FILE *file)
{
    if (told)
        printf("\n%s: the cheapest setting for each decade of error\n", points->scene);
    for (size_t family = 0; family < sizeof families / sizeof *families; family++)
        for (int c = 0; c < SWEEP_COSTS; c++)
            family_write(points, family, c, told && is_told(points, family, c), file);
}
