/* Texts that came from files, made fit to be shown: a terminal obeys control characters, and the page of a CI turns
   names into links, pictures and mentions. */
#ifndef SASBENCH_TEXT_SHOWN_TEXT_H
#define SASBENCH_TEXT_SHOWN_TEXT_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Bytes of the control character at `text`, of which *code becomes the number; 0 where none stands. Beside those of
   ASCII and of U+0080 to U+009F, what cannot be seen but turns, hides or breaks the text around it (U+202E); the
   joiners U+200C and U+200D, which some scripts are written with, are none. */
size_t control_length(const char *text, uint32_t *code);
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
