/* Colours and points of the algorithms, from the one table in plots/families.gp. */
#ifndef SASBENCH_REPORT_FAMILIES_H
#define SASBENCH_REPORT_FAMILIES_H

enum { FAMILIES_MOST = 40 };

struct family {
    char name[32], colour[8]; /* "#0072b2" */
    int point;                /* as gnuplot numbers them, filled */
};
struct families {
    struct family list[FAMILIES_MOST]; /* [count] at least one: the last is that of all others */
    int count;
};
/* Without a readable table all algorithms look alike. */
void families_read(const char *plots_directory, struct families *families);
const struct family *family_of(const struct families *families, const char *algorithm);

#endif
