/* Numbers as they are typed: plain decimal, whatever the locale says. */
#ifndef SASBENCH_TEXT_NUMBER_H
#define SASBENCH_TEXT_NUMBER_H

/* The number that `text` begins with: sign, digits with or without a point, exponent; no blanks, no hexadecimal, no
   "inf" or "nan", and finite. Returns where it ends, NULL (*value untouched) when there is none. */
const char *number_read(const char *text, double *value);
/* A whole number from min to max, in the same way. */
const char *whole_read(const char *text, long long min, long long max, long long *value);

#endif
