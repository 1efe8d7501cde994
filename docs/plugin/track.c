/* A filter of sasbench: the same echoes from other places. `offsets` is a file with dx, dy and dz of each ping in m. */
#include <sasbench.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
struct plan {
    size_t bytes;    /* of the samples */
    double places[]; /* [pings][3], then [pings][receivers][3] */
};

static int make(const struct sas_problem *problem, struct sas_acquisition *out, void **data)
{
    const size_t pings = out->pings, receivers = out->receivers;
    struct plan *plan = malloc(sizeof *plan + 24 * pings * (1 + receivers));
    FILE *file = fopen(problem->texts[0], "r");
    double *tx = plan ? plan->places : NULL, *rx = plan ? tx + 3 * pings : NULL, offset[3] = {0, 0, 0};
    size_t read = 0;
    for (; plan && file && read < pings; read++) {
        if (fscanf(file, "%lf %lf %lf", &offset[0], &offset[1], &offset[2]) != 3)
            break;
        for (int axis = 0; axis < 3; axis++) {
            tx[3 * read + axis] = out->tx_m[3 * read + axis] + offset[axis];
            for (size_t n = 3 * read * receivers + axis; n < 3 * (read + 1) * receivers; n += 3)
                rx[n] = out->rx_m[n] + offset[axis];
        }
    }
    if (file)
        fclose(file);
    if (!plan || read < pings) {
        free(plan);
        return problem->host->fail(SAS_FAILED, "%zu of %zu pings' offsets in %s", read, pings, problem->texts[0]);
    }
    plan->bytes = pings * receivers * out->samples * (problem->precision == SAS_FLOAT ? 8 : 16);
    out->tx_m = tx;
    out->rx_m = rx;
    *data = plan;
    return SAS_OK;
}

static int execute(void *data, const void *samples, void *filtered, void *run)
{
    (void)run; /* the host times the stage `filter_1` */
    memcpy(filtered, samples, ((struct plan *)data)->bytes);
    return SAS_OK;
}

static void work(const void *data, struct sas_work *work)
{
    (void)data;
    work->flops = 0;
}

static const struct sas_setting offsets = {.size = sizeof offsets, .kind = SAS_TEXT, .name = "offsets",
    .summary = "file of dx dy dz in m, a line a ping", .text = "offsets.txt"};
const struct sas_filter sas_filter_plugin = {sizeof sas_filter_plugin, SAS_ABI, "places corrected by offsets", "none",
    0, 1, &offsets, make, execute, work, free};
