/* Back projection with Farrow branches:  s(q) = sum over m <= degree of branch_m[i] u^m,  i = floor(q + 1/2), u = q-i.
   Branch m is the record's spectrum times H_m(nu), made in the range compression: the first two by transforms, the
   others from their neighbours (backprojection/farrow.h has both). A pair reads its values at one index, like
   bp_nearest, and needs neither taps nor weights.

   Cost: two inverse FFTs of factor N a record in place of one, whatever the degree; 4 degree + 8 FLOPs a pair.
   Error, relative L2 of a record of flat spectrum (farrow_error): 4.0e-4, 2.8e-5, 1.7e-6, 9.0e-8 for degrees 3 to 6
   at fs = 2B; 2.9e-3, 3.5e-4, 3.6e-5, 3.1e-6 at fs = 1.2 B. It falls by an order of magnitude and more with each
   degree; a higher degree is cheaper than factor = 2. Frequencies beyond the band keep a small error as well: 1.7e-2
   for degree 3 at fs/2. */
#include <math.h>

#include "backprojection/bp.h"
#include "backprojection/farrow.h"

enum { DEGREE_AUTO, DEGREE_FIRST }; /* of `degrees`: the index of the first number */

struct options {
    struct bp_options bp;
    int degree, factor;
    double error;
};

static const char *const degrees[] = {"auto", "2", "3", "4", "5", "6", "7", "8", "9", NULL};

static const struct param params[] = {
    {PARAM_NAMED(struct options, degree, degrees),
     .summary = "of the polynomials between samples; auto: the least one whose predicted error is at most `error`",
     .initial = DEGREE_AUTO, .max = DEGREE_FIRST + FARROW_MOST - FARROW_LEAST, .sweep = "2 3 4 5 6 7"},
    {PARAM(struct options, factor), .summary = "length of the padded spectrum over the record's", .initial = 1,
     .min = 1, .max = 2, .terse = true},
    {PARAM(struct options, error),
     .summary = "degree=auto: relative L2 error of the image, by the spectrum of echoes and noise", .initial = 1e-4,
     .min = 1e-8, .max = 0.1, .terse = true},
    BP_PARAMS,
    {.name = NULL},
};

static double promise(const void *options)
{
    const struct options *o = options;
    return o->degree == DEGREE_AUTO ? o->error : NAN;
}

static enum status make(const struct problem *problem, const void *options, struct interpolator *interpolator)
{
    const struct options *o = options;
    const int degree = o->degree == DEGREE_AUTO ? farrow_degree_choose(o->error, problem, o->factor)
                                                : FARROW_LEAST + o->degree - DEGREE_FIRST;
    *interpolator = (struct interpolator){.upsample = o->factor, .taps = 1, .degree = degree};
    return degree > 0 ? STATUS_OK : STATUS_FAILED;
}

static const struct bp_method method = {make, NULL};

static const struct candidate_family candidates[] = {
    {"", "degree", "2 3 4 5 6 7 8 9"},
    {"factor=2", "degree", "2 3 4 5 6"},
    {"engine=general", "degree", "2 3 4 5"},
    {.fixed = NULL},
};

static const char *const gated[] = {"degree=3", "degree=6,factor=2,precision=double", "degree=5,engine=general",
                                    "degree=5,engine=general,precision=double", NULL};

const struct algorithm bp_farrow = {
    .name = "bp_farrow",
    .summary = "back projection, polynomials between samples by Farrow branches",
    .reference = "Farrow, ISCAS 1988; Abramowitz and Stegun Eq. 10.1.47",
    .traits = TRAIT_ANY_TRACK | TRAIT_APERTURE_LIMIT | TRAIT_WINDOW,
    .reading = READING_POLYNOMIAL,
    .extreme_error = 1e-3,
    .options_size = sizeof(struct options),
    .params = params,
    .gated = gated,
    .candidates = candidates,
    .method = &method,
    .promise = promise,
    BP_CALLBACKS,
};
