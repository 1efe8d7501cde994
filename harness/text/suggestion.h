/* A suggestion for a mistyped word. */
#ifndef SASBENCH_TEXT_SUGGESTION_H
#define SASBENCH_TEXT_SUGGESTION_H

enum { SUGGESTED = 3, SUGGESTION_TEXT = 240 };

/* The best of the words offered so far; of equally near ones the first. */
struct suggestion {
    const char *given;           /* without leading dashes */
    const char *before;          /* what precedes a suggested word: "--" of options */
    const char *best[SUGGESTED]; /* [count] */
    int count, distance;
};

struct suggestion suggestion_begin(const char *given);
/* Offer a word. It, or its rest behind a '/' or '_', is near when at most a third of the given word's letters, and
   no more than two, are wrong, missing or too many; two swapped neighbours count once. It is also near when one of
   both begins with the other. Leading dashes and case make no difference. */
void suggestion_offer(struct suggestion *suggestion, const char *word);
/* The text between a complaint and what is accepted: "; did you mean 'WORD' or 'OTHER'?", or ";" without a near
   word. */
void suggestion_text(const struct suggestion *suggestion, char text[SUGGESTION_TEXT]);

#endif
