/* Results folders of several machines and commits as pages side by side. */
#ifndef SASBENCH_REPORT_SITE_H
#define SASBENCH_REPORT_SITE_H

#include "contract/status.h"

/* Write OUT/index.html and a page for each scene, OUT/scene-1.html ...: for each kind of machine (processor, cores,
   memory, instruction set, threads) the fastest within an error, fronts, raw rows, and times over commits. Of several
   folders of a kind the newest row of a cell counts. OUT is made, or is an older site, which is replaced. Errors:
   STATUS_INVALID naming file, line and value for a folder that is not as in results/README.md, whose file does not say
   where it is from, or whose rows contradict themselves; and for an OUT that holds anything else. */
enum status site_write(int count, const char *const *folders, const char *out);

#endif
