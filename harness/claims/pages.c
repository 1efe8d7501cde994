/* One page a paper, from the files of a results folder (reproduce.h). */
#include "claims/reproduce.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "files/csv.h"
#include "files/text_file.h"
#include "text/shown_text.h"

static const struct paper {
    const char *name, *prefix, *title; /* as in claims.csv; of its tables' IDs; authors and title */
} papers[] = {
    {"BP22", "bp22_",
     "Zhang and Yang: Back Projection Algorithm for Multi-Receiver Synthetic Aperture Sonar Based on Two "
     "Interpolators, 2022"},
    {"ZP15", "zp15_",
     "Wang, Zhang and Zhu: Upsampling Based Back Projection Imaging Algorithm for Multi-receiver Synthetic "
     "Aperture Sonar, 2015"},
    {"LBF21", "lbf21_", "Zhang, Wu, Sun and Ying: Multireceiver SAS Imagery Based on Monostatic Conversion, 2021"},
    {"SQ18", "sq18_",
     "Wang, Tang, Tian and Huang: An Improved Squint Wideband Synthetic Aperture Sonar Imaging omega-k "
     "Algorithm, 2018"},
    {"PF05", "pf05_", "Szczegielniak: Spatial SAS Signal Filtering by Means of Polar Format Processing, 2005"},
};
enum { PAPERS = sizeof papers / sizeof *papers, TEXTS_MAX = 64 };

enum { V_ID, V_PAPER, V_SECTION, V_CLAIM, V_VERDICT, V_CORRECTED, V_BASIS, V_EVIDENCE };
enum { N_TABLE, N_ITEM, N_QUANTITY, N_DEFINITION, N_UNIT, N_PAPER, N_OURS, N_DIFFERENCE, N_ASSUMPTION };
enum { S_CLAIM, S_SCHEME, S_ASSUMPTION, S_VERDICT };
static const char *const verdict_columns[] = {"id",        "paper", "section",  "claim", "verdict",
                                              "corrected", "basis", "evidence", NULL};
static const char *const number_columns[] = {"table", "item", "quantity",   "definition", "unit",
                                             "paper", "ours", "difference", "assumption", NULL};
static const char *const assumption_columns[] = {"claim", "scheme", "assumption", "verdict", NULL};

struct pages {
    const struct claims *claims;
    const char *from, *to;
    struct csv verdicts, numbers, assumptions; /* `assumptions` without rows: not tried */
};

static int row_of(const struct csv *csv, int column, const char *text)
{
    int row = 0;
    while (row < csv->row_count && strcmp(csv_cell(csv, row, column), text) != 0)
        row++;
    return row < csv->row_count ? row : -1;
}

/* ---- claims ---- */

static const char *verdict_of(const struct pages *pages, const struct claim *claim, enum scheme scheme)
{
    return csv_cell(&pages->verdicts, row_of(&pages->verdicts, V_ID, claim->id), scheme ? V_CORRECTED : V_VERDICT);
}

/* Under how many assumptions the verdict is another one; -1: none was tried. Writes them where `stream` is given. */
static int flips(const struct pages *pages, const struct claim *claim, enum scheme scheme, FILE *stream)
{
    const struct csv *csv = &pages->assumptions;
    const char *nominal = NULL;
    int count = -1;
    for (int row = 0; row < csv->row_count; row++) {
        if (strcmp(csv_cell(csv, row, S_CLAIM), claim->id) != 0
            || strcmp(csv_cell(csv, row, S_SCHEME), scheme_names[scheme]) != 0)
            continue;
        const char *verdict = csv_cell(csv, row, S_VERDICT);
        nominal = nominal ? nominal : verdict;
        count += count < 0;
        if (strcmp(verdict, nominal) == 0)
            continue;
        if (stream)
            fprintf(stream, "%s%s: **%s**", count ? "; " : "", csv_cell(csv, row, S_ASSUMPTION), verdict);
        count++;
    }
    return count;
}

/* The evidence of one scheme is "NUMBERS; criterion: CRITERION; COMPARISONS; settings: ...". The criterion, and that it
   changed, are shown by themselves. */
static void evidence_write(FILE *stream, char *evidence, const char *scheme, const struct claim *claim)
{
    static const char *const heads[] = {"; no criterion: ", "; criterion: ", "; criterion changed "};
    const char *rest = "";
    for (size_t k = 0; k < sizeof heads / sizeof *heads; k++) {
        const char *text = k < 2 ? claim->criterion : claim->changed;
        char *at = strstr(k < 2 ? evidence : rest, heads[k]);
        if (!at || !*text || strncmp(at + strlen(heads[k]), text, strlen(text)) != 0)
            continue;
        rest = at + strlen(heads[k]) + strlen(text);
        *at = '\0';
    }
    fprintf(stream, "- Measured%s: ", scheme);
    shown_markdown(stream, evidence);
    if (*rest) {
        fprintf(stream, "\n- Decided%s: ", scheme);
        shown_markdown(stream, rest + strspn(rest, "; "));
    }
    fputc('\n', stream);
}

static void claim_write(const struct pages *pages, const struct claim *claim, FILE *stream)
{
    const int row = row_of(&pages->verdicts, V_ID, claim->id);
    char *printed = strdup(csv_cell(&pages->verdicts, row, V_EVIDENCE));
    char *corrected = printed ? strstr(printed, " | corrected: ") : NULL;
    fprintf(stream, "\n### %s: %s", claim->id, verdict_of(pages, claim, SCHEME_PRINTED));
    if (claim->by_scheme)
        fprintf(stream, " as printed; corrected: %s", verdict_of(pages, claim, SCHEME_CORRECTED));
    fprintf(stream, "\n\nSection %s: ", claim->section);
    shown_markdown(stream, claim->claim);
    fputs(".\n\n- Criterion: ", stream);
    shown_markdown(stream, claim->criterion);
    fputc('\n', stream);
    if (*claim->changed) {
        fputs("- The criterion changed with the result known: ", stream);
        shown_markdown(stream, claim->changed);
        fputc('\n', stream);
    }
    if (corrected)
        *corrected = '\0';
    if (printed)
        evidence_write(stream, printed, corrected ? ", as printed" : "", claim);
    if (corrected)
        evidence_write(stream, corrected + strlen(" | corrected: "), ", corrected", claim);
    free(printed);
    for (enum scheme scheme = 0; scheme < (claim->by_scheme ? SCHEMES : 1); scheme++) {
        const int count = flips(pages, claim, scheme, NULL);
        if (count < 0)
            continue;
        fprintf(stream, "- Other assumptions%s%s: ", claim->by_scheme ? ", " : "",
                claim->by_scheme ? scheme_names[scheme] : "");
        if (count == 0)
            fputs("the same verdict under all that were tried", stream);
        flips(pages, claim, scheme, stream);
        fputs(".\n", stream);
    }
}

/* ---- printed numbers ---- */

/* The different texts of a column among the rows of a table (and quantity, unless NULL), in their order. */
static int names_of(const struct csv *csv, const char *table, const char *quantity, int column,
                    const char *names[TEXTS_MAX])
{
    int count = 0;
    for (int row = 0; row < csv->row_count; row++) {
        if (strcmp(csv_cell(csv, row, N_TABLE), table) != 0
            || (quantity && strcmp(csv_cell(csv, row, N_QUANTITY), quantity) != 0))
            continue;
        int k = 0;
        while (k < count && strcmp(names[k], csv_cell(csv, row, column)) != 0)
            k++;
        if (k == count && count < TEXTS_MAX)
            names[count++] = csv_cell(csv, row, column);
    }
    return count;
}

static double number_of(const struct csv *csv, int row, int column)
{
    double value = NAN;
    csv_number(csv_cell(csv, row, column), &value);
    return value;
}

/* How far ours is from the paper's, in units of .1 dB or of 1 % of the printed number; NAN: one of them is missing. */
static double distance_of(const struct csv *csv, int row)
{
    const double paper = number_of(csv, row, N_PAPER), ours = number_of(csv, row, N_OURS);
    return fabs(ours - paper) / (strcmp(csv_cell(csv, row, N_UNIT), "dB") == 0 ? 0.1 : 0.01 * fabs(paper));
}

/* The next row from `row` on of a table's number; NULL: of any. -1: there is none. */
static int number_next(const struct csv *csv, int row, const char *const keys[N_UNIT])
{
    for (; row < csv->row_count; row++) {
        bool same = true;
        for (int k = 0; k < N_UNIT; k++)
            same = same && (!keys[k] || strcmp(csv_cell(csv, row, k), keys[k]) == 0);
        if (same)
            return row;
    }
    return -1;
}

/* How near ours are to the printed numbers of a quantity by one definition. */
static void nearness_row(const struct csv *csv, const char *table, const char *quantity, const char *definition,
                         bool *begun, FILE *stream)
{
    const char *const keys[N_UNIT] = {table, NULL, quantity, definition};
    int printed = 0, close = 0, near = 0;
    for (int row = -1; (row = number_next(csv, row + 1, keys)) >= 0;) {
        printed += isfinite(number_of(csv, row, N_PAPER));
        close += distance_of(csv, row) <= 1;
        near += distance_of(csv, row) <= 5;
    }
    if (printed == 0)
        return;
    if (!*begun)
        fputs("\n| table | quantity | definition | printed numbers | ours within 0.1 dB or 1 % | within 0.5 dB or 5 % "
              "|\n|---|---|---|---|---|---|\n",
              stream);
    *begun = true;
    fprintf(stream, "| `%s` | %s | %s | %d | %d | %d |\n", table, quantity, definition, printed, close, near);
}

static void nearness_write(const struct pages *pages, const struct paper *paper, FILE *stream)
{
    bool begun = false;
    for (const struct paper_table *table = paper_tables; table->id; table++) {
        const char *quantities[TEXTS_MAX], *definitions[TEXTS_MAX];
        if (strncmp(table->id, paper->prefix, strlen(paper->prefix)) != 0)
            continue;
        const int count = names_of(&pages->numbers, table->id, NULL, N_QUANTITY, quantities);
        for (int q = 0; q < count; q++) {
            const int each = names_of(&pages->numbers, table->id, quantities[q], N_DEFINITION, definitions);
            for (int d = 0; d < each; d++)
                nearness_row(&pages->numbers, table->id, quantities[q], definitions[d], &begun, stream);
        }
    }
}

/* The numbers of one quantity: an item a row, the printed number, and ours by each definition. */
static void quantity_write(const struct csv *csv, const char *table, const char *quantity, FILE *stream)
{
    const char *items[TEXTS_MAX], *definitions[TEXTS_MAX];
    const int item_count = names_of(csv, table, quantity, N_ITEM, items);
    const int count = names_of(csv, table, quantity, N_DEFINITION, definitions);
    fprintf(stream, "\n| %s (%s) | paper |", quantity,
            csv_cell(csv, number_next(csv, 0, (const char *const[N_UNIT]){table, NULL, quantity}), N_UNIT));
    for (int d = 0; d < count; d++)
        fprintf(stream, " %s |", definitions[d]);
    fputs("\n|---|---|", stream);
    for (int d = 0; d < count; d++)
        fputs(d < count - 1 ? "---|" : "---|\n", stream);
    for (int k = 0; k < item_count; k++) {
        const int first = number_next(csv, 0, (const char *const[N_UNIT]){table, items[k], quantity});
        const double paper = number_of(csv, first, N_PAPER);
        fprintf(stream, isfinite(paper) ? "| %s | %.5g |" : "| %s | not printed |", items[k], paper);
        for (int d = 0; d < count; d++) {
            const int row = number_next(csv, 0, (const char *const[N_UNIT]){table, items[k], quantity, definitions[d]});
            const double ours = row < 0 ? NAN : number_of(csv, row, N_OURS);
            if (row >= 0)
                fprintf(stream, isfinite(ours) ? " %.5g" : " no value", ours);
            fprintf(stream, isfinite(ours - paper) ? " (%+.2g) |" : " |", ours - paper);
        }
        fputc('\n', stream);
    }
}

static enum status picture_copy(const struct pages *pages, const char *name)
{
    char path[4400], buffer[1 << 16];
    struct text_file copy;
    snprintf(path, sizeof path, "%s/%s", pages->from, name);
    FILE *picture = fopen(path, "rb");
    if (!picture)
        return status_set(STATUS_INVALID, "%s: cannot be read", path);
    enum status status = text_file_in(pages->to, name, &copy);
    if (status == STATUS_OK) {
        for (size_t size; (size = fread(buffer, 1, sizeof buffer, picture)) > 0;)
            fwrite(buffer, 1, size, copy.stream);
        status = text_file_close(&copy, STATUS_OK);
    }
    fclose(picture);
    return status;
}

/* Is it a picture of the table: figure-ID.png, figure-ID-SCENE-METHOD.png, or the phase study's of its receiver? */
static bool picture_is(const char *name, const struct paper_table *table)
{
    char begin[200];
    const char *extension = strrchr(name, '.');
    if (!extension || strcmp(extension, ".png") != 0)
        return false;
    for (const struct phase_figure *figure = phase_figures; figure->table; figure++)
        if (strcmp(figure->table, table->id) == 0) {
            phase_path(".", phase_setups[figure->setup], "-receiver", begin, sizeof begin);
            const size_t length = strlen(begin + strlen("./"));
            return strncmp(name, begin + strlen("./"), length) == 0
                   && (strcmp(name + length, "1.png") == 0) == !figure->last;
        }
    const size_t length = (size_t)snprintf(begin, sizeof begin, "figure-%s", table->id);
    return strncmp(name, begin, length) == 0 && strchr(".-", name[length]);
}

static enum status pictures_write(const struct pages *pages, const struct paper_table *table, FILE *stream)
{
    struct dirent **entries = NULL;
    const int count = scandir(pages->from, &entries, NULL, alphasort);
    enum status status = STATUS_OK;
    for (int k = 0; k < count; k++) {
        if (status == STATUS_OK && picture_is(entries[k]->d_name, table)) {
            status = picture_copy(pages, entries[k]->d_name);
            fprintf(stream, "\n![%s](%s)\n", table->title, entries[k]->d_name);
        }
        free(entries[k]);
    }
    free(entries);
    return status;
}

static enum status table_write(const struct pages *pages, const struct paper_table *table, FILE *stream)
{
    const char *quantities[TEXTS_MAX];
    const int count = names_of(&pages->numbers, table->id, NULL, N_QUANTITY, quantities);
    fprintf(stream, "\n## %s\n\n`./sasbench reproduce %s`. Assumed: ", table->title, table->id);
    shown_markdown(stream, table->assumption);
    fputs(".\n", stream);
    for (int q = 0; q < count; q++)
        quantity_write(&pages->numbers, table->id, quantities[q], stream);
    return pictures_write(pages, table, stream);
}

/* ---- a page ---- */

/* The claims with this verdict, a line each. */
static void listed_write(const struct pages *pages, const struct paper *paper, enum claim_verdict verdict,
                         const char *title, FILE *stream)
{
    bool begun = false;
    for (int k = 0; k < pages->claims->count; k++) {
        const struct claim *claim = &pages->claims->claims[k];
        if (strcmp(claim->paper, paper->name) != 0
            || strcmp(verdict_of(pages, claim, SCHEME_PRINTED), claim_verdict_names[verdict]) != 0)
            continue;
        if (!begun)
            fprintf(stream, "\n%s\n\n", title);
        begun = true;
        fprintf(stream, "- `%s`: ", claim->id);
        shown_markdown(stream, claim->claim);
        if (claim->by_scheme)
            fprintf(stream, " (corrected: %s)", verdict_of(pages, claim, SCHEME_CORRECTED));
        fputs(flips(pages, claim, SCHEME_PRINTED, NULL) > 0 ? "; another assumption changes it\n" : "\n", stream);
    }
}

/* A row of counts; of the corrected scheme, if the paper's claims depend on it. */
static void counts_write(const struct pages *pages, const struct paper *paper, enum scheme scheme, FILE *stream)
{
    int counts[CLAIM_VERDICTS] = {0}, total = 0;
    for (int k = 0; k < pages->claims->count; k++) {
        const struct claim *claim = &pages->claims->claims[k];
        if (strcmp(claim->paper, paper->name) != 0 || (scheme && !claim->by_scheme))
            continue;
        total++;
        for (int v = 0; v < CLAIM_VERDICTS; v++)
            counts[v] += strcmp(verdict_of(pages, claim, scheme), claim_verdict_names[v]) == 0;
    }
    if (total == 0)
        return;
    fprintf(stream, "| %s | %d |", scheme ? "those that depend on LBF21's scheme, corrected" : "as printed", total);
    for (int v = 0; v < CLAIM_VERDICTS; v++)
        fprintf(stream, " %d |", counts[v]);
    fputc('\n', stream);
}

static void head_write(const struct pages *pages, const struct paper *paper, FILE *stream)
{
    static const char *const keys[] = {"date", "commit", "machine", "isa", "load"};
    int changing = 0;
    fprintf(stream, "# %s beside our measurements\n\n%s.\n\nWritten by `./sasbench reproduce --docs`:\n\n", paper->name,
            paper->title);
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        const char *value = csv_comment(&pages->verdicts, keys[k]);
        fprintf(stream, "- %s: ", keys[k]);
        shown_markdown(stream, value ? value : "unknown");
        fputc('\n', stream);
    }
    fputs("\n## In short\n\n| | claims |", stream);
    for (int v = 0; v < CLAIM_VERDICTS; v++)
        fprintf(stream, " %s |", claim_verdict_names[v]);
    fputs("\n|---|---|---|---|---|---|---|\n", stream);
    for (enum scheme scheme = 0; scheme < SCHEMES; scheme++)
        counts_write(pages, paper, scheme, stream);
    for (int k = 0; k < pages->claims->count; k++)
        changing += strcmp(pages->claims->claims[k].paper, paper->name) == 0
                    && flips(pages, &pages->claims->claims[k], SCHEME_PRINTED, NULL) > 0;
    if (pages->assumptions.row_count > 0)
        fprintf(stream, "\n%d of the verdicts as printed change under another assumption", changing);
    else
        fputs("\nOther assumptions were not tried (`./sasbench reproduce sensitivity`)", stream);
    fputs(". [What the verdicts mean, and what the scenes assume](../papers.md).\n", stream);
    listed_write(pages, paper, CLAIM_FAILS, "What does not hold:", stream);
    listed_write(pages, paper, CLAIM_UNDECIDED, "What cannot be decided:", stream);
    nearness_write(pages, paper, stream);
}

static enum status page_write(const struct pages *pages, const struct paper *paper)
{
    char path[4400];
    struct text_file file;
    snprintf(path, sizeof path, "%s/%.*s.md", pages->to, (int)strcspn(paper->prefix, "_"), paper->prefix);
    enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    head_write(pages, paper, file.stream);
    for (const struct paper_table *table = paper_tables; table->id && status == STATUS_OK; table++)
        if (strncmp(table->id, paper->prefix, strlen(paper->prefix)) == 0)
            status = table_write(pages, table, file.stream);
    fputs("\n## Claims\n", file.stream);
    for (int k = 0; k < pages->claims->count; k++)
        if (strcmp(pages->claims->claims[k].paper, paper->name) == 0)
            claim_write(pages, &pages->claims->claims[k], file.stream);
    return text_file_close(&file, status);
}

static enum status input_read(const char *from, const char *name, const char *const *columns, struct csv *csv)
{
    char path[4400];
    snprintf(path, sizeof path, "%s/%s", from, name);
    enum status status = csv_read(path, CSV_TAIL_KEEP, csv);
    return status == STATUS_OK ? csv_columns(csv, columns, NULL) : status;
}

enum status pages_write(const char *from, const char *to, const struct claims *claims)
{
    struct pages pages = {.claims = claims, .from = from, .to = to};
    char path[4400];
    enum status status = input_read(from, "claims.csv", verdict_columns, &pages.verdicts);
    if (status == STATUS_OK)
        status = input_read(from, "reproduced.csv", number_columns, &pages.numbers);
    snprintf(path, sizeof path, "%s/sensitivity.csv", from);
    if (status == STATUS_OK && access(path, F_OK) == 0)
        status = input_read(from, "sensitivity.csv", assumption_columns, &pages.assumptions);
    for (int k = 0; k < claims->count && status == STATUS_OK; k++)
        if (row_of(&pages.verdicts, V_ID, claims->claims[k].id) < 0)
            status = status_set(STATUS_INVALID, "%s/claims.csv: %s is missing; --docs goes with all claims", from,
                                claims->claims[k].id);
    if (status == STATUS_OK)
        status = directory_make(to);
    for (int k = 0; k < PAPERS && status == STATUS_OK; k++)
        status = page_write(&pages, &papers[k]);
    csv_free(&pages.verdicts);
    csv_free(&pages.numbers);
    csv_free(&pages.assumptions);
    return status;
}
