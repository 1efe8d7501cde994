/* What was probably meant by a word that is none. */
#ifndef SASBENCH_TEXT_SUGGESTION_H
#define SASBENCH_TEXT_SUGGESTION_H

enum { SUGGESTED = 3, SUGGESTION_TEXT = 240 };

/* The best of the words that were offered so far: the first of those that are equally near. */
struct suggestion {
    const char *given;           /* without dashes ahead */
    const char *before;          /* what stands ahead of a word where it is suggested: "--" of options */
    const char *best[SUGGESTED]; /* [count] */
    int count, distance;
};

struct suggestion suggestion_begin(const char *given);
/* Offer a word: it, or its rest behind a '/' or '_', is near when at most a third of the given one's letters, and no
   more than two, are wrong, missing or too many, or two neighbours are swapped, which counts once; and when one of
   both begins with the other. Dashes ahead and capital letters make no difference. */
void suggestion_offer(struct suggestion *suggestion, const char *word);
/* What goes on behind a complaint and ahead of what is accepted: "; did you mean 'WORD' or 'OTHER'?", or ";" where none
   is near. */
void suggestion_text(const struct suggestion *suggestion, char text[SUGGESTION_TEXT]);

#endif
