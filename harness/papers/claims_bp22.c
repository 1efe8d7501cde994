/* The claims of BP22 (two interpolators): linear upsampling against nearest neighbour and sinc. */
#include <math.h>
#include <stdio.h>

#include "papers/claims.h"
#include "command/task.h"

#define TABLE_3 "bp22/table3" /* six targets on range bins */
#define MANY "bp22/many"      /* targets 0 to 23 on range bins, 24 to 47 between them */
#define SPECKLE "bp22/speckle"

/* Printed values are rounded to .01 dB, so a difference of two is good to .01 dB. */
static const double ROUNDING_DB = 0.01;
/* Table 4: what "the same time" means there. */
static const double SAME_TIME = 7420.0 / 7156;

enum { ON_BINS = 0, BETWEEN_BINS = 24, EACH = 24, ALL = 48, SIX = 6 };

static struct spread islr_loss(struct measured *m, const char *spec, int first, int count)
{
    return SPREAD(m, MANY, spec, SINC_8, "pixel", islr_db, first, count);
}

/* Times of Table 4 over nearest neighbour's. */
static double time_ratio(struct measured *m, const char *method, const char *base, const char *definition)
{
    return table_seconds(m, "bp22_t4", method, definition) / table_seconds(m, "bp22_t4", base, definition);
}

static struct finding bp_is_slow(struct measured *m)
{
    double seconds =
        table_seconds(m, "lbf21_t5", "BP", FAST_TIMES) / table_seconds(m, "lbf21_t5", "LBF, 16 blocks", FAST_TIMES);
    double flops = MEASURED(m, "lbf21/real_size", ZEROPAD_8, flops) / MEASURED(m, "lbf21/real_size", LBF_16, flops);
    return finding(
        seconds > 1 && flops > 1, seconds > 1 || flops > 1,
        "3200 x 4096 pixels: back projection takes %.2f times the time of range migration with 16 blocks, and %.2f "
        "times its counted FLOPs (criterion: both above 1)",
        seconds, flops);
}

static struct finding improves_on_nearest(struct measured *m)
{
    struct spread nearest = islr_loss(m, NEAREST, 0, ALL), two = islr_loss(m, LINEAR_2, 0, ALL);
    struct spread eight = islr_loss(m, LINEAR_8, 0, ALL);
    double error[3] = {MEASURED(m, SPECKLE, NEAREST, error), MEASURED(m, SPECKLE, LINEAR_2, error),
                       MEASURED(m, SPECKLE, LINEAR_8, error)};
    bool islr = two.median < nearest.median && eight.median < nearest.median;
    bool errors = error[1] < error[0] && error[2] < error[0];
    return finding(
        islr && errors, islr || errors,
        "median ISLR above sinc's over 48 targets: nearest %.2f, beta 2 %.2f, beta 8 %.2f dB; error in speckle %.3f, "
        "%.3f, %.3f",
        nearest.median, two.median, eight.median, error[0], error[1], error[2]);
}

static struct finding no_loss_of_efficiency(struct measured *m)
{
    double plain[2] = {time_ratio(m, "linear, beta 2", "nearest", PLAIN_TIMES),
                       time_ratio(m, "linear, beta 8", "nearest", PLAIN_TIMES)};
    double fast[2] = {time_ratio(m, "linear, beta 2", "nearest", FAST_TIMES),
                      time_ratio(m, "linear, beta 8", "nearest", FAST_TIMES)};
    return finding(
        fmax(plain[0], plain[1]) <= SAME_TIME, fmax(fast[0], fast[1]) <= SAME_TIME,
        "time over nearest's, beta 2 and 8: plain engine %.3f and %.3f, fast engine %.3f and %.3f; Table 4 calls up "
        "to %.3f no loss",
        plain[0], plain[1], fast[0], fast[1], SAME_TIME);
}

static struct finding faster_than_sinc(struct measured *m)
{
    double plain = time_ratio(m, "sinc", "linear, beta 8", PLAIN_TIMES),
           fast = time_ratio(m, "sinc", "linear, beta 8", FAST_TIMES);
    return finding(plain > 1 && fast > 1, plain > 1 || fast > 1,
                   "time of sinc over that of beta 8: plain engine %.2f, fast engine %.2f (criterion: both above 1)",
                   plain, fast);
}

static struct finding no_loss_of_performance(struct measured *m)
{
    double linear = MEASURED(m, SPECKLE, LINEAR_8, error), sinc = MEASURED(m, SPECKLE, SINC_8, error);
    struct spread loss = islr_loss(m, LINEAR_8, 0, ALL);
    return finding(
        linear <= sinc, loss.median <= 0.07 + ROUNDING_DB,
        "beta 8 against sinc of 8 taps: error in speckle %.3f against %.3f; only if ISLR is all that counts is "
        "nothing lost: median %.2f dB (Table 3: at most 0.07)",
        linear, sinc, loss.median);
}

static struct finding flops_add_up(struct measured *m)
{
    static const struct {
        const char *method, *spec;
    } rows[] = {{"nearest", NEAREST}, {"linear, beta 2", LINEAR_2}, {"linear, beta 8", LINEAR_8}, {"sinc", SINC_8}};
    double largest = 0;
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++)
        largest = fmax(largest, fabs(MEASURED(m, "bp22/full", rows[k].spec, flops_published)
                                         / published_value(m, "bp22_t1", "", rows[k].method, "flops")
                                     - 1));
    return finding(largest < 1e-4, false,
                   "the plans' sums over Table 1's operations differ from Eq. (11) by at most %.1g", largest);
}

static struct finding interpolation_is_cheap(struct measured *m)
{
    double printed =
        MEASURED(m, "bp22/full", LINEAR_8, flops_published) / MEASURED(m, "bp22/full", NEAREST, flops_published) - 1;
    double counted = MEASURED(m, "bp22/full", LINEAR_8, flops) / MEASURED(m, "bp22/full", NEAREST, flops) - 1;
    return finding(printed <= 0.1 && counted <= 0.1, printed <= 0.1,
                   "beta 8 adds %.2g %% to nearest's FLOPs by Eq. (11), where all samples are upsampled once; "
                   "reading two taps a pair, as our plans do, adds %.0f %% (criterion: a tenth, as the paper reads "
                   "<< )",
                   100 * printed, 100 * counted);
}

static struct finding rate_two_suffices(struct measured *m)
{
    struct scene scene;
    if (scene_load(TABLE_3, SCENE_DIRECTORY, &scene) != STATUS_OK)
        return finding_undecided("%s", status_message());
    double bin = scene.acquisition.sound_speed / (2 * scene.acquisition.fs);
    double wavelength = scene.acquisition.sound_speed / scene.acquisition.fc,
           nominal = scene.acquisition.tx_length / 2;
    scene_free(&scene);
    double width = MEASURED(m, TABLE_3, SINC_8, width_m);
    int strict = upsampling_rate(bin, nominal, wavelength);
    int wide = isfinite(width) ? upsampling_rate(bin, width, wavelength) : 0;
    return finding(
        strict == 2, wide == 2,
        "with the resolution D/2 = %.3g m, 2 b/(2 + 1) = %.5f m is not below %.5f m and beta must be %d; with the -3 "
        "dB width of the images, %.4f m, it must be %d",
        nominal, 2 * bin / 3, nominal * nominal / (10 * wavelength), strict, width, wide);
}

static struct finding nearest_has_sidelobes(struct measured *m)
{
    struct spread on = islr_loss(m, NEAREST, ON_BINS, EACH), off = islr_loss(m, NEAREST, BETWEEN_BINS, EACH);
    return finding(
        on.least > 0 && off.least > 0, on.least > 0 || (on.median > 0 && off.median > 0),
        "ISLR above sinc's: %.2f to %.2f dB (median %.2f) on range bins, %.2f to %.2f dB (median %.2f) between them "
        "(criterion: worse at all of 48 targets)",
        on.least, on.largest, on.median, off.least, off.largest, off.median);
}

static struct finding both_rates_improve(struct measured *m)
{
    struct spread nearest = islr_loss(m, NEAREST, 0, ALL), two = islr_loss(m, LINEAR_2, 0, ALL);
    struct spread eight = islr_loss(m, LINEAR_8, 0, ALL);
    return finding(
        two.median <= nearest.median / 2 && eight.median <= nearest.median / 2,
        two.median < nearest.median && eight.median < nearest.median,
        "median ISLR above sinc's: nearest %.2f, beta 2 %.2f, beta 8 %.2f dB (criterion for highly: at most half)",
        nearest.median, two.median, eight.median);
}

static struct finding eight_improves_slightly(struct measured *m)
{
    struct spread nearest = islr_loss(m, NEAREST, 0, ALL), two = islr_loss(m, LINEAR_2, 0, ALL);
    struct spread eight = islr_loss(m, LINEAR_8, 0, ALL);
    double first = nearest.median - two.median, second = two.median - eight.median;
    return finding(
        second > 0 && second < first, false,
        "median ISLR falls by %.3f dB from beta 2 to 8 and by %.3f dB from nearest to beta 2 (criterion: an "
        "improvement, and the smaller one)",
        second, first);
}

static struct finding low_rate_shows(struct measured *m)
{
    struct spread one = islr_loss(m, LINEAR_1, 0, ALL), two = islr_loss(m, LINEAR_2, 0, ALL);
    return finding(one.median > two.median + ROUNDING_DB, false,
                   "median ISLR above sinc's: beta 1 %.3f, beta 2 %.3f dB (criterion: more by the printed digit)",
                   one.median, two.median);
}

static struct finding two_not_noticeable(struct measured *m)
{
    struct spread on = islr_loss(m, LINEAR_2, ON_BINS, EACH), off = islr_loss(m, LINEAR_2, BETWEEN_BINS, EACH);
    return finding(
        fmax(on.median, off.median) <= 0.19 + ROUNDING_DB, on.median <= 0.19 + ROUNDING_DB,
        "median ISLR above sinc's: %.2f dB on range bins, %.2f dB between them (criterion: Table 3's 0.19 dB)",
        on.median, off.median);
}

/* Over nearest, beta 2 and beta 8. */
static struct spread largest_of_methods(struct measured *m, const char *definition, size_t offset, const char *name,
                                        int first, int count, double *relative_to)
{
    static const char *const specs[] = {NEAREST, LINEAR_2, LINEAR_8};
    struct spread all = {NAN, NAN, NAN};
    for (int k = 0; k < 3; k++) {
        struct spread one = spread_of(m, MANY, specs[k], SINC_8, definition, offset, name, first, count);
        all = (struct spread){fmin(all.least, one.least), one.median, fmax(all.largest, one.largest)};
    }
    if (relative_to)
        *relative_to = spread_of(m, MANY, SINC_8, NULL, definition, offset, name, first, count).median;
    return all;
}

static struct finding pslr_same(struct measured *m)
{
    size_t offset = offsetof(struct target_row, pslr_db);
    double on = spread_magnitude(largest_of_methods(m, "pixel", offset, "pslr_db", ON_BINS, EACH, NULL));
    double off = spread_magnitude(largest_of_methods(m, "pixel", offset, "pslr_db", BETWEEN_BINS, EACH, NULL));
    return finding(
        fmax(on, off) <= 0.14 + ROUNDING_DB, on <= 0.14 + ROUNDING_DB,
        "largest difference of PSLR from sinc's over three methods: %.2f dB on range bins, %.2f dB between them "
        "(criterion: Table 3's largest, 0.14 dB)",
        on, off);
}

static struct finding resolution_same(struct measured *m)
{
    size_t offset = offsetof(struct target_row, width_m);
    double width,
        largest = spread_magnitude(largest_of_methods(m, "null", offset, "width_m", 0, ALL, &width)) / width;
    return finding(largest <= 0.01, false,
                   "-3 dB widths of three methods differ from sinc's by at most %.2g %% of %.1f mm over 48 targets "
                   "(criterion: 1 %%)",
                   100 * largest, 1e3 * width);
}

static struct finding nearest_pslr(struct measured *m)
{
    struct spread six = SPREAD(m, TABLE_3, NEAREST, SINC_8, "pixel", pslr_db, 0, SIX);
    struct spread fine = SPREAD(m, TABLE_3, NEAREST, SINC_8, "null", pslr_db, 0, SIX);
    return finding(
        spread_magnitude(six) <= 0.14 + ROUNDING_DB, fabs(six.median) <= 0.14 + ROUNDING_DB,
        "PSLR of nearest less sinc's at six targets: %.2f to %.2f dB (median %.2f) by pixel, %.2f to %.2f dB by null "
        "(criterion: Table 3's largest, 0.14 dB)",
        six.least, six.largest, six.median, fine.least, fine.largest);
}

/* "The largest difference is `printed`": exactly at the six targets, or among those of many targets on range bins. */
static struct finding islr_difference(struct measured *m, const char *spec, double printed)
{
    struct spread six = SPREAD(m, TABLE_3, spec, SINC_8, "pixel", islr_db, 0, SIX);
    struct spread on = islr_loss(m, spec, ON_BINS, EACH), off = islr_loss(m, spec, BETWEEN_BINS, EACH);
    bool within = printed >= on.least - ROUNDING_DB && printed <= on.largest + ROUNDING_DB;
    return finding(fabs(six.largest - printed) <= ROUNDING_DB, within,
                   "ISLR above sinc's: largest of six %.2f dB; 24 targets on range bins %.2f to %.2f dB; 24 between "
                   "them %.2f to %.2f dB; the paper says %.2f (else: it lies among those on range bins)",
                   six.largest, on.least, on.largest, off.least, off.largest, printed);
}

static struct finding nearest_islr(struct measured *m)
{
    return islr_difference(m, NEAREST, 0.59);
}

/* "Within `printed` dB of sinc": at all targets, or at those that lie on range bins. */
static struct finding islr_within(struct measured *m, const char *spec, double printed)
{
    struct spread six = SPREAD(m, TABLE_3, spec, SINC_8, "pixel", islr_db, 0, SIX);
    struct spread on = islr_loss(m, spec, ON_BINS, EACH), off = islr_loss(m, spec, BETWEEN_BINS, EACH);
    return finding(
        spread_magnitude(spread_join(on, off)) <= printed + ROUNDING_DB,
        spread_magnitude(six) <= printed + ROUNDING_DB || spread_magnitude(on) <= printed + ROUNDING_DB,
        "ISLR less sinc's: six targets as in Table 3 %.2f to %.2f dB; 24 on range bins %.2f to %.2f dB (median "
        "%.2f); 24 between them %.2f to %.2f dB (median %.2f); bound %.2f dB (at all; else at the six or on range "
        "bins)",
        six.least, six.largest, on.least, on.largest, on.median, off.least, off.largest, off.median, printed);
}

static struct finding two_islr(struct measured *m)
{
    return islr_within(m, LINEAR_2, 0.19);
}

static struct finding eight_islr(struct measured *m)
{
    return islr_within(m, LINEAR_8, 0.07);
}

static struct finding eight_beats_two(struct measured *m)
{
    struct spread six = SPREAD(m, TABLE_3, LINEAR_8, LINEAR_2, "pixel", islr_db, 0, SIX);
    struct spread all = SPREAD(m, MANY, LINEAR_8, LINEAR_2, "pixel", islr_db, 0, ALL);
    return finding(
        six.largest < 0 && all.largest < 0, all.median < 0,
        "ISLR of beta 8 less that of beta 2: %.2f to %.2f dB at six targets, %.2f to %.2f dB at 48 (median %.3f; "
        "criterion: lower at each, else lower in the median)",
        six.least, six.largest, all.least, all.largest, all.median);
}

static struct finding recorded_data(struct measured *m)
{
    return finding_undecided(
        "the paper's recorded data are not available; in simulated speckle the errors are %.3f (nearest), %.3f (beta "
        "2), %.3f (beta 8) and %.3f (sinc)",
        MEASURED(m, SPECKLE, NEAREST, error), MEASURED(m, SPECKLE, LINEAR_2, error),
        MEASURED(m, SPECKLE, LINEAR_8, error), MEASURED(m, SPECKLE, SINC_8, error));
}

static struct finding two_phase_error(struct measured *m)
{
    double two = MEASURED(m, SPECKLE, LINEAR_2, phase_rms_rad), eight = MEASURED(m, SPECKLE, LINEAR_8, phase_rms_rad);
    return finding(two >= 2 * eight, false,
                   "rms phase error in speckle: beta 2 %.3f rad, beta 8 %.3f rad, a factor of %.2f (criterion for "
                   "much larger: 2)",
                   two, eight, two / eight);
}

static struct finding nearest_insas(struct measured *m)
{
    return finding_undecided(
        "no interferometric data and no criterion are given; rms phase error in speckle: nearest %.3f rad, sinc %.3f "
        "rad",
        MEASURED(m, SPECKLE, NEAREST, phase_rms_rad), MEASURED(m, SPECKLE, SINC_8, phase_rms_rad));
}

static struct finding times_faster(struct measured *m)
{
    double plain = time_ratio(m, "sinc", "linear, beta 8", PLAIN_TIMES),
           fast = time_ratio(m, "sinc", "linear, beta 8", FAST_TIMES);
    double limited = time_ratio(m, "sinc", "linear, beta 8", FAST_LIMITED);
    double flops =
        MEASURED(m, "bp22/full", SINC_8, flops_published) / MEASURED(m, "bp22/full", LINEAR_8, flops_published);
    return finding(plain >= 4.215, fast >= 4.215,
                   "time of sinc over that of beta 8: plain engine %.2f, fast engine %.2f, fast with limited "
                   "aperture %.2f; by the paper's FLOPs %.2f; the paper says 4.22",
                   plain, fast, limited, flops);
}

static struct finding multiplication_dominates(struct measured *m)
{
    double plain = measured_stage(m, "bp22/full_rows", LINEAR_8 "," PLAIN_BP, "compress");
    double whole = table_seconds(m, "bp22_t4", "linear, beta 8", PLAIN_TIMES);
    double compress = measured_stage(m, "bp22/full", LINEAR_8, "compress"),
           fast = table_seconds(m, "bp22_t4", "linear, beta 8", FAST_TIMES);
    double share = 1 - plain / whole, fast_share = 1 - compress / fast;
    return finding(
        share >= 0.9 && fast_share >= 0.9, share >= 0.9 || fast_share >= 0.9,
        "all but pulse compression takes %.1f %% of the time with beta 8 by the plain engine and %.1f %% by the fast "
        "one (criterion: nine tenths)",
        100 * share, 100 * fast_share);
}

static struct finding times_equal(struct measured *m)
{
    double ratio[2];
    const char *const definitions[] = {PLAIN_TIMES, FAST_TIMES};
    for (int k = 0; k < 2; k++) {
        double two = time_ratio(m, "linear, beta 2", "nearest", definitions[k]);
        double eight = time_ratio(m, "linear, beta 8", "nearest", definitions[k]);
        ratio[k] = fmax(1, fmax(two, eight)) / fmin(1, fmin(two, eight));
    }
    return finding(
        ratio[0] <= SAME_TIME, ratio[1] <= SAME_TIME,
        "slowest over fastest of nearest, beta 2 and beta 8: plain engine %.3f, fast engine %.3f; Table 4: %.3f",
        ratio[0], ratio[1], SAME_TIME);
}

static struct finding flops_explain_times(struct measured *m)
{
    double flops =
        MEASURED(m, "bp22/full", SINC_8, flops_published) / MEASURED(m, "bp22/full", LINEAR_8, flops_published);
    double printed = published_value(m, "bp22_t4", "", "sinc", "time_s")
                     / published_value(m, "bp22_t4", "", "linear, beta 8", "time_s");
    double plain = time_ratio(m, "sinc", "linear, beta 8", PLAIN_TIMES);
    return finding(
        fabs(flops / printed - 1) <= 0.1, fabs(flops / plain - 1) <= 0.1,
        "sinc over beta 8: %.2f by the paper's FLOPs, %.2f by its times, %.2f by our plain engine (criterion: within "
        "a tenth)",
        flops, printed, plain);
}

/* Eq. (17): the phase error that the paper itself tolerates. */
static struct finding nearest_phase(struct measured *m)
{
    double nearest = MEASURED(m, SPECKLE, NEAREST, phase_rms_rad), limit = acos(-1) / 8;
    return finding(nearest > limit, false,
                   "rms phase error of nearest in speckle %.3f rad; the paper tolerates pi/8 = %.3f rad (Eq. (17))",
                   nearest, limit);
}

static struct finding errors_fall(struct measured *m)
{
    static const char *const scenes[] = {SPECKLE, MANY};
    double error[2][3];
    bool falls[2];
    for (int k = 0; k < 2; k++) {
        error[k][0] = MEASURED(m, scenes[k], NEAREST, error);
        error[k][1] = MEASURED(m, scenes[k], LINEAR_2, error);
        error[k][2] = MEASURED(m, scenes[k], LINEAR_8, error);
        falls[k] = error[k][1] < error[k][0] && error[k][2] < error[k][0];
    }
    return finding(falls[0] && falls[1], falls[0] || falls[1],
                   "error of nearest, beta 2, beta 8: %.3f, %.3f, %.3f in speckle; %.3f, %.3f, %.3f over 48 targets",
                   error[0][0], error[0][1], error[0][2], error[1][0], error[1][1], error[1][2]);
}

static struct finding load_not_increased(struct measured *m)
{
    double printed =
        MEASURED(m, "bp22/full", LINEAR_8, flops_published) / MEASURED(m, "bp22/full", NEAREST, flops_published) - 1;
    return finding(printed <= 0, printed < 0.01,
                   "Eq. (11) grows by %.2g %% from nearest to beta 8; that is none only if less than 1 %% counts as "
                   "none",
                   100 * printed);
}

static struct finding efficiency_lowered(struct measured *m)
{
    double plain = time_ratio(m, "linear, beta 8", "sinc", PLAIN_TIMES),
           fast = time_ratio(m, "linear, beta 8", "sinc", FAST_TIMES);
    return finding(plain > 1 && fast > 1, false,
                   "beta 8 takes %.2f (plain engine) and %.2f (fast engine) of sinc's time: it is faster, as the "
                   "paper's own Table 4 says; the sentence says the opposite",
                   plain, fast);
}

static struct finding real_time(struct measured *m)
{
    struct scene scene;
    struct straight_track track = {0};
    if (scene_load("bp22/full", SCENE_DIRECTORY, &scene) != STATUS_OK)
        return finding_undecided("%s", status_message());
    acquisition_is_straight(&scene.acquisition, &track);
    double recording = scene.acquisition.pings * track.spacing / track.speed;
    scene_free(&scene);
    double fast = table_seconds(m, "bp22_t4", "linear, beta 8", FAST_TIMES),
           plain = table_seconds(m, "bp22_t4", "linear, beta 8", PLAIN_TIMES);
    return finding(plain < recording, fast < recording,
                   "an image of %.1f s of pings takes %.1f s by the plain engine and, on this machine, %.1f s by the "
                   "fast one",
                   recording, plain, fast);
}

const struct claim claims_bp22[] = {
    {"bp22-abstract-1", "BP22", "abstract", "back projection costs much more than Fourier-domain methods",
     bp_is_slow},
    {"bp22-abstract-2", "BP22", "abstract", "linear upsampling images better than nearest neighbour",
     improves_on_nearest},
    {"bp22-abstract-3", "BP22", "abstract", "it does so without loss of efficiency", no_loss_of_efficiency},
    {"bp22-abstract-4", "BP22", "abstract", "it is more efficient than traditional back projection (sinc)",
     faster_than_sinc},
    {"bp22-abstract-5", "BP22", "abstract", "it loses no performance against traditional back projection",
     no_loss_of_performance},
    {"bp22-3.2-1", "BP22", "3.2", "the operations of Table 1 add up to Eq. (11)", flops_add_up},
    {"bp22-3.3-1", "BP22", "3.3, 4.1", "beta = 2 is the smallest rate that satisfies Eq. (20)", rate_two_suffices},
    {"bp22-4.1-1", "BP22", "4.1", "nearest neighbour leaves high azimuth sidelobes", nearest_has_sidelobes},
    {"bp22-4.1-2", "BP22", "4.1", "both upsampling rates, 2 and 8, improve the image highly", both_rates_improve},
    {"bp22-4.1-3", "BP22", "4.1", "beta = 8 improves on beta = 2 slightly", eight_improves_slightly},
    {"bp22-4.1-4", "BP22", "4.1", "sidelobes stay noticeable when the upsampling rate is too low", low_rate_shows},
    {"bp22-4.1-5", "BP22", "4.1", "with beta = 2 the image is not noticeably affected", two_not_noticeable},
    {"bp22-4.1-6", "BP22", "4.1", "all methods have almost the same PSLR", pslr_same},
    {"bp22-4.1-7", "BP22", "4.1", "all methods have almost the same azimuth resolution", resolution_same},
    {"bp22-4.1-8", "BP22", "4.1", "PSLR of nearest neighbour and of sinc are mostly identical", nearest_pslr},
    {"bp22-4.1-9", "BP22", "4.1", "ISLR of nearest neighbour differs from sinc's by up to 0.59 dB", nearest_islr},
    {"bp22-4.1-10", "BP22", "4.1", "beta = 2 is within 0.19 dB ISLR of sinc", two_islr},
    {"bp22-4.1-11", "BP22", "4.1", "beta = 8 is within 0.07 dB ISLR of sinc", eight_islr},
    {"bp22-4.1-12", "BP22", "4.1", "ISLR of beta = 8 is better than that of beta = 2 at each target",
     eight_beats_two},
    {"bp22-4.2-1", "BP22", "4.2", "on recorded data both rates give images that hardly differ from sinc's",
     recorded_data},
    {"bp22-4.2-2", "BP22", "4.2", "the phase error of beta = 2 is much larger than that of beta = 8",
     two_phase_error},
    {"bp22-4.2-3", "BP22", "4.2", "the error of nearest neighbour seriously disturbs interferometry", nearest_insas},
    {"bp22-4.2-4", "BP22", "4.2",
     "on recorded data the slice of nearest neighbour deviates, those of beta = 2 and 8 agree with sinc's",
     recorded_data},
    {"bp22-4.2-5", "BP22", "4.2", "the method is 4.22 times faster than traditional back projection", times_faster},
    {"bp22-4.2-6", "BP22", "4.2", "only the complex multiplications take time", multiplication_dominates},
    {"bp22-4.2-7", "BP22", "4.2", "linear interpolation costs far less than the multiplications",
     interpolation_is_cheap},
    {"bp22-4.2-8", "BP22", "4.2", "nearest, beta = 2 and beta = 8 take almost the same time", times_equal},
    {"bp22-4.2-9", "BP22", "4.2", "the FLOPs of sinc interpolation explain its time", flops_explain_times},
    {"bp22-5-1", "BP22", "5", "nearest neighbour without upsampling leads to a large phase error", nearest_phase},
    {"bp22-5-2", "BP22", "5", "two interpolations lower the interpolation error and improve the image", errors_fall},
    {"bp22-5-3", "BP22", "5", "the computation load is not increased", load_not_increased},
    {"bp22-5-4", "BP22", "5", "efficiency is lowered in comparison with traditional back projection",
     efficiency_lowered},
    {"bp22-5-5", "BP22", "5", "the method has the potential for real-time imaging", real_time},
    {.id = NULL},
};
