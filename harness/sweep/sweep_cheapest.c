/* The cheapest sufficient setting: cheapest.csv of a sweep (sweep_group.h). */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "text/shown_text.h"
#include "show/table.h"
#include "sweep/sweep_group.h"

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

static bool is_candidate(const struct group *group, int k, double below, const char *begins)
{
    return group->error[k] <= below && strncmp(group->points.list[k].row->algorithm, begins, strlen(begins)) == 0;
}

/* The cheapest row with an error up to `below`, of equal ones the fastest; -1 without such a row. */
static int cheapest_find(const struct group *group, int c, double below, const char *begins)
{
    int best = -1;
    for (int k = 0; k < group->points.count; k++)
        if (is_candidate(group, k, below, begins)
            && measurement_is_cheaper(group->points.list[k].row, best < 0 ? NULL : group->points.list[best].row,
                                      sweep_costs[c].offset, below))
            best = k;
    return best;
}

/* The settings whose interval overlaps the cheapest one's, separated by "; "; returns their number. */
static int ties_find(const struct group *group, int best, double below, const char *begins, char *text, size_t size)
{
    int count = 0;
    *text = '\0';
    for (int k = 0; k < group->points.count && group->high[best] > group->low[best]; k++) {
        char spec[512];
        const size_t used = strlen(text);
        if (k == best || !is_candidate(group, k, below, begins) || group->low[k] > group->high[best])
            continue;
        measurement_spec(group->points.list[k].row, spec, sizeof spec);
        if (count++ < TIES_TOLD)
            snprintf(text + used, size - used, "%s%s", used ? "; " : "", spec);
    }
    if (count > TIES_TOLD)
        snprintf(text + strlen(text), size - strlen(text), "; %d more", count - TIES_TOLD);
    return count;
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
static bool is_told(const struct group *group, size_t family, int c)
{
    bool others = false;
    for (int k = 0; k < group->points.count; k++)
        others |=
            strcmp(group->points.list[k].row->algorithm, "reference") != 0
            && strncmp(group->points.list[k].row->algorithm, families[family].begins, strlen(families[family].begins))
                   != 0;
    return group->told && (family == 0 || (others && c == SWEEP_RUN_TIME));
}

/* For each decade from 1 down to the smallest that any setting of the family reaches. */
static void family_write(struct group *group, size_t family, int c, FILE *file)
{
    const char *begins = families[family].begins;
    const bool told = is_told(group, family, c);
    int best = cheapest_find(group, c, 1, begins);
    if (best >= 0 && told)
        printf("  %s %s\n      below      time speed-up     MFLOP    error  setting\n", families[family].title,
               sweep_costs[c].title);
    for (int decade = 0; best >= 0; decade--, best = cheapest_find(group, c, pow(10, decade), begins)) {
        const struct measurement *row = group->points.list[best].row;
        char threshold[16], ties[1800];
        snprintf(threshold, sizeof threshold, "1e%d", decade);
        ties_find(group, best, pow(10, decade), begins, ties, sizeof ties);
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

void cheapest_write(struct group *group, FILE *file)
{
    if (group->told)
        printf("\n%s: the cheapest setting for each decade of error\n", group->points.scene);
    for (size_t family = 0; family < sizeof families / sizeof *families; family++)
        for (int c = 0; c < SWEEP_COSTS; c++) {
            group_values(group, &sweep_costs[c]);
            family_write(group, family, c, file);
        }
}
