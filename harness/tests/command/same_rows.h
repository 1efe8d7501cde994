/* Rows of two results folders. */
#ifndef SASBENCH_TEST_SAME_ROWS_H
#define SASBENCH_TEST_SAME_ROWS_H

/* Two files row by row, whatever their order, but for what is measured in seconds. */
void assert_same_rows(const char *whole, const char *other);
/* The two files of results folders. */
void assert_same_results(const char *whole, const char *other);

#endif
