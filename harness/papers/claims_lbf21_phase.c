/* The claims of LBF21 on phase errors: the spectra of LBF and PCA against the exact one (its Figs 2 to 9). */
#include <math.h>

#include "papers/claims.h"

static double phase(struct measured *m, enum phase_setup setup, bool last, const char *formula, double least_m,
                    double most_m, double share)
{
    return measured_phase(m, &(struct phase_part){setup, last, formula, least_m, most_m, share});
}

static double phase_all(struct measured *m, enum phase_setup setup, bool last, const char *formula)
{
    return phase(m, setup, last, formula, 50, 300, 1);
}

/* At the four ranges of the figures. */
static void phase_by_range(struct measured *m, enum phase_setup setup, bool last, const char *formula,
                           double values[4])
{
    static const double ranges_m[] = {50, 135, 220, 300};
    for (int k = 0; k < 4; k++)
        values[k] = phase(m, setup, last, formula, ranges_m[k], ranges_m[k], 1);
}

static bool rises(const double *values, int first)
{
    bool rises = true;
    for (int k = first; k < 3; k++)
        rises = rises && values[k + 1] > values[k];
    return rises;
}

static bool falls(const double *values, int first)
{
    bool falls = true;
    for (int k = first; k < 3; k++)
        falls = falls && values[k + 1] < values[k];
    return falls;
}

static struct finding pca_about_one(struct measured *m)
{
    double first = phase_all(m, PHASE_LONG, false, "pca"), last = phase_all(m, PHASE_LONG, true, "pca");
    double largest = fmax(first, last);
    return finding(largest >= 0.95 && largest < 1.05, largest >= 0.5 && largest < 1.5,
                   "largest phase error of PCA, long integration, 50 to 300 m: %.3f rad (first receiver), %.3f rad "
                   "(last); holds if it rounds to 1.0, under rounding to whole numbers if to 1",
                   first, last);
}

static struct finding lbf_below_quarter_pi(struct measured *m)
{
    double printed = 0, seven = 0;
    for (int k = 0; k < 4; k++) {
        printed = fmax(printed, phase_all(m, (enum phase_setup)(k / 2), k % 2, "lbf_fc"));
        seven = fmax(seven, phase_all(m, (enum phase_setup)(k / 2), k % 2, "lbf7_fc"));
    }
    double limit = acos(-1) / 4;
    return finding(printed < limit && seven < limit, printed < limit,
                   "largest phase error of LBF over both set-ups: %.3f rad by Eq. (5), %.3f rad by Eq. (7), which "
                   "its figures show; pi/4 = %.3f rad",
                   printed, seven, limit);
}

static struct finding lbf_more_accurate(struct measured *m)
{
    double lbf[4], pca[4];
    int printed = 0, seven = 0;
    for (int k = 0; k < 4; k++) {
        pca[k] = phase_all(m, (enum phase_setup)(k / 2), k % 2, "pca");
        lbf[k] = phase_all(m, (enum phase_setup)(k / 2), k % 2, "lbf_fc");
        printed += lbf[k] < pca[k];
        seven += phase_all(m, (enum phase_setup)(k / 2), k % 2, "lbf7_fc") < pca[k];
    }
    return finding(
        printed == 4 && seven == 4, printed == 4,
        "largest phase error, LBF by Eq. (5) against PCA: %.3f/%.3f, %.3f/%.3f rad (short, first and last receiver), "
        "%.3f/%.3f, %.3f/%.3f rad (long); smaller in %d of 4 by Eq. (5), in %d by Eq. (7)",
        lbf[0], pca[0], lbf[1], pca[1], lbf[2], pca[2], lbf[3], pca[3], printed, seven);
}

/* At the Doppler centroid cos theta = 1, and with the bistatic term's S^3/F^2 replaced by F the formulas are one. */
static struct finding lbf_reduces_to_pca(struct measured *m)
{
    double largest = 0, seven = 0, pca = 0;
    for (int k = 0; k < 4; k++) {
        seven = phase(m, (enum phase_setup)(k / 2), k % 2, "lbf7_fc", 50, 300, 0);
        pca = phase(m, (enum phase_setup)(k / 2), k % 2, "pca", 50, 300, 0);
        largest = fmax(largest, fabs(seven - pca));
    }
    return finding(largest < 1e-4, false,
                   "where cos theta = 1 (f = 0), phase errors of Eq. (7) and PCA differ by at most %.2g rad in both "
                   "set-ups (criterion: 1e-4 rad)",
                   largest);
}

/* "LBF errs by ... at most": by both of its formulas, else by one of them, in [low_rad, high_rad). */
static struct finding largest_within(struct measured *m, enum phase_setup setup, bool last, double least_m,
                                     double most_m, double low_rad, double high_rad)
{
    double five = phase(m, setup, last, "lbf_fc", least_m, most_m, 1);
    double seven = phase(m, setup, last, "lbf7_fc", least_m, most_m, 1);
    bool by_five = five >= low_rad && five < high_rad, by_seven = seven >= low_rad && seven < high_rad;
    return finding(by_five && by_seven, by_five || by_seven,
                   "largest from %.0f to %.0f m: %.4f rad by Eq. (5), which the text states, %.4f rad by Eq. (7), "
                   "which the figures show (criterion: %.3f to %.3f rad by both, else by one)",
                   least_m, most_m, five, seven, low_rad, high_rad);
}

static struct finding short_first_maximum(struct measured *m)
{
    return largest_within(m, PHASE_SHORT, false, 50, 300, 0, 0.025);
}

static struct finding short_first_centroid(struct measured *m)
{
    double centre = phase(m, PHASE_SHORT, false, "lbf_fc", 50, 300, 0),
           all = phase_all(m, PHASE_SHORT, false, "lbf_fc");
    return finding(centre < 0.1 * all, false,
                   "%.2g rad at the Doppler centroid, %.2g rad at most (criterion for nearly zero: a tenth)", centre,
                   all);
}

static struct finding short_first_doppler(struct measured *m)
{
    double quarter = phase(m, PHASE_SHORT, false, "lbf_fc", 50, 300, 0.25);
    double half = phase(m, PHASE_SHORT, false, "lbf_fc", 50, 300, 0.5),
           all = phase_all(m, PHASE_SHORT, false, "lbf_fc");
    return finding(quarter < half && half < all, false,
                   "largest within a quarter, half and all of the Doppler band: %.2g, %.2g, %.2g rad", quarter, half,
                   all);
}

static struct finding rises_with_range(struct measured *m, enum phase_setup setup, bool last, const char *formula)
{
    double v[4];
    phase_by_range(m, setup, last, formula, v);
    return finding(rises(v, 0), rises(v, 1),
                   "largest at 50, 135, 220, 300 m: %.3f, %.3f, %.3f, %.3f rad (else: from 135 m on)", v[0], v[1],
                   v[2], v[3]);
}

static struct finding short_first_range(struct measured *m)
{
    return rises_with_range(m, PHASE_SHORT, false, "lbf_fc");
}

static struct finding short_last_range(struct measured *m)
{
    double five[4], seven[4];
    phase_by_range(m, PHASE_SHORT, true, "lbf_fc", five);
    phase_by_range(m, PHASE_SHORT, true, "lbf7_fc", seven);
    return finding(falls(five, 0) && falls(seven, 0), falls(seven, 0),
                   "at 50, 135, 220, 300 m: %.4f, %.4f, %.4f, %.4f rad by Eq. (5), which the text states; %.3f, "
                   "%.3f, %.3f, %.3f rad by Eq. (7), which the figure must show",
                   five[0], five[1], five[2], five[3], seven[0], seven[1], seven[2], seven[3]);
}

static struct finding short_last_maximum(struct measured *m)
{
    return largest_within(m, PHASE_SHORT, true, 135, 300, 0.075, 0.085);
}

static struct finding short_last_quarter_pi(struct measured *m)
{
    return largest_within(m, PHASE_SHORT, true, 50, 300, 0, acos(-1) / 4);
}

static struct finding pca_short_first_range(struct measured *m)
{
    return rises_with_range(m, PHASE_SHORT, false, "pca");
}

static struct finding short_first_much_smaller(struct measured *m)
{
    double lbf = phase_all(m, PHASE_SHORT, false, "lbf_fc"), pca = phase_all(m, PHASE_SHORT, false, "pca");
    return finding(lbf <= pca / 2, lbf < pca,
                   "largest: LBF %.3f rad, PCA %.3f rad (criterion for much smaller: half)", lbf, pca);
}

static struct finding short_first_negligible(struct measured *m)
{
    double lbf = phase_all(m, PHASE_SHORT, false, "lbf_fc"), pca = phase_all(m, PHASE_SHORT, false, "pca"),
           limit = acos(-1) / 4;
    return finding(fmax(lbf, pca) < limit, false,
                   "largest: LBF %.3f rad, PCA %.3f rad; the paper's own limit is pi/4 = %.3f rad", lbf, pca, limit);
}

static struct finding nearly_same_near(struct measured *m, enum phase_setup setup)
{
    double five = phase(m, setup, true, "lbf_fc", 50, 50, 1), seven = phase(m, setup, true, "lbf7_fc", 50, 50, 1);
    double pca = phase(m, setup, true, "pca", 50, 50, 1);
    return finding(fabs(five / pca - 1) <= 0.2, fabs(seven / pca - 1) <= 0.2,
                   "at 50 m: LBF %.4f rad by Eq. (5), %.3f rad by Eq. (7), which the figure must show; PCA %.3f rad "
                   "(criterion: within a fifth)",
                   five, seven, pca);
}

static struct finding short_last_near(struct measured *m)
{
    return nearly_same_near(m, PHASE_SHORT);
}

static struct finding pca_short_last_maximum(struct measured *m)
{
    double far = phase(m, PHASE_SHORT, true, "pca", 135, 300, 1),
           near = phase(m, PHASE_SHORT, true, "pca", 50, 50, 1);
    return finding(fmax(far, near) < 0.155, far < 0.155,
                   "largest: %.3f rad from 135 to 300 m (panels b to d, which the sentence is about), %.3f rad at 50 "
                   "m; the paper says 0.15",
                   far, near);
}

static struct finding pca_short_last_range(struct measured *m)
{
    return rises_with_range(m, PHASE_SHORT, true, "pca");
}

static struct finding long_first_near(struct measured *m)
{
    return largest_within(m, PHASE_LONG, false, 50, 50, 0.015, 0.025);
}

static struct finding long_first_maximum(struct measured *m)
{
    return largest_within(m, PHASE_LONG, false, 50, 300, 0.05, 0.15);
}

static struct finding long_first_range(struct measured *m)
{
    return rises_with_range(m, PHASE_LONG, false, "lbf_fc");
}

static struct finding long_first_pca(struct measured *m)
{
    double largest = phase_all(m, PHASE_LONG, false, "pca");
    return finding(largest >= 0.95 && largest < 1.05, largest >= 0.5 && largest < 1.5,
                   "largest: %.3f rad; holds if it rounds to 1.0, under rounding to whole numbers if to 1",
                   largest);
}

static struct finding long_last_range(struct measured *m)
{
    double five[4], seven[4];
    phase_by_range(m, PHASE_LONG, true, "lbf_fc", five);
    phase_by_range(m, PHASE_LONG, true, "lbf7_fc", seven);
    return finding(five[3] < five[0] && seven[3] < seven[0], seven[3] < seven[0],
                   "at 50, 135, 220, 300 m: %.3f, %.3f, %.3f, %.3f rad by Eq. (5), which the text states; %.3f, "
                   "%.3f, %.3f, %.3f rad by Eq. (7), which the figure must show",
                   five[0], five[1], five[2], five[3], seven[0], seven[1], seven[2], seven[3]);
}

static struct finding pca_long_last_range(struct measured *m)
{
    return rises_with_range(m, PHASE_LONG, true, "pca");
}

static struct finding long_last_near(struct measured *m)
{
    return nearly_same_near(m, PHASE_LONG);
}

static struct finding long_last_far(struct measured *m)
{
    double five = phase(m, PHASE_LONG, true, "lbf_fc", 300, 300, 1),
           seven = phase(m, PHASE_LONG, true, "lbf7_fc", 300, 300, 1);
    double pca = phase(m, PHASE_LONG, true, "pca", 300, 300, 1);
    return finding(fmax(five, seven) < pca, fmin(five, seven) < pca,
                   "at 300 m: LBF %.3f rad by Eq. (5), %.3f rad by Eq. (7), PCA %.3f rad", five, seven, pca);
}

const struct claim claims_lbf21_phase[] = {
    {"lbf21-abstract-1", "LBF21", "abstract", "the largest phase error of PCA is about 1 rad", pca_about_one},
    {"lbf21-abstract-3", "LBF21", "abstract", "the phase error of LBF always stays within pi/4",
     lbf_below_quarter_pi},
    {"lbf21-abstract-4", "LBF21", "abstract", "the spectrum of LBF is more accurate than that of PCA",
     lbf_more_accurate},
    {"lbf21-abstract-6", "LBF21", "abstract, III-B, VI", "LBF reduces to PCA under certain conditions",
     lbf_reduces_to_pca},
    {"lbf21-3C-1", "LBF21", "III-C, Fig. 2", "LBF, first receiver: at most 0.02 rad", short_first_maximum},
    {"lbf21-3C-2", "LBF21", "III-C, Fig. 2", "the error is nearly zero at the Doppler centroid",
     short_first_centroid},
    {"lbf21-3C-3", "LBF21", "III-C, Fig. 2", "the error grows away from the Doppler centroid", short_first_doppler},
    {"lbf21-3C-4", "LBF21", "III-C, Fig. 2", "LBF, first receiver: the error grows with range", short_first_range},
    {"lbf21-3C-5", "LBF21", "III-C, Fig. 3", "LBF, last receiver: the error falls with range", short_last_range},
    {"lbf21-3C-6", "LBF21", "III-C, Fig. 3", "LBF, last receiver: about 0.08 rad in panels b to d",
     short_last_maximum},
    {"lbf21-3C-7", "LBF21", "III-C, Fig. 3", "LBF, last receiver: within pi/4", short_last_quarter_pi},
    {"lbf21-3C-8", "LBF21", "III-C, Fig. 4", "PCA, first receiver: the error grows with range",
     pca_short_first_range},
    {"lbf21-3C-9", "LBF21", "III-C, Figs 2, 4", "first receiver: the error of LBF is much smaller than that of PCA",
     short_first_much_smaller},
    {"lbf21-3C-10", "LBF21", "III-C, Figs 2, 4", "first receiver: both errors are negligible",
     short_first_negligible},
    {"lbf21-3C-11", "LBF21", "III-C, Figs 3a, 5a", "last receiver, close range: PCA is mostly close to LBF",
     short_last_near},
    {"lbf21-3C-12", "LBF21", "III-C, Fig. 5", "PCA, last receiver: at most 0.15 rad", pca_short_last_maximum},
    {"lbf21-3C-13", "LBF21", "III-C, Fig. 5", "PCA, last receiver: the error grows slightly with range",
     pca_short_last_range},
    {"lbf21-3D-1", "LBF21", "III-D, Fig. 6", "LBF, first receiver: about 0.02 rad at close range", long_first_near},
    {"lbf21-3D-2", "LBF21", "III-D, Fig. 6", "LBF, first receiver: about 0.1 rad at most", long_first_maximum},
    {"lbf21-3D-3", "LBF21", "III-D, Fig. 6", "LBF, first receiver: the error grows with range", long_first_range},
    {"lbf21-3D-4", "LBF21", "III-D, Fig. 7", "PCA, first receiver: about 1 rad at most", long_first_pca},
    {"lbf21-3D-5", "LBF21", "III-D, Fig. 8", "LBF, last receiver: the error falls slightly with range",
     long_last_range},
    {"lbf21-3D-6", "LBF21", "III-D, Fig. 9", "PCA, last receiver: the error grows with range", pca_long_last_range},
    {"lbf21-3D-7", "LBF21", "III-D, Figs 8a, 9a", "last receiver, close range: both errors are nearly the same",
     long_last_near},
    {"lbf21-3D-8", "LBF21", "III-D, Figs 8d, 9d",
     "last receiver, far range: the error of LBF is smaller than that of PCA", long_last_far},
    {.id = NULL},
};
