#include "measure/guise.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

#include "common/memory.h"
#include "echoes/echo_data.h"

enum { HEARD_LEAST = 8 }; /* pings: fewer are negated together */

static size_t ping_size(const struct echoes *echoes)
{
    const struct acquisition *a = echoes->acquisition;
    return size_product(1, (size_t)a->receivers, (size_t)a->samples, precision_size(echoes->precision));
}

/* A random half of the pings that are heard. */
static void halve(struct guise *guise)
{
    uint64_t random = 0;
    if (getrandom(&random, sizeof random, 0) != sizeof random)
        random = (uint64_t)guise->runs;
    memset(guise->half, 0, (size_t)guise->echoes->acquisition->pings * sizeof *guise->half);
    for (int k = 0; k < guise->count / 2; k++) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        const int other = k + (int)((random >> 33) % (uint64_t)(guise->count - k)), ping = guise->heard[other];
        guise->heard[other] = guise->heard[k];
        guise->heard[k] = ping;
        guise->half[ping] = true;
    }
}

static bool is_heard(const struct echoes *echoes, int ping)
{
    const size_t size = ping_size(echoes);
    const char *bytes = (const char *)echoes->samples + (size_t)ping * size;
    for (size_t n = 0; n < size; n++)
        if (bytes[n] != 0)
            return true;
    return false;
}

struct guise guise_begin(const struct algorithm *algorithm, struct echoes *echoes)
{
    struct guise guise = {.algorithm = algorithm, .echoes = echoes};
    const int pings = echoes->acquisition->pings;
    if (!algorithm->origin) /* the program's own */
        return guise;
    guise.size = (size_t)pings * ping_size(echoes);
    if (memory_check((double)guise.size, "a copy of the samples") == STATUS_OK)
        guise.kept = malloc(guise.size);
    if (guise.kept)
        memcpy(guise.kept, echoes->samples, guise.size);
    guise.heard = algorithm->traits & TRAIT_FILTERED ? NULL : malloc((size_t)pings * sizeof *guise.heard);
    for (int p = 0; p < pings && guise.heard; p++)
        if (is_heard(echoes, p))
            guise.heard[guise.count++] = p;
    guise.half = guise.count >= HEARD_LEAST ? malloc((size_t)pings * sizeof *guise.half) : NULL;
    if (guise.half)
        halve(&guise);
    return guise;
}

/* Pings of the half, or the others. */
static void pings_negate(struct guise *guise, bool half)
{
    struct echoes one = *guise->echoes;
    struct acquisition ping = *one.acquisition;
    ping.pings = 1;
    one.acquisition = &ping;
    for (int p = 0; p < guise->echoes->acquisition->pings; p++)
        if (guise->half[p] == half) {
            one.samples = (const char *)guise->echoes->samples + (size_t)p * ping_size(guise->echoes);
            echoes_negate(&one);
        }
}

/* Of run n, from 0. */
static int guise_of(const struct guise *guise, int n)
{
    return guise->half ? n % GUISES : n % 2 * 2;
}

void guise_spoil(const struct image *image)
{
    const double complex spoilt = NAN + NAN * I;
    for (int k = 0; k < image->patch_count; k++) {
        float complex *single = image->pixels[k];
        double complex *both = image->pixels[k];
        const size_t count = grid_pixels(&image->patches[k]);
        for (size_t n = 0; n < count; n++)
            if (image->precision == PRECISION_FLOAT)
                single[n] = (float complex)spoilt;
            else
                both[n] = spoilt;
    }
}

/* Weighted sum of all pixels; the sum of the negated image is its exact negative. */
static double complex image_sum(const struct image *image)
{
    double complex sum = 0;
    unsigned weight = 1;
    for (int k = 0; k < image->patch_count; k++)
        for (int i = 0; i < image->patches[k].r_count; i++)
            for (int j = 0; j < image->patches[k].x_count; j++) {
                weight = 1664525 * weight + 1013904223;
                sum += (1 + 0x1p-32 * weight) * image_pixel(image, k, i, j);
            }
    return sum;
}

/* Filters need not be linear; but the same echoes have the same image, and the negated ones another, unless it is
   kept. */
static enum status sum_check(const struct guise *guise, int now, double complex sum)
{
    const bool filtered = guise->algorithm->traits & TRAIT_FILTERED;
    const int other = (now + 2) % GUISES;
    const char *fault = NULL;
    if (!isfinite(cabs(sum)))
        return STATUS_OK;
    if (filtered && guise->known[other] && sum == guise->sums[other] && sum != 0)
        fault = "the image of the negated echoes is the same image";
    else if (filtered && guise->known[now] && sum != guise->sums[now])
        fault = "the same echoes have another image";
    else if (!filtered && guise->known[other] && sum != -guise->sums[other])
        fault = "the image of the negated echoes is not the negated image";
    else if (now == 1 && guise->known[0] && sum != 0 && (sum == guise->sums[0] || sum == -guise->sums[0]))
        fault = "echoes with half of the pings negated have the same image";
    return fault ? status_set(STATUS_FAILED, "%s: %s (run %d)", guise->algorithm->name, fault, guise->runs + 1)
                 : STATUS_OK;
}

/* Other algorithms image the same samples later. */
static enum status samples_check(const struct guise *guise)
{
    if (!guise->kept || memcmp(guise->kept, guise->echoes->samples, guise->size) == 0)
        return STATUS_OK;
    memcpy((void *)guise->echoes->samples, guise->kept, guise->size);
    return status_set(STATUS_FAILED, "%s: it changed its samples, must only read them", guise->algorithm->name);
}

enum status guise_next(struct guise *guise, const struct image *image)
{
    const int now = guise_of(guise, guise->runs);
    const double complex sum = image_sum(image);
    enum status status = guise->runs == 0 ? samples_check(guise) : STATUS_OK;
    if (status == STATUS_OK)
        status = sum_check(guise, now, sum);
    guise->sums[now] = sum;
    guise->known[now] = isfinite(cabs(sum));
    guise->runs++;
    if (!guise->half)
        echoes_negate(guise->echoes);
    else
        pings_negate(guise, now % 2 == 0);
    if (guise->half && now == GUISES - 1) { /* the next half has nothing to do with this one */
        guise->known[1] = guise->known[3] = false;
        halve(guise);
    }
    return status;
}

bool guise_plain(const struct guise *guise)
{
    return guise_of(guise, guise->runs - 1) % 2 == 0;
}

enum status guise_end(struct guise *guise, struct image *image)
{
    const int next = guise_of(guise, guise->runs);
    if (next == 2 && !guise->half)
        echoes_negate(guise->echoes);
    if (guise->half && (next == 1 || next == 2))
        pings_negate(guise, true);
    if (guise->half && (next == 2 || next == 3))
        pings_negate(guise, false);
    if (guise->runs > 0 && guise_of(guise, guise->runs - 1) == 2)
        image_negate(image);
    const enum status status = samples_check(guise);
    free(guise->kept);
    free(guise->heard);
    free(guise->half);
    return status;
}
