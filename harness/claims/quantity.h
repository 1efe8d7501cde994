/* The language of claims.csv: sums and products of measured and printed numbers, with names. results/README.md
   describes it for authors of claims.

   A name that its cell does not define is a row of numbers.csv, of the claim or of its paper.

   A cell is read from left to right and evaluated on the way. Without measurements it is only checked: every number of
   the folder is then 1, but lists have their lengths. A scene, a SPEC, a metric, a time or a printed number that does
   not exist is an error all the same. */
#ifndef SASBENCH_CLAIMS_QUANTITY_H
#define SASBENCH_CLAIMS_QUANTITY_H

#include "papers/sources.h"

/* One number, or one for each of several targets or ranges: of three methods at 48 targets at most. */
enum { VALUES_MAX = 144, TARGETS_MAX = 64 };
struct values {
    int count;
    double at[VALUES_MAX];
    bool timed; /* it depends on a time: only comparisons with a noise may compare it */
};

/* What numbers depend on beside measurements: a scene, a setting (a formula of the phase study, a SPEC that is
   planned), the definition by which an azimuth slice is measured, a table of published.csv. */
enum use { USE_SCENE, USE_SETTING, USE_SLICE, USE_TABLE };

/* The state of reading a claim: the position, and the names defined so far. */
enum { NAMES_MAX = 48 };
struct formula {
    struct measured *measured; /* NULL: only check */
    enum scheme scheme;        /* the scheme of LBF */
    bool by_scheme;            /* LBF was named: the other scheme may give other numbers */
    bool phases;               /* the phase study is needed */
    bool rules;                /* the rules' study is needed */
    bool measures;             /* a measurement is needed */
    bool scenes;               /* a number of a scene is needed */
    bool times;                /* a time, or a scene that is for times, is needed */
    const struct csv *published;
    const struct csv *numbers; /* numbers.csv: [rows] of it may be named */
    int rows;
    const char *id, *paper;                                      /* the claim's */
    void (*need)(void *to, const char *scene, const char *spec); /* called for each measurement; may be NULL */
    void (*use)(void *to, enum use use, const char *text);       /* for what else is looked up; may be NULL */
    void *to;
    const char *path; /* for messages: file, line and column of the cell */
    int line;
    const char *column;
    const char *text, *at; /* the cell, and the next character */
    int depth;             /* of nested parentheses */
    int count;
    struct {
        char name[32];
        struct values values;
    } named[NAMES_MAX];
};

/* The columns of numbers.csv: the number's owner (a claim's ID, or a paper), its name, and its expression, which may
   name rows above. */
enum number_column { NUMBER_OF, NUMBER_NAME, NUMBER_DEFINITION };

/* Define the names of a cell "name = expression; name", the latter being a row of numbers.csv; it may be empty.
   Errors: STATUS_INVALID naming file, line, column, character, what stands there and what is accepted. A number that
   is missing or not finite is no error but a reason in measured->missing. */
enum status quantities_read(struct formula *formula, const char *column, const char *text);
/* The next expression. Errors: as above. */
enum status quantity_read(struct formula *formula, struct values *values);
/* All elements of the comma-separated expressions up to the closing parenthesis, which is taken, too. */
enum status quantity_list_read(struct formula *formula, struct values *values);

/* Append `more`. Errors: STATUS_INVALID where they become too many. */
enum status values_join(const struct formula *formula, const char *at, struct values *values,
                        const struct values *more);

/* Begin a cell. */
void formula_begin(struct formula *formula, const char *column, const char *text);
/* Skip blanks; then take a character if it is the next; then take the word that comes next, "" if there is none. */
void formula_blanks(struct formula *formula);
bool formula_take(struct formula *formula, char character);
void formula_word(struct formula *formula, char *word, size_t size);
/* An error at `at`: "FILE: line N: column C, character K: 'what stands there': MESSAGE". */
enum status formula_error(const struct formula *formula, const char *at, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The largest or the least; NAN if one of them is. */
double values_extreme(const struct values *values, bool largest);
/* "0.452", or "0.01 to 0.45" of several, at the end of a text in `size` bytes. */
void values_append(char *text, size_t size, const struct values *values);

/* Is it the name of a function that looks numbers up? */
bool lookup_exists(const char *name);
/* Read the call of `name`, which stands at `at` and whose opening parenthesis was taken. `accepted`: the names of other
   functions, for the message about an unknown name. Errors: as quantities_read. */
enum status lookup_read(struct formula *formula, const char *at, const char *name, const char *accepted,
                        struct values *values);

#endif
