/* A plug-in of sasbench: back projection, each record read by a truncated sinc of `taps` samples. */
#include <complex.h>
#include <math.h>
#include <omp.h>
#include <sasbench.h>
#include <stdlib.h>
struct plan {
    const struct sas_problem *problem;
    int records, samples, taps;
    double complex compressed[]; /* [records][samples] */
};

static int make(const struct sas_problem *problem, void **out)
{
    const struct sas_acquisition *a = problem->acquisition;
    const int records = a->pings * a->receivers;
    struct plan *plan = *out = malloc(sizeof *plan + 16 * (size_t)records * a->samples);
    if (!plan)
        return problem->host->fail(SAS_FAILED, "no memory for %d records", records);
    *plan = (struct plan){problem, records, a->samples, (int)problem->numbers[0]};
    return SAS_OK;
}

static int execute(void *data, const void *samples, void *const *pixels, void *run)
{
    struct plan *plan = data;
    const struct sas_problem *problem = plan->problem;
    const struct sas_host *host = problem->host;
#pragma omp parallel for
    for (int r = 0; r < plan->records; r++)
        host->compress(problem, omp_get_thread_num(), samples, r, plan->compressed + (size_t)r * plan->samples);
    host->stage(run, "compress");
#pragma omp parallel for
    for (int64_t n = 0; n < problem->pixels; n++) {
        double complex sum = 0;
        for (int r = 0; r < plan->records; r++) {
            double complex *s = plan->compressed + (size_t)r * plan->samples, value = 0;
            double delay, q;
            if (host->pair(problem, r, n, &delay, &q)) /* else the pair does not count */
                for (int k = (int)fmax(0, ceil(q - plan->taps / 2.)); k < fmin(q + plan->taps / 2., plan->samples); k++)
                    value += s[k] * (q == k ? 1 : sin(M_PI * (q - k)) / (M_PI * (q - k)));
            sum += value * cexp(2 * M_PI * I * fmod(problem->acquisition->carrier_hz * delay, 1));
        }
        host->store(problem, pixels, n, creal(sum), cimag(sum));
    }
    host->stage(run, "focus");
    return SAS_OK;
}

static void work(const void *data, struct sas_work *work)
{
    const struct plan *plan = data;
    work->pairs = plan->problem->host->pairs(plan->problem);
    work->flops = work->pairs * (8 + 4 * plan->taps) + plan->problem->host->compress_flops(plan->problem);
    work->bytes = sizeof *plan + 16.0 * plan->records * plan->samples;
}

static const struct sas_setting taps = {sizeof taps, SAS_INTEGER, "taps", "samples read", 8, 1, 64, 0, 0, "2 4 8 16"};
const struct sas_algorithm sas_plugin = {sizeof sas_plugin, SAS_ABI, "back projection by a truncated sinc", "BP22",
    SAS_ANY_TRACK | SAS_APERTURE_LIMIT, 1, &taps, make, execute, work, free};
