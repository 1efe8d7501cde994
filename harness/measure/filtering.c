/* The polar-format filter on recorded echoes (filtering.h). */
#include "measure/filtering.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/traces.h"
#include "echoes/echo_data.h"
#include "scene/simulate.h"
#include "wavenumber/wk.h"

void filtering_close(struct filtering *filtering)
{
    traces_double.destroy(filtering->traces);
    polar_filter_destroy_double(filtering->filter);
}

enum status filtering_open(const struct acquisition *acquisition, const struct spec *spec, struct filtering *filtering)
{
    const struct wk_options *options = spec->options;
    const struct polar_setting setting = {options->subapertures, options->curvature, options->band};
    const struct traces_form form = {.upsample = 1};
    struct traces_shape shape;
    *filtering = (struct filtering){.acquisition = acquisition};
    enum status status =
        polar_filter_plan_double(acquisition, &setting, omp_get_max_threads(), &filtering->shape, &filtering->filter);
    if (status == STATUS_OK)
        status = traces_double.plan(acquisition, &form, omp_get_max_threads(), &shape, &filtering->traces);
    if (status != STATUS_OK)
        filtering_close(filtering);
    return status;
}

void filtering_compress(const struct filtering *filtering, double complex *records)
{
    if (filtering->acquisition->compressed)
        return;
    const size_t samples = (size_t)filtering->acquisition->samples;
#pragma omp parallel for schedule(static)
    for (int p = 0; p < filtering->acquisition->pings; p++)
        traces_double.fill(filtering->traces, omp_get_thread_num(), records + samples * (size_t)p,
                           records + samples * (size_t)p);
}

void filtering_apply(const struct filtering *filtering, double complex *records)
{
    polar_filter_apply_double(filtering->filter, records);
}

/* Energy of samples less `off` (may be NULL), in units of `unit` squared, so that no square overflows. */
static double energy(const double complex *samples, const double complex *off, size_t count, double unit)
{
    double sum = 0;
    for (size_t n = 0; n < count; n++) {
        double complex value = samples[n] - (off ? off[n] : 0);
        double re = creal(value) / unit, im = cimag(value) / unit;
        sum += re * re + im * im;
    }
    return sum;
}

enum status filtering_measure(const struct filtering *filtering, double complex *records, struct kept *kept)
{
    const struct acquisition *a = filtering->acquisition;
    const size_t count = (size_t)a->samples * (size_t)a->pings;
    double complex *before = malloc(count * sizeof *before);
    *kept = (struct kept){NAN, NAN};
    if (!before)
        return status_set(STATUS_FAILED, "no memory for the echoes ahead of the filter");
    memcpy(before, records, count * sizeof *before);
    filtering_apply(filtering, records);
    const double largest = largest_part(before, PRECISION_DOUBLE, count);
    if (largest > 0) {
        double own = energy(before, NULL, count, largest);
        kept->kept_db = 10 * log10(energy(records, NULL, count, largest) / own);
        kept->changed_db = 10 * log10(energy(records, before, count, largest) / own);
    }
    free(before);
    return STATUS_OK;
}

enum status filtering_target(const struct filtering *filtering, const struct scene *scene, int index, struct kept *kept)
{
    struct scene alone = *scene;
    struct echoes echoes;
    alone.targets = &scene->targets[index];
    alone.target_count = alone.point_count = 1;
    alone.noise_std = 0;
    enum status status = scene_simulate(&alone, &echoes);
    if (status != STATUS_OK)
        return status;
    double complex *samples = (double complex *)echoes.samples;
    filtering_compress(filtering, samples);
    status = filtering_measure(filtering, samples, kept);
    echoes_free(&echoes);
    return status;
}

bool area_holds(const struct target_area *area, double x_m, double r_m)
{
    return fabs(x_m - area->x) < area->half_x && fabs(r_m - area->r) < area->half_r;
}
