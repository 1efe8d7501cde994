/* Findings put together by what may have caused them: one verdict on one kind of metric (quality, work, time) of one
   algorithm in one setting, whatever the precision, the scene and the metric. */
#ifndef SASBENCH_GATE_DIFF_GROUPS_H
#define SASBENCH_GATE_DIFF_GROUPS_H

#include "gate/diff.h"

struct finding_group {
    enum verdict verdict;
    enum metric_class class;
    char spec[200];   /* without its precision */
    char what[400];   /* "error, pslr_db in float and double on 3 scenes" */
    int first, count; /* of the findings in struct groups */
};

struct groups {
    int count, finding_count;
    struct finding_group *groups;    /* [count] the worst verdict first, of those the largest */
    const struct finding **findings; /* [finding_count] by group, the largest change first; borrowed */
};

/* All findings but the same ones, put together; freed with groups_free. Errors: STATUS_FAILED without memory. */
enum status groups_make(const struct diff *diff, struct groups *groups);
void groups_free(struct groups *groups);

#endif
