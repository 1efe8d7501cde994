/* Where measurements are from. */
#ifndef SASBENCH_RESULTS_PROVENANCE_H
#define SASBENCH_RESULTS_PROVENANCE_H

/* Rows are comparable where these agree: written as `# key: value` lines ahead of the rows. */
struct provenance {
    char machine[128], isa[16], compiler[160], flags[256], libraries[160], commit[80], program[32], date[32];
    int threads;
};
void provenance_fill(struct provenance *provenance, int threads);
/* The line below a new picture: "sasbench COMMIT, DATE". */
enum { PROVENANCE_LINE = 160 };
void provenance_line(char text[PROVENANCE_LINE]);

#endif
