/* Without MPI: one rank (link.h). */
#include "ranks/link.h"

#include <stdlib.h>

bool link_open(int *number, int *count)
{
    *number = 0;
    *count = 1;
    return false;
}

bool link_same(const void *ours, void *theirs, size_t size)
{
    (void)ours, (void)theirs, (void)size;
    return true;
}

void link_send(int to, int value)
{
    (void)to, (void)value;
}

bool link_take(int *from, int *value)
{
    (void)from, (void)value;
    return false;
}

void link_close(void)
{
}

void link_abort(int status)
{
    _Exit(status);
}
