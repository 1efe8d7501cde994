/* Verdicts (stability_verdict.h). Norms are in long double, which neither overflows nor underflows for values of
   double. */
#include "stability/stability_verdict.h"

#include <fenv.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "stability/method.h"

static const char *const kind_names[] = {"works", "degrades", "refused", "fails"};

/* An image of either kind, so that any two can be compared. */
struct view {
    const double complex *pixels; /* or */
    const struct exact_sum *sums;
};

static long double pixel_part(struct view view, size_t i, bool imaginary)
{
    if (view.pixels)
        return imaginary ? cimag(view.pixels[i]) : creal(view.pixels[i]);
    return imaginary ? view.sums[i].im : view.sums[i].re;
}

/* L2 norm of a - b over pixels [first, end); of a alone without b. */
static long double norm_of(struct view a, struct view b, size_t first, size_t end)
{
    const bool both = b.pixels || b.sums;
    long double sum = 0.0L;
    for (size_t i = first; i < end; i++) {
        const long double re = pixel_part(a, i, false) - (both ? pixel_part(b, i, false) : 0.0L);
        const long double im = pixel_part(a, i, true) - (both ? pixel_part(b, i, true) : 0.0L);
        sum += re * re + im * im;
    }
    return sqrtl(sum);
}

/* Patch k's pixels. */
static void patch_span(const struct scene *scene, int k, size_t *first, size_t *end)
{
    *first = exact_pixels(k, scene->patches);
    *end = exact_pixels(k + 1, scene->patches);
}

/* The larger; NaN as soon as one is NaN. */
static double worse(double a, double b)
{
    return isnan(a) || b <= a ? a : b;
}

/* Norm of a - b over that of b, worst patch; a patch where b is zero allows no difference at all. */
static double relative(const struct scene *scene, struct view a, struct view b)
{
    double worst = 0;
    for (int k = 0; k < scene->patch_count; k++) {
        size_t first, end;
        patch_span(scene, k, &first, &end);
        const long double norm = norm_of(b, (struct view){0}, first, end), difference = norm_of(a, b, first, end);
        worst = worse(worst, norm > 0.0L ? (double)(difference / norm) : difference > 0.0L ? INFINITY : 0);
    }
    return worst;
}

/* Largest rounding error of a pair's phase, rad. */
static double phase_rounding(const struct scene *scene)
{
    const struct acquisition *a = &scene->acquisition;
    double delay = 0, place = 0;
    for (int p = 0; p < a->pings; p++) {
        delay = fmax(delay, fmax(fabs(a->t0[p]), fabs(a->t0[p] + (a->samples - 1) / a->fs)));
        place = fmax(place, fabs(a->tx[p].x));
    }
    return 2 * M_PI * 0x1p-53 * ((a->fc + a->fs / 2) * delay + a->fc * 2 * place / a->sound_speed);
}

/* The conditioning over one patch, relative to the image's norm (stability_verdict.h). */
static long double conditioning_of(const struct exact_sum *sums, size_t first, size_t end, double phase, double epsilon)
{
    long double sum = 0.0L, norm = norm_of((struct view){.sums = sums}, (struct view){0}, first, end);
    for (size_t i = first; i < end; i++) {
        const long double share = sums[i].size * (phase + epsilon * (1.0L + sqrtl(sums[i].pairs))) + sums[i].ties;
        sum += share * share;
    }
    return sqrtl(sum) / norm;
}

/* Digits lost between two images of one method, the worst patch. */
static void digits_measure(const struct scene *scene, struct view image, struct view own, const struct exact_sum *sums,
                           double phase, double epsilon, struct stability_verdict *verdict)
{
    for (int k = 0; k < scene->patch_count; k++) {
        size_t first, end;
        patch_span(scene, k, &first, &end);
        const long double norm = norm_of(own, (struct view){0}, first, end);
        if (!(norm > 0.0L))
            continue;
        const double difference = (double)(norm_of(image, own, first, end) / norm);
        const double conditioning = (double)conditioning_of(sums, first, end, phase, epsilon);
        const double digits = fmax(log10(difference / conditioning), -9.9);
        if (!(digits <= verdict->digits)) {
            verdict->difference = difference;
            verdict->conditioning = conditioning;
            verdict->digits = digits;
        }
    }
}

/* The same SPEC in double, -1 if it is not in the trial. */
static int double_of(const struct trial *trial, int spec)
{
    for (int k = 0; k < trial->spec_count; k++)
        if (trial->specs[k].algorithm == trial->specs[spec].algorithm
            && strcmp(trial->specs[k].text, trial->specs[spec].text) == 0
            && trial->specs[k].precision == PRECISION_DOUBLE)
            return k;
    return -1;
}

/* Compare with the method's own sum if there is one. Otherwise compare float with double of the same mode, and
   double with itself in the usual mode. */
static void digits_check(const struct trial *trial, int spec, const struct method *method,
                         struct stability_verdict *verdict)
{
    const bool is_float = trial->specs[spec].precision == PRECISION_FLOAT;
    const double epsilon = is_float ? 0x1p-24 : 0x1p-53, phase = phase_rounding(trial->scene) + method->phase_rad;
    const int twin = double_of(trial, spec);
    const bool has_own = method->has_reading && trial->scene->acquisition.compressed;
    for (int mode = 0; mode < trial->mode_count; mode++) {
        const struct view image = {.pixels = trial_image(trial, mode, spec)};
        const struct exact_sum *sums = has_own ? trial->exact + (size_t)spec * trial->pixels : trial->ideal;
        struct view own = {.sums = sums};
        if (!has_own && is_float && (twin < 0 || trial_attempt(trial, mode, twin)->status != STATUS_OK))
            continue;
        if (!has_own)
            own = (struct view){.pixels = trial_image(trial, is_float ? mode : 0, is_float ? twin : spec)};
        if (has_own || !trial->ideal_excludes)
            digits_measure(trial->scene, image, own, sums, phase + method->weight, epsilon, verdict);
    }
}

static void __attribute__((format(printf, 2, 3))) fail(struct stability_verdict *verdict, const char *format, ...)
{
    va_list arguments;
    if (verdict->kind == VERDICT_FAILS)
        return; /* keep the first reason */
    verdict->kind = VERDICT_FAILS;
    va_start(arguments, format);
    vsnprintf(verdict->why, sizeof verdict->why, format, arguments);
    va_end(arguments);
}

/* Faults of an image whatever its error. */
static void flaws_check(struct stability_verdict *verdict)
{
    const struct {
        int flag;
        const char *name;
    } exceptions[] = {{FE_INVALID, "invalid"}, {FE_DIVBYZERO, "division by zero"}, {FE_OVERFLOW, "overflow"}};
    if (!verdict->same_bits)
        fail(verdict, "bits differ between threads");
    for (size_t k = 0; k < sizeof exceptions / sizeof *exceptions; k++)
        if (verdict->exceptions & exceptions[k].flag)
            fail(verdict, "raised %s", exceptions[k].name);
    if (verdict->digits > DIGITS_MOST)
        fail(verdict, "digits");
}

/* The name of the condition in a message: "condition NAME:", "key 'NAME'", a phrase for it, or else the text behind
   the place, unchanged. */
static void name_find(const char *message, char *name, size_t size)
{
    static const struct {
        const char *before, *end;
    } forms[] = {{"condition ", ":"}, {"key '", "'"}, {": ", ":;("}};
    static const struct {
        const char *phrase, *name;
    } phrases[] = {{"leave a phase error", "phase_digits"}, {"a single ping", "pings"}, {"needs r > 0", "r > 0"}};
    for (size_t k = 0; k < sizeof phrases / sizeof *phrases; k++)
        if (strstr(message, phrases[k].phrase)) {
            snprintf(name, size, "%s", phrases[k].name);
            return;
        }
    for (size_t k = 0; k < sizeof forms / sizeof *forms; k++) {
        const char *found = strstr(message, forms[k].before);
        if (found) {
            found += strlen(forms[k].before);
            snprintf(name, size, "%.*s", (int)fmin(strcspn(found, forms[k].end), 60), found);
            return;
        }
    }
    snprintf(name, size, "%.60s", message);
}

/* A verdict before any measurement. */
static struct stability_verdict verdict_empty(enum verdict_kind kind)
{
    return (struct stability_verdict){.kind = kind,
                                      .error = NAN,
                                      .error_most = NAN,
                                      .difference = NAN,
                                      .conditioning = NAN,
                                      .digits = NAN,
                                      .spread = NAN,
                                      .same_bits = true,
                                      .finite = true};
}

struct stability_verdict refusal_verdict(const char *message)
{
    struct stability_verdict verdict = verdict_empty(CANDIDATE_REFUSED);
    snprintf(verdict.message, sizeof verdict.message, "%s", message);
    name_find(message, verdict.why, sizeof verdict.why);
    return verdict;
}

/* Do all modes have the same status? Otherwise record why not; true when there are images. */
static bool statuses_check(const struct trial *trial, int spec, struct stability_verdict *verdict)
{
    const struct attempt *usual = trial_attempt(trial, 0, spec);
    for (int mode = 0; mode < trial->mode_count; mode++) {
        const struct attempt *attempt = trial_attempt(trial, mode, spec);
        if (attempt->status == STATUS_FAILED || attempt->status != usual->status) {
            *verdict = refusal_verdict(attempt->message);
            verdict->finite = !strstr(attempt->message, "finite");
            fail(verdict, "%s, mode %s",
                 attempt->is_stopped                ? "signal"
                 : !verdict->finite                 ? "not finite"
                 : attempt->status == STATUS_FAILED ? "failed"
                                                    : "refused in one mode only",
                 trial_mode_names[mode]);
            return false;
        }
    }
    if (usual->status != STATUS_OK)
        *verdict = refusal_verdict(usual->message);
    return usual->status == STATUS_OK;
}

/* Possible change of the right image by pairs at a record's end, worst patch. */
static double ties_of(const struct trial *trial)
{
    double worst = 0;
    for (int k = 0; k < trial->scene->patch_count && !trial->ideal_excludes; k++) {
        size_t first, end;
        long double sum = 0.0L;
        patch_span(trial->scene, k, &first, &end);
        const long double norm = norm_of((struct view){.sums = trial->ideal}, (struct view){0}, first, end);
        for (size_t i = first; i < end; i++)
            sum += trial->ideal[i].ties * trial->ideal[i].ties;
        worst = fmax(worst, norm > 0.0L ? (double)(sqrtl(sum) / norm) : 0);
    }
    return worst;
}

/* The right image: the closed form's, or reference's without a closed form. */
static struct view ideal_of(const struct trial *trial)
{
    if (!trial->ideal_excludes)
        return (struct view){.sums = trial->ideal};
    for (int k = 0; k < trial->spec_count; k++)
        if (trial->specs[k].precision == PRECISION_DOUBLE && (trial->specs[k].algorithm->traits & TRAIT_EXACT)
            && trial_attempt(trial, 0, k)->status == STATUS_OK)
            return (struct view){.pixels = trial_image(trial, 0, k)};
    return (struct view){0};
}

struct stability_verdict trial_verdict(const struct trial *trial, int spec)
{
    struct stability_verdict verdict;
    if (!statuses_check(trial, spec, &verdict))
        return verdict;
    const struct attempt *usual = trial_attempt(trial, 0, spec);
    const struct problem problem = scene_problem(trial->scene, trial->specs[spec].precision);
    const struct method method = method_of(&trial->specs[spec], usual->engine, &problem);
    const struct view ideal = ideal_of(trial), first = {.pixels = trial_image(trial, 0, spec)};
    verdict = verdict_empty(VERDICT_WORKS);
    verdict.error_most = method.error_most;
    verdict.error = ideal.sums || ideal.pixels ? 0 : NAN;
    verdict.spread = 0;
    snprintf(verdict.engine, sizeof verdict.engine, "%s", usual->engine);
    for (int mode = 0; mode < trial->mode_count; mode++) {
        const struct attempt *attempt = trial_attempt(trial, mode, spec);
        const struct view image = {.pixels = trial_image(trial, mode, spec)};
        verdict.same_bits = verdict.same_bits && attempt->same_bits;
        verdict.exceptions |= attempt->exceptions;
        verdict.spread = worse(verdict.spread, relative(trial->scene, image, first));
        if (ideal.sums || ideal.pixels)
            verdict.error = worse(verdict.error, relative(trial->scene, image, ideal));
    }
    digits_check(trial, spec, &method, &verdict);
    if (method.reading.kind == READING_BAND && verdict.conditioning > 0)
        verdict.error_most += pow(10, DIGITS_MOST) * verdict.conditioning; /* exact methods err by rounding alone */
    flaws_check(&verdict);
    verdict.error_most += ties_of(trial);
    if (verdict.error > fmax(0.5, verdict.error_most))
        fail(&verdict, "error");
    if (verdict.kind == VERDICT_WORKS && verdict.error > verdict.error_most)
        verdict.kind = VERDICT_DEGRADES;
    return verdict;
}

void verdict_text(const struct stability_verdict *verdict, char *text, size_t size)
{
    snprintf(text, size, "%s%s%s", kind_names[verdict->kind], *verdict->why ? ": " : "", verdict->why);
}
