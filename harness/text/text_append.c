#include "text/text_append.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void text_append(char *text, size_t size, const char *format, ...)
{
    const size_t used = strlen(text);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text + used, size - used, format, arguments);
    va_end(arguments);
}

void text_append_word(char *text, size_t size, const char *word)
{
    static const char plain[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+=.,:/@%";
    const char *quote = *word && *word != '-' && !word[strspn(word, plain)] ? "" : "'";
    text_append(text, size, "%s", quote);
    for (; *word; word++)
        text_append(text, size, *quote && *word == '\'' ? "'\\''" : "%c", *word);
    text_append(text, size, "%s", quote);
}
