/* What commands set for external programs (external.c), and what their time costs. */
#ifndef SASBENCH_GUESTS_EXTERNAL_H
#define SASBENCH_GUESTS_EXTERNAL_H

/* s that a program may be silent while it plans or executes; 600 at first. */
void external_timeout(double seconds);
/* The results folder whose external.log gets what programs print; NULL, and at first: none. */
void external_logs(const char *folder);

#endif
