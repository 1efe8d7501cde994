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
#include <stdio.h>

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

/* A measured value up to its bound; the words behind name what was measured: scene, SPEC. A NaN is above any bound. */
#define assert_up_to(value, bound, ...) check_up_to(value, bound, __FILE__, __LINE__, __VA_ARGS__)

static inline void __attribute__((format(printf, 5, 6)))
check_up_to(double value, double bound, const char *file, int line, const char *format, ...)
{
    char text[400];
    va_list arguments;
    if (value <= bound)
        return;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    print_error("%s: %.6g, must be up to %.6g\n", text, value, bound);
    _fail(file, line);
}

/* The larger one; NaN as soon as one is NaN, which fmax would drop. */
static inline double worse_of(double worst, double value)
{
    return isnan(worst) || value <= worst ? worst : value;
}

#endif
