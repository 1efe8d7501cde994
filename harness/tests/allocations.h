/* Memory and FFTW plans that our own objects take and give back: the linker sends their calls here (-Wl,--wrap, see
   meson.build). What libraries allocate inside is not seen. */
#ifndef SASBENCH_TEST_ALLOCATIONS_H
#define SASBENCH_TEST_ALLOCATIONS_H

struct allocations {
    int taken, freed;           /* calls that allocate, and that free something */
    int plans, plans_destroyed; /* of FFTW */
    int blocks;                 /* of those taken: still held */
    double bytes;               /* in them */
    int refused;                /* calls that got NULL */
};

/* Count from zero until allocations_end. `refuse`: the number of the one call, from 0, that allocates and gets NULL;
   -1: none does. */
void allocations_begin(int refuse);
struct allocations allocations_now(void);
struct allocations allocations_end(void);

#endif
