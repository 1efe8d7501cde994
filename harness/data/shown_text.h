/* Texts that came from files, made fit to be shown: a terminal obeys control characters, and the page of a CI turns
   names into links, pictures and mentions. */
#ifndef SASBENCH_DATA_SHOWN_TEXT_H
#define SASBENCH_DATA_SHOWN_TEXT_H

#include <stddef.h>
#include <stdio.h>

/* Bytes of the character at `text`, which is not its end: 0 for a control character and for what is not UTF-8. */
size_t shown_length(const char *text);

/* For a terminal: '?' stands for each byte that cannot be shown. */
void shown_write(FILE *stream, const char *text);
/* The same in place. */
void shown_make(char *text);

/* "sasbench: TEXT" on standard error, behind what was printed so far: one line, on a terminal broken at blanks to its
   width. */
void shown_note(const char *text);

/* For Markdown, in a paragraph, a list or a cell of a table: read as it is written, without effect. */
void shown_markdown(FILE *stream, const char *text);

#endif
