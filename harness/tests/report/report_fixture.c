/* Made-up rows, and the parser of pages (report_fixture.h). */
#include "tests/report/report_fixture.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "results/results_folder.h"
#include "tests/support.h"

struct measurement row_of(const char *scene, const char *algorithm, const char *options, double run_s, double error)
{
    return (struct measurement){.scene = scene,
                                .algorithm = algorithm,
                                .options = options,
                                .precision = "float",
                                .threads = 2,
                                .engine = "invariant",
                                .status = "ok",
                                .reason = "",
                                .skipped = "",
                                .plan_s = 0.01,
                                .run_s = run_s,
                                .run_min_s = run_s,
                                .runs = 3,
                                .control_s = 1,
                                .stages = "",
                                .flops_published = NAN,
                                .flops = 1e9 * run_s,
                                .pairs = 1e6,
                                .bytes = 1e6,
                                .error = error,
                                .error_gain = error,
                                .phase_rms_rad = error,
                                .width_m = 0.04,
                                .pslr_db = -13.3 - error,
                                .islr_db = -10.4 - error,
                                .run_q1_s = NAN,
                                .run_q3_s = NAN,
                                .entropy = 5,
                                .contrast = 2,
                                .peak_over_median = 80};
}

void record_rows(const struct measurement *rows, int count)
{
    struct provenance provenance = {
        .machine = "a machine & its <cores>", .commit = "abc", .program = "def", .date = "2026-01-01", .threads = 2};
    struct results_folder *results;
    assert_int_equal(results_folder_open(folder, &provenance, &results), STATUS_OK);
    for (int k = 0; k < count; k++) {
        assert_int_equal(results_folder_scene(results, rows[k].scene, 1), STATUS_OK);
        assert_int_equal(results_folder_add(results, &rows[k]), STATUS_OK);
    }
    results_folder_close(results);
}

static void parse_failed(const struct parser *parser, const char *fault)
{
    fail_msg("%s, at: %.80s", fault, parser->at);
}

static void parse_name(struct parser *parser, char name[32])
{
    size_t length = strspn(parser->at, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789:-");
    if (length == 0 || length > 31)
        parse_failed(parser, "no name of an element or attribute");
    snprintf(name, 32, "%.*s", (int)length, parser->at);
    parser->at += length;
}

/* A link may lead to a PNG file in the folder of the page. */
static bool is_picture_beside(const char *value, const char *end)
{
    const size_t length = (size_t)(end - value);
    return length > 4 && memcmp(end - 4, ".png", 4) == 0 && *value != '.'
           && strspn(value, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.%") >= length;
}

/* One `NAME="VALUE"`: nothing may come from outside, no two elements may have one name. */
static void parse_attribute(struct parser *parser)
{
    char name[32];
    parse_name(parser, name);
    char quote = parser->at[0] == '=' ? parser->at[1] : '\0';
    if (quote != '"' && quote != '\'')
        parse_failed(parser, "an attribute without quotes");
    const char *value = parser->at + 2, *end = strchr(value, quote);
    if (!end || memchr(value, '<', (size_t)(end - value)))
        parse_failed(parser, "a value that is not closed");
    bool link = strcmp(name, "href") == 0 || strcmp(name, "xlink:href") == 0;
    if ((link && *value != '#' && !is_picture_beside(value, end))
        || (strcmp(name, "src") == 0 && strncmp(value, "data:image/png;base64,", 22) != 0
            && strncmp(value, "data:image/jpeg;base64,", 23) != 0)
        || strncmp(name, "on", 2) == 0)
        parse_failed(parser, "something from outside");
    if (strcmp(name, "id") == 0) {
        assert_true(parser->id_count < IDS_MAX);
        char *id = parser->ids[parser->id_count];
        snprintf(id, sizeof parser->ids[0], "%.*s", (int)(end - value), value);
        for (int k = 0; k < parser->id_count; k++)
            if (strcmp(parser->ids[k], id) == 0)
                parse_failed(parser, "a second element of this name");
        parser->id_count++;
    }
    parser->at = end + 1;
}

static void parse_element(struct parser *parser)
{
    char name[32];
    if (strncmp(parser->at, "<!--", 4) == 0) {
        const char *end = strstr(parser->at, "-->");
        if (!end)
            parse_failed(parser, "a comment without an end");
        parser->at = end + 3;
        return;
    }
    if (parser->at[1] == '/') {
        parser->at += 2;
        parse_name(parser, name);
        if (parser->depth == 0 || strcmp(parser->open[parser->depth - 1], name) != 0 || *parser->at != '>')
            parse_failed(parser, "an end of another element");
        parser->depth--;
        parser->at++;
        return;
    }
    parser->at++;
    parse_name(parser, name);
    parser->tables += strcmp(name, "table") == 0;
    parser->rows += strcmp(name, "tr") == 0;
    parser->drawings += strcmp(name, "svg") == 0;
    parser->images += strcmp(name, "img") == 0;
    parser->scripts += strcmp(name, "script") == 0;
    if (parser->scripts > 1)
        parse_failed(parser, "a second script");
    for (;;) {
        parser->at += strspn(parser->at, " \n\t\r");
        if (*parser->at == '>' || strncmp(parser->at, "/>", 2) == 0)
            break;
        parse_attribute(parser);
    }
    if (*parser->at == '/') {
        parser->at += 2;
        return;
    }
    parser->at++;
    assert_true(parser->depth < DEPTH_MAX);
    snprintf(parser->open[parser->depth++], sizeof parser->open[0], "%s", name);
    if (strcmp(name, "style") == 0 || strcmp(name, "script") == 0)
        parser->at += strcspn(parser->at, "<");
}

struct parser *page_parse(const char *html)
{
    static const char doctype[] = "<!DOCTYPE html>\n";
    struct parser *parser = calloc(1, sizeof *parser);
    assert_non_null(parser);
    assert_memory_equal(html, doctype, strlen(doctype));
    for (parser->at = html + strlen(doctype); *parser->at;) {
        if (*parser->at == '<') {
            parse_element(parser);
        } else if (*parser->at == '&') {
            size_t length = strspn(parser->at + 1, "#abcdefghijklmnopqrstuvwxyz0123456789");
            if (length == 0 || parser->at[length + 1] != ';')
                parse_failed(parser, "a bare &");
            parser->at += length;
        } else {
            if (parser->depth == 0 && !isspace((unsigned char)*parser->at))
                parse_failed(parser, "text outside of the page");
            parser->at++;
        }
    }
    assert_int_equal(parser->depth, 0);
    return parser;
}
