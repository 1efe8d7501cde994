/* Make texts from files safe to show: a terminal obeys control characters, and the page of a CI turns names into
   links, pictures and mentions. */
#ifndef SASBENCH_TEXT_SHOWN_TEXT_H
#define SASBENCH_TEXT_SHOWN_TEXT_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Length in bytes of the control character at `text`, its number in *code; 0 if there is none. It includes those of
   ASCII, those from U+0080 to U+009F, and invisible characters that turn, hide or break the text around them
   (U+202E). The joiners U+200C and U+200D, which some scripts need, are allowed. */
size_t control_length(const char *text, uint32_t *code);
/* Length in bytes of the character at `text`, not its end: 0 for a control character and for invalid UTF-8. */
size_t shown_length(const char *text);

/* Columns of a text in UTF-8, each character one. */
size_t shown_columns(const char *text);

/* For a terminal: '?' replaces each byte that cannot be shown. */
void shown_write(FILE *stream, const char *text);
/* The same in place. */
void shown_make(char *text);

/* "sasbench: TEXT" on standard error, after earlier output: one line, on a terminal broken at blanks to its width. */
void shown_note(const char *text);

/* For Markdown, in a paragraph, a list or a cell of a table: shown as written, without markup. */
void shown_markdown(FILE *stream, const char *text);

#endif
