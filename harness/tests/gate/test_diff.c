/* Two results are compared as diff.h says: what is compared how, which rows and files belong together, how it is
   shown. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "gate/diff.h"
#include "tests/support.h"

static int folder_remove_known(void **state)
{
    (void)state;
    static const char *const names[] = {"old.csv",
                                        "new.csv",
                                        "out.md",
                                        "out.json",
                                        "old/measurements.csv",
                                        "old/targets.csv",
                                        "new/measurements.csv",
                                        "new/targets.csv",
                                        "old",
                                        "new"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        remove(path_of(names[k]));
    return rmdir(folder); /* fails when a file was left behind */
}

static char *text_read(const char *name)
{
    static char text[1 << 17];
    FILE *file = fopen(path_of(name), "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    return text;
}

static const struct finding *find(const struct diff *diff, const char *metric)
{
    for (int k = 0; k < diff->finding_count; k++)
        if (strcmp(diff->findings[k].metric, metric) == 0)
            return &diff->findings[k];
    return NULL;
}

/* --- Results -------------------------------------------------------------------------------------------------- */

#define HEAD "# sasbench measurements 1\n# scene s: 0123\n" ROW_HEAD
#define ROW_HEAD                                                                                                       \
    "scene,algorithm,options,precision,threads,engine,status,reason,skipped,plan_s,run_s,run_min_s,runs,control_s,"    \
    "stages,flops_published,flops,pairs,bytes,error,error_gain,phase_rms_rad,width_m,pslr_db,islr_db,"                 \
    "run_q1_s,run_q3_s,entropy,contrast,peak_over_median\n"
#define TARGET_HEAD                                                                                                    \
    "# sasbench targets 1\n"                                                                                           \
    "scene,algorithm,options,precision,target,axis,definition,extent_m,position_error_m,phase_error_rad,width_m,"      \
    "pslr_db,islr_db\n"
#define ROW                                                                                                            \
    "s,a,beta=8,float,2,general,ok,,,0.1,1,0.9,5,2,focus=1,1e6,1e6,1000,4096,0.1,0.05,0.01,0.04,-13.3,-10.4,,,,,\n"

static void compare_texts(const char *old, const char *new, struct diff *diff)
{
    support_write("old.csv", old);
    support_write("new.csv", new);
    enum status status = diff_results(path_of("old.csv"), path_of("new.csv"), diff);
    if (status != STATUS_OK)
        fail_msg("%s", status_message());
}

static const struct {
    const char *before, *after; /* what is put in place of it in the row */
    const char *metric;         /* of the finding that is not the same; NULL: all are */
    enum verdict verdict;
} changes[] = {
    {",0.1,0.05,", ",0.10009,0.05,", NULL, VERDICT_SAME},
    {",0.1,0.05,", ",0.1002,0.05,", "error", VERDICT_WORSE},
    {",0.1,0.05,", ",0.0998,0.05,", "error", VERDICT_BETTER},
    {",0.1,0.05,", ",,0.05,", "error", VERDICT_GONE},
    {"1000,4096", "1001,4096", "pairs", VERDICT_WORSE}, /* neither way is better: any change is to be seen */
    {"1000,4096", "999,4096", "pairs", VERDICT_WORSE},
    {"1000,4096", "1000,4095", "bytes", VERDICT_BETTER},
    {"1e6,1e6,", "1e6,1000001,", "flops", VERDICT_WORSE},
    {"1e6,1e6,", "1000001,1e6,", "flops_published", VERDICT_WORSE},
    {"-13.3", "-13.297", "pslr_db", VERDICT_WORSE},
    {"-13.3", "-13.299", NULL, VERDICT_SAME},
    {"-10.4", "-10.41", "islr_db", VERDICT_BETTER},
    {"-10.4", "-10.5", "islr_db", VERDICT_CHANGED}, /* a fault may flatter */
    {"-10.4", "10.4", "islr_db", VERDICT_WORSE},
    {"1000,4096", "1000,4000", "bytes", VERDICT_CHANGED},
    {"0.04,", "0.0401,", "width_m", VERDICT_WORSE},
    {",ok,,", ",failed,no memory,", "status", VERDICT_WORSE},
    {",ok,,", ",unsupported,,", "status", VERDICT_WORSE},
    {"s,a,", "s,b,", "row", VERDICT_GONE},
    {"beta=8", "beta=9", "row", VERDICT_GONE},
    {",1,0.9,", ",1.6,1.5,", NULL, VERDICT_SAME}, /* two runs cannot tell less than a factor */
    {",1,0.9,", ",1.98,1.8,", NULL, VERDICT_SAME},
    {",1,0.9,", ",2.2,1.9,", "run_s", VERDICT_WORSE},
    {",1,0.9,", ",2.2,1.0,", NULL, VERDICT_SAME},       /* the least time says otherwise */
    {",1,0.9,5,2,", ",3,2.7,5,6,", NULL, VERDICT_SAME}, /* a slower machine: the control took as much longer */
    {",1,0.9,5,2,", ",3,9,5,6,", NULL, VERDICT_SAME},   /* of the median alone */
    {",1,0.9,5,2,", ",0.4,0.3,5,2,", "run_s", VERDICT_BETTER},
    {"float,2,", "float,1,", NULL, VERDICT_SAME},
    {",0.1,1,0.9,5,2,", ",,,,,,", NULL, VERDICT_SAME}, /* a baseline has no times */
};

static void values_are_compared_by_the_metric_table(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof changes / sizeof *changes; k++) {
        char old[2048], new[2048];
        struct diff diff;
        snprintf(old, sizeof old, HEAD ROW);
        const char *at = strstr(ROW, changes[k].before);
        assert_non_null(at);
        snprintf(new, sizeof new, HEAD "%.*s%s%s", (int)(at - ROW), ROW, changes[k].after,
                 at + strlen(changes[k].before));
        compare_texts(old, new, &diff);
        for (int n = 0; n < diff.note_count; n++)
            if (strstr(diff.notes[n], "a row alone is compared"))
                assert_non_null(strstr(diff.notes[n], "beyond a factor of 2,"));
        const struct finding *changed = NULL;
        for (int n = diff.finding_count - 1; n >= 0; n--)
            if (diff.findings[n].verdict != VERDICT_SAME)
                changed = &diff.findings[n];
        bool fails = changes[k].metric
                     && (changes[k].verdict == VERDICT_WORSE || changes[k].verdict == VERDICT_GONE
                         || changes[k].verdict == VERDICT_CHANGED);
        if ((changed != NULL) != (changes[k].metric != NULL) || (diff_status(&diff) != STATUS_OK) != fails
            || (changed && (strcmp(changed->metric, changes[k].metric) != 0 || changed->verdict != changes[k].verdict)))
            fail_msg("%s -> %s: %s %s", changes[k].before, changes[k].after, changed ? changed->metric : "",
                     changed ? verdict_names[changed->verdict] : "nothing");
        diff_free(&diff);
    }
}

/* Small betterments in five rows; then a row that is no longer refused. Only a baseline asks for a new one. */
static void many_betterments_are_a_change(void **state)
{
    (void)state;
    static const char row[] = "s,a,beta=%d,float,2,,ok,,,,,,,,,,,,,%s,,,,,,,,,,\n";
    for (int rows = 4; rows <= 5; rows++) {
        char old[4096] = HEAD, new[4096] = HEAD;
        struct diff diff;
        for (int k = 0; k < rows; k++) {
            snprintf(old + strlen(old), sizeof old - strlen(old), row, k, "0.1");
            snprintf(new + strlen(new), sizeof new - strlen(new), row, k, "0.0998");
        }
        compare_texts(old, new, &diff);
        assert_int_equal(diff.counts[CLASS_QUALITY][rows == 5 ? VERDICT_CHANGED : VERDICT_BETTER], rows);
        assert_int_equal(diff_status(&diff), rows == 5 ? STATUS_FAILED : STATUS_OK);
        if (rows == 5)
            assert_non_null(strstr(status_message(), "0 worse, 0 gone, 5 changed for the better: where that is meant, "
                                                     "./sasbench baseline writes a new baseline"));
        diff_free(&diff);
    }
    for (int measured = 0; measured < 2; measured++) {
        struct diff diff;
        char old[4096];
        snprintf(old, sizeof old, "%s%s", HEAD, "s,a,,float,2,,unsupported,why,,,,,,,,,,,,,,,,,,,,,,\n");
        if (measured)
            memcpy(strstr(old, "# scene s: 0123"), "# program: 0123", 15);
        compare_texts(old, HEAD "s,a,,float,2,,ok,,,,,,,,,,,,,1,,,,,,,,,,\n", &diff);
        assert_int_equal(find(&diff, "status")->verdict, VERDICT_CHANGED);
        assert_int_equal(diff_status(&diff), measured ? STATUS_OK : STATUS_FAILED);
        diff_free(&diff);
    }
}

/* Names that continue another with signs below and above ':' and ' ', and names with colons of their own. */
static void scenes_are_told_apart_whatever_they_are_called(void **state)
{
    (void)state;
    static const char *const names[] = {"far", "far2", "far!", "far far", "far:", "far: 1", "farz", "fa", "far/3", "-"};
    enum { NAMES = sizeof names / sizeof *names };
    for (int changed = 0; changed < NAMES; changed++) {
        char texts[2][8192];
        struct diff diff;
        const char *columns = strstr(HEAD, "scene,");
        for (int side = 0; side < 2; side++) {
            char *text = texts[side];
            size_t size = sizeof texts[side];
            snprintf(text, size, "# sasbench measurements 1\n");
            for (int k = 0; k < NAMES; k++)
                snprintf(text + strlen(text), size - strlen(text), "# scene %s: %016x\n", names[k],
                         16 * k + (side == 1 && k == changed));
            snprintf(text + strlen(text), size - strlen(text), "%s", columns);
            for (int k = 0; k < NAMES; k++)
                snprintf(text + strlen(text), size - strlen(text), "%s,a,,float,2,,ok,,,,,,,,,,,,,1,,,,,,,,,,\n",
                         names[k]);
        }
        compare_texts(texts[0], texts[1], &diff);
        const struct finding *gone = find(&diff, "row");
        if (!gone || gone->verdict != VERDICT_GONE || strcmp(gone->scene, names[changed]) != 0
            || diff.counts[CLASS_QUALITY][VERDICT_GONE] != 1 || diff.counts[CLASS_QUALITY][VERDICT_NEW] != 1)
            fail_msg("a change of scene '%s' is not seen, or another's is", names[changed]);
        diff_free(&diff);
    }
}

static void rounding_of_float_is_no_change_but_of_double(void **state)
{
    (void)state;
    struct diff diff;
    static const char *const row = HEAD "s,a,,%s,2,,ok,,,,,,,,,,,,,%s,,,,,,,,,,\n";
    for (int is_double = 0; is_double < 2; is_double++) {
        char old[1024], new[1024];
        snprintf(old, sizeof old, row, is_double ? "double" : "float", "4e-10");
        snprintf(new, sizeof new, row, is_double ? "double" : "float", "3e-8");
        compare_texts(old, new, &diff);
        assert_int_equal(find(&diff, "error")->verdict, is_double ? VERDICT_WORSE : VERDICT_SAME);
        diff_free(&diff);
    }
}

static void rows_of_another_scene_content_are_not_compared(void **state)
{
    (void)state;
    struct diff diff;
    char new[2048];
    snprintf(new, sizeof new, "%s", HEAD ROW);
    memcpy(strstr(new, "0123"), "0124", 4);
    compare_texts(HEAD ROW, new, &diff);
    assert_int_equal(diff.counts[CLASS_QUALITY][VERDICT_GONE], 1);
    assert_int_equal(diff.counts[CLASS_QUALITY][VERDICT_NEW], 1);
    assert_int_equal(diff.finding_count, 2);
    assert_non_null(strstr(diff.notes[2], "scene s has another content"));
    diff_free(&diff);
}

/* Folders: measurements and targets; a target is named, and not reported again when its measurement is. */
static void folders_are_compared_with_their_targets(void **state)
{
    (void)state;
    struct diff diff;
    mkdir(path_of("old"), 0777);
    mkdir(path_of("new"), 0777);
    support_write("old/measurements.csv", HEAD ROW "s,b,,float,2,,ok,,,,,,,,,,,,,1,,,,,,,,,,\n");
    support_write("new/measurements.csv", HEAD ROW "s,b,,float,2,,failed,why,,,,,,,,,,,,,,,,,,,,,,\n");
    support_write("old/targets.csv", TARGET_HEAD "s,a,beta=8,float,0,azimuth,null,3,-1e-3,0,0.04,-13,-10\n"
                                                 "s,b,,float,0,azimuth,null,3,0,0,0.04,-13,-10\n");
    support_write("new/targets.csv", TARGET_HEAD "s,a,beta=8,float,0,azimuth,null,3,2e-3,0,0.04,-13,-10\n");
    assert_int_equal(diff_results(path_of("old"), path_of("new"), &diff), STATUS_OK);
    const struct finding *position = find(&diff, "position_error_m"), *status = find(&diff, "status");
    assert_int_equal(position->verdict, VERDICT_WORSE);
    assert_string_equal(position->detail, "target 1, azimuth, null");
    assert_int_equal(status->verdict, VERDICT_WORSE);
    assert_string_equal(status->after_text, "failed: why");
    assert_int_equal(diff.counts[CLASS_QUALITY][VERDICT_WORSE], 2);
    assert_int_equal(diff.counts[CLASS_QUALITY][VERDICT_GONE], 0);
    assert_null(find(&diff, "row"));
    diff_free(&diff);
    /* A file is compared with the folder's file of its kind. */
    assert_int_equal(diff_results(path_of("old/targets.csv"), path_of("new"), &diff), STATUS_OK);
    assert_non_null(find(&diff, "position_error_m"));
    assert_int_equal(diff.counts[CLASS_QUALITY][VERDICT_GONE], 1);
    diff_free(&diff);
    remove(path_of("new/targets.csv"));
    assert_int_equal(diff_results(path_of("old"), path_of("new"), &diff), STATUS_INVALID);
    assert_non_null(strstr(status_message(), "new/targets.csv"));
    diff_free(&diff);
}

/* What an image without targets is compared by. */
static void sharpness_is_compared(void **state)
{
    (void)state;
    struct diff diff;
    compare_texts(HEAD "s,a,,float,2,,ok,,,,,,,,,,,,,1,,,,,,,,5,2,80\n",
                  HEAD "s,a,,float,2,,ok,,,,,,,,,,,,,1,,,,,,,,5.1,2,80\n", &diff);
    assert_int_equal(find(&diff, "entropy")->verdict, VERDICT_WORSE);
    assert_int_equal(find(&diff, "contrast")->verdict, VERDICT_SAME);
    diff_free(&diff);
}

static void malformed_and_mixed_files_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says[3];
    } cases[] = {
        {"", {"new.csv:1", "# sasbench measurements 1"}},
        {"scene,algorithm\n", {"new.csv:1", "the first line is ''", "is needed"}},
        {"# sasbench measurements 2\nscene\n", {"new.csv:1", "sasbench measurements 2", "is needed"}},
        {"# sasbench measurements 1\nscene,algorithm,settings\n", {"new.csv", "column 3 is 'settings'", "'options'"}},
        {HEAD "s,a,\n", {"new.csv:4", "3 fields", "30"}},
        {HEAD ROW "\"s,a", {"new.csv:5", "never ends"}},
        {HEAD "s,a,,float,2,,ok,,,x,,,,,,,,,,,,,,,,,,,,\n", {"new.csv:4", "plan_s is 'x'", "a number"}},
        {HEAD "s,a,,float,2,,ok,,,,,,,,,,,,,nan,,,,,,,,,,\n", {"new.csv:4", "error is 'nan'", "finite"}},
        {HEAD "s,a,,float,2,,ok,,,,,,,,,,inf,,,,,,,,,,,,,\n", {"new.csv:4", "flops is 'inf'", "finite"}},
        {HEAD "s,a,,float,2,,fine,,,,,,,,,,,,,,,,,,,,,,,\n", {"new.csv:4", "status is 'fine'", "unsupported"}},
        {HEAD "s,a,,float,2.5,,ok,,,,,,,,,,,,,,,,,,,,,,,\n", {"new.csv:4", "threads is '2.5'", "whole"}},
        {HEAD ROW ROW, {"new.csv:5", "line 4", "once"}},
        {TARGET_HEAD, {"old.csv holds measurements", "new.csv holds targets", "same kind"}},
    };
    support_write("old.csv", HEAD ROW);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct diff diff;
        support_write("new.csv", cases[k].text);
        assert_int_equal(diff_results(path_of("old.csv"), path_of("new.csv"), &diff), STATUS_INVALID);
        for (int s = 0; s < 3 && cases[k].says[s]; s++)
            if (!strstr(status_message(), cases[k].says[s]))
                fail_msg("case %zu: '%s' does not say '%s'", k, status_message(), cases[k].says[s]);
        diff_free(&diff);
    }
}

static void many_rows(void **state)
{
    (void)state;
    enum { ROWS = 10000 };
    for (int side = 0; side < 2; side++) {
        FILE *file = fopen(path_of(side ? "new.csv" : "old.csv"), "w");
        assert_non_null(file);
        fputs(HEAD, file);
        for (int k = 0; k < ROWS; k++) {
            int n = side ? ROWS - 1 - k : k;
            fprintf(file,
                    "s%d,a,beta=%d,float,2,general,ok,,,0.1,1,0.9,5,2,focus=1,1e6,1e6,1000,4096,%s,0.05,0.01,0.04,"
                    "-13.3,-10.4,,,,,\n",
                    n % 50, n, side && n == 5000 ? "0.2" : "0.1");
        }
        assert_int_equal(fclose(file), 0);
    }
    struct diff diff;
    assert_int_equal(diff_results(path_of("old.csv"), path_of("new.csv"), &diff), STATUS_OK);
    assert_int_equal(diff.finding_count, ROWS * 11);
    assert_int_equal(diff.counts[CLASS_QUALITY][VERDICT_WORSE], 1);
    assert_int_equal(diff_status(&diff), STATUS_FAILED);
    diff_free(&diff);
}

static void shown_as_text_markdown_and_json(void **state)
{
    (void)state;
    struct diff diff;
    char text[4096] = "";
    compare_texts(HEAD ROW,
                  HEAD "s,a,beta=8,float,2,general,ok,,,0.1,1,0.9,5,2,focus=1,1e6,1e6,1000,4096,0.15,0.05,0.01,0.04,"
                       "-13.2,-10.4,,,,,\n\"t|\"\"x\",a,,double,,,ok,,,,,,,,,,,,,1,,,,,,,,,,\n",
                  &diff);
    FILE *stream = fmemopen(text, sizeof text - 1, "w");
    diff_print(&diff, stream);
    fclose(stream);
    assert_non_null(strstr(text, "worse, quality of a:beta=8: 2 values, error, pslr_db on s\n"));
    assert_non_null(strstr(text, "  error                     0.1        0.15       +50 %  s a:beta=8\n"));
    assert_non_null(strstr(text, "  pslr_db                 -13.3       -13.2     +0.1 dB  s a:beta=8\n"));
    assert_non_null(strstr(text, "new, "));
    assert_non_null(strstr(text, "something got worse\n"));
    assert_int_equal(diff_markdown(&diff, path_of("out.md")), STATUS_OK);
    assert_non_null(strstr(text_read("out.md"), "| worse | error | 0.1 | 0.15 | +50 % | s | a:beta=8 |\n"));
    assert_non_null(strstr(text_read("out.md"), "| t\\|\"x | a:precision=double |\n"));
    assert_non_null(strstr(text_read("out.md"), "| worse | a:beta=8 | 2 | error, pslr_db on s | 0.1 | 0.15 | +50 % |"));
    assert_int_equal(diff_json(&diff, path_of("out.json")), STATUS_OK);
    assert_non_null(strstr(text_read("out.json"), "{\"name\": \"s a:beta=8 error\", \"unit\": \"1\", \"value\": 0.15, "
                                                  "\"range\": \"0.0001\"}"));
    assert_null(strstr(text_read("out.json"), "pairs"));
    diff_free(&diff);
}

/* What a file from elsewhere holds must neither command the terminal nor act in a comment. */
static void names_are_shown_without_effect(void **state)
{
    (void)state;
    static const char *const live[] = {"@some", "<img", "![x]",     "](http", "http://", "www.x",
                                       "#12",   "\x1b", "\xc2\x9b", "`id",    "||"};
    struct diff diff;
    char text[1 << 14] = "";
    compare_texts("# sasbench measurements 1\n# commit: @some/one ![x](http://x/y.png) <img src=x>\n"
                  "# machine: www.x.org #12 `id` ||\n" ROW_HEAD,
                  HEAD "\"@someone <img> ![x](http://x) www.x.org #12 a||b \\| \xff `id`\",a,,float,2,,failed,@some,"
                       ",,,,,,,,,,,,,,,,,,,,,\n",
                  &diff);
    assert_int_equal(diff_markdown(&diff, path_of("out.md")), STATUS_OK);
    const char *markdown = text_read("out.md");
    for (size_t k = 0; k < sizeof live / sizeof *live; k++)
        for (const char *at = markdown; (at = strstr(at, live[k])); at++)
            if (at[-1] != '\\')
                fail_msg("'%s' is in the comment: %s", live[k], markdown);
    assert_non_null(strstr(
        markdown, "@&#8203;someone &lt;img&gt; !\\[x\\](http&#58;//x) www&#46;x.org #&#8203;12 a\\|\\|b \\\\\\| ? "));
    FILE *stream = fmemopen(text, sizeof text - 1, "w");
    struct finding odd = {.verdict = VERDICT_GONE,
                          .scene = "a\x1b[31mb\xc2\x9b"
                                   "c\xff\u202e",
                          .spec = "\t",
                          .detail = "\x7f",
                          .metric = "row",
                          .unit = "",
                          .before = NAN,
                          .after = NAN,
                          .change = NAN,
                          .slack = NAN,
                          .before_text = "\x1b]0;x",
                          .after_text = ""};
    assert_int_equal(diff_add(&diff, &odd), STATUS_OK);
    assert_int_equal(diff_note(&diff, "\x1b[2J"), STATUS_OK);
    diff_print(&diff, stream);
    fclose(stream);
    assert_non_null(strstr(text, "a?[31mb??c???? ? ?\n"));
    for (const char *at = text; *at; at++)
        assert_true(*at == '\n' || ((unsigned char)*at >= ' ' && *at != 0x7f));
    assert_non_null(strstr(text, "?[2J\n"));
    odd.lower_is_better = true;
    odd.after = 1;
    assert_int_equal(diff_add(&diff, &odd), STATUS_OK);
    assert_int_equal(diff_json(&diff, path_of("out.json")), STATUS_OK);
    assert_non_null(strstr(text_read("out.json"), "a\\ufffd[31mb\\ufffd\\ufffdc\\ufffd"));
    assert_int_equal(diff_markdown(&diff, path_of("out.md")), STATUS_OK);
    assert_non_null(strstr(text_read("out.md"), "b??c????"));
    diff_free(&diff);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, folder_make, folder_remove_known)

int main(void)
{
    const struct CMUnitTest tests[] = {
        IN_FOLDER(values_are_compared_by_the_metric_table),
        IN_FOLDER(many_betterments_are_a_change),
        IN_FOLDER(scenes_are_told_apart_whatever_they_are_called),
        IN_FOLDER(rounding_of_float_is_no_change_but_of_double),
        IN_FOLDER(rows_of_another_scene_content_are_not_compared),
        IN_FOLDER(folders_are_compared_with_their_targets),
        IN_FOLDER(sharpness_is_compared),
        IN_FOLDER(malformed_and_mixed_files_are_refused),
        IN_FOLDER(many_rows),
        IN_FOLDER(shown_as_text_markdown_and_json),
        IN_FOLDER(names_are_shown_without_effect),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
