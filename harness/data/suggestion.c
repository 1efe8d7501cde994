/* What was probably meant (suggestion.h): the least number of edits. */
#include "data/suggestion.h"

#include <stdio.h>
#include <string.h>

enum { LETTERS_MOST = 60, EDITS_MOST = 2 };

static int least(int a, int b)
{
    return a < b ? a : b;
}

/* Letters to change, add, leave out, or swap with the next. */
static int edits(const char *a, const char *b)
{
    int rows[3][LETTERS_MOST + 1];
    const int length_a = (int)strlen(a), length_b = (int)strlen(b);
    for (int j = 0; j <= length_b; j++)
        rows[0][j] = j;
    for (int i = 1; i <= length_a; i++) {
        int *now = rows[i % 3], *before = rows[(i + 2) % 3], *earlier = rows[(i + 1) % 3];
        now[0] = i;
        for (int j = 1; j <= length_b; j++) {
            now[j] = least(least(before[j], now[j - 1]) + 1, before[j - 1] + (a[i - 1] != b[j - 1]));
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                now[j] = least(now[j], earlier[j - 2] + 1);
        }
    }
    return rows[length_a % 3][length_b];
}

struct suggestion suggestion_begin(const char *given)
{
    const int most = (int)strlen(given) / 3;
    return (struct suggestion){given, NULL, least(most, EDITS_MOST) + 1};
}

void suggestion_offer(struct suggestion *suggestion, const char *word)
{
    if (strlen(suggestion->given) > LETTERS_MOST || strlen(word) > LETTERS_MOST)
        return;
    const int distance = edits(suggestion->given, word);
    if (distance < suggestion->distance) {
        suggestion->distance = distance;
        suggestion->best = word;
    }
}

void suggestion_text(const struct suggestion *suggestion, char *text, size_t size)
{
    if (suggestion->best)
        snprintf(text, size, "; did you mean '%s'?", suggestion->best);
    else
        snprintf(text, size, ";");
}
