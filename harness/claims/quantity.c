/* The language of claims.csv (quantity.h): names, sums, products and functions of lists. lookup.c looks numbers up. */
#include "claims/quantity.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "text/text_append.h"
#include "measure/timing.h"

/* ---- texts ---- */

double values_extreme(const struct values *values, bool largest)
{
    const double *at = values->at;
    double value = at[0];
    for (int k = 1; k < values->count; k++)
        value = isnan(at[k]) || (largest ? at[k] > value : at[k] < value) ? at[k] : value;
    return value;
}

void values_append(char *text, size_t size, const struct values *values)
{
    text_append(text, size, "%.4g", values_extreme(values, false));
    if (values->count > 1)
        text_append(text, size, " to %.4g", values_extreme(values, true));
}

enum status formula_error(const struct formula *formula, const char *at, const char *format, ...)
{
    char message[500];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    return status_set(STATUS_INVALID, "%s: line %d: column %s, character %d: '%.40s': %s", formula->path, formula->line,
                      formula->column, (int)(at - formula->text) + 1, at, message);
}

void formula_begin(struct formula *formula, const char *column, const char *text)
{
    formula->column = column;
    formula->text = formula->at = text;
    formula->depth = 0;
}

void formula_blanks(struct formula *formula)
{
    while (*formula->at == ' ')
        formula->at++;
}

bool formula_take(struct formula *formula, char character)
{
    formula_blanks(formula);
    bool there = *formula->at == character && character;
    formula->at += there;
    return there;
}

void formula_word(struct formula *formula, char *word, size_t size)
{
    formula_blanks(formula);
    size_t length = 0;
    if (isalpha((unsigned char)*formula->at))
        while (isalnum((unsigned char)formula->at[length]) || formula->at[length] == '_')
            length++;
    snprintf(word, size, "%.*s", (int)length, formula->at);
    formula->at += length;
}

/* ---- arithmetic ---- */

/* a = a OPERATOR b, element by element; one number goes with each of several. */
static enum status combine(struct formula *formula, const char *at, struct values *a, const struct values *b,
                           char operation)
{
    if (a->count != b->count && a->count != 1 && b->count != 1)
        return formula_error(formula, at,
                             "lists of %d and %d numbers do not go together; lists of one length, or one "
                             "number, are accepted",
                             a->count, b->count);
    struct values result = {.count = a->count > b->count ? a->count : b->count, .timed = a->timed || b->timed};
    for (int k = 0; k < result.count; k++) {
        const double x = a->at[a->count == 1 ? 0 : k], y = b->at[b->count == 1 ? 0 : k];
        result.at[k] = operation == '+' ? x + y : operation == '-' ? x - y : operation == '*' ? x * y : x / y;
    }
    *a = result;
    return STATUS_OK;
}

enum status values_join(const struct formula *formula, const char *at, struct values *values, const struct values *more)
{
    if (values->count + more->count > VALUES_MAX)
        return formula_error(formula, at, "more than %d numbers; up to that are accepted", VALUES_MAX);
    memcpy(values->at + values->count, more->at, (size_t)more->count * sizeof *more->at);
    values->count += more->count;
    values->timed |= more->timed;
    return STATUS_OK;
}

enum status quantity_list_read(struct formula *formula, struct values *values)
{
    values->count = 0;
    values->timed = false;
    do {
        struct values more;
        const char *at = formula->at;
        enum status status = quantity_read(formula, &more);
        if (status == STATUS_OK)
            status = values_join(formula, at, values, &more);
        if (status != STATUS_OK)
            return status;
    } while (formula_take(formula, ','));
    return formula_take(formula, ')') ? STATUS_OK
                                      : formula_error(formula, formula->at, "an operator, ',' or ')' is needed here");
}

/* ---- what takes numbers ---- */

static double least(const struct values *v)
{
    return values_extreme(v, false);
}

static double largest(const struct values *v)
{
    return values_extreme(v, true);
}

static double magnitude(const struct values *v)
{
    return fmax(fabs(least(v)), fabs(largest(v)));
}

static double middle(const struct values *v)
{
    struct values copy = *v;
    return median(copy.at, copy.count);
}

static const struct {
    const char *name;
    double (*reduce)(const struct values *values);
    double (*each)(double value); /* instead: of every element */
} functions[] = {
    {"list", NULL, NULL},     {"min", least, NULL}, {"max", largest, NULL}, {"magnitude", magnitude, NULL},
    {"median", middle, NULL}, {"abs", NULL, fabs},  {"sqrt", NULL, sqrt},
};
enum { FUNCTIONS = sizeof functions / sizeof *functions };

static enum status function_read(struct formula *formula, int k, struct values *values)
{
    struct values list;
    enum status status = quantity_list_read(formula, &list);
    if (status != STATUS_OK)
        return status;
    *values = list;
    for (int n = 0; functions[k].each && n < list.count; n++)
        values->at[n] = functions[k].each(list.at[n]);
    if (functions[k].reduce)
        *values = (struct values){1, {functions[k].reduce(&list)}, list.timed};
    return STATUS_OK;
}

/* ---- names and factors ---- */

static int name_find(const struct formula *formula, const char *name)
{
    for (int k = 0; k < formula->count; k++)
        if (strcmp(formula->named[k].name, name) == 0)
            return k;
    return -1;
}

static enum status name_add(struct formula *formula, const char *at, const char *name, const struct values *values)
{
    if (formula->count == NAMES_MAX)
        return formula_error(formula, at, "more than %d names; up to that are accepted", NAMES_MAX);
    for (int k = 0; k < values->count && formula->measured; k++)
        if (!isfinite(values->at[k]))
            measured_missing(formula->measured, "%s is not finite", name);
    strcpy(formula->named[formula->count].name, name);
    formula->named[formula->count++].values = *values;
    return STATUS_OK;
}

/* The row of numbers.csv that may be named here; -1 where there is none. */
static int number_find(const struct formula *formula, const char *name)
{
    for (int row = formula->rows - 1; row >= 0; row--) {
        const char *of = csv_cell(formula->numbers, row, NUMBER_OF);
        if (strcmp(csv_cell(formula->numbers, row, NUMBER_NAME), name) == 0
            && (strcmp(of, formula->id) == 0 || strcmp(of, formula->paper) == 0))
            return row;
    }
    return -1;
}

/* Its value, which then has its name. */
static enum status number_of_row(struct formula *formula, int row, struct values *values)
{
    const char *path = formula->path, *column = formula->column, *text = formula->text, *at = formula->at;
    const int line = formula->line, depth = formula->depth, rows = formula->rows;
    formula->path = formula->numbers->path;
    formula->line = formula->numbers->lines[row];
    formula->rows = row;
    formula_begin(formula, "definition", csv_cell(formula->numbers, row, NUMBER_DEFINITION));
    enum status status = quantity_read(formula, values);
    if (status == STATUS_OK && *formula->at)
        status = formula_error(formula, formula->at, "an operator or the end is needed here");
    if (status == STATUS_OK)
        status = name_add(formula, formula->at, csv_cell(formula->numbers, row, NUMBER_NAME), values);
    formula->path = path;
    formula->line = line;
    formula->rows = rows;
    formula->column = column;
    formula->text = text;
    formula->at = at;
    formula->depth = depth;
    return status;
}

/* A factor that begins with a word. */
static enum status word_read(struct formula *formula, struct values *values)
{
    const char *at = formula->at;
    char word[40], accepted[600] = "";
    formula_word(formula, word, sizeof word);
    if (formula_take(formula, '(')) {
        for (int k = 0; k < FUNCTIONS; k++) {
            if (strcmp(functions[k].name, word) == 0)
                return function_read(formula, k, values);
            text_append(accepted, sizeof accepted, "%s, ", functions[k].name);
        }
        return lookup_read(formula, at, word, accepted, values);
    }
    int k = name_find(formula, word);
    if (k >= 0)
        *values = formula->named[k].values;
    else if ((k = number_find(formula, word)) >= 0)
        return number_of_row(formula, k, values);
    else if (strcmp(word, "pi") == 0)
        *values = (struct values){1, {acos(-1)}, false};
    else {
        for (k = 0; k < formula->count; k++)
            text_append(accepted, sizeof accepted, "%s, ", formula->named[k].name);
        return formula_error(formula, at, "this is no name; %spi, or a function with '(' are accepted", accepted);
    }
    return STATUS_OK;
}

static enum status number_read(struct formula *formula, struct values *values)
{
    char text[40];
    size_t length = strspn(formula->at, "0123456789.");
    if (length && (formula->at[length] == 'e' || formula->at[length] == 'E')) {
        length += 1 + (formula->at[length + 1] == '-');
        length += strspn(formula->at + length, "0123456789");
    }
    snprintf(text, sizeof text, "%.*s", (int)length, formula->at);
    values->count = 1;
    if (!length || length >= sizeof text || !csv_number(text, values->at) || !isfinite(*values->at))
        return formula_error(formula, formula->at, "a number, a name, a function or '(' is needed here");
    formula->at += length;
    return STATUS_OK;
}

static enum status factor_read(struct formula *formula, struct values *values)
{
    enum status status;
    values->timed = false;
    if (formula->depth == 20)
        return formula_error(formula, formula->at, "nested more than %d deep; less is accepted", formula->depth);
    formula->depth++;
    if (formula_take(formula, '-')) {
        status = factor_read(formula, values);
        for (int k = 0; status == STATUS_OK && k < values->count; k++)
            values->at[k] = -values->at[k];
    } else if (formula_take(formula, '(')) {
        status = quantity_read(formula, values);
        if (status == STATUS_OK && !formula_take(formula, ')'))
            status = formula_error(formula, formula->at, "')' is needed here");
    } else {
        status = isalpha((unsigned char)*formula->at) ? word_read(formula, values) : number_read(formula, values);
    }
    formula->depth--;
    return status;
}

static enum status product_read(struct formula *formula, struct values *values)
{
    enum status status = factor_read(formula, values);
    while (status == STATUS_OK) {
        struct values factor;
        const char *at = formula->at;
        bool times = formula_take(formula, '*');
        if (!times && !formula_take(formula, '/'))
            break;
        status = factor_read(formula, &factor);
        if (status == STATUS_OK)
            status = combine(formula, at, values, &factor, times ? '*' : '/');
    }
    return status;
}

enum status quantity_read(struct formula *formula, struct values *values)
{
    enum status status = product_read(formula, values);
    while (status == STATUS_OK) {
        struct values term;
        const char *at = formula->at;
        bool plus = formula_take(formula, '+');
        if (!plus && !formula_take(formula, '-'))
            break;
        status = product_read(formula, &term);
        if (status == STATUS_OK)
            status = combine(formula, at, values, &term, plus ? '+' : '-');
    }
    return status;
}

/* ---- definitions ---- */

static bool name_reserved(const char *name)
{
    bool reserved = strcmp(name, "pi") == 0 || lookup_exists(name);
    for (int k = 0; k < FUNCTIONS; k++)
        reserved |= strcmp(functions[k].name, name) == 0;
    return reserved;
}

static enum status definition_read(struct formula *formula)
{
    char name[sizeof formula->named[0].name + 1];
    struct values values;
    formula_blanks(formula);
    const char *at = formula->at;
    formula_word(formula, name, sizeof name);
    const int row = number_find(formula, name);
    if (row >= 0 && !formula_take(formula, '='))
        return name_find(formula, name) >= 0 ? STATUS_OK : number_of_row(formula, row, &values);
    if (!*name || strlen(name) >= sizeof formula->named[0].name || name_reserved(name) || name_find(formula, name) >= 0
        || row >= 0)
        return formula_error(formula, at,
                             "a name of its own is needed here, of up to %zu letters, digits and '_', "
                             "that is no function's and not in numbers.csv",
                             sizeof formula->named[0].name - 1);
    if (!formula_take(formula, '='))
        return formula_error(formula, formula->at, "'=' is needed here");
    const enum status status = quantity_read(formula, &values);
    return status == STATUS_OK ? name_add(formula, at, name, &values) : status;
}

enum status quantities_read(struct formula *formula, const char *column, const char *text)
{
    formula_begin(formula, column, text);
    enum status status = STATUS_OK;
    if (!*text)
        return STATUS_OK;
    do
        status = definition_read(formula);
    while (status == STATUS_OK && formula_take(formula, ';'));
    if (status == STATUS_OK && *formula->at)
        status = formula_error(formula, formula->at, "an operator, ';' or the end is needed here");
    return status;
}
