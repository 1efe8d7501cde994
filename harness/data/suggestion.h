/* What was probably meant by a word that is none. */
#ifndef SASBENCH_DATA_SUGGESTION_H
#define SASBENCH_DATA_SUGGESTION_H

#include <stddef.h>

/* The best of the words that were offered so far. */
struct suggestion {
    const char *given, *best; /* best NULL: none is near */
    int distance;
};

struct suggestion suggestion_begin(const char *given);
/* Offer a word: it is near when at most a third of the given one's letters, and no more than two, are wrong, missing or
   too many, or two neighbours are swapped, which counts once. */
void suggestion_offer(struct suggestion *suggestion, const char *word);
/* What goes on behind a complaint and ahead of what is accepted: "; did you mean 'WORD'?", or ";" where none is near.
   */
void suggestion_text(const struct suggestion *suggestion, char *text, size_t size);

#endif
