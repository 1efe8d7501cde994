/* Results from elsewhere: whatever a folder holds, and whatever it is called, reporting on it starts no command, waits
   for nobody and shows no other file. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "show/plot.h"
#include "report/report.h"
#include "text/shown_text.h"
#include "tests/support.h"

#define PLOTS SASBENCH_ROOT "/plots"
#define ROW_HEAD                                                                                                       \
    "scene,algorithm,options,precision,threads,engine,status,reason,skipped,plan_s,run_s,run_min_s,runs,control_s,"    \
    "stages,flops_published,flops,pairs,bytes,error,error_gain,phase_rms_rad,width_m,pslr_db,islr_db,"                 \
    "run_q1_s,run_q3_s,entropy,contrast,peak_over_median\n"
#define SLOPES_HEAD                                                                                                    \
    "scene,algorithm,options,precision,setting,part,first,last,rate_first,rate_last,points,slope,"                     \
    "error_first,error_last,residual_log10\n"
#define RULES_HEAD "scene,fc_hz,fs_hz,bandwidth_hz,bp22_eq20_rate,zp15_rate,edge_phase_rad,linear_floor\n"

/* Every command touches the canary in the working folder, which is the test's own. */
static const char canary[] = "PWNED";
static const char *const payloads[] = {"`touch PWNED`",
                                       "$(touch PWNED)",
                                       "system('touch PWNED')",
                                       "'.system('touch PWNED').'",
                                       "\".system('touch PWNED').\"",
                                       "\\\".system('touch PWNED').\\\"",
                                       "''.system('touch PWNED').''",
                                       "'; system('touch PWNED') #",
                                       "!touch PWNED",
                                       "|touch PWNED;#",
                                       "<touch PWNED;#",
                                       "'; touch PWNED; '",
                                       "@PWNED",
                                       "\\047.system('touch PWNED').\\047",
                                       "{/Symbol a}^{b}_c &{x} @{y}",
                                       "%s%n%d\\n",
                                       "-f",
                                       "$rows",
                                       "=touch PWNED"};
enum { PAYLOADS = sizeof payloads / sizeof *payloads };
/* With control characters: refused where they are read. */
static const char *const broken[] = {"x\n!touch PWNED\n#",         "3\nEND\nsystem('touch PWNED')\n#",
                                     "x\rsystem('touch PWNED')",   "x\tsystem('touch PWNED')",
                                     "x\\\nsystem('touch PWNED')", "x\x1b[31m"};
enum { BROKEN = sizeof broken / sizeof *broken };

static int work_folder(void **state)
{
    return folder_make(state) || chdir(folder);
}

static int work_folder_end(void **state)
{
    return chdir("/") || folder_remove(state);
}

/* A field between quotes. */
static void field_write(FILE *file, const char *text)
{
    fputc('"', file);
    for (; *text; text++) {
        if (*text == '"')
            fputc('"', file);
        fputc(*text, file);
    }
    fputc('"', file);
}

static FILE *file_begin(const char *directory, const char *name)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    return file;
}

static void fields_write(FILE *file, const char *const *texts, int count, const char *rest)
{
    for (int k = 0; k < count; k++) {
        field_write(file, texts[k]);
        fputc(',', file);
    }
    fputs(rest, file);
}

/* A folder with the text wherever a text can be, and in the numbers of the tables that are not ours to judge. */
static void results_fill(const char *directory, const char *scene, const char *text, const char *number)
{
    FILE *file = file_begin(directory, "measurements.csv");
    fprintf(file, "# sasbench measurements 1\n");
    if (!strchr(text, '\n'))
        fprintf(file, "# machine: %s\n# commit: %s\n# threads: %s\n# scene %s: %s\n", text, text, text, text, text);
    fputs(ROW_HEAD, file);
    fields_write(file, (const char *[]){scene, "reference", "", "float"}, 4,
                 "1,inv,ok,,,0.1,1,0.1,3,0.5,focus=1,1,2e6,3,4,1e-06,0.1,0.1,0.04,-13,-10,,,,,\n");
    for (int k = 2; k < 5; k++) {
        char options[2048];
        snprintf(options, sizeof options, "beta=%d,x=%s", k, text);
        fields_write(file, (const char *[]){scene, "bp_linear", options, "float"}, 4,
                     "1,inv,ok,,,0.1,0.2,0.1,3,0.5,focus=1,1,2e6,3,4,0.01,0.1,0.1,0.04,-12,-9,,,,,\n");
        fields_write(file, (const char *[]){scene, text, options, text}, 4,
                     "1,inv,ok,,,0.1,0.2,0.1,3,0.5,focus=1,1,2e6,3,4,0.01,0.1,0.1,0.04,-12,-9,,,,,\n");
    }
    fields_write(file, (const char *[]){scene, "rma_lbf", text, "double"}, 4,
                 "1,inv,failed,because,,,,,,,,,,,,,,,,,,,,,,\n");
    assert_int_equal(fclose(file), 0);

    file = file_begin(directory, "slopes.csv");
    fputs(SLOPES_HEAD, file);
    fields_write(file,
                 (const char *[]){scene, "bp_linear", text, "float", "beta", "finest", "2", "4", number, number, number,
                                  number, number, number, number},
                 14, "0.1\n");
    assert_int_equal(fclose(file), 0);

    file = file_begin(directory, "rules.csv");
    fputs(RULES_HEAD, file);
    fields_write(file, (const char *[]){scene, number, number, number, number, number, number}, 7, "1\n");
    assert_int_equal(fclose(file), 0);
}

/* The scripts by hand, as they say at their head. */
static void plot_by_hand(const char *script, const char *directory)
{
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        char path[1024], plots[2048];
        snprintf(path, sizeof path, "%s/%s.gp", PLOTS, script);
        snprintf(plots, sizeof plots, "plots=%s", gnuplot_text(PLOTS));
        if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr))
            _exit(126);
        execlp("gnuplot", "gnuplot", "-e", plots, "-c", path, directory, (char *)NULL);
        _exit(127);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) < 126);
}

static void assert_no_canary(const char *what, const char *payload)
{
    if (access(canary, F_OK) == 0)
        fail_msg("%s ran what a folder holds: %s", what, payload);
}

static void texts_are_no_commands(void **state)
{
    (void)state;
    for (int k = 0; k < PAYLOADS; k++) {
        char directory[300], name[200];
        snprintf(name, sizeof name, "./%s", payloads[k]);
        snprintf(directory, sizeof directory, "%s", strchr(payloads[k], '/') ? "./plain" : name);
        assert_int_equal(mkdir(directory, 0777), 0);
        results_fill(directory, payloads[k], payloads[k], payloads[k]);
        const char *given = directory[2] == '-' ? directory : directory + 2;
        if (report_write(given) != STATUS_OK)
            fail_msg("%s: %s", payloads[k], status_message());
        assert_no_canary("report", payloads[k]);
        int undrawn = 0;
        char picture[1024];
        assert_int_equal(plot_results(given, NULL, &undrawn), STATUS_OK);
        assert_int_equal(plot_results(given, payloads[k], &undrawn), STATUS_OK);
        assert_int_equal(undrawn, 0);
        assert_no_canary("a script of plots/", payloads[k]);
        picture_path(given, payloads[k], "upsampling.svg", picture, sizeof picture);
        if (access(picture, R_OK) != 0)
            fail_msg("%s: no picture %s", payloads[k], picture);
        picture_path(given, payloads[k], "error_time.png", picture, sizeof picture);
        if (access(picture, R_OK) != 0)
            fail_msg("%s: no picture %s", payloads[k], picture);
    }
}

static void control_characters_are_refused(void **state)
{
    (void)state;
    for (int k = 0; k < BROKEN; k++)
        for (int place = 0; place < 3; place++) {
            assert_int_equal(mkdir("results", 0777), 0);
            results_fill("results", place == 0 ? broken[k] : "a", place == 1 ? broken[k] : "b",
                         place == 2 ? broken[k] : "1");
            assert_int_equal(report_write("results"), STATUS_INVALID);
            assert_non_null(strstr(status_message(), ".csv:"));
            int undrawn = 0;
            assert_true(plot_results("results", "a", &undrawn) == STATUS_INVALID || undrawn > 0);
            assert_no_canary("a broken line", broken[k]);
            assert_int_equal(system("rm -r results"), 0);
        }
}

/* A folder's name in front of the one CSV and of the picture. */
static void paths_are_no_pipes(void **state)
{
    (void)state;
    static const char *const names[] = {"<touch PWNED;#", "|touch PWNED;#", "a'; touch PWNED; '"};
    for (int k = 0; k < 3; k++) {
        char csv[100], picture[100];
        assert_int_equal(mkdir(names[k], 0777), 0);
        FILE *file = file_begin(names[k], "bench.csv");
        fputs("scene,engine,isa,algorithm,precision,threads,pairs_per_s,fraction_of_peak,ratio_to_control\n"
              "bp22/full,general,v3,\"`touch "
              "PWNED`\",float,1,1e9,0.1,100\nbp22/full,invariant,v3,bp_nearest,float,1,2e9,0.2,200\n",
              file);
        assert_int_equal(fclose(file), 0);
        snprintf(csv, sizeof csv, "%s/bench.csv", names[k]);
        snprintf(picture, sizeof picture, "%s/bench.png", names[k]);
        if (plot_csv(picture, PLOTS, "bench.gp", csv, "here") != STATUS_OK)
            fail_msg("%s: %s", csv, status_message());
        assert_int_equal(access(picture, R_OK), 0);
        plot_path_svg(picture); /* beside it */
        assert_int_equal(access(picture, R_OK), 0);
        plot_by_hand("bench", csv);
        assert_no_canary("bench", csv);
        file = file_begin(names[k], "stability.csv");
        fputs("scene,algorithm,options,precision,verdict,digits\n"
              "a,b,\"c;touch PWNED,d='`touch PWNED`'\",float,works,1\n",
              file);
        assert_int_equal(fclose(file), 0);
        snprintf(csv, sizeof csv, "%s/stability.csv", names[k]);
        plot_by_hand("stability", csv);
        snprintf(picture, sizeof picture, "%s/stability.png", names[k]);
        assert_int_equal(access(picture, R_OK), 0);
        assert_no_canary("stability", csv);
    }
}

static void only_regular_pictures_are_shown(void **state)
{
    (void)state;
    results_fill(".", "a", "b", "1");
    support_write("secret", "what must not be shown");
    assert_int_equal(symlink("secret", "a-slices.png"), 0);
    assert_int_equal(symlink("/nowhere/at/all", "phase-broken.png"), 0);
    assert_int_equal(mkfifo("phase-pipe.png", 0600), 0);
    assert_int_equal(mkdir("phase-folder.png", 0700), 0);
    support_write("phase-good.png", "abc");
    alarm(60);
    if (report_write(folder) != STATUS_OK)
        fail_msg("%s", status_message());
    alarm(0);
    char *html = support_read("report.html");
    assert_non_null(html);
    assert_non_null(strstr(html, "src=\"data:image/png;base64,YWJj\""));
    assert_null(strstr(html, "d2hhdCBtdXN0IG5vdCBiZSBzaG93bg"));
    assert_non_null(strstr(html, "3 pictures are left out: links, folders or pipes")); /* of the figures */
    assert_non_null(strstr(html, "1 picture is left out: links, folders or pipes"));
    free(html);
    assert_int_equal(mkfifo("claims.csv", 0600), 0);
    alarm(60);
    assert_int_equal(report_write(folder), STATUS_INVALID);
    alarm(0);
    assert_non_null(strstr(status_message(), "claims.csv: not a regular file; a readable CSV file"));
}

static void pages_are_utf8_whatever_the_names_are(void **state)
{
    (void)state;
    results_fill(".", "a\xff\xfe\xc3(\xf0\x9f\x92", "\xed\xa0\x80 gr\xc3\xbc\xc3\x9f \xc0\xaf", "1");
    if (report_write(folder) != STATUS_OK)
        fail_msg("%s", status_message());
    char *page = support_read("report.html");
    assert_non_null(page);
    for (const char *at = page; *at;) {
        size_t length = *at == '\n' || *at == '\t' ? 1 : shown_length(at);
        if (length == 0)
            fail_msg("the page holds the byte 0x%02x at %td", (unsigned char)*at, at - page);
        at += length;
    }
    assert_non_null(strstr(page, "gr\xc3\xbc\xc3\x9f"));
    free(page);
}

int main(void)
{
#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, work_folder, work_folder_end)
    const struct CMUnitTest tests[] = {
        IN_FOLDER(texts_are_no_commands),
        IN_FOLDER(control_characters_are_refused),
        IN_FOLDER(paths_are_no_pipes),
        IN_FOLDER(only_regular_pictures_are_shown),
        IN_FOLDER(pages_are_utf8_whatever_the_names_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
