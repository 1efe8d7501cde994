/* The claims of ZP15: zero padding in frequency against nearest neighbour and truncated sinc. */
#include <math.h>

#include "papers/claims.h"
#include "command/task.h"

#define TARGET "zp15/target"
#define MANY "zp15/many" /* 24 targets anywhere between range bins */
#define SPECKLE "zp15/speckle"
#define FULL "lbf21/real_size"

enum { TARGETS = 24 };

static struct finding truncation_distorts_phase(struct measured *m)
{
    double sinc[2] = {MEASURED(m, SPECKLE, SINC_8, phase_rms_rad), MEASURED(m, MANY, SINC_8, phase_rms_rad)};
    double zero[2] = {MEASURED(m, SPECKLE, ZEROPAD_8, phase_rms_rad), MEASURED(m, MANY, ZEROPAD_8, phase_rms_rad)};
    return finding(
        sinc[0] > zero[0] && sinc[1] > zero[1], sinc[0] > zero[0] || sinc[1] > zero[1],
        "rms phase error of sinc of 8 taps and of zero padding by 8: %.2g and %.2g rad in speckle, %.2g and %.2g rad "
        "over 24 lone targets (criterion: sinc's the larger; without another clause: in one of the two)",
        sinc[0], zero[0], sinc[1], zero[1]);
}

/* Sinc's time over zero padding's. */
static double sinc_over_zeropad(struct measured *m, bool plain)
{
    return plain ? table_seconds(m, "lbf21_t5", "BP", PLAIN_SINC) / table_seconds(m, "lbf21_t5", "BP", PLAIN_TIMES)
                 : table_seconds(m, "lbf21_t5", "BP", FAST_SINC) / table_seconds(m, "lbf21_t5", "BP", FAST_TIMES);
}

static struct finding truncation_is_costly(struct measured *m)
{
    double plain = sinc_over_zeropad(m, true), fast = sinc_over_zeropad(m, false);
    return finding(plain > 1 && fast > 1, plain > 1 || fast > 1,
                   "3200 x 4096 pixels, 20 kHz: sinc of 8 taps takes %.2f (plain engine) and %.2f (fast engine) "
                   "times the time of zero padding by 8 (criterion: above 1 by both)",
                   plain, fast);
}

static struct finding padding_interpolates(struct measured *m)
{
    double e8 = MEASURED(m, SPECKLE, ZEROPAD_8, error), e16 = MEASURED(m, SPECKLE, ZEROPAD_16, error);
    double e32 = MEASURED(m, SPECKLE, ZEROPAD_32, error), order = log2(e8 / e32) / 2;
    return finding(order > 0.85 && order < 1.15, false,
                   "error in speckle with factor 8, 16, 32: %.2g, %.2g, %.2g; order %.2f in 1/factor, so that only "
                   "rounding is left (criterion: 0.85 to 1.15)",
                   e8, e16, e32, order);
}

static struct finding truncation_loses_resolution(struct measured *m)
{
    struct spread wider = SPREAD(m, MANY, SINC_8, ZEROPAD_8, "null", width_m, 0, TARGETS);
    double width = SPREAD(m, MANY, ZEROPAD_8, NULL, "null", width_m, 0, TARGETS).median;
    return finding(wider.median >= 0.01 * width, wider.largest >= 0.01 * width,
                   "-3 dB width of sinc of 8 taps less that of zero padding by 8: %.3g to %.3g %% of %.1f mm "
                   "(criterion for a loss: 1 %%)",
                   100 * wider.least / width, 100 * wider.largest / width, 1e3 * width);
}

static struct finding phase_preserving(struct measured *m)
{
    double zero = MEASURED(m, SPECKLE, ZEROPAD_8, phase_rms_rad), sinc = MEASURED(m, SPECKLE, SINC_8, phase_rms_rad);
    double many_zero = MEASURED(m, MANY, ZEROPAD_8, phase_rms_rad),
           many_sinc = MEASURED(m, MANY, SINC_8, phase_rms_rad);
    return finding(
        zero <= sinc / 2 && many_zero <= many_sinc / 2, zero <= sinc / 2,
        "rms phase error of zero padding by 8 against sinc of 8 taps: %.2g against %.2g rad in speckle, %.2g against "
        "%.2g rad over 24 lone targets, whose peaks have no phase error by any method (criterion: at most half; in "
        "speckle at least)",
        zero, sinc, many_zero, many_sinc);
}

static struct finding eighth_of_wavelength(struct measured *m)
{
    struct scene scene;
    if (scene_load(TARGET, SCENE_DIRECTORY, &scene) != STATUS_OK)
        return finding_undecided("%s", status_message());
    const struct acquisition *a = &scene.acquisition;
    double wavelength = a->sound_speed / a->fc, bin = a->sound_speed / (2 * a->fs);
    int factor = 1;
    while (bin / (2 * factor) > wavelength / 8) /* rounding misses by half a fine bin at most */
        factor++;
    scene_free(&scene);
    double phase = MEASURED(m, SPECKLE, ZEROPAD_8, phase_rms_rad);
    return finding(
        factor <= 8 && phase < acos(-1) / 8, factor <= 8,
        "rounding misses the range by at most %.2f mm with factor 8 and lambda/8 is %.2f mm, so the rule asks for "
        "%d; rms phase error left in speckle %.2g rad (criterion: below pi/8)",
        1e3 * bin / 16, 1e3 * wavelength / 8, factor, phase);
}

static struct finding padding_costs_little(struct measured *m)
{
    double plain = measured_stage(m, "lbf21/real_size_rows", ZEROPAD_8 "," PLAIN_BP, "compress")
                   / table_seconds(m, "lbf21_t5", "BP", PLAIN_TIMES);
    double fast = measured_stage(m, FULL, ZEROPAD_8, "compress") / table_seconds(m, "lbf21_t5", "BP", FAST_TIMES);
    return finding(plain <= 0.1 && fast <= 0.1, plain <= 0.1 || fast <= 0.1,
                   "compression and zero padding by 8 together take %.2g %% (plain engine) and %.2g %% (fast engine) "
                   "of the time at 3200 x 4096 pixels (criterion: a tenth)",
                   100 * plain, 100 * fast);
}

static struct finding better_than_nearest(struct measured *m)
{
    struct spread gain = SPREAD(m, MANY, NEAREST, ZEROPAD_8, "null", islr_db, 0, TARGETS);
    double nearest = MEASURED(m, TARGET, NEAREST, error), zero = MEASURED(m, TARGET, ZEROPAD_8, error);
    return finding(
        gain.least > 0 && zero < nearest, gain.median > 0,
        "ISLR of nearest above that of zero padding by 8: %.2f to %.2f dB over 24 targets; error at the paper's "
        "target %.3f against %.3f (criterion: better at each)",
        gain.least, gain.largest, nearest, zero);
}

static struct finding better_than_sinc(struct measured *m)
{
    static const char *const scenes[] = {TARGET, SPECKLE, MANY};
    double zero[3], sinc[3];
    int better = 0;
    for (int k = 0; k < 3; k++) {
        zero[k] = MEASURED(m, scenes[k], ZEROPAD_8, error);
        sinc[k] = MEASURED(m, scenes[k], SINC_8, error);
        better += zero[k] < sinc[k];
    }
    return finding(better == 3, zero[0] < sinc[0] || zero[1] < sinc[1],
                   "error of zero padding by 8 against sinc of 8 taps: %.3f against %.3f around the paper's target, "
                   "%.3f against %.3f in speckle, %.3f against %.3f close to 24 targets (criterion: smaller; in all "
                   "three, or in speckle or the paper's case)",
                   zero[0], sinc[0], zero[1], sinc[1], zero[2], sinc[2]);
}

static struct finding slices_differ(struct measured *m)
{
    struct spread sinc = SPREAD(m, MANY, SINC_8, ZEROPAD_8, "null", islr_db, 0, TARGETS);
    return finding(sinc.least > 0, sinc.median >= 0.01,
                   "ISLR of sinc of 8 taps less that of zero padding by 8: %.3f to %.3f dB (median %.3f) over 24 "
                   "targets (criterion: zero padding is lower at each, else by 0.01 dB in the median)",
                   sinc.least, sinc.largest, sinc.median);
}

static struct finding lake_trial(struct measured *m)
{
    return finding_undecided(
        "the recorded data of the lake trial are not available; errors in simulated speckle: %.3f (nearest), %.3f "
        "(sinc of 8 taps), %.3f (zero padding by 8)",
        MEASURED(m, SPECKLE, NEAREST, error), MEASURED(m, SPECKLE, SINC_8, error),
        MEASURED(m, SPECKLE, ZEROPAD_8, error));
}

static struct finding accurate_and_efficient(struct measured *m)
{
    double zero = MEASURED(m, SPECKLE, ZEROPAD_8, error), sinc = MEASURED(m, SPECKLE, SINC_8, error);
    double plain = sinc_over_zeropad(m, true), fast = sinc_over_zeropad(m, false);
    return finding(zero < sinc && plain > 1 && fast > 1, zero < sinc && (plain > 1 || fast > 1),
                   "against sinc of 8 taps, zero padding by 8 has an error of %.3f instead of %.3f in speckle and is "
                   "%.2f (plain engine) and %.2f (fast engine) times as fast (criterion: better in both)",
                   zero, sinc, plain, fast);
}

const struct claim claims_zp15[] = {
    {"zp15-abstract-1", "ZP15", "abstract", "truncated interpolation distorts the phase", truncation_distorts_phase},
    {"zp15-abstract-2", "ZP15", "abstract", "truncated interpolation is costly; zero padding is more efficient",
     truncation_is_costly},
    {"zp15-abstract-3", "ZP15", "abstract", "zero padding in frequency is interpolation in time",
     padding_interpolates},
    {"zp15-1-1", "ZP15", "introduction", "truncated interpolation loses resolution over the whole image",
     truncation_loses_resolution},
    {"zp15-1-2", "ZP15", "introduction", "zero padding preserves phase, unlike truncated interpolation",
     phase_preserving},
    {"zp15-1-3", "ZP15", "introduction", "a range error within lambda/8 is reached by zero padding",
     eighth_of_wavelength},
    {"zp15-3-1", "ZP15", "back projection", "the longer data do not add significantly to the load",
     padding_costs_little},
    {"zp15-4-1", "ZP15", "results, Figs 3-4", "zero padding focuses better than no interpolation",
     better_than_nearest},
    {"zp15-4-2", "ZP15", "results, Figs 3-4", "zero padding images better than truncated interpolation",
     better_than_sinc},
    {"zp15-4-3", "ZP15", "results, Fig. 4", "its azimuth slice is better than that of truncated interpolation",
     slices_differ},
    {"zp15-4-4", "ZP15", "results, Fig. 6", "on lake-trial data zero padding focuses more finely", lake_trial},
    {"zp15-5-1", "ZP15", "conclusion", "the method is both accurate and efficient", accurate_and_efficient},
    {.id = NULL},
};
