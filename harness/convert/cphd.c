/* CPHD: phase history of a radar. Each vector is a ping with the places of both antennas, referred to the delay of a
   point.

   A target whose delay is D longer than the reference point's has the phase sign f (1 + aFDOP) D at frequency f, or in
   time of arrival a main lobe at D of the phase at the band's middle; f (1 + aFDOP) is taken as f + aFDOP times that
   middle. The receiver's place counts at the time of the reference point's echo, its velocity about it: at emission it
   was elsewhere. x and y are the file's image area coordinates in metres, so z is up. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "convert/band.h"
#include "convert/cphd_file.h"
#include "convert/layout.h"
#include "common/fft_length.h"

#define LIGHT_SPEED 299792458.0 /* m/s */
/* s: the atmosphere's part of RcvTime - TxTime, which the geometry has not; ionosphere at 400 MHz: some 1e-6. */
#define ATMOSPHERE_MOST 1e-5
#define FACTOR_MOST     1e200 /* samples of class single times it stay far from the end of doubles */
/* Of a step: what the last sample of a vector may be off by a step of its own; the ends of records turn by 3e-3 rad. */
#define UNEVEN_MOST 1e-3

/* A conversion under way. */
struct cphd {
    struct cphd_file file;
    const struct acquisition *acquisition;
    double *reference;    /* [vectors] s: delay of the reference point */
    double *shift;        /* [vectors] Hz: of the middle of the vector's band, from fc */
    double *factor;       /* [vectors] */
    double step;          /* from sample to sample: Hz, or s */
    double complex *line; /* [samples] of one vector */
    struct band band;
};

struct frame {
    struct vector origin, x, y, z; /* earth-centred, m, and unit vectors */
};

static struct vector cross(struct vector a, struct vector b)
{
    return (struct vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static struct vector scaled_sum(struct vector a, double factor, struct vector b)
{
    return (struct vector){a.x + factor * b.x, a.y + factor * b.y, a.z + factor * b.z};
}

static struct vector turned(const struct frame *frame, struct vector v)
{
    return (struct vector){vector_dot(v, frame->x), vector_dot(v, frame->y), vector_dot(v, frame->z)};
}

/* A step of a metre that the file states in rad of latitude and longitude, on WGS 84 about the frame's origin. */
static enum status geodetic_step(const struct cphd_file *file, const char *field, struct vector *step)
{
    static const double equator = 6378137, flattening = 1 / 298.257223563, degree = M_PI / 180;
    double latitude, longitude, height, north = 0, east = 0;
    char name[100];
    enum status status = cphd_number(file, "SceneCoordinates/IARP/LLH/Lat", &latitude);
    if (status == STATUS_OK)
        status = cphd_number(file, "SceneCoordinates/IARP/LLH/Lon", &longitude);
    if (status == STATUS_OK)
        status = cphd_number(file, "SceneCoordinates/IARP/LLH/HAE", &height);
    snprintf(name, sizeof name, "%s/Lat", field);
    if (status == STATUS_OK)
        status = cphd_number(file, name, &north);
    snprintf(name, sizeof name, "%s/Lon", field);
    if (status == STATUS_OK)
        status = cphd_number(file, name, &east);
    if (status != STATUS_OK)
        return status;
    const double sine = sin(latitude * degree), cosine = cos(latitude * degree),
                 eccentric = flattening * (2 - flattening);
    const double across = equator / sqrt(1 - eccentric * sine * sine);
    north *= across * (1 - eccentric) / (1 - eccentric * sine * sine) + height;
    east *= (across + height) * cosine;
    const double c = cos(longitude * degree), s = sin(longitude * degree);
    *step = (struct vector){-north * sine * c - east * s, -north * sine * s + east * c, north * cosine};
    return STATUS_OK;
}

static enum status frame_read(const struct cphd_file *file, struct frame *frame)
{
#define SURFACE "SceneCoordinates/ReferenceSurface/"
    const bool is_planar = xml_text(&file->xml, SURFACE "Planar/uIAX/X", 0);
    const char *const axes[] = {is_planar ? SURFACE "Planar/uIAX" : SURFACE "HAE/uIAXLL",
                                is_planar ? SURFACE "Planar/uIAY" : SURFACE "HAE/uIAYLL"};
    struct vector given[2];
    enum status status = cphd_place(file, "SceneCoordinates/IARP/ECF", &frame->origin);
    for (int k = 0; k < 2 && status == STATUS_OK; k++)
        status = (is_planar ? cphd_place : geodetic_step)(file, axes[k], &given[k]);
    if (status != STATUS_OK)
        return status;
    const double lengths[] = {vector_norm(given[0]), vector_norm(given[1])}, skew = vector_dot(given[0], given[1]);
    for (int k = 0; k < 2; k++)
        if (!(fabs(lengths[k] - 1) <= 1e-3) || !(fabs(skew) <= 1e-3)) /* decimals of the text */
            return status_set(
                STATUS_INVALID,
                "%s: variable `%s` is %g m long, and its cosine with the other axis %g; two steps of 1 m at "
                "right angles are needed",
                file->path, axes[k], lengths[k], skew);
    frame->x = scaled_sum((struct vector){0}, 1 / lengths[0], given[0]);
    frame->z = cross(frame->x, given[1]);
    frame->z = scaled_sum((struct vector){0}, 1 / vector_norm(frame->z), frame->z);
    frame->y = cross(frame->z, frame->x);
    return STATUS_OK;
}

/* Places, delays and bands of all vectors; *width: the widest band, Hz. */
static enum status vectors_read(struct cphd *cphd, const struct frame *frame, struct acquisition *a, double *width)
{
    const struct cphd_file *file = &cphd->file;
    struct vector v[CPHD_PARAMETERS];
    char why[160];
    *width = 0;
    for (int p = 0; p < file->vectors; p++) {
        const enum status status = cphd_vector(file, p, v);
        if (status != STATUS_OK)
            return status;
        const double delay = (vector_norm(vector_difference(v[CPHD_TX_POS], v[CPHD_SRP_POS]))
                              + vector_norm(vector_difference(v[CPHD_RCV_POS], v[CPHD_SRP_POS])))
                             / LIGHT_SPEED;
        const double flight = v[CPHD_RCV_TIME].x - v[CPHD_TX_TIME].x, step = v[CPHD_SCSS].x, low = v[CPHD_FX1].x,
                     band = v[CPHD_FX2].x - low;
        snprintf(why, sizeof why,
                 "is %.10g s after `PVP/TxTime`, the way by `PVP/SRPPos` takes %.10g s; the same is needed", flight,
                 delay);
        if (!(fabs(flight - delay) <= ATMOSPHERE_MOST))
            return cphd_refuse(file, CPHD_RCV_TIME, p, why);
        snprintf(why, sizeof why, "is %.10g, of the first vector %.10g; the same step > 0 is needed", step,
                 p ? cphd->step : step);
        cphd->step = p ? cphd->step : step;
        if (!(step > 0) || !(file->samples * fabs(step / cphd->step - 1) <= UNEVEN_MOST))
            return cphd_refuse(file, CPHD_SCSS, p, why);
        if (file->is_toa && !(low > 0 && band > 0 && band * step <= 1))
            return cphd_refuse(file, CPHD_FX2, p, "and `PVP/FX1` are no band above 0 that `PVP/SCSS` samples");
        if (!(v[CPHD_AMP_SF].x > 0 && v[CPHD_AMP_SF].x <= FACTOR_MOST))
            return cphd_refuse(file, CPHD_AMP_SF, p, "is no factor > 0 of at most 1e200");
        const double middle = file->is_toa ? low + band / 2 : v[CPHD_SC0].x + file->samples / 2 * step;
        *width = fmax(*width, file->is_toa ? band : file->samples * step);
        cphd->reference[p] = delay;
        cphd->shift[p] = middle * (1 + v[CPHD_A_FDOP].x);
        cphd->factor[p] = v[CPHD_AMP_SF].x;
        a->t0[p] = delay + (file->is_toa ? v[CPHD_SC0].x : 0);
        a->tx[p] = turned(frame, vector_difference(v[CPHD_TX_POS], frame->origin));
        a->velocity[p] = turned(frame, v[CPHD_RCV_VEL]);
        a->rx[p] = scaled_sum(turned(frame, vector_difference(v[CPHD_RCV_POS], frame->origin)), -delay, a->velocity[p]);
    }
    return STATUS_OK;
}

/* The carrier in the middle of all vectors' bands, and a rate that holds them. */
static enum status band_find(struct cphd *cphd, double width, struct acquisition *a)
{
    const struct cphd_file *file = &cphd->file;
    double least = INFINITY, most = 0;
    int farthest = 0;
    for (int p = 0; p < a->pings; p++) {
        least = fmin(least, cphd->shift[p]);
        farthest = cphd->shift[p] > most ? p : farthest;
        most = fmax(most, cphd->shift[p]);
    }
    const double rate = 1 / cphd->step;
    a->fc = least + (most - least) / 2;
    a->bandwidth = width + (most - least);
    for (int p = 0; p < a->pings; p++)
        cphd->shift[p] -= a->fc;
    if (!(least > 0) || !(most - least <= width) || (file->is_toa && !(a->bandwidth <= rate)))
        return cphd_refuse(file, file->is_toa ? CPHD_FX2 : CPHD_SC0, farthest,
                           "is of a band too far from the other vectors', or of none above 0 Hz; bands of one record's "
                           "width are needed");
    /* A quarter beyond the band, over which interpolators roll off. */
    a->samples = file->is_toa ? file->samples : fft_length((long long)(1.25 * a->bandwidth / cphd->step) + 1);
    a->fs = file->is_toa ? rate : a->samples * cphd->step;
    for (int p = 0; p < a->pings && !file->is_toa; p++)
        a->t0[p] -= a->samples / 2 / a->fs;
    return file->is_toa ? STATUS_OK : band_open(file->samples, a->samples, &cphd->band);
}

static double complex turn(double cycles)
{
    return cexp(2 * M_PI * I * (cycles - round(cycles)));
}

static enum status cphd_pings(void *with, int first, int count, double complex *samples)
{
    struct cphd *cphd = with;
    const struct acquisition *a = cphd->acquisition;
    const int length = cphd->file.samples;
    for (int p = first; p < first + count; p++, samples += a->samples) {
        const enum status status = cphd_samples(&cphd->file, p, cphd->line);
        if (status != STATUS_OK)
            return status;
        for (int n = 0; n < length && cphd->file.sign > 0; n++)
            cphd->line[n] = conj(cphd->line[n]);
        const double complex factor = cphd->factor[p] * turn(-a->fc * cphd->reference[p]);
        if (cphd->file.is_toa)
            for (int n = 0; n < length; n++)
                samples[n] = factor * cphd->line[n];
        else
            band_samples(&cphd->band, cphd->line, -(a->samples / 2), factor / length, samples);
        for (int n = 0; n < a->samples && cphd->shift[p] != 0; n++)
            samples[n] *= turn(cphd->shift[p] * (a->t0[p] + n / a->fs - cphd->reference[p]));
    }
    return STATUS_OK;
}

static void cphd_end(void *with)
{
    struct cphd *cphd = with;
    cphd_close(&cphd->file);
    band_close(&cphd->band);
    free(cphd->reference);
    free(cphd->shift);
    free(cphd->factor);
    free(cphd->line);
    free(cphd);
}

static enum status cphd_begin(struct cphd *cphd, struct acquisition *a)
{
    const size_t vectors = (size_t)cphd->file.vectors;
    cphd->reference = calloc(vectors, sizeof *cphd->reference);
    cphd->shift = calloc(vectors, sizeof *cphd->shift);
    cphd->factor = calloc(vectors, sizeof *cphd->factor);
    cphd->line = calloc((size_t)cphd->file.samples, sizeof *cphd->line);
    cphd->acquisition = a;
    *a = (struct acquisition){.samples = cphd->file.samples, .receivers = 1, .pings = cphd->file.vectors};
    a->sound_speed = LIGHT_SPEED;
    a->aperture_limit = INFINITY;
    a->compressed = true;
    if (!cphd->reference || !cphd->shift || !cphd->factor || !cphd->line)
        return status_set(STATUS_FAILED, "%s: out of memory for %zu vectors", cphd->file.path, vectors);
    return acquisition_allocate(a);
}

static enum status cphd_read(const char *const *paths, int count, struct recording *recording)
{
    struct acquisition *a = &recording->acquisition;
    struct cphd *cphd = calloc(1, sizeof *cphd);
    struct frame frame;
    double width = 0;
    (void)count;
    if (!cphd)
        return status_set(STATUS_FAILED, "%s: out of memory", paths[0]);
    recording->source = (struct sample_source){0, cphd_pings, cphd};
    recording->source_close = cphd_end;
    enum status status = cphd_open(paths[0], &cphd->file);
    if (status == STATUS_OK)
        status = frame_read(&cphd->file, &frame);
    if (status == STATUS_OK)
        status = cphd_begin(cphd, a);
    if (status == STATUS_OK)
        status = vectors_read(cphd, &frame, a, &width);
    if (status == STATUS_OK)
        status = band_find(cphd, width, a);
    if (status == STATUS_OK && cphd->file.channels > 1)
        snprintf(recording->note, sizeof recording->note, "channel %d of %d, the reference of the file",
                 cphd->file.channel + 1, cphd->file.channels);
    return status;
}

const struct layout cphd_layout = {"CPHD", NULL, 0, false, "CPHD/", cphd_read};
