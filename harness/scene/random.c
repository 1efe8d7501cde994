#include "scene/random.h"

#include <math.h>

static uint64_t next(struct random *random)
{
    uint64_t z = random->state += 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

struct random random_seed(uint64_t seed, uint64_t stream)
{
    struct random random = {seed};
    uint64_t mixed = next(&random);
    random.state = mixed ^ (stream * 0xD1342543DE82EF95u);
    random.state = next(&random);
    return random;
}

double random_uniform(struct random *random)
{
    return (double)(next(random) >> 11) * 0x1p-53;
}

double complex random_normal(struct random *random)
{
    double radius = sqrt(-log(1 - random_uniform(random)));
    double angle = 6.283185307179586 * random_uniform(random);
    return radius * cos(angle) + I * (radius * sin(angle));
}
