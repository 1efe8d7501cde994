/* A suggestion for a mistyped word (suggestion.h): the words with the fewest edits. */
#include "text/suggestion.h"

#include <ctype.h>
#include <limits.h>
#include <stdbool.h>
#include <string.h>
#include <strings.h>

#include "text/text_append.h"

enum { LETTERS_MOST = 60, EDITS_MOST = 2 };

static int least(int a, int b)
{
    return a < b ? a : b;
}

static bool same(char a, char b)
{
    return tolower((unsigned char)a) == tolower((unsigned char)b);
}

/* Letters to change, add, leave out, or swap with the next, without regard to case. */
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
            now[j] = least(least(before[j], now[j - 1]) + 1, before[j - 1] + !same(a[i - 1], b[j - 1]));
            if (i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]))
                now[j] = least(now[j], earlier[j - 2] + 1);
        }
    }
    return rows[length_a % 3][length_b];
}

static bool begins(const char *text, const char *with)
{
    return *with && strncasecmp(text, with, strlen(with)) == 0;
}

/* Edits from the given word to a word or to its rest behind a '/' or '_', at most `most`. A word that is cut short
   or continued counts as one edit; INT_MAX for others. */
static int distance(const char *given, const char *word, int most)
{
    int nearest = begins(given, word) ? 1 : INT_MAX;
    for (const char *part = word; part; part = strpbrk(part, "/_")) {
        part += part > word;
        const int count = edits(given, part);
        if (count <= most)
            nearest = least(nearest, count);
        if (begins(part, given))
            nearest = least(nearest, 1);
    }
    return nearest;
}

struct suggestion suggestion_begin(const char *given)
{
    return (struct suggestion){.given = given + strspn(given, "-"), .before = "", .distance = INT_MAX - 1};
}

void suggestion_offer(struct suggestion *suggestion, const char *word)
{
    const char *given = suggestion->given, *bare = word + strspn(word, "-");
    if (strlen(given) > LETTERS_MOST || strlen(bare) > LETTERS_MOST)
        return;
    const int found = distance(given, bare, least((int)strlen(given) / 3, EDITS_MOST));
    if (found > suggestion->distance)
        return;
    if (found < suggestion->distance)
        suggestion->count = 0;
    suggestion->distance = found;
    if (suggestion->count < SUGGESTED)
        suggestion->best[suggestion->count++] = word;
}

void suggestion_text(const struct suggestion *suggestion, char text[SUGGESTION_TEXT])
{
    *text = '\0';
    for (int k = 0; k < suggestion->count; k++)
        text_append(text, SUGGESTION_TEXT, "%s'%s%s'",
                    k == 0                       ? "; did you mean "
                    : k == suggestion->count - 1 ? " or "
                                                 : ", ",
                    suggestion->before, suggestion->best[k]);
    text_append(text, SUGGESTION_TEXT, suggestion->count ? "?" : ";");
}
