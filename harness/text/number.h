/* Numbers as typed: plain decimal, in every locale. */
#ifndef SASBENCH_TEXT_NUMBER_H
#define SASBENCH_TEXT_NUMBER_H

/* The number that `text` begins with: sign, digits with or without a point, exponent; no blanks, no hexadecimal, no
   "inf" or "nan", and finite. Returns its end, or NULL (*value unchanged) without a number. */
const char *number_read(const char *text, double *value);
/* A whole number from min to max, read likewise. */
const char *whole_read(const char *text, long long min, long long max, long long *value);

#endif
