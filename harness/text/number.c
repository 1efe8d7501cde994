/* The one reader of numbers on the command line (number.h). strtod also takes blanks, hexadecimal, "inf" and "nan". The
   program never sets a locale: the point is a point. */
#include "text/number.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char digits[] = "0123456789";

/* The end of a plain decimal, or NULL. */
static const char *decimal_end(const char *text)
{
    text += *text == '+' || *text == '-';
    size_t whole = strspn(text, digits);
    text += whole;
    size_t fraction = *text == '.' ? strspn(text + 1, digits) : 0;
    if (whole + fraction == 0)
        return NULL;
    text += *text == '.' ? 1 + fraction : 0;
    if (*text != 'e' && *text != 'E')
        return text;
    const char *exponent = text + 1 + (text[1] == '+' || text[1] == '-');
    size_t length = strspn(exponent, digits);
    return length > 0 ? exponent + length : NULL;
}

const char *number_read(const char *text, double *value)
{
    const char *end = decimal_end(text);
    if (!end || *end == 'x' || *end == 'X') /* strtod would read on behind the 0 */
        return NULL;
    double number = strtod(text, NULL);
    if (!isfinite(number))
        return NULL;
    *value = number;
    return end;
}

const char *whole_read(const char *text, long long min, long long max, long long *value)
{
    const char *first = text + (*text == '+' || *text == '-');
    size_t length = strspn(first, digits);
    errno = 0;
    long long number = length > 0 ? strtoll(text, NULL, 10) : 0;
    if (length == 0 || errno == ERANGE || number < min || number > max)
        return NULL;
    *value = number;
    return first + length;
}
