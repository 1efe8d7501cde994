/* A text made part by part. */
#ifndef SASBENCH_TEXT_TEXT_APPEND_H
#define SASBENCH_TEXT_TEXT_APPEND_H

#include <stddef.h>

/* Add a formatted part behind the string text[size]; it is cut where there is no room. */
void text_append(char *text, size_t size, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* Add one word of a command for a shell, quoted where it is empty, begins with a dash or has special characters. */
void text_append_word(char *text, size_t size, const char *word);

#endif
