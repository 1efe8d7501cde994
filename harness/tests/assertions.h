/* cmocka, with an assertion on numbers that a NaN never passes: cmocka's assert_float_equal takes NaN for equal to
   anything and rounds to float, so that it may not be used here. */
#ifndef SASBENCH_TEST_ASSERTIONS_H
#define SASBENCH_TEST_ASSERTIONS_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#undef assert_float_equal
#undef assert_float_not_equal
#pragma GCC poison assert_float_equal assert_float_not_equal assert_double_equal assert_double_not_equal

/* NaN is close to nothing. */
static inline bool is_close(double value, double wanted, double slack)
{
    return fabs(value - wanted) <= slack;
}

#define assert_close(value, wanted, slack) check_close(value, wanted, slack, #value, __FILE__, __LINE__)

static inline void check_close(double value, double wanted, double slack, const char *text, const char *file, int line)
{
    if (is_close(value, wanted, slack))
        return;
    print_error("%s is %.12g, must be %.12g +- %.3g\n", text, value, wanted, slack);
    _fail(file, line);
}

/* The larger one; NaN as soon as one is NaN, which fmax would drop. */
static inline double worse_of(double worst, double value)
{
    return isnan(worst) || value <= worst ? worst : value;
}

#endif
